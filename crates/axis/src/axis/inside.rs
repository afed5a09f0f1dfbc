//! Keeping the axis inside its limits when a command takes over.
//!
//! A command may have less jerk or snap than the motion it takes over from. From some states only the limits of the
//! earlier motion can brake in time; with the limits of the command the velocity would exceed that of the axis. An
//! excess that the earlier limits or the axis limits can avoid is not unavoidable, so the command gets those limits,
//! as far as needed.

use super::commands::{Entry, ROUNDING};
use super::{Axis, Motion};
use crate::{ErrorId, Event, Scope};
use standstill_planner::{Excess, Limits, Plan, PlanError, Planner, Setpoint};

/// The excess must become smaller by at least this factor to justify a higher limit.
const WORTH: f64 = 0.99;

impl<P: Planner> Axis<P> {
    /// The excess of `plan` over the axis limits. It is no excess if a slower command takes over from a
    /// faster motion.
    pub(super) fn beyond_axis(&self, plan: &P::Plan) -> Option<Excess> {
        plan.excess()?;
        plan.excess_over(&self.hardest_limits())
    }

    /// The same, and over the limits that slaves leave.
    pub(super) fn beyond_bound(&self, plan: &P::Plan) -> Option<Excess> {
        plan.excess()?;
        plan.excess_over(&self.slowed(&self.hardest_limits()))
    }

    /// The same for a motion.
    pub(super) fn excess_of(&self, motion: &Motion<P::Plan>) -> Option<Excess> {
        match motion {
            // Of a torque: the ramp of its velocity limit.
            Motion::Run { plan, .. } | Motion::Torque { plan, .. } => self.beyond_bound(plan),
            Motion::Hold | Motion::Follow | Motion::Geared | Motion::Closing { .. } => None,
        }
    }

    /// `motion`, which is planned for `entry`, or a motion with higher limits that exceeds those of the
    /// axis by less; `entry` then gets these limits. Cost: at most two plans, for a motion that exceeds.
    ///
    /// # Errors
    /// With the higher limits it would move in a barred direction, so the excess stays.
    pub(super) fn kept_inside(
        &self,
        entry: &mut Entry,
        motion: Motion<P::Plan>,
        start: &Setpoint,
        before: &Limits,
    ) -> Result<Motion<P::Plan>, ErrorId> {
        match self.excess_of(&motion) {
            None => Ok(motion),
            Some(excess) => self.planned_higher(entry, motion, excess, (start, before)),
        }
    }

    #[cold]
    #[inline(never)]
    fn planned_higher(
        &self,
        entry: &mut Entry,
        motion: Motion<P::Plan>,
        mut excess: Excess,
        (start, before): (&Setpoint, &Limits),
    ) -> Result<Motion<P::Plan>, ErrorId> {
        let mut kept = motion;
        let axis = self.slowed(&self.config.limits);
        for limits in self.higher(&entry.limits, before, &axis) {
            let mut raised = Entry { limits, ..*entry };
            let motion = match self.plan_from(&mut raised, start, before) {
                Ok(motion) => motion,
                Err(
                    error @ (ErrorId::PositiveBarred
                    | ErrorId::NegativeBarred
                    | ErrorId::OutwardFromLimitSwitch),
                ) => return Err(error),
                Err(_) => continue,
            };
            let left = self.excess_of(&motion);
            if is_less(left, &excess) {
                (kept, *entry) = (motion, raised);
                match left {
                    Some(left) => excess = left,
                    None => break,
                }
            }
        }
        if self.is_slowed() {
            kept = self.planned_free(entry, kept, start, before);
        }
        Ok(kept)
    }

    /// If the limits that slaves leave would take the axis beyond its own limits, uses its own limits. The slaves
    /// then lag.
    fn planned_free(
        &self,
        entry: &mut Entry,
        motion: Motion<P::Plan>,
        start: &Setpoint,
        before: &Limits,
    ) -> Motion<P::Plan> {
        let axis = &self.config.limits;
        // A stop that turns back has an excess, too, but exceeds no limit of the axis.
        let leaves = |motion: &Motion<P::Plan>| match motion {
            Motion::Run { plan, .. }
                if plan.excess_over(axis).is_some_and(|excess| excess.velocity > 0.0) =>
            {
                let most = self.planner.peaks((plan, 0));
                most.is_none_or(|most| most.velocity > axis.velocity * (1.0 + ROUNDING))
            }
            _ => false,
        };
        if !leaves(&motion) {
            return motion;
        }
        let limits = axis.with_velocity(entry.limits.velocity);
        let mut free = Entry { limits, ..*entry };
        match self.plan_from(&mut free, start, before) {
            Ok(planned) if !leaves(&planned) => {
                *entry = free;
                planned
            }
            _ => motion,
        }
    }

