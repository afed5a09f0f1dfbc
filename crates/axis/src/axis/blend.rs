//! Blending: the velocity at which a positioning command passes its end when a blended command waits behind it.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; rules B1 to B17.
//! `docs/buffering.md` states what the standard leaves open. The planner does the calculation.

use super::commands::{Entry, REST, ROUNDING, Run, Work};
use super::power::Reaction;
use super::through::{is_braking, keeps_rates};
use super::{Axis, Motion};
use crate::{BufferMode, ErrorId, Fate, QUEUE_MAX, Scope};
use standstill_planner::{Limits, Passage, Plan, Planner, Setpoint};

/// The longest distance that can be planned takes this number of scans at constant velocity. The rest of a plan's
/// scans is for the ramps.
const SCANS: f64 = 1_073_741_824.0;

/// The share of its velocity that an end keeps at least, however fast the superimposed motion is. Then the next
/// command may be unable to stop in its distance.
const AT_LEAST: f64 = 0.1;

/// A command of a chain: the one that is or becomes the owner, or one that waits.
#[derive(Clone, Copy)]
struct Leg<'a> {
    entry: &'a Entry,
    /// The distance to its end (u), with its sign; `None` if it has no end.
    way: Option<f64>,
    /// The position of its end (u), if it has one.
    end: Option<f64>,
}

impl<P: Planner> Axis<P> {
    /// A command has been queued with `mode`. If it is blended, the velocity at the end of the owner may change, and
    /// the owner is planned anew from the last set-point (B15). If no new plan is found, the present one stays. It
    /// also stays if it passes its end on a ramp and the new plan is not sooner, or if it is one motion and the next
    /// command could not come to rest behind the new plan.
    pub(super) fn arm(&mut self, mode: BufferMode, scope: &mut Scope<'_>) {
        if mode.blends() {
            self.arm_owner_if(
                |axis, owner, plan| {
                    (!axis.passes_on_a_ramp() || axis.is_sooner(owner, plan))
                        && !axis.splits_too_fast(owner, plan)
                },
                scope,
            );
        }
    }

    /// Whether the owner is one motion with others now, would no longer be with `plan` (of `owner`), and would pass
    /// its own end too fast for the next command.
    fn splits_too_fast(&self, owner: &Entry, plan: &P::Plan) -> bool {
        let is_split = owner.run.count == 0 && self.owner.is_some_and(|was| was.run.count > 0);
        let speed = plan.end().velocity.abs();
        is_split && speed > owner.passage.most * (1.0 + ROUNDING)
    }

    /// The same after any change behind the owner.
    pub(super) fn arm_owner(&mut self, scope: &mut Scope<'_>) {
        self.arm_owner_if(|_, _, _| true, scope);
    }

    fn arm_owner_if(&mut self, is_good: impl Fn(&Self, &Entry, &P::Plan) -> bool, scope: &mut Scope<'_>) {
        let Some(was) = self.owner else { return };
        let mut owner = was;
        self.look_through(&mut owner, self.mover.setpoint().position, 0);
        // The highest velocity with which the next command can begin matters only to a new plan.
        let asked = |entry: &Entry| (entry.passage.wanted, entry.passage.brake, entry.run);
        let changed = asked(&owner) != asked(&was);
        if !changed
            || owner.end.is_none()
            || self.is_held_up()
            || !matches!(self.mover.motion(), Motion::Run { .. })
        {
            return;
        }
        if self.mover.layer().is_some() {
            // Under a superimposed motion it continues as planned. After that the added distance only moves its end.
            let passes = !self.is_superimposing() && owner.passage.wanted > 0.0;
            if !passes || self.plan_anew(owner, scope).is_err() {
                self.end_run();
            }
            return;
        }
        let (start, before) = (self.mover.setpoint(), self.mover.before());
        let planned = match self.ahead(&mut owner, start, before) {
            // If one motion can't continue because the next command is another one, the owner comes to rest at its
            // end.
            None if was.run.count > 0 => self.at_rest_ahead(&owner, start, before),
            planned => {
                let moves = |plan: &P::Plan| !plan.at(self.along(&owner, *plan).scans()).is_at_rest();
                planned.filter(|plan| was.run.count > 0 || owner.run.count > 0 || moves(plan))
            }
        };
        match planned.filter(|plan| is_good(self, &owner, plan)) {
            Some(plan) => self.adopt(owner, self.along(&owner, plan), scope),
            // It continues as planned. An owner of one motion passes its end like that, and the next command takes
            // over there.
            None => self.end_run(),
        }
    }

