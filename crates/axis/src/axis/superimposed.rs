//! A second motion on top of the owner's: MC_MoveSuperimposed adds it, MC_HaltSuperimposed ends it.
//!
//! The owner's set-point and the added motion are planned separately and published as their sum, so the owner keeps
//! its time and path. The added motion must leave the sum inside the limits of the axis. It is used as commanded, or
//! slower, or it waits until the owner's motion leaves room (docs/superimposed.md, docs/decisions/0006).
//!
//! Source: PLCopen Motion Control Part 1, sections MC_MoveSuperimposed and MC_HaltSuperimposed; R51, R64 to
//! R66, S9, V14, V14a.

mod behind;
mod plan;
mod soonest;
mod update;

use self::soonest::Search;
use super::commands::{Entry, REST, Work, WorkKind};
use super::mover::{Mover, even_scans};
use super::{Axis, Motion};
use crate::{AxisEvent, AxisState, CommandId, ErrorId, Event, Fate, InstanceId, Scope, Superimpose};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

/// The kinds of superimposed commands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Adds {
    /// MC_MoveSuperimposed, in the coordinate of the added motion.
    Distance {
        /// As commanded (u).
        distance: f64,
        /// The position at which it took over (u).
        origin: f64,
        /// The position at which it ends (u).
        target: f64,
    },
    /// MC_HaltSuperimposed.
    Halt,
}

/// A superimposed command.
#[derive(Clone, Copy, Debug)]
pub(super) struct Added {
    pub id: CommandId,
    instance: InstanceId,
    adds: Adds,
    /// Its limits, lowered by those of the application and scaled by the override.
    limits: Limits,
    /// As commanded.
    asked: Limits,
    /// The override holds it: it comes to rest, and continues when the velocity factor is raised.
    halting: bool,
    progress: Progress,
    /// No block follows it: its instance was triggered again, and that command was refused.
    orphaned: bool,
}

/// The progress of a superimposed command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Progress {
    /// It waits for room, and the command before it comes to its end.
    Waits,
    /// The motion added is this command's.
    Runs,
    /// The same, slower than commanded.
    RunsSlower,
}

impl Added {
    /// The motion added is this command's.
    fn runs(&self) -> bool {
        self.progress != Progress::Waits
    }

    /// Whether more room would change something: it would begin, or go faster.
    fn lacks_room(&self) -> bool {
        self.progress != Progress::Runs
    }

    /// It has to wait before it continues. Without a block it does not wait, and is a halt from now on.
    fn wait(&mut self) {
        if self.orphaned {
            self.adds = Adds::Halt;
            self.halting = false;
        }
        self.progress = match self.adds {
            Adds::Halt => Progress::Runs,
            Adds::Distance { .. } => Progress::Waits,
        };
    }
}

/// The second motion and the motion under it.
#[derive(Clone, Copy, Debug)]
pub(super) struct Layer<Plan> {
    /// Set-point of the owner alone.
    base: Setpoint,
    /// The number of scans in which the owner's motion was even; see [`even_scans`]. Counted only on an axis with a
    /// shaper.
    even: u32,
    /// The added motion; its position counts from the start of the layer.
    added: Setpoint,
    /// The part of `added.position` that the positions of `base` already contain (u).
    taken: f64,
    /// The motion of `added`; never [`Motion::Follow`].
    motion: Motion<Plan>,
    /// Limits of that motion.
    in_force: Limits,
    /// Limits of the motion that it took over from.
    before: Limits,
    command: Option<Added>,
    /// Scan of the owner's plan from which a command that waits or was lowered may find more room.
    retry: u64,
    /// The results of the search for the command.
    search: Search,
}

impl<P: Plan> Layer<P> {
    fn on(mover: &Mover<P>, limits: &Limits) -> Self {
        Self {
            base: *mover.setpoint(),
            even: mover.even(),
            added: Setpoint::default(),
            taken: 0.0,
            motion: Motion::Hold,
            in_force: *limits,
            before: *limits,
            command: None,
            retry: 0,
            search: Search::NEW,
        }
    }

    /// Set-point of the owner alone.
    pub fn base(&self) -> &Setpoint {
        &self.base
    }

    /// The added motion; its position counts from the start of the layer.
    pub fn added(&self) -> &Setpoint {
        &self.added
    }

