//! The answers for the page: the digests of the command line, messages with their places, and refusals
//! with their bounds.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use standstill_playground::{
    BLOCKS_MAX, BYTES_MAX, LINES_MAX, LINK_MAX, check, hand, plan, run, save, share,
};
use standstill_script::suite::{self, Allowed};
use standstill_trace::digest;
use std::collections::BTreeMap;
use std::fs;
use std::path::{Path, PathBuf};

fn scan_tests(folder: &str) -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scan-tests")
        .join(folder)
}

/// A script with the texts below its folder that it names, as the page would send it.
fn project(path: &Path) -> Value {
    let folder = path.parent().expect("a folder");
    let mut files = BTreeMap::new();
    let mut folders = vec![folder.to_owned()];
    while let Some(next) = folders.pop() {
        for entry in fs::read_dir(next).expect("a folder") {
            let file = entry.expect("an entry").path();
            if file.is_dir() {
                folders.push(file);
            } else if [".machine.json", ".st", ".wat", ".csv"]
                .iter()
                .any(|ending| file.to_string_lossy().ends_with(ending))
            {
                let name = file
                    .strip_prefix(folder)
                    .expect("below it")
                    .to_string_lossy()
                    .replace('\\', "/");
                files.insert(name, fs::read_to_string(&file).expect("a text"));
            }
        }
    }
    let text = fs::read_to_string(path).expect("a text");
    // And the texts that those name: files of another script would only make the link longer.
    let (mut named, mut all) = (BTreeMap::new(), text.clone());
    for _ in 0..files.len() {
        for (name, file) in &files {
            let last = name.rsplit('/').next().expect("a name");
            if all.contains(last) && named.insert(name.clone(), file.clone()).is_none() {
                all += file;
            }
        }
    }
    let name = path.file_name().expect("a name").to_string_lossy();
    json!({"name": name, "text": text, "files": named})
}

fn ran(project: &Value) -> Value {
    serde_json::from_str(&run(&project.to_string(), |_, _| true).about).expect("JSON")
}

fn shared(request: &Value) -> Value {
    serde_json::from_str(&share(&request.to_string())).expect("JSON")
}

fn script(scans: u64, more: &str) -> Value {
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": {scans}, "axes": {{"X": {{"limits": {{"velocity": 10, "acceleration": 100}}}}}}{more}}}"#
    );
    json!({"name": "x.scan.json", "text": text})
}

const NO_BLOCKS: &str = r#", "blocks": []"#;

#[test]
fn digests_are_those_of_the_command_line_and_links_hold_them() {
    for folder in ["gallery", "tutorial", "include", "guests", "structured_text"] {
        let paths = suite::find(&scan_tests(folder)).expect("a folder");
        for path in paths.into_iter().step_by(standstill_testkit::stride()) {
            let expected = suite::run_file(&path, &[], &Allowed::default(), |_| {}).expect("a run");
            let project = project(&path);
            let told = ran(&project);
            let expected = format!("{:016x}", digest::whole(&expected.trace));
            assert_eq!(told["digest"], json!(expected), "{}: {told:.300}", path.display());
            let link = shared(&json!({"pack": project}))["link"]
                .as_str()
                .expect("a link")
                .to_owned();
            assert_eq!(shared(&json!({"unpack": link}))["content"], project);
            assert!(
                link.len() <= 8 * 1024,
                "{}: a link of {} characters",
                path.display(),
                link.len()
            );
        }
    }
}

#[test]
fn mistakes_have_their_places() {
    let text = "{\n  \"standstill\": 1, \"cycle\": \"T#1ms\", \"scans\": 5, \"axes\": {}, \"blocks\": [],\n  \"steps\": [{\"at\": 1, \"sett\": {}}]\n}\n";
    let told: Value = serde_json::from_str(&check(&json!({"name": "a.scan.json", "text": text}).to_string()))
        .expect("JSON");
    let found = told["diagnostics"].as_array().expect("a list");
    let found = found
        .iter()
        .find(|found| found["code"] == "unknown_key")
        .expect("the key");
    assert_eq!((&found["from"], &found["to"]), (&json!([3, 23]), &json!([3, 29])));
    assert_eq!(found["file"], "a.scan.json");
    assert!(
        found["help"].as_str().is_some_and(|help| help.contains("set")),
        "{found}"
    );
    assert_eq!(check(&script(5, NO_BLOCKS).to_string()), "{}");
}

