//! The motion step of a slave, after that of its master.

use super::super::commands::ROUNDING;
use super::super::guard::{LAST_SCAN, Steps};
use super::super::modulo::is_far;
use super::super::power::Reaction;
use super::super::{Axis, Motion};
use super::needs::{DERIVATIVES, Piece, RESOLVED, Step};
use super::view::{Future, Kind, Seen, SeenBoth, View, anchor_at};
use super::{Coupling, FURTHEST, Rung};
use crate::{ErrorId, Event, Fate, OnLimit, OnMasterLost, Scope};
use standstill_planner::{Anchor, Leads, Limits, Place, Plan, Planner, Setpoint};

/// The excess of a motion: the name, its value and the limit.
pub(in crate::axis) type Beyond = (&'static str, f64, f64);

/// The longest last scan, relative to a scan: that of the master's plan, or of a plan beside the law, may
/// be longer.
pub(super) const LONGEST: f64 = 1.0 + LAST_SCAN;

impl Coupling {
    /// The place of the law for given masters, and its derivatives.
    pub(super) fn law(&self, anchor: &Anchor, seen: &SeenBoth) -> (Place, Setpoint) {
        let slave = self.gearing.slave(anchor, seen.map(|seen| seen.place));
        let derivative =
            |of: fn(&Setpoint) -> f64| self.gearing.derivative([of(&seen[0].at), of(&seen[1].at)]);
        let state = Setpoint {
            position: slave.position,
            velocity: derivative(|at| at.velocity),
            acceleration: derivative(|at| at.acceleration),
            jerk: derivative(|at| at.jerk),
            snap: derivative(|at| at.snap),
        };
        (slave, state)
    }

    /// The size of the masters' places from which the law is computed, including their shifts (u of the slave).
    pub(super) fn size_of_masters(&self, seen: &SeenBoth) -> f64 {
        let [first, second] = seen;
        let part = |leg, seen: &Seen| self.gearing.factor(leg, seen.size()).abs();
        part(0, first) + part(1, second)
    }

    /// Whether the law is constant for any motion of the masters.
    pub(super) fn stands<Q>(&self, future: &Future<'_, Q>) -> bool {
        let [first, second] = &future.parts;
        self.gearing.factor(0, first.factor) == 0.0 && self.gearing.factor(1, second.factor) == 0.0
    }

    /// The plans of the masters, as the slave sees them; `None` if they are not known.
    pub(super) fn leads<'a, Q: Plan>(&self, future: &Future<'a, Q>) -> Option<Leads<'a, Q>> {
        future.leads(|leg, factor| self.gearing.factor(leg, factor))
    }
}

impl<P: Planner> Axis<P> {
    /// [`Axis::advance`] for an axis that may follow a master, which it can see.
    ///
    /// Cost in gear: one evaluation of the law, and one ramp while the master's next motion is not known
    /// or there are software limits. If the master got another plan: at most seven plans and six searches
    /// along two of them.
    #[inline(never)]
    pub(crate) fn advance_behind(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if !self.still_follows(view, scope) {
            return;
        }
        let shifts = self.is_phasing();
        let view = &self.shifted_view(view, scope);
        self.rebase(view, scope.scan);
        let is_new = self.look_ahead(view);
        if self.stays_paused(is_new, scope) {
            return self.measure(view, scope);
        }
        // A slave that must not lag stays in gear until it can't.
        let stays = self.config.following.on_limit == OnLimit::Error;
        self.superimpose_behind(view, is_new, !stays, scope);
        let stays = self.is_locked() && (stays || self.adds_motion());
        if (is_new && !stays) || self.rung() == Some(Rung::Due) {
            self.lay_law(view);
            self.approach(view, true, scope);
            self.end_pause();
            if let Some(coupling) = &mut self.follower.coupling {
                coupling.is_kept = false;
            }
            self.tell_outside(view, scope);
            // The last step of a shift is a special one.
            if !shifts {
                self.note_source();
            }
        }
        if self.is_coupled() {
            self.step_behind(view, scope);
        }
        self.note_own_part();
        if self.is_in_gear() && !self.queue.is_empty() {
            self.hand_over(self.mover.setpoint().position, scope);
        }
        self.finish_reset();
        self.note_whether_law_stands(view);
        self.note_steady();
    }

