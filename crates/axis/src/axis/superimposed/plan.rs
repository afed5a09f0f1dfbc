//! Finding a superimposed motion that leaves the sum inside the axis limits.

use super::soonest::{Below, Search};
use super::{Added, Adds, Layer, Progress};
use crate::axis::commands::{Entry, Work, refusal};
use crate::axis::inside::pins;
use crate::axis::{Axis, Motion};
use crate::{AxisState, Dynamics, ErrorId, Event, Fate, Scope};
use standstill_planner::math::min;
use standstill_planner::{Limits, Plan, Planner, Setpoint};

/// Motions tried, one after the other, until one fits.
pub(super) const PROPOSALS: usize = 7;

/// From the fourth on, the commanded motion is slowed by this factor: the same path in more time.
const SLOWER: [f64; PROPOSALS - 3] = [0.75, 0.5, 0.25, 0.125];

/// A motion that fits.
pub(super) struct Proposal<Plan> {
    pub plan: Plan,
    pub limits: Limits,
    /// It differs from the commanded one.
    pub lowered: bool,
}

/// The room that the owner's motion leaves at any time.
pub(super) struct Room {
    pub limits: Limits,
    /// The owner's motion is endless: there will never be more room than now.
    pub endless: bool,
}

impl Room {
    /// The free part of `asked`. `None` if nothing is free. Also `None` if it is less than the slowest proposal needs
    /// and the owner's motion will end: then waiting is faster.
    fn of(&self, asked: f64, free: f64, least: f64) -> Option<f64> {
        let least = if self.endless { 0.0 } else { least * asked };
        (free >= asked || (free > 0.0 && free >= least)).then_some(min(asked, free))
    }
}

/// `limits` for the same path in a time longer by `1 / rate`.
pub(super) fn slower(limits: &Limits, rate: f64) -> Limits {
    let square = rate * rate;
    Limits {
        velocity: limits.velocity * rate,
        acceleration: limits.acceleration * square,
        deceleration: limits.deceleration * square,
        jerk: limits.jerk * (square * rate),
        snap: limits.snap * (square * square),
    }
}

/// The limits of proposal `index`: as commanded, then with at most the velocity that is always free, then with at
/// most all limits that are always free, then slower and slower. `None` if there is no such proposal.
pub(super) fn limits_of(index: usize, asked: &Limits, room: &Room) -> Option<Limits> {
    const LEAST: f64 = SLOWER[SLOWER.len() - 1];
    const LEAST_2: f64 = LEAST * LEAST;
    let free = &room.limits;
    match index {
        0 => Some(*asked),
        1 => Some(asked.with_velocity(room.of(asked.velocity, free.velocity, LEAST)?)),
        2 => Some(Limits {
            velocity: room.of(asked.velocity, free.velocity, LEAST)?,
            acceleration: room.of(asked.acceleration, free.acceleration, LEAST_2)?,
            deceleration: room.of(asked.deceleration, free.deceleration, LEAST_2)?,
            jerk: room.of(asked.jerk, free.jerk, LEAST_2 * LEAST)?,
            snap: room.of(asked.snap, free.snap, LEAST_2 * LEAST_2)?,
        }),
        _ => Some(slower(asked, *SLOWER.get(index.checked_sub(3)?)?)),
    }
}

impl<P: Planner> Axis<P> {
    /// Checks the values at the pins of MC_MoveSuperimposed.
    pub(super) fn superimposed_limits(
        &self,
        dynamics: &Dynamics,
        scope: &mut Scope<'_>,
    ) -> Result<Limits, ErrorId> {
        let velocity = self.positive_velocity("VelocityDiff", dynamics.velocity, scope)?;
        Ok(self.resolve(dynamics, scope)?.with_velocity(velocity))
    }

    /// The software limits in the sum of the plans' own positions.
    fn range(&self, taken: f64) -> Option<(f64, f64)> {
        self.parameters
            .software_limits
            .map(|(min, max)| (min + taken, max + taken))
    }

