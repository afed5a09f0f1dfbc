//! `st`: its messages about a program, and its output.

use crate::support::{scratch, standstill, typed};
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
    let ended = typed(&place, "st build cell.st -o cell.wasm --axis X");
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
    let ended = typed(
        &place,
        "run cell.st --axes m.machine.json --scans 20 --cycle T#2ms",
    );
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    ended.prints("Disabled -> Standstill");
    ended.prints("cell.st: passed, 1 of 1 claims, 20 scans");
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

/// A machine file knows nothing of the programs that are tried with it.
#[test]
fn a_program_without_a_script_gets_a_name_and_a_task_that_are_free() {
    let place = scratch("st_run_free");
    let text = "PROGRAM P\nVAR\n  Feeder : AXIS_REF;\n  Power : MC_Power;\nEND_VAR\nPower(Axis := Feeder, Enable := TRUE);\nEND_PROGRAM\n";
    fs::write(place.join("feeder.st"), text).unwrap();
    let axis = r#"{"limits": {"velocity": 1, "acceleration": 1}}"#;
    let machine = format!(
        r#"{{"standstill": 1, "axes": {{"Feeder": {axis}, "Cell": {axis}}}, "inputs": {{"cell2": false}},
        "tasks": {{"slow": {{"interval": 10}}}}, "blocks": [{{"name": "t", "type": "TON", "task": "slow"}}]}}"#
    );
    fs::write(place.join("m.machine.json"), machine).unwrap();
    let ended = typed(&place, "run feeder.st --axes m.machine.json --scans 20");
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
    ended.prints("Disabled -> Standstill");
    ended.prints("cell3   +Power.Enable");
    fs::write(
        place.join("tasks.st"),
        format!(
            "{text}CONFIGURATION C\n  TASK Main(INTERVAL := T#10ms, PRIORITY := 1);\n  PROGRAM I WITH Main : P;\nEND_CONFIGURATION\n"
        ),
    )
    .unwrap();
    let ended = typed(&place, "run tasks.st --axes m.machine.json --scans 20");
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
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

#[test]
fn files_are_laid_out_in_place_and_only_those_that_change_are_named() {
    let place = scratch("st_fmt");
    fs::write(place.join("good.st"), GOOD).unwrap();
    let ugly = GOOD.replace("Count := Count + 1", "Count:=Count+1");
    fs::write(place.join("ugly.st"), &ugly).unwrap();
    let ended = standstill(&place, &["st", "fmt", "--check", "good.st", "ugly.st"]);
    assert_eq!((ended.status, ended.out.as_str()), (1, "ugly.st\n"));
    assert_eq!(fs::read_to_string(place.join("ugly.st")).unwrap(), ugly);
    let ended = standstill(&place, &["st", "fmt", "good.st", "ugly.st"]);
    assert_eq!((ended.status, ended.out.as_str()), (0, "ugly.st\n"));
    assert_eq!(fs::read_to_string(place.join("ugly.st")).unwrap(), GOOD);
    fs::write(place.join("bad.st"), "PROGRAM P x := ; END_PROGRAM").unwrap();
    let ended = standstill(&place, &["st", "fmt", "bad.st"]);
    assert_eq!(ended.status, 3);
    ended.complains("bad.st:1:16");
}

/// Executed statements are counted in a run beside the judged one.
#[test]
fn a_test_says_which_statements_and_branches_were_executed() {
    let place = scratch("st_coverage");
    let text = "FUNCTION Half : INT
VAR_INPUT x : INT; END_VAR
Half := x / 2;
END_FUNCTION
PROGRAM Cell
VAR_INPUT Go : BOOL; END_VAR
VAR_OUTPUT Count : INT; Kind : INT; END_VAR
IF Go THEN
  Count := Count + 1;
END_IF;
CASE Count OF
  1: Kind := 10;
  2, 3: Kind := 20;
  7: Kind := Half(7);
END_CASE;
END_PROGRAM
";
    fs::write(place.join("cell.st"), text).unwrap();
    let script = |claims: &str| {
        format!(
            r#"{{"standstill": 1, "title": "t", "cycle": "T#10ms", "scans": 5, "golden": false, "axes": {{}}, "blocks": [],
  "programs": {{"cell": {{"st": "cell.st"}}}}, "steps": [{{"at": 2, "set": {{"cell.Go": true}}}}],
  "expect": [{claims}]}}"#
        )
    };
    let path = place.join("a.scan.json");
    fs::write(
        &path,
        script(r#"{"at": 4, "that": {"cell.Count": 3, "cell.Kind": 20}}"#),
    )
    .unwrap();
    let ended = standstill(&place, &["test", "--coverage", "cov.lcov", "a.scan.json"]);
    assert_eq!(ended.status, 0, "{} {}", ended.out, ended.err);
    let line = "  cell.st: not executed: lines 3, 14; a branch not taken: line 11
coverage: 5 of 7 (71.4 %) statements, 5 of 6 (83.3 %) branches: cov.lcov\n";
    ended.prints_last(line);
    let lcov = fs::read_to_string(place.join("cov.lcov")).unwrap();
    let expected = "TN:
SF:cell.st
BRDA:8,2,0,3
BRDA:8,2,1,2
BRDA:11,4,0,1
BRDA:11,4,1,2
BRDA:11,4,2,0
BRDA:11,4,3,2
BRF:6
BRH:5
DA:3,0
DA:8,5
DA:9,3
DA:11,5
DA:12,1
DA:13,2
DA:14,0
LF:7
LH:5
end_of_record
";
    assert_eq!(lcov, expected);
    // With a folder for reports there is a page of the sources.
    let arguments = ["test", "--coverage", "cov.lcov", "--report", "out", "a.scan.json"];
    let ended = standstill(&place, &arguments);
    ended.prints_last("    report: out/coverage.html\n");
    let page = fs::read_to_string(place.join("out/coverage.html")).unwrap();
    for row in [
        "<h2>cell.st</h2>\n<p>5 of 7 (71.4 %) statements, 5 of 6 (83.3 %) branches</p>",
        "<tr class=\"no\"><td class=\"n\">3</td><td class=\"n\">0</td><td>Half := x / 2;</td></tr>",
        "<tr class=\"yes\"><td class=\"n\">9</td><td class=\"n\">3</td><td>  Count := Count + 1;</td></tr>",
        "<tr class=\"part\"><td class=\"n\">11</td>",
        "<tr class=\"\"><td class=\"n\">1</td><td class=\"n\"></td><td>FUNCTION Half : INT</td></tr>",
    ] {
        assert!(page.contains(row), "{row}\n{page}");
    }
    // The trace of the judged run is the same with and without.
    for (name, more) in [("with", &["--coverage", "x.lcov"][..]), ("without", &[][..])] {
        let trace = place.join(name);
        fs::create_dir(&trace).unwrap();
        for file in ["a.scan.json", "cell.st"] {
            fs::copy(place.join(file), trace.join(file)).unwrap();
        }
        let text = fs::read_to_string(trace.join("a.scan.json")).unwrap();
        fs::write(trace.join("a.scan.json"), text.replace("\"golden\": false, ", "")).unwrap();
        let mut arguments = vec!["test", "--accept", "a.scan.json"];
        arguments.extend(more);
        assert_eq!(standstill(&trace, &arguments).status, 0);
    }
    let golden = |name: &str| fs::read(place.join(name).join("a.exact")).unwrap();
    assert_eq!(golden("with"), golden("without"));
}
