//! Moves that turn at their target: velocity 0 there, in a scan, with the acceleration that leads back.
//!
//! What stands here: the motion to the turn. What does not: what comes behind it, and which acceleration is best. Equations
//! (O22) and (O23) are in `docs/planner-online.md`.

use super::ends::Ends;
use super::ladder::Found;
use super::{OnlinePlan, check};
use crate::kernel::{NOISE, Sides};
use crate::ramp::{self, solve::Ramps};
use crate::{Limits, Order, PlanError, Setpoint};

impl OnlinePlan {
    /// Comes to `target` in the least number of whole scans known ([`OnlinePlan::turn`]), with velocity 0 and the `acceleration`
    /// (u/s^2, 0 or more) that leads back from there; `None` where that can't be had without going back before, and at
    /// order 2, where acceleration may jump.
    ///
    /// Behind the turn the plan comes to rest as soon as it can, for the case that nobody takes over. An acceleration above the lower
    /// one of acceleration and deceleration is lowered to it.
    ///
    /// Bounded work: two roots of pairs of ramps.
    ///
    /// # Errors
    /// As [`OnlinePlan::new`].
    pub fn turning(
        start: &Setpoint,
        target: f64,
        acceleration: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Option<Self>, PlanError> {
        let (given, before) = (&(*limits).into(), &(*before).into());
        check(start, target, 0.0, given, before, cycle)?;
        let distance = target - start.position;
        let most = acceleration.min(limits.lower_acceleration());
        if limits.order() == Order::Two || distance == 0.0 || !(most > 0.0) {
            return Ok(None);
        }
        let side = distance.signum();
        let back = -side * most;
        let steepest = Setpoint {
            acceleration: start.acceleration.abs().max(most),
            ..*start
        };
        let limits = &given.acting_for(&steepest, 0.0, distance, cycle);
        let wider = &given
            .or_larger(before)
            .acting_for(&steepest, 0.0, distance, cycle);
        let ramps = Ramps::new(limits, wider);
        let ends = Ends::new(
            &ramps,
            ramps.inward(distance, 0),
            (0.0, ramps.inward(back, 2)),
            Sides::both(ramps.velocity(side)),
            NOISE * ramps.inward(start.position.abs() + target.abs(), 0),
        );
        let mut plan = Self {
            start: *start,
            target,
            end_velocity: 0.0,
            end_acceleration: 0.0,
            cycle,
            scans: 0,
            found: Found::nothing(ramps.order()),
        };
        let origin = Setpoint {
            position: 0.0,
            ..*start
        };
        let scan = ramps.scale().moments(cycle);
        let Some(spans) = ends.turning(&ramps.state_inward(&origin), side, scan) else {
            return Ok(None);
        };
        if !plan.climb_to_turn(&ramps, &spans, back, limits) {
            return Ok(None);
        }
        (plan.found.solves, plan.found.steps) = (ends.solves(), ends.steps());
        let scans = ramp::scans(plan.found.path.duration(), cycle);
        Ok(scans.map(|scans| Self { scans, ..plan }))
    }
}
