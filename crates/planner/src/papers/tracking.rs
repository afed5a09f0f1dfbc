//! To a target that moves while the axis moves.
//!
//! Zhang, "An investigation of the implementation of S-curve motion profiling model in robotics
//! applications": the essay evaluates the profile of the new target on the old clock, so that position and
//! velocity jump (`docs/papers.md`). Here a new target is planned from the state the axis has, and nothing
//! jumps.

use crate::ramp::path::{moved, zeros};
use crate::{Limits, OnlinePlan, Order, Peaks, PlanError, Segment, Setpoint};

/// An axis that follows a target: the running plan and the elapsed scans.
///
/// The order is that of the limits ([`Limits::order`]). The conditions for start and limits, and the
/// search for each plan, are those of [`OnlinePlan::new`].
#[derive(Clone, Copy, Debug)]
pub struct Tracking {
    limits: Limits,
    cycle: f64,
    plan: OnlinePlan,
    scans: u64,
}

impl Tracking {
    /// From `start` to the first `target` (u) with sample time `cycle` (s). The bounds are those of one plan.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::new`].
    pub fn new(start: &Setpoint, target: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        Ok(Self {
            limits: *limits,
            cycle,
            plan: OnlinePlan::new(start, target, limits, limits, cycle)?,
            scans: 0,
        })
    }

    /// Takes the target that applies from now on. Returns whether this made a new plan.
    ///
    /// The same target again changes nothing: a new plan would end an instant later or earlier because of
    /// rounding.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::new`]; the old target is kept.
    pub fn retarget(&mut self, target: f64) -> Result<bool, PlanError> {
        if target == self.plan.target() {
            return Ok(false);
        }
        self.plan = OnlinePlan::new(&self.now(), target, &self.limits, &self.limits, self.cycle)?;
        self.scans = 0;
        Ok(true)
    }

    /// Advances by `scans`, and returns the set-point there.
    pub fn advance(&mut self, scans: u32) -> Setpoint {
        self.scans += u64::from(scans);
        self.now()
    }

    /// The present set-point.
    pub fn now(&self) -> Setpoint {
        self.plan.at(self.scans)
    }

    /// Whether the axis is at rest on the target.
    pub fn is_there(&self) -> bool {
        self.scans >= u64::from(self.plan.scans())
    }

    /// The running plan, made when the target last changed.
    pub const fn plan(&self) -> &OnlinePlan {
        &self.plan
    }

    /// The executed part of the running plan: its segments up to now, and the wait at its end.
    pub fn executed(&self) -> impl Iterator<Item = Segment> {
        let elapsed = self.scans as f64 * self.cycle;
        let mut left = elapsed;
        let moving = self.plan.segments().map_while(move |segment| {
            let duration = segment.duration.min(left);
            left -= segment.duration;
            (duration > 0.0).then_some(Segment { duration, ..segment })
        });
        moving.chain(Segment::wait(elapsed - self.plan.duration()))
    }
}

/// The largest magnitudes along `segments` of `order`, in closed form: at the ends of each, and at zeros
/// of jerk and acceleration inside. Infinite for derivatives that jump at this order.
pub fn peaks(order: Order, segments: impl IntoIterator<Item = Segment>) -> Peaks {
    let mut peaks = Peaks::default();
    for segment in segments {
        let first = segment.first();
        let [early, late] = zeros(first.acceleration, first.jerk, first.snap);
        let flat = -first.jerk / first.snap;
        for time in [0.0, flat, early, late, segment.duration] {
            if time >= 0.0 && time <= segment.duration {
                peaks.see(&moved(&first, time));
            }
        }
    }
    peaks.with_jumps(order)
}
