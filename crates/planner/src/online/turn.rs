//! Moves with an acceleration at their target. They pass it while slowing down or speeding up, or turn there: they
//! have velocity 0 at a scan, with the acceleration that leads back.
//!
//! This module has the motion to the target. It does not have the motion behind it, and does not choose speed and
//! acceleration. Equations (O22) to (O26) are in `docs/planner-online.md`.

use super::ends::Ends;
use super::{OnlinePlan, Passage, check};
use crate::kernel::{NOISE, Sides};
use crate::ramp::{self, solve::Ramps};
use crate::{Limits, Order, PlanError, Setpoint};

impl OnlinePlan {
    /// Moves to `target` as `passage` says, with an acceleration against its motion, or with it. `None` if that is
    /// not possible without an earlier reversal, and at order 2, where acceleration may jump.
    ///
    /// With a wanted speed it passes the target at most that fast, somewhere between two scans, and keeps the
    /// acceleration for a scan. Without one it turns there, in the least known number of whole scans
    /// ([`OnlinePlan::turn`]). Then it comes to rest as soon as it can, in case nothing takes over. While speeding
    /// up it passes the target only from a constant velocity, with the speed that one ramp reaches over that
    /// distance; `None` if that is not below the wanted one.
    ///
    /// An acceleration above what `limits` allow at the target is lowered to that. If the path to a turn has no
    /// whole number of scans, the acceleration is lowered until it has one.
    ///
    /// Bounded work: a root of pairs of ramps, for a turn two of these and one of ramps, and at order 3 up to 16
    /// without ramps; at order 4 from rest to a turn only a plan; while speeding up one root of ramps.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::new`].
    pub fn braking(
        start: &Setpoint,
        target: f64,
        passage: &Passage,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Option<Self>, PlanError> {
        let (given, before) = (&(*limits).into(), &(*before).into());
        check(start, target, 0.0, given, before, cycle)?;
        let distance = target - start.position;
        let turns = passage.wanted <= 0.0;
        let pushes = passage.brake < 0.0;
        let most = passage.brake.abs().min(if turns {
            limits.lower_acceleration()
        } else if pushes {
            limits.acceleration
        } else {
            limits.deceleration
        });
        if limits.order() == Order::Two || distance == 0.0 || !(most > 0.0) {
            return Ok(None);
        }
        let side = distance.signum();
        let back = if pushes { side * most } else { -side * most };
        let steepest = Setpoint {
            acceleration: start.acceleration.abs().max(most),
            ..*start
        };
        let wanted = passage.wanted.max(0.0).min(limits.velocity);
        let limits = &given.acting_for(&steepest, wanted, distance, cycle);
        let wider = &given
            .or_larger(before)
            .acting_for(&steepest, wanted, distance, cycle);
        let ramps = Ramps::new(limits, wider);
        // The highest velocity from which it slows down that the velocity bound allows.
        let released = ramps.coasting(&Setpoint {
            acceleration: most,
            ..Setpoint::default()
        });
        let held = if pushes { most * cycle } else { 0.0 };
        let speed = wanted.min(limits.lower_velocity() - released - held);
        if !turns && speed <= most * cycle {
            return Ok(None);
        }
        let end = (if turns { 0.0 } else { side * speed }, back);
        let ends = Ends::new(
            &ramps,
            ramps.inward(distance, 0),
            (ramps.inward(end.0, 1), ramps.inward(end.1, 2)),
            Sides::both(ramps.velocity(side)),
            NOISE * ramps.inward(start.position.abs() + target.abs(), 0),
        );
        let mut plan = Self::nothing(start, target, (0.0, 0.0), ramps.order(), cycle);
        let scan = ramps.scale().moments(cycle);
        let from = ramps.state_inward(&start.at_origin());
        let is_steady = from.acceleration == 0.0 && from.jerk == 0.0;
        let found = if pushes {
            let found = is_steady.then(|| ends.speeding(&from, side)).flatten();
            found.map(|(spans, speed)| (spans, (side * speed / ramps.inward(1.0, 1), end.1)))
        } else {
            let found = ends.braking(&from, side, turns.then_some(scan));
            found.map(|(spans, part)| (spans, (end.0, part * end.1)))
        };
        let Some((spans, end)) = found else {
            return Ok(None);
        };
        if !plan.climb_to_brake(&ramps, &spans, end, limits) {
            return Ok(None);
        }
        plan.found.count(&ends.work);
        let scans = ramp::scans(plan.found.path.duration(), cycle);
        Ok(scans.map(|scans| Self { scans, ..plan }))
    }
}