#[test]
fn what_is_too_large_is_refused_with_its_bound() {
    let refused = |project: &Value| ran(project)["refused"].as_str().unwrap_or_default().to_owned();
    let long = ran(&script(1_000_000_000, NO_BLOCKS));
    assert_eq!(long["diagnostics"][0]["code"], "too_large", "{long}");
    assert!(refused(&script(2_000_000, NO_BLOCKS)).contains("1000000 of the playground"));
    let many = |count: usize| {
        let blocks: Vec<String> = (0..count)
            .map(|at| format!(r#"{{"name":"b{at}","type":"R_TRIG","pins":{{}}}}"#))
            .collect();
        script(5, &format!(r#", "blocks": [{}]"#, blocks.join(",")))
    };
    assert!(refused(&many(BLOCKS_MAX + 1)).contains("2001 blocks"));
    assert!(refused(&many(100_000)).contains(&format!("the {BYTES_MAX} of the playground")));
    let cells = refused(&{
        let mut wide = many(1_000);
        let text = wide["text"]
            .as_str()
            .expect("a text")
            .replace("\"scans\": 5", "\"scans\": 20000");
        wide["text"] = json!(text);
        wide
    });
    assert!(cells.contains("cells"), "{cells}");
    let lines = "{}\n".repeat(LINES_MAX + 1);
    assert!(plan(&lines).contains("201 lines are more than the 200"));
}

#[test]
fn an_endless_guest_ends() {
    let endless = script(100, r#", "blocks": [], "programs": {"p": {"st": "p.st"}}"#);
    let with = |fuel: &str| {
        let mut project = endless.clone();
        project["text"] = json!(
            project["text"]
                .as_str()
                .expect("a text")
                .replace("\"p.st\"", &format!("\"p.st\"{fuel}"))
        );
        project["files"] = json!({"p.st": "PROGRAM p\nVAR n : INT; END_VAR\nWHILE TRUE DO n := 1; END_WHILE\nEND_PROGRAM\n"});
        ran(&project)
    };
    let told = with("");
    assert!(told["digest"].is_string(), "{told}");
    assert!(
        told["trace"]["events"].to_string().contains("Fault"),
        "{}",
        told["trace"]["events"]
    );
    let told = with(", \"fuel\": 1000000000");
    assert!(
        told["refused"].as_str().is_some_and(|why| why.contains("fuel")),
        "{told}"
    );
}

#[test]
fn a_run_tells_its_progress_and_can_be_ended() {
    let request = script(5_000, NO_BLOCKS).to_string();
    let mut seen = Vec::new();
    run(&request, |scans, of| {
        seen.push((scans, of));
        true
    });
    assert_eq!(
        seen,
        [1_000, 2_000, 3_000, 4_000, 5_000].map(|scans| (scans, 5_000))
    );
    let ended = run(&request, |scans, _| scans < 2_000);
    assert_eq!(ended.about, r#"{"refused":"ended by hand after 2000 scans"}"#);
}

#[test]
fn numbers_come_with_every_bit() {
    let project = project(&scan_tests("tutorial").join("slide.scan.json"));
    let outcome = run(&project.to_string(), |_, _| true);
    let about: Value = serde_json::from_str(&outcome.about).expect("JSON");
    let trace = suite::run_file(
        &scan_tests("tutorial").join("slide.scan.json"),
        &[],
        &Allowed::default(),
        |_| {},
    )
    .expect("a run")
    .trace;
    let rows = trace.scans();
    let mut reals = 0;
    for (index, column) in about["columns"].as_array().expect("columns").iter().enumerate() {
        assert_eq!(column["name"], trace.columns()[index].name.as_str());
        if let Some(at) = column["reals"].as_u64() {
            let at = at as usize;
            let own: Vec<f64> = trace.reals(index).collect();
            assert!(
                own.iter()
                    .zip(&outcome.reals[at..at + rows])
                    .all(|(one, other)| one.to_bits() == other.to_bits())
            );
            reals += rows;
        }
    }
    assert_eq!(outcome.reals.len(), reals);
}

#[test]
fn links_that_cannot_be_read_are_refused_with_the_cause() {
    let link = shared(&json!({"pack": script(5, NO_BLOCKS)}))["link"]
        .as_str()
        .expect("a link")
        .to_owned();
    let why = |link: &str| {
        shared(&json!({"unpack": link}))["refused"]
            .as_str()
            .unwrap_or_default()
            .to_owned()
    };
    for broken in ["", "1", "1.", "x.abc", "1.%%%", &link[..link.len() / 2], "-1.abc"] {
        assert!(why(broken).contains("broken"), "{broken}: {}", why(broken));
    }
    assert!(why(&link.replacen("1.", "2.", 1)).contains("later version"));
    assert!(why(&format!("1.{}", "A".repeat(LINK_MAX))).contains("are read"));
    // A small link that would unpack to more than a script may have.
    let bomb = json!({"pack": {"text": "a".repeat(BYTES_MAX - 100)}});
    assert!(shared(&bomb)["link"].is_string());
    assert!(shared(&json!({"pack": {"text": "a".repeat(BYTES_MAX)}}))["refused"].is_string());
    for request in ["", "[]", "{}", r#"{"pack": 1}"#, r#"{"unpack": 1}"#] {
        assert!(share(request).contains("refused"), "{request}");
    }
}

#[test]
fn every_form_can_be_saved() {
    let request = project(&scan_tests("tutorial").join("slide.scan.json")).to_string();
    let begins = [
        ("csv", "scan,time_ns,"),
        ("vcd", "$"),
        ("svg", "<svg"),
        ("report", "<!doctype html>"),
    ];
    for (form, begin) in begins {
        let told: Value = serde_json::from_str(&save(&request, form)).expect("JSON");
        let text = told["text"].as_str().unwrap_or_default();
        assert!(text.starts_with(begin), "{form}: {told:.200}");
    }
    assert!(save(&request, "pdf").contains("no form pdf"));
    assert!(save(r#"{"name": "a", "text": "{"}"#, "csv").contains("diagnostics"));
}

#[test]
fn lines_are_planned_as_by_the_command_line() {
    let answers = plan(
        "{\"id\": 1, \"Ts\": 0.001, \"target\": 1, \"limits\": {\"velocity\": 1, \"acceleration\": 10}}\n\nno\n",
    );
    let lines: Vec<Value> = answers
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect();
    assert_eq!(lines.len(), 2);
    assert_eq!(
        (&lines[0]["id"], &lines[0]["method"]),
        (&json!(1), &json!("overlapped"))
    );
    assert_eq!(lines[1]["error"]["code"], "invalid_input");
}

#[test]
fn an_axis_led_by_hand_comes_to_its_target_within_its_limits() {
    let limits = json!({"velocity": 100.0, "acceleration": 1000.0, "jerk": 20000.0, "snap": 800000.0});
    let mut axes: Vec<Value> = [2, 3, 4]
        .map(|order| json!({"order": order, "state": [0.0, 0.0, 0.0, 0.0], "load": [0.0, 0.0]}))
        .to_vec();
    for frame in 0..150 {
        // The target reverses while the axes are moving.
        let target = if frame < 20 { 60.0 } else { 40.0 };
        let request = json!({
            "cycle": 0.001, "scans": 16, "target": target, "limits": limits, "before": limits,
            "load": {"rate": 30.0, "damping": 0.05}, "axes": axes,
        });
        let told: Value = serde_json::from_str(&hand(&request.to_string())).expect("JSON");
        for (axis, led) in axes.iter_mut().zip(told["axes"].as_array().expect("axes")) {
            let bound = |index: usize| led["state"][index].as_f64().expect("a number").abs();
            assert!(bound(1) <= 100.0001 && bound(2) <= 1000.001, "{led}");
            axis["state"] = led["state"].clone();
            axis["load"] = led["load"].clone();
        }
    }
    for axis in &axes {
        assert_eq!(axis["state"], json!([40.0, 0.0, 0.0, 0.0]), "{axis}");
    }
    // The purpose of a smoother profile: the load vibrates less behind it.
    let swing = |axis: &Value| (axis["load"][0].as_f64().expect("a number") - 40.0).abs();
    assert!(swing(&axes[2]) < 1.0, "{axes:?}");
    assert!(hand("{}").contains("refused"));
    assert!(hand(r#"{"cycle": 0, "scans": 1, "target": 1, "limits": 1}"#).contains("refused"));
}

#[test]
fn a_program_that_is_no_text_runs_and_what_cannot_be_had_says_why() {
    let folder = scan_tests("guests");
    let path = folder.join("a_guest_moves_an_axis.scan.json");
    let as_text = project(&path);
    let expected = ran(&as_text)["digest"].clone();
    let mut as_bytes = as_text;
    let name = as_bytes["files"].as_object().and_then(|files| {
        let text = as_bytes["text"].as_str()?;
        files
            .keys()
            .find(|name| text.contains(&format!("\"{name}\"")))
            .cloned()
    });
    let name = name.expect("the script names a program");
    let bytes = wat(as_bytes["files"][&name].as_str().expect("a text"));
    as_bytes["files"][&name] = json!({"base64": bytes});
    assert_eq!(ran(&as_bytes)["digest"], expected);
    let why = |project: &Value| ran(project)["diagnostics"][0]["message"].to_string();
    as_bytes["files"][&name] = json!({"base64": "no base64"});
    assert!(why(&as_bytes).contains("it came damaged"), "{}", why(&as_bytes));
    as_bytes["files"]
        .as_object_mut()
        .expect("an object")
        .remove(&name);
    assert!(
        why(&as_bytes).contains("there is no such file here"),
        "{}",
        why(&as_bytes)
    );
    as_bytes["lacks"] = json!({&*name: "a pipe is no file"});
    assert!(why(&as_bytes).contains("a pipe is no file"), "{}", why(&as_bytes));
}

/// A module, from its text, in base64.
fn wat(text: &str) -> String {
    STANDARD.encode(wat::parse_str(text).expect("a module"))
}