    /// The first proposal for `command` from the state of `layer` that fits the owner's motion;
    /// `Ok(None)` if none does for now.
    ///
    /// # Errors
    /// The planner refuses the original command, or MC_Power bars its direction.
    pub(super) fn propose(
        &self,
        layer: &Layer<P::Plan>,
        command: &Added,
        search: &mut Search,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        let axis = &self.slowed(&self.config.limits);
        let base = self.mover.plan();
        let room = || Room {
            limits: base.map_or(*axis, |rest| self.planner.room(rest, axis)),
            endless: base.is_some_and(|(plan, _)| plan.end().velocity != 0.0),
        };
        let range = self.range(layer.taken);
        let is_distance = matches!(command.adds, Adds::Distance { .. }) && !command.halting;
        if let (Some(rest), true) = (base, is_distance) {
            self.admit_way(layer, command)?;
            if !self.may_run_past_the_end(layer, command, rest) {
                return Ok(None);
            }
            return self.soonest(layer, command, &room(), &Below { rest, axis, range }, search);
        }
        // A motion of distance 0 may not reverse outside the software limits either.
        let still = Setpoint::at_rest(layer.base.position);
        let hold = range.and_then(|_| self.planner.ramp_to(&still, 0.0, axis, axis).ok());
        let base = base.or(hold.as_ref().map(|plan| (plan, 0)));
        self.propose_within(layer, command, room, |plan| {
            base.is_none_or(|rest| self.planner.fits(rest, (plan, 0), axis, range))
        })
    }

    /// Whether the owner may pass its end for a blended command with `command` in motion: from there both together
    /// have to stop inside the software limits.
    fn may_run_past_the_end(&self, layer: &Layer<P::Plan>, command: &Added, rest: (&P::Plan, u64)) -> bool {
        let blends = self
            .owner
            .is_some_and(|owner| owner.passage.wanted > 0.0 && !owner.halted);
        let Adds::Distance { target, .. } = command.adds else {
            return true;
        };
        let (shift, left) = (layer.added.position - layer.taken, target - layer.added.position);
        let added = || {
            self.speed_over(left, &command.limits)
                .max(layer.added.velocity.abs())
        };
        !blends || self.stops_beside(rest, shift, left, added())
    }

    /// The same over any motion that always leaves this `room`, if the added motion `fits`.
    pub(super) fn propose_within(
        &self,
        layer: &Layer<P::Plan>,
        command: &Added,
        room: impl FnOnce() -> Room,
        fits: impl Fn(&P::Plan) -> bool,
    ) -> Result<Option<Proposal<P::Plan>>, ErrorId> {
        if command.halting && !layer.moves() {
            return Ok(None);
        }
        self.admit_way(layer, command)?;
        let room = room();
        let moving = self.limits_in_state(&layer.added, &layer.in_force, &layer.before);
        let mut last = None;
        for index in 0..PROPOSALS {
            let limits = limits_of(index, &command.limits, &room);
            let Some(limits) = limits.filter(|limits| last != Some(*limits)) else {
                continue;
            };
            last = Some(limits);
            let before = if layer.moves() { &moving } else { &limits };
            let planned = match command.adds {
                Adds::Distance { .. } if command.halting => {
                    self.planner.ramp_to(&layer.added, 0.0, &limits, before)
                }
                Adds::Distance { target, .. } => {
                    let profile = self.config.profile;
                    self.planner
                        .move_to(profile, &layer.added, target, &limits, before)
                }
                Adds::Halt => self.planner.ramp_to(&layer.added, 0.0, &limits, before),
            };
            match planned {
                Ok(plan) => {
                    if command.adds != Adds::Halt
                        && !command.halting
                        && let Some(error) = self.barred((&plan, 0), &limits, before)
                    {
                        return Err(error);
                    }
                    // Without the owner it exceeds the axis limits only if it takes over from a motion for which its
                    // own limits are too low. That motion may continue instead.
                    let motion = Motion::along(plan);
                    if !self.exceeds(&motion) && fits(&plan) {
                        let is_faster = u64::from(plan.scans()) < layer.scans_in_progress(command);
                        return Ok(is_faster.then_some(Proposal {
                            plan,
                            limits,
                            lowered: index > 0,
                        }));
                    }
                }
                Err(error) if index == 0 => return Err(refusal(error)),
                // A slower motion takes even longer.
                Err(_) => break,
            }
        }
        Ok(None)
    }

    /// Checks that MC_Power permits the direction of a distance that begins.
    fn admit_way(&self, layer: &Layer<P::Plan>, command: &Added) -> Result<(), ErrorId> {
        match command.adds {
            Adds::Distance { target, .. } if !layer.moves() => {
                self.way_barred(target - layer.added.position).map_or(Ok(()), Err)
            }
            Adds::Distance { .. } | Adds::Halt => Ok(()),
        }
    }

