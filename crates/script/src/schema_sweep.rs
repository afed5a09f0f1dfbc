//! The JSON Schema of sweeps, made from the tables that the reader uses.

use crate::read::shape::sweep as shape;
use crate::read::sweep::{SCALES, SWEEP_VERSION};
use crate::schema::{add, object, required, titled, written};
use crate::sweep::{CASES_MAX, TAKES};
use serde_json::{Value, json};

/// The JSON Schema (draft 2020-12) of sweeps, in the layout of [`format`](crate::format).
pub fn sweep_schema() -> String {
    written(document())
}

fn document() -> Value {
    let mut root = required(&["standstill_sweep", "script"], object(&shape::SWEEP));
    let description = "Says which parameters of a scan script vary, and what is taken of every run.";
    titled(
        &mut root,
        "Sweep over the parameters of a scan script",
        description,
    );
    add(
        &mut root,
        "oneOf",
        json!([{"required": ["grid"]}, {"required": ["sample"]}]),
    );
    root
}

/// Parameters with a list of values or a range each.
fn varied(range: Value) -> Value {
    let number = json!({"anyOf": [{"type": "number"}, {"enum": ["NaN", "Infinity", "-Infinity"]}]});
    let list = json!({"type": "array", "minItems": 1, "items": number});
    json!({
        "type": "object",
        "minProperties": 1,
        "properties": {"note": {"anyOf": [{"type": "string"}, list, range]}},
        "additionalProperties": {"anyOf": [list, range]},
    })
}

pub(crate) fn sweep_version() -> Value {
    json!({"const": SWEEP_VERSION})
}

pub(crate) fn grid() -> Value {
    varied(required(&["from", "to", "count"], object(&shape::STEPS)))
}

pub(crate) fn sample() -> Value {
    required(&["seed", "count", "of"], object(&shape::SAMPLE))
}

pub(crate) fn seed() -> Value {
    json!({"type": "integer", "minimum": 0})
}

pub(crate) fn cases() -> Value {
    json!({"type": "integer", "minimum": 1, "maximum": CASES_MAX})
}

pub(crate) fn grid_count() -> Value {
    json!({"type": "integer", "minimum": 2, "maximum": CASES_MAX})
}

pub(crate) fn sampled() -> Value {
    varied(required(&["from", "to"], object(&shape::RANGE)))
}

pub(crate) fn scale() -> Value {
    json!({"enum": SCALES.map(|(word, _)| word)})
}

pub(crate) fn measures() -> Value {
    json!({"type": "object", "additionalProperties": {"oneOf": each_measure()}})
}

/// A measure for each quantity: exactly one of the keys.
fn each_measure() -> Vec<Value> {
    let text = json!({"type": "string"});
    TAKES
        .iter()
        .map(|(take, _)| {
            json!({
                "type": "object",
                "properties": {*take: text, "note": text},
                "required": [*take],
                "additionalProperties": false,
            })
        })
        .collect()
}
