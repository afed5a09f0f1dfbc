//! Scripts with programs in Structured Text: a message for every error in one.

use standstill_script::{ScriptError, model::Script, read_with_programs};
use std::fmt::Write;

const FILES: [(&str, &str); 7] = [
    (
        "main.wat",
        r#"(module (memory (export "memory") 1) (func (export "plc_scan") (param i32 i64)))"#,
    ),
    (
        "cell.st",
        "TYPE E_State : (Idle, Busy := 3); END_TYPE
         VAR_GLOBAL Total : LINT; END_VAR
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
        "whole.st",
        "PROGRAM P END_PROGRAM
         CONFIGURATION C RESOURCE R ON PLC
           TASK Fast(INTERVAL := T#4ms, PRIORITY := 1); PROGRAM A WITH Fast : P;
         END_RESOURCE END_CONFIGURATION",
    ),
];

/// A script with this program, these further keys, and these conditions.
fn read(program: &str, keys: &str, that: &str) -> Result<Script, ScriptError> {
    let text = format!(
        "{{\n  \"standstill\": 1, \"cycle\": \"T#2ms\", \"scans\": 9,\n  \"axes\": {{\"X\": {{\"limits\": \
         {{\"velocity\": 1, \"acceleration\": 1}}}}}},\n  \"programs\": {{\"c\": {program}}},\n  {keys}\n  \
         \"expect\": [{{\"at\": 1, \"that\": {{{that}}}}}]\n}}"
    );
    let mut files = |_: &str| Err("there are no files here".to_owned());
    read_with_programs(&text, "a/cell.scan.json", &[], &mut files, &mut |wanted| {
        let file = FILES.iter().find(|(name, _)| *name == wanted);
        file.map(|(_, text)| text.as_bytes().to_vec())
            .ok_or_else(|| "there is no such file".to_owned())
    })
}

const CELL: &str = r#"{"st": "cell.st"}"#;

/// The code, what is wrong, the program, further keys, and conditions.
const CASES: [(&str, &str, &str, &str, &str); 26] = [
    (
        "bad_program",
        "no such file",
        r#"{"st": ["cell.st", "gone.st"]}"#,
        "",
        "",
    ),
    (
        "bad_program",
        "mistakes in the sources",
        r#"{"st": ["wrong.st"]}"#,
        "",
        "",
    ),
    (
        "bad_program",
        "two programs, and none is named",
        r#"{"st": ["cell.st", "other.st"]}"#,
        "",
        "",
    ),
    (
        "bad_program",
        "a program that is not there",
        r#"{"st": "cell.st", "program": "Cel"}"#,
        "",
        "",
    ),
    ("wrong_type", "a file is a path", r#"{"st": [1]}"#, "", ""),
    ("bad_value", "no file", r#"{"st": []}"#, "", ""),
    (
        "unknown_key",
        "two sources",
        r#"{"st": "cell.st", "wasm": "cell.wasm"}"#,
        "",
        "",
    ),
    (
        "unknown_key",
        "symbols are of modules",
        r#"{"st": "cell.st", "symbols": {}}"#,
        "",
        "",
    ),
    (
        "unknown_key",
        "traces are of texts",
        r#"{"wasm": "main.wat", "trace": []}"#,
        "",
        "",
    ),
    (
        "unknown_signal",
        "a reference that is not there",
        r#"{"st": "cell.st", "axes": {"Feder": "X"}}"#,
        "",
        "",
    ),
    (
        "unknown_signal",
        "a reference that is bound twice",
        r#"{"st": "cell.st", "axes": {"Feeder": "X", "feeder": "X"}}"#,
        "",
        "",
    ),
    (
        "unknown_axis",
        "an axis that is not there",
        r#"{"st": "cell.st", "axes": {"Feeder": "Y"}}"#,
        "",
        "",
    ),
    (
        "unknown_signal",
        "a column that is not there",
        r#"{"st": "cell.st", "trace": ["Totl"]}"#,
        "",
        "",
    ),
    (
        "bad_value",
        "a task beside a CONFIGURATION",
        r#"{"st": "whole.st", "task": "main"}"#,
        "",
        "",
    ),
    (
        "bad_time",
        "an interval beside the cycle",
        r#"{"st": "tasks.st"}"#,
        "",
        "",
    ),
    (
        "unknown_signal",
        "a variable that is not there",
        CELL,
        "",
        r#""c.Sped": 1"#,
    ),
    (
        "unknown_signal",
        "a block is no signal",
        CELL,
        "",
        r#""c.mv": true"#,
    ),
    (
        "unknown_element",
        "an element that is not there",
        CELL,
        "",
        r#""c.State": "Bussy""#,
    ),
    ("bad_value", "half an INT", CELL, "", r#""c.Inner": 0.5"#),
    (
        "bad_value",
        "a LINT that JSON cannot write",
        CELL,
        "",
        r#""c.Total": 9007199254740993"#,
    ),
    (
        "bad_value",
        "a LINT has no tolerance",
        CELL,
        "",
        r#""c.Total": {"near": 1, "within": 1}"#,
    ),
    (
        "wrong_type",
        "an enumeration is no number",
        CELL,
        "",
        r#""c.State": {"gt": 1}"#,
    ),
    (
        "not_writable",
        "a variable inside",
        CELL,
        r#""steps": [{"at": 1, "set": {"c.Inner": 1}}],"#,
        "",
    ),
    (
        "bad_value",
        "beyond a subrange",
        CELL,
        r#""steps": [{"at": 1, "set": {"c.Level": 10}}],"#,
        "",
    ),
    (
        "unknown_element",
        "a number without a name",
        CELL,
        r#""steps": [{"at": 1, "set": {"c.State": 1}}],"#,
        "",
    ),
    (
        "wrong_type",
        "no pin has 64 bits",
        CELL,
        r#""blocks": [{"name": "t", "type": "MC_Stop", "pins": {"Axis": "X", "Deceleration": {"from": "c.Total"}}}],"#,
        "",
    ),
];

/// Covers: ST43
#[test]
fn every_mistake_with_a_program_in_structured_text_is_told() {
    let mut messages = String::new();
    for (code, title, program, keys, that) in CASES {
        let blocks = if keys.contains("blocks") {
            ""
        } else {
            r#""blocks": [],"#
        };
        let that = if that.is_empty() {
            r#""X.Position": 0"#
        } else {
            that
        };
        let error = read(program, &format!("{blocks} {keys}"), that).expect_err(title);
        let codes: Vec<_> = error.diagnostics().iter().map(|it| it.code.name()).collect();
        assert_eq!(codes, [code], "{title}\n{error}");
        writeln!(messages, "# {title}\n{error}\n").unwrap();
    }
    insta::assert_snapshot!(messages);
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
        let script = read(program, r#""blocks": [],"#, that).unwrap_or_else(|error| panic!("{error}"));
        let symbols = script.programs[0].symbols.iter();
        symbols.map(|symbol| symbol.name.clone()).collect()
    };
    let usual = names(CELL, r#""c.total": 0"#);
    assert_eq!(usual[..3], ["Fault", "Total", "Mv.Execute"]);
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
    let keys = r#""blocks": [], "stop_when": "=c.Mode = Run AND c.%IW4*2 = 6 AND c.Axes[2, 1].Number = 1","#;
    let script = read(program, keys, r#""c.Mode": "Run""#).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(standstill_script::run(&script).unwrap().trace.scans(), 1);
}