    /// Starts the layer's command as proposed. Without a proposal it waits, or its motion continues.
    pub(super) fn add(&mut self, proposed: Option<Proposal<P::Plan>>, scope: &mut Scope<'_>) {
        let next_switch = self
            .mover
            .plan()
            .map(|rest| (self.planner.next_switch(rest), rest.1));
        let Some(layer) = self.mover.layer() else { return };
        let before = self.limits_in_state(&layer.added, &layer.in_force, &layer.before);
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        let moves = layer.moves();
        let Some(command) = &mut layer.command else { return };
        let first = layer.retry == 0;
        let before = if moves { before } else { layer.in_force };
        layer.retry = next_switch
            .and_then(|(switch, now)| {
                let ahead = (switch > now).then(|| switch.saturating_sub(now));
                Some(now.saturating_add(layer.search.pause(ahead)?))
            })
            // Nothing changes until the owner does.
            .unwrap_or(u64::MAX);
        match proposed {
            Some(Proposal {
                plan,
                limits,
                lowered,
            }) => {
                command.progress = if lowered {
                    Progress::RunsSlower
                } else {
                    Progress::Runs
                };
                let command = *command;
                layer.before = before;
                layer.in_force = limits;
                layer.motion = Motion::along(plan);
                self.watch_anew();
                self.record_lowered(&command, &limits, scope);
                let scans = plan.scans();
                let distance = match command.adds {
                    Adds::Distance { distance, .. } if !command.halting => Some(distance),
                    Adds::Distance { .. } | Adds::Halt => None,
                };
                self.record_as(&command, Event::Superimposed { distance, scans }, scope);
            }
            None if first && !command.runs() && (!command.halting || moves) => {
                let command = *command;
                self.record_as(&command, Event::RoomAwaited, scope);
            }
            None => {}
        }
    }

    /// Records the pins whose values exceed the room.
    fn record_lowered(&self, command: &Added, used: &Limits, scope: &mut Scope<'_>) {
        for (pin, value, limit) in pins("VelocityDiff", &command.limits, used) {
            let rests = command.halting || command.adds == Adds::Halt;
            if limit < value && (pin != "VelocityDiff" || !rests) {
                self.record_as(command, Event::Clamped { pin, value, limit }, scope);
            }
        }
    }

    /// The override has changed: a superimposed move takes its new limits, comes to rest, or continues.
    pub(in crate::axis) fn override_superimposed(&mut self, scope: &mut Scope<'_>) {
        let Some(mut layer) = self.mover.layer().copied() else {
            return;
        };
        let Some(command) = layer
            .command
            .as_mut()
            .filter(|command| command.adds != Adds::Halt)
        else {
            return;
        };
        command.limits = self.slowed(&self.factors.of(&command.asked, &self.parameters.limits));
        command.halting = self.factors.halt();
        if command.halting {
            command.wait();
        }
        command.progress = Progress::Waits;
        layer.try_soon();
        self.end_routine();
        self.mover.lay(layer);
        self.try_again(scope);
    }

    /// A command that waits or was lowered is tried again when the owner's motion has changed.
    pub(super) fn try_again(&mut self, scope: &mut Scope<'_>) {
        let Some(layer) = self.mover.layer() else { return };
        let Some(command) = &layer.command else { return };
        if self.follows() {
            // Its own motion step decides.
            return;
        }
        let due = match self.mover.motion() {
            Motion::Run { elapsed, .. } => *elapsed >= layer.retry,
            _ => true,
        };
        if !command.lacks_room() || !due {
            return;
        }
        self.try_now(scope);
    }

    /// Tries the command. The planner accepts again what it accepted before. If not, or while the direction is barred,
    /// nothing changes.
    #[inline(never)]
    fn try_now(&mut self, scope: &mut Scope<'_>) {
        let Some(layer) = self.mover.layer() else { return };
        let Some(command) = &layer.command else { return };
        let mut search = layer.search;
        if let Ok(proposed) = self.propose(layer, command, &mut search) {
            if let Some(layer) = self.mover.layer_mut() {
                layer.search = search;
            }
            self.add(proposed, scope);
        }
    }