    /// The ramp to rest without a command, from `start`, a state of a motion within `before`. It keeps `limits`, or
    /// higher ones if these can't keep the axis inside `axis`; `limits` is set to those used. Cost: at most three
    /// ramps.
    ///
    /// # Errors
    /// That of the ramp within `limits`.
    pub(super) fn stopped_inside(
        &self,
        start: &Setpoint,
        limits: &mut Limits,
        before: &Limits,
        axis: &Limits,
    ) -> Result<P::Plan, PlanError> {
        let planned = |limits: &Limits| self.planner.ramp_to(start, 0.0, limits, before);
        let first = planned(limits)?;
        Ok(self.least_beyond(first, limits, (before, axis), planned))
    }

    /// A move of the axis to `target`, and its limits: these, or higher ones if these can't keep the axis inside its
    /// own.
    ///
    /// # Errors
    /// Those of [`Planner::move_to`].
    pub(super) fn moved_inside(
        &self,
        start: &Setpoint,
        target: f64,
        limits: Limits,
        before: &Limits,
    ) -> Result<(P::Plan, Limits), PlanError> {
        self.planned_inside(limits, |limits| {
            let profile = self.config.profile;
            self.planner.move_to(profile, start, target, limits, before)
        })
    }

    /// The plan that `planned` makes with `limits`, or with higher ones if these can't keep the axis inside its own,
    /// and the limits used. Cost: at most three plans.
    ///
    /// # Errors
    /// That of `planned` with `limits`.
    pub(super) fn planned_inside(
        &self,
        mut limits: Limits,
        planned: impl Fn(&Limits) -> Result<P::Plan, PlanError>,
    ) -> Result<(P::Plan, Limits), PlanError> {
        let first = planned(&limits)?;
        let axis = self.slowed(&self.parameters.limits);
        let plan = self.least_beyond(first, &mut limits, (self.mover.in_force(), &axis), planned);
        Ok((plan, limits))
    }

    /// `plan`, or a plan that `again` makes with higher limits (from `before` or `axis`) if that exceeds `axis` by
    /// less.
    fn least_beyond(
        &self,
        plan: P::Plan,
        limits: &mut Limits,
        (before, axis): (&Limits, &Limits),
        again: impl Fn(&Limits) -> Result<P::Plan, PlanError>,
    ) -> P::Plan {
        let beyond = |plan: &P::Plan| plan.excess().and_then(|_| plan.excess_over(axis));
        let Some(mut excess) = beyond(&plan) else {
            return plan;
        };
        let mut kept = plan;
        for higher in self.higher(limits, before, axis) {
            let Ok(plan) = again(&higher) else {
                continue;
            };
            let left = beyond(&plan);
            if is_less(left, &excess) {
                (kept, *limits) = (plan, higher);
                match left {
                    Some(left) => excess = left,
                    None => break,
                }
            }
        }
        kept
    }

    /// Higher limits to try: with jerk and snap of the motion before, and with rates, jerk and snap of the `axis`.
    pub(super) fn higher(&self, limits: &Limits, before: &Limits, axis: &Limits) -> [Limits; 2] {
        [
            Limits {
                jerk: limits.jerk.max(before.jerk),
                snap: limits.snap.max(before.snap),
                ..*limits
            },
            Limits {
                velocity: limits.velocity,
                acceleration: limits.acceleration.max(axis.acceleration),
                deceleration: limits.deceleration.max(axis.deceleration),
                jerk: limits.jerk.max(axis.jerk),
                snap: limits.snap.max(axis.snap),
            },
        ]
    }

    /// Records which limits of a command were raised.
    pub(super) fn record_raised(&self, asked: &Limits, used: &Limits, scope: &mut Scope<'_>) {
        for (pin, value, limit) in pins("", asked, used).into_iter().skip(1) {
            if limit > value {
                self.record(Event::Raised { pin, value, limit }, scope);
            }
        }
    }
}

/// The pins of dynamic values, with those of `asked` and `used`; `velocity` is the name of the first.
pub(super) fn pins(velocity: &'static str, asked: &Limits, used: &Limits) -> [(&'static str, f64, f64); 5] {
    [
        (velocity, asked.velocity, used.velocity),
        ("Acceleration", asked.acceleration, used.acceleration),
        ("Deceleration", asked.deceleration, used.deceleration),
        ("Jerk", asked.jerk, used.jerk),
        ("Snap", asked.snap, used.snap),
    ]
}

/// Whether `left` is clearly less than `excess`: in velocity, otherwise in acceleration, otherwise in jerk.
fn is_less(left: Option<Excess>, excess: &Excess) -> bool {
    let Some(left) = left else { return true };
    let parts = [
        (left.velocity, excess.velocity),
        (left.acceleration, excess.acceleration),
        (left.jerk, excess.jerk),
    ];
    let differing = parts
        .iter()
        .find(|(left, was)| *left < *was * WORTH || *was < *left * WORTH);
    differing.is_some_and(|(left, was)| left < was)
}
