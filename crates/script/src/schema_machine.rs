//! The JSON Schema of machine files, which scripts include: the part of the scripts' schema that they may
//! have.

use crate::read::shape;
use crate::schema::{add, definitions, object, required, titled, written};
use serde_json::{Map, Value};

/// The JSON Schema (draft 2020-12) of machine files (`*.machine.json`), in the layout of [`format`](crate::format).
///
/// Only the reader of the script can check which names of the including files an included file may use.
pub fn machine_schema() -> String {
    written(document())
}

fn document() -> Value {
    let mut root = required(&["standstill"], object(&shape::MACHINE));
    let description =
        "Axes with their drives, inputs, tasks, blocks and parameters that several scan scripts share.";
    titled(&mut root, "Machine file for scan scripts", description);
    let needed = needed(&root, &definitions());
    add(&mut root, "$defs", Value::Object(needed));
    root
}

/// The definitions that a schema refers to, and those that they refer to.
fn needed(root: &Value, all: &Map<String, Value>) -> Map<String, Value> {
    let mut needed = Map::new();
    let mut open = references(root);
    while let Some(name) = open.pop() {
        if let (Some(definition), false) = (all.get(&name), needed.contains_key(&name)) {
            open.extend(references(definition));
            needed.insert(name, definition.clone());
        }
    }
    needed
}

/// The names of the definitions that a schema refers to itself.
fn references(schema: &Value) -> Vec<String> {
    match schema {
        Value::Object(members) => members
            .iter()
            .flat_map(|(key, value)| match (key.as_str(), value.as_str()) {
                ("$ref", Some(path)) => path
                    .strip_prefix("#/$defs/")
                    .map(str::to_owned)
                    .into_iter()
                    .collect(),
                _ => references(value),
            })
            .collect(),
        Value::Array(items) => items.iter().flat_map(references).collect(),
        _ => Vec::new(),
    }
}
