//! Ends that are passed on a ramp. Between moves with different dynamics, a short move need not reach a constant
//! velocity at its end.
//!
//! A move may be too short for the velocity wanted at its end. Then the ramp to that velocity leads through the end,
//! or the axis passes the end still accelerating, with the higher rates of the first command. The next move may be
//! too short to slow down from that velocity. Then the axis passes the end braking. This module decides which of
//! these is used, and whether the next command is done sooner with it. The planner does the calculation.
//!
//! Source: PLCopen Motion Control Part 1, section on aborting and buffered commands; B14, B15. `docs/buffering.md`.

use super::commands::{Entry, ROUNDING, Work};
use super::run::goal_past;
use super::{Axis, Motion};
use standstill_planner::{Excess, Limits, MoveProfile, Passage, Plan, Planner, Setpoint};

/// An end is passed braking with this part of a deceleration: the one with which the next command would slow down
/// there. The rest is needed to build up the jerk.
const BRAKE: f64 = 0.8;

/// The least deceleration, as a part of the lower limit of the two commands.
const LEAST: f64 = 0.2;

/// An end is passed accelerating with this part of the lower acceleration limit.
const PUSH: f64 = 0.8;

/// The next command behind an end.
pub(super) struct Behind<'a> {
    next: &'a Entry,
    end: f64,
    target: f64,
    forward: bool,
    /// Its number in the queue.
    number: usize,
    /// How the next command passes its own end.
    exit: Passage,
}

impl<P: Planner> Axis<P> {
    /// The plan of `entry` past the end with which its next command is done soonest: `passing`, which has no
    /// acceleration there, or a plan on a ramp. `None` if a stop at the end is soonest.
    ///
    /// Cost: the plan on a ramp, two plans behind it, and for the stop two more.
    pub(super) fn soonest_past(
        &self,
        entry: &Entry,
        start: &Setpoint,
        (behind, passage): (&Behind<'_>, &Passage),
        before: &Limits,
        passing: Option<P::Plan>,
    ) -> Option<P::Plan> {
        let speed = passing.as_ref().map_or(0.0, |plan| plan.end().velocity.abs());
        let is_wanted = speed >= passage.wanted * (1.0 - ROUNDING);
        let is_faster = speed > passage.wanted * (1.0 + ROUNDING);
        let ramps = if is_wanted && !is_faster {
            [self.braking_through(entry, start, passage, before, behind), None]
        } else {
            [
                self.speeding_through(entry, start, passage.wanted, before, behind),
                if start.acceleration == 0.0 {
                    self.pushing_through(entry, start, passage.wanted, before, behind)
                } else {
                    self.letting_go(entry, start, passage.wanted, before, behind)
                },
            ]
        };
        let keeps = |plan: &P::Plan| self.beyond_bound(plan).is_none() && !self.turns(plan, behind.forward);
        let ramps = ramps.map(|ramp| ramp.filter(keeps));
        let is_certain = is_wanted && !is_braking(start);
        match (passing, ramps) {
            (None, [None, None]) => return None,
            (Some(passing), [None, None]) if is_certain => return Some(passing),
            _ => {}
        }
        let counted = |plan: P::Plan| {
            let goal = goal_past(&plan, 0, behind.end, behind.forward);
            let scans = goal.saturating_add(self.scans_behind(&plan.at(goal), behind));
            (plan, scans)
        };
        let with_rest = || {
            let to_rest = self.scans_to_rest(entry, start, behind.end, before);
            to_rest.saturating_add(self.scans_behind(&Setpoint::at_rest(behind.end), behind))
        };
        // A ramp behind which the next command can't be done is not used. `passing` is kept even then.
        let ramps = ramps.into_iter().flatten().map(counted);
        let ramps = ramps.filter(|(_, scans)| *scans < u64::MAX);
        let on_a_ramp = ramps.min_by_key(|(_, scans)| *scans);
        // A ramp to the wanted velocity is nearer to it than a faster plan.
        let passing = passing.filter(|_| !is_faster || on_a_ramp.is_none());
        let plans = passing.map(counted).into_iter().chain(on_a_ramp);
        let (plan, scans) = plans.min_by_key(|(_, scans)| *scans)?;
        let goes_on = || {
            let with_rest = with_rest();
            // If it is too late for a stop, it is too late for the next command, too.
            scans < with_rest || with_rest == u64::MAX
        };
        (is_certain || goes_on()).then_some(plan)
    }

    /// Whether the commands that wait behind the owner's end are done sooner along `plan`, a new plan of `owner`,
    /// than along the one in progress.
    ///
    /// Cost for each of the two: the plan of the next command, and a plan of the command behind it.
    pub(super) fn is_sooner(&self, owner: &Entry, plan: &P::Plan) -> bool {
        let (
            Some(end),
            Motion::Run {
                plan: present,
                elapsed,
                scans,
            },
        ) = (owner.end, self.mover.motion())
        else {
            return true;
        };
        let forward = end > self.mover.setpoint().position;
        let Some(behind) = self
            .behind(owner, end, forward)
            .filter(|behind| behind.number == 0)
        else {
            return true;
        };
        let goal = goal_past(plan, 0, end, forward);
        let anew = goal.saturating_add(self.scans_of_next(&plan.at(goal), &behind));
        let left = scans.saturating_sub(*elapsed);
        let as_planned = left.saturating_add(self.scans_of_next(&present.at(*scans), &behind));
        anew < as_planned && !self.turns(plan, forward)
    }

    /// Scans from a state at the start of the next command, which is the first that waits, until it and the command
    /// behind it are done; [`u64::MAX`] if they can't without reversing.
    fn scans_of_next(&self, from: &Setpoint, behind: &Behind<'_>) -> u64 {
        let Behind { target, forward, .. } = *behind;
        let mut next = Entry {
            end: Some(target),
            ..*behind.next
        };
        self.look_through(&mut next, from.position, 1);
        let limits = next.limits;
        let to_rest = || {
            let planned = self
                .planner
                .move_to(self.config.profile, from, target, &limits, &limits);
            planned.ok()
        };
        let plan = self.ahead(&mut next, from, &limits).or_else(to_rest);
        let Some(plan) = plan.filter(|plan| !self.turns(plan, forward)) else {
            return u64::MAX;
        };
        if next.run.count > 0 {
            return goal_past(&plan, 0, next.run.end, forward);
        }
        let goal = goal_past(&plan, 0, target, forward);
        let after = self.leading_on(1, target, forward);
        let scans = after.map_or(0, |after| self.scans_behind(&plan.at(goal), &after));
        goal.saturating_add(scans)
    }

    /// Whether the plan of the owner passes its end on a ramp.
    pub(super) fn passes_on_a_ramp(&self) -> bool {
        let is_one = |owner: &Entry| owner.run.count == 0 && owner.passage.wanted > 0.0;
        self.mover.motion().goes_on()
            && !self.mover.setpoint().is_at_rest()
            && self.owner.as_ref().is_some_and(is_one)
    }

    /// The command behind the `end` of `entry`, if it is a move in the same direction with other limits, and ramps
    /// are possible.
    pub(super) fn behind(&self, entry: &Entry, end: f64, forward: bool) -> Option<Behind<'_>> {
        self.behind_at(self.number_behind(entry), entry, end, forward)
    }

