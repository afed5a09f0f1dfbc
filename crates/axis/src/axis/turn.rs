//! Turns: if the next command reverses, the axis need not come to rest between the two commands.
//!
//! It reaches the end with velocity 0, exactly and in a scan, with an acceleration that continues into the next
//! command. This module chooses the acceleration, and handles a turn that no command follows. The planner does the
//! calculation.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; B13. `docs/buffering.md`.

use super::commands::{Entry, REST, ROUNDING, Run, Work};
use super::through::keeps_rates;
use super::{Axis, Motion};
use crate::{BufferMode, Scope};
use standstill_planner::{Limits, MoveProfile, Passage, Plan, Planner, Setpoint};

/// Shares of the highest acceleration that are tried at a turn. The first one with which the next command need not go
/// back is used.
const PARTS: [f64; 4] = [1.0, 0.8, 0.6, 0.45];

impl<P: Planner> Axis<P> {
    /// How `entry` passes its `end` (u), which it reaches in `direction`, if `next` reverses there.
    ///
    /// Cost: with software limits one ramp.
    pub(super) fn at_turn(&self, entry: &Entry, next: &Entry, end: Option<f64>, direction: f64) -> Passage {
        let is_move = matches!(next.work, Work::Position(_) | Work::Distance(_));
        if self.modulo.is_some()
            || !is_move
            || next.mode == BufferMode::Buffered
            || self.mover.layer().is_some()
        {
            return REST;
        }
        let most = |entry: &Entry| entry.limits.lower_acceleration();
        let turn = most(entry).min(most(next));
        if self.stops_behind(end, direction, turn) {
            Passage { brake: turn, ..REST }
        } else {
            REST
        }
    }

    /// Whether the stop dynamics keep an axis inside the software limits that is stopped on its way to a turn at
    /// `end` with the acceleration `turn`. The stop has to reduce the deceleration, so it leads beyond the turn.
    fn stops_behind(&self, end: Option<f64>, direction: f64, turn: f64) -> bool {
        let (Some((min, max)), Some(end)) = (self.parameters.software_limits, end) else {
            return true;
        };
        let limits = self.stop_limits();
        let at_turn = Setpoint {
            acceleration: direction * turn,
            ..Setpoint::at_rest(0.0)
        };
        // From the turn on a stop travels further than from before it.
        let stop = self.planner.ramp_to(&at_turn, 0.0, &limits, &limits);
        stop.is_ok_and(|stop| {
            let furthest = end + stop.end().position;
            turn <= limits.lower_acceleration() && min <= furthest && furthest <= max
        })
    }

    /// Whether an axis that is stopped in this state stays inside the software limits.
    pub(super) fn stops_inside(&self, state: &Setpoint) -> bool {
        let Some((min, max)) = self.parameters.software_limits else {
            return true;
        };
        let limits = self.stop_limits();
        let stop = self.planner.ramp_to(state, 0.0, &limits, &limits);
        stop.is_ok_and(|stop| {
            let furthest = stop.end().position;
            keeps_rates(&stop) && min <= furthest && furthest <= max
        })
    }

    /// The plan of `entry` that turns at `end`, if the next command is then done sooner than with a rest.
    ///
    /// Cost: for each of [`PARTS`] a plan and a turn, and two plans with a rest; on average that of seven plans.
    pub(super) fn turned(
        &self,
        entry: &Entry,
        start: &Setpoint,
        (end, passage): (f64, &Passage),
        before: &Limits,
    ) -> Option<P::Plan> {
        let forward = end > start.position;
        let next = self.next_behind(entry)?;
        let target = self.end_of_leg(next, end, forward)?;
        let after = |from: &Setpoint, profile| {
            let limits = &next.limits;
            let planned = self.planner.move_to(profile, from, target, limits, limits);
            let is_straight = |plan: &P::Plan| from.is_at_rest() || !self.turns(plan, !forward);
            planned
                .ok()
                .filter(|plan| plan.excess().is_none() && is_straight(plan))
        };
        let plan = PARTS.iter().find_map(|part| {
            let turn = part * passage.brake;
            let from = Setpoint {
                acceleration: if forward { -turn } else { turn },
                ..Setpoint::at_rest(end)
            };
            let after_turn = after(&from, MoveProfile::Online)?;
            let passage = Passage {
                brake: turn,
                ..*passage
            };
            let planned = self.planner.blend(start, end, &passage, &entry.limits, before);
            let plan = planned.ok().flatten()?;
            let at_turn = plan.at(u64::from(plan.turn()?));
            // To take whole scans, the plan may turn with less acceleration.
            let after = if at_turn.acceleration == from.acceleration {
                after_turn
            } else {
                after(&at_turn, MoveProfile::Online)?
            };
            let is_kept = self.beyond_bound(&plan).is_none();
            is_kept.then_some((plan, after.scans()))
        });
        let (plan, scans) = plan?;
        let rest = after(&Setpoint::at_rest(end), self.config.profile);
        let with_rest = rest.map_or(u64::MAX, |after| {
            let to_rest = self.scans_to_rest(entry, start, end, before);
            to_rest.saturating_add(after.scans().into())
        });
        let turning = u64::from(plan.turn()?).saturating_add(scans.into());
        (turning < with_rest).then_some(plan)
    }

