//! The response of a block to a value, found by running it: a pin that exists need not be supported yet.

use standstill_axis::{ErrorClass, ErrorId};
use standstill_fb::{BlockInfo, Direction, Pin, PinType};
use standstill_script::{read, run};
use standstill_trace::{Cell, Trace};
use std::collections::BTreeSet;

/// Scans of a probe: enough for an answer of the drive.
const SCANS: u32 = 10;

/// The values of an input that the runtime refuses as not supported, each with the error.
///
/// BOOL pins are tried with TRUE and FALSE, enumerations with every element, each on a powered axis at
/// rest while the other inputs have plain values. A block that cannot be called in this way refuses
/// nothing here.
pub fn refused(info: &BlockInfo, pin: &Pin) -> Vec<(String, ErrorId)> {
    let values: Vec<(String, String)> = match pin.ty {
        _ if pin.direction != Direction::Input || is_trigger(pin.name) => Vec::new(),
        PinType::Bool => [("TRUE", "true"), ("FALSE", "false")]
            .map(|(shown, json)| (shown.into(), json.into()))
            .into(),
        PinType::Enum(elements) => elements
            .elements
            .iter()
            .map(|(name, _)| ((*name).into(), format!("\"{name}\"")))
            .collect(),
        _ => Vec::new(),
    };
    values
        .into_iter()
        .filter_map(|(shown, json)| {
            let trace = called(info, &[(pin.name, &json)])?;
            let errors = unsupported(&trace)
                .difference(&called(info, &[]).map(|trace| unsupported(&trace))?)
                .copied()
                .next();
            Some((shown, errors?))
        })
        .collect()
}

/// Whether an output rises when the block is called with these values; FALSE for a block that cannot be
/// called in this way.
pub fn rises(info: &BlockInfo, values: &[(&str, &str)], output: &str) -> bool {
    called(info, values).is_some_and(|trace| {
        let column = trace.column(&format!("b.{output}"));
        column.is_some_and(|column| trace.cells(column).any(|cell| cell == Cell::Bool(true)))
    })
}

fn is_trigger(name: &str) -> bool {
    name == "Execute" || name == "Enable"
}

/// The errors of class Unsupported that the block showed.
fn unsupported(trace: &Trace) -> BTreeSet<ErrorId> {
    let column = trace.column("b.ErrorID");
    let cells = column.into_iter().flat_map(|column| trace.cells(column));
    cells
        .filter_map(|cell| match cell {
            Cell::Integer(number) => ErrorId::from_number(u16::try_from(number).ok()?),
            Cell::Bool(_) | Cell::Real(_) | Cell::Name(_) => None,
        })
        .filter(|id| id.class() == ErrorClass::Unsupported)
        .collect()
}

/// The block called with plain values and the given ones; every AXIS_REF is an axis of its own.
fn called(info: &BlockInfo, values: &[(&str, &str)]) -> Option<Trace> {
    let mut axes = Vec::new();
    let mut pins = Vec::new();
    for pin in info.pins() {
        let given = values.iter().find(|(name, _)| *name == pin.name);
        let value = match (given, pin.direction, pin.ty) {
            (_, Direction::Output, _) => continue,
            (Some((_, value)), ..) => (*value).to_owned(),
            (None, _, PinType::Axis(_)) => {
                axes.push(format!(
                    "\"{0}\": {{\"limits\": {{\"velocity\": 100, \"acceleration\": 1000, \"jerk\": 10000, \"snap\": \
                     100000}}, \"software_limits\": {{\"min\": -1000, \"max\": 1000}}, \"max_following_error\": 1000, \"state\": \"Standstill\"}}",
                    pin.name
                ));
                format!("\"{}\"", pin.name)
            }
            (None, _, PinType::Bool) if is_trigger(pin.name) => "true".into(),
            (None, _, PinType::Lreal | PinType::Int | PinType::Uint) => "1".into(),
            (None, ..) => continue,
        };
        pins.push(format!("\"{}\": {value}", pin.name));
    }
    let script = format!(
        "{{\"standstill\": 1, \"cycle\": \"T#1ms\", \"scans\": {SCANS}, \"axes\": {{{}}}, \"blocks\": \
         [{{\"name\": \"b\", \"type\": \"{}\", \"pins\": {{{}}}}}]}}",
        axes.join(", "),
        info.name,
        pins.join(", ")
    );
    let script = read(&script, "probe", &[]).ok()?;
    Some(run(&script).ok()?.trace)
}