    /// The first part of the motion step of a slave, in a gear or on a cam: power, and a lost master. Returns whether
    /// it still follows; if not, its step is done.
    pub(super) fn still_follows(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) -> bool {
        self.apply_power(scope);
        self.follow_torque_order();
        if self.follows() {
            self.end_idle_halt();
            if !view.is_operating() && !self.has_lost_master() {
                match self.config.following.on_master_lost {
                    OnMasterLost::Error => {
                        self.fail(ErrorId::MasterLost, scope);
                        self.finish_reset();
                        return false;
                    }
                    OnMasterLost::Hold => self.hold_without_master(scope),
                }
            }
        }
        // An owner without a block has become a halt.
        let follows = self.follows() && !self.has_lost_master();
        if !follows {
            self.advance(scope);
        }
        follows
    }

    /// Whether the owner follows a master, in a gear or on a cam.
    pub(in crate::axis) fn follows(&self) -> bool {
        self.is_coupled() || self.is_on_cam()
    }

    /// A paused slave continues if the master's future motion `is_new`. Returns whether it stays paused; its step is
    /// then done.
    pub(super) fn stays_paused(&mut self, is_new: bool, scope: &mut Scope<'_>) -> bool {
        if self.is_paused() && is_new {
            self.resume(scope);
        }
        let stays = self.is_paused();
        if stays {
            self.advance(scope);
        }
        stays
    }

    /// Whether its coupling is in gear, whether or not the motion follows it now.
    fn is_locked(&self) -> bool {
        self.coupling().is_some_and(|coupling| coupling.rung.is_locked())
    }

    pub(super) fn rung(&self) -> Option<Rung> {
        self.coupling().map(|coupling| coupling.rung)
    }

    /// Coordinates of master or slave were shifted: the law is shifted with them, and nothing else changes.
    fn rebase(&mut self, view: &View<'_, P::Plan>, scan: u64) {
        let (here, moves) = (self.place(), self.frame.moves());
        let own = self.coordinates_moved(scan);
        let Some(coupling) = &mut self.follower.coupling else {
            return;
        };
        let now = view.seen();
        for (was, now) in coupling.was.iter_mut().zip(&now) {
            // A shift of coordinates within the motion step was not seen before it.
            let late = now.moved - was.moved;
            was.place.position += late;
            was.at.position += late;
            if late.abs() > FURTHEST {
                // At numbers of this size a step is lost in rounding.
                let phase = was.place.phase;
                (was.place, was.at.position) = (Place { phase, ..now.place }, now.at.position);
            }
        }
        let masters_moved = now.iter().any(|seen| seen.moved != 0.0);
        let slave_moved = coupling.moves != moves;
        coupling.moves = moves;
        if !masters_moved && !slave_moved {
            return;
        }
        let own = if slave_moved { own } else { 0.0 };
        let added = self.mover.layer().map_or(0.0, |layer| layer.added().position);
        let shift = |anchor: &mut Anchor| {
            anchor.master.position += now[0].moved;
            anchor.second.position += now[1].moved;
            anchor.slave.position += own;
        };
        match &mut coupling.rung {
            Rung::BesideLine { start, .. } => start.position += own,
            Rung::BesideLaw(anchor) | Rung::BesideMeasured { anchor, .. } => shift(anchor),
            Rung::Due | Rung::Locked | Rung::Own | Rung::Lost => {}
        }
        let Some(anchor) = &mut coupling.anchor else {
            return;
        };
        if coupling.rung.is_locked() {
            *anchor = anchor_at(&coupling.was, here);
            coupling.lay_layer(added);
        } else {
            shift(anchor);
        }
    }

