//! Chains as one motion: blended commands in the same direction within the same limits.
//!
//! Between two such commands all blending modes ask for the velocity that both have. Nothing else has to be reached
//! at the end of the first. So one plan leads to the end of the last command. Its switches may be anywhere, so it has
//! exactly that velocity. The owner changes in each scan in which an end is passed; the plan continues.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; B2, B14. `docs/buffering.md`
//! states which commands are one motion.

use super::commands::{Entry, ROUNDING, Run, Work};
use super::mover::scans_to_goal;
use super::supervision::Arrival;
use super::through::is_braking;
use super::{Axis, Motion};
use crate::{CommandId, ErrorId, Fate, Scope};
use standstill_planner::{Limits, MoveProfile, Plan, Planner, Setpoint};

/// Number of bisections that finds any scan of a plan; its scans are a number of 32 bits.
const HALVINGS: u32 = 32;

/// Rounding of a position, relative to it.
pub(super) const RESOLUTION: f64 = 64.0 * f64::EPSILON;

impl<P: Planner> Axis<P> {
    /// The plan to the end of the last command that is one motion with `entry`; `None` if `entry` is separate.
    ///
    /// No two ends are passed in one scan. If that would happen, a distance shorter than a scan at full velocity ends
    /// the motion before it. `entry` then holds the shorter run.
    ///
    /// Cost: at most two plans with a blended end, three more if the axis brakes or does not reach the wanted
    /// velocity, and [`HALVINGS`] evaluations of the plan for each command.
    pub(super) fn in_one_motion(
        &self,
        entry: &mut Entry,
        start: &Setpoint,
        before: &Limits,
    ) -> Option<P::Plan> {
        let whole = entry.run.count;
        if whole == 0 {
            return None;
        }
        if let Some(plan) = self.through_ends(entry, start, before) {
            return Some(plan);
        }
        let shortest = self.longest_scan(entry);
        let skip = usize::from(self.queue.first().is_some_and(|first| first.id == entry.id));
        (_, entry.run) = self.chain(entry, start.position, skip, shortest);
        if entry.run.count == 0 || entry.run.count == whole {
            return None;
        }
        self.through_ends(entry, start, before)
    }

    /// The longest distance (u) of a motion of `entry` in a scan.
    pub(super) fn longest_scan(&self, entry: &Entry) -> f64 {
        entry.limits.velocity * self.planner.cycle()
    }

    /// The plan through the ends of all commands that are one motion with `entry`, if it passes them in separate
    /// scans.
    fn through_ends(&self, entry: &Entry, start: &Setpoint, before: &Limits) -> Option<P::Plan> {
        let (end, run) = (entry.end?, &entry.run);
        let forward = run.end > end;
        let passing = self.blended(entry, start, run.end, &run.passage, before);
        let plan = match passing {
            Some(plan) => plan,
            None => {
                let planned =
                    self.planner
                        .move_to(MoveProfile::Online, start, run.end, &entry.limits, before);
                planned.ok().filter(|plan| {
                    self.beyond_bound(plan).is_none()
                        && (moves_away(start, forward) || !self.turns(plan, forward))
                })?
            }
        };
        let is_good = self.passes_one_by_one(entry, &plan) && self.is_no_later(entry, start, before, &plan);
        is_good.then_some(plan)
    }

    /// Whether `plan` passes each end of the commands that are one motion with `entry` in a scan of its own.
    fn passes_one_by_one(&self, entry: &Entry, plan: &P::Plan) -> bool {
        let Some(end) = entry.end else { return false };
        let forward = entry.run.end > end;
        let mut passed = passing_scan(plan, 0, end, forward);
        let mut from = end;
        let behind = self.queue.iter().filter(|next| next.id != entry.id);
        behind.take(entry.run.count).all(|next| {
            let Some(end) = self.end_of_leg(next, from, forward) else {
                return false;
            };
            let before = passed;
            passed = passing_scan(plan, before, end, forward);
            from = end;
            // Behind an end that was passed while the owner was held up, each command still has a scan.
            let is_new = !is_past(plan, before, end, forward) || (entry.is_behind && passed > before);
            is_past(plan, passed, end, forward) && is_new
        })
    }

