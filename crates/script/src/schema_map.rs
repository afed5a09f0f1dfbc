//! The JSON Schema of maps for `standstill compare`, made from the tables that the reader uses.

use crate::read::machine_map::{COLUMNS_MAX, DECIMALS, DELIMITERS, MAP_VERSION, UNITS};
use crate::read::shape::machine as shape;
use crate::schema::{add, object, required};
use serde_json::{Value, json};

/// The JSON Schema (draft 2020-12) of maps, in the layout of [`format`](crate::format).
///
/// It knows no trace, so it takes the keys of every kind of signal for every one.
pub fn map_schema() -> String {
    let mut document = document();
    document.sort_all_objects();
    let text = document.to_string();
    // A JSON writer made the text, so it can be laid out.
    crate::format(&text, "compare-map.schema.json").unwrap_or(text)
}

fn document() -> Value {
    let mut root = required(
        &["standstill_compare", "recording", "offset", "signals"],
        object(&shape::MAP, map_key),
    );
    let schema = "https://json-schema.org/draft/2020-12/schema";
    let description =
        "Says which column of a machine's recording is which signal of a trace, and what may differ.";
    let definitions = json!({
        "time": {"type": "string", "pattern": "^([tT]|[tT][iI][mM][eE])#-?[0-9]"},
        "column": {"anyOf": [
            {"type": "string", "minLength": 1},
            {"type": "integer", "minimum": 1, "maximum": COLUMNS_MAX},
        ]},
    });
    add(&mut root, "$schema", json!(schema));
    add(&mut root, "title", json!("Map for standstill compare"));
    add(&mut root, "description", json!(description));
    add(&mut root, "$defs", definitions);
    root
}

fn time() -> Value {
    json!({"$ref": "#/$defs/time"})
}

fn words<T>(table: &[(&str, T)]) -> Value {
    json!({"enum": table.iter().map(|(word, _)| *word).collect::<Vec<_>>()})
}

fn map_key(key: &str) -> Value {
    match key {
        "standstill_compare" => json!({"const": MAP_VERSION}),
        "recording" => required(&["time"], object(&shape::RECORDING, recording_key)),
        "offset" => json!({"anyOf": [
            time(),
            required(&["edge", "to"], object(&shape::EDGE, offset_key)),
            required(&["fit", "from", "to"], object(&shape::FIT, fit_key)),
        ]}),
        "window" => required(&["from", "to"], object(&shape::WINDOW, |_| time())),
        "time_tolerance" => time(),
        "signals" => json!({"type": "object", "minProperties": 1, "additionalProperties": {"anyOf": [
            required(&["column", "tolerance"], object(&shape::CURVE, signal_key)),
            required(&["column"], object(&shape::BOOL, signal_key)),
            required(&["column"], object(&shape::WHOLE, signal_key)),
            required(&["column"], object(&shape::WORD, signal_key)),
        ]}}),
        _ => json!({"type": "string"}),
    }
}

fn recording_key(key: &str) -> Value {
    match key {
        "delimiter" => words(&DELIMITERS),
        "decimal" => words(&DECIMALS),
        _ => json!({"anyOf": [
            required(&["column", "unit"], object(&shape::TIME, time_key)),
            required(&["every"], object(&shape::TIME, time_key)),
        ]}),
    }
}

fn time_key(key: &str) -> Value {
    match key {
        "column" => json!({"$ref": "#/$defs/column"}),
        "unit" => words(&UNITS),
        _ => time(),
    }
}

fn offset_key(key: &str) -> Value {
    match key {
        "edge" => json!({"type": "string"}),
        "number" => json!({"type": "integer", "minimum": 1}),
        _ => json!({"type": ["boolean", "integer", "string"]}),
    }
}

fn fit_key(key: &str) -> Value {
    match key {
        "fit" => json!({"type": "string"}),
        _ => time(),
    }
}

fn signal_key(key: &str) -> Value {
    match key {
        "column" => json!({"$ref": "#/$defs/column"}),
        "factor" | "zero" => json!({"type": "number"}),
        "sign" => json!({"enum": [1, -1]}),
        "tolerance" => json!({"type": "number", "minimum": 0}),
        "invert" => json!({"type": "boolean"}),
        "values" => json!({"type": "object", "additionalProperties": {"type": "string"}}),
        _ => time(),
    }
}
