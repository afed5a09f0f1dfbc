//! A scenario as a scan script for `standstill run`.

use super::run::{Failure, Who};
use super::scenario::{Action, AxisSetup, BlockSetup, FAULT_CODE, Scenario, axis_pins, wired};
use standstill_axis::keys::{AXIS, Holds, Key, Object};
use standstill_axis::{AxisConfig, Limits};
use standstill_blocks::{REGISTRY, registry::find};
use standstill_drives::keys::{CIA402, IDEAL, PLANT};
use standstill_drives::simulated::{Cia402Setup, DriveSetup, IdealDriveSetup, PlantSetup};
use standstill_fb::{BlockInfo, Pin, PinType, Value};
use std::fmt::Write;

/// Names of axes.
const AXES: [&str; 3] = ["X", "Y", "Z"];

fn axis_name(axis: usize) -> &'static str {
    AXES.get(axis).copied().unwrap_or("")
}

fn info(block: &str) -> &'static BlockInfo {
    // Names come from the registry.
    find(block).unwrap_or(&REGISTRY[0])
}

impl Scenario {
    /// Name of an instance in the script.
    fn instance_name(&self, block: usize) -> String {
        let name = self.blocks.get(block).map_or("", |setup| setup.block);
        let short = name.split_once('_').map_or(name, |(_, short)| short);
        format!("{short}{}", block + 1)
    }

    fn pin_name(&self, block: usize, pin: usize) -> &'static str {
        let info = self.blocks.get(block).map(|setup| info(setup.block));
        info.and_then(|info| info.pins().nth(pin))
            .map_or("", |pin| pin.name)
    }

    /// The script. With a failure it claims that the broken rule holds.
    pub fn script(&self, failure: Option<&Failure>) -> String {
        let mut text = String::new();
        let title = failure.map_or_else(
            || "A random program".to_owned(),
            |failure| {
                let who = match failure.who {
                    Who::Instance(block) => self.instance_name(block),
                    Who::Axis(axis) => axis_name(axis).to_owned(),
                };
                let broken = failure.broken;
                format!("{} at {who} in scan {}: {}", broken.id, failure.scan, broken.what)
            },
        );
        // Writing to a String cannot fail.
        let _ = write!(
            text,
            "{{\n  \"standstill\": 1,\n  \"title\": {title:?},\n  \"cycle\": \"T#{}us\",\n  \"scans\": {},\n",
            self.cycle_ns / 1000,
            self.scans
        );
        let axes = self.axes.iter().enumerate().map(|(index, axis)| {
            let name = axis_name(index);
            format!("    \"{name}\": {{{}}}", members(axis).join(", "))
        });
        list(&mut text, "axes", '{', axes, '}', false);
        let blocks = self.blocks.iter().enumerate().map(|(index, setup)| {
            let axes = axis_pins(info(setup.block)).map(|(_, pin)| {
                let axis = axis_name(wired(pin, setup.axis, self.axes.len()));
                format!("\"{}\": \"{axis}\"", pin.name)
            });
            let constants = setup
                .constants
                .iter()
                .map(|(pin, value)| format!(", \"{}\": {}", self.pin_name(index, *pin), shown(*value)));
            format!(
                "    {{\"name\": \"{}\", \"type\": \"{}\", \"pins\": {{{}{}{}}}}}",
                self.instance_name(index),
                setup.block,
                axes.collect::<Vec<_>>().join(", "),
                constants.collect::<String>(),
                tables(setup)
            )
        });
        list(&mut text, "blocks", '[', blocks, ']', false);
        let steps = self.steps.iter().map(|step| {
            let action = match step.action {
                Action::Set { block, pin, value } => format!(
                    "\"set\": {{\"{}.{}\": {}}}",
                    self.instance_name(block),
                    self.pin_name(block, pin),
                    shown(value)
                ),
                Action::Fault { axis, kind } => format!(
                    "\"fault\": {{\"axis\": \"{}\", \"kind\": \"{}\", \"code\": {FAULT_CODE}}}",
                    axis_name(axis),
                    kind.name()
                ),
                Action::Clear { axis } => format!("\"clear\": {{\"axis\": \"{}\"}}", axis_name(axis)),
            };
            format!("    {{\"at\": {}, {action}}}", step.scan)
        });
        list(&mut text, "steps", '[', steps, ']', failure.is_none());
        if let Some(failure) = failure {
            list(
                &mut text,
                "expect",
                '[',
                [self.claim(failure)].into_iter(),
                ']',
                true,
            );
        }
        text.push_str("}\n");
        text
    }

    /// The claim that the broken rule holds.
    fn claim(&self, failure: &Failure) -> String {
        let scan = failure.scan;
        let range = format!("    {{\"from\": {scan}, \"to\": {scan}");
        match failure.who {
            Who::Axis(axis) if failure.broken.id == "limits" => {
                format!("{range}, \"within_limits\": \"{}\"}}", axis_name(axis))
            }
            Who::Axis(axis) => {
                let state = failure.state.map_or("", |state| state.name());
                format!(
                    "{range}, \"never\": {{\"{}.State\": \"{state}\"}}}}",
                    axis_name(axis)
                )
            }
            Who::Instance(block) => {
                let name = self.instance_name(block);
                let shown = failure.shown.unwrap_or_default();
                let flags = [
                    ("Busy", shown.busy),
                    ("Active", shown.active),
                    ("Done", shown.done),
                    ("ProfileCompleted", shown.done),
                    ("CommandAborted", shown.aborted),
                    ("Error", shown.error),
                ];
                let block = self.blocks.get(block).map(|setup| info(setup.block));
                let flags = flags
                    .iter()
                    .filter(|(pin, _)| block.is_some_and(|block| block.pin(pin).is_some()))
                    .map(|(pin, value)| format!("\"{name}.{pin}\": {value}"))
                    .collect::<Vec<_>>();
                format!("{range}, \"never\": {{{}}}}}", flags.join(", "))
            }
        }
    }
}

