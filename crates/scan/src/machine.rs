//! The axes with their drives, and what a scan does to them.

use crate::{NotOff, ScanTime};
use alloc::vec::Vec;
use core::fmt;
use standstill_axis::{
    Axis, AxisConfig, AxisId, ConfigError, Drive, DriveFeedback, InstanceId, Log, Planner, Source, Standard,
    steps,
};
use standstill_fb::{Context, Record, TableRef, Value};

/// The instance in records of what no block instance caused.
pub const RUNTIME: InstanceId = InstanceId(u16::MAX);

/// All axes, the drive under each, and their common ring of records.
#[derive(Clone, Debug)]
pub struct Machine<P: Planner = Standard, D: Drive = standstill_axis::IdealDrive> {
    axes: Vec<Axis<P>>,
    drives: Vec<D>,
    /// This scan's feedback in axis order; empty before the first scan.
    feedback: Vec<DriveFeedback>,
    /// Places of all axes in the order of the motion step.
    order: Vec<AxisId>,
    log: Log,
    /// The numbers of all tables.
    tables: Vec<f64>,
}

impl<P: Planner, D: Drive> Default for Machine<P, D> {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            drives: Vec::new(),
            feedback: Vec::new(),
            order: Vec::new(),
            log: Log::default(),
            tables: Vec::new(),
        }
    }
}

impl<P: Planner, D: Drive> Machine<P, D> {
    /// A machine without axes.
    pub fn new() -> Self {
        Self::default()
    }

    /// Adds an axis with its drive; the only step that uses the heap.
    ///
    /// # Errors
    /// [`MachineError`] if the configuration is not usable or there are 65535 axes.
    pub fn add_axis(&mut self, config: AxisConfig, planner: P, drive: D) -> Result<AxisId, MachineError> {
        let id = u16::try_from(self.axes.len())
            .map(AxisId::new)
            .ok()
            .filter(|id| *id != AxisId::NONE)
            .ok_or(MachineError::TooManyAxes)?;
        let axis = Axis::new(id, config, planner).map_err(MachineError::Axis)?;
        self.axes.push(axis);
        self.drives.push(drive);
        self.order.push(id);
        // Room for a whole scan, so that reading feedback never allocates.
        self.feedback.reserve(self.drives.len());
        Ok(id)
    }

    /// Adds a table for the pins of blocks, record after record; uses the heap. `None` if it has more than 65535 records.
    pub fn add_table<R: Record>(&mut self, records: &[R]) -> Option<TableRef> {
        let place = TableRef {
            first: u32::try_from(self.tables.len()).ok()?,
            records: u16::try_from(records.len()).ok()?,
        };
        let cell = |record: &R, field| record.get(field).and_then(Value::to_cell).unwrap_or_default();
        for record in records {
            let cells = (0..R::PINS.len()).map(|field| cell(record, field));
            self.tables.extend(cells);
        }
        Some(place)
    }

    /// The numbers of all tables: places in here are those of [`TableRef`]. A change counts from the next call on.
    pub fn tables_mut(&mut self) -> &mut Vec<f64> {
        &mut self.tables
    }

    /// The order of the motion step, in which masters must stand before their slaves. Without this call it
    /// is the order in which axes were added.
    ///
    /// # Errors
    /// [`OrderError`] unless each axis stands in `order` exactly once; the order then stays as it was.
    pub fn set_advance_order(&mut self, order: &[AxisId]) -> Result<(), OrderError> {
        for (index, id) in order.iter().enumerate() {
            if id.index() >= self.axes.len() {
                return Err(OrderError::Unknown { axis: *id });
            }
            if order.iter().take(index).any(|other| other == id) {
                return Err(OrderError::Twice { axis: *id });
            }
        }
        if order.len() != self.axes.len() {
            return Err(OrderError::Missing {
                given: order.len(),
                axes: self.axes.len(),
            });
        }
        self.order = order.to_vec();
        Ok(())
    }

