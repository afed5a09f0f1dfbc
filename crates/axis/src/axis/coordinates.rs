//! Shifts of the coordinates: MC_SetPosition, and the position that MC_Home sets.
//!
//! The axis keeps its place and its motion; only the values of positions change. Set and actual position change by
//! the same amount, so neither the following error nor the velocity has a step. A drive that counts increments gets
//! the same increments as before.
//!
//! Source: PLCopen Motion Control Part 1, MC_SetPosition; V15, T39 i.

use super::commands::{Entry, Place, Work};
use super::{Axis, Motion};
use crate::{CommandId, ErrorId, Event, ExecutionMode, Fate, QUEUE_MAX, Raw, Scope};
use standstill_planner::Planner;
use standstill_planner::turns::split;

impl<P: Planner> Axis<P> {
    /// MC_SetPosition: the actual position becomes `position` (u), or with `relative` grows by it. The
    /// set position changes by the same amount. Works in every state, at rest and in motion, and never
    /// changes the state.
    ///
    /// A running absolute move keeps the value of its target, so its remaining distance changes: it is planned anew
    /// from the present state. All other motions continue unchanged. With `mcQueued` the command waits like a
    /// buffered one while the axis has an owner.
    ///
    /// Cost: at most one plan.
    ///
    /// # Errors
    /// The [`ErrorId`] the block shows. Causes: a position that is not finite or outside the first turn of a modulo
    /// axis; a position so large that two set-points could not be distinguished, or in motion such a present position;
    /// an undefined mode; a full buffer; a move that could not be planned anew. Nothing changes then.
    pub fn set_position(
        &mut self,
        position: f64,
        relative: bool,
        mode: Raw<ExecutionMode>,
        scope: &mut Scope<'_>,
    ) -> Result<CommandId, ErrorId> {
        let queued = self.is_queued(mode, scope)?;
        self.finite("Position", position, scope)?;
        if !relative {
            self.in_first_turn("Position", position, scope)?;
        }
        if queued {
            return self.enqueue(Work::SetPosition { position, relative }, scope);
        }
        self.move_coordinates(position, relative, scope)
            .map_err(|error| self.refuse("Position", position, f64::NAN, error, scope))?;
        Ok(self.done_at_once())
    }

    /// Whether the next command in the buffer shifts the coordinates. It takes effect at the next latch, so that this
    /// scan still publishes its set-point.
    pub(super) fn queue_waits_for_shift(&mut self) -> bool {
        self.end_routine();
        self.shift_due = self
            .queue
            .first()
            .is_some_and(|entry| matches!(entry.work, Work::SetPosition { .. }));
        self.shift_due
    }

    /// Shifts the coordinates for the commands at the head of the buffer. Then the next command becomes active.
    #[cold]
    pub(super) fn take_queued_shifts(&mut self, scope: &mut Scope<'_>) {
        for _ in 0..QUEUE_MAX {
            if !self.queue_waits_for_shift() {
                break;
            }
            let Some(entry) = self.queue.pop() else { break };
            let Work::SetPosition { position, relative } = entry.work else {
                break;
            };
            let scope = &mut scope.with(entry.instance);
            let fate = match self.move_coordinates(position, relative, scope) {
                Ok(()) => Fate::Done,
                Err(error) => Fate::Failed(self.refuse("Position", position, f64::NAN, error, scope)),
            };
            self.decide(entry.id, fate);
        }
        self.hand_over(self.mover.setpoint().position, scope);
    }

    /// A number that grows with each shift of the coordinates (MC_SetPosition, MC_Home), and wraps. Positions taken
    /// at different numbers can only be compared with [`Axis::coordinates_total`].
    pub fn coordinates(&self) -> u32 {
        self.frame.moves()
    }

    /// The sum of all shifts of the coordinates (u). A place has grown by as much as this has since, except for
    /// rounding and, on a modulo axis, whole turns.
    pub fn coordinates_total(&self) -> f64 {
        self.frame.total()
    }