    /// For an axis that brakes to rest at the owner's end: whether `plan` is done no later than that rest and a move
    /// from there.
    fn is_no_later(&self, entry: &Entry, start: &Setpoint, before: &Limits, plan: &P::Plan) -> bool {
        let (
            Motion::Run {
                plan: present,
                elapsed,
                scans,
            },
            Some(owner),
            Some(end),
            true,
        ) = (self.mover.motion(), &self.owner, entry.end, is_braking(start))
        else {
            return true;
        };
        let rest = Setpoint::at_rest(end);
        let leads_to_rest = !self.mover.motion().goes_on() && present.at(*scans) == rest;
        if owner.id != entry.id || !leads_to_rest {
            return true;
        }
        let profile = self.config.profile;
        let onwards = self
            .planner
            .move_to(profile, &rest, entry.run.end, &entry.limits, before);
        let left = scans.saturating_sub(*elapsed);
        onwards.map_or(true, |onwards| {
            goal_past(plan, 0, entry.run.end, entry.run.end > end)
                <= left.saturating_add(u64::from(onwards.scans()))
        })
    }

    /// Whether `plan` moves back anywhere.
    pub(super) fn turns(&self, plan: &P::Plan, forward: bool) -> bool {
        let (up, down) = self.planner.ways((plan, 0));
        let back = if forward { down } else { up };
        back > ROUNDING * (up + down) + RESOLUTION * plan.at(0).position.abs()
    }

    /// The motion along `plan`, with its goal at the end of `entry`. In one motion the plan passes that end before
    /// its own.
    pub(super) fn along(&self, entry: &Entry, plan: P::Plan) -> Motion<P::Plan> {
        match entry.end {
            Some(end) if entry.run.count > 0 => Motion::Run {
                scans: passing_scan(&plan, 0, end, entry.run.end > end),
                plan,
                elapsed: 0,
            },
            Some(end) if entry.passage.wanted > 0.0 && !entry.halted => Motion::Run {
                scans: goal_past(&plan, 0, end, end > plan.at(0).position),
                plan,
                elapsed: 0,
            },
            _ => Motion::along(plan),
        }
    }

    /// Whether the owner's motion passes its end in this scan, and command `id` is next in the same motion.
    pub(super) fn goes_on_to(&self, id: CommandId) -> bool {
        let in_run = |owner: &Entry| owner.run.count > 0;
        self.mover.motion().goes_on()
            && self.goal_reached()
            && !self.is_held_up()
            && self.mover.layer().is_none()
            && self.owner.as_ref().is_some_and(in_run)
            && self.queue.first().is_some_and(|next| next.id == id)
    }

    /// The plan in progress is no longer one motion with the waiting commands: behind the owner's end another plan
    /// follows.
    pub(super) fn end_run(&mut self) {
        if let Some(owner) = &mut self.owner {
            owner.run = Run::NONE;
        }
    }

    /// The owner has passed its end along its plan. If the next command is one motion with it, that command takes
    /// over and continues along the plan. Returns whether it does. In another turn of a modulo axis it does not, and
    /// is planned anew, so that the target is met to the bit.
    pub(super) fn goes_on_along(&mut self, from: f64, scope: &mut Scope<'_>) -> bool {
        let (Some(owner), Some(mut next)) = (self.owner, self.queue.first().copied()) else {
            return false;
        };
        if !self.goes_on_to(next.id) || next.limits != owner.limits {
            return false;
        }
        self.aim(&mut next, from);
        let here = self.mover.setpoint().position;
        let forward = owner.end.is_some_and(|end| owner.run.end > end);
        next.is_behind = next
            .end
            .is_some_and(|end| if forward { here >= end } else { here <= end });
        self.look_through(&mut next, here, 1);
        // The run as it was planned. If the chain is another one now, it is planned anew.
        next.run = Run {
            count: owner.run.count.saturating_sub(1),
            ..owner.run
        };
        if next.turns != 0 || self.end_of_run(&next) != Some(owner.run.end) {
            return false;
        }
        let Motion::Run { plan, elapsed, .. } = self.mover.motion() else {
            return false;
        };
        let goal = match next.end {
            Some(end) if next.run.count > 0 => passing_scan(plan, *elapsed, end, forward),
            Some(end) if owner.run.passage.wanted > 0.0 => goal_past(plan, *elapsed, end, forward),
            _ => scans_to_goal(plan),
        };
        self.mover.set_goal(goal);
        if next.run.count == 0 {
            (next.passage, next.run) = (owner.run.passage, Run::NONE);
        }
        self.queue.pop();
        self.end_owner(Fate::Done);
        self.enter(next.work.manner().start);
        self.record_slowed(&next, &mut scope.with(next.instance));
        self.arrival = Arrival::default();
        self.mover.take_over_from(next.limits);
        self.own(next);
        true
    }

    /// Whether the owner was to pass its end in motion, was held up, and is behind the end now. It then need not go
    /// back there.
    pub(super) fn is_past_its_end(&self, owner: &Entry) -> bool {
        self.way_on(owner, self.mover.setpoint().position).is_some()
    }

