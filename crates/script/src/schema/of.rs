//! The permitted values of a key, each as a schema.

use super::{add, object, required};
use crate::read::program::{FUEL_MAX, MEMORY_MAX, SYMBOL_TYPES};
use crate::read::shape;
use crate::read::step::FAULT_KINDS;
use crate::read::value::WHOLE_MAX;
use crate::read::{CAM_PIECES_MOST, CAM_SLOTS_MOST, CLAMPS, SCANS_MAX, VERSION};
use serde_json::{Value, json};
use standstill_axis::{DIGITAL, PROBES};
use standstill_blocks::REGISTRY;
use standstill_drives::keys::{CIA402, IDEAL, PLANT};

/// The definition called `name`.
pub(crate) fn definition(name: &str) -> Value {
    json!({"$ref": format!("#/$defs/{name}")})
}

pub(crate) fn any_of_these(schemas: &[Value]) -> Value {
    json!({"anyOf": schemas})
}

pub(crate) fn list(items: Value, least: usize) -> Value {
    json!({"type": "array", "items": items, "minItems": least})
}

pub(crate) fn words<T>(table: &[(&str, T)]) -> Value {
    let words: Vec<&str> = table.iter().map(|(word, _)| *word).collect();
    json!({"enum": words})
}

pub(crate) fn integer(least: i64, most: i64) -> Value {
    any_of_these(&[
        json!({"type": "integer", "minimum": least, "maximum": most}),
        definition("parameter"),
    ])
}

/// An object that has more than a note.
pub(crate) fn not_empty(mut object: Value) -> Value {
    add(&mut object, "minProperties", json!(1));
    add(
        &mut object,
        "not",
        json!({"required": ["note"], "maxProperties": 1}),
    );
    object
}

/// An object whose keys are names the script declares.
pub(crate) fn names_of(each: Value) -> Value {
    json!({"type": "object", "propertyNames": definition("identifier"), "additionalProperties": each})
}

/// A count of scans in a range, or a time in its place. If the range is above 0, the time is, too.
pub(crate) fn scans_in(least: u64, most: u64) -> Value {
    let mut time = definition("duration");
    if least > 0 {
        add(&mut time, "pattern", json!("[1-9]"));
    }
    let count = json!({"type": "integer", "minimum": least, "maximum": most});
    any_of_these(&[count, definition("parameter"), time])
}

pub(crate) fn text() -> Value {
    json!({"type": "string"})
}

pub(crate) fn texts() -> Value {
    list(text(), 0)
}

pub(crate) fn some_texts() -> Value {
    list(text(), 1)
}

pub(crate) fn two_texts() -> Value {
    list(text(), 2)
}

pub(crate) fn text_or_texts() -> Value {
    any_of_these(&[text(), texts()])
}

/// Of programs in Structured Text.
pub(crate) fn files() -> Value {
    any_of_these(&[text(), some_texts()])
}

pub(crate) fn boolean() -> Value {
    json!({"type": "boolean"})
}

pub(crate) fn vacuous() -> Value {
    json!({"const": "allowed"})
}

/// A number without any other form.
pub(crate) fn plain() -> Value {
    json!({"type": "number"})
}

pub(crate) fn number() -> Value {
    definition("number")
}

pub(crate) fn finite() -> Value {
    definition("finite")
}

pub(crate) fn positive() -> Value {
    definition("positive")
}

pub(crate) fn count() -> Value {
    definition("count")
}

pub(crate) fn scans() -> Value {
    definition("scans")
}

/// A time above 0.
pub(crate) fn cycle() -> Value {
    let mut time = definition("duration");
    add(&mut time, "pattern", json!("[1-9]"));
    time
}

/// Rows of a run: at least one.
pub(crate) fn rows() -> Value {
    scans_in(1, SCANS_MAX)
}

pub(crate) fn interval() -> Value {
    scans_in(1, WHOLE_MAX as u64)
}

pub(crate) fn priority() -> Value {
    integer(0, u32::MAX.into())
}

pub(crate) fn watchdog() -> Value {
    integer(1, u32::MAX.into())
}

pub(crate) fn word_16() -> Value {
    integer(0, u16::MAX.into())
}

pub(crate) fn int_16() -> Value {
    integer(i16::MIN.into(), i16::MAX.into())
}

pub(crate) fn ratio_den() -> Value {
    integer(1, u16::MAX.into())
}

pub(crate) fn value() -> Value {
    definition("value")
}

pub(crate) fn identifier() -> Value {
    definition("identifier")
}

pub(crate) fn any_object() -> Value {
    json!({"type": "object"})
}

pub(crate) fn version() -> Value {
    json!({"const": VERSION})
}

pub(crate) fn clamps() -> Value {
    words(&CLAMPS)
}

pub(crate) fn parameters() -> Value {
    json!({"type": "object", "additionalProperties": definition("plain_number")})
}

pub(crate) fn axes() -> Value {
    names_of(definition("axis"))
}

pub(crate) fn inputs() -> Value {
    names_of(any_of_these(&[boolean(), number(), definition("input")]))
}

pub(crate) fn input_value() -> Value {
    any_of_these(&[boolean(), number()])
}

pub(crate) fn tasks() -> Value {
    names_of(definition("task"))
}

