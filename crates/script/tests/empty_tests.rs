//! Every kind of part that tests nothing is reported with its place; others are not. Claims detect
//! mutants.

use super::common::{scan_tests, script};
use standstill_script::mutate::{Fate, mutants};
use standstill_script::suite::{Allowed, find, run_script};
use standstill_script::{WarningKind, Warnings, run, warnings};
use std::fs;
use std::path::Path;
use std::thread;

/// A script in which every item tests something.
const SOUND: &str = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 100, "inputs": {"go": false, "stop": false},
"axes": {"X": {"limits": {"velocity": 100, "acceleration": 10000}, "state": "Standstill"}},
"blocks": [{"name": "move", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "go"}, "Position": 4, "Velocity": 100}},
{"name": "halt", "type": "MC_Halt", "pins": {"Axis": "X", "Execute": {"from": "stop"}}}],
"steps": [{"at": 1, "set": {"go": true}}, {"when": {"move.Done": true}, "set": {"stop": true}}],
"expect": [{"by": 90, "that": {"move.Done": true, "X.Position": 4}}, {"by": 99, "that": {"halt.Done": true}}]}"#;

fn warned(text: &str) -> Warnings {
    let script = script(text);
    let outcome = run(&script).unwrap_or_else(|error| panic!("{error}"));
    assert!(outcome.passed(), "{:#?}", outcome.verdicts);
    warnings(&script, &outcome, false)
}

/// The lines of the one warning that the script has with one piece replaced.
#[track_caller]
fn told(find: &str, replace: &str, path: &str, words: &str) {
    assert_eq!(SOUND.matches(find).count(), 1, "{find}");
    let warnings = warned(&SOUND.replace(find, replace));
    let lines: Vec<_> = warnings.lines().collect();
    let found = lines
        .iter()
        .find(|line| line.starts_with(&format!("{path} (")) && line.contains(words));
    assert!(found.is_some(), "{replace}: {lines:#?}");
    assert!(warnings.count());
}

