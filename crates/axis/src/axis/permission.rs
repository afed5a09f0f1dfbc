//! Directions that MC_Power bars. A new motion in a barred direction is refused; a running motion in one is paused.
//!
//! A motion is barred if it travels further in a barred direction than an immediate stop within its limits; from
//! rest, if it travels there at all. A command that is barred when it becomes active is an error. A motion that is
//! barred while it runs brakes with the stop dynamics. Its command stays the owner, and continues to its end or
//! velocity once the direction it then needs is permitted. A motion that brings the axis to rest is never barred, so
//! it is never paused either.
//!
//! A superimposed motion has a direction of its own. If either motion is barred the sum brakes. The rest of the
//! superimposed distance waits, as it waits for room.
//!
//! Source: PLCopen Motion Control Part 1, MC_Power; V9.

use super::commands::{Entry, Place, ROUNDING};
use super::run::RESOLUTION;
use super::{Axis, Motion};
use crate::{AxisEvent, AxisState, ErrorId, Event, Fate, Scope};
use standstill_planner::{Limits, Plan, Planner};

/// The directions in which an axis may move: EnablePositive and EnableNegative of MC_Power.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct Permission {
    /// Towards larger positions.
    pub positive: bool,
    /// Towards smaller positions.
    pub negative: bool,
}

impl Permission {
    /// Both directions: the initial value.
    pub const BOTH: Self = Self {
        positive: true,
        negative: true,
    };

    /// The reason why a motion in these directions is barred, if it is.
    pub(super) fn bars(self, up: bool, down: bool) -> Option<ErrorId> {
        if up && !self.positive {
            Some(ErrorId::PositiveBarred)
        } else if down && !self.negative {
            Some(ErrorId::NegativeBarred)
        } else {
            None
        }
    }
}

impl<P: Planner> Axis<P> {
    /// MC_Power changes the permitted directions.
    #[cold]
    #[inline(never)]
    pub(super) fn permit(&mut self, permitted: Permission, scope: &mut Scope<'_>) {
        self.power.permit(permitted);
        self.unsettle();
        if let Some(error) = self.barred_now() {
            self.pause(error, scope);
        }
        if let Some(layer) = self.mover.layer_mut() {
            layer.try_soon();
        }
        // A slave that still moves in the barred direction would be stopped again.
        if !self.follows() || self.way_barred(self.mover.setpoint().velocity).is_none() {
            self.resume(scope);
        }
    }

    /// Whether MC_Power has stopped the owner, which waits to continue.
    #[inline]
    pub(super) fn is_paused(&self) -> bool {
        self.owner.as_ref().is_some_and(|owner| owner.paused)
    }

    /// Refuses `plan` of `entry`, after a motion within `before`, if it needs a barred direction. A
    /// paused command may go no further than its stop.
    #[inline]
    pub(super) fn permitted(&self, entry: &Entry, plan: &P::Plan, before: &Limits) -> Result<(), ErrorId> {
        let brakes = entry.halted && !entry.paused;
        if !self.bars_any() || brakes || !entry.work.manner().barred {
            return Ok(());
        }
        let limits = if entry.paused {
            self.slowed(&self.stop_limits())
        } else {
            entry.limits
        };
        self.barred((plan, 0), &limits, before).map_or(Ok(()), Err)
    }

    /// The reason why the rest of a plan is barred. Cost: one ramp.
    #[inline(never)]
    pub(super) fn barred(&self, rest: (&P::Plan, u64), limits: &Limits, before: &Limits) -> Option<ErrorId> {
        if !self.bars_any() {
            return None;
        }
        let (plan, elapsed) = rest;
        let (start, goal) = (plan.at(elapsed), plan.end().velocity);
        let (up, down) = self.planner.ways(rest);
        // A stop is never barred, in any direction.
        let axis = &self.slowed(&self.hardest_limits());
        let (braking_up, braking_down) = match self.stopped_inside(&start, &mut { *limits }, before, axis) {
            Ok(ramp) if !start.is_at_rest() => self.planner.ways((&ramp, 0)),
            _ => (0.0, 0.0),
        };
        let small = ROUNDING * (up + down) + RESOLUTION * start.position.abs();
        self.bars(
            goal > 0.0 || up > braking_up + small,
            goal < 0.0 || down > braking_down + small,
        )
    }