    /// The plan of `entry` to rest at its end; `None` if it would turn or exceed a limit of the axis.
    fn at_rest_ahead(&self, entry: &Entry, start: &Setpoint, before: &Limits) -> Option<P::Plan> {
        let (end, profile) = (entry.end?, self.config.profile);
        let planned = self.planner.move_to(profile, start, end, &entry.limits, before);
        planned
            .ok()
            .filter(|plan| self.beyond_bound(plan).is_none() && !self.turns(plan, end > start.position))
    }

    /// The plan of `entry` that continues with the commands behind it: as one motion, or past its end. `None` if it
    /// is to come to rest there from a state in which it need not be blended, or can't do it without turning.
    pub(super) fn ahead(&self, entry: &mut Entry, start: &Setpoint, before: &Limits) -> Option<P::Plan> {
        if let Some(plan) = self.in_one_motion(entry, start, before) {
            return Some(plan);
        }
        entry.run = Run::NONE;
        if entry.is_behind {
            // There is nothing else to pass: it goes back and comes to rest.
            (entry.is_behind, entry.passage) = (false, REST);
        }
        self.blended(entry, start, entry.end?, &entry.passage, before)
    }

    /// The plan that passes `end` with `passage`. `end` is that of `entry`, or of the last command that is one motion
    /// with it.
    pub(super) fn blended(
        &self,
        entry: &Entry,
        start: &Setpoint,
        end: f64,
        passage: &Passage,
        before: &Limits,
    ) -> Option<P::Plan> {
        if passage.brake > 0.0 {
            return self.turned(entry, start, (end, passage), before);
        }
        if passage.wanted <= 0.0 && !self.passes_its_end(&entry.limits) {
            return None;
        }
        let planned = self.planner.blend(start, end, passage, &entry.limits, before);
        // If there is no blended plan, the caller plans a move to rest, which would return the same error. The same
        // applies to a plan that is too fast at its end because the limits were lowered too late: it passes its end,
        // turns and comes back. No plan may exceed a limit of the axis.
        let planned = planned.ok().flatten();
        let passing = planned
            .filter(|plan| passage.wanted <= 0.0 || self.beyond_bound(plan).is_none())
            .filter(|plan| {
                let end = plan.end().velocity.abs();
                let most = self.fastest() * (1.0 + ROUNDING);
                end <= if passage.wanted > 0.0 { most } else { 0.0 }
            });
        if passage.wanted <= 0.0 {
            return passing;
        }
        match self.behind(entry, end, end > start.position) {
            Some(behind) => self.soonest_past(entry, start, (&behind, passage), before, passing),
            None => passing.filter(|plan| self.is_worth_it(entry, start, (end, passage), before, plan)),
        }
    }

