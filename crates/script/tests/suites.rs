//! Folders of scripts: the found scripts, and the effect of each mode on goldens.

use super::common::scan_tests;
use serde_json::{Value, json};
use standstill_script::golden::{Mode, Standing};
use standstill_script::read;
use standstill_script::suite::{
    Allowed, Report, SuiteError, Texts, find, find_texts, judge_file, name, orphans, shown,
};
use standstill_testkit::stride;
use standstill_trace::compare::{Tolerance, Yardstick};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder of its own for one test, removed at its end.
struct Folder(PathBuf);

impl Folder {
    fn new(test: &str) -> Self {
        let path = Path::new(env!("CARGO_TARGET_TMPDIR")).join(test);
        let _ = fs::remove_dir_all(&path);
        fs::create_dir_all(&path).expect("the folder is ours");
        Self(path)
    }

    fn write(&self, file: &str, text: &str) -> PathBuf {
        let path = self.0.join(file);
        fs::create_dir_all(path.parent().expect("a file has a folder")).expect("the folder is ours");
        fs::write(&path, text).expect("the folder is ours");
        path
    }

    /// Names of all files, sorted.
    fn files(&self) -> Vec<String> {
        let mut names: Vec<_> = fs::read_dir(&self.0)
            .expect("the folder is there")
            .map(|entry| {
                entry
                    .expect("readable")
                    .file_name()
                    .to_string_lossy()
                    .into_owned()
            })
            .collect();
        names.sort();
        names
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = fs::remove_dir_all(&self.0);
    }
}

/// A move to this position, claimed to be Done in scan 11.
fn script(position: f64) -> String {
    format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 20,
            "axes": {{"X": {{"limits": {{"velocity": 1000, "acceleration": 1000000}}, "state": "Standstill"}}}},
            "blocks": [{{"name": "m", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": true, "Position": {position}, "Velocity": 1000}}}}],
            "expect": [{{"at": 11, "that": {{"m.Done": true}}}}]}}"#
    )
}

fn judged(path: &Path, mode: Mode) -> Report {
    judged_by(path, mode, Yardstick::Exact)
}

fn judged_by(path: &Path, mode: Mode, yardstick: Yardstick) -> Report {
    judge_file(path, mode, yardstick, &Allowed::default(), |_| {}).unwrap_or_else(|error| panic!("{error}"))
}

fn failed(report: &Report) -> &str {
    match &report.golden {
        Standing::Failed(why) => why,
        other => panic!("{other:?}"),
    }
}

#[test]
fn a_missing_golden_fails_and_is_only_proposed_where_it_may_be_reviewed() {
    let folder = Folder::new("missing");
    let path = folder.write("x.scan.json", &script(10.0));
    let report = judged(&path, Mode::Check);
    assert!(!report.passed());
    assert_eq!(failed(&report), "there is no golden yet");
    assert_eq!(folder.files(), ["x.scan.json"]);
    let report = judged(&path, Mode::Propose);
    assert!(!report.passed());
    assert!(failed(&report).contains("standstill test --accept"), "{report}");
    assert_eq!(folder.files(), ["x.scan.json", "x.snap.new"]);
    let report = judged(&path, Mode::Accept);
    assert_eq!(report.golden, Standing::Accepted);
    assert_eq!(folder.files(), ["x.exact", "x.scan.json", "x.snap"]);
    for mode in [Mode::Check, Mode::Propose, Mode::Accept] {
        assert_eq!(judged(&path, mode).golden, Standing::Same, "{mode:?}");
    }
}

#[test]
fn a_run_that_differs_names_scan_signal_and_values() {
    let folder = Folder::new("differs");
    let path = folder.write("x.scan.json", &script(10.0));
    judged(&path, Mode::Accept);
    folder.write("x.scan.json", &script(10.000000000000002));
    let report = judged(&path, Mode::Check);
    assert!(report.outcome.passed());
    let why = failed(&report);
    assert!(why.contains("scan 0"), "{why}");
    assert!(why.contains("m.Position"), "{why}");
    assert!(why.contains("10.000000000000002"), "{why}");
    assert!(why.contains("ULP"), "{why}");
    assert_eq!(folder.files(), ["x.exact", "x.scan.json", "x.snap"]);
}

