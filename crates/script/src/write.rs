//! Parts of a script as JSON, for programs that make scripts.

use serde_json::{Map, Value as Json};
use standstill_axis::keys::{AXIS, Holds, Key, Object};
use standstill_axis::{AxisConfig, Limits};
use standstill_drives::keys::{CIA402, IDEAL, PLANT};
use standstill_drives::simulated::{Cia402Setup, DriveSetup, IdealDriveSetup, PlantSetup};
use standstill_fb::{PinType, TableInfo, Value};

/// An axis and its drive: the keys that differ from the default, and those that an axis needs.
#[must_use]
pub fn axis(config: &AxisConfig, drive: &DriveSetup) -> Json {
    let mut members = object(&AXIS, config, &AxisConfig::new(Limits::NONE));
    let (name, setup) = match drive {
        DriveSetup::Ideal(setup) => ("ideal", object(&IDEAL, setup, &IdealDriveSetup::PLAIN)),
        DriveSetup::Cia402(setup) => ("cia402", object(&CIA402, setup, &Cia402Setup::PLAIN)),
        DriveSetup::Plant(setup) => ("plant", object(&PLANT, setup, &PlantSetup::NONE)),
    };
    // An axis without a drive has the default ideal one.
    if name != "ideal" || !setup.is_empty() {
        let drive = Map::from_iter([(name.to_owned(), Json::Object(setup))]);
        members.insert("drive".to_owned(), Json::Object(drive));
    }
    Json::Object(members)
}

/// The value of a pin, except an axis or a table. An element of an enumeration is its number.
#[must_use]
pub fn value(value: Value) -> Option<Json> {
    Some(match value {
        Value::Bool(value) => value.into(),
        Value::Lreal(value) => number(value),
        Value::Enum(value) => value.into(),
        Value::Int(value) => value.into(),
        Value::Word(value) => value.into(),
        Value::Dword(value) => value.into(),
        Value::Time(ns) => time(ns),
        Value::Table(_) | Value::Axis(_) => return None,
    })
}

/// A table of records, each with all its fields as the numbers of a table.
#[must_use]
pub fn table(info: &TableInfo, records: &[Vec<f64>]) -> Json {
    let record = |cells: &Vec<f64>| {
        let fields = info.fields.iter().zip(cells);
        let fields = fields.map(|(field, &cell)| {
            let cell = match field.ty {
                PinType::Bool => (cell != 0.0).into(),
                PinType::Lreal => number(cell),
                PinType::Time => time(cell as i64),
                _ => (cell as i64).into(),
            };
            (field.name.to_owned(), cell)
        });
        Json::Object(fields.collect())
    };
    records.iter().map(record).collect()
}

/// A number; one that JSON does not have is a word.
fn number(value: f64) -> Json {
    match serde_json::Number::from_f64(value) {
        // Adding 0.0 removes the sign of zero.
        Some(_) => (value + 0.0).into(),
        None if value.is_nan() => "NaN".into(),
        None if value < 0.0 => "-Infinity".into(),
        None => "Infinity".into(),
    }
}

/// A time of nanoseconds. The least one has no literal.
fn time(ns: i64) -> Json {
    crate::read::time::literal(ns.max(-i64::MAX)).into()
}

/// The keys of an object that differ from the default, and those that it needs; none if there are none.
fn object<T>(object: &Object<T>, of: &T, plain: &T) -> Map<String, Json> {
    let differs = |key: &&Key<T>| !key.is_same(of, plain) || is_null(key, of);
    if !object.keys.iter().any(|key| differs(&key)) {
        return Map::new();
    }
    let said = object.keys.iter().filter(|key| key.is_needed() || differs(key));
    said.filter_map(|key| Some((key.name().to_owned(), held(key, of, plain)?)))
        .collect()
}

fn is_null<T>(key: &Key<T>, of: &T) -> bool {
    key.null.as_ref().is_some_and(|null| (null.is)(of))
}

/// The value of a key.
fn held<T>(key: &Key<T>, of: &T, plain: &T) -> Option<Json> {
    if is_null(key, of) {
        return Some(Json::Null);
    }
    match &key.holds {
        Holds::Bool { get, .. } => Some(get(of).into()),
        Holds::Word { words, get, .. } => Some(words.get(get(of)?)?.to_owned().into()),
        Holds::Number { get, .. } => get(of).map(number),
        Holds::Whole { get, .. } | Holds::Scans { get, .. } => Some(get(of)?.into()),
        Holds::Object(inner) => Some(Json::Object(object(inner, of, plain))),
        Holds::List(places) => {
            let members = places.iter().map(|inner| object(inner, of, plain));
            let given = members.filter(|members| !members.is_empty());
            Some(given.map(Json::Object).collect())
        }
    }
}
