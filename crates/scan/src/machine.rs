//! The axes with their drives, and their steps of a scan.

use crate::{NotOff, ScanTime};
use alloc::vec::Vec;
use core::fmt;
use standstill_axis::{
    Axis, AxisConfig, AxisId, CAM_PIECES, CAM_SLOTS, CamPiece, CamSlot, Cams, ConfigError, Drive,
    DriveFeedback, InstanceId, Log, Planner, Scope, Setpoint, Standard, steps,
};
use standstill_fb::{Context, Record, TableRef, Value};

/// The instance number in records that no block instance caused.
pub const RUNTIME: InstanceId = InstanceId(u16::MAX);

/// All axes, the drive under each, and their common ring of records.
#[derive(Clone, Debug)]
pub struct Machine<P: Planner = Standard, D: Drive = standstill_axis::IdealDrive> {
    axes: Vec<Axis<P>>,
    drives: Vec<D>,
    /// This scan's feedback in axis order; empty before the first scan.
    feedback: Vec<DriveFeedback>,
    log: Log,
    /// The numbers of all tables.
    tables: Vec<f64>,
    /// The slots of the store of cams, and their pieces.
    cams: (Vec<CamSlot>, Vec<CamPiece>),
    /// Past set-points of the axes with `vibration`, one axis after the other.
    history: Vec<Setpoint>,
}

impl<P: Planner, D: Drive> Default for Machine<P, D> {
    fn default() -> Self {
        Self {
            axes: Vec::new(),
            drives: Vec::new(),
            feedback: Vec::new(),
            log: Log::default(),
            tables: Vec::new(),
            cams: (Vec::new(), Vec::new()),
            history: Vec::new(),
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
        let mut axis = Axis::new(id, config, planner).map_err(MachineError::Axis)?;
        axis.set_history(self.history.len());
        let places = self.history.len() + axis.history_needed();
        self.history.resize(places, Setpoint::default());
        self.axes.push(axis);
        self.drives.push(drive);
        // Room for a whole scan, so that reading feedback never allocates.
        self.feedback.reserve(self.drives.len());
        Ok(id)
    }

    /// Adds a table for the pins of blocks, given record by record. Uses the heap. `None` if it has more
    /// than 65535 records.
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

    /// Sets up the store of cams with `slots` slots and `pieces` pieces in all. A cam takes one piece
    /// less than it has rows. Uses the heap, about 120 bytes for a piece. Without a store
    /// MC_CamTableSelect has no room. Cams selected before are lost, so call it before the first scan.
    pub fn set_cam_store(&mut self, slots: usize, pieces: usize) {
        self.cams = (Vec::new(), Vec::new());
        self.cams.0.resize(slots, CamSlot::default());
        self.cams.1.resize(pieces, CamPiece::default());
    }

    /// The same with [`CAM_SLOTS`] slots and [`CAM_PIECES`] pieces.
    pub fn set_usual_cam_store(&mut self) {
        self.set_cam_store(CAM_SLOTS, CAM_PIECES);
    }

    /// The selected cams.
    pub fn cams(&mut self) -> Cams<'_> {
        Cams::new(&mut self.cams.0, &mut self.cams.1)
    }

    /// The numbers of all tables; a [`TableRef`] is a place in them. A change has effect from the next
    /// call.
    pub fn tables_mut(&mut self) -> &mut Vec<f64> {
        &mut self.tables
    }

    /// All axes; an [`AxisId`] is an index into them.
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

    /// The feedback of this scan, in axis order; empty before the first scan.
    pub fn feedback(&self) -> &[DriveFeedback] {
        &self.feedback
    }

    /// The records.
    pub fn log(&self) -> &Log {
        &self.log
    }

    /// The context for a block called by `instance`.
    pub fn context(&mut self, time: ScanTime, instance: InstanceId) -> Context<'_, P> {
        Context {
            now_ns: time.now_ns,
            scope: Scope {
                scan: time.scan,
                instance,
                log: &mut self.log,
                cams: Cams::new(&mut self.cams.0, &mut self.cams.1),
                history: &mut self.history,
            },
            axes: &mut self.axes,
            tables: &self.tables,
        }
    }

    /// Reads every drive once, in axis order, then updates the axis states.
    pub(crate) fn read_feedback(&mut self, time: ScanTime) {
        self.feedback.clear();
        self.feedback
            .extend(self.drives.iter_mut().map(|drive| drive.read(time.now_ns)));
        steps::follow(
            &mut self.axes,
            &mut self.drives,
            &self.feedback,
            &mut runtime_scope(time.scan, &mut self.log),
        );
    }

    /// The motion step: advances every axis by one nominal tick, then writes every drive once. Both are in
    /// axis order.
    pub(crate) fn advance(&mut self, time: ScanTime) {
        let mut scope = runtime_scope(time.scan, &mut self.log);
        scope.cams = Cams::new(&mut self.cams.0, &mut self.cams.1);
        scope.history = &mut self.history;
        steps::advance_and_publish(&mut self.axes, &mut self.drives, time.now_ns, &mut scope);
    }

    /// Advances an axis by `steps` motion steps, without its drive. `take` receives the number of each step,
    /// from 0, and its set-point.
    ///
    /// Use it only for as many steps as the axis continues its present motion ([`Axis::goes_on_for`]).
    /// [`Executor::stand`](crate::Executor::stand) advances the time. The host must correct the actual
    /// positions.
    // An iterator would pass each set-point through memory and wait for it. So would a copy.
    #[inline]
    pub fn along(
        &mut self,
        axis: usize,
        time: ScanTime,
        steps: usize,
        mut take: impl FnMut(usize, &Setpoint),
    ) {
        let mut scope = runtime_scope(time.scan, &mut self.log);
        scope.history = &mut self.history;
        let Some(axis) = self.axes.get_mut(axis) else {
            return;
        };
        for step in 0..steps {
            axis.step_alone(&mut scope);
            match axis.setpoint_in_place() {
                Some(setpoint) => take(step, setpoint),
                None => take(step, &axis.setpoint()),
            }
        }
    }

    /// Asks every axis to stop and switch off, each as its configuration says.
    pub(crate) fn power_off(&mut self, scan: u64) {
        steps::switch_off(&mut self.axes, &mut runtime_scope(scan, &mut self.log));
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

/// The scope of records that the machine itself writes in `scan`.
fn runtime_scope(scan: u64, log: &mut Log) -> Scope<'_> {
    Scope {
        instance: RUNTIME,
        ..Scope::new(scan, log)
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
