//! Scripts with programs in Structured Text: a message for every error in one.

use super::cases::table;
use standstill_script::{ScriptError, model::Script, read_with_programs};
use std::fmt::Write;

const FILES: [(&str, &str); 10] = [
    (
        "main.wat",
        r#"(module (memory (export "memory") 1) (func (export "plc_scan") (param i32 i64)))"#,
    ),
    (
        "cell.st",
        "TYPE E_State : (Idle, Busy := 3); END_TYPE
         VAR_GLOBAL Total : LINT; END_VAR VAR_GLOBAL CONSTANT Most : INT := 9; END_VAR
         PROGRAM Cell
         VAR_INPUT Go : BOOL; Speed : REAL; Level : INT(0..9); State : E_State; Wait : TIME; END_VAR
         VAR Feeder : AXIS_REF; Mv : MC_MoveAbsolute; Inner : INT; END_VAR
         Mv(Axis := Feeder, Execute := Go);
         END_PROGRAM",
    ),
    (
        "plain.st",
        "PROGRAM Plain
         VAR_OUTPUT Mode : (Idle, Run := 5); Level AT %IW4 : INT := 3; END_VAR
         VAR Axes : ARRAY [1..2, 0..1] OF AXIS_REF; END_VAR
           Mode := Run;
         END_PROGRAM",
    ),
    ("other.st", "PROGRAM Other END_PROGRAM"),
    (
        "wrong.st",
        "PROGRAM Cell\nVAR n : INT; END_VAR\n  n = 1;\n  m := 2;\nEND_PROGRAM\n",
    ),
    (
        "tasks.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Fast(INTERVAL := T#3ms, PRIORITY := 1); PROGRAM A WITH Fast : P;
         END_RESOURCE END_CONFIGURATION",
    ),
    (
        "slow_main.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Main(INTERVAL := T#4ms, PRIORITY := 1); PROGRAM A WITH Main : P;
         END_RESOURCE END_CONFIGURATION",
    ),
    (
        "late_main.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Main(INTERVAL := T#2ms, PRIORITY := 1); PROGRAM A WITH Main : P;
         END_RESOURCE END_CONFIGURATION",
    ),
    (
        "other_main.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Main(INTERVAL := T#2ms, PRIORITY := 2); PROGRAM A WITH Main : P;
         END_RESOURCE END_CONFIGURATION",
    ),
    (
        "whole.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Fast(INTERVAL := T#4ms, PRIORITY := 1); PROGRAM A WITH Fast : P;
         END_RESOURCE END_CONFIGURATION",
    ),
];

/// A good script.
const GOOD: &str = r#"{
  "standstill": 1, "cycle": "T#2ms", "scans": 9,
  "axes": {"X": {"limits": {"velocity": 1, "acceleration": 1}}},
  "programs": {"c": {"st": "cell.st"}},
  "blocks": [],
  "expect": [{"at": 1, "that": {"X.Position": 0}}]
}"#;

fn read(text: &str) -> Result<Script, ScriptError> {
    let mut files = |_: &str| Err("there are no files here".to_owned());
    read_with_programs(text, "a/cell.scan.json", &[], &mut files, &mut |wanted| {
        let file = FILES.iter().find(|(name, _)| *name == wanted);
        file.map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| "there is no such file".to_owned())
    })
}

/// The good script with another program and another condition.
fn with(program: &str, that: &str) -> String {
    GOOD.replacen(r#"{"st": "cell.st"}"#, program, 1)
        .replacen(r#""X.Position": 0"#, that, 1)
}

const CELL: &str = r#"{"st": "cell.st"}"#;

/// Covers: ST43
#[test]
fn every_mistake_with_a_program_in_structured_text_is_told() {
    let mut messages = String::new();
    for case in table(include_str!("bad_texts.txt")) {
        let error = read(&case.text(GOOD)).expect_err(case.title);
        let codes: Vec<_> = error.diagnostics().iter().map(|it| it.code.name()).collect();
        assert_eq!(codes, [case.code], "{}\n{error}", case.title);
        writeln!(messages, "# {}\n{error}\n", case.title).unwrap();
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn a_task_called_main_takes_the_place_of_a_predefined_one_that_nobody_uses() {
    let tasks = |programs: &str, more: &str| {
        let text =
            GOOD.replacen(r#""c": {"st": "cell.st"}"#, programs, 1)
                .replacen(r#""blocks": [],"#, more, 1);
        let script = read(&text).unwrap_or_else(|error| panic!("{error}"));
        let task = |task: &standstill_script::model::Task| (task.name.clone(), task.interval, task.priority);
        script.tasks.iter().map(task).collect::<Vec<_>>()
    };
    let main = |interval, priority| ("Main".to_owned(), Some(interval), priority);
    let none = r#""blocks": [],"#;
    assert_eq!(tasks(r#""c": {"st": "slow_main.st"}"#, none), [main(2, 1)]);
    let twice = r#""c": {"st": "late_main.st"}, "d": {"st": "late_main.st"}"#;
    assert_eq!(tasks(twice, none), [main(1, 1)]);
    let same = r#""blocks": [], "tasks": {"Main": {"interval": 2, "priority": 1}},"#;
    assert_eq!(tasks(r#""c": {"st": "slow_main.st"}"#, same), [main(2, 1)]);
    // In the script's own `main` then.
    let both = r#""c": {"st": "cell.st"}, "d": {"st": "slow_main.st"}"#;
    assert_eq!(tasks(both, same), [main(2, 1)]);
}

#[test]
fn what_is_not_utf8_is_told_with_its_file() {
    let mut files = |_: &str| Err("there are no files here".to_owned());
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 1, "axes": {}, "blocks": [],
        "programs": {"c": {"st": "cell.st"}}}"#;
    let error = read_with_programs(text, "cell.scan.json", &[], &mut files, &mut |_| {
        Ok(b"PROGRAM P\n(* \xff *) END_PROGRAM".to_vec())
    })
    .expect_err("no UTF-8");
    assert!(error.to_string().contains("cell.st:2:4"), "{error}");
}

#[test]
fn columns_are_what_trace_names_and_what_the_script_asks_for() {
    let names = |program: &str, that: &str| -> Vec<String> {
        let script = read(&with(program, that)).unwrap_or_else(|error| panic!("{error}"));
        let symbols = script.programs[0].symbols.iter();
        symbols.map(|symbol| symbol.name.clone()).collect()
    };
    let usual = names(CELL, r#""c.total": 0"#);
    assert_eq!(usual[..4], ["Fault", "Total", "Most", "Mv.Execute"]);
    assert!(usual.iter().any(|name| name == "Mv.Done"), "{usual:?}");
    assert!(!usual.iter().any(|name| name == "Inner"), "{usual:?}");
    let asked = names(
        r#"{"st": "cell.st", "trace": ["Feeder"]}"#,
        r#""c.CELL.inner": 0"#,
    );
    assert_eq!(asked, ["Fault", "Feeder.Number", "Inner"]);
}

/// Covers: ST11, ST21, ST43
#[test]
fn expressions_read_addresses_and_enumerations_without_a_name() {
    let program = r#"{"st": "plain.st", "axes": {"axes[2, 1]": "X"}}"#;
    let stop = r#""blocks": [], "stop_when": "=c.Mode = Run AND c.%IW4*2 = 6 AND c.Axes[2, 1].Number = 1","#;
    let text = with(program, r#""c.Mode": "Run""#).replacen(r#""blocks": [],"#, stop, 1);
    let script = read(&text).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(standstill_script::run(&script).unwrap().trace.scans(), 1);
}