    /// Whether the command after `entry` is done sooner if `entry` passes its `end` along `passing` than if it comes
    /// to rest there. This is certain if `entry` reaches the wanted velocity and does not brake now.
    ///
    /// Cost: at most three plans, if `entry` brakes or does not reach that velocity.
    fn is_worth_it(
        &self,
        entry: &Entry,
        start: &Setpoint,
        (end, passage): (f64, &Passage),
        before: &Limits,
        passing: &P::Plan,
    ) -> bool {
        let last = passing.end();
        let is_wanted = last.velocity.abs() >= passage.wanted * (1.0 - ROUNDING);
        if is_wanted && !is_braking(start) {
            return true;
        }
        let to_rest = self.scans_to_rest(entry, start, end, before);
        let profile = self.config.profile;
        let Some(next) = self.next_behind(entry) else {
            return true;
        };
        let target = self.end_of_leg(next, end, end > start.position);
        // A command without an end can't be done sooner.
        let after = |from: &Setpoint| match target {
            Some(target) => self
                .planner
                .move_to(profile, from, target, &next.limits, &next.limits)
                .map_or(u64::MAX, |plan| u64::from(plan.scans())),
            None => 0,
        };
        let passed = last.moved_to(end);
        let in_motion = u64::from(passing.scans()).saturating_add(after(&passed));
        in_motion < to_rest.saturating_add(after(&Setpoint::at_rest(end)))
    }

    /// Scans until `entry` is at rest at its `end`, by a new plan or by the present one.
    pub(super) fn scans_to_rest(&self, entry: &Entry, start: &Setpoint, end: f64, before: &Limits) -> u64 {
        let planned = self
            .planner
            .move_to(self.config.profile, start, end, &entry.limits, before);
        // A plan that turns does not count.
        let planned = planned
            .ok()
            .filter(|plan| start.is_at_rest() || !self.turns(plan, end > start.position));
        let anew = planned.map_or(u64::MAX, |plan| u64::from(plan.scans()));
        let present = match (self.mover.motion(), &self.owner) {
            (Motion::Run { plan, elapsed, scans }, Some(owner))
                if owner.id == entry.id
                    && owner.run.count == entry.run.count
                    && plan.at(*scans).is_at_rest() =>
            {
                scans.saturating_sub(*elapsed)
            }
            _ => u64::MAX,
        };
        anew.min(present)
    }

    /// The command behind `entry`, or behind the last command that is one motion with it.
    pub(super) fn next_behind(&self, entry: &Entry) -> Option<&Entry> {
        self.queue.iter().nth(self.number_behind(entry))
    }

    /// Its number in the queue. `entry` may still be the first there.
    pub(super) fn number_behind(&self, entry: &Entry) -> usize {
        let is_first = self.queue.first().is_some_and(|first| first.id == entry.id);
        entry.run.count + usize::from(is_first)
    }

    /// `limits` of a motion, with the velocity at the end of its plan if that is higher (B3).
    pub(super) fn limits_of(limits: &Limits, motion: &Motion<P::Plan>) -> Limits {
        match motion {
            Motion::Run { plan, .. } => raised(limits, plan),
            Motion::Follow
            | Motion::Hold
            | Motion::Torque { .. }
            | Motion::Geared
            | Motion::Closing { .. } => *limits,
        }
    }

    /// The owner has passed its end in motion: it is Done, and the next command takes over from the set-point (B2).
    /// If the next command has to wait for a superimposed motion, the owner waits too, and keeps its velocity.
    pub(super) fn pass_on(&mut self, scope: &mut Scope<'_>) {
        let follows = self.owner.as_ref().is_some_and(|owner| !owner.passage.rests());
        if follows || !self.is_turning() {
            self.hand_over(self.passed_end(), scope);
        }
        if self.is_turning() {
            return self.rest_at_end(scope);
        }
        if self.queue.is_empty()
            && self.mover.base().velocity != 0.0
            && self.goal_reached()
            && self.passes_on()
        {
            // The waiting command was refused, too late to come to rest: coordinates moved, a direction was barred,
            // or its values changed.
            match self.allowed(self.mover.setpoint().position) {
                Ok(_) => self.halt_behind_end(scope),
                Err(_) => {
                    self.end_owner(Fate::Done);
                    self.trip(ErrorId::SoftwareLimitReached, 0, Reaction::Ramp, scope);
                }
            }
        }
    }