    /// All axes; an [`AxisId`] is a place in here.
    pub fn axes(&self) -> &[Axis<P>] {
        &self.axes
    }

    /// All axes.
    pub fn axes_mut(&mut self) -> &mut [Axis<P>] {
        &mut self.axes
    }

    /// All drives, in axis order.
    pub fn drives(&self) -> &[D] {
        &self.drives
    }

    /// All drives, in axis order.
    pub fn drives_mut(&mut self) -> &mut [D] {
        &mut self.drives
    }

    /// What the drives told in this scan, in axis order; empty before the first scan.
    pub fn feedback(&self) -> &[DriveFeedback] {
        &self.feedback
    }

    /// The records.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// What a block called by `instance` may touch.
    pub fn context(&mut self, time: ScanTime, instance: InstanceId) -> Context<'_, P> {
        Context {
            now_ns: time.now_ns,
            scan: time.scan,
            instance,
            axes: &mut self.axes,
            log: &mut self.log,
            tables: &self.tables,
        }
    }

    /// Reads every drive once, in axis order, then lets the axis states follow.
    pub(crate) fn read_feedback(&mut self, time: ScanTime) {
        self.feedback.clear();
        self.feedback
            .extend(self.drives.iter_mut().map(|drive| drive.read(time.now_ns)));
        steps::follow(
            &mut self.axes,
            &mut self.drives,
            &self.feedback,
            time.scan,
            &mut self.log,
        );
    }

    /// Advances every axis by one nominal tick, in advance order; a late scan does not stretch a motion.
    pub(crate) fn advance(&mut self, time: ScanTime) {
        for id in &self.order {
            if let Some(axis) = self.axes.get_mut(id.index()) {
                axis.advance(time.scan, &mut self.log);
            }
        }
    }

    /// Writes every drive once, in axis order.
    pub(crate) fn publish(&mut self, time: ScanTime) {
        steps::publish(&mut self.axes, &mut self.drives, time.now_ns);
    }

    /// Asks every axis to stop and switch off, each as its configuration says.
    pub(crate) fn power_off(&mut self, scan: u64) {
        let source = Source {
            scan,
            instance: RUNTIME,
        };
        steps::switch_off(&mut self.axes, source, &mut self.log);
    }

    /// Whether every axis is Disabled, or in ErrorStop and at rest.
    ///
    /// # Errors
    /// [`NotOff`] with the first axis that is not.
    pub fn is_off(&self) -> Result<(), NotOff> {
        let on = steps::first_not_off(&self.axes);
        on.map_or(Ok(()), |(axis, state)| Err(NotOff { axis, state }))
    }
}

/// Why an axis was not added.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum MachineError {
    /// Its configuration is not usable.
    Axis(ConfigError),
    /// No handle is left.
    TooManyAxes,
}

impl fmt::Display for MachineError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Axis(error) => error.fmt(f),
            Self::TooManyAxes => write!(f, "a machine has at most 65535 axes: use a second one"),
        }
    }
}

impl core::error::Error for MachineError {}

/// Why an advance order was refused.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum OrderError {
    /// There is no such axis.
    Unknown {
        /// The handle.
        axis: AxisId,
    },
    /// An axis stands twice.
    Twice {
        /// The axis.
        axis: AxisId,
    },
    /// Some axes are missing.
    Missing {
        /// Axes in the order.
        given: usize,
        /// Axes of the machine.
        axes: usize,
    },
}

impl fmt::Display for OrderError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Unknown { axis } => write!(f, "there is no axis {}: remove it", axis.index()),
            Self::Twice { axis } => write!(f, "axis {} stands twice: name each axis once", axis.index()),
            Self::Missing { given, axes } => {
                write!(
                    f,
                    "the order has {given} of {axes} axes: name each axis exactly once"
                )
            }
        }
    }
}

impl core::error::Error for OrderError {}
