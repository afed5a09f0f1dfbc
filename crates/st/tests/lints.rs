//! Lints: the findings of each, and code without a finding.

use crate::common::{compile_with, source};
use standstill_st::{Options, Report};

/// The codes and lines of the warnings for a program with these variables and statements, from line 10 on.
fn lints(variables: &str, statements: &str) -> Vec<(&'static str, u32)> {
    let text = format!(
        "PROGRAM P\nVAR\n  X : AXIS_REF;\n  go, done : BOOL;\n  n : INT(0..9);\n  a, b : LREAL;\n{variables}\nEND_VAR\n\n\
         {statements}\ngo := done AND n = 1 AND a > b AND X.Number = 1;\nEND_PROGRAM\n"
    );
    let report = report(&text);
    let told = report.diagnostics().iter();
    told.map(|it| (it.code.name(), report.positions(it.span).0.line))
        .collect()
}

/// The codes of the warnings for this text.
fn codes(text: &str) -> Vec<&'static str> {
    let report = report(text);
    report.diagnostics().iter().map(|it| it.code.name()).collect()
}

/// The report of this text, which has no mistake.
fn report(text: &str) -> Report {
    let options = Options {
        lint: true,
        ..Options::default()
    };
    let report = standstill_st::check(&[source("p.st", text)], &options);
    assert!(!report.has_errors(), "{report}");
    report
}

const MOVE: &str = "Mv : MC_MoveAbsolute;";

/// Covers: ST50
#[test]
fn a_motion_block_is_called_in_every_scan() {
    let in_branch = "IF go THEN\nMv(Axis := X, Execute := done);\nEND_IF;\ngo := Mv.Error;";
    assert_eq!(lints(MOVE, in_branch), [("ST50", 11)]);
    let in_case = "CASE n OF\n1: Mv(Axis := X, Execute := done);\nEND_CASE;\ngo := Mv.Error;";
    assert_eq!(lints(MOVE, in_case), [("ST50", 11)]);
    let always = "Mv(Axis := X, Execute := done);\ngo := Mv.Error;";
    assert_eq!(lints(MOVE, always), []);
    // An additional call; a timer need not be called.
    let both = "IF go THEN\nn := 1;\nEND_IF;\nMv(Axis := X, Execute := done);\ngo := Mv.Error;";
    assert_eq!(lints(MOVE, both), []);
    assert_eq!(
        lints("T : TON;", "IF go THEN\nT(IN := done, PT := T#1s);\nEND_IF;"),
        []
    );
    let all = "FOR i := 1 TO 2 DO\nMvs[i](Axis := X, Execute := done);\ngo := Mvs[i].Error;\nEND_FOR;";
    assert_eq!(lints("i : INT; Mvs : ARRAY [1..2] OF MC_MoveAbsolute;", all), []);
}

/// Covers: ST50
#[test]
fn every_path_counts_for_a_motion_block() {
    let told = |statements: &str| lints(MOVE, &format!("{statements}\ngo := Mv.Error;"));
    let call = "Mv(Axis := X, Execute := done);";
    for always in [
        format!("IF go THEN\n{call}\nELSE\n{call}\nEND_IF;"),
        format!("IF go THEN\n{call}\nELSIF done THEN\n{call}\nELSE\n{call}\nEND_IF;"),
        format!("CASE n OF\n1: {call}\nELSE\n{call}\nEND_CASE;"),
        format!("CASE n OF\n0..4: {call}\n5, 6..9: {call}\nEND_CASE;"),
        format!("IF go THEN\n{call}\nRETURN;\nEND_IF;\n{call}"),
        format!("{call}\nIF go THEN\nRETURN;\nEND_IF;"),
        format!("REPEAT\n{call}\nIF go THEN\nEXIT;\nEND_IF;\nUNTIL done END_REPEAT;"),
        format!("IF go THEN\nIF done THEN\n{call}\nELSE\n{call}\nEND_IF;\nELSE\n{call}\nEND_IF;"),
    ] {
        assert_eq!(told(&always), [], "{always}");
    }
    for (not_always, line) in [
        (format!("IF go THEN\nRETURN;\nEND_IF;\n{call}"), 13),
        (
            format!("IF go THEN\n{call}\nELSIF done THEN\n{call}\nEND_IF;"),
            11,
        ),
        (format!("IF go THEN\n{call}\nELSE\nn := 1;\nEND_IF;"), 11),
        (
            format!("IF go THEN\nIF done THEN\n{call}\nEND_IF;\nELSE\n{call}\nEND_IF;"),
            12,
        ),
        (format!("CASE n OF\n0..4: {call}\n6..9: {call}\nEND_CASE;"), 11),
        (format!("WHILE go DO\n{call}\nEND_WHILE;"), 11),
        (
            format!("REPEAT\nIF go THEN\nEXIT;\nEND_IF;\n{call}\nUNTIL done END_REPEAT;"),
            14,
        ),
        (
            format!("REPEAT\nIF go THEN\nRETURN;\nEND_IF;\n{call}\nUNTIL done END_REPEAT;"),
            14,
        ),
    ] {
        assert_eq!(told(&not_always), [("ST50", line)], "{not_always}");
    }
    let modes = "Mode : (Idle, Work);\nMv : MC_MoveAbsolute;";
    let by_mode = format!("CASE Mode OF\nIdle: {call}\nWork: {call}\nEND_CASE;\ngo := Mv.Error;");
    assert_eq!(lints(modes, &by_mode), []);
}

