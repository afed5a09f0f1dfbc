//! The JSON Schema of scripts, made from the tables that the reader and the runtime use.
//!
//! With it an editor completes and checks keys, block names, pins and enum elements. What a schema cannot say
//! (which names exist, the types of wires, multiples of the cycle) only the reader checks.

use crate::read::axis::{
    ABOVE_LIMIT, EDGE_WHILE_BUSY, JOG_AT_LIMIT, MODULO_TARGETS, ON_LIMIT, ON_MASTER_LOST, ON_POWER_OFF,
    PROFILES, START_STATES,
};
use crate::read::block::is_needed;
use crate::read::drive::{NODE_DIRECTIONS, REACTIONS};
use crate::read::homing::{HOME_DIRECTIONS, PROCEDURES, SWITCH_EDGES};
use crate::read::names::KEYWORDS;
use crate::read::program::{FUEL_MAX, MEMORY_MAX, SYMBOL_TYPES};
use crate::read::shape::{self, Shape};
use crate::read::step::FAULT_KINDS;
use crate::read::value::NUMBER_WORDS;
use crate::read::{CAM_PIECES_MOST, CAM_SLOTS_MOST, CLAMPS, SCANS_MAX, VERSION};
use serde_json::{Map, Value, json};
use standstill_axis::{ACTUAL_FILTER_MAX, DELAY_MAX, DIGITAL, PROBES, QUEUE_MAX};
use standstill_blocks::REGISTRY;
use standstill_fb::{BlockInfo, Direction, PinType, TableInfo};

/// The JSON Schema (draft 2020-12) of scan scripts, in the layout of [`format`](crate::format).
///
/// It asks for the spelling of the tables, where the reader, like IEC 61131-3, takes any case.
pub fn schema() -> String {
    let mut document = document();
    // The order of keys must not depend on which features of the JSON library other crates switch on.
    document.sort_all_objects();
    let text = document.to_string();
    // A JSON writer made the text, so it can be laid out.
    crate::format(&text, "scan-script.schema.json").unwrap_or(text)
}

fn document() -> Value {
    let mut root = object(&shape::SCRIPT, script_key);
    add(&mut root, "required", json!(["standstill", "cycle", "scans"]));
    // Included files may have the rest.
    add(
        &mut root,
        "anyOf",
        json!([{"required": ["axes", "blocks"]}, {"required": ["include"]}]),
    );
    add(&mut root, "dependentRequired", json!({"after": ["stop_when"]}));
    add(
        &mut root,
        "$schema",
        json!("https://json-schema.org/draft/2020-12/schema"),
    );
    add(&mut root, "title", json!("Scan script"));
    add(
        &mut root,
        "description",
        json!("Drives PLCopen function blocks scan by scan and says what must happen."),
    );
    add(&mut root, "$defs", Value::Object(definitions()));
    root
}

/// All definitions by name.
pub(crate) fn definitions() -> Map<String, Value> {
    let pins = REGISTRY.iter().map(|info| (pins_name(info), pins(info)));
    scalars().into_iter().chain(parts()).chain(pins).collect()
}

