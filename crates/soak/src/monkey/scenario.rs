//! A run as data: axes, block instances in call order, and what is done to them in which scan.

use standstill_axis::{AxisConfig, AxisId, DrivePosition, IdealDrive, Standard, StartState};
use standstill_blocks::BlockInstance;
use standstill_fb::{AnyInstance, Value};
use standstill_scan::Machine;

/// Axes over ideal drives.
pub type Bench = Machine<Standard, IdealDrive>;

/// Everything a run follows from.
#[derive(Clone, Debug, PartialEq)]
pub struct Scenario {
    /// Length of a scan (ns).
    pub cycle_ns: i64,
    /// How many.
    pub scans: u64,
    /// The axes.
    pub axes: Vec<AxisSetup>,
    /// Instances in call order.
    pub blocks: Vec<BlockSetup>,
    /// What happens, in order of scans.
    pub steps: Vec<Step>,
}

/// An axis with its drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct AxisSetup {
    /// Its configuration.
    pub config: AxisConfig,
    /// Scans from command to actual position.
    pub delay: usize,
    /// Scans until power is confirmed.
    pub power_on: u32,
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
}

/// Something done at the latch of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Step {
    /// The scan.
    pub scan: u64,
    /// What.
    pub action: Action,
}

/// What can be done.
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
        /// What fails.
        kind: FaultKind,
    },
    /// The cause of what failed is gone.
    Clear {
        /// The axis.
        axis: usize,
    },
}

/// What can fail.
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

/// The code faults show.
pub const FAULT_CODE: u16 = 7;

impl AxisSetup {
    fn drive(&self) -> IdealDrive {
        let config = &self.config;
        let position = match config.scaling {
            Some(scaling) => DrivePosition::Increments(scaling.to_increments(config.position)),
            None => DrivePosition::Units(config.position),
        };
        let enabled = config.start == StartState::Standstill;
        IdealDrive::new(position, self.delay, Some(self.power_on), enabled)
    }
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
            machine.add_axis(axis.config, planner, axis.drive()).ok()?;
        }
        Some(machine)
    }

    /// The instances before the first scan; `None` if a block or one of its pins is unknown.
    pub fn instances(&self) -> Option<Vec<BlockInstance>> {
        let made = self.blocks.iter().map(|setup| {
            let mut block = BlockInstance::new(setup.block)?;
            let (axis, _) = block.info().pin("Axis")?;
            block.set(axis, Value::Axis(axis_id(setup.axis))).ok()?;
            for (pin, value) in &setup.constants {
                block.set(*pin, *value).ok()?;
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
