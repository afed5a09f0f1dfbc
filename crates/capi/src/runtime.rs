//! A runtime: axes with their drives, block instances under keys, and its position in the tick.

use crate::config::refused;
use crate::drive::{AnyDrive, no_feedback};
use crate::recorder::{Order, Recorder};
use crate::storage::{CamStore, List};
use crate::{AxisSetup, AxisStatus, Code, ConfigFault, DriveSetup, Mishap, RecorderConfig, raw};
use core::cell::UnsafeCell;
use core::sync::atomic::{AtomicU32, AtomicUsize};
use standstill_axis::{
    Axis, AxisId, AxisState, Drive, DriveFeedback, DrivePosition, ErrorId, InstanceId, Log, Scope, Setpoint,
    Standard, steps,
};
use standstill_blocks::{BlockInstance, REGISTRY};
use standstill_drives::simulated::{DriveChange, SimulatedDrive};
use standstill_fb::{Context, PinType, axis_number, numbered_axis};

/// The instance number in records without a block; `standstill-scan` has the same.
pub(crate) const NOBODY: InstanceId = InstanceId(u16::MAX);

/// The largest number of axes of a runtime.
pub(crate) const AXES: u32 = 1024;

/// The largest number of instances of a runtime: their numbers in records have 16 bits, and one number
/// means nobody.
pub(crate) const INSTANCES: u32 = 65_534;

/// The largest number of set-points kept.
pub(crate) const HISTORY: u32 = 1 << 24;

/// The largest number of slots of a store of cams: their numbers have 16 bits.
pub(crate) const CAM_SLOTS: u32 = 0xFFFF;

/// The largest number of pieces of a store of cams.
pub(crate) const CAM_PIECES: u32 = 1 << 24;

/// Number of values that the arrays of one block take.
const CELLS: usize = {
    let mut most = 0;
    let mut blocks = REGISTRY;
    while let [block, others @ ..] = blocks {
        let mut cells = 0;
        let mut pins = block.inputs();
        while let [pin, rest @ ..] = pins {
            if let PinType::Table(table) = pin.ty {
                cells += table.most * table.fields.len();
            }
            pins = rest;
        }
        if cells > most {
            most = cells;
        }
        blocks = others;
    }
    most
};

/// The target of a handle. The magic comes first, because it is checked before the rest is known to
/// exist.
#[repr(C)]
pub struct Runtime {
    /// [`MAGIC`] from init to close.
    pub(crate) magic: AtomicU32,
    /// The thread inside, or with an open tick; 0 for none.
    pub(crate) owner: AtomicUsize,
    /// Without distinguishable threads: a call is under way.
    #[cfg(not(feature = "std"))]
    pub(crate) busy: core::sync::atomic::AtomicBool,
    pub(crate) inner: UnsafeCell<Inner>,
}

/// "STST": zeroed or foreign memory is unlikely to begin with it.
pub(crate) const MAGIC: u32 = 0x5453_5453;

/// The scope for actions of no block in `scan`.
fn nobody(scan: u64, log: &mut Log) -> Scope<'_> {
    Scope {
        instance: NOBODY,
        ..Scope::new(scan, log)
    }
}

/// Whether blocks are called.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Mode {
    Running,
    /// Running with a flight recorder that needs the inputs of every call.
    Recorded,
    Stopped,
    /// A panic was caught; without `std` none can be.
    #[cfg_attr(not(feature = "std"), allow(dead_code))]
    Broken,
}

/// The place of an instance.
pub(crate) struct Slot {
    /// Rises whenever the place is given to another instance.
    pub generation: u32,
    pub block: Option<BlockInstance>,
}

/// The part of a runtime that one thread at a time has.
pub(crate) struct Inner {
    pub axes: List<Axis>,
    pub drives: List<AnyDrive>,
    feedback: List<DriveFeedback>,
    pub slots: List<Slot>,
    pub log: Log,
    /// The records of the arrays of the block being called.
    pub cells: [f64; CELLS],
    pub cycle_ns: i64,
    pub scan: u64,
    pub now_ns: i64,
    /// The first tick has begun.
    started: bool,
    /// Between begin and end.
    pub ticking: bool,
    pub mode: Mode,
    /// Axes are to be switched off in the next tick.
    pub off_pending: bool,
    pub fault: ConfigFault,
    /// The flight recorder, if there is one.
    pub recorder: List<Recorder>,
    /// The store of cams, if there is one.
    pub cams: CamStore,
    /// Past set-points of axes with vibration.
    pub history: List<Setpoint>,
    /// Number of set-points that axes have taken.
    history_taken: usize,
}

