//! Chains as one motion: blended commands that lead on the same way within the same limits.
//!
//! All blending modes ask for the same velocity between them, the one both have, so nothing has to end where the first does: one
//! plan, whose switches lie anywhere so that it has exactly that velocity, leads to the end of the last. The owner changes in
//! each scan in which an end is passed; the plan goes on.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; B2, B14. `docs/buffering.md` tells which
//! commands are one motion.

use super::commands::{Entry, ROUNDING, Run, Work};
use super::mover::scans_to_goal;
use super::supervision::Arrival;
use super::through::is_braking;
use super::{Axis, Motion};
use crate::{CommandId, ErrorId, Fate, Scope};
use standstill_planner::{Limits, MoveProfile, Plan, Planner, Setpoint};

/// Halvings that find any scan of a plan, whose scans are a number of 32 bits.
const HALVINGS: u32 = 32;

/// Rounding of a position, relative to it.
pub(super) const RESOLUTION: f64 = 64.0 * f64::EPSILON;

impl<P: Planner> Axis<P> {
    /// The plan to the end of the last command that is one motion with `entry`; `None` if that is on its own.
    ///
    /// No two ends are passed in one scan. Where they would be, ways that take less than a scan at full speed are no part of it, and the
    /// entry then says so.
    ///
    /// Cost: at most two plans with a blended end, three more for one that is told late, and [`HALVINGS`] looks at the plan for
    /// each command.
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

    /// How far (u) a motion of `entry` leads in a scan at most.
    pub(super) fn longest_scan(&self, entry: &Entry) -> f64 {
        entry.limits.velocity * self.planner.cycle()
    }

    /// The plan through the ends of all that is one motion with `entry`, if there is one that passes them one by one.
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

    /// Whether `plan` has each end of what is one motion with `entry` in a scan of its own.
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
            // Behind an end that was passed while it was held up each has a scan all the same.
            let is_new = !is_past(plan, before, end, forward) || (entry.is_behind && passed > before);
            is_past(plan, passed, end, forward) && is_new
        })
    }

    /// Whether `plan` is done no later than the plan to rest in progress, and a move from there.
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

    /// Whether `plan` goes back on its way.
    pub(super) fn turns(&self, plan: &P::Plan, forward: bool) -> bool {
        let (up, down) = self.planner.ways((plan, 0));
        let back = if forward { down } else { up };
        back > ROUNDING * (up + down) + RESOLUTION * plan.at(0).position.abs()
    }

    /// Along `plan`, up to the end of `entry`, which the plan of one motion passes before its own.
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

    /// The owner's motion passes its end at which it is now, and command `id` is next on its way.
    pub(super) fn goes_on_to(&self, id: CommandId) -> bool {
        let in_run = |owner: &Entry| owner.run.count > 0;
        self.mover.motion().goes_on()
            && self.goal_reached()
            && !self.is_held_up()
            && self.mover.layer().is_none()
            && self.owner.as_ref().is_some_and(in_run)
            && self.queue.first().is_some_and(|next| next.id == id)
    }

    /// The plan in progress is no longer one motion with what waits: from the owner's end on there is another one.
    pub(super) fn end_run(&mut self) {
        if let Some(owner) = &mut self.owner {
            owner.run = Run::NONE;
        }
    }

    /// The owner has passed its end on the way of its plan, and the next command is one motion with it: that goes on along the
    /// plan. Returns whether it does. Where a modulo axis comes into another turn it is planned anew, to meet the target to the bit.
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
        // As it was planned; what is another chain now is planned anew.
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

    /// Whether a command that was to pass its end in motion and has been held up is behind it now: it need not go back there.
    pub(super) fn is_past_its_end(&self, owner: &Entry) -> bool {
        self.way_on(owner, self.mover.setpoint().position).is_some()
    }

    /// The way (u) of the next command from `place` on (u), if that is behind the end of `owner`, which was to be passed in motion.
    fn way_on(&self, owner: &Entry, place: f64) -> Option<f64> {
        let (end, next) = (owner.end?, self.queue.first()?);
        let target = self.end_of_leg(next, end, self.mover.last_velocity() > 0.0)?;
        let is_onward = (target - end) * (place - end) > 0.0;
        // What is paused was to come to rest wherever it is.
        let was_to_pass = owner.passage.wanted > 0.0 || owner.paused || owner.is_behind;
        let goes_on = self.mover.layer().is_none() && was_to_pass && next.mode.blends() && is_onward;
        goes_on.then_some(target - place)
    }

    /// Why `owner`, held up so far, has to wait where it comes to rest behind its end: the next move leads on from there, and that way is
    /// barred.
    pub(super) fn barred_from_there_on(&self, owner: &Entry) -> Option<ErrorId> {
        let next = self.queue.first()?;
        if owner.halted || !self.is_held_up() || !is_move(next) {
            return None;
        }
        let way = self.way_on(owner, self.mover.end_of_plan())?;
        self.way_barred(way)
    }

    /// Hands over to the next command if `owner`, the present one as it is to go on, has been held up behind its end and is no one motion
    /// with that. What is barred waits, and what may need a run-up does not begin here.
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

    /// Where the last of what is one motion with `first`, which is at the head of the buffer, ends (u).
    fn end_of_run(&self, first: &Entry) -> Option<f64> {
        let forward = self.mover.setpoint().velocity > 0.0;
        let mut behind = self.queue.iter().skip(1).take(first.run.count);
        behind.try_fold(first.end?, |from, next| {
            let same = next.mode.blends() && next.work.manner().blends && next.limits == first.limits;
            same.then(|| self.end_of_leg(next, from, forward))?
        })
    }
}

/// Whether a command is a move that ends.
fn is_move(entry: &Entry) -> bool {
    matches!(entry.work, Work::Position(_) | Work::Distance(_))
}

/// Whether a motion that leads `forward`, or back, begins the other way.
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

/// The goal of `plan` after the scan `from` for a command that ends at `end` (u): where the plan leads beyond that, the first scan in
/// which it is there.
pub(super) fn goal_past<P: Plan>(plan: &P, from: u64, end: f64, forward: bool) -> u64 {
    let last = plan.at(u64::from(plan.scans())).position;
    let leads_beyond = last != end && (last > end) == forward;
    if plan.turn().is_none() && leads_beyond {
        passing_scan(plan, from, end, forward)
    } else {
        scans_to_goal(plan)
    }
}

/// The first scan after `from`, in which it is not there yet, in which `plan` is at or past `end` (u); that of its goal if there is
/// none.
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
