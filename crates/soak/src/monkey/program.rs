//! A random program: a scan script in its own form, as JSON.

use super::run::{Failure, Who};
use crate::rules::Kind;
use serde::Serialize;
use serde_json::{Map, Value as Json, json};
use standstill_blocks::registry::find;
use standstill_fb::{BlockInfo, Value};
use standstill_script::ScriptError;
use standstill_script::model::{Instance, Script};

/// The name of a program in messages.
const FILE: &str = "random.scan.json";

/// A scan script.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Program {
    standstill: u32,
    /// Its title.
    pub title: String,
    cycle: String,
    /// Number of scans.
    pub scans: u64,
    /// The axes by name, as in [`standstill_script::write::axis`].
    pub axes: Map<String, Json>,
    /// Instances in call order.
    pub blocks: Vec<Block>,
    /// Steps with one action each, in order of scans.
    pub steps: Vec<Json>,
    /// What is claimed.
    pub expect: Vec<Json>,
}

/// A block instance.
#[derive(Clone, Debug, PartialEq, Serialize)]
pub struct Block {
    /// Its name.
    pub name: String,
    /// IEC name of the block.
    #[serde(rename = "type")]
    pub block: &'static str,
    /// Its axes, constants and tables by pin.
    pub pins: Map<String, Json>,
}

impl Program {
    /// Of scans of this length (ns), without axes.
    pub fn new(cycle_ns: i64, scans: u64) -> Self {
        Self {
            standstill: 1,
            title: "A random program".to_owned(),
            cycle: format!("T#{}us", cycle_ns / 1000),
            scans,
            axes: Map::new(),
            blocks: Vec::new(),
            steps: Vec::new(),
            expect: Vec::new(),
        }
    }

    /// The text of the script, in the canonical layout.
    pub fn text(&self) -> String {
        let text = serde_json::to_string(self).unwrap_or_default();
        standstill_script::format(&text, FILE).unwrap_or(text)
    }

    /// The script, checked.
    ///
    /// # Errors
    /// It cannot run.
    pub fn read(&self) -> Result<Script, ScriptError> {
        standstill_script::read(&self.text(), FILE, &[])
    }

    /// The script with the claim that the broken rule holds.
    #[must_use]
    pub fn claiming(mut self, failure: &Failure) -> Self {
        let (who, claim) = match failure.who {
            Who::Axis(axis) => {
                let name = self.axes.keys().nth(axis).cloned().unwrap_or_default();
                let claim = if failure.broken.id == "limits" {
                    json!({"within_limits": name})
                } else {
                    let state = failure.state.map_or("", |state| state.name());
                    json!({"never": {(format!("{name}.State")): state}})
                };
                (name, claim)
            }
            Who::Instance(index) => {
                let (name, block) = match self.blocks.get(index) {
                    Some(block) => (block.name.clone(), find(block.block)),
                    None => (String::new(), None),
                };
                let shown = failure.shown.unwrap_or_default();
                let flags = [
                    ("Busy", shown.busy),
                    ("Active", shown.active),
                    ("Done", shown.done),
                    ("ProfileCompleted", shown.done),
                    ("CommandAborted", shown.aborted),
                    ("Error", shown.error),
                ];
                let of_block = |(pin, _): &&(&str, bool)| block.is_some_and(|block| block.pin(pin).is_some());
                let flags = flags.iter().filter(of_block);
                let flags: Map<_, _> = flags
                    .map(|(pin, value)| (format!("{name}.{pin}"), (*value).into()))
                    .collect();
                (name, json!({ "never": flags }))
            }
        };
        let (scan, broken) = (failure.scan, failure.broken);
        self.title = format!("{} at {who} in scan {scan}: {}", broken.id, broken.what);
        let mut claim = claim;
        claim["from"] = scan.into();
        claim["to"] = scan.into();
        self.expect.push(claim);
        self
    }
}

/// The part of an instance in a program, for its actor and the rules.
#[derive(Clone, Copy, Debug)]
pub struct Role {
    /// Its block.
    pub info: &'static BlockInfo,
    /// The kind of its block for the rules.
    pub kind: Kind,
    /// Index of the axis that it moves or reads, if it has one.
    pub axis: Option<usize>,
    /// Execute, Enable or JogForward, if it has one of them.
    pub trigger: Option<usize>,
}

impl Role {
    /// Of an instance.
    pub fn of(instance: &Instance) -> Self {
        let info = instance.block;
        let place = |pin: &str| info.pin(pin).map(|(place, _)| place);
        let mut axes = instance.constants.iter().filter_map(|(pin, value)| match value {
            Value::Axis(id) => Some((info.pins().nth(*pin)?.name, id.index())),
            _ => None,
        });
        let axis = axes.find(|(pin, _)| !pin.starts_with("Master"));
        Self {
            info,
            kind: kind_of(info),
            axis: axis.map(|(_, axis)| axis),
            trigger: ["Execute", "Enable", "JogForward"].into_iter().find_map(place),
        }
    }
}

/// The scan of a step.
pub fn scan_of(step: &Json) -> u64 {
    step["at"].as_u64().unwrap_or(0)
}

/// The instance, the pin and the value that a step sets; none for a fault.
pub fn set_by(step: &Json) -> Option<(&str, &str, &Json)> {
    let (signal, value) = step.get("set")?.as_object()?.iter().next()?;
    let (instance, pin) = signal.split_once('.')?;
    Some((instance, pin, value))
}

/// The kind of a block for the rules if its tables are not empty.
pub fn kind_of(info: &BlockInfo) -> Kind {
    match info.name {
        "MC_PositionProfile" | "MC_VelocityProfile" | "MC_AccelerationProfile" => Kind::Motion,
        // Without a drive that holds a torque it is always refused, and the refusal must not change the axis.
        "MC_TorqueControl" => Kind::Motion,
        // The drive has no edges: it waits until it is aborted, or finds the probe in use.
        "MC_TouchProbe" => Kind::Administrative,
        "MC_DigitalCamSwitch" | "MC_ReadActualTorque" => Kind::Reading,
        // Their pins are the inputs and outputs of an axis.
        "MC_ReadDigitalInput" | "MC_ReadDigitalOutput" => Kind::Reading,
        "MC_WriteDigitalOutput" => Kind::Administrative,
        "MC_GearIn" | "MC_GearInPos" | "MC_CombineAxes" | "MC_CamIn" => Kind::Motion,
        // It works in addition to the coupling, which owns the axis; without a coupling it is refused.
        "MC_PhasingAbsolute" | "MC_PhasingRelative" => Kind::Administrative,
        // Its command owns the axis, but the block's outputs do not show that.
        "MC_GearOut" | "MC_CamOut" => Kind::Administrative,
        // It takes some calls, and moves nothing.
        "MC_CamTableSelect" => Kind::Administrative,
        _ => Kind::of(info),
    }
}