    /// Notes the master's future motion. Returns whether that or a limit has changed since the last scan, or whether
    /// the way onto the law is due to be searched again.
    fn look_ahead(&mut self, view: &View<'_, P::Plan>) -> bool {
        let limits = self.slowed(&self.parameters.limits);
        let Some(coupling) = &mut self.follower.coupling else {
            return false;
        };
        let is_locked = coupling.rung.is_locked();
        let seen = (&mut coupling.known, &mut coupling.left, &mut coupling.limits);
        view.future.is_new_to(seen, &limits, is_locked)
    }

    fn step_behind(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        match (self.mover.motion(), self.rung()) {
            (Motion::Geared, Some(Rung::Locked)) => self.step_in_gear(view, scope),
            (Motion::Closing { .. }, Some(_)) => self.step_beside(view, scope),
            _ => {
                self.advance(scope);
                self.lock_at_velocity(view, scope);
            }
        }
        self.measure(view, scope);
    }

    /// In gear: the set-point is the law.
    fn step_in_gear(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let added = self.next_added();
        let Some(coupling) = &self.follower.coupling else {
            return;
        };
        let Some(mut anchor) = coupling.anchor else { return };
        let limits = coupling.limits;
        if let Some(added) = &added {
            anchor.slave.phase = coupling.lead + added.position;
        }
        let (place, law) = coupling.law(&anchor, &view.seen());
        let next = added.map_or(law, |added| law.plus(&added).moved_to(law.position));
        // A motion added to a law at rest was checked against the limits before.
        let is_held = added.is_some() && self.law_stands(view);
        let rough = self.rough(view).filter(|_| !is_held);
        let reason = self.beyond(Some(place), &next, &limits, rough);
        if let Some(reason) = reason.or_else(|| self.beyond_on_the_way(&anchor, view, &limits)) {
            self.lose_gear(reason, scope);
            if self.config.following.on_limit == OnLimit::Error {
                return self.fail(ErrorId::DeviationTooLarge, scope);
            }
            self.approach(view, false, scope);
            if self.is_coupled() {
                self.step_behind(view, scope);
            }
            return;
        }
        self.mover.keep_only(limits);
        self.publish_behind(place, next, scope);
        if let (true, Some(added), Some(coupling)) = (self.is_on_law(), added, &mut self.follower.coupling) {
            coupling.anchor = Some(anchor);
            self.note_added(added);
        }
    }

    /// In gear, so that the next set-point is the law.
    pub(in crate::axis) fn is_on_law(&self) -> bool {
        (self.is_locked() || self.is_locked_on_cam()) && matches!(self.mover.motion(), Motion::Geared)
    }

    /// Whether the masters have not moved in this scan, and will not move as far as is known.
    pub(in crate::axis) fn law_stands(&self, view: &View<'_, P::Plan>) -> bool {
        if let Some(was) = self.master_of_cam_was() {
            let has_stood = was.place == view.now.place && was.at.is_at_rest();
            return self.holds_end_of_cam() || (view.future.kind() == Kind::Still && has_stood);
        }
        let Some(coupling) = &self.follower.coupling else {
            return false;
        };
        let mut both = coupling.was.iter().zip(view.seen());
        view.future.kind() == Kind::Still
            && both.all(|(was, now)| was.place == now.place && was.at.is_at_rest())
    }

    /// After a step: notes for its slaves whether it is at rest as long as its law is, and whether it only trembles
    /// with its masters.
    pub(super) fn note_whether_law_stands(&mut self, view: &View<'_, P::Plan>) {
        self.follower.stands =
            self.is_on_law() && self.mover.setpoint().is_at_rest() && self.law_stands(view);
        self.follower.trembles = self.is_on_law() && view.trembles() && !self.adds_motion();
    }

