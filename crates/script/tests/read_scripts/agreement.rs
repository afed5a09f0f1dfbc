//! The schema and the reader accept the same scripts: every value of three scripts is replaced by others,
//! every key omitted, and an unknown key added to every object; in plain `cargo test` some of all that.

use super::cases::GOOD;
use serde_json::{Value, json};
use standstill_script::{read, schema};
use standstill_testkit::peers::Schema;
use std::collections::BTreeMap;

const TEXTS: [&str; 3] = [
    GOOD,
    include_str!("contract_example.scan.json"),
    include_str!("every_key.scan.json"),
];

/// What only the reader can know, by a piece of its message: names, the types of signals, and what is compared with something
/// elsewhere in the script or with the cycle.
const ONLY_THE_READER: &[&str] = &[
    "a period takes from 4 to 4096 cycles",
    "there is no input variable or instance",
    "there is no axis, input variable or instance",
    "there is no axis state",
    "the script has no ",
    "the name `",
    "` (",
    "an expression gives no AXIS_REF",
    "is an axis: here",
    "an axis has no signal",
    "has no element",
    "two writers on",
    "but the run's last scan is",
    "the range ends with scan",
    "is no whole multiple of the cycle",
    "half a turn or more",
    "scans: it must be from",
    "are averaged",
    "above the axis limit",
    "above homing.velocity",
    "the procedure ",
    "min must be below max",
    ", above `",
    "of `rated_torque`",
    "give a number below `",
    "for the cycle",
    "a shorter cycle",
    "which cannot keep",
    "only a CiA 402 drive has",
    "this drive tells no torque",
    "`report.position` is",
    "`within` takes a number",
    "cannot be wired from",
];

/// What is put in place of a value.
fn candidates() -> Vec<Value> {
    let texts = [
        "",
        "X",
        "go",
        "NaN",
        "Infinity",
        "-Infinity",
        "T#0s",
        "T#1ms",
        "T#500ms",
        "T#-5ms",
        "error",
        "Standstill",
        "Homing",
        "positive",
        "=1",
    ];
    let numbers = [
        0.0,
        -0.0,
        1.0,
        -1.0,
        0.5,
        2.0,
        1.5,
        3.0,
        16.0,
        17.0,
        64.0,
        65.0,
        65_535.0,
        65_536.0,
        4_294_967_295.0,
        4_294_967_296.0,
        9_007_199_254_740_992.0,
        1e16,
        1e300,
        5e-324,
        f64::MAX,
        f64::MIN,
        1e-9,
        -1e300,
    ];
    let others = [
        Value::Null,
        json!(true),
        json!(false),
        json!([]),
        json!([1]),
        json!(["X"]),
        json!({}),
        json!({"note": "why"}),
        json!({"note": 1}),
        json!({"param": "v"}),
        json!({"param": 1}),
        json!({"from": "GO"}),
        json!({"when": {"X.Velocity": 0}}),
    ];
    let texts = texts.iter().map(|text| json!(text));
    texts
        .chain(numbers.iter().map(|number| json!(number)))
        .chain(others)
        .collect()
}

/// The paths of all values.
fn paths(value: &Value, at: &str, all: &mut Vec<String>) {
    all.push(at.to_owned());
    match value {
        Value::Object(members) => {
            for (key, value) in members {
                paths(
                    value,
                    &format!("{at}/{}", key.replace('~', "~0").replace('/', "~1")),
                    all,
                );
            }
        }
        Value::Array(items) => {
            for (index, value) in items.iter().enumerate() {
                paths(value, &format!("{at}/{index}"), all);
            }
        }
        _ => {}
    }
}

/// A script with one thing changed, and what was; as many of them as a search tries.
fn variants(text: &str) -> Vec<(String, Value)> {
    let whole: Value = serde_json::from_str(text).unwrap();
    let mut places = Vec::new();
    paths(&whole, "", &mut places);
    let mut all = Vec::new();
    let mut number = 0;
    let mut is_tried = || {
        number += 1;
        number % step() == 0
    };
    let candidates = candidates();
    for place in &places {
        for candidate in &candidates {
            if !is_tried() {
                continue;
            }
            let mut other = whole.clone();
            *other.pointer_mut(place).unwrap() = candidate.clone();
            all.push((format!("{place} = {candidate}"), other));
        }
        let mut other = whole.clone();
        if let Some(members) = other.pointer_mut(place).and_then(Value::as_object_mut) {
            for key in members.keys().cloned().collect::<Vec<_>>() {
                if !is_tried() {
                    continue;
                }
                let mut without = whole.clone();
                let members = without.pointer_mut(place).and_then(Value::as_object_mut).unwrap();
                members.remove(&key);
                all.push((format!("{place} without {key}"), without));
            }
            members.insert("surplus".to_owned(), json!(1));
            all.push((format!("{place} with a surplus key"), other));
        }
    }
    all
}

/// Every variant of a text is tried, or in a short run every 41st.
fn step() -> usize {
    standstill_testkit::whole_or(1, 41)
}

#[test]
fn the_schema_and_the_reader_accept_the_same() {
    let Some(validator) = Schema::new(&schema()) else {
        return;
    };
    let mut differing = Vec::new();
    let mut known = BTreeMap::new();
    let mut tried = 0;
    for text in TEXTS {
        for (what, script) in variants(text) {
            tried += 1;
            // What a parameter stands for is written elsewhere.
            if what.starts_with("/parameters/") || what.contains("\"param\"") {
                continue;
            }
            let text = script.to_string();
            let by_schema = validator.check(&text);
            match (read(&text, "varied.scan.json", &[]), by_schema) {
                (Ok(_), Ok(())) | (Err(_), Err(_)) => {}
                (Ok(_), Err(why)) => differing.push(format!("only the reader takes {what}: {why}")),
                (Err(error), Ok(())) => {
                    let messages = error.diagnostics().iter().map(|one| one.message.clone());
                    let others: Vec<_> = messages
                        .filter(|message| {
                            let known_one = ONLY_THE_READER.iter().find(|piece| message.contains(*piece));
                            known_one
                                .map(|piece| *known.entry(*piece).or_insert(0) += 1)
                                .is_none()
                        })
                        .collect();
                    if let Some(first) = others.first() {
                        differing.push(format!("only the schema takes {what}: {first}"));
                    }
                }
            }
        }
    }
    assert!(
        differing.is_empty(),
        "{} of {tried}:\n{}",
        differing.len(),
        differing.join("\n")
    );
    if standstill_testkit::searches() {
        for piece in ONLY_THE_READER {
            assert!(known.contains_key(piece), "not needed: {piece}");
        }
    }
    assert!(tried > 10_000 / step(), "{tried}");
}