    /// Whether the owner is at its end in motion, and `next` can take over within its own limits alone (B5). A plan
    /// that continues behind that end, such as a ramp, may be too steep for them. Cost: at most one ramp.
    pub(super) fn passes_its_end(&self, next: &Limits) -> bool {
        let here = self.mover.setpoint();
        let keeps = || {
            let stop = self.planner.ramp_to(here, 0.0, next, next);
            stop.is_ok_and(|stop| keeps_rates(&stop))
        };
        self.goal_reached()
            && !self.is_held_up()
            && self.passes_on()
            && here.velocity != 0.0
            && (!self.mover.motion().goes_on() || keeps())
    }

    /// The fate of the owner when another command takes over in motion. An owner with an end has passed it, so it is
    /// Done.
    pub(super) fn fate_at_hand_over(&self) -> Fate {
        if self.passes_on() {
            Fate::Done
        } else {
            Fate::Aborted
        }
    }

    /// Whether the owner passes its end, and in motion.
    #[inline(never)]
    pub(super) fn passes_in_motion(&self) -> bool {
        self.passes_on() && !self.mover.base().is_at_rest()
    }

    fn passes_on(&self) -> bool {
        self.owner
            .as_ref()
            .is_some_and(|owner| owner.work.manner().blends)
    }

    /// The position from which distances of the next command count (u). It is the owner's end, plus what is
    /// superimposed, if that end was passed in this scan; otherwise the set position (B10).
    pub(super) fn passed_end(&self) -> f64 {
        let now = self.mover.setpoint().position;
        let end = self.owner.as_ref().and_then(|owner| owner.end);
        match (self.mover.motion(), end) {
            (Motion::Run { elapsed, scans, .. }, Some(end))
                if elapsed == scans && self.mover.layer().is_none() =>
            {
                end
            }
            (Motion::Run { elapsed, scans, .. }, Some(end)) if elapsed == scans => {
                end + (now - self.mover.base().position)
            }
            _ => now,
        }
    }

    /// Finds how `entry` passes its end, which is known, and which commands of the queue are one motion with it.
    /// `entry` starts at `start` (u); the first `skip` commands of the queue are no longer behind it. The search runs
    /// from the last command to the first, because no command may begin faster than it can end. Under a superimposed
    /// motion there is no chain as one motion, because the axis is not at the ends of its commands.
    ///
    /// Cost: at most two ramps or roots of ramps for each command that waits.
    pub(super) fn look_through(&self, entry: &mut Entry, start: f64, skip: usize) {
        (entry.passage, entry.run) = self.chain(entry, start, skip, 0.0);
    }

    /// How `first` passes its end, see [`Axis::look_through`].
    pub(super) fn passage(&self, first: &Entry, start: f64, skip: usize) -> Passage {
        self.chain(first, start, skip, 0.0).0
    }

    /// The same, with distances of at least `shortest` (u) in one motion.
    pub(super) fn chain(&self, first: &Entry, start: f64, skip: usize, shortest: f64) -> (Passage, Run) {
        const NONE: Option<Leg<'_>> = None;
        let mut legs = [NONE; QUEUE_MAX];
        let way = first
            .end
            .map(|end| if first.is_behind { start - end } else { end - start });
        let mut forward = way.is_none_or(|way| way > 0.0);
        // When the next command begins, the added distance may be complete or not. The shorter distance counts.
        let farthest = first.end.map(|end| match self.mover.layer() {
            Some(layer) => layer.farthest_above(end, forward, skip == 0),
            None => end,
        });
        let mut from = farthest;
        for (leg, entry) in legs.iter_mut().zip(self.queue.iter().skip(skip)) {
            let end = from.and_then(|from| self.end_of_leg(entry, from, forward));
            *leg = Some(Leg {
                entry,
                end,
                way: end.zip(from).map(|(end, from)| end - from).filter(|way| {
                    self.is_countable(*way, entry) && end.is_some_and(|end| self.allowed(end).is_ok())
                }),
            });
            forward = end.zip(from).map_or(forward, |(end, from)| end > from);
            from = end;
        }
        let alone = Leg {
            entry: first,
            end: farthest,
            way,
        };
        let (count, end) = self.joined(&alone, &legs, shortest);
        let mut run = Run {
            count,
            end,
            passage: REST,
        };
        let mut passage = REST;
        let numbered = legs.iter().enumerate();
        let mut legs = numbered
            .filter_map(|(number, leg)| Some((number, leg.as_ref()?)))
            .rev()
            .peekable();
        while let Some((number, next)) = legs.next() {
            let leg = legs.peek().map_or(&alone, |(_, leg)| leg);
            passage = self.between(leg, next, &passage);
            if number == count {
                run.passage = passage;
            }
        }
        (passage, if count > 0 { run } else { Run::NONE })
    }