/// Adds a claim.
#[track_caller]
fn claim(claim: &str, words: &str) {
    told(
        r#"{"by": 99, "that": {"halt.Done": true}}"#,
        &format!(r#"{{"by": 99, "that": {{"halt.Done": true}}}}, {claim}"#),
        "expect[2]",
        words,
    );
}

#[test]
fn a_script_that_tests_something_has_no_warnings() {
    assert_eq!(warned(SOUND).all, []);
}

#[test]
fn steps_inputs_blocks_and_axes_that_do_nothing_are_told() {
    let end = r#""set": {"stop": true}}]"#;
    let more = |step: &str| format!(r#""set": {{"stop": true}}}}, {step}]"#);
    told(
        end,
        &more(r#"{"when": {"X.Position": {"gt": 5}}, "set": {"go": false}}"#),
        "steps[2]",
        "held in no scan",
    );
    told(
        end,
        &more(r#"{"when": {"move.Done": true}, "after": 99, "set": {"go": false}}"#),
        "steps[2]",
        "the run ended with scan 99",
    );
    told(
        r#""stop": false"#,
        r#""stop": false, "lamp": false"#,
        "inputs.lamp",
        "is read by no wire",
    );
    let block = r#"{"name": "halt", "type""#;
    let spare = |more: &str| {
        format!(r#"{{"name": "spare", "type": "MC_Halt", "pins": {{"Axis": "X"}}{more}}}, {block}"#)
    };
    told(block, &spare(""), "blocks[1]", "never commanded");
    let unstarted = SOUND
        .replace(
            r#""inputs": {"#,
            r#""tasks": {"main": {"interval": "T#1ms"}, "late": {"single": {"from": "call"}}}, "inputs": {"call": false, "#,
        )
        .replace(
            r#"{"name": "halt", "type""#,
            r#"{"name": "spare", "type": "MC_ReadStatus", "task": "late", "pins": {"Axis": "X", "Enable": true}},
{"name": "halt", "type""#,
        );
    let warnings = warned(&unstarted);
    let lines: Vec<_> = warnings.lines().collect();
    assert!(
        lines[0].starts_with("blocks[1] (")
            && lines[0].ends_with("spare is never called: its task never runs"),
        "{lines:#?}"
    );
    told(
        r#""axes": {"#,
        r#""axes": {"Y": {"limits": {"velocity": 1, "acceleration": 1}}, "#,
        "axes.Y",
        "no block commands",
    );
}

#[test]
fn claims_that_ask_for_nothing_are_told() {
    claim(
        r#"{"always": {"X.Position": 4}, "while": {"X.Position": {"gt": 5}}}"#,
        "`while` held in no scan",
    );
    claim(
        r#"{"never": {"move.Error": true}, "from": {"when": {"X.Position": {"gt": 5}}}}"#,
        "window",
    );
    claim(
        r#"{"when": {"move.Error": true}, "within": 3, "that": {"move.Done": true}}"#,
        "asks for nothing",
    );
    claim(
        r#"{"duration": [{"move.Error": true}, {"move.Done": true}], "le": 3}"#,
        "asks for nothing",
    );
    claim(
        r#"{"never": {"move.Busy": true}, "for": 1000}"#,
        "fewer than `for`",
    );
    claim(
        r#"{"never": {"move.Busy": true}, "for": 20, "from": 5, "to": 15}"#,
        "11 rows on end at most",
    );
    claim(
        r#"{"always": {"move.Position": 4}}"#,
        "no wire and no step writes it",
    );
    claim(
        r#"{"always": "=move.Velocity > 3.0"}"#,
        "no wire and no step writes it",
    );
    claim(
        r#"{"always": {"X.Position": {"near": 2, "within": 6}}}"#,
        "all values lie within 4",
    );
    told(
        r#""expect": [{"by": 90, "that": {"move.Done": true, "X.Position": 4}}, {"by": 99, "that": {"halt.Done": true}}]"#,
        r#""expect": []"#,
        "expect",
        "no claims and no golden",
    );
}

#[test]
fn what_is_meant_is_not_told() {
    let text = SOUND.replace(
        r#"{"by": 99, "that": {"halt.Done": true}}"#,
        r#"{"by": 99, "that": {"halt.Done": true}}, {"always": {"move.Position": 4}, "vacuous": "allowed"}"#,
    );
    assert_eq!(warned(&text).all, []);
}

/// A script in a folder of its own.
fn folder(name: &str, files: &[(&str, &str)]) -> std::path::PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).unwrap();
    for (name, text) in files {
        fs::write(folder.join(name), text).unwrap();
    }
    folder.join(files[0].0)
}

#[test]
fn what_the_compiler_finds_doubtful_in_a_program_is_told() {
    let script = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 5, "axes": {}, "blocks": [],
"programs": {"cell": {"st": "cell.st"}}, "expect": [{"at": 4, "that": {"cell.n": 5}}]}"#;
    let program = "PROGRAM main\nVAR n : INT; END_VAR\n{sparkle}\nn := n + 1;\nEND_PROGRAM\n";
    let path = folder("doubtful", &[("a.scan.json", script), ("cell.st", program)]);
    let (script, outcome) = run_script(&path, &[], &Allowed::default(), |_| {}).unwrap();
    assert!(outcome.passed(), "{:#?}", outcome.verdicts);
    let told = warnings(&script, &outcome, false);
    let kinds: Vec<_> = told.all.iter().map(|warning| warning.kind).collect();
    assert_eq!(kinds, [WarningKind::Doubtful], "{told}");
    assert_eq!(told.all[0].path, "programs.cell");
    assert!(told.count());
    let line = told.lines().next().unwrap();
    assert!(
        line.contains("cell.st:3:1: the pragma `sparkle` is not known and has no effect"),
        "{line}"
    );
}

/// Numbers in a table are numbers at a pin.
#[test]
fn the_numbers_of_a_table_are_changed_and_claims_notice() {
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 400, "inputs": {"go": false},
"axes": {"X": {"limits": {"velocity": 400, "acceleration": 20000}, "state": "Standstill"}},
"blocks": [{"name": "dose", "type": "MC_PositionProfile", "pins": {"Axis": "X", "Execute": {"from": "go"},
"TimePosition": [{"DeltaTime": "T#100ms", "Position": 6}, {"DeltaTime": "T#100ms", "Position": 0}]}}],
"steps": [{"at": 1, "set": {"go": true}}],
"expect": [{"once": {"X.Position": 6}}, {"duration": [{"dose.Busy": true}, {"dose.Done": true}], "ge": 200, "le": 200}]}"#;
    let script = script(text);
    let original = run(&script).unwrap();
    assert!(original.passed(), "{:#?}", original.verdicts);
    let all = mutants(&script, 1, 500);
    let of_table: Vec<_> = all
        .iter()
        .filter(|mutant| mutant.path.contains("TimePosition["))
        .collect();
    let listed: Vec<_> = of_table
        .iter()
        .map(|mutant| format!("{}: {}", mutant.path, mutant.says))
        .collect();
    let cell = |record: usize, field: &str, says: &str| {
        format!("blocks[0].pins.TimePosition[{record}].{field}: {says}")
    };
    assert_eq!(
        listed,
        [
            cell(0, "DeltaTime", "T#100ms to T#90ms"),
            cell(0, "DeltaTime", "T#100ms to T#110ms"),
            cell(0, "Position", "6.0 to 5.4"),
            cell(0, "Position", "6.0 to 6.6000000000000005"),
            cell(1, "DeltaTime", "T#100ms to T#90ms"),
            cell(1, "DeltaTime", "T#100ms to T#110ms"),
        ]
    );
    for mutant in of_table {
        let fate = mutant.judge(&script, &original);
        assert!(matches!(fate, Fate::Killed(_)), "{}: {fate:?}", mutant.path);
    }
}

/// This is a note, for which no strict test fails: the homing may be intended to reverse at a limit switch.
#[test]
fn a_reference_behind_the_search_is_a_note() {
    let gallery = scan_tests().join("gallery");
    let text = fs::read_to_string(gallery.join("homing_then_production.scan.json")).unwrap();
    let notes = |text: &str| -> Vec<String> {
        let script = script(text);
        let outcome = run(&script).unwrap();
        let all = warnings(&script, &outcome, true).all.into_iter();
        let notes = all.filter(|warning| warning.kind == WarningKind::Note);
        notes
            .map(|note| {
                assert!(!note.counts());
                format!("{}: {}", note.path, note.message)
            })
            .collect()
    };
    assert_eq!(notes(&text), [""; 0]);
    let turned = text.replace("\"direction\": \"negative\"", "\"direction\": \"positive\"");
    let told = notes(&turned);
    assert!(
        told.len() == 1 && told[0].starts_with("axes.X: the home switch of X") && told[0].contains("behind"),
        "{told:?}"
    );
}

/// Users start from the gallery, so its claims must be good.
#[test]
fn every_script_of_the_gallery_kills_four_of_five_mutants() {
    let gallery = scan_tests().join("gallery");
    let scripts = find(&gallery).unwrap();
    assert!(scripts.len() >= 15, "{scripts:?}");
    let scores = thread::scope(|scope| {
        let each: Vec<_> = scripts
            .iter()
            .step_by(standstill_testkit::stride())
            .map(|path| scope.spawn(move || (path, score(path))))
            .collect();
        each.into_iter()
            .map(|score| score.join().unwrap())
            .collect::<Vec<_>>()
    });
    for (path, [killed, survived]) in scores {
        assert!(
            killed > 0 && killed * 5 >= (killed + survived) * 4,
            "{}: {killed} killed, {survived} survived",
            path.display()
        );
    }
}

/// How many mutants of a script are killed, and how many survive.
fn score(path: &Path) -> [usize; 2] {
    let (script, original) = run_script(path, &[], &Allowed::default(), |_| {}).unwrap();
    let fates: Vec<Fate> = mutants(&script, 1, standstill_testkit::whole_or(500, 10))
        .iter()
        .map(|mutant| mutant.judge(&script, &original))
        .collect();
    let killed = fates.iter().filter(|fate| matches!(fate, Fate::Killed(_)));
    let survived = fates.iter().filter(|fate| **fate == Fate::Survived);
    [killed.count(), survived.count()]
}