    fn behind_at(&self, number: usize, entry: &Entry, end: f64, forward: bool) -> Option<Behind<'_>> {
        let next = self.queue.iter().nth(number)?;
        let has_ramps = self.modulo.is_none() && self.mover.layer().is_none();
        let is_other = next.limits != entry.limits;
        (has_ramps && is_other).then(|| self.leading_on(number, end, forward))?
    }

    /// The same with any limits.
    fn leading_on(&self, number: usize, end: f64, forward: bool) -> Option<Behind<'_>> {
        let next = self.queue.iter().nth(number)?;
        let is_move = matches!(next.work, Work::Position(_) | Work::Distance(_));
        let target = self.end_of_leg(next, end, forward)?;
        let is_onward = is_move && target != end && (target > end) == forward;
        if !is_onward {
            return None;
        }
        let aimed = Entry {
            end: Some(target),
            ..*next
        };
        Some(Behind {
            next,
            end,
            target,
            forward,
            number,
            exit: self.passage(&aimed, end, number + 1),
        })
    }

    /// The ramp to the `wanted` velocity through the end, with rates that the next command also allows.
    fn speeding_through(
        &self,
        entry: &Entry,
        start: &Setpoint,
        wanted: f64,
        before: &Limits,
        behind: &Behind<'_>,
    ) -> Option<P::Plan> {
        let (own, next) = (&entry.limits, &behind.next.limits);
        // A faster motion slows down with these rates, too.
        let limits =
            rates_of_both(own, next).with_velocity(own.velocity.max(wanted).max(start.velocity.abs()));
        let velocity = if behind.forward { wanted } else { -wanted };
        let ramp = self.planner.ramp_to(start, velocity, &limits, before).ok()?;
        let at_end = ramp.at(goal_past(&ramp, 0, behind.end, behind.forward));
        let is_past = (at_end.position >= behind.end) == behind.forward;
        // A start with more acceleration than is allowed at the end has lowered it by then.
        let within = |value: f64, limit: f64| value.abs() <= limit * (1.0 + ROUNDING);
        let is_kept = within(at_end.acceleration, limits.acceleration) && within(at_end.jerk, limits.jerk);
        let keeps = is_kept && keeps_rates_from(&ramp, start, own);
        (is_past && keeps && self.stops_inside(&at_end)).then_some(ramp)
    }

    /// The ramp through the end that lowers its acceleration to 0 at once, if that leads to at most `most` velocity
    /// (u/s). It is the ramp of [`Axis::speeding_through`] with the shortest travel.
    fn letting_go(
        &self,
        entry: &Entry,
        start: &Setpoint,
        most: f64,
        before: &Limits,
        behind: &Behind<'_>,
    ) -> Option<P::Plan> {
        let rates = rates_of_both(&entry.limits, &behind.next.limits);
        let arrested = self.planner.coasting(start, &rates).abs();
        let ramp = || self.speeding_through(entry, start, arrested, before, behind);
        (arrested <= most).then(ramp)?
    }

    /// The plan that passes the end still accelerating, as much as the next command allows, with the velocity that a
    /// ramp of its own rates reaches.
    fn pushing_through(
        &self,
        entry: &Entry,
        start: &Setpoint,
        wanted: f64,
        before: &Limits,
        behind: &Behind<'_>,
    ) -> Option<P::Plan> {
        let (own, next) = (&entry.limits, &behind.next.limits);
        let is_lower = next.acceleration < own.acceleration || next.jerk < own.jerk || next.snap < own.snap;
        if !is_lower {
            return None;
        }
        let limits = own.with_velocity(own.velocity.max(wanted));
        let pushing = Passage {
            wanted,
            most: wanted,
            brake: -PUSH * own.acceleration.min(next.acceleration),
        };
        let planned = self.planner.blend(start, behind.end, &pushing, &limits, before);
        let plan = planned.ok().flatten()?;
        let at_end = plan.at(goal_past(&plan, 0, behind.end, behind.forward));
        (keeps_rates(&plan) && self.stops_inside(&at_end)).then_some(plan)
    }

    /// The plan that passes the end braking. Its velocity there lets the next command slow down to the velocity at
    /// its own end.
    fn braking_through(
        &self,
        entry: &Entry,
        start: &Setpoint,
        passage: &Passage,
        before: &Limits,
        behind: &Behind<'_>,
    ) -> Option<P::Plan> {
        let Behind {
            next, end, target, ..
        } = *behind;
        let asked = self.asked(entry, next, end, behind.forward);
        if passage.wanted >= asked * (1.0 - ROUNDING) {
            return None;
        }
        let way = (target - end).abs();
        let most = entry.limits.deceleration.min(next.limits.deceleration);
        let steepness = self.deceleration_before(way, asked.min(entry.limits.velocity), behind)?;
        let brake = (BRAKE * steepness.min(most)).max(LEAST * most);
        let speed = self
            .planner
            .entry_speed(asked, brake, way, behind.exit.wanted, &next.limits);
        let braking = Passage {
            wanted: speed,
            most: speed,
            brake,
        };
        let is_one = speed > 0.0;
        let planned = is_one.then(|| self.planner.blend(start, end, &braking, &entry.limits, before))?;
        planned.ok().flatten().filter(keeps_rates)
    }

    /// The deceleration (u/s^2) of the next command at a `way` (u) before it has slowed down from `speed` to the
    /// velocity at its end.
    fn deceleration_before(&self, way: f64, speed: f64, behind: &Behind<'_>) -> Option<f64> {
        let begin = Setpoint::at_velocity(0.0, speed);
        let limits = behind
            .next
            .limits
            .with_velocity(speed.max(behind.next.limits.velocity));
        let ramp = self.planner.ramp_to(&begin, behind.exit.wanted, &limits, &limits);
        let ramp = ramp.ok()?;
        let there = ramp.end().position - way;
        if there <= 0.0 {
            return Some(0.0);
        }
        let state = ramp.at(goal_past(&ramp, 0, there, true));
        Some((-state.acceleration).max(0.0))
    }

    /// The velocity wanted at `end`, as far as software limits allow it.
    fn asked(&self, entry: &Entry, next: &Entry, end: f64, forward: bool) -> f64 {
        let asked = next
            .mode
            .speed_between(entry.limits.velocity, next.limits.velocity);
        let passage = Passage {
            wanted: asked,
            most: asked,
            ..Passage::REST
        };
        let direction = if forward { 1.0 } else { -1.0 };
        self.stoppable(passage, Some(end), direction).wanted
    }

    /// Scans that the next command takes from a state at its start; [`u64::MAX`] if it can't.
    fn scans_behind(&self, from: &Setpoint, behind: &Behind<'_>) -> u64 {
        let scans = self.scans_as_asked(from, behind);
        scans
            .or_else(|| self.scans_speeding(from, behind))
            .unwrap_or(u64::MAX)
    }

    /// The same if it passes its own end as wanted, or comes to rest there.
    fn scans_as_asked(&self, from: &Setpoint, behind: &Behind<'_>) -> Option<u64> {
        let Behind {
            next, target, exit, ..
        } = behind;
        let limits = &next.limits;
        let blended = || {
            let planned = self.planner.blend(from, *target, exit, limits, limits);
            planned.ok().flatten()
        };
        let to_rest = || {
            let planned = self
                .planner
                .move_to(MoveProfile::Online, from, *target, limits, limits);
            planned.ok()
        };
        // Before a reversal it must be able to come to rest. Whether it reverses is decided when it begins.
        let plan = if exit.wanted > 0.0 { blended() } else { None };
        let plan = plan.or_else(to_rest)?;
        let goal = goal_past(&plan, 0, *target, behind.forward);
        self.arrives(&plan, goal, behind).then_some(goal)
    }

    /// The same if it passes its own end on a ramp, too, and the command behind it passes its end as wanted.
    fn scans_speeding(&self, from: &Setpoint, behind: &Behind<'_>) -> Option<u64> {
        if (behind.target > from.position) != behind.forward {
            return None;
        }
        let entry = Entry {
            end: Some(behind.target),
            ..*behind.next
        };
        let after = self.behind_at(behind.number + 1, &entry, behind.target, behind.forward)?;
        let plan = self.letting_go(&entry, from, behind.exit.wanted, &entry.limits, &after)?;
        let goal = goal_past(&plan, 0, behind.target, behind.forward);
        let at_end = plan.at(goal);
        let is_speeding = at_end.velocity * at_end.acceleration > 0.0;
        let goes_on = || self.scans_as_asked(&at_end, &after).is_some();
        (is_speeding && self.arrives(&plan, goal, behind) && goes_on()).then_some(goal)
    }

    /// Whether a `plan` of the next command is in an allowed state at its end in the scan `goal`.
    fn arrives(&self, plan: &P::Plan, goal: u64, behind: &Behind<'_>) -> bool {
        let is_slow = plan.at(goal).velocity.abs() <= behind.exit.most * (1.0 + ROUNDING);
        is_slow && !self.turns(plan, behind.forward) && keeps_rates_of(plan, &behind.next.limits)
    }
}

