//! The JSON Schema of maps for `standstill compare`, made from the tables that the reader uses.

use crate::read::machine_map::{COLUMNS_MAX, DECIMALS, DELIMITERS, MAP_VERSION, UNITS};
use crate::read::shape::machine as shape;
use crate::schema::of::words;
use crate::schema::{add, object, required, titled, written};
use serde_json::{Value, json};

/// The JSON Schema (draft 2020-12) of maps, in the layout of [`format`](crate::format).
///
/// It knows no trace, so it accepts the keys of every kind of signal for every one.
pub fn map_schema() -> String {
    written(document())
}

fn document() -> Value {
    let mut root = required(
        &["standstill_compare", "recording", "offset", "signals"],
        object(&shape::MAP),
    );
    let description =
        "Says which column of a machine's recording is which signal of a trace, and what may differ.";
    let definitions = json!({
        "time": {"type": "string", "pattern": "^([tT]|[tT][iI][mM][eE])#-?[0-9]"},
        "column": {"anyOf": [
            {"type": "string", "minLength": 1},
            {"type": "integer", "minimum": 1, "maximum": COLUMNS_MAX},
        ]},
    });
    titled(&mut root, "Map for standstill compare", description);
    add(&mut root, "$defs", definitions);
    root
}

pub(crate) fn map_version() -> Value {
    json!({"const": MAP_VERSION})
}

pub(crate) fn recording() -> Value {
    required(&["time"], object(&shape::RECORDING))
}

pub(crate) fn delimiter() -> Value {
    words(&DELIMITERS)
}

pub(crate) fn decimal() -> Value {
    words(&DECIMALS)
}

pub(crate) fn recording_time() -> Value {
    json!({"anyOf": [
        required(&["column", "unit"], object(&shape::TIME)),
        required(&["every"], object(&shape::TIME)),
    ]})
}

pub(crate) fn time_unit() -> Value {
    words(&UNITS)
}

pub(crate) fn column() -> Value {
    json!({"$ref": "#/$defs/column"})
}

pub(crate) fn map_time() -> Value {
    json!({"$ref": "#/$defs/time"})
}

pub(crate) fn offset() -> Value {
    json!({"anyOf": [
        map_time(),
        required(&["edge", "to"], object(&shape::EDGE)),
        required(&["fit", "from", "to"], object(&shape::FIT)),
    ]})
}

pub(crate) fn edge_value() -> Value {
    json!({"type": ["boolean", "integer", "string"]})
}

pub(crate) fn edge_number() -> Value {
    json!({"type": "integer", "minimum": 1})
}

pub(crate) fn map_window() -> Value {
    required(&["from", "to"], object(&shape::WINDOW))
}

pub(crate) fn signals() -> Value {
    json!({"type": "object", "minProperties": 1, "additionalProperties": {"anyOf": [
        required(&["column", "tolerance"], object(&shape::CURVE)),
        required(&["column"], object(&shape::BOOL)),
        required(&["column"], object(&shape::WHOLE)),
        required(&["column"], object(&shape::WORD)),
    ]}})
}

pub(crate) fn sign() -> Value {
    json!({"enum": [1, -1]})
}

pub(crate) fn not_negative() -> Value {
    json!({"type": "number", "minimum": 0})
}

pub(crate) fn map_values() -> Value {
    json!({"type": "object", "additionalProperties": {"type": "string"}})
}