    /// The plans ahead, as the law of a gear has them, or unchanged for a cam; `None` while the law is
    /// constant or they are not known.
    pub(in crate::axis) fn leads_of_law<'a>(&self, view: &View<'a, P::Plan>) -> Option<Leads<'a, P::Plan>> {
        if self.is_on_cam() {
            return self.lead_of_master(view).map(|lead| [Some(lead), None]);
        }
        let leads = self.coupling()?.leads(&view.future)?;
        leads.iter().any(Option::is_some).then_some(leads)
    }

    /// The law at the end of the last scan, and at the end of this one.
    pub(in crate::axis) fn law_before_and_now(
        &self,
        view: &View<'_, P::Plan>,
    ) -> Option<(Setpoint, Setpoint)> {
        let coupling = self.coupling()?;
        let anchor = coupling.anchor?;
        let law = |seen| coupling.law(&anchor, seen).1;
        Some((law(&coupling.was), law(&view.seen())))
    }

    /// A step beside the law, or beside the line that it leads onto.
    fn step_beside(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let here = self.place();
        let cycle = self.planner.cycle();
        let (Some(step), Motion::Closing { plan, .. }) = (self.mover.step_beside(), self.mover.motion())
        else {
            return;
        };
        let (beside, elapsed, is_over) = (step.beside, step.elapsed, step.is_over());
        let goal = plan.at(step.scans).position;
        let Some(coupling) = &self.follower.coupling else {
            return;
        };
        let (rung, known) = (coupling.rung, coupling.anchor);
        let anchor = match (rung, known) {
            (Rung::BesideLaw(anchor) | Rung::BesideMeasured { anchor, .. }, _) | (_, Some(anchor)) => anchor,
            (_, None) => return self.publish_behind(here, *self.mover.setpoint(), scope),
        };
        let (law_place, law) = coupling.law(&anchor, &view.seen());
        let (frame_place, frame, arrives) = match rung {
            Rung::BesideLine {
                start,
                velocity,
                begin,
            } => {
                let line =
                    Setpoint::at_velocity(start.position + velocity * (elapsed as f64 * cycle), velocity);
                let is_even = law.acceleration == 0.0 && law.jerk == 0.0;
                (start, line, is_over && is_even && elapsed >= begin)
            }
            _ => (law_place, law, is_over),
        };
        let end = frame.moved_to(frame.position + goal);
        let next = frame.plus(&beside);
        if let Rung::BesideMeasured { anchor, room } = rung {
            let place = frame_place.moved_to(next.position);
            let in_force = self.mover.in_force();
            let law = |seen| coupling.law(&anchor, seen).1;
            let ends = [law(&coupling.was), law(&view.seen())];
            let speeds = [self.mover.setpoint().velocity, next.velocity];
            // A motion on the law needs no room.
            let leaves_room = room.velocity == 0.0 || leaves_room(&ends, &room, speeds, in_force, cycle);
            if !leaves_room || self.beyond(Some(place), &next, in_force, Some(false)).is_some() {
                self.approach(view, false, scope);
                if self.is_coupled() {
                    self.step_behind(view, scope);
                }
                return;
            }
        }
        self.look_from_near(&beside, frame.position - frame_place.position);
        let arrives = arrives && self.law_fits(view, true);
        if arrives && known.is_some() && self.is_on(&end, frame_place, &law, law_place) {
            // The snap is that of the motion before this point.
            let snap = next.snap;
            self.publish_behind(law_place, Setpoint { snap, ..law }, scope);
            return self.lock_unless_stopped(anchor, view, scope);
        }
        self.publish_behind(frame_place, next, scope);
        if arrives && known.is_none() {
            let anchor = anchor_at(&view.seen(), self.place());
            self.lock_unless_stopped(anchor, view, scope);
        }
    }

    /// On a way of several turns back onto its law, searches the rest of the way again from the present place. A plan
    /// that began further away is as coarse as that distance.
    fn look_from_near(&mut self, beside: &Setpoint, line: f64) {
        let (Some(modulo), Some(coupling)) = (&self.modulo, &mut self.follower.coupling) else {
            return;
        };
        let is_long = is_far(beside.position, modulo.length) || is_far(line, modulo.length);
        if is_long && !coupling.is_syncing() && matches!(coupling.rung, Rung::BesideLine { .. }) {
            coupling.left = 0;
        }
    }

    /// In gear, unless the set-point published last has ended that.
    fn lock_unless_stopped(&mut self, anchor: Anchor, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if self.is_coupled() && !self.is_paused() {
            self.lock(anchor, view, scope);
        }
    }

    /// Whether a frame at the end of a plan is the law except for rounding. If not, the way is searched
    /// again.
    fn is_on(&mut self, frame: &Setpoint, frame_place: Place, law: &Setpoint, law_place: Place) -> bool {
        let Some(coupling) = &self.follower.coupling else {
            return false;
        };
        let length = self.config.modulo.unwrap_or(0.0);
        let place = frame_place.moved_to(frame.position);
        let resolved = self.resolved_of(coupling, law_place);
        let is_on = off(place, law_place, length).abs() <= resolved && self.law_is_near(frame, law);
        if let (false, Some(coupling)) = (is_on, &mut self.follower.coupling) {
            coupling.left = 0;
        }
        is_on
    }

    /// After a step of its own: in gear if it has reached the velocity of the law, was not in gear before, and can
    /// stay on the law.
    fn lock_at_velocity(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(coupling) = &self.follower.coupling else {
            return;
        };
        let is_at_goal =
            matches!(self.mover.motion(), Motion::Run { elapsed, scans, .. } if elapsed >= scans);
        if coupling.anchor.is_some() || coupling.rung != Rung::Own || !is_at_goal || self.is_paused() {
            return;
        }
        let anchor = anchor_at(&view.seen(), self.place());
        let (_, law) = coupling.law(&anchor, &view.seen());
        let is_even = law.acceleration == 0.0 && law.jerk == 0.0;
        if is_even && self.law_is_near(self.mover.setpoint(), &law) && self.law_fits(view, true) {
            self.lock(anchor, view, scope);
        }
    }

    /// Whether two velocities are equal except for rounding.
    fn law_is_near(&self, one: &Setpoint, law: &Setpoint) -> bool {
        (one.velocity - law.velocity).abs() <= ROUNDING * self.parameters.limits.velocity
    }

    /// Whether the law keeps the limits of the slave as far as is known. It is checked from the end of
    /// this scan if the step `is_over`, else from the end of the last one.
    pub(super) fn law_fits(&self, view: &View<'_, P::Plan>, is_over: bool) -> bool {
        let Some(coupling) = &self.follower.coupling else {
            return false;
        };
        if !self.is_told_finely(view) {
            return false;
        }
        let anchor = coupling.anchor.unwrap_or_default();
        let (_, after) = coupling.law(&anchor, &view.seen());
        let (_, before) = coupling.law(&anchor, &coupling.was);
        let is_late = view.future.is_late();
        // A plan that began and ended within this scan was never checked.
        if is_late && self.beyond_now(view).is_some() {
            return false;
        }
        match coupling.leads(&view.future) {
            _ if coupling.stands(&view.future) => true,
            Some(mut leads) => {
                let now = if is_late || is_over { &after } else { &before };
                if is_over && !is_late {
                    for lead in leads.iter_mut().flatten() {
                        lead.elapsed = lead.elapsed.saturating_add(1);
                    }
                }
                self.planner.fits_behind(&leads, now, None, &coupling.limits)
            }
            None => self.beyond_now(view).is_none(),
        }
    }

    /// The limit that the law of measured values exceeds between the ends of the last two scans, although it keeps it
    /// at both ends.
    fn beyond_on_the_way(
        &self,
        anchor: &Anchor,
        view: &View<'_, P::Plan>,
        limits: &Limits,
    ) -> Option<Beyond> {
        let coupling = self.coupling().filter(|_| self.follows_actual())?;
        let (_, from) = coupling.law(anchor, &coupling.was);
        let (_, to) = coupling.law(anchor, &view.seen());
        let peaks = Piece::between(&from, &to, self.planner.cycle()).peaks();
        // A superimposed motion may use its limits at any time.
        let most = self.mover.layer().and_then(|layer| layer.limits_in_motion());
        let added = |of: fn(&Limits) -> f64| most.map_or(0.0, of);
        let steepest = |limits: &Limits| limits.acceleration.max(limits.deceleration);
        let told = [
            (
                "velocity",
                peaks.velocity + added(|limits| limits.velocity),
                limits.velocity,
            ),
            (
                "acceleration",
                peaks.acceleration + added(steepest),
                steepest(limits),
            ),
            ("jerk", peaks.jerk + added(|limits| limits.jerk), limits.jerk),
            ("snap", peaks.snap + added(|limits| limits.snap), limits.snap),
        ];
        told.into_iter()
            .find(|(_, value, limit)| !(*value <= limit * (1.0 + ROUNDING)))
    }

    /// Whether measured places are fine enough that rounding causes no step of the slave. Only jumps lead to places
    /// that are too coarse.
    pub(super) fn is_told_finely(&self, view: &View<'_, P::Plan>) -> bool {
        let Some(coupling) = self.coupling().filter(|_| self.follows_actual()) else {
            return true;
        };
        let numbers = coupling.size_of_masters(&view.seen()) + self.mover.setpoint().position.abs();
        let rounded = 8.0 * f64::EPSILON * numbers;
        rounded <= LAST_SCAN * self.parameters.limits.velocity * self.planner.cycle()
    }

    /// The limit that the law exceeds in this scan, if the motion ahead is not known.
    pub(super) fn beyond_now(&self, view: &View<'_, P::Plan>) -> Option<Beyond> {
        let coupling = self.coupling()?;
        let anchor = coupling.anchor.unwrap_or_default();
        let (place, law) = coupling.law(&anchor, &view.seen());
        let place = coupling.anchor.map(|_| place);
        self.beyond(place, &law, &coupling.limits, self.rough(view))
    }

    /// `Some` if this step was not checked against the limits before. The causes are: the slave stays in gear as long
    /// as it can; the master's future motion is not known, or was not until now; the master is at rest, perhaps after
    /// a plan of one scan. `Some(TRUE)` if the master's motion is less smooth than the slave needs. A shift is as
    /// smooth as the slave.
    fn rough(&self, view: &View<'_, P::Plan>) -> Option<bool> {
        let gearing = &self.coupling()?.gearing;
        let degree = self.slowed(&self.parameters.limits).order().degree();
        let own = view.seen().map(|seen| seen.own_rates()[1]);
        let is_rough = view.degree() < degree && gearing.derivative(own) != 0.0;
        match view.future.kind() {
            // The motion of the masters was planned for this slave, unless the slave does something else.
            _ if self.slows_master() && view.keeps_bound() && !self.adds_motion() => None,
            _ if self.config.following.on_limit == OnLimit::Error => Some(is_rough),
            Kind::Unknown | Kind::Measured | Kind::Still | Kind::NotSeen => Some(is_rough),
            Kind::Plan if view.future.is_late() => Some(false),
            Kind::Plan => None,
        }
    }

    /// In gear from now on, on the law through `anchor`.
    pub(super) fn lock(&mut self, anchor: Anchor, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.anchor = Some(anchor);
            coupling.rung = Rung::Locked;
            coupling.left = u64::MAX;
            coupling.told = None;
            coupling.deviation = 0.0;
            self.mover.keep_only(coupling.limits);
        }
        self.mover.gear();
        self.mover.watch(self.parameters.software_limits.is_some());
        self.end_routine();
        self.record_in_gear(scope);
        self.note_sync(view, scope);
    }

    /// No longer in gear: the law needs `value`, but only `limit` is allowed.
    pub(in crate::axis) fn lose_gear(&mut self, (what, value, limit): Beyond, scope: &mut Scope<'_>) {
        if self.is_on_cam() {
            return self.lose_sync((what, value, limit), scope);
        }
        self.leave_law();
        self.rest_superimposed();
        self.end_routine();
        let event = Event::GearLost { what, value, limit };
        self.record(event, &mut self.owner_scope(scope));
    }

    /// The limit that the state `next` at `place` exceeds. If the future motion is not known (`rough` says how the
    /// master moves), there are two more checks: a step that no motion within the limits can make, and a state that
    /// must lead beyond them. They cost a ramp.
    pub(super) fn beyond(
        &self,
        place: Option<Place>,
        next: &Setpoint,
        limits: &Limits,
        rough: Option<bool>,
    ) -> Option<Beyond> {
        let found = beyond_limits(next, limits);
        let Some(is_rough) = rough.filter(|_| found.is_none()) else {
            return found;
        };
        let length = self.config.modulo.unwrap_or(0.0);
        let geared = self.coupling();
        let masters = geared.map_or_else(
            || self.size_of_master_on_cam(),
            |coupling| coupling.size_of_masters(&coupling.was),
        );
        let step = Step {
            last: self.mover.setpoint(),
            next,
            way: place.map(|place| off(place, self.place(), length)),
            coarsest: length + masters,
            cycle: self.planner.cycle(),
        };
        let needed = step.needs();
        if is_rough {
            return Some(("jerk", needed[2], limits.jerk));
        }
        let steepest = limits.acceleration.max(limits.deceleration);
        let most = [limits.velocity, steepest, limits.jerk, limits.snap];
        let parts = DERIVATIVES.into_iter().zip(needed).zip(most);
        let told = parts.map(|((what, value), limit)| (what, value, limit));
        let found = told
            .into_iter()
            .find(|(_, value, limit)| !(*value <= limit * (1.0 + LAST_SCAN)));
        if found.is_some() {
            return found;
        }
        let found = step.beyond(limits);
        if found.is_some() {
            return found;
        }
        if next.is_at_rest() {
            return None;
        }
        let ramp = self.planner.ramp_to(next, 0.0, limits, limits);
        // The highest velocity that cannot be avoided. A stop in the middle of a reversal stays within the limits
        // when it reverses.
        let most = match &ramp {
            Ok(ramp) => {
                let excess = ramp.excess()?;
                let most = self.planner.peaks((ramp, 0)).map(|peaks| peaks.velocity);
                let turns_back = excess.acceleration == 0.0 && excess.jerk == 0.0;
                if turns_back && most.is_some_and(|most| most <= limits.velocity * (1.0 + ROUNDING)) {
                    return None;
                }
                most.unwrap_or(f64::INFINITY)
            }
            Err(_) => f64::INFINITY,
        };
        let most = most.max(limits.velocity);
        Some(("velocity", most.copysign(next.velocity), limits.velocity))
    }

    /// Publishes `next`, whose whole turns are those of `place`, if it is a permitted step from the last set-point.
    pub(super) fn publish_behind(&mut self, place: Place, mut next: Setpoint, scope: &mut Scope<'_>) {
        let mut last = *self.mover.setpoint();
        let mut turns = place.turns;
        if let Some(modulo) = &self.modulo {
            let (further, position) = standstill_planner::turns::split(next.position, modulo.length);
            next.position = position;
            turns = turns.saturating_add(further);
            let was = self.place();
            // Its last place, as a position in its present turn.
            last.position = was.position + (was.turns.wrapping_sub(turns)) as f64 * modulo.length;
        }
        if !next.is_finite() {
            return self.fail(ErrorId::SetpointBroken, scope);
        }
        if !self.is_step_behind(&last, &next) {
            return self.fail(ErrorId::SetpointStep, scope);
        }
        if self.bars_any()
            && let Some(error) = self.way_barred(next.velocity)
        {
            self.pause(error, scope);
            return self.advance(scope);
        }
        if self.mover.is_watched() && self.would_leave(next) {
            return self.fail(ErrorId::SoftwareLimitReached, scope);
        }
        if let Some(modulo) = &mut self.modulo {
            modulo.put(turns);
        }
        self.mover.publish(next);
    }

    /// Whether `next` is no further from the `last` set-point than the axis may move in a scan.
    fn is_step_behind(&self, last: &Setpoint, next: &Setpoint) -> bool {
        let scan = LONGEST * self.planner.cycle();
        let fits = |limits: &Limits| Steps::within(limits, scan).allow(last, next, 0.0);
        let limits = &self.config.limits;
        fits(limits)
            || fits(
                &limits
                    .or_larger(self.mover.before())
                    .or_larger(&self.stop_limits()),
            )
    }

    /// The master went out of operation: the slave comes to rest and searches no way onto the law.
    #[cold]
    fn hold_without_master(&mut self, scope: &mut Scope<'_>) {
        self.pause(ErrorId::MasterLost, scope);
        self.end_superimposed(Fate::Aborted);
        self.end_phasing();
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.rung = Rung::Lost;
            coupling.anchor = None;
            coupling.deviation = 0.0;
        }
        self.hold_off_cam();
    }

    /// Computes its present distance from the law, and whether that is too large.
    fn measure(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let Some(coupling) = &mut self.follower.coupling else {
            return;
        };
        coupling.deviation = match (coupling.rung, &coupling.anchor) {
            (Rung::Locked, _) | (_, None) => 0.0,
            (_, Some(anchor)) => off(here, coupling.law(anchor, &view.seen()).0, length),
        };
        let most = self
            .config
            .following
            .max_deviation
            .filter(|_| coupling.was_in_gear);
        if most.is_some_and(|most| coupling.deviation.abs() > most) {
            self.trip(ErrorId::DeviationTooLarge, 0, Reaction::Ramp, scope);
        }
    }
}