    /// The reason why a motion in progress is barred.
    fn barred_now(&self) -> Option<ErrorId> {
        let limits = self.slowed(&self.stop_limits());
        let owner = match (self.mover.motion(), &self.owner) {
            (Motion::Run { plan, elapsed, .. } | Motion::Torque { plan, elapsed, .. }, Some(owner))
                if owner.work.manner().barred && !owner.paused =>
            {
                self.barred((plan, *elapsed), &limits, self.mover.in_force())
            }
            (Motion::Geared | Motion::Closing { .. }, Some(owner)) if !owner.paused => {
                self.way_barred(self.mover.setpoint().velocity)
            }
            _ => None,
        };
        owner.or_else(|| self.barred_behind_the_end()).or_else(|| {
            let (rest, in_force) = self.mover.layer()?.distance_in_progress()?;
            self.barred(rest, &limits, in_force)
        })
    }

    /// The reason why the next command is barred, if the owner is about to pass its end for it.
    fn barred_behind_the_end(&self) -> Option<ErrorId> {
        let owner = self
            .owner
            .as_ref()
            .filter(|owner| !owner.paused && !owner.passage.rests())?;
        let passage = self.passage(owner, self.mover.setpoint().position, 0);
        self.bars(true, true).filter(|_| passage.rests())
    }

    /// Everything brakes: from now on there is one motion, with the velocity of the sum. A superimposed motion on an
    /// axis at rest brakes by itself, so that its travel counts.
    pub(super) fn pause(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        if !matches!(self.mover.motion(), Motion::Hold | Motion::Follow)
            && let Some(mut owner) = self.owner
        {
            self.note_passing(&mut owner);
            self.own(owner);
            self.note_end_of_profile();
        }
        self.pause_noted(error, scope);
    }

    /// The same, after it was noted whether the owner has passed its position.
    pub(super) fn pause_noted(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        let scope = &mut self.owner_scope(scope);
        let goes_on = |owner: &Entry| !owner.paused && owner.paused_by == Some(error);
        if !self.owner.as_ref().is_some_and(goes_on) {
            self.record(Event::Paused { error }, scope);
        }
        if matches!(self.mover.motion(), Motion::Hold | Motion::Follow) {
            return self.brake_superimposed();
        }
        if let Some(mut owner) = self.owner.filter(|owner| owner.work.manner().barred) {
            owner.paused = true;
            owner.paused_by = Some(error);
            owner.turns = 0;
            self.own(owner);
        }
        self.replan_due = false;
        self.leave_law();
        self.mover.keep(self.limits_before(self.mover.in_force()));
        let setpoint = *self.mover.setpoint();
        if let Some(layer) = self.mover.layer_mut() {
            layer.pass_velocity(setpoint.moved_to(layer.base().position));
        }
        let (start, mut limits) = (self.mover.base(), self.slowed(&self.stop_limits()));
        let axis = &self.slowed(&self.hardest_limits());
        let motion = match self.stopped_inside(&start, &mut limits, self.mover.in_force(), axis) {
            Ok(plan) if !start.is_at_rest() => {
                if let Some(excess) = self.beyond_axis(&plan) {
                    self.record(Event::Unavoidable(excess), scope);
                }
                Motion::along(self.onto_limit(plan))
            }
            _ => Motion::Hold,
        };
        self.mover.start(motion, limits);
        self.end_orphan();
        self.watch_anew();
    }

    /// A slave has searched its way. If it is not paused again, the pause is over.
    pub(super) fn end_pause(&mut self) {
        if let Some(owner) = self.owner.as_mut().filter(|owner| !owner.paused) {
            owner.paused_by = None;
        }
    }

