//! `st`: what it says of a program, and what it makes of it.

use crate::support::{scratch, standstill};
use std::fs;

const GOOD: &str = "PROGRAM Cell\nVAR\n  X : AXIS_REF;\nEND_VAR\nVAR_OUTPUT\n  Count : INT;\nEND_VAR\nCount := Count + 1;\nEND_PROGRAM\n";

#[test]
fn a_good_program_is_built_with_its_symbols() {
    let place = scratch("st_build");
    fs::write(place.join("cell.st"), GOOD).unwrap();
    let ended = standstill(&place, &["st", "check", "cell.st"]);
    assert_eq!(
        (ended.status, ended.out.as_str(), ended.err.as_str()),
        (0, "", "")
    );
    let ended = standstill(
        &place,
        &["st", "build", "cell.st", "-o", "cell.wasm", "--axis", "X"],
    );
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert_eq!(ended.out, "cell.wasm\ncell.symbols.json\n");
    assert!(fs::read(place.join("cell.wasm")).unwrap().starts_with(b"\0asm"));
    let table: serde_json::Value =
        serde_json::from_str(&fs::read_to_string(place.join("cell.symbols.json")).unwrap()).unwrap();
    let paths: Vec<_> = table["variables"]
        .as_array()
        .unwrap()
        .iter()
        .map(|it| it["path"].as_str().unwrap())
        .collect();
    assert_eq!(paths, ["Cell.X.Number", "Cell.Count"]);
}

#[test]
fn a_mistake_is_told_as_text_and_as_json_and_nothing_is_written() {
    let place = scratch("st_wrong");
    fs::write(place.join("cell.st"), GOOD.replace(":= Count", "= Count")).unwrap();
    let ended = standstill(&place, &["st", "check", "cell.st"]);
    assert_eq!(ended.status, 3);
    assert!(
        ended.out.contains("cell.st:8:7") && ended.out.contains("assign with `:=`"),
        "{}",
        ended.out
    );
    let ended = standstill(&place, &["st", "check", "--json", "cell.st"]);
    assert_eq!(ended.status, 3);
    let told: serde_json::Value = serde_json::from_str(&ended.out).unwrap();
    let first = &told["diagnostics"][0];
    assert_eq!(
        (&first["line"], &first["column"], &first["code"]),
        (&8.into(), &7.into(), &"syntax".into())
    );
    let ended = standstill(&place, &["st", "build", "cell.st", "-o", "cell.wasm"]);
    assert_eq!(ended.status, 3);
    assert!(!place.join("cell.wasm").exists() && !place.join("cell.symbols.json").exists());
}

#[test]
fn a_program_runs_without_a_script() {
    let place = scratch("st_run");
    let text = "PROGRAM Cell\nVAR\n  X : AXIS_REF;\n  Power : MC_Power;\nEND_VAR\nPower(Axis := X, Enable := TRUE);\nEND_PROGRAM\n";
    fs::write(place.join("cell.st"), text).unwrap();
    let machine = r#"{"standstill": 1, "axes": {"X": {"limits": {"velocity": 1, "acceleration": 1}}}}"#;
    fs::write(place.join("m.machine.json"), machine).unwrap();
    let ended = standstill(
        &place,
        &[
            "run",
            "cell.st",
            "--axes",
            "m.machine.json",
            "--scans",
            "20",
            "--cycle",
            "T#2ms",
        ],
    );
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert!(ended.out.contains("Disabled -> Standstill"), "{}", ended.out);
    assert!(
        ended.out.contains("cell.st: passed, 1 of 1 claims, 20 scans"),
        "{}",
        ended.out
    );
    for (arguments, status) in [
        (&["run", "gone.st"][..], 4),
        (&["run", "cell.st", "--axes", "gone.json"], 4),
        (&["run", "cell.st", "a.scan.json"], 2),
        (&["run", "a.scan.json", "--scans", "3"], 2),
        (&["run", "cell.st", "--cycle", "T#0ms"], 2),
    ] {
        assert_eq!(standstill(&place, arguments).status, status, "{arguments:?}");
    }
}

#[test]
fn what_is_probably_not_meant_is_told_by_its_code() {
    let place = scratch("st_lint");
    let text = "PROGRAM Cell\nVAR\n  a, b : LREAL;\n  same : BOOL;\nEND_VAR\nsame := a = b;\nEND_PROGRAM\n";
    fs::write(place.join("cell.st"), text).unwrap();
    let ended = standstill(&place, &["st", "check", "cell.st"]);
    assert_eq!((ended.status, ended.out.as_str()), (0, ""));
    let ended = standstill(&place, &["st", "lint", "cell.st"]);
    assert_eq!(ended.status, 1);
    assert!(
        ended.out.contains("warning[ST55]") && ended.out.contains("cell.st:6:11"),
        "{}",
        ended.out
    );
    let quiet = text.replace("VAR\n", "VAR {lint off ST55}\n");
    fs::write(place.join("cell.st"), quiet).unwrap();
    let ended = standstill(&place, &["st", "lint", "--json", "cell.st"]);
    assert_eq!(ended.status, 0, "{}", ended.out);
}