pub(crate) fn blocks() -> Value {
    list(definition("block"), 0)
}

pub(crate) fn block_type() -> Value {
    let names: Vec<&str> = REGISTRY.iter().map(|info| info.name).collect();
    json!({"enum": names})
}

pub(crate) fn tables() -> Value {
    names_of(definition("table"))
}

pub(crate) fn table_rows() -> Value {
    list(any_object(), 0)
}

pub(crate) fn cams() -> Value {
    object(&shape::CAMS)
}

pub(crate) fn cam_slots() -> Value {
    integer(0, CAM_SLOTS_MOST as i64)
}

pub(crate) fn cam_pieces() -> Value {
    integer(0, CAM_PIECES_MOST as i64)
}

pub(crate) fn programs() -> Value {
    names_of(definition("program"))
}

pub(crate) fn program_axes() -> Value {
    json!({"type": "object", "additionalProperties": text()})
}

pub(crate) fn fuel() -> Value {
    integer(1, FUEL_MAX)
}

pub(crate) fn memory() -> Value {
    integer(1, MEMORY_MAX)
}

pub(crate) fn symbol_type() -> Value {
    json!({"enum": SYMBOL_TYPES})
}

pub(crate) fn symbols() -> Value {
    names_of(any_of_these(&[
        symbol_type(),
        required(&["type"], object(&shape::SYMBOL)),
    ]))
}

pub(crate) fn ideal_drive() -> Value {
    super::keys::object(&IDEAL)
}

pub(crate) fn cia402_drive() -> Value {
    super::keys::object(&CIA402)
}

pub(crate) fn plant() -> Value {
    super::keys::object(&PLANT)
}

/// At most one drive.
pub(crate) fn drive() -> Value {
    let mut drive = object(&shape::DRIVE);
    let pairs = [["ideal", "cia402"], ["ideal", "plant"], ["cia402", "plant"]];
    let both = pairs.map(|pair| json!({"required": pair}));
    add(&mut drive, "not", any_of_these(&both));
    drive
}

pub(crate) fn wire() -> Value {
    definition("wire")
}

pub(crate) fn steps() -> Value {
    list(definition("step"), 0)
}

pub(crate) fn set() -> Value {
    let value = any_of_these(&[value(), list(any_object(), 0)]);
    not_empty(json!({"type": "object", "properties": {"note": text()}, "additionalProperties": value}))
}

pub(crate) fn fault() -> Value {
    required(&["axis", "kind"], object(&shape::FAULT))
}

pub(crate) fn fault_kind() -> Value {
    words(&FAULT_KINDS)
}

pub(crate) fn clear() -> Value {
    required(&["axis"], object(&shape::CLEAR))
}

pub(crate) fn drive_step() -> Value {
    let mut step = required(&["axis"], object(&shape::DRIVE_STEP));
    let changes = shape::DRIVE_STEP
        .names()
        .filter(|name| !matches!(*name, "axis" | "note"));
    add(
        &mut step,
        "anyOf",
        changes.map(|name| json!({"required": [name]})).collect(),
    );
    step
}

/// A part of a scan.
pub(crate) fn part() -> Value {
    any_of_these(&[
        json!({"type": "number", "minimum": 0, "maximum": 1}),
        definition("parameter"),
    ])
}

pub(crate) fn drive_report() -> Value {
    let mut report = object(&shape::DRIVE_REPORT);
    let one = json!([{"required": ["position"]}, {"required": ["torque"]}]);
    add(&mut report, "anyOf", one);
    report
}

pub(crate) fn drive_input() -> Value {
    required(&["number", "value"], object(&shape::DRIVE_INPUT))
}

pub(crate) fn input_number() -> Value {
    integer(0, i64::from(DIGITAL) - 1)
}

pub(crate) fn drive_probe() -> Value {
    required(&["number", "value"], object(&shape::DRIVE_PROBE))
}

pub(crate) fn probe_number() -> Value {
    integer(1, PROBES as i64)
}

pub(crate) fn claims() -> Value {
    list(definition("claim"), 0)
}

pub(crate) fn conditions() -> Value {
    definition("conditions")
}

pub(crate) fn two_conditions() -> Value {
    json!({"type": "array", "items": conditions(), "minItems": 2, "maxItems": 2})
}

/// The begin or the end of a window.
pub(crate) fn range_end() -> Value {
    any_of_these(&[scans(), required(&["when"], object(&shape::WINDOW_EDGE))])
}

/// The value to compare with.
pub(crate) fn bound() -> Value {
    any_of_these(&[number(), definition("time_literal")])
}

/// A tolerance.
pub(crate) fn within() -> Value {
    any_of_these(&[
        json!({"type": "number", "minimum": 0}),
        json!({"const": "Infinity"}),
        definition("parameter"),
        definition("duration"),
    ])
}

pub(crate) fn near() -> Value {
    any_of_these(&[bound(), required(&["of"], object(&shape::NEAR_TO))])
}

pub(crate) fn follows() -> Value {
    required(&["slave", "master", "num", "den"], object(&shape::FOLLOWS))
}

pub(crate) fn anchor() -> Value {
    required(&["master", "slave"], object(&shape::ANCHOR))
}