/// Whether a law of measured values left a plan this `room` beside it during the whole scan. The law had these two
/// states at the ends of a scan of this `cycle` (s); the sum of both had these two velocities there.
pub(super) fn leaves_room(
    law: &[Setpoint; 2],
    room: &Limits,
    [from, to]: [f64; 2],
    limits: &Limits,
    cycle: f64,
) -> bool {
    let [before, now] = law;
    let peaks = Piece::between(before, now, cycle).peaks();
    let rate = limits.lower_acceleration();
    // Between two velocities one scan apart.
    let fastest = 0.5 * (from + to).abs() + 0.5 * rate * cycle;
    fastest <= limits.velocity
        && peaks.acceleration + room.acceleration <= rate
        && peaks.jerk + room.jerk <= limits.jerk
        && peaks.snap + room.snap <= limits.snap
}

/// The first derivative of a state that exceeds its limit.
#[inline]
fn beyond_limits(next: &Setpoint, limits: &Limits) -> Option<Beyond> {
    let rate = if next.velocity * next.acceleration < 0.0 {
        limits.deceleration
    } else {
        limits.acceleration
    };
    let told = [
        ("velocity", next.velocity, limits.velocity),
        ("acceleration", next.acceleration, rate),
        ("jerk", next.jerk, limits.jerk),
        ("snap", next.snap, limits.snap),
    ];
    let beyond = |(_, value, limit): &Beyond| !(value.abs() <= limit * (1.0 + ROUNDING));
    told.into_iter().find(beyond)
}

/// The distance of `one` from `other` (u), including turns of `length` (u).
pub(super) fn off(one: Place, other: Place, length: f64) -> f64 {
    (one.turns.wrapping_sub(other.turns)) as f64 * length + (one.position - other.position)
}

/// The same for two masters as their slave sees them, including phase shifts.
pub(super) fn apart(one: Place, other: Place, length: f64) -> f64 {
    off(one, other, length) + (one.phase - other.phase)
}

/// Whether two masters are at the same place, except for rounding.
pub(super) fn meet(one: Place, other: Place, length: f64) -> bool {
    let numbers = one.position.abs() + other.position.abs() + length;
    apart(one, other, length).abs() <= RESOLVED * 4.0 * numbers
}