    /// The motion of the added part.
    pub fn motion(&self) -> &Motion<P> {
        &self.motion
    }

    /// The number of scans in which the owner's motion was even.
    pub fn even(&self) -> u32 {
        self.even
    }

    /// Notes that the owner is at `base` after this step.
    pub fn count_even(&mut self, base: &Setpoint, coarsest: f64) {
        self.even = even_scans(self.even, &self.base, base, coarsest);
    }

    /// The owner is at `base` at the end of this scan, and the added motion continues. Returns their sum.
    pub fn step(&mut self, base: Setpoint) -> Setpoint {
        self.base = base;
        self.search.pass();
        if let Motion::Run { plan, elapsed, .. } = &mut self.motion {
            *elapsed = elapsed.saturating_add(1);
            self.added = plan.next(*elapsed);
        }
        self.sum()
    }

    /// Shifts the coordinates by `by` (u).
    pub fn shift(&mut self, by: f64) {
        self.base.position += by;
    }

    /// The part of the added distance that the positions in the owner's frame contain (u).
    pub fn taken(&self) -> f64 {
        self.taken
    }

    pub fn moves(&self) -> bool {
        matches!(self.motion, Motion::Run { .. })
    }

    /// The limits of the added motion.
    pub fn limits_in_motion(&self) -> Option<&Limits> {
        self.moves().then_some(&self.in_force)
    }

    /// Whether there is still something to add. A halt that finds nothing in motion adds nothing.
    fn is_busy(&self) -> bool {
        self.moves() || matches!(&self.command, Some(command) if command.adds != Adds::Halt)
    }

    /// Scans left of the motion of `command`; the largest number if it waits or is at rest.
    fn scans_in_progress(&self, command: &Added) -> u64 {
        match &self.motion {
            Motion::Run { elapsed, scans, .. } if command.runs() => scans.saturating_sub(*elapsed),
            _ => u64::MAX,
        }
    }

    /// The distance that is still to be added (u).
    fn left(&self) -> f64 {
        let end = match (&self.command, &self.motion) {
            (
                Some(Added {
                    adds: Adds::Distance { target, .. },
                    ..
                }),
                _,
            ) => *target,
            (_, Motion::Run { plan, .. }) => plan.end().position,
            (_, _) => self.added.position,
        };
        end - self.added.position
    }

    /// The owner's plan starts again at `start` (u), `passed` scans later than before. Returns the sum's position.
    pub fn bring_back(&mut self, start: f64, passed: u64) -> f64 {
        self.base.position = start;
        if self.retry != u64::MAX {
            // 0 means a command that was not tried yet.
            self.retry = self.retry.saturating_sub(passed).max(1);
        }
        self.sum().position
    }

    /// The owner's plan starts at `start` (u) of its own frame; returns the sum's position.
    pub fn start_at(&mut self, start: f64) -> f64 {
        self.base.position = start;
        self.sum().position
    }

    /// The owner takes over the whole velocity, as `sum`; the rest of the distance starts again from
    /// rest.
    pub fn pass_velocity(&mut self, sum: Setpoint) {
        self.base = sum;
        self.motion = Motion::Hold;
        self.added = Setpoint::at_rest(self.added.position);
        if let Some(command) = &mut self.command {
            command.wait();
        }
    }

    /// The rest of a superimposed distance, and the limits it keeps.
    pub fn distance_in_progress(&self) -> Option<((&P, u64), &Limits)> {
        match (&self.motion, &self.command) {
            (Motion::Run { plan, elapsed, .. }, Some(command)) if command.adds != Adds::Halt => {
                Some(((plan, *elapsed), &self.in_force))
            }
            _ => None,
        }
    }

    /// The owner's motion has changed: a command that waits or was lowered is tried again.
    pub fn try_soon(&mut self) {
        self.retry = 0;
        self.search = Search::NEW;
    }

    /// The place of the axis once everything is added, with the owner at `position` (u).
    pub fn end_above(&self, position: f64) -> f64 {
        position + (self.added.position - self.taken) + self.left()
    }

