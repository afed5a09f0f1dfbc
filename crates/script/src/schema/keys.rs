//! Objects whose keys are in a table: those of axes and drives.

use super::of::{any_of_these, boolean, definition, scans_in, text};
use super::{add, required};
use serde_json::{Map, Value, json};
use standstill_axis::keys::{Bounds, Holds, Key, Object};

/// An object of a table, with the meaning of each key.
pub(super) fn object<T>(object: &Object<T>) -> Value {
    let property = |key: &Key<T>| {
        let mut schema = holds(key);
        add(&mut schema, "description", json!(described(key)));
        (key.name().to_owned(), schema)
    };
    let mut properties: Map<String, Value> = object.keys.iter().map(property).collect();
    properties.insert("note".to_owned(), text());
    let mut schema = json!({"type": "object", "properties": properties, "additionalProperties": false});
    let needed: Vec<_> = object
        .keys
        .iter()
        .filter(|key| key.is_needed())
        .map(Key::name)
        .collect();
    if !needed.is_empty() {
        schema = required(&needed, schema);
    }
    if object.needs_one {
        let one = object.keys.iter().map(|key| json!({"required": [key.name()]}));
        add(&mut schema, "anyOf", one.collect());
    }
    schema
}

fn described<T>(key: &Key<T>) -> String {
    let absent = key.absent.map(|absent| format!(". If absent: {absent}"));
    format!("{}{}", key.doc, absent.unwrap_or_default())
}

fn holds<T>(key: &Key<T>) -> Value {
    let schema = match &key.holds {
        Holds::Bool { .. } => boolean(),
        Holds::Word { words, .. } => json!({"enum": words}),
        Holds::Number { bounds, .. } => number(bounds),
        Holds::Whole {
            range: (least, most), ..
        } => any_of_these(&[
            json!({"type": "integer", "minimum": least, "maximum": most}),
            definition("parameter"),
        ]),
        Holds::Scans {
            range: (least, most), ..
        } => scans_in(*least, *most),
        Holds::Object(inner) => object(inner),
        Holds::List(places) => {
            // All places of a list have the same schema.
            let item = places.first().map_or(Value::Null, object);
            json!({"type": "array", "items": item, "maxItems": places.len()})
        }
    };
    match key.null {
        Some(_) => any_of_these(&[schema, json!({"type": "null"})]),
        None => schema,
    }
}

/// A number in a range, or a parameter.
fn number(bounds: &Bounds) -> Value {
    let mut number = json!({"type": "number"});
    let least = if bounds.is_above {
        "exclusiveMinimum"
    } else {
        "minimum"
    };
    if bounds.least > f64::MIN {
        add(&mut number, least, json!(bounds.least));
    }
    if bounds.most < f64::MAX {
        add(&mut number, "maximum", json!(bounds.most));
    }
    any_of_these(&[number, definition("parameter")])
}
