//! Plans the owner anew in motion: for new override factors, new values at its pins, or a blended successor.
//!
//! The motion continues from the last set-point, so the set-point has no step. If the state is outside the new
//! limits, the largest limits since the command began apply too until it is inside. The motion first gets inside. An
//! excess that no ramp can avoid is recorded. A superimposed motion continues if the sum stays inside the limits of
//! the axis. If not, the owner takes over the velocity of the sum, and the rest of the distance starts again when
//! there is room.
//!
//! Source: PLCopen Motion Control Part 1, sections on ContinuousUpdate and MC_SetOverride; R9, R12, B15 to B17.

use super::commands::{Ending, Entry, Place, ROUNDING, Work};
use super::mover::scans_to_goal;
use super::superimposed::Layer;
use super::supervision::Arrival;
use super::through::keeps_rates;
use super::{Axis, Motion};
use crate::{ErrorId, Event, Goal, Scope};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// Plans `owner`, the present owner with other values, from the present state. If a superimposed motion leaves no
    /// room now, it is tried again in every scan.
    ///
    /// Cost: at most two plans, four more if those exceed the limits of the axis, and two checks of a sum. On a
    /// modulo axis one more ramp. For each blended command that waits a ramp, at most a root of ramps.
    ///
    /// # Errors
    /// The refusal of the planner or of the software limits; nothing changes then.
    pub(super) fn replan(&mut self, mut owner: Entry, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        let here = self.mover.base();
        owner.turns = 0;
        self.look_through(&mut owner, here.position, 0);
        self.stay_in_direction(&mut owner, &here);
        self.replan_aimed(owner, scope)
    }

    /// The same for an owner whose end is known in the frame in which it will move.
    pub(super) fn replan_aimed(&mut self, mut owner: Entry, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        if owner.paused {
            // It continues with these values when it is permitted.
            self.own(owner);
            return Ok(());
        }
        match self.plan_anew(owner, scope) {
            Err(error @ (ErrorId::PositiveBarred | ErrorId::NegativeBarred)) => {
                // The motion in progress still is that of the unchanged owner. A halt comes to rest anywhere.
                if let Some(mut was) = self.owner {
                    self.note_passing(&mut was);
                    owner.passed |= was.passed;
                }
                self.own(owner);
                self.pause_noted(error, scope);
                Ok(())
            }
            planned => planned,
        }
    }

    /// The same for an owner that may be paused; it then continues with this plan.
    pub(super) fn plan_anew(&mut self, mut owner: Entry, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        if let Some(error) = self.barred_from_there_on(&owner) {
            return Err(error);
        }
        let here = self.mover.base();
        let start = self
            .in_frame_of(&owner, &here)
            .map_or(here.position, |framed| framed.position);
        self.look_through(&mut owner, start, 0);
        let run = owner.run;
        let before = self.limits_of_owner().unwrap_or(owner.limits);
        let motion = match self.mover.layer().copied() {
            None => {
                let motion = self.plan_from(&mut owner, &here, &before)?;
                let motion = self.kept_inside(&mut owner, motion, &here, &before)?;
                let goes_on = self.is_one_motion_as_planned(&run);
                if self.is_too_late(&owner, &motion, goes_on) {
                    if goes_on {
                        owner.run = run;
                    }
                    self.own(owner);
                    return Ok(());
                }
                Some(motion)
            }
            Some(layer) => self.plan_beside(layer, &mut owner, &before)?,
        };
        match motion {
            Some(motion) => {
                self.mover.take_over_from(before);
                self.adopt(owner, motion, scope);
            }
            None => {
                owner.paused = false;
                self.own(owner);
                self.replan_due = true;
            }
        }
        Ok(())
    }

    /// Plans `owner` under a superimposed motion, which continues if there is room for it; `None` if `owner` must
    /// wait. Its limits are raised if they can't keep the axis inside its own.
    #[inline(never)]
    fn plan_beside(
        &mut self,
        mut layer: Layer<P::Plan>,
        owner: &mut Entry,
        before: &Limits,
    ) -> Result<Option<Motion<P::Plan>>, ErrorId> {
        let asked = *owner;
        let motion = self.plan_from(owner, layer.base(), before)?;
        let mut motion = self.kept_inside(owner, motion, layer.base(), before)?;
        if let (Motion::Run { plan, .. }, false) = (&motion, owner.is_endless() || owner.halted) {
            self.allowed(layer.end_above(plan.end().position))?;
        }
        if !self.fits_under(&motion, &layer) {
            let sum = self.mover.setpoint().moved_to(layer.base().position);
            let both = self.limits_before(&owner.limits).or_larger(before);
            *owner = asked;
            motion = self.plan_from(owner, &sum, &both)?;
            motion = self.kept_inside(owner, motion, &sum, &both)?;
            if self.exceeds(&motion) {
                *owner = asked;
                return Ok(None);
            }
            layer.pass_velocity(sum);
        }
        layer.try_soon();
        self.end_routine();
        self.mover.lay(layer);
        Ok(Some(motion))
    }

    /// Tries a plan again that had to wait for a superimposed motion.
    #[cold]
    pub(super) fn replan_late(&mut self, scope: &mut Scope<'_>) {
        self.replan_due = false;
        let Some(owner) = self.owner else { return };
        if let Err(error) = self.replan(owner, scope) {
            self.refuse_plan(&owner, error, &mut self.owner_scope(scope));
        }
    }

    /// Notes that an endless owner has passed its position. A new plan of it continues from there.
    pub(super) fn note_passing(&self, owner: &mut Entry) {
        let through = matches!(owner.work, Work::Through { .. });
        owner.passed |= through && !owner.halted && !owner.paused && !self.replan_due && self.goal_reached();
    }

    /// For an owner that must not turn back: if it can't stop before its target, or slow down to the velocity at its
    /// target, it adds turns (B8).
    pub(super) fn stay_in_direction(&self, owner: &mut Entry, here: &Setpoint) {
        let (Some(modulo), Some(Place::At(_)), Some(end), Some(_)) =
            (&self.modulo, owner.place(), owner.end, owner.direction)
        else {
            return;
        };
        // If it is too late for another plan, it continues as planned.
        if !owner.halted && !owner.passed && !owner.is_behind && !self.passes_as_planned(owner) {
            owner.turns = self.never_back(owner, here, end, 0, modulo.length);
        }
    }

    /// The limits that apply to the owner's motion in its present state: its own, and also those of the motion it
    /// took over from until it is inside its own. None if it has no motion. Cost: at most one ramp.
    pub(super) fn limits_of_owner(&self) -> Option<Limits> {
        if !matches!(
            self.mover.motion(),
            Motion::Run { .. } | Motion::Geared | Motion::Closing { .. }
        ) {
            return None;
        }
        Some(self.limits_in_state(&self.mover.base(), self.mover.in_force(), self.mover.before()))
    }

    /// `own` limits of a motion in `state`, and also those `before` until it is inside its own. If that is enough,
    /// only the part of them that slaves leave, or only the part of their rates. Cost: at most one ramp, with slaves
    /// three.
    pub(super) fn limits_in_state(&self, state: &Setpoint, own: &Limits, before: &Limits) -> Limits {
        let wider = own.or_larger(before);
        let held = if wider == *own || self.is_inside(state, own) {
            *own
        } else {
            wider
        };
        let slowed = self.slowed(&held);
        if slowed == held {
            return held;
        }
        let at_speed = slowed.with_velocity(held.velocity);
        let fits = |limits: &Limits| self.stops_within(state, limits);
        [slowed, at_speed].into_iter().find(fits).unwrap_or(held)
    }

    /// Whether a motion can continue from `state` without exceeding `limits`.
    #[inline(never)]
    fn is_inside(&self, state: &Setpoint, limits: &Limits) -> bool {
        self.planner
            .ramp_to(state, 0.0, limits, limits)
            .is_ok_and(|ramp| ramp.excess().is_none())
    }

    /// Whether an axis in this state can come to rest within `limits`, even if it has to turn back. It can then make
    /// any motion within them. Cost: one ramp.
    pub(super) fn stops_within(&self, state: &Setpoint, limits: &Limits) -> bool {
        let Ok(stop) = self.planner.ramp_to(state, 0.0, limits, limits) else {
            return false;
        };
        let most = self.planner.peaks((&stop, 0)).map(|most| most.velocity);
        keeps_rates(&stop) && most.is_some_and(|most| most <= limits.velocity * (1.0 + ROUNDING))
    }

    /// Starts `motion` for `entry`, which is or becomes the owner.
    pub(super) fn adopt(&mut self, entry: Entry, motion: Motion<P::Plan>, scope: &mut Scope<'_>) {
        match &motion {
            Motion::Run { plan, scans, .. } if entry.run.count == 0 => {
                self.record_plan(&entry, plan, *scans, scope);
            }
            Motion::Run { plan, .. } | Motion::Torque { plan, .. } => {
                self.record_plan(&entry, plan, scans_to_goal(plan), scope);
            }
            _ => {}
        }
        if matches!(motion, Motion::Torque { .. }) {
            // A torque that may continue, or has new values, must be checked in every scan.
            self.end_routine();
        }
        let searches = matches!(motion, Motion::Geared);
        self.mover
            .start_anew(motion, Self::limits_of(&entry.limits, &motion));
        self.arrival = Arrival::default();
        if self.modulo.is_some() {
            self.start_of_plan();
        }
        let entry = Entry {
            paused: false,
            paused_by: entry.paused_by.filter(|_| searches),
            ..entry
        };
        self.mover.watch(self.needs_watching(&entry));
        self.own(entry);
        self.replan_due = false;
        if searches {
            self.await_master(&entry, scope);
        }
    }

    /// Records `plan`, which reaches its goal in the scan `scans`.
    fn record_plan(&self, entry: &Entry, plan: &P::Plan, scans: u64, scope: &mut Scope<'_>) {
        let scope = &mut scope.with(entry.instance);
        let positioning = entry.work.manner().ending == Ending::InPosition;
        let end = plan.at(scans);
        let goal = match entry.goal() {
            _ if entry.halted || entry.passed => Goal::Velocity(end.velocity),
            Some(position) if end.velocity != 0.0 || !positioning => Goal::Passing {
                position,
                velocity: end.velocity,
            },
            Some(_) => Goal::Position(end.position),
            None => Goal::Velocity(end.velocity),
        };
        let planned = Event::Planned {
            goal,
            // A plan has at most 2^31 - 1.
            scans: u32::try_from(scans).unwrap_or(u32::MAX),
        };
        self.record(planned, scope);
        if let Some(excess) = self.beyond_axis(plan) {
            self.record(Event::Unavoidable(excess), scope);
        }
    }
}
