//! The power stage of an axis: the requests of MC_Power and the reports of the drive.

use super::Permission;
use crate::{Comms, DriveFeedback, Fault, InstanceId};

/// The known state of the power stage.
#[derive(Clone, Copy, Debug)]
pub(super) struct Power {
    /// MC_Power.Enable.
    wanted: bool,
    /// Operation is enabled, as the drive reported last.
    on: bool,
    stage: Stage,
    /// Latches in a row in which power was requested and not confirmed; counted only if there is a
    /// time-out.
    waited: u64,
    /// The last request of an MC_Power in this scan, unless that instance decides.
    overruled: Option<Wish>,
    /// The directions MC_Power permits.
    permitted: Permission,
    /// The last instance called in the scan before.
    decider: Option<InstanceId>,
    /// Whether power for the stage is available, as last reported.
    voltage: bool,
    /// The fault last reported; only in ErrorStop.
    fault: Option<Fault>,
    /// State of the communication; other than Ok only in ErrorStop.
    comms: Comms,
}

/// The request of an instance of MC_Power.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    pub wanted: bool,
    pub permitted: Permission,
    pub instance: InstanceId,
}

/// The reasons why the stage is not in the state that MC_Power requests.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Stage {
    /// Nothing.
    Ready,
    /// Switched off on request; the axis ramps down or waits for the stage.
    GoingOff,
    /// It is off; the drive, which was asked to stop by itself, has not come to rest.
    Braking,
    /// Power was lost or the drive failed: power does not return before a reset or a new rising Enable.
    Tripped,
    /// The same after power was not confirmed in time.
    Unconfirmed,
}

impl Power {
    /// The initial state: off, or on and requested.
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

    /// It is off, not requested, and the drive stops by itself.
    pub fn is_braking(&self) -> bool {
        self.stage == Stage::Braking && !self.wanted
    }

    /// It does not return by itself.
    pub fn is_tripped(&self) -> bool {
        matches!(self.stage, Stage::Tripped | Stage::Unconfirmed)
    }

    /// The same, because it was not confirmed in time.
    pub fn is_unconfirmed(&self) -> bool {
        self.stage == Stage::Unconfirmed
    }

    /// Latches in a row in which it was requested and not confirmed, if there is a time-out.
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

    /// Whether it is on as requested, with nothing pending.
    pub fn is_routine(&self) -> bool {
        let is_as_wanted = self.on && self.wanted && self.stage == Stage::Ready && self.overruled.is_none();
        let is_well = self.voltage && self.fault.is_none() && self.comms == Comms::Ok;
        is_as_wanted && is_well
    }

    /// Takes the drive's report beside its power; `comms` includes the check of the position.
    pub fn latch(&mut self, feedback: &DriveFeedback, comms: Comms) {
        self.voltage = feedback.voltage;
        self.fault = feedback.fault;
        self.comms = comms;
    }

    /// The drive reported whether operation is enabled. Returns whether it went off while it was requested, and was
    /// not going off.
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

    /// A latch has passed. If it was the last of `timeout` in which power could be confirmed, it trips,
    /// and returns the instance that requests power.
    pub fn wait(&mut self, timeout: u64) -> Option<InstanceId> {
        let waits = self.wanted && !self.on && self.stage == Stage::Ready;
        self.waited = if waits { self.waited.saturating_add(1) } else { 0 };
        if self.waited < timeout {
            return None;
        }
        (self.stage, self.waited) = (Stage::Unconfirmed, 0);
        Some(self.decider.unwrap_or_default())
    }

    /// Power may be requested again, for any cause of its loss.
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

    /// It is off. The drive continues the stop that it was requested to make.
    pub fn leave_to_drive(&mut self) {
        self.stage = Stage::Braking;
    }

    /// The drive has come to rest, or something else takes over.
    pub fn end_braking(&mut self) {
        if self.stage == Stage::Braking {
            self.stage = Stage::Ready;
        }
    }

    /// Takes the request of an MC_Power instance. Returns whether it has effect at once. The decider of
    /// the last scan has; others take effect at the end of the scan if no other was called after them
    /// (V9b).
    pub fn hear(&mut self, wish: Wish) -> bool {
        if *self.decider.get_or_insert(wish.instance) == wish.instance {
            self.overruled = None;
            true
        } else {
            self.overruled = Some(wish);
            false
        }
    }

    /// Whether a request is left to decide at the end of the scan.
    #[inline]
    pub fn is_overruled(&self) -> bool {
        self.overruled.is_some()
    }

    /// The last request in this scan that had no effect yet; its instance decides from now on.
    pub fn take_overruled(&mut self) -> Option<Wish> {
        let wish = self.overruled.take();
        self.decider = wish.map(|wish| wish.instance).or(self.decider);
        wish
    }

    /// Drops the requests of this scan.
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
