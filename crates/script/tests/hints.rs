//! Typical first errors: each message has the remedy.

use standstill_script::{Diagnostic, read};

const SCRIPT: &str = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 9, "inputs": {"GO": false, "b": false},
"axes": {"X": {"limits": {"velocity": 1, "acceleration": 1}}},
"blocks": [{"name": "there", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Velocity": 4}},
{"name": "speed", "type": "MC_ReadActualVelocity", "pins": {"Axis": "X", "Enable": true}}],
"steps": [{"at": 1, "set": {"GO": true, "b": true}}], "expect": [{"by": 8, "that": {"X.Position": {"ge": 0}}}]}"#;

/// The message for the script with one piece replaced.
#[track_caller]
fn said(find: &str, replace: &str) -> String {
    assert_eq!(SCRIPT.matches(find).count(), 1, "{find}");
    read(&SCRIPT.replace(find, replace), "a.scan.json", &[])
        .unwrap_err()
        .to_string()
}

#[test]
fn the_script_is_right() {
    read(SCRIPT, "a.scan.json", &[]).unwrap();
}

#[test]
fn every_mistake_has_its_remedy() {
    let cases = [
        (
            r#"{"from": "GO"}"#,
            r#"{"from": "NOT b"}"#,
            r#"write {"not": "b"}"#,
        ),
        (
            r#"{"from": "GO"}"#,
            r#"{"from": "GO AND b"}"#,
            r#"write {"all": ["GO", "b"]}"#,
        ),
        (
            r#"{"from": "GO"}"#,
            r#""GO OR b""#,
            r#"write {"any": ["GO", "b"]}"#,
        ),
        (r#"{"from": "GO"}"#, r#""TRUE""#, "write true, without quotes"),
        (
            r#"{"from": "GO"}"#,
            r#"{"from": "X.Position"}"#,
            "MC_ReadActualPosition",
        ),
        (
            r#""Velocity": 4"#,
            r#""Velocity": 4,5"#,
            "numbers have a decimal point: 4.5",
        ),
        (
            r#""Velocity": 4"#,
            r#""Velocity": "4,5""#,
            "write 4.5: with a decimal point",
        ),
        (
            r#""Velocity": 4"#,
            r#""Velocity": LREAL#4.0"#,
            "write 4.0: a number has no type here",
        ),
        (
            r#""Velocity": 4"#,
            r#""Velocity": "LREAL#4.0""#,
            "write 4.0: a number has no type",
        ),
        (r#""Velocity": 4"#, "“Velocity”: 4", "a typographic quote"),
        (
            r#""Velocity": 4"#,
            r#""Velocity": "speed.Velocity""#,
            r#"a wire is written {"from": "speed.Velocity"}"#,
        ),
        (r#""by": 8"#, r#""before": 8"#, "`by` is what it is called here"),
        (r#"{"ge": 0}"#, r#"{">=": 0}"#, "`ge` is what it is called here"),
        (r#"{"ge": 0}"#, r#"">= 0""#, r#"write {"ge": 0}"#),
        (r#"{"ge": 0}"#, r#"{"==": 0}"#, "write the value itself"),
        (
            r#""X.Position": {"ge": 0}"#,
            r#""NOT there.Done": true"#,
            "a condition is a signal and its value",
        ),
    ];
    for (find, replace, remedy) in cases {
        let said = said(find, replace);
        assert!(said.contains(remedy), "{replace}\n{said}");
    }
}

#[test]
fn all_missing_keys_are_told_at_once() {
    let said = read("{}", "a.scan.json", &[]).unwrap_err().to_string();
    for key in ["standstill", "cycle", "scans", "axes", "blocks"] {
        assert!(
            said.contains(&format!("a script needs the key `{key}`")),
            "{said}"
        );
    }
}

/// The codes of all faults of a script.
fn codes(script: &str) -> Vec<&'static str> {
    let error = read(script, "a.scan.json", &[]).unwrap_err();
    let of = |diagnostic: &Diagnostic| diagnostic.code.name();
    error.diagnostics().iter().map(of).collect()
}

#[test]
fn what_follows_from_another_mistake_is_left_out() {
    let slips = said(r#""name": "speed""#, r#""nmae": "speed""#);
    assert!(slips.contains("a block needs the key `name`"), "{slips}");
    let without = SCRIPT.replacen("\"axes\"", "\"axis\"", 1);
    assert_eq!(codes(&without), ["missing_key", "unknown_key"]);
    let slip = SCRIPT.replacen("\"inputs\"", "\"input\"", 1);
    assert_eq!(codes(&slip), ["unknown_key"]);
    let (begin, _) = SCRIPT.split_once("\"inputs\": {").unwrap();
    let (_, end) = SCRIPT[begin.len()..].split_once('}').unwrap();
    assert_eq!(codes(&format!("{begin}\"inputs\": []{end}")), ["wrong_type"]);
}
