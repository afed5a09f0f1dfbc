//! A run as data: axes, block instances in call order, and the actions in each scan.

use crate::rules::Kind;
use standstill_axis::{AxisConfig, AxisId, Standard};
use standstill_blocks::BlockInstance;
use standstill_drives::simulated::{DriveSetup, SimulatedDrive};
use standstill_fb::{AnyInstance, BlockInfo, Pin, PinType, TableRef, Value};
use standstill_scan::Machine;

/// Axes over simulated drives, as scan scripts have them.
pub type Bench = Machine<Standard, SimulatedDrive>;

/// The full definition of a run.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Length of a scan (ns).
    pub cycle_ns: i64,
    /// Number of scans.
    pub scans: u64,
    /// The axes.
    pub axes: Vec<AxisSetup>,
    /// Instances in call order.
    pub blocks: Vec<BlockSetup>,
    /// The actions, in order of scans.
    pub steps: Vec<Step>,
}

/// An axis with its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSetup {
    /// Its configuration.
    pub config: AxisConfig,
    /// Its drive.
    pub drive: DriveSetup,
}

/// A block instance.
#[derive(Clone, Debug, PartialEq)]
pub struct BlockSetup {
    /// IEC name of the block.
    pub block: &'static str,
    /// Its axis.
    pub axis: usize,
    /// Inputs that hold from the start, by pin.
    pub constants: Vec<(usize, Value)>,
    /// Its tables.
    pub tables: Vec<TableSetup>,
}

/// The table at a pin.
#[derive(Clone, Debug, PartialEq)]
pub struct TableSetup {
    /// The pin.
    pub pin: usize,
    /// Its records, each with all its fields as numbers of a table.
    pub records: Vec<Vec<f64>>,
}

/// An action at the latch of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The scan.
    pub scan: u64,
    /// The action.
    pub action: Action,
}

/// The kinds of actions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Action {
    /// An input of an instance takes a value.
    Set {
        /// The instance.
        block: usize,
        /// Its pin.
        pin: usize,
        /// The value.
        value: Value,
    },
    /// The axis, its drive, its power or its communication fails.
    Fault {
        /// The axis.
        axis: usize,
        /// The kind of fault.
        kind: FaultKind,
    },
    /// The cause of the fault is gone.
    Clear {
        /// The axis.
        axis: usize,
    },
}

/// The kinds of faults.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum FaultKind {
    /// The axis itself.
    Axis,
    /// The drive.
    Drive,
    /// The supply of the power stage.
    Power,
    /// The communication.
    Communication,
}

impl FaultKind {
    /// Its name in scan scripts.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Axis => "axis",
            Self::Drive => "drive",
            Self::Power => "power",
            Self::Communication => "communication",
        }
    }
}

/// The code of injected faults.
pub const FAULT_CODE: u16 = 7;

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

/// The pins of a block that are axes.
pub fn axis_pins(info: &'static BlockInfo) -> impl Iterator<Item = (usize, &'static Pin)> {
    let pins = info.pins().enumerate();
    pins.filter(|(_, pin)| matches!(pin.ty, PinType::Axis(_)))
}

/// The axis of `count` at a pin of a block of `axis`. A master is the next axis, so that all of them
/// could form a ring; a second master is the one after that, which is the same one if there are two.
pub fn wired(pin: &Pin, axis: usize, count: usize) -> usize {
    let further = match pin.name {
        "Master" | "Master1" => 1,
        "Master2" if count > 2 => 2,
        "Master2" => 1,
        _ => 0,
    };
    (axis + further) % count.max(1)
}

impl Scenario {
    /// The cycle (s).
    pub fn cycle(&self) -> f64 {
        self.cycle_ns as f64 / 1e9
    }

    /// The axes and drives before the first scan; `None` if a configuration is refused.
    pub fn machine(&self) -> Option<Bench> {
        let mut machine = Machine::new();
        let planner = Standard::new(self.cycle());
        for axis in &self.axes {
            let drive = SimulatedDrive::new(&axis.drive, &axis.config, self.cycle_ns).ok()?;
            machine.add_axis(axis.config, planner, drive).ok()?;
        }
        let tables = self.blocks.iter().flat_map(|setup| &setup.tables);
        let cells = tables.flat_map(|table| table.records.iter().flatten());
        machine.tables_mut().extend(cells);
        machine.set_usual_cam_store();
        Some(machine)
    }

    /// The instances before the first scan; `None` if a block or one of its pins is unknown.
    pub fn instances(&self) -> Option<Vec<BlockInstance>> {
        let mut first = 0;
        let made = self.blocks.iter().map(|setup| {
            let mut block = BlockInstance::new(setup.block)?;
            for (pin, entry) in axis_pins(block.info()) {
                let axis = wired(entry, setup.axis, self.axes.len());
                block.set(pin, Value::Axis(axis_id(axis))).ok()?;
            }
            for (pin, value) in &setup.constants {
                block.set(*pin, *value).ok()?;
            }
            for table in &setup.tables {
                let records = u16::try_from(table.records.len()).ok()?;
                block
                    .set(table.pin, Value::Table(TableRef { first, records }))
                    .ok()?;
                first += u32::try_from(table.records.iter().map(Vec::len).sum::<usize>()).ok()?;
            }
            Some(block)
        });
        made.collect()
    }
}

/// The handle of an axis.
pub fn axis_id(axis: usize) -> AxisId {
    u16::try_from(axis).map_or(AxisId::NONE, AxisId::new)
}