/// An object with the keys of `shape`; `schema_of` gives the schema of each.
pub(crate) fn object(shape: &Shape, schema_of: impl Fn(&str) -> Value) -> Value {
    let property = |key: &&str| {
        let schema = match *key {
            "note" => json!({"type": "string"}),
            "vacuous" => json!({"const": "allowed"}),
            key => schema_of(key),
        };
        ((*key).to_owned(), schema)
    };
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

/// The definition called `name`.
fn of(name: &str) -> Value {
    json!({"$ref": format!("#/$defs/{name}")})
}

fn any(schemas: &[Value]) -> Value {
    json!({"anyOf": schemas})
}

fn list(items: Value, least: usize) -> Value {
    json!({"type": "array", "items": items, "minItems": least})
}

fn words<T>(table: &[(&str, T)]) -> Value {
    let words: Vec<&str> = table.iter().map(|(word, _)| *word).collect();
    json!({"enum": words})
}

fn text() -> Value {
    json!({"type": "string"})
}

fn integer(least: i64, most: i64) -> Value {
    any(&[
        json!({"type": "integer", "minimum": least, "maximum": most}),
        of("parameter"),
    ])
}

/// An object whose keys are names the script declares.
fn names(of_each: Value) -> Value {
    json!({"type": "object", "propertyNames": of("identifier"), "additionalProperties": of_each})
}

pub(crate) fn script_key(key: &str) -> Value {
    match key {
        "standstill" => json!({"const": VERSION}),
        "covers" => list(text(), 0),
        "include" | "override" => any(&[text(), list(text(), 0)]),
        "cycle" => of("time_literal"),
        "scans" => any(&[integer(1, SCANS_MAX as i64), of("time_literal")]),
        "after" => of("scans"),
        "parameters" => json!({"type": "object", "additionalProperties": of("plain_number")}),
        "axes" => names(of("axis")),
        "inputs" => names(any(&[json!({"type": "boolean"}), of("number"), of("input")])),
        "golden" => json!({"type": "boolean"}),
        "clamps" => words(&CLAMPS),
        "tasks" => names(of("task")),
        "blocks" => list(of("block"), 0),
        "tables" => names(of("table")),
        "cams" => object(&shape::CAMS, |key| match key {
            "slots" => integer(0, CAM_SLOTS_MOST as i64),
            _ => integer(0, CAM_PIECES_MOST as i64),
        }),
        "programs" => names(of("program")),
        "steps" => list(of("step"), 0),
        "expect" => list(of("claim"), 0),
        "stop_when" => of("conditions"),
        _ => text(),
    }
}

/// Definitions of single values.
fn scalars() -> Vec<(String, Value)> {
    let number = |bounds: Value| any(&[bounds, of("parameter")]);
    let unit = "([dDhHsS]|[mM][sS]?|[uUnN][sS])";
    let time = format!("^[lL]?[tT]([iI][mM][eE])?#-?([0-9][0-9_]*(\\.[0-9]+)?{unit}_?)+$");
    let defs = [
        (
            "identifier",
            json!({"type": "string", "pattern": "^[A-Za-z_][A-Za-z0-9_]*$", "not": {"enum": KEYWORDS}}),
        ),
        (
            "parameter",
            required(&["param"], object(&shape::PARAM, |_| text())),
        ),
        (
            "plain_number",
            any(&[json!({"type": "number"}), words(&NUMBER_WORDS)]),
        ),
        ("number", any(&[of("plain_number"), of("parameter")])),
        ("finite", number(json!({"type": "number"}))),
        (
            "positive",
            number(json!({"type": "number", "exclusiveMinimum": 0})),
        ),
        ("optional_limit", any(&[of("positive"), json!({"type": "null"})])),
        ("count", number(json!({"type": "integer", "minimum": 0}))),
        ("time_literal", json!({"type": "string", "pattern": time})),
        ("scans", any(&[of("count"), of("time_literal")])),
        (
            "value",
            any(&[json!({"type": ["boolean", "number", "string"]}), of("parameter")]),
        ),
    ];
    defs.map(|(name, def)| (name.to_owned(), def)).into()
}

/// Definitions of the objects of a script.
fn parts() -> Vec<(String, Value)> {
    let defs = [
        ("axis", required(&["limits"], object(&shape::AXIS, axis_key))),
        ("task", task()),
        ("block", block()),
        (
            "program",
            json!({"oneOf": [
                required(&["wasm"], object(&shape::PROGRAM_MODULE, program_key)),
                required(&["st"], object(&shape::PROGRAM_TEXT, program_key)),
            ]}),
        ),
        (
            "table",
            required(
                &["type"],
                object(&shape::TABLE, |key| match key {
                    "rows" => list(json!({"type": "object"}), 0),
                    _ => text(),
                }),
            ),
        ),
        ("wire", wire()),
        ("expression", expression()),
        ("step", step()),
        ("conditions", conditions()),
        ("comparison", comparison()),
        (
            "input",
            required(
                &["value"],
                object(&shape::INPUT, |_| {
                    any(&[json!({"type": "boolean"}), of("number")])
                }),
            ),
        ),
        (
            "claim",
            json!({"oneOf": shape::CLAIMS.map(|shape| claim(&shape))}),
        ),
    ];
    defs.map(|(name, def)| (name.to_owned(), def)).into()
}

fn program_key(key: &str) -> Value {
    let symbol = |key: &str| match key {
        "type" => json!({"enum": SYMBOL_TYPES}),
        "export" => text(),
        _ => of("count"),
    };
    match key {
        "fuel" => integer(1, FUEL_MAX),
        "memory" => integer(1, MEMORY_MAX),
        "may_fault" => json!({"type": "boolean"}),
        "st" => any(&[text(), json!({"type": "array", "items": text(), "minItems": 1})]),
        "trace" => json!({"type": "array", "items": text()}),
        "axes" => json!({"type": "object", "additionalProperties": text()}),
        "symbols" => names(any(&[
            json!({"enum": SYMBOL_TYPES}),
            required(&["type"], object(&shape::SYMBOL, symbol)),
        ])),
        _ => text(),
    }
}

fn axis_key(key: &str) -> Value {
    match key {
        "unit" => text(),
        "limits" => required(
            &["velocity", "acceleration"],
            object(&shape::LIMITS, |key| match key {
                "velocity" | "acceleration" => of("positive"),
                _ => of("optional_limit"),
            }),
        ),
        "application_limits" => object(&shape::APPLICATION_LIMITS, |_| of("optional_limit")),
        "stop" => object(&shape::STOP, |_| of("positive")),
        "jog_at_limit" => words(&JOG_AT_LIMIT),
        "modulo_targets" => words(&MODULO_TARGETS),
        "edge_while_busy" => words(&EDGE_WHILE_BUSY),
        "defaults" => object(&shape::DEFAULTS, |_| of("positive")),
        "stop_deceleration" | "stop_jerk" | "modulo" => of("positive"),
        "state" => words(&START_STATES),
        "scaling" => required(
            &["increments", "units"],
            object(&shape::SCALING, |key| match key {
                "invert" => json!({"type": "boolean"}),
                "offset" => of("finite"),
                _ => integer(1, u32::MAX.into()),
            }),
        ),
        "software_limits" => {
            let mut limits = object(&shape::SOFTWARE_LIMITS, |_| of("finite"));
            add(
                &mut limits,
                "anyOf",
                json!([{"required": ["min"]}, {"required": ["max"]}]),
            );
            limits
        }
        "above_limit" => words(&ABOVE_LIMIT),
        "profile" => words(&PROFILES),
        "queue" => integer(0, QUEUE_MAX as i64),
        "on_power_off" => words(&ON_POWER_OFF),
        "needs_homed" | "hardware_limits" => json!({"type": "boolean"}),
        "homing" => homing(),
        "power_timeout" => any(&[integer(1, SCANS_MAX as i64), of("time_literal")]),
        "override_max" => any(&[json!({"type": "number", "minimum": 1}), of("parameter")]),
        "coupling" => object(&shape::COUPLING, |key| match key {
            "on_limit" => words(&ON_LIMIT),
            "on_master_lost" => words(&ON_MASTER_LOST),
            "actual_filter" => any(&[integer(0, ACTUAL_FILTER_MAX.into()), of("time_literal")]),
            "actual_lead" => json!({"type": "boolean"}),
            _ => of("finite"),
        }),
        "in_position" => required(
            &["window"],
            object(&shape::IN_POSITION, |key| match key {
                "time" => of("scans"),
                _ => of("finite"),
            }),
        ),
        "drive" => drive(),
        _ => of("finite"),
    }
}

fn homing() -> Value {
    required(
        &["procedure"],
        object(&shape::HOMING, |key| match key {
            "procedure" => words(&PROCEDURES),
            "direction" => words(&HOME_DIRECTIONS),
            "edge" => words(&SWITCH_EDGES),
            "pulse" => json!({"type": "boolean"}),
            "time_limit" => of("scans"),
            "block" => required(
                &["velocity", "time"],
                object(&shape::BLOCK_DETECTION, |key| match key {
                    "time" => of("scans"),
                    _ => of("positive"),
                }),
            ),
            _ => of("positive"),
        }),
    )
}

/// What stands along the travel of any drive; `None` for other keys.
fn switches(key: &str) -> Option<Value> {
    match key {
        "limit_switches" => Some(required(
            &["negative", "positive"],
            object(&shape::LIMIT_SWITCHES, |_| of("finite")),
        )),
        "home_switch" => Some(required(
            &["from", "to"],
            object(&shape::HOME_SWITCH, |_| of("finite")),
        )),
        "marker" => Some(required(
            &["at"],
            object(&shape::MARKER, |key| match key {
                "every" => of("positive"),
                _ => of("finite"),
            }),
        )),
        _ => None,
    }
}

fn drive() -> Value {
    let never = || any(&[of("scans"), json!({"type": "null"})]);
    let delay = || any(&[integer(0, DELAY_MAX as i64), of("time_literal")]);
    object(&shape::DRIVE, |key| match key {
        "ideal" => object(&shape::IDEAL, |key| match key {
            "delay" => delay(),
            "power_on" => never(),
            _ => switches(key).unwrap_or_else(text),
        }),
        "plant" => required(
            &["inertia"],
            object(&shape::PLANT, |key| match key {
                "power_on" => never(),
                "load" => required(&["inertia", "stiffness"], object(&shape::LOAD, |_| of("finite"))),
                "stops" => required(
                    &["negative", "positive", "stiffness"],
                    object(&shape::STOPS, |_| of("finite")),
                ),
                "gains" => object(&shape::GAINS, |_| of("finite")),
                _ => switches(key).unwrap_or_else(|| of("finite")),
            }),
        ),
        _ => object(&shape::CIA402, |key| match key {
            "delay" => delay(),
            "power_on" => never(),
            "start_up" => of("scans"),
            "quick_stop" => words(&REACTIONS),
            "on_disable" | "on_fault" => words(&[REACTIONS[0], REACTIONS[1]]),
            "homing" => required(
                &["velocity"],
                object(&shape::NODE_HOMING, |key| match key {
                    "direction" => words(&NODE_DIRECTIONS),
                    _ => of("positive"),
                }),
            ),
            "motor" => required(
                &["rated_torque", "inertia"],
                object(&shape::MOTOR, |key| match key {
                    "viscous" | "coulomb" => of("finite"),
                    _ => of("positive"),
                }),
            ),
            _ => switches(key).unwrap_or_else(|| of("finite")),
        }),
    })
}

fn task() -> Value {
    let mut task = object(&shape::TASK, |key| match key {
        "interval" => any(&[integer(1, i64::from(u32::MAX)), of("time_literal")]),
        "single" => of("wire"),
        "watchdog" => integer(1, u32::MAX.into()),
        _ => integer(0, u32::MAX.into()),
    });
    add(
        &mut task,
        "anyOf",
        json!([{"required": ["interval"]}, {"required": ["single"]}]),
    );
    task
}

fn block() -> Value {
    let names: Vec<&str> = REGISTRY.iter().map(|info| info.name).collect();
    let mut block = object(&shape::BLOCK, |key| match key {
        "name" => of("identifier"),
        "type" => json!({"enum": names}),
        "pins" => json!({"type": "object"}),
        _ => text(),
    });
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
        let mut schema = any(&[constant(pin.ty), of("wire")]);
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
        PinType::Time => of("scans"),
        PinType::Axis(_) => of("identifier"),
        PinType::Enum(info) => any(&[words(info.elements), integer(i32::MIN.into(), i32::MAX.into())]),
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
    any(&[rows, required(&["table"], object(&shape::TABLE_USE, |_| text()))])
}

fn wire() -> Value {
    let mut wire = object(&shape::WIRE, |key| match key {
        "any" | "all" => list(text(), 1),
        _ => text(),
    });
    let kinds = shape::WIRE_KINDS.iter().map(|kind| json!({"required": [kind]}));
    add(&mut wire, "oneOf", kinds.collect());
    any(&[wire, of("expression")])
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
    let mut step = object(&shape::STEP, |key| match key {
        "at" | "after" => of("scans"),
        "when" => of("conditions"),
        "every" => json!({"type": "boolean"}),
        "set" => json!({
            "type": "object",
            "additionalProperties": any(&[of("value"), list(json!({"type": "object"}), 0)]),
        }),
        "fault" => required(
            &["axis", "kind"],
            object(&shape::FAULT, |key| match key {
                "kind" => words(&FAULT_KINDS),
                "code" => integer(0, u16::MAX.into()),
                _ => text(),
            }),
        ),
        "clear" => required(&["axis"], object(&shape::CLEAR, |_| text())),
        _ => required(
            &["axis"],
            object(&shape::DRIVE_STEP, |key| match key {
                "displace" => of("finite"),
                "report" => {
                    let mut report = object(&shape::DRIVE_REPORT, |_| of("number"));
                    add(
                        &mut report,
                        "anyOf",
                        json!([{"required": ["position"]}, {"required": ["torque"]}]),
                    );
                    report
                }
                "remote" | "warning" => json!({"type": "boolean"}),
                "input" => required(
                    &["number", "value"],
                    object(&shape::DRIVE_INPUT, |key| match key {
                        "number" => integer(0, i64::from(DIGITAL) - 1),
                        _ => json!({"type": "boolean"}),
                    }),
                ),
                "probe" => required(
                    &["number", "value"],
                    object(&shape::DRIVE_PROBE, |key| match key {
                        "number" => integer(1, PROBES as i64),
                        "at" => of("finite"),
                        _ => json!({"type": "boolean"}),
                    }),
                ),
                _ => text(),
            }),
        ),
    });
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
    let map = json!({
        "type": "object",
        "minProperties": 1,
        "additionalProperties": any(&[of("value"), of("comparison")]),
    });
    any(&[map, of("expression")])
}

fn comparison() -> Value {
    let mut comparison = object(&shape::COMPARISON, |key| match key {
        "ne" => of("value"),
        "same_as" => text(),
        _ => any(&[of("number"), of("time_literal")]),
    });
    add(&mut comparison, "minProperties", json!(1));
    add(
        &mut comparison,
        "dependentRequired",
        json!({"near": ["within"], "within": ["near"]}),
    );
    comparison
}

fn follows() -> Value {
    let follows = object(&shape::FOLLOWS, |key| match key {
        "slave" | "master" => text(),
        "num" => integer(i16::MIN.into(), i16::MAX.into()),
        "den" => integer(1, u16::MAX.into()),
        "anchor" => required(&["master", "slave"], object(&shape::ANCHOR, |_| of("number"))),
        _ => of("conditions"),
    });
    required(&["slave", "master", "num", "den"], follows)
}

fn claim(shape: &Shape) -> Value {
    let kind = shape.keys.first().copied().unwrap_or_default();
    let claim = object(shape, |key| match key {
        "at" | "by" | "within" => of("scans"),
        "for" => any(&[integer(1, SCANS_MAX as i64), of("time_literal")]),
        "from" | "to" => any(&[
            of("scans"),
            required(&["when"], object(&shape::WINDOW_EDGE, |_| of("conditions"))),
        ]),
        "duration" => json!({"type": "array", "items": of("conditions"), "minItems": 2, "maxItems": 2}),
        "le" | "ge" | "eq" => of("scans"),
        "each" => json!({"type": "boolean"}),
        "exclusive" => list(text(), 2),
        "within_limits" => text(),
        "factor" => of("positive"),
        "follows" => follows(),
        _ => of("conditions"),
    });
    if shape.keys.contains(&"that") {
        let second = if kind == "when" { "within" } else { "by" };
        match kind {
            "when" | "after" => required(&[kind, second, "that"], claim),
            _ => required(&[kind, "that"], claim),
        }
    } else {
        required(&[kind], claim)
    }
}
