//! The motion step of a slave on a cam, after that of its master.

use super::super::super::commands::ROUNDING;
use super::super::super::power::Reaction;
use super::super::super::{Axis, Motion};
use super::super::FURTHEST;
use super::super::follow::{Beyond, leaves_room, meet, off};
use super::super::view::{Kind, View};
use super::{Curve, OnCam, Rung, Shadow};
use crate::{ErrorId, Event, OnLimit, Scope};
use standstill_planner::{CamAt, Lead, Limits, Place, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// [`Axis::advance`] for an axis on a cam, which can see its master.
    ///
    /// Cost in sync: one evaluation of the cam, and one ramp while the master's motion ahead is not known or there
    /// are software limits. If the master got another plan: a check along it ([`Axis::beyond_on_cam`]) and at most 50
    /// plans. On a long way behind a master with turns: one plan every few turns.
    #[inline(never)]
    pub(crate) fn advance_on_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if !self.still_follows(view, scope) {
            return;
        }
        let shifts = self.is_phasing();
        let view = &self.shifted_view(view, scope);
        self.rebase_cam(view, scope.scan);
        let is_new = self.look_ahead_on_cam(view);
        if self.stays_paused(is_new, scope) {
            return self.measure_on_cam(view, scope);
        }
        // A slave that must not lag stays in sync until it can't.
        let is_locked = self.is_locked_on_cam();
        let stays = self.config.following.on_limit == OnLimit::Error;
        self.superimpose_behind(view, is_new, !stays, scope);
        let is_locked = is_locked && self.is_locked_on_cam();
        let stays = is_locked && (stays || self.adds_motion());
        if (is_new && !stays) || self.cam_rung() == Some(Rung::Due) {
            self.decide_on_cam(view, true, scope);
            self.end_pause();
            self.tell_outside(view, scope);
            // The last step of a shift is a special one.
            if !shifts {
                self.note_source();
            }
        } else {
            self.go_on_from_near(view, scope);
        }
        if is_new && self.slows_master() {
            self.bound_master_on_cam(&scope.cams);
        }
        let shadow = self.on_cam().and_then(|on_cam| on_cam.shadow);
        if self.is_on_cam() {
            self.step_on_cam(view, scope);
        }
        self.note_own_part();
        self.measure_on_cam(view, scope);
        self.end_of_cam(shadow, view, scope);
        self.finish_reset();
        self.note_whether_law_stands(view);
        self.note_steady();
    }

    pub(in crate::axis::coupling) fn is_locked_on_cam(&self) -> bool {
        self.on_cam().is_some_and(|on_cam| on_cam.rung.is_locked())
    }

    pub(super) fn cam_rung(&self) -> Option<Rung> {
        self.on_cam().map(|on_cam| on_cam.rung)
    }

    /// Coordinates of master or slave were shifted: the cam is shifted with them, and nothing else changes.
    fn rebase_cam(&mut self, view: &View<'_, P::Plan>, scan: u64) {
        let moves = self.frame.moves();
        let own = self.coordinates_moved(scan);
        let Some(on_cam) = &mut self.follower.on_cam else {
            return;
        };
        // A shift of coordinates within the motion step was not seen before it.
        let late = view.now.moved - on_cam.was.moved;
        on_cam.was.place.position += late;
        on_cam.was.at.position += late;
        let slave_moved = on_cam.moves != moves;
        on_cam.moves = moves;
        let (by, own) = (view.now.moved, if slave_moved { own } else { 0.0 });
        if by == 0.0 && own == 0.0 {
            return;
        }
        let is_held = by.abs() <= FURTHEST && own.abs() <= FURTHEST;
        if !is_held && on_cam.rung != Rung::Lost {
            // At numbers of this size the place of the cam is lost in rounding: it is fixed again.
            on_cam.was.place = view.now.place;
            on_cam.was.at.position = view.now.at.position;
            *on_cam = OnCam {
                was: on_cam.was,
                known: on_cam.known,
                ..OnCam::new(on_cam.camming, on_cam.limits, moves)
            };
            return;
        }
        if let Some(shadow) = &mut on_cam.shadow {
            shadow.place.position += by;
        }
        if let Some(anchor) = &mut on_cam.anchor {
            anchor.master.position += by;
            anchor.slave.position += own;
        }
        on_cam.at.place.position += own;
        match &mut on_cam.rung {
            Rung::BesideLine { start, .. } | Rung::Corner { start } => start.position += by,
            Rung::Moving { to: Some(to), .. } => to.position += by,
            Rung::Due
            | Rung::Locked
            | Rung::BesideMaster
            | Rung::BesideMeasured { .. }
            | Rung::Moving { to: None, .. }
            | Rung::Waiting
            | Rung::Lost => {}
        }
        if let Rung::Moving { .. } = on_cam.rung {
            self.mover.shift_beside(own);
        }
    }

    /// Notes the master's future motion. Returns whether that or a limit has changed since the last scan, or whether
    /// the way is due to be searched again.
    fn look_ahead_on_cam(&mut self, view: &View<'_, P::Plan>) -> bool {
        let limits = self.slowed(&self.parameters.limits);
        let Some(on_cam) = &mut self.follower.on_cam else {
            return false;
        };
        let is_locked = on_cam.rung.is_locked();
        let seen = (&mut on_cam.known, &mut on_cam.left, &mut on_cam.limits);
        view.future.is_new_to(seen, &limits, is_locked)
    }

    /// The plan of the master, if it is known.
    pub(in crate::axis) fn lead_of_master<'a>(&self, view: &View<'a, P::Plan>) -> Option<Lead<'a, P::Plan>> {
        let leads = view
            .future
            .leads(|leg, factor| if leg == 0 { factor } else { 0.0 })?;
        let [lead, _] = leads;
        lead
    }

    /// Checks that the cam keeps the limits of the slave as far as is known, with the slave at the place of its
    /// master. It is checked from the end of this scan if the step `is_over`, else from the end of the last one.
    ///
    /// # Errors
    /// The limit that is exceeded.
    pub(super) fn keeps_on_cam(
        &self,
        curve: &Curve<'_>,
        view: &View<'_, P::Plan>,
        is_over: bool,
    ) -> Result<(), Beyond> {
        let Some(on_cam) = &self.follower.on_cam else {
            return Ok(());
        };
        let is_late = view.future.is_late();
        let found = match self.lead_of_master(view) {
            Some(lead) if self.is_too_fast_for_corners(curve, &lead) => {
                Some(curve.corner().asks(&on_cam.limits))
            }
            Some(mut lead) => {
                // A step that did not belong to this plan was never checked.
                let now = is_late.then(|| self.beyond_on_cam_now(curve, view)).flatten();
                let place = if is_late || is_over {
                    view.now.place
                } else {
                    on_cam.was.place
                };
                if is_over && !is_late {
                    lead.elapsed = lead.elapsed.saturating_add(1);
                }
                now.or_else(|| self.beyond_on_cam(curve, (&lead, view.degree()), place, &on_cam.limits))
            }
            None => self.beyond_on_cam_now(curve, view),
        };
        found.map_or(Ok(()), Err)
    }

    /// The limit that the cam exceeds in this scan, if the future motion is not known.
    fn beyond_on_cam_now(&self, curve: &Curve<'_>, view: &View<'_, P::Plan>) -> Option<Beyond> {
        let on_cam = self.on_cam()?;
        let at = curve.at(view.now.place, &view.now.at, on_cam.at.piece);
        let is_rough = self.is_rough_on_cam(view, &at);
        self.beyond(Some(at.place), &at.state, &on_cam.limits, Some(is_rough))
    }

    /// Whether the master moves less smoothly than the slave may, and the cam passes that on. A shift is as smooth as
    /// the slave.
    fn is_rough_on_cam(&self, view: &View<'_, P::Plan>, at: &CamAt) -> bool {
        let degree = self.slowed(&self.parameters.limits).order().degree();
        let was = self.on_cam().map_or(0.0, |on_cam| on_cam.was.own_rates()[0]);
        let [velocity, acceleration] = view.now.own_rates();
        let accelerates = acceleration != 0.0 || velocity != was;
        view.degree() < degree && accelerates && at.state.velocity != 0.0
    }

    pub(super) fn step_on_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        match (self.mover.motion(), self.cam_rung()) {
            (Motion::Geared, Some(Rung::Locked)) => self.step_in_sync(view, scope),
            (Motion::Closing { .. }, Some(Rung::Moving { turns, to })) => {
                self.step_to_cam(turns, to, view, scope);
            }
            (
                Motion::Closing { .. },
                Some(
                    Rung::BesideLine { .. }
                    | Rung::BesideMaster
                    | Rung::BesideMeasured { .. }
                    | Rung::Corner { .. },
                ),
            ) => self.step_along_cam(view, scope),
            _ => self.advance(scope),
        }
    }

    /// The place of the slave on the curve for a master at `place`.
    fn on_curve(&self, place: Place, moving: &Setpoint, scope: &Scope<'_>) -> Option<CamAt> {
        let on_cam = self.on_cam()?;
        let curve = on_cam.stored_curve(&scope.cams)?;
        Some(curve.at(place, moving, on_cam.at.piece))
    }

    /// In sync: the set-point is the cam, moved by the superimposed distance.
    fn step_in_sync(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if !self.queue.is_empty() && self.switches_cam(view, scope) {
            return;
        }
        let added = self.next_added();
        // A motion added to a law at rest was checked against the limits before.
        let is_held = added.is_some() && self.law_stands(view);
        let before = self.on_cam().and_then(|on_cam| on_cam.anchor);
        let held = self.held_end(added.as_ref());
        if let (Some(added), Some(on_cam)) = (&added, &mut self.follower.on_cam)
            && let Some(anchor) = &mut on_cam.anchor
        {
            anchor.slave.phase = on_cam.lead + added.position;
        }
        let at = held.or_else(|| self.on_curve(view.now.place, &view.now.at, scope));
        let (Some(mut at), Some(on_cam)) = (at, &self.follower.on_cam) else {
            return self.fail(ErrorId::SetpointBroken, scope);
        };
        let limits = on_cam.limits;
        let is_rough = || held.is_none() && self.is_rough_on_cam(view, &at);
        let rough = match view.future.kind() {
            _ if self.config.following.on_limit == OnLimit::Error => Some(is_rough()),
            Kind::Unknown | Kind::Measured | Kind::Still | Kind::NotSeen => Some(is_rough()),
            Kind::Plan if view.future.is_late() => Some(false),
            Kind::Plan => None,
        };
        let rough = rough.filter(|_| held.is_none() && !is_held);
        if let Some(added) = &added {
            at.state = at.state.plus(added).moved_to(at.state.position);
        }
        let corner = self.corner_in_sync(view, scope).filter(|_| held.is_none());
        let reason = corner.map(|corner| corner.asks(&limits));
        let reason = reason.or_else(|| self.beyond(Some(at.place), &at.state, &limits, rough));
        if let Some(reason) = reason {
            if let Some(on_cam) = &mut self.follower.on_cam {
                on_cam.anchor = before;
            }
            self.lose_sync(reason, scope);
            if self.config.following.on_limit == OnLimit::Error {
                return self.fail(ErrorId::DeviationTooLarge, scope);
            }
            if let Some(corner) = corner {
                return self.brake_for_corner(corner, view, scope);
            }
            self.decide_on_cam(view, false, scope);
            if self.is_on_cam() {
                self.step_on_cam(view, scope);
            }
            return;
        }
        self.mover.keep_only(limits);
        let shadow = Shadow::of(&view.now);
        self.publish_on_cam(&at, shadow, scope);
        if let (true, Some(added)) = (self.is_on_law(), added) {
            self.note_added(added);
        }
    }

    /// Publishes a place of the curve. The slave is there from now on.
    pub(super) fn publish_on_cam(&mut self, at: &CamAt, shadow: Shadow, scope: &mut Scope<'_>) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.at = *at;
            on_cam.shadow = Some(shadow);
        }
        self.publish_behind(at.place, at.state, scope);
    }

    /// A step along the curve, with a plan for the place of the shadow.
    fn step_along_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let cycle = self.planner.cycle();
        let Some(step) = self.mover.step_beside() else {
            return;
        };
        let (beside, elapsed, is_over) = (step.beside, step.elapsed, step.is_over());
        let now = &view.now;
        let (frame_place, frame, arrives) = match self.cam_rung() {
            Some(Rung::BesideLine {
                start,
                velocity,
                begin,
            }) => {
                let line =
                    Setpoint::at_velocity(start.position + velocity * (elapsed as f64 * cycle), velocity);
                let is_even = now.at.acceleration == 0.0 && now.at.jerk == 0.0;
                (start, line, is_over && is_even && elapsed >= begin)
            }
            Some(Rung::Corner { start }) => (start, Setpoint::at_rest(start.position), false),
            _ => (now.place, now.at, is_over),
        };
        let next = frame.plus(&beside);
        let shadow = Shadow {
            place: frame_place.moved_to(next.position),
            at: next,
        };
        if let Some(Rung::BesideMeasured { room }) = self.cam_rung()
            && !self.keeps_room(&room, &shadow, view, scope)
        {
            self.decide_on_cam(view, false, scope);
            if self.is_on_cam() {
                self.step_on_cam(view, scope);
            }
            return;
        }
        if let Some(corner) = self.corner_on_way(&shadow, scope) {
            return self.brake_for_corner(corner, view, scope);
        }
        if arrives && self.arrive_on_cam(&shadow, view, scope) {
            return;
        }
        let Some(at) = self.on_curve(shadow.place, &shadow.at, scope) else {
            return self.fail(ErrorId::SetpointBroken, scope);
        };
        self.publish_on_cam(&at, shadow, scope);
    }

    /// Whether a master whose future motion is not known left the shadow this `room` beside it, and the slave keeps
    /// its limits at `next`.
    fn keeps_room(&self, room: &Limits, next: &Shadow, view: &View<'_, P::Plan>, scope: &Scope<'_>) -> bool {
        let (Some(on_cam), Some(at)) = (&self.follower.on_cam, self.on_curve(next.place, &next.at, scope))
        else {
            return false;
        };
        let last = on_cam.shadow.map_or(next.at, |shadow| shadow.at);
        let ends = [on_cam.was.at, view.now.at];
        let speeds = [last.velocity, next.at.velocity];
        leaves_room(&ends, room, speeds, &on_cam.shadow_limits, self.planner.cycle())
            && self
                .beyond(Some(at.place), &at.state, &on_cam.limits, Some(false))
                .is_none()
    }

    /// The shadow has reached its master: in sync from now on, if that keeps the limits. Returns whether it is.
    fn arrive_on_cam(&mut self, shadow: &Shadow, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) -> bool {
        let Some(on_cam) = &self.follower.on_cam else {
            return false;
        };
        let turn = on_cam.camming.law.master_turn.unwrap_or(0.0);
        let is_there = meet(shadow.place, view.now.place, turn);
        let speed = on_cam.shadow_limits.velocity.min(f64::MAX);
        let is_even = (shadow.at.velocity - view.now.at.velocity).abs() <= ROUNDING * speed;
        let curve = on_cam.stored_curve(&scope.cams);
        let Some(curve) = curve.filter(|_| is_there && is_even) else {
            if let Some(on_cam) = &mut self.follower.on_cam {
                on_cam.left = 0;
            }
            return false;
        };
        if self.keeps_on_cam(&curve, view, true).is_err() {
            return false;
        }
        let at = curve.at(view.now.place, &view.now.at, on_cam.at.piece);
        let shadow = Shadow::of(&view.now);
        self.publish_on_cam(&at, shadow, scope);
        if self.is_on_cam() && !self.is_paused() {
            self.lock_on_cam(scope);
        }
        true
    }

    /// A step of a move of its own, to a place of the curve or to rest.
    fn step_to_cam(
        &mut self,
        turns: i64,
        to: Option<Place>,
        view: &View<'_, P::Plan>,
        scope: &mut Scope<'_>,
    ) {
        let Some(step) = self.mover.step_beside() else {
            return;
        };
        let (next, is_over) = (step.beside, step.is_over());
        let place = Place::new(turns, next.position);
        self.publish_behind(place, next, scope);
        if !is_over || !self.is_on_cam() || self.is_paused() {
            return;
        }
        let Some(to) = to else {
            self.mover.hold();
            return self.leave_cam();
        };
        let shadow = Shadow::at_rest(to);
        let at = self.on_curve(to, &shadow.at, scope);
        let mut is_there = view.now.at.is_at_rest() && view.future.kind() == Kind::Still;
        if let (Some(on_cam), Some(at)) = (&mut self.follower.on_cam, at) {
            let turn = on_cam.camming.law.master_turn.unwrap_or(0.0);
            is_there &= meet(to, view.now.place, turn);
            on_cam.at = at;
            on_cam.shadow = Some(shadow);
            on_cam.rung = Rung::Due;
        }
        if is_there {
            self.lock_on_cam(scope);
        }
    }

    /// In sync from now on.
    pub(super) fn lock_on_cam(&mut self, scope: &mut Scope<'_>) {
        let was_in_sync = self.on_cam().is_some_and(|on_cam| on_cam.was_in_sync);
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.rung = Rung::Locked;
            on_cam.left = u64::MAX;
            on_cam.deviation = 0.0;
            on_cam.was_in_sync = true;
            self.mover.keep_only(on_cam.limits);
        }
        self.bound_master_on_cam(&scope.cams);
        self.mover.gear();
        self.mover.watch(self.parameters.software_limits.is_some());
        self.end_routine();
        self.record(Event::InSync, &mut self.owner_scope(scope));
        if !was_in_sync {
            self.note_sync_on_cam(scope);
        }
    }

    /// No longer in sync: the cam exceeds a limit.
    pub(in crate::axis::coupling) fn lose_sync(
        &mut self,
        (what, value, limit): Beyond,
        scope: &mut Scope<'_>,
    ) {
        let adds = self.adds_motion();
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.rung = Rung::Due;
            if adds {
                // It has the velocity of the added motion, which no place of the curve has.
                on_cam.shadow = None;
            }
        }
        self.rest_superimposed();
        self.end_routine();
        let event = Event::SyncLost { what, value, limit };
        self.record(event, &mut self.owner_scope(scope));
    }

    /// The master went out of operation: no way onto the cam is searched.
    pub(in crate::axis::coupling) fn hold_off_cam(&mut self) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.rung = Rung::Lost;
            on_cam.anchor = None;
            on_cam.deviation = 0.0;
        }
    }

    /// Computes its present distance from the cam at its master's place, and whether that is too large.
    fn measure_on_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let is_off = !self.is_locked_on_cam();
        let at = is_off
            .then(|| self.on_curve(view.now.place, &view.now.at, scope))
            .flatten();
        let Some(on_cam) = &mut self.follower.on_cam else {
            return;
        };
        on_cam.deviation = at.map_or(0.0, |at| off(here, at.place, length));
        let most = self.config.following.max_deviation;
        let most = most.filter(|_| on_cam.was_in_sync);
        if most.is_some_and(|most| on_cam.deviation.abs() > most) {
            self.trip(ErrorId::DeviationTooLarge, 0, Reaction::Ramp, scope);
        }
    }

    /// The end of a cam without periods where the slave holds, moved by the `added` distance.
    pub(super) fn held_end(&self, added: Option<&Setpoint>) -> Option<CamAt> {
        let on_cam = self.on_cam().filter(|_| self.holds_end_of_cam())?;
        let mut at = on_cam.at;
        if let (Some(added), Some(anchor)) = (added, &on_cam.anchor) {
            at.place.position += on_cam.lead + added.position - anchor.slave.phase;
        }
        at.state = Setpoint::at_rest(at.place.position);
        Some(at)
    }

    /// Whether a cam without periods is over and the slave holds its last place.
    pub(in crate::axis) fn holds_end_of_cam(&self) -> bool {
        self.on_cam().is_some_and(|on_cam| on_cam.ends.is_over())
    }
}
