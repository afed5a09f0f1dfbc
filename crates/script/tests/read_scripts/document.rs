//! docs/scan-scripts.md against the reader: its examples are read, and it names every key and every code.

use serde_json::{Map, Value};
use standstill_script::{Code, read, read_with_programs, schema};
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};

const DOCUMENT: &str = include_str!("../../../../docs/scan-scripts.md");

/// Where a program of the examples lies.
fn program(name: &str) -> PathBuf {
    let folder = match name.ends_with(".st") {
        true => "structured_text",
        false => "guests",
    };
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scan-tests");
    tests.join(folder).join(name)
}

/// The ```json blocks.
fn examples() -> Vec<&'static str> {
    let blocks = DOCUMENT.split("```json\n").skip(1);
    blocks.map(|rest| rest.split("```").next().unwrap()).collect()
}

#[test]
fn every_example_is_read() {
    let examples = examples();
    let [first, parts @ ..] = &examples[..] else {
        panic!("no example")
    };
    read(first, "docs/scan-scripts.md", &[]).unwrap_or_else(|error| panic!("{error}"));
    assert!(parts.len() >= 6, "{}", parts.len());
    for part in parts {
        // Some keys of a script: they replace those of the first example.
        let mut script: Map<String, Value> = serde_json::from_str(first).unwrap();
        let part: Map<String, Value> = serde_json::from_str(&format!("{{{part}}}")).unwrap();
        script.extend(part);
        let text = serde_json::to_string_pretty(&script).unwrap();
        let mut files = |_: &str| Err("there are no files here".to_owned());
        let mut guest = |path: &str| {
            let found = std::fs::read(program(path));
            found.map_err(|error| error.to_string())
        };
        read_with_programs(&text, "docs/scan-scripts.md", &[], &mut files, &mut guest)
            .unwrap_or_else(|error| panic!("{error}"));
    }
}

#[test]
fn every_key_is_named() {
    fn keys(value: &Value, found: &mut BTreeSet<String>) {
        match value {
            Value::Object(members) => {
                // Pins are described by `standstill blocks`.
                if let Some(Value::Object(properties)) = members.get("properties") {
                    found.extend(properties.keys().cloned());
                }
                members
                    .iter()
                    .filter(|(key, _)| !key.starts_with("pins_of_"))
                    .for_each(|(_, value)| keys(value, found));
            }
            Value::Array(items) => items.iter().for_each(|item| keys(item, found)),
            _ => {}
        }
    }
    let mut found = BTreeSet::new();
    keys(&serde_json::from_str(&schema()).unwrap(), &mut found);
    assert!(found.len() > 60, "{found:?}");
    for key in found {
        let named = [format!("`{key}`"), format!(".{key}`"), format!("\"{key}\":")]
            .iter()
            .any(|word| DOCUMENT.contains(word));
        assert!(named, "docs/scan-scripts.md does not name {key}");
    }
}

#[test]
fn every_code_stands_in_its_table() {
    for code in Code::ALL {
        let row = format!("| `{}` | {} |\n", code.name(), code.doc());
        assert!(
            DOCUMENT.contains(&row),
            "docs/scan-scripts.md needs this row:\n{row}"
        );
    }
}