/// Whether a motion slows down.
pub(super) fn is_braking(state: &Setpoint) -> bool {
    state.velocity * state.acceleration < 0.0
}

/// The lower rates of a command and the next one, but its own velocity and deceleration.
fn rates_of_both(own: &Limits, next: &Limits) -> Limits {
    Limits {
        velocity: own.velocity,
        acceleration: own.acceleration.min(next.acceleration),
        deceleration: own.deceleration,
        jerk: own.jerk.min(next.jerk),
        snap: own.snap.min(next.snap),
    }
}

/// Whether a plan exceeds none of its limits, except for the velocity.
pub(super) fn keeps_rates<P: Plan>(plan: &P) -> bool {
    is_of_velocity(plan.excess())
}

/// The same for other limits.
fn keeps_rates_of<P: Plan>(plan: &P, limits: &Limits) -> bool {
    is_of_velocity(plan.excess_over(limits))
}

/// The same, except for the excess that its `start` has already.
fn keeps_rates_from<P: Plan>(plan: &P, start: &Setpoint, limits: &Limits) -> bool {
    let most = if is_braking(start) {
        limits.deceleration
    } else {
        limits.acceleration
    };
    let above = |value: f64, limit: f64| (value.abs() - limit).max(0.0) * (1.0 + ROUNDING);
    plan.excess_over(limits).is_none_or(|excess| {
        excess.acceleration <= above(start.acceleration, most)
            && excess.jerk <= above(start.jerk, limits.jerk)
    })
}

fn is_of_velocity(excess: Option<Excess>) -> bool {
    excess.is_none_or(|excess| excess.acceleration == 0.0 && excess.jerk == 0.0)
}