/// Covers: ST51
#[test]
fn execute_has_a_condition() {
    assert_eq!(
        lints(MOVE, "Mv(Axis := X, Execute := TRUE);\ngo := Mv.Error;"),
        [("ST51", 10)]
    );
    assert_eq!(lints(MOVE, "Mv(Axis := X, Execute := go);\ngo := Mv.Error;"), []);
    assert_eq!(
        lints(
            "P1 : MC_Power;",
            "P1(Axis := X, Enable := TRUE);\ngo := P1.Error;"
        ),
        []
    );
}

/// Covers: ST51
#[test]
fn another_call_may_give_execute_otherwise() {
    let told = |variables: &str, statements: &str| {
        let told = lints(variables, &format!("{statements}\ngo := Mv.Error;"));
        told.into_iter()
            .filter(|(code, _)| *code == "ST51")
            .collect::<Vec<_>>()
    };
    let given = |other: &str| {
        format!("IF go THEN\nMv(Axis := X, Execute := TRUE);\nELSE\nMv(Axis := X{other});\nEND_IF;")
    };
    assert_eq!(told(MOVE, &given(", Execute := FALSE")), []);
    assert_eq!(told(MOVE, &given(", Execute := done")), []);
    assert_eq!(told(MOVE, &given("")), [("ST51", 11)]);
    assert_eq!(
        told(MOVE, &given(", Execute := TRUE")),
        [("ST51", 11), ("ST51", 13)]
    );
    // A statement writes it, and a call uses that value.
    assert_eq!(told(MOVE, &format!("Mv.Execute := done;\n{}", given(""))), []);
    let every = "Mv.Execute := done;\nMv(Axis := X, Execute := TRUE);";
    assert_eq!(told(MOVE, every), [("ST51", 11)]);
    // The value of another instance is not its own.
    let two = "Mv(Axis := X, Execute := TRUE);\nMw(Axis := X, Execute := FALSE);\ngo := Mw.Error;";
    assert_eq!(told("Mv, Mw : MC_MoveAbsolute;", two), [("ST51", 10)]);
}

/// Covers: ST52
#[test]
fn one_variable_has_one_writer() {
    let two = "A1(Axis := X, Execute := go, Done => done, Error => go);\nB1(Axis := X, Execute := go, Done => done);\ngo := B1.Error;";
    assert_eq!(lints("A1, B1 : MC_MoveAbsolute;", two), [("ST52", 11)]);
    let one = "A1(Axis := X, Execute := go, Done => done, Error => go);\nB1(Axis := X, Execute := go);\ngo := B1.Error;";
    assert_eq!(lints("A1, B1 : MC_MoveAbsolute;", one), []);
}

/// Covers: ST53
#[test]
fn a_refusal_is_noticed() {
    assert_eq!(lints(MOVE, ""), [("ST53", 7)]);
    assert_eq!(lints(MOVE, "Mv(Axis := X, Execute := go);"), [("ST53", 10)]);
    for noticed in ["go := Mv.Error;", "go := Mv.ErrorID <> 0;"] {
        assert_eq!(
            lints(MOVE, &format!("Mv(Axis := X, Execute := go);\n{noticed}")),
            [],
            "{noticed}"
        );
    }
    assert_eq!(lints(MOVE, "Mv(Axis := X, Execute := go, Error => done);"), []);
}

/// Covers: ST53
#[test]
fn an_instance_that_is_read_is_called() {
    assert_eq!(lints("T : TON;", "go := T.Q;"), [("ST53", 7)]);
    assert_eq!(lints("T : TON;", "T.IN := go;"), [("ST53", 7)]);
    assert_eq!(lints("T : TON;", "T(IN := go, PT := T#1s);\ngo := T.Q;"), []);
    assert_eq!(
        lints("Ts : ARRAY [1..2] OF TON;", "go := Ts[1].Q;"),
        [("ST53", 7)]
    );
    // A unit that receives the instance may call it.
    let text = "FUNCTION_BLOCK Wait VAR_IN_OUT T : TON; END_VAR T(IN := TRUE, PT := T#1s); END_FUNCTION_BLOCK
        FUNCTION_BLOCK Count VAR_OUTPUT n : INT; END_VAR METHOD Up n := n + 1; END_METHOD END_FUNCTION_BLOCK
        PROGRAM P VAR T : TON; W : Wait; C : Count; go : BOOL; END_VAR
        W(T := T); C.Up(); go := T.Q AND C.n > 3; END_PROGRAM";
    assert_eq!(codes(text), [""; 0]);
}

