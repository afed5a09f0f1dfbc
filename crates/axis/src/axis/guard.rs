//! The last check before publishing: no set-point of a plan is further from the last one than the limits allow in one
//! scan.
//!
//! Plans are verified when they are made, and tests check them independently. A set-point that is wrong nevertheless
//! is not published: the axis stops from the last good state (ErrorID 904).

use super::commands::ROUNDING;
use super::{Axis, Motion};
use crate::ErrorId;
use standstill_planner::{Excess, Limits, Planner, Setpoint};

/// The same at the end of a plan, whose last scan may be longer by this part.
pub(super) const LAST_SCAN: f64 = 1.0 / 2048.0;

/// The largest error of a position, relative to the largest position in its computation.
pub(super) const RESOLVED: f64 = 8.0 * f64::EPSILON;

/// The largest changes of a set-point from one scan to the next: of position (u), velocity (u/s) and acceleration
/// (u/s^2).
#[derive(Clone, Copy, Debug)]
pub(super) struct Steps {
    position: f64,
    velocity: f64,
    acceleration: f64,
}

impl Steps {
    /// What `limits` allow in a `scan` (s).
    #[inline]
    pub fn within(limits: &Limits, scan: f64) -> Self {
        // `f64::max` would also check for NaN; no limit is NaN.
        let (up, down) = (limits.acceleration, limits.deceleration);
        let steepest = if up > down { up } else { down };
        Self {
            position: limits.velocity * scan,
            velocity: steepest * scan,
            acceleration: limits.jerk * scan,
        }
    }

    /// Whether the changes from `last` to `next` are smaller than these, plus rounding; so they are finite. The
    /// rounding includes that of a position of magnitude `coarsest` (u): an earlier position of the plan, or its end.
    #[inline(always)]
    pub fn allow(&self, last: &Setpoint, next: &Setpoint, coarsest: f64) -> bool {
        let resolved = RESOLVED * (last.position.abs() + next.position.abs() + coarsest);
        (next.position - last.position).abs() < self.position + resolved
            && (next.velocity - last.velocity).abs() < self.velocity
            && (next.acceleration - last.acceleration).abs() < self.acceleration
    }
}

impl<P: Planner> Axis<P> {
    /// Why `next` may not follow the set-point last published; none if it may.
    ///
    /// Cost: four comparisons for a set-point within the limits in force. Any other is checked against
    /// three more sets of limits: those the plan took over from, those of the axis, and the recorded
    /// unavoidable excess.
    #[inline(always)]
    pub(super) fn fault_of(&self, next: Setpoint) -> Option<ErrorId> {
        if self.is_usual_step(&next) {
            None
        } else {
            self.fault_of_wider_step(next)
        }
    }

    /// Whether `next` is finite and within the limits in force, which is so for nearly all set-points.
    #[inline(always)]
    fn is_usual_step(&self, next: &Setpoint) -> bool {
        let last = self.mover.setpoint();
        self.mover.steps().allow(last, next, 0.0) && (next.jerk + next.snap).abs() <= f64::MAX
    }

    #[cold]
    #[inline(never)]
    fn fault_of_wider_step(&self, next: Setpoint) -> Option<ErrorId> {
        if !next.is_finite() {
            Some(ErrorId::SetpointBroken)
        } else if !self.is_wider_step(next) {
            Some(ErrorId::SetpointStep)
        } else {
            None
        }
    }

    fn is_wider_step(&self, next: Setpoint) -> bool {
        let layer = self
            .mover
            .layer()
            .and_then(|layer| self.excess_of(layer.motion()));
        let told = [self.excess_of(self.mover.motion()), layer].map(Option::unwrap_or_default);
        let excess = |part: fn(&Excess) -> f64| told.iter().map(part).fold(0.0, f64::max);
        let wider = [
            self.mover.in_force(),
            self.mover.before(),
            &self.config.limits,
            &self.stop_limits(),
        ];
        // A derivative without a limit may step.
        let most = |bound: fn(&Limits) -> f64| wider.iter().map(|limits| bound(limits)).fold(0.0, f64::max);
        let widest = Limits {
            velocity: most(|limits| limits.velocity) + excess(|told| told.velocity),
            acceleration: most(|limits| limits.acceleration.max(limits.deceleration))
                + excess(|told| told.acceleration),
            jerk: most(|limits| limits.jerk) + excess(|told| told.jerk),
            ..*self.mover.in_force()
        };
        let is_last = matches!(self.mover.motion(), Motion::Run { elapsed, scans, .. } if elapsed >= scans);
        let slack = if is_last { LAST_SCAN } else { ROUNDING };
        let scan = (1.0 + slack) * self.planner.cycle();
        // The positions of a plan may be computed from its end, at any distance.
        let coarsest = self.mover.coarsest().max(self.mover.end_of_plan().abs());
        Steps::within(&widest, scan).allow(self.mover.setpoint(), &next, coarsest)
    }
}