    /// The owner continues from its present state, if all directions it needs are permitted. If it no longer can, it
    /// fails at rest.
    #[inline(never)]
    pub(super) fn resume(&mut self, scope: &mut Scope<'_>) {
        let Some(owner) = self.owner.filter(|owner| owner.paused) else {
            return;
        };
        match self.continue_paused(owner, scope) {
            Ok(()) | Err(ErrorId::PositiveBarred | ErrorId::NegativeBarred) => {}
            Err(error) if self.mover.setpoint().is_at_rest() && !self.is_superimposing() => {
                if !self.profile_is_over() {
                    self.refuse_plan(&owner, error, &mut self.owner_scope(scope));
                }
                self.end_owner(Fate::Failed(error));
                self.mover.hold();
                // ContinuousMotion has a transition to Standstill only through a halt.
                let is_endless = self.state == AxisState::ContinuousMotion;
                if !is_endless {
                    self.enter(AxisEvent::MotionDone);
                }
                self.hand_over(self.mover.setpoint().position, scope);
                if self.owner.is_none() && is_endless {
                    self.halt_after(&owner, scope);
                }
            }
            // It continues to brake, and is checked again at rest.
            Err(_) => {}
        }
    }

    /// The paused owner has other values, or its end has moved: at rest it continues if the direction it needs now is
    /// permitted. While it brakes, that is checked when it comes to rest.
    ///
    /// # Errors
    /// The reason why it can't continue; it stays paused.
    #[cold]
    pub(super) fn resume_at_rest(&mut self, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let brakes = matches!(self.mover.motion(), Motion::Run { .. });
        let waits = |owner: &Entry| owner.paused && !owner.halted && !brakes;
        let Some(owner) = self.owner.filter(waits) else {
            return Ok(());
        };
        match self.continue_paused(owner, scope) {
            Err(ErrorId::PositiveBarred | ErrorId::NegativeBarred) => Ok(()),
            planned => planned,
        }
    }

    /// Plans the paused `owner` from its present state, or hands over to the next command.
    fn continue_paused(&mut self, mut owner: Entry, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        if self.has_lost_master() {
            return Ok(());
        }
        owner.is_behind |= self.is_past_its_end(&owner);
        if owner.is_behind {
            let on_its_way = Entry {
                paused: false,
                ..owner
            };
            if self.leaves_to_next(on_its_way, scope) {
                return Ok(());
            }
        }
        if owner.turns == 0 {
            self.look_through(&mut owner, self.mover.base().position, 0);
            self.stay_in_direction(&mut owner, &self.mover.base());
        }
        self.plan_anew(owner, scope)
    }

    /// The paused owner is at rest. The direction it needs now may be permitted, because the stop may
    /// have passed its end.
    #[cold]
    pub(super) fn settle_paused(&mut self, scope: &mut Scope<'_>) {
        if self.is_paused() && matches!(self.mover.motion(), Motion::Run { .. }) {
            self.mover.hold();
            self.resume(scope);
        }
    }

    /// The coordinates were shifted by `by` (u) under a paused or halted owner: an absolute end keeps its value.
    #[cold]
    pub(super) fn shift_paused(&mut self, by: f64) {
        self.mover.shift_plan(by);
        let Some(mut owner) = self.owner else { return };
        if matches!(owner.place(), Some(Place::At(_))) {
            self.aim(&mut owner, self.mover.setpoint().position);
        } else {
            owner.end = owner.end.map(|end| end + by);
            owner.from += by;
        }
        self.own(owner);
    }

    /// Whether a direction is barred.
    pub(super) fn bars_any(&self) -> bool {
        self.permission() != Permission::BOTH
    }

    /// The error if a layer at rest may not be moved in this direction.
    pub(super) fn way_barred(&self, way: f64) -> Option<ErrorId> {
        self.bars(way > 0.0, way < 0.0)
    }
}