    /// The limits that apply to the last set-point: those of the motion in progress. With a superimposed motion they
    /// are those of both together, but at most those of the axis. `own` if there is no motion.
    pub(in crate::axis) fn limits_before(&self, own: &Limits) -> Limits {
        let base = self.limits_of_owner();
        let base = base.as_ref();
        let Some(layer) = self.mover.layer().filter(|layer| layer.moves()) else {
            return *base.unwrap_or(own);
        };
        let (axis, added) = (&self.slowed(&self.config.limits), &layer.in_force);
        let both = |of: fn(&Limits) -> f64| min(of(axis), of(added) + base.map_or(0.0, of));
        Limits {
            velocity: both(|limits| limits.velocity),
            acceleration: both(|limits| limits.acceleration),
            deceleration: both(|limits| limits.deceleration),
            jerk: both(|limits| limits.jerk),
            snap: both(|limits| limits.snap),
        }
    }

    /// Plans a waiting command that becomes the owner, on top of which a superimposed motion may
    /// continue; `Ok(None)` if it must wait for that motion.
    ///
    /// It starts at the real set position. If the added motion leaves room for it, it starts with the velocity of its
    /// predecessor alone. If not, it also takes over the velocity of the added motion, and the rest of the added
    /// distance starts again from rest when there is room.
    pub(in crate::axis) fn plan_next(
        &mut self,
        entry: &mut Entry,
    ) -> Result<Option<Motion<P::Plan>>, ErrorId> {
        // MC_Home sets the position at rest. The command before it, which should have brought the axis to rest, may
        // have failed.
        if matches!(entry.work, Work::Home(_)) {
            if self.is_superimposing() {
                return Ok(None);
            }
            if !matches!(self.state, AxisState::Standstill | AxisState::Homing) {
                return Err(ErrorId::InMotion);
            }
        }
        if matches!(entry.work, Work::Torque { .. } | Work::Gear(_) | Work::Cam(_))
            && self.mover.layer().is_some()
        {
            if self.mover.layer().is_some_and(Layer::moves) {
                return Ok(None);
            }
            // Only now: if this command is refused, the added motion stays with the owner.
            let motion = self.plan_for(entry)?;
            self.end_superimposed(Fate::Aborted);
            return Ok(Some(motion));
        }
        match self.mover.layer().copied() {
            None => self.plan_for(entry).map(Some),
            Some(layer) => self.plan_under(layer, entry),
        }
    }

    #[inline(never)]
    fn plan_under(
        &mut self,
        mut layer: Layer<P::Plan>,
        entry: &mut Entry,
    ) -> Result<Option<Motion<P::Plan>>, ErrorId> {
        let start = layer.base.moved_to(self.mover.setpoint().position);
        let in_force = if matches!(self.mover.motion(), Motion::Run { .. } | Motion::Geared) {
            *self.mover.in_force()
        } else {
            entry.limits
        };
        let motion = self.plan_from(entry, &start, &in_force)?;
        let mut motion = self.kept_inside(entry, motion, &start, &in_force)?;
        // A stop is never refused. It is watched if it may leave the limits.
        let leads_somewhere = !entry.is_endless() && entry.end.is_some();
        if let (Motion::Run { plan, .. }, true) = (&motion, leads_somewhere) {
            self.allowed(plan.end().position + layer.left())?;
        }
        layer.base = start;
        layer.taken = layer.added.position;
        if !self.fits_under(&motion, &layer) {
            motion = self.plan_from(entry, self.mover.setpoint(), &self.limits_before(&entry.limits))?;
            if self.exceeds(&motion) {
                // It cannot take over this velocity either. The velocity will be lower soon.
                return Ok(None);
            }
            layer.pass_velocity(*self.mover.setpoint());
        }
        layer.try_soon();
        self.end_routine();
        self.mover.lay(layer);
        Ok(Some(motion))
    }

    /// Whether a new motion of the owner leaves enough reserve for the added motion.
    pub(in crate::axis) fn fits_under(&self, motion: &Motion<P::Plan>, layer: &Layer<P::Plan>) -> bool {
        let (
            Motion::Run { plan, .. },
            Motion::Run {
                plan: added, elapsed, ..
            },
        ) = (motion, &layer.motion)
        else {
            return true;
        };
        let (axis, range) = (&self.slowed(&self.config.limits), self.range(layer.taken));
        self.planner.fits((plan, 0), (added, *elapsed), axis, range)
    }

    /// Whether a motion must exceed the limits of the axis.
    pub(in crate::axis) fn exceeds(&self, motion: &Motion<P::Plan>) -> bool {
        self.excess_of(motion).is_some()
    }
}