    /// The same for any part of the rest that may be added by then: the place farthest `forward`, or farthest back.
    /// `is_owner` says whether `position` is the owner's place, or that of the command that takes over from it now.
    pub fn farthest_above(&self, position: f64, forward: bool, is_owner: bool) -> f64 {
        let added = if is_owner {
            self.added.position - self.taken
        } else {
            0.0
        };
        let left = self.left();
        position + added + if forward { left.max(0.0) } else { left.min(0.0) }
    }

    fn sum(&self) -> Setpoint {
        let position = self.added.position - self.taken;
        self.base.plus(&self.added.moved_to(position))
    }
}

impl<P: Planner> Axis<P> {
    /// Takes MC_MoveSuperimposed, or refuses it without any effect (R38). It aborts only an earlier
    /// superimposed command (R66), and takes over from its motion.
    ///
    /// Cost: if the owner moves, that of `Axis::soonest`: at most 48 plans, and 16 in a later scan; otherwise at most
    /// 7. Each is laid over the owner's plan.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows; the refusal is recorded with pin, value and limit. A lack of room
    /// under the axis limits is no error: the command waits.
    pub fn superimpose(
        &mut self,
        request: &Superimpose,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        self.admit_superimposed()
            .map_err(|error| self.refuse("", f64::NAN, f64::NAN, error, scope))?;
        let layer = self
            .mover
            .layer()
            .copied()
            .unwrap_or_else(|| Layer::on(&self.mover, &self.config.limits));
        let id = self.new_id();
        let command = self.added(id, layer.added.position, &layer, request, scope)?;
        let refuse = |error| self.refuse("Distance", request.distance, f64::NAN, error, scope);
        if self.follows() {
            self.propose_alone(&layer, &command).map_err(refuse)?;
            self.end_superimposed_command(Fate::Aborted);
            self.await_room(layer, command);
            return Ok(id);
        }
        let mut search = Search::NEW;
        let proposed = self.propose(&layer, &command, &mut search).map_err(refuse)?;
        if self.state == AxisState::Standstill {
            self.enter(AxisEvent::StartDiscrete);
        }
        self.end_superimposed_command(Fate::Aborted);
        self.end_routine();
        let layer = self.mover.layer_or(layer);
        layer.command = Some(command);
        layer.search = search;
        self.add(proposed, scope);
        self.rest_before_outside(scope);
        Ok(command.id)
    }

    /// A superimposed distance moves the owner's end, and with it the end of a blended distance behind it. If that is
    /// now outside the software limits, the owner comes to rest at its end, and the next command is refused there.
    fn rest_before_outside(&mut self, scope: &mut Scope<'_>) {
        let blends = |owner: &Entry| owner.passage != REST;
        let (Some(owner), Some(layer)) = (self.owner.filter(blends), self.mover.layer()) else {
            return;
        };
        let (Some(end), Some(next)) = (owner.end, self.queue.first()) else {
            return;
        };
        let target = self.end_of_leg(next, layer.end_above(end), end > layer.base.position);
        if target.is_some_and(|target| self.allowed(target).is_err()) {
            self.pass_at_rest(scope);
        }
    }

    /// Takes MC_HaltSuperimposed: aborts the superimposed command and brings its motion to rest; the
    /// owner continues. With nothing superimposed it completes without effect, in every state (V14a). The
    /// velocity and acceleration of `dynamics` are not read.
    ///
    /// # Errors
    /// The [`ErrorId`] of a pin; nothing changes then.
    pub fn halt_superimposed(
        &mut self,
        dynamics: &crate::Dynamics,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        let asked = self.resolve(dynamics, scope)?;
        let limits = self.slowed(&asked);
        let layer = self
            .mover
            .layer()
            .copied()
            .unwrap_or_else(|| Layer::on(&self.mover, &limits));
        let command = Added {
            id: self.new_id(),
            instance: scope.instance,
            adds: Adds::Halt,
            limits,
            asked,
            halting: false,
            progress: if layer.moves() {
                Progress::Waits
            } else {
                Progress::Runs
            },
            orphaned: false,
        };
        if self.follows() {
            self.end_superimposed_command(Fate::Aborted);
            self.await_room(layer, command);
            return Ok(command.id);
        }
        let mut search = Search::NEW;
        let proposed = if layer.moves() {
            self.propose(&layer, &command, &mut search)
                .map_err(|error| self.refuse("Deceleration", limits.deceleration, f64::NAN, error, scope))?
        } else {
            None
        };
        self.end_superimposed_command(Fate::Aborted);
        self.end_routine();
        self.mover.layer_or(layer).command = Some(command);
        if !command.runs() {
            self.add(proposed, scope);
        }
        Ok(command.id)
    }