/// A change by an upgrade that no machine notices: an ULP of a set-point passes, a scan of an edge does not.
#[test]
fn by_events_a_golden_admits_close_set_points_and_nothing_else() {
    let folder = Folder::new("by_events");
    let close = Yardstick::Events(Tolerance::default());
    let path = folder.write("x.scan.json", &script(10.0));
    judged(&path, Mode::Accept);
    let golden = fs::read(folder.0.join("x.snap")).expect("accepted");
    assert_eq!(judged_by(&path, Mode::Check, close).golden, Standing::Same);
    folder.write("x.scan.json", &script(10.000000000000002));
    for mode in [Mode::Check, Mode::Propose, Mode::Accept] {
        let report = judged_by(&path, mode, close);
        assert!(report.passed());
        let Standing::Close(Some(how)) = &report.golden else {
            panic!("{:?}", report.golden)
        };
        assert!(how.values > 0 && how.apart > 0.0 && how.apart < 1e-6, "{how}");
        assert_eq!(
            fs::read(folder.0.join("x.snap")).expect("there"),
            golden,
            "{mode:?}"
        );
        assert_eq!(folder.files(), ["x.exact", "x.scan.json", "x.snap"], "{mode:?}");
    }
    folder.write("x.scan.json", &script(9.99999));
    let report = judged_by(&path, Mode::Check, close);
    let why = failed(&report);
    assert!(why.contains("first difference in scan 0"), "{why}");
    assert!(why.contains("found 9.99999  (may be 1.0e-6 apart)"), "{why}");
    let wide = Yardstick::Events(Tolerance {
        absolute: 0.0,
        relative: 1e-7,
    });
    assert!(
        !judged_by(&path, Mode::Check, wide).passed(),
        "seven digits are not the same"
    );
    let wider = Yardstick::Events(Tolerance {
        absolute: 10.0,
        relative: 1e-5,
    });
    assert!(judged_by(&path, Mode::Check, wider).passed());
    // One scan later is another behaviour, for any tolerance.
    let late = script(10.0)
        .replace("\"pins\"", "\"task\": \"main\", \"pins\"")
        .replace(
            "\"blocks\"",
            "\"tasks\": {\"main\": {\"interval\": 2}}, \"blocks\"",
        );
    folder.write("x.scan.json", &late.replace("\"at\": 11", "\"at\": 12"));
    let report = judged_by(&path, Mode::Check, wider);
    assert!(report.outcome.passed(), "{report}");
    let why = failed(&report);
    assert!(why.contains("first difference in scan 11"), "{why}");
    assert!(why.contains("m.Done    expected TRUE   found FALSE"), "{why}");
    assert!(why.contains("events: - golden, + this run\n"), "{why}");
    assert!(!why.contains("digest"), "only events are told: {why}");
    // Accepting writes a change that a machine would notice.
    assert_eq!(judged_by(&path, Mode::Accept, wider).golden, Standing::Accepted);
    // Without its companion a golden has no set-points to compare with.
    fs::remove_file(folder.0.join("x.exact")).expect("it was written");
    folder.write("x.scan.json", &script(10.000000000000002));
    let report = judged_by(&path, Mode::Check, close);
    assert!(
        failed(&report).contains("set-points cannot be compared: there is no exact trace"),
        "{report}"
    );
}

#[test]
fn a_script_whose_claims_fail_gets_no_golden() {
    let folder = Folder::new("refused");
    let path = folder.write("x.scan.json", &script(30.0));
    for mode in [Mode::Accept, Mode::Propose, Mode::Check] {
        let report = judged(&path, mode);
        assert!(!report.passed());
        assert!(
            report.to_string().starts_with("expect[0].that.m.Done: "),
            "{report}"
        );
        assert!(matches!(report.golden, Standing::Failed(_)));
        assert_eq!(folder.files(), ["x.scan.json"], "{mode:?}");
    }
}