fn list(
    text: &mut String,
    key: &str,
    open: char,
    items: impl Iterator<Item = String>,
    close: char,
    last: bool,
) {
    let items = items.collect::<Vec<_>>().join(",\n");
    let end = if last { "" } else { "," };
    let _ = if items.is_empty() {
        writeln!(text, "  \"{key}\": {open}{close}{end}")
    } else {
        writeln!(text, "  \"{key}\": {open}\n{items}\n  {close}{end}")
    };
}

/// The tables of a block, as further pins.
fn tables(setup: &BlockSetup) -> String {
    let pins = info(setup.block).pins().enumerate();
    let tables = setup.tables.iter().filter_map(|table| {
        let (_, pin) = pins.clone().find(|(place, _)| *place == table.pin)?;
        let PinType::Table(of) = pin.ty else { return None };
        let records = table.records.iter().map(|record| {
            let fields = of.fields.iter().zip(record);
            let fields =
                fields.map(|(field, cell)| format!("\"{}\": {}", field.name, cell_text(field, *cell)));
            format!("{{{}}}", fields.collect::<Vec<_>>().join(", "))
        });
        let records = records.collect::<Vec<_>>().join(", ");
        Some(format!(", \"{}\": [{records}]", pin.name))
    });
    tables.collect()
}

/// A field of a record.
fn cell_text(field: &Pin, cell: f64) -> String {
    match field.ty {
        PinType::Bool => (cell != 0.0).to_string(),
        PinType::Lreal => number(cell),
        PinType::Time => {
            // A larger value is read as the longest possible TIME.
            let ns = (cell.abs() as u64).min(i64::MAX as u64);
            let sign = if cell < 0.0 { "-" } else { "" };
            format!("\"T#{sign}{}us{}ns\"", ns / 1000, ns % 1000)
        }
        _ => (cell as i64).to_string(),
    }
}

/// The keys of an axis that differ from the default.
fn members(axis: &AxisSetup) -> Vec<String> {
    let mut members = keys(&AXIS, &axis.config, &AxisConfig::new(Limits::NONE));
    let drive = match &axis.drive {
        DriveSetup::Ideal(setup) => drive("ideal", &IDEAL, setup, &IdealDriveSetup::PLAIN),
        DriveSetup::Cia402(setup) => drive("cia402", &CIA402, setup, &Cia402Setup::PLAIN),
        DriveSetup::Plant(setup) => drive("plant", &PLANT, setup, &PlantSetup::NONE),
    };
    members.extend(drive);
    members
}

/// A drive that differs from the default ideal drive.
fn drive<T>(name: &str, object: &Object<T>, setup: &T, plain: &T) -> Option<String> {
    let members = keys(object, setup, plain);
    let is_plain = name == "ideal" && members.is_empty();
    (!is_plain).then(|| format!("\"drive\": {{\"{name}\": {{{}}}}}", members.join(", ")))
}

/// The keys of an object that differ from the default, and those that it needs; none if there are none.
fn keys<T>(object: &Object<T>, of: &T, plain: &T) -> Vec<String> {
    let differs =
        |key: &&Key<T>| !key.is_same(of, plain) || key.null.as_ref().is_some_and(|null| (null.is)(of));
    if object.keys.iter().find(differs).is_none() {
        return Vec::new();
    }
    let said = object.keys.iter().filter(|key| key.is_needed() || differs(key));
    said.filter_map(|key| Some(format!("\"{}\": {}", key.name(), held(key, of, plain)?)))
        .collect()
}

/// The value of a key, in the form of a script.
fn held<T>(key: &Key<T>, of: &T, plain: &T) -> Option<String> {
    if key.null.as_ref().is_some_and(|null| (null.is)(of)) {
        return Some("null".to_owned());
    }
    match &key.holds {
        Holds::Bool { get, .. } => Some(get(of).to_string()),
        Holds::Word { words, get, .. } => Some(format!("\"{}\"", words.get(get(of)?)?)),
        Holds::Number { get, .. } => get(of).map(number),
        Holds::Whole { get, .. } | Holds::Scans { get, .. } => Some(get(of)?.to_string()),
        Holds::Object(object) => Some(format!("{{{}}}", keys(object, of, plain).join(", "))),
        Holds::List(places) => {
            let members = places.iter().map(|object| keys(object, of, plain));
            let given = members.filter(|members| !members.is_empty());
            let objects: Vec<_> = given
                .map(|members| format!("{{{}}}", members.join(", ")))
                .collect();
            Some(format!("[{}]", objects.join(", ")))
        }
    }
}

fn number(value: f64) -> String {
    if value.is_nan() {
        "\"NaN\"".to_owned()
    } else if value.is_infinite() {
        format!("\"{}Infinity\"", if value < 0.0 { "-" } else { "" })
    } else {
        // Adding 0.0 removes the sign of zero.
        format!("{:?}", value + 0.0)
    }
}

fn shown(value: Value) -> String {
    match value {
        Value::Bool(value) => value.to_string(),
        Value::Lreal(value) => number(value),
        Value::Enum(value) => value.to_string(),
        Value::Int(value) => value.to_string(),
        Value::Word(value) => value.to_string(),
        Value::Dword(value) => value.to_string(),
        // Only tables without records are drawn.
        Value::Table(_) => "[]".to_owned(),
        Value::Time(value) => value.to_string(),
        Value::Axis(axis) => format!("\"{}\"", axis_name(axis.index())),
    }
}
