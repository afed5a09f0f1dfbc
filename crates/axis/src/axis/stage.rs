//! The power stage under an axis: what MC_Power wants of it and what the drive tells of it.

use super::Permission;
use crate::{Comms, DriveFeedback, Fault, InstanceId};

/// What is known of the power stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    /// MC_Power.Enable.
    wanted: bool,
    /// Operation is enabled, as the drive told last.
    on: bool,
    stage: Stage,
    /// Latches in a row that power was asked for and not confirmed; counted only if that has a time-out.
    waited: u64,
    /// What the last MC_Power of this scan asked for, unless it is the decider.
    overruled: Option<Wish>,
    /// The directions MC_Power permits.
    permitted: Permission,
    /// The instance that spoke last in the scan before.
    decider: Option<InstanceId>,
    /// Power for the stage is available, as last told.
    voltage: bool,
    /// The fault last told; only in ErrorStop.
    fault: Option<Fault>,
    /// State of the communication; other than Ok only in ErrorStop.
    comms: Comms,
}

/// What an instance of MC_Power asked for.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    pub wanted: bool,
    pub permitted: Permission,
    pub instance: InstanceId,
}

/// What keeps the stage from being as MC_Power wants it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Nothing.
    Ready,
    /// Switched off on request; the axis ramps down or waits for the stage.
    GoingOff,
    /// Power was lost or the drive failed: power does not come back before a reset or a new rising Enable.
    Tripped,
    /// The same after power was not confirmed in time.
    Unconfirmed,
}

impl Power {
    /// As it starts: off, or on and wanted.
    pub fn new(powered: bool) -> Self {
        Self {
            wanted: powered,
            on: powered,
            stage: Stage::Ready,
            waited: 0,
            overruled: None,
            permitted: Permission::BOTH,
            decider: None,
            voltage: true,
            fault: None,
            comms: Comms::Ok,
        }
    }

    pub fn is_wanted(&self) -> bool {
        self.wanted
    }

    pub fn is_on(&self) -> bool {
        self.on
    }

    pub fn is_going_off(&self) -> bool {
        self.stage == Stage::GoingOff
    }

    /// It does not come back by itself.
    pub fn is_tripped(&self) -> bool {
        matches!(self.stage, Stage::Tripped | Stage::Unconfirmed)
    }

    /// The same, because it was not confirmed in time.
    pub fn is_unconfirmed(&self) -> bool {
        self.stage == Stage::Unconfirmed
    }

    /// Latches in a row that it was asked for and not confirmed, if that has a time-out.
    pub fn waited(&self) -> u64 {
        self.waited
    }

    pub fn permitted(&self) -> Permission {
        self.permitted
    }

    pub fn has_voltage(&self) -> bool {
        self.voltage
    }

    pub fn fault(&self) -> Option<Fault> {
        self.fault
    }

    pub fn comms(&self) -> Comms {
        self.comms
    }

    /// On as wanted, and nothing is the matter.
    pub fn is_calm(&self) -> bool {
        let is_as_wanted = self.on && self.wanted && self.stage == Stage::Ready && self.overruled.is_none();
        let is_well = self.fault.is_none() && self.comms == Comms::Ok;
        is_as_wanted && is_well
    }

    /// Takes over what a drive without a fault told.
    #[inline]
    pub fn latch_voltage(&mut self, voltage: bool) {
        self.voltage = voltage;
    }

    /// Takes over what the drive told beside its power; `comms` as it is after a look at the position.
    pub fn latch(&mut self, feedback: &DriveFeedback, comms: Comms) {
        self.voltage = feedback.voltage;
        self.fault = feedback.fault;
        self.comms = comms;
    }

    /// The drive told whether operation is enabled. Returns whether it went off although it is wanted and was not asked to.
    pub fn latch_enabled(&mut self, enabled: bool) -> bool {
        let was_on = self.on;
        self.on = enabled;
        was_on && !enabled && self.wanted && !self.is_going_off()
    }

    /// It counts as off.
    pub fn count_as_off(&mut self) {
        self.on = false;
    }

    /// It was lost, or the drive failed.
    pub fn trip(&mut self) {
        if self.stage != Stage::Unconfirmed {
            self.stage = Stage::Tripped;
        }
    }

    /// A latch has gone by. If it was the last of `timeout` in which power could be confirmed, it trips, and the instance that
    /// wants power is returned.
    pub fn wait(&mut self, timeout: u64) -> Option<InstanceId> {
        let waits = self.wanted && !self.on && self.stage == Stage::Ready;
        self.waited = if waits { self.waited.saturating_add(1) } else { 0 };
        if self.waited < timeout {
            return None;
        }
        (self.stage, self.waited) = (Stage::Unconfirmed, 0);
        Some(self.decider.unwrap_or_default())
    }

    /// Whatever took the power away, it may be asked for again.
    pub fn let_return(&mut self) {
        if self.is_tripped() {
            self.stage = Stage::Ready;
        }
    }

    /// It is switched off on request.
    pub fn go_off(&mut self) {
        self.stage = Stage::GoingOff;
    }

    /// It is off, or something else takes over.
    pub fn end_going_off(&mut self) {
        if self.is_going_off() {
            self.stage = Stage::Ready;
        }
    }

    /// An instance of MC_Power speaks. Returns whether it is obeyed at once: the decider of the scan before is, others at the
    /// end of the scan if nobody spoke after them (V9b).
    pub fn hear(&mut self, wish: Wish) -> bool {
        let obeyed = *self.decider.get_or_insert(wish.instance) == wish.instance;
        self.overruled = if obeyed { None } else { Some(wish) };
        obeyed
    }

    /// Something is left to be decided at the end of the scan.
    #[inline]
    pub fn is_overruled(&self) -> bool {
        self.overruled.is_some()
    }

    /// Who spoke last in this scan without being obeyed; it decides from now on.
    pub fn take_overruled(&mut self) -> Option<Wish> {
        let wish = self.overruled.take();
        self.decider = wish.map(|wish| wish.instance).or(self.decider);
        wish
    }

    /// Nobody is heard in this scan any more.
    pub fn forget_overruled(&mut self) {
        self.overruled = None;
    }

    #[inline]
    pub fn want(&mut self, wanted: bool) {
        self.wanted = wanted;
    }

    pub fn permit(&mut self, permitted: Permission) {
        self.permitted = permitted;
    }
}