/// This is how cargo-insta accepts: the proposal becomes the snapshot, and the exact trace is not changed.
#[test]
fn a_snapshot_accepted_elsewhere_gets_its_exact_trace_outside_ci() {
    let folder = Folder::new("insta");
    let path = folder.write("x.scan.json", &script(10.0));
    judged(&path, Mode::Propose);
    fs::rename(folder.0.join("x.snap.new"), folder.0.join("x.snap")).expect("it was proposed");
    let report = judged(&path, Mode::Check);
    assert!(failed(&report).contains("exact trace"), "{report}");
    assert_eq!(judged(&path, Mode::Propose).golden, Standing::Accepted);
    assert_eq!(judged(&path, Mode::Check).golden, Standing::Same);
}

#[test]
fn scripts_are_found_in_sorted_order_and_orphans_reported() {
    let folder = Folder::new("found");
    let scripts = ["b/z.scan.json", "a.scan.json", "b/a.scan.json", "b.scan.json"];
    for file in scripts {
        folder.write(file, "");
    }
    for file in [
        "a.snap",
        "b/z.exact",
        "c.snap",
        "b/c.exact",
        "b/d.snap.new",
        "note.txt",
    ] {
        folder.write(file, "");
    }
    let of_insta = |source: &str| format!("---\nsource: {source}\nexpression: text\n---\nsource: x\n");
    folder.write("b/units__text.snap", &of_insta("src/units.rs"));
    folder.write("b/gone.snap", &of_insta("\"gone.scan.json\""));
    let names =
        |paths: Vec<PathBuf>| -> Vec<String> { paths.iter().map(|path| name(&folder.0, path)).collect() };
    let found = find(&folder.0).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(names(found), ["a", "b/a", "b/z", "b"]);
    let lonely = orphans(&folder.0).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(
        names(lonely),
        ["b/c.exact", "b/d.snap.new", "b/gone.snap", "c.snap"]
    );
    assert!(matches!(
        find(&folder.0.join("nowhere")),
        Err(SuiteError::Io { .. })
    ));
}

#[test]
fn what_is_no_script_is_told_apart_from_what_cannot_be_read() {
    let folder = Folder::new("broken");
    let judge = |file: &str| {
        judge_file(
            &folder.0.join(file),
            Mode::Check,
            Yardstick::Exact,
            &Allowed::default(),
            |_| {},
        )
    };
    assert!(matches!(judge("nowhere.scan.json"), Err(SuiteError::Io { .. })));
    folder.write("broken.scan.json", "{,}");
    assert!(matches!(judge("broken.scan.json"), Err(SuiteError::Script(_))));
    fs::write(folder.0.join("bytes.scan.json"), [b'{', 0xff]).expect("the folder is ours");
    let error = judge("bytes.scan.json").map(|_| ()).unwrap_err();
    assert!(
        error
            .to_string()
            .contains("not UTF-8 after 1 bytes: it looks like Latin-1"),
        "{error}"
    );
    for (bytes, valid) in [(&b"\xff\xfe{\0}\0"[..], 0), (b"{\0}\0", 1)] {
        fs::write(folder.0.join("bytes.scan.json"), bytes).expect("the folder is ours");
        let error = judge("bytes.scan.json").map(|_| ()).unwrap_err().to_string();
        assert!(
            error.contains(&format!("after {valid} bytes: it looks like UTF-16")),
            "{error}"
        );
    }
}

/// What `standstill fmt` makes of a script of the suite is the script.
#[test]
fn the_scripts_of_the_suite_are_in_the_canonical_layout() {
    let files = find_texts(&scan_tests()).unwrap();
    assert!(files.len() > 450, "{}", files.len());
    for file in files {
        let text = fs::read_to_string(&file).unwrap();
        let name = shown(&file);
        let laid_out = standstill_script::format(&text, &name).unwrap_or_else(|error| panic!("{error}"));
        assert!(text == laid_out, "{name}: run `standstill fmt scan-tests`");
    }
}