    /// The distance superimposed command `id` has added so far (u); kept for the last one that ended.
    pub fn covered_distance(&self, id: CommandId) -> Option<f64> {
        if let Some(layer) = self.mover.layer()
            && let Some(command) = &layer.command
            && command.id == id
        {
            return Some(match command.adds {
                Adds::Distance { origin, .. } => layer.added.position - origin,
                Adds::Halt => 0.0,
            });
        }
        self.fates.covered(id)
    }

    /// The state of superimposed command `id`, if it is the present one.
    pub(super) fn superimposed_fate(&self, id: CommandId) -> Option<Fate> {
        let command = self.mover.layer()?.command.as_ref()?;
        (command.id == id).then_some(if command.runs() {
            Fate::Active { reached: false }
        } else {
            Fate::Waiting
        })
    }

    /// Whether some distance is still to be superimposed.
    pub(super) fn is_superimposing(&self) -> bool {
        self.mover.layer().is_some_and(Layer::is_busy)
    }

    /// The highest speed (u/s) that the superimposed motion can still reach, and from which it can stop in its
    /// distance.
    ///
    /// Cost: one ramp or root of ramps.
    pub(super) fn superimposed_speed(&self) -> f64 {
        let Some(layer) = self.mover.layer() else {
            return 0.0;
        };
        let limits = match &layer.command {
            Some(command) => &command.limits,
            None if layer.moves() => &layer.in_force,
            None => return 0.0,
        };
        self.speed_over(layer.left(), limits)
            .max(layer.added.velocity.abs())
    }

    /// The highest speed (u/s) of a motion over `distance` (u).
    fn speed_over(&self, distance: f64, limits: &Limits) -> f64 {
        self.planner
            .entry_speed(limits.velocity, 0.0, distance.abs(), 0.0, limits)
    }

    /// The distance that is still to be superimposed (u).
    pub(super) fn superimposed_left(&self) -> f64 {
        self.mover.layer().map_or(0.0, Layer::left)
    }

    /// Checks that it may start in this state (R64, S9).
    fn admit_superimposed(&self) -> Result<(), ErrorId> {
        if self.power.is_going_off() {
            return Err(ErrorId::PoweringOff);
        }
        match self.state {
            AxisState::Disabled => Err(ErrorId::NotPowered),
            AxisState::ErrorStop => Err(ErrorId::InErrorStop),
            AxisState::Stopping => Err(ErrorId::InStopping),
            AxisState::Homing => Err(ErrorId::InHoming),
            _ if matches!(self.mover.motion(), Motion::Torque { .. }) => Err(ErrorId::TorqueControls),
            _ if self.has_lost_master() => Err(ErrorId::MasterLost),
            AxisState::Standstill
            | AxisState::DiscreteMotion
            | AxisState::ContinuousMotion
            | AxisState::SynchronizedMotion => Ok(()),
        }
    }

    /// The rest position of the owner (u); NaN if it does not come to rest by itself.
    fn base_end(&self, layer: &Layer<P::Plan>) -> f64 {
        match (self.mover.motion(), self.owner.as_ref().map(|owner| owner.work)) {
            (Motion::Run { .. }, Some(Work::Velocity { .. } | Work::Through { .. })) => f64::NAN,
            // While the override halts it, its plan ends elsewhere.
            (Motion::Run { .. }, Some(work)) if work.manner().blends => self
                .owner
                .as_ref()
                .and_then(|owner| owner.end)
                .unwrap_or(f64::NAN),
            // A slave has no end of its own.
            _ if self.follows() => f64::NAN,
            (Motion::Run { plan, .. }, _) => plan.end().position,
            (_, _) => layer.base.position,
        }
    }