    /// Whether it is in the scan in which it turns at the end of its owner.
    pub(super) fn is_turning(&self) -> bool {
        self.goal_reached() && !self.is_held_up() && self.is_to_turn()
    }

    /// Whether the goal of the motion is a turn.
    fn is_to_turn(&self) -> bool {
        let Motion::Run { plan, scans, .. } = self.mover.motion() else {
            return false;
        };
        plan.turn().map(u64::from) == Some(*scans)
    }

    /// Whether it is too late for new values of `owner`, so that it continues as planned. The present plan passes its
    /// end, turns there or continues as one motion. The new plan `motion` would reach the end only by going back, or
    /// pass it faster than planned and than asked.
    pub(super) fn is_too_late(&self, owner: &Entry, motion: &Motion<P::Plan>, goes_on: bool) -> bool {
        let (Motion::Run { plan, scans, .. }, Some(end)) = (motion, owner.end) else {
            return false;
        };
        let at_end = plan.at(*scans);
        let as_planned = self.mover.goal().unwrap_or(Setpoint::at_rest(end));
        let speed = at_end.velocity.abs();
        // A plan that brakes at its end is slower soon after it.
        let is_faster = speed > as_planned.velocity.abs() || slowing(&at_end) < slowing(&as_planned);
        // A plan on a ramp was found together with the next command, which begins braking or reduces its
        // acceleration.
        let is_on_a_ramp = motion.goes_on();
        let is_too_fast = speed > owner.passage.wanted * (1.0 + ROUNDING) && is_faster && !is_on_a_ramp;
        (self.is_to_turn() || self.is_to_pass(owner) || (goes_on && owner.run.count == 0))
            && self.is_on_its_way(owner)
            && plan.turn().is_none()
            && (is_too_fast || self.turns(plan, end > self.mover.setpoint().position))
    }

    /// Whether `owner`, the present owner with other values, is still on the way to its end as planned.
    fn is_on_its_way(&self, owner: &Entry) -> bool {
        let is_same = |was: &Entry| was.id == owner.id && was.end == owner.end && !was.halted && !was.paused;
        !self.goal_reached() && !owner.halted && self.owner.as_ref().is_some_and(is_same)
    }

    /// Whether `owner`, the present owner with other values, passes its end in motion as planned.
    pub(super) fn passes_as_planned(&self, owner: &Entry) -> bool {
        self.is_on_its_way(owner) && self.is_to_pass(owner)
    }

    /// Whether the goal of the motion is an end that is passed in motion, also for `owner`.
    fn is_to_pass(&self, owner: &Entry) -> bool {
        let is_one = |entry: &Entry| entry.run.count == 0;
        !owner.passage.rests()
            && is_one(owner)
            && self.owner.as_ref().is_some_and(is_one)
            && self.mover.goal().is_some_and(|goal| goal.velocity != 0.0)
    }

    /// Whether the plan in progress already is this `run` with the owner.
    pub(super) fn is_one_motion_as_planned(&self, run: &Run) -> bool {
        let is_it = |was: &Entry| was.run.count == run.count && was.run.end == run.end;
        run.count > 0 && self.owner.as_ref().is_some_and(is_it)
    }

    /// No command takes over at the turn: the axis goes back to the end and comes to rest there.
    #[cold]
    pub(super) fn rest_at_end(&mut self, scope: &mut Scope<'_>) {
        if let Some(owner) = self.owner
            && self.replan(owner, scope).is_err()
        {
            // It comes to rest behind the turn as planned.
            self.halt_behind_end(scope);
        }
    }
}

/// The acceleration against a motion (u/s^2).
fn slowing(state: &Setpoint) -> f64 {
    (-state.velocity.signum() * state.acceleration).max(0.0)
}
