//! Hardware limit switches: an axis that moves onto one stops, and an axis on one may only move back.
//!
//! A motion towards an active limit switch is an axis error: ErrorStop, with the stop dynamics. The axis is then at
//! rest behind the edge of the switch, which has to stay active up to the end of the travel. A motion further
//! outwards is refused when it becomes active, like one that MC_Power bars. A homing that searches for a switch or
//! reverses at it uses it without error.

use super::power::Reaction;
use super::{Axis, Permission};
use crate::{DriveSignals, ErrorId, Scope};
use standstill_planner::Planner;

impl<P: Planner> Axis<P> {
    /// Takes this scan's signals. If the drive counts the other way, its positive switch is at the lower
    /// end.
    pub(super) fn latch_signals(&mut self, told: DriveSignals) {
        self.signals = told;
        if self.config.scaling.is_some_and(|scaling| scaling.invert()) {
            self.signals.limit_switch_positive = told.limit_switch_negative;
            self.signals.limit_switch_negative = told.limit_switch_positive;
        }
    }

    /// Whether the limit switch at the upper or the lower end is active.
    #[inline]
    pub(super) fn is_on_limit_switch(&self, up: bool) -> bool {
        if up {
            self.signals.limit_switch_positive
        } else {
            self.signals.limit_switch_negative
        }
    }

    /// After the latch: ErrorStop if the axis moves onto a switch.
    pub(super) fn mind_limit_switches(&mut self, scope: &mut Scope<'_>) {
        let velocity = self.mover.setpoint().velocity;
        let up = velocity > 0.0;
        let minded = self.config.hardware_limits || !self.homing.is_idle();
        if minded && velocity != 0.0 && self.is_on_limit_switch(up) && !self.turns_at_limit_switch(up) {
            self.trip(ErrorId::LimitSwitchReached, 0, Reaction::Ramp, scope);
        }
    }

    /// The directions that neither MC_Power nor a limit switch bars.
    pub(super) fn permission(&self) -> Permission {
        let free = |up: bool| !(self.config.hardware_limits && self.is_on_limit_switch(up));
        let permitted = self.power.permitted();
        Permission {
            positive: permitted.positive && free(true),
            negative: permitted.negative && free(false),
        }
    }

    /// The reason why a motion up or down is barred, if it is.
    pub(super) fn bars(&self, up: bool, down: bool) -> Option<ErrorId> {
        let by_power = self.power.permitted().bars(up, down);
        by_power.or_else(|| {
            let barred = self.permission().bars(up, down);
            barred.map(|_| ErrorId::OutwardFromLimitSwitch)
        })
    }
}