    /// Ends the superimposed command, if there is one; the caller handles its motion.
    pub(super) fn end_superimposed_command(&mut self, fate: Fate) {
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        let moves = layer.moves();
        let Some(command) = layer.command.take() else {
            return;
        };
        let fate = match command.adds {
            Adds::Distance { distance, .. } if fate == Fate::Done => {
                self.fates.cover(command.id, distance);
                fate
            }
            Adds::Distance { origin, .. } => {
                self.fates.cover(command.id, layer.added.position - origin);
                fate
            }
            // It has nothing to do.
            Adds::Halt if !moves => Fate::Done,
            Adds::Halt => fate,
        };
        self.decide(command.id, fate);
    }

    /// The instance of superimposed command `id` gives another command. If `id` waits for room or is held up, its
    /// motion comes to rest. Returns whether that is the case.
    pub(super) fn withdraw_superimposed(&mut self, id: CommandId) -> bool {
        let Some(layer) = self.mover.layer_mut() else {
            return false;
        };
        let waits = |command: &&mut Added| command.id == id && (!command.runs() || command.halting);
        let Some(command) = layer.command.as_mut().filter(waits) else {
            return false;
        };
        command.orphaned = true;
        command.wait();
        command.progress = Progress::Waits;
        layer.try_soon();
        self.end_routine();
        true
    }

    /// No block follows superimposed command `id` any more; `false` if it has ended.
    pub(super) fn orphan_superimposed(&mut self, id: CommandId) -> bool {
        let command = self.mover.layer_mut().and_then(|layer| layer.command.as_mut());
        let command = command.filter(|command| command.id == id);
        command.is_some_and(|command| {
            command.orphaned = true;
            true
        })
    }

    /// Ends the superimposed motion and its command (R65): from now on there is one motion, that of the sum.
    pub(super) fn end_superimposed(&mut self, fate: Fate) {
        if self.mover.layer().is_some() {
            self.drop_superimposed(fate);
        }
    }

    #[cold]
    fn drop_superimposed(&mut self, fate: Fate) {
        self.mover.keep(self.limits_before(self.mover.in_force()));
        self.end_superimposed_command(fate);
        self.mover.drop_layer();
        self.end_routine();
    }

    /// The motion step with a superimposed motion: both motions advance, and their sum is published.
    #[inline(never)]
    pub(super) fn advance_both(&mut self, scope: &mut Scope<'_>) {
        if matches!(self.mover.motion(), Motion::Torque { .. }) {
            return self.advance_torque_below(scope);
        }
        self.note_end_of_profile();
        let Some(next) = self.mover.step_both(self.feedback.position()) else {
            return;
        };
        let fault = if self.is_following() {
            // A set-point that follows the feedback belongs to no plan.
            (!next.is_finite()).then_some(ErrorId::SetpointBroken)
        } else {
            self.fault_of(next)
        };
        if let Some(error) = fault {
            self.fail(error, scope);
        } else if self.parameters.software_limits.is_some() && self.would_leave(next) {
            self.fail(ErrorId::SoftwareLimitReached, scope);
        } else {
            self.mover.publish(next);
        }
        if self.modulo.is_some() {
            self.bring_back();
        }
        if self.goal_reached() {
            self.settle(scope);
        }
        self.settle_superimposed(scope);
        if self.replan_due {
            self.replan_late(scope);
        }
    }

    /// Under a torque nothing is superimposed: MC_HaltSuperimposed has nothing to do, and the drive keeps its torque.
    #[cold]
    fn advance_torque_below(&mut self, scope: &mut Scope<'_>) {
        self.step_torque();
        let setpoint = *self.mover.setpoint();
        if let Some(layer) = self.mover.layer_mut() {
            layer.base = setpoint;
        }
        self.settle_superimposed(scope);
    }

    /// Completes the superimposed motion, and tries a command again that waits or was lowered.
    fn settle_superimposed(&mut self, scope: &mut Scope<'_>) {
        let delay = self.mover.shaping_delay();
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        let was_busy = layer.command.is_some();
        let reached = match &layer.motion {
            Motion::Run { elapsed, scans, .. } => *elapsed >= scans.saturating_add(delay),
            _ => true,
        };
        if reached {
            self.reach_added();
        }
        self.try_again(scope);
        if was_busy && matches!(self.mover.motion(), Motion::Run { .. }) {
            self.end_of_superimposed(scope);
        }
        if !matches!(self.mover.motion(), Motion::Run { .. }) {
            self.leave_added(was_busy, scope);
        }
    }

