//! The JSON Schema of scripts, made from the tables that the reader and the runtime use.
//!
//! With it an editor completes and checks keys, block names, pins and enum elements. Only the reader
//! checks what a schema cannot express (which names exist, the types of wires, multiples of the cycle).

mod keys;
pub(crate) mod of;

use crate::read::block::is_needed;
use crate::read::names::KEYWORDS;
use crate::read::shape::{self, Shape};
use crate::read::value::{NUMBER_WORDS, WHOLE_MAX};
use of::{any_of_these, definition as of, integer, text, words};
use serde_json::{Map, Value, json};
use standstill_axis::keys::AXIS;
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, PinType, TableInfo};

/// The JSON Schema (draft 2020-12) of scan scripts, in the layout of [`format`](crate::format).
///
/// It requires the spelling of the tables, but the reader, like IEC 61131-3, accepts any case.
pub fn schema() -> String {
    written(document())
}

/// A document as text, in the layout of [`format`](crate::format).
pub(crate) fn written(mut document: Value) -> String {
    // The order of keys must not depend on the features of the JSON library that other crates enable.
    document.sort_all_objects();
    let text = document.to_string();
    // A JSON writer made the text, so it can be laid out.
    crate::format(&text, "a schema").unwrap_or(text)
}

/// The head of a document.
pub(crate) fn titled(root: &mut Value, title: &str, description: &str) {
    add(
        root,
        "$schema",
        json!("https://json-schema.org/draft/2020-12/schema"),
    );
    add(root, "title", json!(title));
    add(root, "description", json!(description));
}

fn document() -> Value {
    let mut root = object(&shape::SCRIPT);
    add(&mut root, "required", json!(["standstill", "cycle", "scans"]));
    // Included files may have the rest.
    add(
        &mut root,
        "anyOf",
        json!([{"required": ["axes", "blocks"]}, {"required": ["include"]}]),
    );
    add(&mut root, "dependentRequired", json!({"after": ["stop_when"]}));
    let description = "Drives PLCopen function blocks scan by scan and says what must happen.";
    titled(&mut root, "Scan script", description);
    add(&mut root, "$defs", Value::Object(definitions()));
    root
}

/// All definitions by name.
pub(crate) fn definitions() -> Map<String, Value> {
    let pins = REGISTRY.iter().map(|info| (pins_name(info), pins(info)));
    scalars().into_iter().chain(parts()).chain(pins).collect()
}

/// An object with the keys of `shape`.
pub(crate) fn object(shape: &Shape) -> Value {
    let property = |(name, schema): &shape::Field| ((*name).to_owned(), schema());
    let properties: Map<String, Value> = shape.keys.iter().map(property).collect();
    json!({"type": "object", "properties": properties, "additionalProperties": false})
}

pub(crate) fn required(keys: &[&str], mut object: Value) -> Value {
    add(&mut object, "required", json!(keys));
    object
}

pub(crate) fn add(schema: &mut Value, key: &str, value: Value) {
    if let Value::Object(members) = schema {
        members.insert(key.to_owned(), value);
    }
}

/// Definitions of single values.
fn scalars() -> Vec<(String, Value)> {
    let number = |bounds: Value| any_of_these(&[bounds, of("parameter")]);
    let unit = "([dDhHsS]|[mM][sS]?|[uUnN][sS])";
    let literal =
        |sign: &str| format!("^[lL]?[tT]([iI][mM][eE])?#{sign}([0-9][0-9_]*(\\.[0-9]+)?{unit}_?)+$");
    let (time, duration) = (literal("-?"), literal(""));
    let defs = [
        (
            "identifier",
            json!({"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$", "not": {"enum": KEYWORDS}}),
        ),
        ("parameter", required(&["param"], object(&shape::PARAM))),
        (
            "plain_number",
            any_of_these(&[json!({"type": "number"}), words(&NUMBER_WORDS)]),
        ),
        ("number", any_of_these(&[of("plain_number"), of("parameter")])),
        ("finite", number(json!({"type": "number"}))),
        (
            "positive",
            number(json!({"type": "number", "exclusiveMinimum": 0})),
        ),
        (
            "count",
            number(json!({"type": "integer", "minimum": 0, "maximum": WHOLE_MAX})),
        ),
        ("time_literal", json!({"type": "string", "pattern": time})),
        ("duration", json!({"type": "string", "pattern": duration})),
        ("scans", any_of_these(&[of("count"), of("duration")])),
        (
            "value",
            any_of_these(&[json!({"type": ["boolean", "number", "string"]}), of("parameter")]),
        ),
    ];
    defs.map(|(name, def)| (name.to_owned(), def)).into()
}

/// Definitions of the objects of a script.
fn parts() -> Vec<(String, Value)> {
    let defs = [
        ("axis", axis()),
        ("task", task()),
        ("block", block()),
        (
            "program",
            json!({"oneOf": [
                required(&["wasm"], object(&shape::PROGRAM_MODULE)),
                required(&["st"], object(&shape::PROGRAM_TEXT)),
            ]}),
        ),
        ("table", required(&["type"], object(&shape::TABLE))),
        ("wire", wire()),
        ("expression", expression()),
        ("step", step()),
        ("conditions", conditions()),
        ("comparison", comparison()),
        ("input", required(&["value"], object(&shape::INPUT))),
        (
            "claim",
            json!({"oneOf": shape::CLAIMS.map(|shape| claim(&shape))}),
        ),
    ];
    defs.map(|(name, def)| (name.to_owned(), def)).into()
}

