//! Programs of the gallery with one typical fault each: the first line of "why" names the fault.
//!
//! `broken_programs/programs.json` holds the faults: the replacement in the text of the script (or the
//! changed call order), and the words that name the fault. The search for reasons does not use these
//! data.

use super::common::{outcome, scan_tests};
use serde::Deserialize;
use standstill_script::Outcome;
use standstill_script::suite::read_text;

/// The least number of broken programs whose fault is named.
const NAMED_LEAST: usize = 37;
const OF: usize = 41;

#[derive(Deserialize)]
struct Broken {
    kind: String,
    script: String,
    #[serde(default)]
    find: String,
    #[serde(default)]
    replace: String,
    edit: Option<Edit>,
    names: Vec<String>,
}

/// A block that is called too early.
#[derive(Deserialize)]
struct Edit {
    #[serde(rename = "move")]
    block: String,
    before: String,
}

fn broken() -> Vec<Broken> {
    serde_json::from_str(include_str!("broken_programs/programs.json")).unwrap()
}

fn text(script: &str) -> String {
    read_text(&scan_tests().join(format!("gallery/{script}.scan.json"))).unwrap()
}

/// The script with its fault.
fn with_fault(broken: &Broken) -> String {
    let text = text(&broken.script);
    let Some(edit) = &broken.edit else {
        assert_eq!(
            text.matches(&broken.find).count(),
            1,
            "{}: {}",
            broken.script,
            broken.find
        );
        return text.replace(&broken.find, &broken.replace);
    };
    let mut script: serde_json::Value = serde_json::from_str(&text).unwrap();
    let blocks = script["blocks"].as_array_mut().unwrap();
    let place = |blocks: &[serde_json::Value], name: &str| {
        blocks.iter().position(|block| block["name"] == name).unwrap()
    };
    let from = place(blocks, &edit.block);
    let block = blocks.remove(from);
    let to = place(blocks, &edit.before);
    assert!(
        to < from,
        "{} is called before {} already",
        edit.block,
        edit.before
    );
    blocks.insert(to, block);
    script.to_string()
}

fn run_of(broken: &Broken) -> Outcome {
    outcome(&with_fault(broken))
}

#[test]
fn the_first_line_of_why_names_the_fault() {
    let all = broken();
    let mut misses = Vec::new();
    for broken in &all {
        let outcome = run_of(broken);
        let edit = broken.edit.as_ref();
        let edit = edit.map_or(String::new(), |edit| {
            format!("{} before {}", edit.block, edit.before)
        });
        let what = format!("{}: {}: {}{edit}", broken.kind, broken.script, broken.find);
        assert!(!outcome.passed(), "{what}: no claim fails");
        let first = outcome.why.first().map_or("", |reason| reason.text.as_str());
        if !broken.names.iter().all(|name| first.contains(name.as_str())) {
            misses.push(format!("{what}\n    wanted {:?}\n    {first}", broken.names));
        }
    }
    println!("{} misses\n{}", misses.len(), misses.join("\n"));
    assert_eq!(all.len(), OF);
    assert!(all.len() - misses.len() >= NAMED_LEAST, "{}", misses.join("\n"));
}

/// A reason leads to a scan, and to the claims that fail for it.
#[test]
fn a_reason_names_its_scan_and_its_claims() {
    let all = broken();
    let missing = all.iter().find(|broken| broken.script == "gate").unwrap();
    let why = run_of(missing).why;
    assert_eq!(why[0].scan, Some(5));
    assert!(why[0].text.contains("in scan 5"), "{}", why[0].text);
    assert!(why[0].claims.contains(&"expect[0]".to_owned()));
}

#[test]
fn a_run_whose_claims_hold_has_no_reasons() {
    let outcome = outcome(&text("gate"));
    assert!(outcome.passed() && outcome.why.is_empty());
}