    /// The distance (u) of the next command from `place` (u), if that is behind the end of `owner`, which was to be
    /// passed in motion.
    fn way_on(&self, owner: &Entry, place: f64) -> Option<f64> {
        let (end, next) = (owner.end?, self.queue.first()?);
        let forward = self.mover.last_velocity() > 0.0;
        let target = self.end_of_leg(next, end, forward)?;
        // Before a reversal both are on one side of the end, too, but the axis has not been there.
        let is_behind = |position: f64| if forward { position > end } else { position < end };
        let is_onward = is_behind(target) && is_behind(place);
        // A paused owner brakes to rest anywhere.
        let was_to_pass = owner.passage.wanted > 0.0 || owner.paused || owner.is_behind;
        let goes_on = self.mover.layer().is_none() && was_to_pass && next.mode.blends() && is_onward;
        goes_on.then_some(target - place)
    }

    /// The reason why `owner`, which was held up, has to wait at rest behind its end: the next move continues from
    /// there, and its direction is barred.
    pub(super) fn barred_from_there_on(&self, owner: &Entry) -> Option<ErrorId> {
        let next = self.queue.first()?;
        if owner.halted || !self.is_held_up() || !is_move(next) {
            return None;
        }
        let way = self.way_on(owner, self.mover.end_of_plan())?;
        self.way_barred(way)
    }

    /// `owner` is the present owner with other values. If it was held up behind its end and is not one motion with
    /// the next command, hands over to that command. Returns whether it did. A barred command waits; a command that
    /// may need a run-up does not begin here.
    pub(super) fn leaves_to_next(&mut self, mut owner: Entry, scope: &mut Scope<'_>) -> bool {
        let (true, Some(end), Some(next)) = (owner.is_behind && !owner.halted, owner.end, self.queue.first())
        else {
            return false;
        };
        let here = self.mover.base().position;
        let target = self.end_of_leg(next, end, here > end);
        self.look_through(&mut owner, here, 0);
        if !is_move(next)
            || owner.run.count > 0
            || target.is_none_or(|target| self.way_barred(target - here).is_some())
        {
            return false;
        }
        self.own(owner);
        self.hand_over(end, scope);
        self.owner.is_none_or(|now| now.id != owner.id)
    }

    /// The end (u) of the last command that is one motion with `first`, the head of the buffer.
    fn end_of_run(&self, first: &Entry) -> Option<f64> {
        let forward = self.mover.setpoint().velocity > 0.0;
        let mut behind = self.queue.iter().skip(1).take(first.run.count);
        behind.try_fold(first.end?, |from, next| {
            let same = next.mode.blends() && next.work.manner().blends && next.limits == first.limits;
            same.then(|| self.end_of_leg(next, from, forward))?
        })
    }
}

/// Whether a command is a move with an end.
fn is_move(entry: &Entry) -> bool {
    matches!(entry.work, Work::Position(_) | Work::Distance(_))
}

/// Whether a motion towards larger positions (`forward`), or smaller ones, starts in the opposite direction.
fn moves_away(start: &Setpoint, forward: bool) -> bool {
    if forward {
        start.velocity < 0.0
    } else {
        start.velocity > 0.0
    }
}

/// Whether a plan is at or past `end` (u) in this scan.
fn is_past<P: Plan>(plan: &P, scan: u64, end: f64, forward: bool) -> bool {
    let position = plan.at(scan).position;
    if forward { position >= end } else { position <= end }
}

/// The goal of `plan` after the scan `from`, for a command that ends at `end` (u). If the plan leads beyond that end,
/// it is the first scan at or past it.
pub(super) fn goal_past<P: Plan>(plan: &P, from: u64, end: f64, forward: bool) -> u64 {
    let last = plan.at(u64::from(plan.scans())).position;
    let leads_beyond = last != end && (last > end) == forward;
    if plan.turn().is_none() && leads_beyond {
        passing_scan(plan, from, end, forward)
    } else {
        scans_to_goal(plan)
    }
}

/// The first scan after `from` in which `plan` is at or past `end` (u); in `from` it is not there yet. If there is
/// none, the scan of its goal.
fn passing_scan<P: Plan>(plan: &P, from: u64, end: f64, forward: bool) -> u64 {
    let (mut short, mut past) = (from, scans_to_goal(plan));
    for _ in 0..HALVINGS {
        let middle = short + past.saturating_sub(short) / 2;
        if middle == short {
            break;
        }
        if is_past(plan, middle, end, forward) {
            past = middle;
        } else {
            short = middle;
        }
    }
    past
}
