//! The motion step: one set-point, then completion and hand-over.
//!
//! It follows all block calls of a scan, so its decisions show in the next scan (R70).

use super::commands::{Ending, Entry, Work};
use super::{Axis, Motion, Routine, power::Reaction};
use crate::{AxisEvent, AxisState, ErrorId, Fate, InstanceId, QUEUE_MAX, Scope};
use standstill_planner::{Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// Computes the set-point for the end of this scan, then decides completion and hand-over.
    ///
    /// Cost: one evaluation of the plan; at a hand-over at most one plan per waiting command; with software
    /// limits one ramp plan per scan of an endless motion or a stop.
    // See `follow_feedback`.
    #[inline(always)]
    pub(crate) fn advance(&mut self, scope: &mut Scope<'_>) {
        // Before its goal a plan needs only its next set-point. So does an endless motion for which no command waits.
        if self.routine == Routine::Alone && (self.mover.is_short_of_goal() || self.is_cruising()) {
            self.step_along_plan(scope);
            if !self.is_plain && self.is_far_round() {
                self.bring_back();
            }
        } else {
            self.advance_with_care(scope);
        }
    }

    /// As `advance`, when something is pending or superimposed, or the goal is near.
    #[inline(never)]
    fn advance_with_care(&mut self, scope: &mut Scope<'_>) {
        self.apply_power(scope);
        self.follow_torque_order();
        if self.mover.layer().is_none() && self.mover.is_short_of_goal() {
            self.step_along_plan(scope);
        } else {
            self.step_at_goal(scope);
        }
        self.finish_reset();
    }

    /// Whether an endless motion has reached its velocity, or reaches it now, and no command waits for that.
    #[inline]
    pub(super) fn is_cruising(&self) -> bool {
        let is_endless = self.owner.as_ref().is_some_and(Entry::is_endless);
        is_endless && self.queue.is_empty() && !self.is_held_up()
    }

    /// Advances the plan by a scan and publishes its set-point, if that may be published.
    // Inlined for the same reason as `Mover::publish`.
    #[inline(always)]
    fn step_along_plan(&mut self, scope: &mut Scope<'_>) {
        let Some(next) = self.mover.next() else { return };
        if let Some(error) = self.fault_of(next) {
            self.fail(error, scope);
        } else if self.mover.is_watched() && self.would_leave(next) {
            self.fail(ErrorId::SoftwareLimitReached, scope);
        } else {
            self.mover.publish(next);
        }
    }

    /// The step of an axis that is at its goal or reaches it in this step, is not in operation, or has something
    /// superimposed.
    #[inline(never)]
    fn step_at_goal(&mut self, scope: &mut Scope<'_>) {
        if self.owner.is_none() && self.goal_reached() {
            // A ramp without a command ended in the scan before. Power stayed on until then, so that the drive gets
            // the last set-point.
            self.mover.hold();
        }
        if self.mover.layer().is_some() {
            self.advance_both(scope);
            return;
        }
        match self.mover.motion() {
            Motion::Follow => {
                self.mover.publish(Setpoint::at_rest(self.feedback.position()));
                self.count_actual_turns();
            }
            // A slave has a step of its own. Without its master it holds its position.
            Motion::Hold | Motion::Geared | Motion::Closing { .. } => {
                self.mover
                    .publish(Setpoint::at_rest(self.mover.setpoint().position));
            }
            Motion::Run { .. } => self.step_along_plan(scope),
            Motion::Torque { .. } => self.step_torque(),
        }
        if self.modulo.is_some() {
            self.bring_back();
        }
        if self.goal_reached() {
            self.settle(scope);
        }
    }

    /// Enters ErrorStop and publishes the first set-point of the ramp, which starts at the last one published.
    #[cold]
    pub(super) fn fail(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        if self.state == AxisState::ErrorStop {
            // The ramp itself is wrong, so there is no plan left that could move the axis.
            self.mover.hold();
        }
        self.trip(error, 0, Reaction::Ramp, scope);
        let ramp = self.mover.begin_plan();
        let next = ramp.filter(|next| self.fault_of(*next).is_none());
        if next.is_none() && ramp.is_some() {
            self.mover.hold();
        }
        self.mover
            .publish(next.unwrap_or(Setpoint::at_rest(self.mover.setpoint().position)));
    }

    /// Completion and hand-over, at the goal.
    pub(super) fn settle(&mut self, scope: &mut Scope<'_>) {
        let Some(owner) = &self.owner else {
            if matches!(self.state, AxisState::Standstill | AxisState::DiscreteMotion)
                && !self.queue.is_empty()
            {
                // MC_Stop released the axis in this scan (note 6), or a command waits for a superimposed motion.
                self.hand_over(self.mover.setpoint().position, scope);
            }
            return;
        };
        if self.is_held_up() {
            return self.settle_paused(scope);
        }
        match owner.work.manner().ending {
            Ending::InPosition => self.complete_move(scope),
            Ending::AtRest => self.complete(scope),
            Ending::Names(position) => self.settle_homing(position, scope),
            Ending::Locks if owner.held => {
                self.mover.hold();
                self.stop_held = true;
            }
            Ending::Locks => {
                self.mover.hold();
                self.end_owner(Fate::Done);
                self.enter(AxisEvent::StopReleased);
                self.hand_over(self.mover.setpoint().position, scope);
            }
            // An endless motion hands over once it has reached its velocity.
            Ending::Holds => self.hand_over(self.passed_end(), scope),
            Ending::RunsOn => self.hand_over(self.mover.setpoint().position, scope),
            // This is decided together with its master.
            Ending::Follows | Ending::Due | Ending::Never => {}
        }
    }

    /// A move is done once the axis is in position. A move that passes its end or turns there does not wait for that.
    fn complete_move(&mut self, scope: &mut Scope<'_>) {
        if !self.mover.base().is_at_rest() || self.has_arrived() {
            self.complete(scope);
        }
    }

    /// The owner is done, at rest or when it passes its end and a blended command takes over.
    #[cold]
    pub(super) fn complete(&mut self, scope: &mut Scope<'_>) {
        if !self.mover.base().is_at_rest() {
            return self.pass_on(scope);
        }
        self.end_owner(Fate::Done);
        self.come_to_rest();
        self.hand_over(self.mover.setpoint().position, scope);
    }

    /// The owner has ended at rest. The motion is not over while something is superimposed (V14).
    pub(super) fn come_to_rest(&mut self) {
        self.mover.hold();
        if !self.is_superimposing() {
            self.enter(AxisEvent::MotionDone);
        }
    }

    /// The next waiting command that can be planned becomes the owner; commands that can't be planned fail (R79). An
    /// endless owner stays the owner if there is none. Distances count from `from` (B10).
    #[inline(never)]
    pub(super) fn hand_over(&mut self, from: f64, scope: &mut Scope<'_>) {
        if self.goes_on_along(from, scope) {
            return;
        }
        for _ in 0..QUEUE_MAX {
            let Some(mut next) = self.queue.first().copied() else {
                return;
            };
            if self.queue_waits_for_shift() {
                return;
            }
            if self.write_queued(scope) {
                continue;
            }
            if let Work::Profile { .. } = next.work {
                return self.begin_due(next);
            }
            self.aim_passing(&mut next, from);
            let before = self.limits_before(&next.limits);
            let asked = next.limits;
            let planned = self.plan_next(&mut next);
            if let Ok(None) = planned {
                return;
            }
            self.queue.pop();
            match planned {
                Ok(None) => {}
                Ok(Some(motion)) => {
                    let blended = self.passes_its_end(&next.limits);
                    let phasing = self.lend_phasing(&next);
                    self.end_owner(self.fate_at_hand_over());
                    self.keep_phasing(phasing);
                    let before = if blended { next.limits } else { before };
                    self.begin(next, motion, before, scope);
                    self.record_raised(&asked, &next.limits, &mut self.owner_scope(scope));
                    return;
                }
                Err(error) => {
                    let scope = &mut scope.with(next.instance);
                    self.refuse_plan(&next, error, scope);
                    self.decide(next.id, Fate::Failed(error));
                    self.lose_heir(next.id, scope);
                }
            }
        }
    }

    /// `scope` with the instance of the present motion; instance 0 if there is none.
    pub(super) fn owner_scope<'s>(&self, scope: &'s mut Scope<'_>) -> Scope<'s> {
        let owner = self.owner.as_ref();
        scope.with(owner.map_or(InstanceId::default(), |owner| owner.instance))
    }
}