/// Covers: ST50, ST53
#[test]
fn many_variables_and_calls_are_searched() {
    let most = standstill_testkit::whole_or(10_000, 2_000);
    let variables: String = (0..most).map(|i| format!("v{i} : INT; t{i} : TON;\n")).collect();
    let calls: String = (0..most)
        .map(|i| format!("t{i}(IN := v{i} > 0, PT := T#1s, Q => go);\nv{i} := v{i} + 1;\n"))
        .collect();
    let text = format!("PROGRAM P VAR go : BOOL;\n{variables}END_VAR\n{calls}END_PROGRAM");
    assert!(codes(&text).iter().all(|code| *code == "ST52"));
}

/// Covers: ST54
#[test]
fn a_block_is_called_once_in_a_scan() {
    let twice = "Mv(Axis := X, Execute := FALSE);\nMv(Execute := go, Axis := X);\ngo := Mv.Error;";
    assert_eq!(lints(MOVE, twice), [("ST54", 11)]);
    let again = "T(IN := go, PT := T#1s);\nIF go THEN\nT(IN := FALSE);\nEND_IF;";
    assert_eq!(lints("T : TON;", again), [("ST54", 12)]);
    let either = "IF go THEN\nT(IN := go, PT := T#1s);\nELSE\nT(IN := FALSE);\nEND_IF;";
    assert_eq!(lints("T : TON;", either), []);
    let elements = "Ts[1](IN := go, PT := T#1s);\nTs[2](IN := go, PT := T#1s);";
    assert_eq!(lints("Ts : ARRAY [1..2] OF TON;", elements), []);
}

/// Covers: ST55
#[test]
fn numbers_with_a_point_are_not_compared_for_being_equal() {
    assert_eq!(lints("", "go := a = b;"), [("ST55", 10)]);
    assert_eq!(lints("", "go := a <> b;"), [("ST55", 10)]);
    assert_eq!(lints("", "go := ABS(a - b) < 0.001 OR n = 3;"), []);
}

/// Covers: ST56
#[test]
fn a_value_is_not_made_wide_to_be_made_narrow() {
    assert_eq!(lints("i : INT;", "i := DINT_TO_INT(i);"), [("ST56", 10)]);
    assert_eq!(lints("i : INT; d : DINT;", "i := DINT_TO_INT(d); d := i;"), []);
}

/// Covers: ST57
#[test]
fn every_branch_and_every_variable_is_of_use() {
    assert_eq!(lints("idle : INT;", ""), [("ST57", 7)]);
    assert_eq!(lints("i : INT;", "i := 1;"), []);
    assert_eq!(lints("i AT %QW0 : INT;", ""), []);
    let beyond = "CASE n OF\n1: go := TRUE;\n12: go := FALSE;\nEND_CASE;";
    assert!(
        lints("", beyond).contains(&("ST57", 12)),
        "{:?}",
        lints("", beyond)
    );
    assert_eq!(lints("", "CASE n OF\n1: go := TRUE;\nEND_CASE;"), []);
}

/// Covers: ST55
#[test]
fn a_lint_is_switched_off_in_place() {
    let off = "{lint off ST55}\ngo := a = b;\n{lint on ST55}\ngo := a <> b;";
    assert_eq!(lints("", off), [("ST55", 13)]);
    assert_eq!(lints("", "{lint off ST50}\ngo := a = b;"), [("ST55", 11)]);
}

/// An AXIS_REF that is never bound is reported if the axes are known.
#[test]
fn an_axis_that_nobody_names_is_told() {
    let doubts = |variables: &str, statements: &str, axes: &[&str], bindings: &[(&str, u16)]| {
        let text = format!(
            "PROGRAM P\nVAR\n  Power : MC_Power;\n{variables}\nEND_VAR\n{statements}\n\
             Power(Axis := X, Enable := TRUE);\nEND_PROGRAM\n"
        );
        let options = Options {
            axes: axes.iter().map(ToString::to_string).collect(),
            bindings: bindings
                .iter()
                .map(|(path, axis)| (path.to_string(), *axis))
                .collect(),
            ..Options::default()
        };
        let report = compile_with(&text, &options).unwrap().report;
        let told = report.diagnostics().iter();
        told.map(|it| (report.positions(it.span).0.line, it.message.clone()))
            .collect::<Vec<_>>()
    };
    let plain = "  X : AXIS_REF;";
    let message = "`X` names no axis: blocks refuse it with ErrorID 100".to_owned();
    assert_eq!(doubts(plain, "", &["Belt"], &[]), [(4, message)]);
    // It has the name of an axis, is bound, has a number, or is set at run time; or no machine is known.
    assert_eq!(doubts(plain, "", &["Belt", "x"], &[]), []);
    assert_eq!(doubts(plain, "", &["Belt"], &[("X", 1)]), []);
    assert_eq!(doubts("  X : AXIS_REF := (Number := 1);", "", &["Belt"], &[]), []);
    assert_eq!(doubts(plain, "X.Number := 1;", &["Belt"], &[]), []);
    assert_eq!(doubts(plain, "", &[], &[]), []);
}