    fn move_coordinates(
        &mut self,
        position: f64,
        relative: bool,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let by = if relative {
            position
        } else {
            position - self.feedback.position()
        };
        // Whole turns would only change the resolution of plans.
        let by = match &self.modulo {
            Some(modulo) if by.abs() >= modulo.length => split(by, modulo.length).1,
            _ => by,
        };
        // Without turns, an axis without following error is set to exactly the requested value, however far the
        // shift.
        let at = if !relative
            && self.modulo.is_none()
            && self.mover.setpoint().position == self.feedback.position()
        {
            position
        } else {
            self.mover.setpoint().position + by
        };
        let is_finite = at.is_finite()
            && (self.feedback.position() + by).is_finite()
            && (self.frame.shift() + by).is_finite();
        // If set-points were equal in the old coordinates, their difference can't be recovered in the new ones.
        let is_resolved = self.is_resolved(at)
            && (self.mover.setpoint().is_at_rest() || self.is_resolved(self.mover.setpoint().position));
        if !(is_finite && is_resolved) {
            return Err(ErrorId::PositionInvalid);
        }
        let names = self.mover.call(at, by);
        if let Err(error) = self.move_motion(by, scope) {
            self.mover.call_as_before(names);
            return Err(error);
        }
        self.frame.count_move(by);
        self.rename_places();
        self.feedback.shift(by);
        self.homing.shift(by);
        if !relative {
            self.feedback.call(position);
        }
        if let Some(modulo) = &self.modulo {
            let (_, in_turn) = split(self.feedback.position(), modulo.length);
            self.feedback.call(in_turn);
        }
        let turn = self.config.modulo;
        self.measured.call(self.feedback.position(), by, turn);
        let following = matches!(self.mover.motion(), Motion::Follow);
        if following {
            self.mover.stand_at(self.feedback.position());
        }
        self.end_routine();
        if self.config.scaling.is_some() {
            self.frame.shift_by(by);
        } else {
            // Out of operation the drive is at its actual position, to which it may have been pushed.
            self.frame.rename(self.setpoint().position);
        }
        self.watch_anew();
        self.tell_moved(by, scope);
        self.arm_anew(scope);
        // A paused move that still can't continue waits for its direction.
        let _waits = self.resume_at_rest(scope);
        Ok(())
    }

    /// Whether a 64-bit number distinguishes `position` (u) from the position one scan later at the velocity limit.
    /// At a larger value an axis could not move, and its slaves would lose its motion.
    pub(super) fn is_resolved(&self, position: f64) -> bool {
        position.abs() * f64::EPSILON <= self.config.limits.velocity * self.planner.cycle()
    }

    /// Moves the motion in progress to coordinates that are `by` (u) larger. An absolute move is planned anew to the
    /// same value; all others continue unchanged.
    fn move_motion(&mut self, by: f64, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let is_halted = self.owner.as_ref().is_some_and(|owner| owner.halted);
        if self.is_paused() || is_halted {
            self.shift_paused(by);
            return Ok(());
        }
        let Motion::Run { elapsed, scans, .. } = self.mover.motion() else {
            return Ok(());
        };
        let absolute = |owner: &Entry| matches!(owner.place(), Some(Place::At(_)));
        let Some(mut owner) = self.owner.filter(absolute).filter(|_| elapsed < scans) else {
            self.mover.shift_plan(by);
            if let Some(owner) = &mut self.owner {
                owner.end = owner.end.map(|end| end + by);
                owner.from += by;
                owner.run.end += by;
            }
            return Ok(());
        };
        let start = self.aim(&mut owner, self.mover.setpoint().position);
        self.look_through(&mut owner, start, 0);
        // A superimposed motion may leave no room now.
        let motion = self.plan_next(&mut owner)?.ok_or(ErrorId::InMotion)?;
        self.mover.take_over_from(self.limits_before(&owner.limits));
        self.adopt(owner, motion, scope);
        Ok(())
    }

    /// Notes and records that coordinates were shifted by `by` (u).
    pub(super) fn tell_moved(&mut self, by: f64, scope: &mut Scope<'_>) {
        self.frame.note_moved(scope.scan, by);
        self.record(Event::Shifted { by }, scope);
    }

    /// Sets the present position to `position` (u) (MC_Home).
    pub(super) fn call_set_position(&mut self, position: f64, scope: &mut Scope<'_>) {
        let by = position - self.mover.setpoint().position;
        if by != 0.0 {
            self.tell_moved(by, &mut self.owner_scope(scope));
        }
        self.frame.count_move(by);
        self.rename_places();
        self.rename_actual(self.mover.setpoint().position, position);
        self.end_routine();
        if self.config.scaling.is_some() {
            self.frame.shift_by(position - self.mover.setpoint().position);
        } else {
            self.frame.rename(position);
        }
        self.mover.stand_at(position);
    }
}