/// The keys of its configuration, and the other keys of an axis.
fn axis() -> Value {
    let mut axis = keys::object(&AXIS);
    let others = [
        ("unit", text()),
        ("drive", of::drive()),
        ("vacuous", of::vacuous()),
    ];
    if let Some(properties) = axis.get_mut("properties") {
        for (name, schema) in others {
            add(properties, name, schema);
        }
    }
    // A modulo axis has no end, and a CiA 402 drive counts increments.
    add(
        &mut axis,
        "not",
        json!({"required": ["modulo", "software_limits"]}),
    );
    let counts = json!({"required": ["drive"], "properties": {"drive": {"required": ["cia402"]}}});
    add(&mut axis, "if", counts);
    add(&mut axis, "then", json!({"required": ["scaling"]}));
    axis
}

fn task() -> Value {
    let mut task = object(&shape::TASK);
    add(
        &mut task,
        "anyOf",
        json!([{"required": ["interval"]}, {"required": ["single"]}]),
    );
    task
}

fn block() -> Value {
    let mut block = object(&shape::BLOCK);
    let pins_by_type: Vec<Value> = REGISTRY
        .iter()
        .map(|info| {
            let mut then = json!({"properties": {"pins": of(&pins_name(info))}});
            if info.pins_of(Direction::InOut).next().is_some() {
                add(&mut then, "required", json!(["pins"]));
            }
            json!({"if": {"properties": {"type": {"const": info.name}}}, "then": then})
        })
        .collect();
    add(&mut block, "allOf", json!(pins_by_type));
    required(&["name", "type"], block)
}

fn pins_name(info: &BlockInfo) -> String {
    format!("pins_of_{}", info.name)
}

fn pins(info: &BlockInfo) -> Value {
    let mut properties = Map::new();
    properties.insert("note".to_owned(), text());
    for pin in info.pins().take(info.input_count()) {
        let unit = if pin.unit.is_empty() {
            String::new()
        } else {
            format!(" Unit: {}.", pin.unit)
        };
        let mut schema = any_of_these(&[constant(pin.ty), of("wire")]);
        add(
            &mut schema,
            "description",
            json!(format!("{}: {}{unit}", pin.ty.iec_name(), pin.doc.trim())),
        );
        properties.insert(pin.name.to_owned(), schema);
    }
    let needed: Vec<&str> = info
        .pins()
        .filter(|pin| is_needed(pin))
        .map(|pin| pin.name)
        .collect();
    json!({
        "description": info.doc,
        "type": "object",
        "properties": properties,
        "required": needed,
        "additionalProperties": false,
    })
}

fn constant(ty: PinType) -> Value {
    match ty {
        PinType::Bool => json!({"type": "boolean"}),
        PinType::Int => integer(i16::MIN.into(), i16::MAX.into()),
        PinType::Lreal => of("number"),
        PinType::Uint | PinType::Word => integer(0, u16::MAX.into()),
        PinType::Dword => integer(0, u32::MAX.into()),
        PinType::Table(info) => table(info),
        PinType::Time => any_of_these(&[of("count"), of("time_literal")]),
        PinType::Axis(_) => of("identifier"),
        PinType::Enum(info) => {
            any_of_these(&[words(info.elements), integer(i32::MIN.into(), i32::MAX.into())])
        }
    }
}

fn table(info: TableInfo) -> Value {
    let mut properties = Map::new();
    properties.insert("note".to_owned(), text());
    for field in info.fields {
        let mut schema = constant(field.ty);
        add(&mut schema, "description", json!(field.doc.trim()));
        properties.insert(field.name.to_owned(), schema);
    }
    let rows = json!({
        "type": "array",
        "maxItems": info.most,
        "items": {"type": "object", "properties": properties, "additionalProperties": false},
    });
    any_of_these(&[rows, required(&["table"], object(&shape::TABLE_USE))])
}

fn wire() -> Value {
    let mut wire = object(&shape::WIRE);
    let kinds = shape::WIRE_KINDS.iter().map(|kind| json!({"required": [kind]}));
    add(&mut wire, "oneOf", kinds.collect());
    any_of_these(&[wire, of("expression")])
}

/// Structured Text over signals and input variables.
fn expression() -> Value {
    json!({
        "type": "string",
        "pattern": "^=",
        "description": "An expression in Structured Text over signals and input variables.",
    })
}

fn step() -> Value {
    let mut step = object(&shape::STEP);
    add(
        &mut step,
        "oneOf",
        json!([{"required": ["at"]}, {"required": ["when"]}]),
    );
    add(
        &mut step,
        "dependentRequired",
        json!({"after": ["when"], "every": ["when"]}),
    );
    let actions = ["set", "fault", "clear", "drive"].map(|action| json!({"required": [action]}));
    add(&mut step, "anyOf", json!(actions));
    step
}

fn conditions() -> Value {
    let map = of::not_empty(json!({
        "type": "object",
        "properties": {"note": text()},
        "additionalProperties": any_of_these(&[of("value"), of("comparison")]),
    }));
    any_of_these(&[map, of("expression")])
}

fn comparison() -> Value {
    let mut comparison = of::not_empty(object(&shape::COMPARISON));
    add(
        &mut comparison,
        "dependentRequired",
        json!({"near": ["within"], "within": ["near"]}),
    );
    comparison
}

fn claim(shape: &Shape) -> Value {
    let kind = shape.names().next().unwrap_or_default();
    let claim = object(shape);
    if shape.has("that") {
        let second = if kind == "when" { "within" } else { "by" };
        match kind {
            "when" | "after" => required(&[kind, second, "that"], claim),
            _ => required(&[kind, "that"], claim),
        }
    } else {
        required(&[kind], claim)
    }
}
