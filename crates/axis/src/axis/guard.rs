//! The last check before publishing: no set-point of a plan is further from the last one than the limits allow in one
//! scan.
//!
//! Plans are verified when they are made, and tests check them independently. A set-point that is wrong nevertheless
//! is not published: the axis stops from the last good state (ErrorID 904).

use super::commands::ROUNDING;
use super::{Axis, Motion};
use standstill_planner::{Excess, Limits, Planner, Setpoint};

/// The same at the end of a plan, whose last scan may be longer by this part.
pub(super) const LAST_SCAN: f64 = 1.0 / 2048.0;

/// The largest error of a position, relative to the largest position in its computation.
pub(super) const RESOLVED: f64 = 8.0 * f64::EPSILON;

impl<P: Planner> Axis<P> {
    /// Whether `next` may follow the set-point last published.
    ///
    /// Cost: three comparisons for a set-point within the limits in force. Any other is checked against
    /// three more sets of limits: those the plan took over from, those of the axis, and the recorded
    /// unavoidable excess.
    #[inline(always)]
    pub(super) fn is_step(&self, next: Setpoint) -> bool {
        self.is_usual_step(&next) || self.is_wider_step(next)
    }

    /// The same within the limits in force, which is enough for nearly all set-points.
    #[inline(always)]
    fn is_usual_step(&self, next: &Setpoint) -> bool {
        let scan = (1.0 + ROUNDING) * self.planner.cycle();
        steps_within(self.mover.setpoint(), next, self.mover.in_force(), scan, 0.0)
    }

    #[cold]
    #[inline(never)]
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
        steps_within(self.mover.setpoint(), &next, &widest, scan, coarsest)
    }
}

/// Whether position, velocity and acceleration change from `last` to `next` in a `scan` (s) by at most what `limits`
/// allow, plus rounding. The rounding includes that of a position of magnitude `coarsest` (u): an earlier position of
/// the plan, or its end.
#[inline(always)]
pub(super) fn steps_within(
    last: &Setpoint,
    next: &Setpoint,
    limits: &Limits,
    scan: f64,
    coarsest: f64,
) -> bool {
    let resolved = RESOLVED * (last.position.abs() + next.position.abs() + coarsest);
    // `f64::max` would also check for NaN; no limit is NaN.
    let (up, down) = (limits.acceleration, limits.deceleration);
    let steepest = if up > down { up } else { down };
    (next.position - last.position).abs() <= limits.velocity * scan + resolved
        && (next.velocity - last.velocity).abs() <= steepest * scan
        && (next.acceleration - last.acceleration).abs() <= limits.jerk * scan
}