    /// The number of `legs` that are one motion with `first`, and the end of the last of them (u).
    fn joined(&self, first: &Leg<'_>, legs: &[Option<Leg<'_>>], shortest: f64) -> (usize, f64) {
        let none = (0, 0.0);
        let Some(way) = first.way.filter(|_| first.entry.work.manner().blends) else {
            return none;
        };
        if self.way_barred(way).is_some() || self.mover.layer().is_some() {
            return none;
        }
        // On a modulo axis, where a command must not turn back, one motion must always have a plan.
        let shortest = if self.modulo.is_some() {
            self.longest_scan(first.entry)
        } else {
            shortest
        };
        let joins = |leg: &&Leg<'_>| {
            let is_onward = |next: f64| next * way > 0.0 && next.abs() >= shortest;
            leg.entry.mode.blends()
                && leg.entry.work.manner().blends
                && leg.entry.limits == first.entry.limits
                && leg.way.is_some_and(is_onward)
        };
        let joined = legs.iter().flatten().take_while(joins);
        joined.fold(none, |(count, end), leg| (count + 1, leg.end.unwrap_or(end)))
    }

    /// Whether a distance can be planned. A longer one is refused when its command becomes active, at rest.
    fn is_countable(&self, way: f64, entry: &Entry) -> bool {
        way.abs() <= entry.limits.velocity * self.planner.cycle() * SCANS
    }

    /// How `leg` passes its end if `next` passes its own with `after`.
    fn between(&self, leg: &Leg<'_>, next: &Leg<'_>, after: &Passage) -> Passage {
        let (entry, mode) = (leg.entry, next.entry.mode);
        let direction = match leg.way {
            Some(way) if entry.work.manner().blends && way != 0.0 => way.signum(),
            // Any other command comes to rest, or hands over with its present velocity (B12).
            _ => return REST,
        };
        let limits = &next.entry.limits;
        // The direction and velocity of the next command, and the velocity at its end: as commanded, and the highest.
        // None if it has no end to overshoot.
        let (towards, velocity, exit) = match next.entry.work {
            Work::Position(_) | Work::Distance(_) => match next.way {
                Some(way) => (way, limits.velocity, Some((after.wanted, after.most))),
                None => return REST,
            },
            Work::Through { end_velocity, .. } => match next.way {
                Some(way) => {
                    let onwards = end_velocity * way >= 0.0;
                    let exit = end_velocity.abs();
                    (way, limits.velocity, onwards.then_some((exit, exit)))
                }
                None => return REST,
            },
            Work::Velocity { velocity, along } => {
                let towards = if along { velocity * direction } else { velocity };
                (towards, velocity.abs(), None)
            }
            Work::Halt => (direction, 0.0, None),
            // No other command takes over in motion.
            _ => return REST,
        };
        // A command that MC_Power bars would be refused at the end, too late to stop there. A continuous move may
        // need a run-up.
        let runs_up = matches!(next.entry.work, Work::Through { end_velocity, .. } if end_velocity != 0.0);
        if self.way_barred(towards).is_some() || (runs_up && self.bars_any()) {
            return REST;
        }
        // The next command reverses or has no distance: velocity 0 at the end (B13). Velocity 0 has no direction.
        if towards * direction <= 0.0 && velocity != 0.0 {
            return self.at_turn(leg.entry, next.entry, leg.end, direction);
        }
        let first = entry.limits.velocity;
        let wanted = mode.speed_between(first, velocity);
        let passage = match exit {
            Some((exit, most_exit)) => {
                let down_to =
                    |exit, wanted| self.planner.entry_speed(wanted, 0.0, towards.abs(), exit, limits);
                let alone = down_to(exit, wanted);
                // A distance too short for the wanted velocity is too short for a higher one, too.
                let most = if alone < wanted {
                    alone
                } else {
                    down_to(most_exit, self.fastest()).max(alone)
                };
                // The next command may have to take over the velocity of the superimposed motion, too.
                let added = self.superimposed_speed();
                let wanted = if added > 0.0 {
                    alone.min((down_to(exit, wanted + added) - added).max(AT_LEAST * alone))
                } else {
                    alone
                };
                Passage {
                    wanted,
                    most,
                    brake: 0.0,
                }
            }
            None => Passage {
                wanted,
                most: f64::INFINITY,
                brake: 0.0,
            },
        };
        self.stoppable(passage, leg.end, direction)
    }

    /// `passage` at `end`, but only as fast as the stop dynamics can stop before the software limit behind it, for
    /// any next command.
    pub(super) fn stoppable(&self, passage: Passage, end: Option<f64>, direction: f64) -> Passage {
        let (Some((min, max)), Some(end)) = (self.parameters.software_limits, end) else {
            return passage;
        };
        let room = if direction > 0.0 { max - end } else { end - min };
        if !room.is_finite() || passage.wanted <= 0.0 {
            return passage;
        }
        // Both motions together have to stop.
        let added = self.superimposed_speed();
        let stoppable = |speed| (self.stoppable_speed(speed + added, room) - added).max(0.0);
        Passage {
            wanted: stoppable(passage.wanted),
            most: stoppable(passage.most.min(self.fastest())),
            ..passage
        }
    }

    /// The highest velocity (u/s) of the axis, for any command.
    fn fastest(&self) -> f64 {
        self.slowed(&self.config.limits).velocity
    }

    /// The largest speed (u/s), at most `wanted`, from which the stop dynamics come to rest within `room` (u).
    fn stoppable_speed(&self, wanted: f64, room: f64) -> f64 {
        let limits = self.stop_limits();
        self.planner.entry_speed(wanted, 0.0, room.max(0.0), 0.0, &limits)
    }

    /// Whether the stop dynamics keep an axis inside the software limits behind the end of the plan `rest`. The axis
    /// passes that end at its velocity, `shift` (u) beside it, while a distance `left` (u) is still superimposed with
    /// a speed of `added` (u/s).
    pub(super) fn stops_beside(&self, (rest, _): (&P::Plan, u64), shift: f64, left: f64, added: f64) -> bool {
        let mut end = rest.end();
        end.position += shift;
        let Some((min, max)) = self.parameters.software_limits.filter(|_| end.velocity != 0.0) else {
            return true;
        };
        let forward = end.velocity > 0.0;
        let room = if forward {
            max - end.position - left.max(0.0)
        } else {
            end.position + left.min(0.0) - min
        };
        let speed = end.velocity.abs() + if (left > 0.0) == forward { added } else { 0.0 };
        self.stoppable_speed(speed, room) >= speed * (1.0 - ROUNDING)
    }
}

/// `limits` with the velocity at the end of `plan` if that is higher (B3).
fn raised<P: Plan>(limits: &Limits, plan: &P) -> Limits {
    let end = plan.end().velocity.abs();
    limits.with_velocity(limits.velocity.max(end))
}
