//! A scenario as a scan script that `standstill run` takes.

use super::run::{Failure, Who};
use super::scenario::{Action, AxisSetup, BlockSetup, FAULT_CODE, Scenario, axis_pins, wired};
use standstill_axis::{
    AboveLimit, AxisConfig, Limits, MoveProfile, OnLimit, OnMasterLost, PowerOff, StartState,
};
use standstill_blocks::{REGISTRY, registry::find};
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

    /// The script. With a failure it claims that what broke the rule does not happen.
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

    /// That what broke the rule does not happen.
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
            let (sign, ns) = (if cell < 0.0 { "-" } else { "" }, cell.abs() as u64);
            format!("\"T#{sign}{}us{}ns\"", ns / 1000, ns % 1000)
        }
        _ => (cell as i64).to_string(),
    }
}

/// The keys of an axis that differ from the default.
fn members(axis: &AxisSetup) -> Vec<String> {
    let config = &axis.config;
    let plain = AxisConfig::new(config.limits);
    let numbers = |parts: &[(&str, Option<f64>)]| {
        let given = parts.iter().filter_map(|(key, value)| Some((key, (*value)?)));
        let given = given.filter(|(_, value)| value.is_finite());
        given
            .map(|(key, value)| format!("\"{key}\": {}", number(value)))
            .collect::<Vec<_>>()
    };
    let Limits {
        velocity,
        acceleration,
        deceleration,
        jerk,
        snap,
    } = config.limits;
    let limits = numbers(&[
        ("velocity", Some(velocity)),
        ("acceleration", Some(acceleration)),
        ("deceleration", Some(deceleration)),
        ("jerk", Some(jerk)),
        ("snap", Some(snap)),
    ]);
    let mut members = vec![format!("\"limits\": {{{}}}", limits.join(", "))];
    let defaults = numbers(&[
        ("acceleration", config.defaults.acceleration),
        ("deceleration", config.defaults.deceleration),
        ("jerk", config.defaults.jerk),
        ("snap", config.defaults.snap),
    ]);
    if !defaults.is_empty() {
        members.push(format!("\"defaults\": {{{}}}", defaults.join(", ")));
    }
    let position = Some(config.position).filter(|position| *position != 0.0);
    members.extend(numbers(&[
        ("position", position),
        ("modulo", config.modulo),
        ("stop_deceleration", config.stop_deceleration),
        ("stop_jerk", config.stop_jerk),
    ]));
    if config.start == StartState::Standstill {
        members.push("\"state\": \"Standstill\"".to_owned());
    }
    if let Some((min, max)) = config.software_limits {
        let ends = numbers(&[("min", Some(min)), ("max", Some(max))]);
        members.push(format!("\"software_limits\": {{{}}}", ends.join(", ")));
    }
    if let Some(scaling) = config.scaling {
        members.push(format!(
            "\"scaling\": {{\"increments\": {}, \"units\": {}, \"invert\": {}, \"offset\": {}}}",
            scaling.increments(),
            scaling.units(),
            scaling.invert(),
            number(scaling.offset())
        ));
    }
    if config.profile != MoveProfile::Overlapped {
        members.push(format!("\"profile\": \"{}\"", config.profile.name()));
    }
    if config.above_limit == AboveLimit::Error {
        members.push("\"above_limit\": \"error\"".to_owned());
    }
    if config.queue != plain.queue {
        members.push(format!("\"queue\": {}", config.queue));
    }
    match config.on_power_off {
        PowerOff::Ramp => {}
        PowerOff::Coast => members.push("\"on_power_off\": \"coast\"".to_owned()),
        PowerOff::Drive => members.push("\"on_power_off\": \"drive\"".to_owned()),
    }
    if config.needs_homed {
        members.push("\"needs_homed\": true".to_owned());
    }
    let following = &config.following;
    let mut coupling = numbers(&[("max_deviation", following.max_deviation)]);
    match following.on_limit {
        OnLimit::Lag => {}
        OnLimit::Error => coupling.push("\"on_limit\": \"error\"".to_owned()),
        OnLimit::SlowMaster => coupling.push("\"on_limit\": \"slow_master\"".to_owned()),
    }
    if following.on_master_lost == OnMasterLost::Hold {
        coupling.push("\"on_master_lost\": \"hold\"".to_owned());
    }
    if following.actual_filter != plain.following.actual_filter {
        coupling.push(format!("\"actual_filter\": {}", following.actual_filter));
    }
    if following.actual_lead {
        coupling.push("\"actual_lead\": true".to_owned());
    }
    if !coupling.is_empty() {
        members.push(format!("\"coupling\": {{{}}}", coupling.join(", ")));
    }
    if (axis.delay, axis.power_on) != (0, 0) {
        members.push(format!(
            "\"drive\": {{\"ideal\": {{\"delay\": {}, \"power_on\": {}}}}}",
            axis.delay, axis.power_on
        ));
    }
    members
}

fn number(value: f64) -> String {
    if value.is_nan() {
        "\"NaN\"".to_owned()
    } else if value.is_infinite() {
        format!("\"{}Infinity\"", if value < 0.0 { "-" } else { "" })
    } else {
        // Adding 0.0 takes the sign off zero.
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
