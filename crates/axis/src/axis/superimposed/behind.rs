//! A superimposed motion on a slave.
//!
//! In gear the set-point is the law, with the place of the slave moved by the added distance. Once the
//! distance is added it stays in the law, to the bit. Room is checked in the motion step, after the
//! master has moved and when its plan is known. When the slave loses its law, the added motion passes its
//! velocity to the slave, and the rest of the distance waits.
//!
//! Source: PLCopen Motion Control Part 1, MC_MoveSuperimposed, MC_HaltSuperimposed. docs/coupling.md states what the
//! standard leaves open.

use super::plan::{Proposal, Room};
use super::{Added, Adds, Layer, Progress};
use crate::axis::coupling::{Kind, View, way_to_rest};
use crate::axis::{Axis, Motion};
use crate::{Cams, ErrorId, Event, Fate, Scope};
use standstill_planner::{CamBounds, Lead, Limits, Plan, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// `command` waits on `layer` for the next motion step.
    pub(super) fn await_room(&mut self, mut layer: Layer<P::Plan>, command: Added) {
        layer.command = Some(command);
        layer.try_soon();
        self.mover.lay(layer);
        self.end_routine();
    }

    /// Refuses a command that could not be added even if the master is at rest.
    ///
    /// # Errors
    /// The planner refuses the original command, or MC_Power bars its direction.
    pub(super) fn propose_alone(&self, layer: &Layer<P::Plan>, command: &Added) -> Result<(), ErrorId> {
        let room = || Room {
            limits: self.slowed(&self.config.limits),
            endless: false,
        };
        self.propose_within(layer, command, room, |_| true).map(|_| ())
    }

    /// Whether there is a superimposed motion that moves.
    pub(in crate::axis) fn adds_motion(&self) -> bool {
        self.mover.layer().is_some_and(Layer::moves)
    }

    /// A halt of a superimposed motion that finds no motion is done.
    pub(in crate::axis) fn end_idle_halt(&mut self) {
        let idle = |layer: &Layer<P::Plan>| {
            !layer.moves() && layer.command.is_none_or(|command| command.adds == Adds::Halt)
        };
        if self.mover.layer().is_some_and(idle) {
            self.end_superimposed(Fate::Done);
        }
    }

    /// The slave is not on its law: it takes the velocity of the added motion, and the rest of the
    /// distance waits.
    pub(in crate::axis) fn rest_superimposed(&mut self) {
        let setpoint = *self.mover.setpoint();
        if let Some(layer) = self.mover.layer_mut().filter(|layer| layer.moves()) {
            layer.pass_velocity(setpoint);
            layer.taken = layer.added.position;
            layer.try_soon();
        }
    }

    /// Before the step of a slave: slows down a motion without room beside the law, and starts a command that waits
    /// for room. `is_new` says that the master's motion differs from the known one, or that a limit has changed. The
    /// slave loses its gear for lack of room only if it `may_lose` it.
    ///
    /// Cost: at most nine plans, each laid over the master's.
    pub(in crate::axis) fn superimpose_behind(
        &mut self,
        view: &View<'_, P::Plan>,
        is_new: bool,
        may_lose: bool,
        scope: &mut Scope<'_>,
    ) {
        if self.mover.layer().is_none() {
            return;
        }
        if !self.is_on_law() {
            self.rest_superimposed();
            return self.tell_waiting(scope);
        }
        if is_new {
            self.give_way(view, may_lose, scope);
        }
        if !self.is_on_law() || view.future.is_late() || !self.sees_law(view) {
            return self.tell_waiting(scope);
        }
        self.begin_behind(view, scope);
    }

    /// Records once that a command waits.
    fn tell_waiting(&mut self, scope: &mut Scope<'_>) {
        let Some(layer) = self.mover.layer_mut().filter(|layer| layer.retry == 0) else {
            return;
        };
        layer.retry = 1;
        if let Some(command) = layer.command.filter(|command| !command.runs()) {
            self.record_as(&command, Event::RoomAwaited, scope);
        }
    }

    /// Whether the law is known from the end of the last scan on.
    fn sees_law(&self, view: &View<'_, P::Plan>) -> bool {
        match view.future.kind() {
            _ if self.holds_end_of_cam() => true,
            // With measured values each step is checked, but not on a cam.
            Kind::Measured => !self.is_on_cam(),
            Kind::Plan => true,
            // It may have come to rest in this scan.
            Kind::Still => self.law_stands(view),
            Kind::Unknown | Kind::NotSeen => false,
        }
    }

    /// Adapts the motion beside the law to the master's new motion: it becomes slower, or comes to rest. If there is
    /// no room for that either, the gear is lost.
    fn give_way(&mut self, view: &View<'_, P::Plan>, may_lose: bool, scope: &mut Scope<'_>) {
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        layer.retry = layer.retry.min(1);
        let motion = layer.motion;
        let Motion::Run { plan, elapsed, .. } = &motion else {
            return;
        };
        // If the master's future motion is not known, each step is checked.
        if !self.sees_law(view)
            || view.future.kind() == Kind::Measured
            || self.fits_law(view, (plan, *elapsed), &scope.cams)
        {
            return;
        }
        if let Some(command) = self.mover.layer_mut().and_then(|layer| layer.command.as_mut()) {
            command.progress = Progress::Waits;
        }
        if self.take_proposal(view, scope) || self.brake_behind(view, scope) || !may_lose {
            return;
        }
        let beside = self.planner.peaks((plan, *elapsed)).unwrap_or_default();
        let reason = if self.is_on_cam() {
            self.beyond_beside_cam(view, &beside, &scope.cams)
        } else {
            self.reason_beside(view, &beside)
        };
        let limit = self.parameters.limits.velocity;
        self.lose_gear(reason.unwrap_or(("velocity", f64::NAN, limit)), scope);
    }

    /// Starts a command that waits, or speeds up one that was lowered, if there is room beside the law now.
    fn begin_behind(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(layer) = self.mover.layer() else { return };
        let Some(command) = layer.command else { return };
        let is_due = match self.first_lead(view) {
            Some(lead) => lead.elapsed.saturating_add(1) >= layer.retry,
            None => layer.retry != u64::MAX,
        };
        if !command.lacks_room() || !is_due {
            return;
        }
        let ends_outside = self
            .end_behind(view, layer)
            .is_some_and(|end| self.allowed(end).is_err());
        if ends_outside && !layer.moves() && matches!(command.adds, Adds::Distance { .. }) {
            return self.refuse_end(view, &command, scope);
        }
        self.take_proposal(view, scope);
    }

    /// Starts a motion that fits beside the law from now on. Returns whether there is one.
    fn take_proposal(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) -> bool {
        let Some(layer) = self.mover.layer() else {
            return false;
        };
        let Some(command) = &layer.command else {
            return false;
        };
        let room = || self.room_of_law(view, &scope.cams);
        let fits = |plan: &P::Plan| self.fits_law(view, (plan, 0), &scope.cams);
        // The planner accepts again what it accepted before. While the direction is barred nothing
        // changes.
        let Ok(proposed) = self.propose_within(layer, command, room, fits) else {
            return false;
        };
        let is_found = proposed.is_some();
        let (place, moves) = (layer.added.position, layer.moves());
        if !moves {
            self.lay_layer_on_law(place);
        }
        self.add(proposed, scope);
        self.end_routine();
        let next = self.next_switch_of_law(view);
        if let Some(layer) = self.mover.layer_mut() {
            layer.retry = match next {
                Some((switch, now)) if switch > now => switch,
                // Nothing changes until the master's motion changes.
                _ => u64::MAX,
            };
        }
        is_found
    }

    /// The superimposed motion comes to rest with the stop dynamics, or more slowly, if there is room for
    /// that.
    fn brake_behind(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) -> bool {
        let Some(layer) = self.mover.layer() else {
            return false;
        };
        let Some(command) = layer.command else {
            return false;
        };
        let stop = Added {
            limits: self.slowed(&self.stop_limits()),
            halting: true,
            ..command
        };
        let room = || self.room_of_law(view, &scope.cams);
        let fits = |plan: &P::Plan| self.fits_law(view, (plan, 0), &scope.cams);
        let proposed = self.propose_within(layer, &stop, room, fits);
        let (Ok(Some(Proposal { plan, limits, .. })), Some(layer)) = (proposed, self.mover.layer_mut())
        else {
            return false;
        };
        layer.before = layer.in_force;
        layer.in_force = limits;
        layer.motion = Motion::along(plan);
        if let Some(command) = &mut layer.command {
            command.wait();
        }
        let (distance, scans) = (None, plan.scans());
        self.record_as(&command, Event::Superimposed { distance, scans }, scope);
        true
    }

    fn first_lead<'a>(&self, view: &View<'a, P::Plan>) -> Option<Lead<'a, P::Plan>> {
        self.leads_of_law(view)?.into_iter().flatten().next()
    }

    /// The scan at which a master's plan next changes its highest derivative, and the present scan, both
    /// counted from the start of the first plan.
    fn next_switch_of_law(&self, view: &View<'_, P::Plan>) -> Option<(u64, u64)> {
        let now = self.first_lead(view)?.elapsed;
        let next = self.scans_to_switch(&self.leads_of_law(view)?);
        Some((now.saturating_add(next.unwrap_or(0)), now))
    }

    /// The part of the slave's limits that the law always leaves.
    fn room_of_law(&self, view: &View<'_, P::Plan>, cams: &Cams<'_>) -> Room {
        let limits = &self.slowed(&self.parameters.limits);
        let none = Limits {
            velocity: 0.0,
            acceleration: 0.0,
            deceleration: 0.0,
            jerk: 0.0,
            snap: 0.0,
        };
        if self.is_on_cam() {
            let (limits, endless) = self.room_on_cam(view, cams).unwrap_or((none, true));
            return Room { limits, endless };
        }
        match self.leads_of_law(view) {
            Some(leads) => Room {
                limits: self.room_beside(&leads, limits).unwrap_or(none),
                endless: leads.iter().flatten().any(|lead| lead.plan.end().velocity != 0.0),
            },
            None if view.future.kind() == Kind::Measured => Room {
                limits: self.room_now(view, limits).unwrap_or(none),
                endless: true,
            },
            None => Room {
                limits: *limits,
                endless: false,
            },
        }
    }

    /// Whether the superimposed motion keeps the limits together with the law, as far as the law is
    /// known. `elapsed` counts the scans from its start to the end of the last scan.
    fn fits_law(&self, view: &View<'_, P::Plan>, (plan, elapsed): (&P::Plan, u64), cams: &Cams<'_>) -> bool {
        if self.is_on_cam() {
            let room = self.room_on_cam(view, cams);
            let peaks = self.planner.peaks((plan, elapsed));
            let both = room.zip(peaks);
            return both.is_some_and(|((room, _), peaks)| CamBounds::beyond(&peaks, &room).is_none());
        }
        let Some((before, after)) = self.law_before_and_now(view) else {
            return false;
        };
        let limits = &self.slowed(&self.parameters.limits);
        let Some(layer) = self.mover.layer() else {
            return true;
        };
        match self.leads_of_law(view) {
            Some(leads) => {
                let late = u64::from(view.future.is_late());
                let elapsed = elapsed.saturating_add(late);
                let now = if late > 0 {
                    after.plus(&plan.at(elapsed))
                } else {
                    before.plus(&layer.added)
                };
                let beside = Some((plan, elapsed));
                self.planner.fits_behind(&leads, &now, beside, limits)
            }
            None => {
                let limits = if view.future.kind() == Kind::Measured {
                    self.room_now(view, limits)
                } else {
                    Some(*limits)
                };
                limits.is_some_and(|limits| {
                    self.planner
                        .fits_behind(&[None; 2], &layer.added, Some((plan, elapsed)), &limits)
                })
            }
        }
    }

    /// The rest position of the slave once everything is added (u). `None` if its master is not known to come to
    /// rest.
    fn end_behind(&self, view: &View<'_, P::Plan>, layer: &Layer<P::Plan>) -> Option<f64> {
        if self.is_on_cam() {
            // The end of a cam's motion is not checked.
            let stands = self.law_stands(view);
            return stands.then(|| self.mover.setpoint().position + layer.left());
        }
        let leads = self.leads_of_law(view);
        let way = leads.map_or(Some(0.0), |leads| way_to_rest(&leads, 0))?;
        Some(self.mover.setpoint().position + way + layer.left())
    }

    /// Refuses a distance with which the slave would come to rest outside its software limits.
    #[cold]
    fn refuse_end(&mut self, view: &View<'_, P::Plan>, command: &Added, scope: &mut Scope<'_>) {
        let Adds::Distance { distance, .. } = command.adds else {
            return;
        };
        let end = self.mover.layer().and_then(|layer| self.end_behind(view, layer));
        let limit = end.map_or(f64::NAN, |end| self.broken_software_limit(end));
        let error = ErrorId::TargetOutsideSoftwareLimits;
        self.refuse(
            "Distance",
            distance,
            limit,
            error,
            &mut scope.with(command.instance),
        );
        self.end_superimposed(Fate::Failed(error));
    }

    /// The set-point of the superimposed motion for the end of this scan, if it moves.
    pub(in crate::axis) fn next_added(&mut self) -> Option<Setpoint> {
        match &mut self.mover.layer_mut()?.motion {
            Motion::Run { plan, elapsed, .. } => Some(plan.next(elapsed.saturating_add(1))),
            _ => None,
        }
    }

    /// Notes that `added` was published on top of the law.
    pub(in crate::axis) fn note_added(&mut self, added: Setpoint) {
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        layer.added = added;
        let Motion::Run { elapsed, scans, .. } = &mut layer.motion else {
            return;
        };
        *elapsed = elapsed.saturating_add(1);
        if *elapsed < *scans {
            return;
        }
        layer.added = Setpoint::at_rest(added.position);
        layer.motion = Motion::Hold;
        // It is at rest now, so more may fit from here.
        layer.try_soon();
        let is_done = |command: &Added| !command.halting && (command.runs() || command.adds == Adds::Halt);
        if layer.command.as_ref().is_none_or(is_done) {
            self.end_superimposed(Fate::Done);
        }
    }

    /// After the step of a slave: notes the slave's own part of the set-point, without the added motion.
    pub(in crate::axis) fn note_own_part(&mut self) {
        let all = *self.mover.setpoint();
        let Some(layer) = self.mover.layer_mut() else {
            return;
        };
        let added = &layer.added;
        layer.taken = added.position;
        layer.base = Setpoint {
            position: all.position,
            velocity: all.velocity - added.velocity,
            acceleration: all.acceleration - added.acceleration,
            jerk: all.jerk - added.jerk,
            snap: all.snap - added.snap,
        };
    }
}