    /// The added motion has come to its end.
    #[inline(never)]
    fn reach_added(&mut self) {
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        layer.added = Setpoint::at_rest(layer.added.position);
        let stopped = layer.moves();
        layer.motion = Motion::Hold;
        match layer.command {
            Some(command) if !command.halting && (command.runs() || command.adds == Adds::Halt) => {
                self.end_superimposed_command(Fate::Done);
            }
            // It is at rest now, so more may fit.
            Some(_) if stopped => layer.try_soon(),
            Some(_) | None => {}
        }
    }

    /// The owner does not move by a plan. With no command superimposed, nor in this scan, there is one motion again.
    #[inline(never)]
    fn leave_added(&mut self, was_busy: bool, scope: &mut Scope<'_>) {
        // A paused owner continues to its end later. That end has moved by the added distance.
        let keeps = |layer: &Layer<P::Plan>| self.is_paused() && layer.added.position != layer.taken;
        let kept = self.mover.layer().is_some_and(keeps);
        let is_idle = self.mover.layer().is_some_and(|layer| layer.command.is_none());
        if is_idle && (was_busy || !kept) {
            if !kept {
                self.mover.drop_layer();
            }
            self.end_routine();
            if self.owner.is_none() && self.state == AxisState::DiscreteMotion {
                self.enter(AxisEvent::MotionDone);
                self.hand_over(self.mover.setpoint().position, scope);
            }
            self.resume(scope);
        }
    }

    /// When the superimposed motion has ended, a command that waits behind the owner is blended again. If nothing has
    /// been added, there is only one motion left.
    fn end_of_superimposed(&mut self, scope: &mut Scope<'_>) {
        let Some(layer) = self
            .mover
            .layer()
            .filter(|layer| layer.command.is_none() && !layer.moves())
        else {
            return;
        };
        if layer.added.position == layer.taken {
            self.mover.drop_layer();
            self.end_routine();
        }
        self.arm_owner(scope);
    }

    /// A command that was given while only a superimposed motion moved starts beside it at once.
    pub(super) fn start_beside(&mut self, scope: &mut Scope<'_>) {
        if self.owner.is_none() && self.state == AxisState::DiscreteMotion {
            self.hand_over(self.mover.setpoint().position, scope);
        }
    }

    /// The superimposed motion comes to rest with the stop dynamics; the rest of its distance waits.
    #[cold]
    pub(super) fn brake_superimposed(&mut self) {
        let (mut limits, axis) = (
            self.slowed(&self.stop_limits()),
            self.slowed(&self.hardest_limits()),
        );
        let Some(layer) = self.mover.layer() else {
            return;
        };
        let planned = self.stopped_inside(&layer.added, &mut limits, &layer.in_force, &axis);
        if let (Ok(plan), Some(layer)) = (planned, self.mover.layer_mut())
            && let Some(command) = &mut layer.command
        {
            layer.motion = Motion::along(plan);
            layer.in_force = limits;
            command.wait();
        }
        self.watch_anew();
    }

    /// For [`crate::Outlook`]: the command, the scans left as for the owner, whether it waits for room,
    /// and the positions of both motions as bits.
    pub(super) fn superimposed_outlook(&self) -> Option<super::Beside> {
        self.mover.layer().map(|layer| super::Beside {
            command: layer.command.as_ref().map(|command| {
                let kind = match command.adds {
                    Adds::Distance { .. } => WorkKind::Distance,
                    Adds::Halt => WorkKind::Halt,
                };
                (command.id, kind, command.runs())
            }),
            scans_left: layer.motion.scans_left().unwrap_or(0),
            tried_in: match (&layer.command, self.mover.motion()) {
                (Some(command), Motion::Run { elapsed, .. }) if command.lacks_room() => {
                    u32::try_from(layer.retry.saturating_sub(*elapsed)).unwrap_or(u32::MAX)
                }
                _ => 0,
            },
            found: match &layer.command {
                Some(command) if command.lacks_room() => layer.search.bits(),
                _ => [0; 9],
            },
            base: (layer.base.position.to_bits(), layer.base.velocity.to_bits()),
            added: (layer.added.position.to_bits(), layer.left().to_bits()),
        })
    }

    fn record_as(&self, command: &Added, event: Event, scope: &mut Scope<'_>) {
        self.record(event, &mut scope.with(command.instance));
    }
}