impl Inner {
    pub fn new(
        axes: List<Axis>,
        drives: List<AnyDrive>,
        feedback: List<DriveFeedback>,
        slots: List<Slot>,
        history: List<Setpoint>,
        cycle_ns: i64,
    ) -> Self {
        Self {
            axes,
            drives,
            feedback,
            slots,
            log: Log::default(),
            cells: [0.0; CELLS],
            cycle_ns,
            scan: 0,
            now_ns: 0,
            started: false,
            ticking: false,
            mode: Mode::Running,
            off_pending: false,
            fault: ConfigFault {
                size: size_of::<ConfigFault>() as u32,
                reserved: 0,
                value: 0.0,
                key: [0; crate::NAME],
            },
            recorder: List::none(),
            cams: CamStore::none(),
            history,
            history_taken: 0,
        }
    }

    /// The flight recorder.
    pub fn recorder(&mut self) -> Result<&mut Recorder, Code> {
        self.recorder.slice_mut().first_mut().ok_or(Code::NoRecorder)
    }

    /// The settings of a flight recorder of this runtime.
    pub fn recorder_order(&self, config: RecorderConfig) -> Order<'_> {
        Order {
            config,
            axes: self.axes.slice(),
            slots: self.slots.slice(),
        }
    }

    /// Takes a flight recorder, or returns its storage.
    pub fn set_recorder(&mut self, recorder: Option<List<Recorder>>) {
        self.recorder = recorder.unwrap_or(List::none());
        if matches!(self.mode, Mode::Running | Mode::Recorded) {
            self.mode = self.at_work();
        }
    }

    /// The mode in which blocks are called.
    fn at_work(&self) -> Mode {
        if self.recorder.len() == 0 {
            Mode::Running
        } else {
            Mode::Recorded
        }
    }

    /// The index of an axis number.
    pub fn place(&self, axis: i32) -> Result<usize, Code> {
        let id = numbered_axis(axis);
        if id.index() < self.axes.len() {
            Ok(id.index())
        } else {
            Err(Code::UnknownAxis)
        }
    }

    /// Adds an axis and returns its number.
    pub fn add_axis(&mut self, setup: &AxisSetup, drive: &DriveSetup) -> Result<i32, Code> {
        let id = u16::try_from(self.axes.len()).map_or(AxisId::NONE, AxisId::new);
        if self.axes.is_full() || id == AxisId::NONE {
            return Err(Code::NoRoom);
        }
        let config = setup
            .config()
            .map_err(|fault| self.refuse(fault.key, fault.value))?;
        let mut axis = Axis::new(id, config, Standard::new(self.cycle_ns as f64 / 1e9)).map_err(|error| {
            let fault = refused(&error);
            self.refuse(fault.key, fault.value)
        })?;
        let drive = AnyDrive::new(drive, axis.config(), self.cycle_ns)
            .map_err(|fault| self.refuse(fault.key, fault.value))?;
        let needed = axis.history_needed();
        if needed > self.history.len() - self.history_taken {
            // The value is the number that the axis needs.
            return Err(self.refuse("vibration", needed as f64));
        }
        axis.set_history(self.history_taken);
        self.history_taken += needed;
        // An initial value only: the first tick reads the drive before any use.
        let feedback = no_feedback(DrivePosition::Units(0.0));
        // All lists have the same capacity, so each has room for it.
        self.axes.push(axis);
        self.drives.push(drive);
        self.feedback.push(feedback);
        Ok(axis_number(id))
    }

    fn refuse(&mut self, key: &'static str, value: f64) -> Code {
        self.fault.key = raw::name(key);
        self.fault.value = value;
        Code::BadConfig
    }

    /// The simulated drive under an axis.
    pub fn simulated(&mut self, axis: i32) -> Result<&mut SimulatedDrive, Code> {
        let place = self.place(axis)?;
        let drive = self.drives.slice_mut().get_mut(place).ok_or(Code::UnknownAxis)?;
        drive.simulated()
    }

    /// Whether the drive under an axis counts increments.
    pub fn counts_increments(&self, axis: i32) -> Result<bool, Code> {
        let axis = self.axes.slice().get(self.place(axis)?);
        Ok(axis.is_some_and(|axis| axis.config().scaling.is_some()))
    }

    /// Applies a disturbance to an axis or to the simulated drive under it.
    pub fn suffer(&mut self, axis: i32, mishap: Mishap, code: u16) -> Result<(), Code> {
        let place = self.place(axis)?;
        let drive = self.simulated(axis)?;
        let is_node = drive.is_cia402();
        let change = match mishap {
            Mishap::Clear => {
                drive.clear_cause();
                if let Some(axis) = self.axes.slice_mut().get_mut(place) {
                    axis.clear_cause();
                }
                return Ok(());
            }
            Mishap::Fault => {
                drive.fail(code);
                return Ok(());
            }
            Mishap::Power => {
                drive.cut_power();
                return Ok(());
            }
            Mishap::Communication => {
                drive.cut_communication();
                return Ok(());
            }
            Mishap::Axis => {
                let scope = &mut nobody(self.scan, &mut self.log);
                if let Some(axis) = self.axes.slice_mut().get_mut(place) {
                    axis.raise(ErrorId::AxisFault, code, scope);
                }
                return Ok(());
            }
            Mishap::Local => DriveChange::Remote(false),
            Mishap::Remote => DriveChange::Remote(true),
            Mishap::Warning => DriveChange::Warning(true),
            Mishap::NoWarning => DriveChange::Warning(false),
        };
        if !is_node {
            return Err(Code::WrongDrive);
        }
        // Only a push can be refused.
        let _done = drive.change(change);
        Ok(())
    }

    /// Begins a tick: drives are read, and axis states are updated.
    pub fn begin(&mut self, now_ns: i64) -> Result<(), Code> {
        if self.started && now_ns < self.now_ns {
            return Err(Code::TimeBackwards);
        }
        self.started = true;
        self.now_ns = now_ns;
        self.ticking = true;
        for (feedback, drive) in self.feedback.slice_mut().iter_mut().zip(self.drives.slice_mut()) {
            *feedback = drive.read(now_ns);
        }
        steps::follow(
            self.axes.slice_mut(),
            self.drives.slice_mut(),
            self.feedback.slice(),
            &mut nobody(self.scan, &mut self.log),
        );
        if core::mem::replace(&mut self.off_pending, false) {
            self.switch_off();
        }
        Ok(())
    }

    /// Ends a tick: advances motion by one cycle, then writes the drives.
    pub fn end(&mut self) {
        if let Some(recorder) = self.recorder.slice_mut().first_mut() {
            recorder.observe(self.axes.slice());
        }
        let mut scope = nobody(self.scan, &mut self.log);
        scope.cams = self.cams.lend();
        scope.history = self.history.slice_mut();
        steps::advance(self.axes.slice_mut(), &mut scope);
        steps::publish(self.axes.slice_mut(), self.drives.slice_mut(), self.now_ns);
        if let Some(recorder) = self.recorder.slice_mut().first_mut() {
            recorder.record(self.scan, self.axes.slice(), self.slots.slice(), &self.log);
        }
        self.scan = self.scan.wrapping_add(1);
        self.ticking = false;
    }

    /// Stops calling blocks, and switches the axes off.
    pub fn stop(&mut self) {
        if matches!(self.mode, Mode::Running | Mode::Recorded) {
            self.mode = Mode::Stopped;
            self.switch_off();
        }
    }

    fn switch_off(&mut self) {
        steps::switch_off(self.axes.slice_mut(), &mut nobody(self.scan, &mut self.log));
    }

    /// Whether every axis is off.
    pub fn check_off(&self) -> Result<(), Code> {
        match steps::first_not_off(self.axes.slice()) {
            None => Ok(()),
            Some(_) => Err(Code::NotOff),
        }
    }

    /// Lets blocks be called again.
    pub fn start(&mut self) -> Result<(), Code> {
        match self.mode {
            Mode::Running | Mode::Recorded => Ok(()),
            Mode::Broken => Err(Code::Internal),
            Mode::Stopped => {
                self.check_off()?;
                self.mode = self.at_work();
                Ok(())
            }
        }
    }

    /// The present data of an axis.
    pub fn status(&self, axis: i32) -> Result<AxisStatus, Code> {
        let place = self.place(axis)?;
        let axis = self.axes.slice().get(place).ok_or(Code::UnknownAxis)?;
        let setpoint = axis.setpoint();
        Ok(AxisStatus {
            size: size_of::<AxisStatus>() as u32,
            state: match axis.state() {
                AxisState::Disabled => 0,
                AxisState::Standstill => 1,
                AxisState::Homing => 2,
                AxisState::DiscreteMotion => 3,
                AxisState::ContinuousMotion => 4,
                AxisState::SynchronizedMotion => 5,
                AxisState::Stopping => 6,
                AxisState::ErrorStop => 7,
            },
            position: setpoint.position,
            velocity: setpoint.velocity,
            acceleration: setpoint.acceleration,
            jerk: setpoint.jerk,
            snap: setpoint.snap,
            actual_position: axis.actual_position(),
            error_id: axis.error_id().number().into(),
            error_code: axis.error_code().into(),
            powered: axis.is_powered().into(),
            homed: axis.is_homed().into(),
        })
    }

    /// The instance of a key.
    #[inline]
    pub fn slot(&mut self, key: u64) -> Result<(u32, &mut BlockInstance), Code> {
        let (number, generation) = (key as u32, (key >> 32) as u32);
        let place = (number as usize).wrapping_sub(1);
        match self.slots.slice_mut().get_mut(place) {
            Some(Slot {
                generation: found,
                block: Some(block),
            }) if *found == generation => Ok((number, block)),
            _ => Err(Code::UnknownKey),
        }
    }

    /// The instance of a key in the form that `find` returns, and its context.
    #[inline]
    pub fn instance<T>(
        &mut self,
        key: u64,
        find: impl FnOnce(&mut BlockInstance) -> Option<&mut T>,
    ) -> Result<(&mut T, Context<'_>), Code> {
        let place = (key as u32 as usize).wrapping_sub(1);
        let slot = self.slots.slice_mut().get_mut(place).ok_or(Code::UnknownKey)?;
        if slot.generation != (key >> 32) as u32 {
            return Err(Code::UnknownKey);
        }
        let missing = if slot.block.is_none() {
            Code::UnknownKey
        } else {
            Code::WrongBlock
        };
        let Some(found) = slot.block.as_mut().and_then(find) else {
            return Err(missing);
        };
        let context = Context {
            now_ns: self.now_ns,
            scope: Scope {
                scan: self.scan,
                // At most 65534, so the conversion is exact.
                instance: InstanceId(key as u16),
                log: &mut self.log,
                cams: self.cams.lend(),
                history: self.history.slice_mut(),
            },
            axes: self.axes.slice_mut(),
            tables: &self.cells,
        };
        Ok((found, context))
    }

    /// Takes a place for a new instance and returns its key. Cost: a search of all places, at most 65534.
    pub fn create(&mut self, block: BlockInstance) -> Result<u64, Code> {
        let slots = self.slots.slice_mut().iter_mut();
        let free = (1_u64..).zip(slots).find(|(_, slot)| slot.block.is_none());
        let (number, slot) = free.ok_or(Code::NoRoom)?;
        slot.block = Some(block);
        Ok(u64::from(slot.generation) << 32 | number)
    }

    /// Frees the place of an instance.
    pub fn release(&mut self, key: u64) -> Result<(), Code> {
        self.slot(key)?;
        let place = (key as u32 as usize).wrapping_sub(1);
        if let Some(slot) = self.slots.slice_mut().get_mut(place) {
            slot.block = None;
            slot.generation = slot.generation.wrapping_add(1);
        }
        Ok(())
    }
}
