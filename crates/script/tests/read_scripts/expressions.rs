//! Scripts with expressions: the messages for one that cannot be read, and for one without a value.

use crate::common;
use standstill_script::read;
use std::fmt::Write;

/// A script with these pins of a move, and this claim.
fn with(pins: &str, claim: &str) -> String {
    format!(
        r#"{{
  "standstill": 1, "cycle": "T#1ms", "scans": 9,
  "axes": {{"X": {{"limits": {{"velocity": 50, "acceleration": 200}}, "state": "Standstill"}}}},
  "inputs": {{"go": false, "speed": 2.5}},
  "blocks": [
    {{"name": "c", "type": "CTU", "pins": {{"CU": {{"from": "go"}}}}}},
    {{"name": "m", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", {pins}}}}}
  ],
  "steps": [{{"at": 3, "set": {{"go": true}}}}],
  "expect": [{claim}]
}}
"#
    )
}

/// The code, the pins and the claim.
const CASES: [(&str, &str, &str); 17] = [
    ("unknown_signal", r#""Execute": "=X.Velocty > 3.0""#, ""),
    ("unknown_signal", r#""Execute": "=X.Position.d1 > 3.0""#, ""),
    ("bad_expression", r#""Position": "=go""#, ""),
    ("bad_expression", r#""Position": "=speed +""#, ""),
    ("bad_expression", r#""Position": "=X.State""#, ""),
    ("wrong_type", r#""Position": "=m.Axis""#, ""),
    ("bad_expression", r#""Direction": "=mcPositveDirection""#, ""),
    ("bad_expression", r#""Execute": {"any": ["go", "=speed"]}"#, ""),
    ("bad_expression", "", r#"{"always": "=speed"}"#),
    (
        "bad_expression",
        "",
        r#"{"always": "=speed > 1.0 AND X.Position"}"#,
    ),
    (
        "bad_expression",
        "",
        r#"{"at": 1, "that": "=X.State = Standing"}"#,
    ),
    ("bad_expression", "", r#"{"always": "=TON(IN := go)"}"#),
    ("bad_expression", "", r#"{"always": "=m.Done AND (m.Busy OR go"}"#),
    ("bad_expression", "", r#"{"always": "=go; go := TRUE"}"#),
    ("bad_expression", "", r#"{"always": "="}"#),
    ("bad_expression", "", r#"{"always": "=go\u0020AND 5"}"#),
    ("unknown_pin", "", r#"{"always": "=m.Buzy"}"#),
];

/// Covers: ST13
#[test]
fn every_bad_expression_is_told_at_its_place() {
    let mut messages = String::new();
    for (code, pins, claim) in CASES {
        let pins = if pins.is_empty() { r#""Position": 1"# } else { pins };
        let error = read(&with(pins, claim), "e.scan.json", &[]).expect_err(claim);
        let codes: Vec<_> = error.diagnostics().iter().map(|it| it.code.name()).collect();
        assert_eq!(codes, [code], "{error}");
        writeln!(messages, "{error}\n").unwrap();
    }
    insta::assert_snapshot!(messages);
}

/// What speaks against the claims of a run.
fn failures(pins: &str, claims: &str) -> Vec<String> {
    common::failures(&common::outcome(&with(pins, claims)))
}

/// Covers: ST33
#[test]
fn an_expression_without_a_value_is_a_failed_claim() {
    let why = "a division by zero: the dividend is 10";
    assert_eq!(
        failures(r#""Position": 1"#, r#"{"never": "=10 / c.CV = 3"}"#),
        [format!("expect[0]: =10 / c.CV = 3 has no value at scan 0: {why}")]
    );
    // Only the scans count that the claim speaks of.
    let later = r#"{"never": "=10 / c.CV = 3", "from": 3}"#;
    assert!(failures(r#""Position": 1"#, later).is_empty());
}

/// Covers: ST33
#[test]
fn an_expression_without_a_value_in_a_wire_stops_the_programs_and_fails_the_run() {
    let pins = r#""Execute": "=10 / (c.CV - 1) < 0", "Position": 1, "Velocity": 1"#;
    let claims =
        r#"{"at": 2, "that": {"X.State": "DiscreteMotion"}}, {"by": 8, "that": {"X.State": "Disabled"}}"#;
    assert_eq!(
        failures(pins, claims),
        ["blocks: =10 / (c.CV - 1) < 0 has no value at scan 3: a division by zero: the dividend is 10"]
    );
}