/// Goldens as version 1 wrote them, kept beside this test. They pass and show the command that renews them. That
/// command renews them.
#[test]
fn goldens_of_version_1_are_met_and_say_how_they_are_renewed() {
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../script/tests/version_1");
    let folder = Folder::new("version_1");
    for entry in fs::read_dir(&kept).expect("it is there") {
        let file = entry.expect("readable").path();
        let name = file.file_name().expect("a file has a name");
        fs::copy(&file, folder.0.join(name)).expect("the folder is ours");
    }
    let scripts = find(&folder.0).expect("it is there");
    assert_eq!(scripts.len(), 3);
    for script in &scripts {
        let golden =
            |path: &Path| fs::read(path.with_extension("").with_extension("snap")).expect("it is there");
        let before = golden(script);
        for mode in [Mode::Check, Mode::Propose] {
            let report = judged(script, mode);
            let Standing::Old(note) = &report.golden else {
                panic!("{:?}", report.golden)
            };
            let command = format!("standstill test --accept {}", shown(script));
            assert!(report.passed() && note.ends_with(&command), "{note}");
            assert_eq!(golden(script), before, "nothing is written");
        }
        // One scan of another length is another run.
        let text = fs::read_to_string(script).expect("it is there");
        let cycle = text.replacen("\"cycle\": \"T#", "\"cycle\": \"T#1", 1);
        assert_ne!(cycle, text);
        fs::write(script, cycle).expect("the folder is ours");
        let changed = judged(script, Mode::Check);
        assert!(failed(&changed).contains("differs from its golden"), "{changed}");
        fs::write(script, text).expect("the folder is ours");
        assert_eq!(judged(script, Mode::Accept).golden, Standing::Accepted);
        assert_ne!(golden(script), before);
        assert_eq!(judged(script, Mode::Check).golden, Standing::Same);
    }
}

/// Replaces each number below a node by the use of a parameter.
fn name_numbers(node: &mut Value, parameters: &mut Vec<(String, f64)>) {
    match node {
        Value::Number(number) => {
            let name = format!("p{}", parameters.len());
            parameters.push((name.clone(), number.as_f64().expect("a number")));
            *node = json!({ "param": name });
        }
        Value::Array(items) => items.iter_mut().for_each(|item| name_numbers(item, parameters)),
        Value::Object(members) => members
            .values_mut()
            .for_each(|node| name_numbers(node, parameters)),
        Value::Null | Value::Bool(_) | Value::String(_) => {}
    }
}

/// Replaces every number of the axes of every script by a parameter, and then every number of its blocks.
#[test]
fn a_script_with_other_values_is_what_reading_it_with_them_gives() {
    let folder = Folder::new("other_values");
    let scripts = find(&scan_tests()).expect("there are scripts");
    let (mut good, mut refused) = (0, 0);
    for (place, key) in scripts
        .iter()
        .flat_map(|script| [(script, "axes"), (script, "blocks")])
        .step_by(stride())
    {
        let mut script: Value =
            serde_json::from_str(&fs::read_to_string(place).expect("readable")).expect("JSON");
        if script.get("parameters").is_some() {
            continue;
        }
        let mut own = Vec::new();
        script
            .get_mut(key)
            .into_iter()
            .for_each(|node| name_numbers(node, &mut own));
        script["parameters"] = own
            .iter()
            .cloned()
            .map(|(name, value)| (name, json!(value)))
            .collect();
        let text = script.to_string();
        let path = folder.write("a.scan.json", &text);
        // Scripts with files beside them are left out, and so are those with numbers that cannot be parameters.
        let Ok((texts, mut varied)) = Texts::read(&path, &Allowed::default()) else {
            continue;
        };
        // A compiled program contains its place in memory.
        if !varied.formulas.is_empty() {
            continue;
        }
        for factor in [0.5, -1.0, 1.0, 1.0 / 3.0] {
            let values: Vec<_> = own
                .iter()
                .map(|(name, value)| (name.clone(), value * factor))
                .collect();
            let found = texts.vary(&mut varied, &values).map(|()| format!("{varied:?}"));
            let wanted = read(&text, &shown(&path), &values).map(|script| format!("{script:?}"));
            match &wanted {
                Ok(_) => good += 1,
                Err(_) => refused += 1,
            }
            let tell = |result: Result<String, _>| result.map_err(|error| format!("{error:?}"));
            let is_same = tell(found) == tell(wanted);
            assert!(is_same, "{key} of {} by {factor}", place.display());
        }
    }
    let stride = stride();
    assert!(good > 2000 / stride && refused > 200 / stride, "{good} {refused}");
}
