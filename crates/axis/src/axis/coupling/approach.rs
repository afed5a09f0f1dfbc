//! How a slave comes onto the law of its gear: looked for whenever the master gets another plan, or a way has ended.
//!
//! | rung | the slave moves | in gear |
//! | --- | --- | --- |
//! | in gear | on the law | at once, where it is on the law and that keeps its limits as far as is known |
//! | beside the law | on the law and a plan to its difference 0; both together keep the limits | at the end of the plan |
//! | onto a stretch | to the velocity of the law in its next stretch of constant velocity | at the end of the plan, or where the stretch begins |
//! | pace | as fast as it may, the way the law leads | not yet |
//!
//! Of the first three the one that is in gear soonest is taken. The last two always exist, so a slave is never without a plan.
//! Before it was in gear only the velocity counts, and the way lost is not made up; after that it catches up onto the same law.

use super::super::commands::{Entry, Work};
use super::super::supervision::Arrival;
use super::super::{Axis, Motion};
use super::follow::{Beyond, ROUNDING, off};
use super::needs::RESOLVED;
use super::view::{Course, View};
use super::{Coupling, Rung};
use crate::{Approach, ErrorId, Event, Fate, Scope};
use standstill_planner::{Anchor, Limits, MoveProfile, Place, Plan, Planner, Setpoint};

/// Scans after which the way is looked for again while what the master does next is not known.
const UNKNOWN: u64 = 16;

/// A velocity left beside that of a line must be at least this part of the limit.
const LEAST: f64 = 1e-6;

/// The law's next stretch of constant velocity.
#[derive(Clone, Copy)]
struct Stretch {
    /// Scans until it begins and ends; the largest number if it has no end.
    begin: u64,
    end: u64,
    /// Velocity of the law on it (u/s).
    velocity: f64,
    /// Where a line of that velocity through it is now (u), in the turn the slave is in.
    now: f64,
}

/// A way onto the law.
pub(super) struct Way<Plan> {
    motion: Motion<Plan>,
    rung: Rung,
    /// Scans until in gear; the largest number if not along this way.
    lock: u64,
    /// Scans until it is looked for again.
    left: u64,
    name: Approach,
    velocity: f64,
    /// Limits in force along it.
    limits: Limits,
}

impl<Plan> Way<Plan> {
    /// Scans until in gear, if that is along this way.
    pub(super) fn scans_to_lock(&self) -> Option<u64> {
        (self.lock != u64::MAX).then_some(self.lock)
    }
}

impl<P: Planner> Axis<P> {
    /// Finds the way onto the law, from the state at the end of the scan before; in gear at once only if it `may_lock`.
    pub(super) fn approach(&mut self, view: &View<'_, P::Plan>, may_lock: bool, scope: &mut Scope<'_>) {
        let (Some(coupling), Some(owner)) = (&self.coupling, self.owner) else {
            return;
        };
        let was_locked = coupling.rung == Rung::Locked;
        let anchor = coupling.anchor.unwrap_or(Anchor {
            master: coupling.was.place,
            slave: self.place(),
        });
        let (_, law) = coupling.law(&anchor, &coupling.was);
        let difference = self.difference(coupling, &anchor);
        if difference.is_at_rest() && difference.position == 0.0 {
            // What was not on the law may not have been held against a plan of the master that is over now.
            let was_on_law = coupling.anchor.is_some();
            let is_seen = match view.future.course {
                Course::Still => law.is_at_rest(),
                Course::Plan(..) => !view.future.is_late(),
                Course::Unknown => true,
            };
            if may_lock && (was_on_law || is_seen) && self.law_fits(view, false) {
                if !was_locked {
                    self.lock(anchor, view, scope);
                }
                return;
            }
            if was_locked {
                let reason = self.reason(view).or_else(|| self.beyond_now(view));
                let reason = reason.unwrap_or(("velocity", law.velocity, f64::NAN));
                self.lose_gear(reason, scope);
            }
        }
        let before = self.limits_before(&self.limits_of_approach(&owner));
        match self.way_onto(&owner, view, anchor, &difference) {
            Ok(mut way) => {
                if view.future.is_late() {
                    way.left = 0;
                }
                self.take_way(way, before, scope);
            }
            Err(error) => self.stay_back(error, view, scope),
        }
    }

    /// How the slave is off the law through `anchor` at the end of the scan before.
    pub(super) fn difference(&self, coupling: &Coupling, anchor: &Anchor) -> Setpoint {
        let (place, law) = coupling.law(anchor, &coupling.was);
        let length = self.modulo.as_ref().map_or(0.0, |modulo| modulo.length);
        Setpoint {
            position: off(self.place(), place, length),
            velocity: self.setpoint.velocity - law.velocity,
            acceleration: self.setpoint.acceleration - law.acceleration,
            jerk: self.setpoint.jerk - law.jerk,
            snap: 0.0,
        }
    }

    /// The way onto the law through `anchor` that is in gear soonest, from the end of the scan before.
    ///
    /// # Errors
    /// Why there is none: the way is barred, or before the slave is in sync for the first time the master is too fast.
    pub(super) fn way_onto(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        anchor: Anchor,
        difference: &Setpoint,
    ) -> Result<Way<P::Plan>, ErrorId> {
        let Some(coupling) = &self.coupling else {
            return Err(ErrorId::PlanRefused);
        };
        let here = self.place();
        let length = self.modulo.as_ref().map_or(0.0, |modulo| modulo.length);
        let (place, law) = coupling.law(&anchor, &coupling.was);
        let (place_now, _) = coupling.law(&anchor, &view.now);
        let step = off(place_now, place, length);
        let stretch = self.next_stretch(view, here.position - difference.position, step);
        let mut limits = self.limits_of_approach(owner);
        let before = self.limits_before(&limits);
        let velocity = stretch.map_or(law.velocity, |stretch| stretch.velocity);
        if coupling.is_syncing() {
            if coupling.goes_slowly() && velocity != 0.0 {
                limits.velocity = limits.velocity.min(velocity.abs());
            }
            if let (Some(stretch), Course::Plan(..)) = (&stretch, view.future.course) {
                self.is_in_reach(stretch, &limits)?;
            }
        }
        let onto = stretch.and_then(|stretch| self.onto(owner, view, &stretch, &limits, &before));
        let soonest = onto.as_ref().map_or(u64::MAX, |way| way.lock);
        let beside = self
            .beside_law(view, anchor, difference, velocity, &limits)
            .filter(|way| way.lock < soonest);
        match beside.or(onto) {
            Some(way) => Ok(way),
            None => self.at_pace(owner, view, velocity),
        }
    }

    /// The limits of the owner on its way onto the law.
    pub(super) fn limits_of_approach(&self, owner: &Entry) -> Limits {
        let (asked, axis) = (&owner.limits, &self.parameters.limits);
        // The Velocity of MC_GearInPos is one for the way to its sync point.
        let is_synced = |coupling: &Coupling| coupling.gearing.sync.is_some() && coupling.was_in_gear;
        let velocity = if self.coupling.as_ref().is_some_and(is_synced) {
            axis.velocity
        } else {
            asked.velocity.min(axis.velocity)
        };
        Limits {
            velocity,
            acceleration: asked.acceleration.min(axis.acceleration),
            deceleration: asked.deceleration.min(axis.deceleration),
            jerk: asked.jerk.min(axis.jerk),
            snap: asked.snap.min(axis.snap),
        }
    }

    /// The stretch of the law that the slave is to be led onto; the law was at `on_law` (u), in the turn of the slave, and has
    /// moved by `step` (u) in this scan.
    fn next_stretch(&self, view: &View<'_, P::Plan>, on_law: f64, step: f64) -> Option<Stretch> {
        let coupling = self.coupling.as_ref()?;
        let gear = &coupling.gearing.gear;
        let factor = coupling.factor(&view.future);
        let cycle = self.planner.cycle();
        if factor == 0.0 || matches!(view.future.course, Course::Still) {
            return Some(Stretch {
                begin: 0,
                end: u64::MAX,
                velocity: 0.0,
                now: on_law + step,
            });
        }
        let velocity = gear.derivative(view.now.at.velocity);
        let unknown = Stretch {
            begin: 0,
            end: UNKNOWN,
            velocity,
            now: on_law + (step - velocity * cycle),
        };
        let Some((plan, from, late)) = view.future.plan() else {
            return Some(unknown);
        };
        let Some((begin, end)) = self.planner.stretch((plan, from)) else {
            return Some(unknown);
        };
        let velocity = gear.derivative(view.future.factor * plan.at(begin).velocity);
        let scans = |at: u64| at.saturating_sub(from).saturating_add(late);
        // By how much the law comes further than the line on its way there.
        let way = factor * (plan.at(begin).position - plan.at(from).position);
        let way = if late > 0 { way + step } else { way };
        Some(Stretch {
            begin: scans(begin),
            end: if end == u64::MAX { end } else { scans(end) },
            velocity,
            now: on_law + (way - velocity * (scans(begin) as f64 * cycle)),
        })
    }

    /// The velocity of the law in its next stretch, without its sign (u/s).
    pub(super) fn law_speed(&self, view: &View<'_, P::Plan>) -> f64 {
        let stretch = self.next_stretch(view, 0.0, 0.0);
        stretch.map_or(0.0, |stretch| stretch.velocity.abs())
    }

    /// Where a stop beside a line of this `velocity` (u/s) ends (u), more than 0 if ahead of it; `start` is the state beside it.
    fn stop_ahead(&self, start: &Setpoint, velocity: f64, limits: &Limits) -> Option<f64> {
        let lower = limits.lower_acceleration();
        let widest = Limits {
            velocity: limits.velocity + velocity.abs() + start.velocity.abs(),
            acceleration: lower,
            deceleration: lower,
            ..*limits
        };
        let stop = self.planner.ramp_to(start, 0.0, &widest, &widest).ok()?;
        Some(1.0_f64.copysign(velocity) * stop.at(u64::from(stop.scans())).position)
    }

    /// Whether the slave can come onto a stretch without going faster than `limits` allow.
    ///
    /// # Errors
    /// [`ErrorId::MasterTooFast`].
    fn is_in_reach(&self, stretch: &Stretch, limits: &Limits) -> Result<(), ErrorId> {
        let line = stretch.velocity.abs();
        let too_fast = if line == 0.0 || limits.velocity > line * (1.0 + LEAST) {
            false
        } else if limits.velocity < line * (1.0 - ROUNDING) {
            true
        } else {
            // As fast as the line it can wait for it, not catch up with it.
            let ahead = self.stop_ahead(&self.beside_stretch(stretch), stretch.velocity, limits);
            let resolved = RESOLVED * 4.0 * (stretch.now.abs() + self.setpoint.position.abs());
            ahead.is_some_and(|ahead| ahead < -resolved)
        };
        if too_fast {
            Err(ErrorId::MasterTooFast)
        } else {
            Ok(())
        }
    }

    /// The state of the slave beside the line of a stretch.
    fn beside_stretch(&self, stretch: &Stretch) -> Setpoint {
        Setpoint {
            position: self.place().position - stretch.now,
            velocity: self.setpoint.velocity - stretch.velocity,
            ..self.setpoint
        }
    }

    /// Onto a law that rests, planned as MC_MoveAbsolute to its place is.
    fn onto_rest(&self, view: &View<'_, P::Plan>, limits: &Limits, before: &Limits) -> Option<Way<P::Plan>> {
        let coupling = self.coupling.as_ref()?;
        let anchor = coupling.anchor?;
        let here = self.place();
        let length = self.modulo.as_ref().map_or(0.0, |modulo| modulo.length);
        let (law, _) = coupling.law(&anchor, &view.now);
        let target = (law.turns.wrapping_sub(here.turns)) as f64 * length + law.position;
        let start = Setpoint {
            position: here.position,
            ..self.setpoint
        };
        let plan = self
            .planner
            .move_to(self.config.profile, &start, target, limits, before)
            .ok()?;
        let lock = u64::from(plan.scans());
        Some(Way {
            motion: closing(plan),
            rung: Rung::BesideLine {
                start: Place {
                    position: 0.0,
                    ..here
                },
                velocity: 0.0,
                begin: 0,
            },
            lock,
            left: u64::MAX,
            name: Approach::Stretch,
            velocity: 0.0,
            limits: *limits,
        })
    }

    /// Onto a stretch of constant velocity.
    fn onto(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        stretch: &Stretch,
        limits: &Limits,
        before: &Limits,
    ) -> Option<Way<P::Plan>> {
        if stretch.velocity.abs() > limits.velocity {
            return None;
        }
        let coupling = self.coupling.as_ref()?;
        let is_syncing = coupling.is_syncing();
        if is_syncing && matches!(view.future.course, Course::Still) {
            return self.onto_rest(view, limits, before);
        }
        let (motion, rung, limits) = if coupling.anchor.is_none() {
            let (motion, limits) = self.to_velocity(owner, stretch.velocity).ok()?;
            (motion, Rung::Own, limits)
        } else {
            let here = self.place();
            let start = self.beside_stretch(stretch);
            let line = stretch.velocity.abs();
            // Ahead of the line the slave lets it come, and does not go to meet it.
            let waits = is_syncing
                && line != 0.0
                && self
                    .stop_ahead(&start, stretch.velocity, limits)
                    .is_some_and(|ahead| ahead > 0.0);
            let room = |limits: &Limits| if waits { line } else { limits.velocity - line };
            if room(limits) <= LEAST * limits.velocity {
                return None;
            }
            let (plan, limits) = self.beside_line(&start, stretch.velocity, room, limits, before)?;
            let rung = Rung::BesideLine {
                start: Place {
                    position: stretch.now,
                    ..here
                },
                velocity: stretch.velocity,
                begin: stretch.begin,
            };
            (closing(plan), rung, limits)
        };
        let arrives = scans_of(&motion).max(stretch.begin);
        let is_in_time = arrives <= stretch.end;
        Some(Way {
            motion,
            rung,
            lock: if is_in_time { arrives } else { u64::MAX },
            left: stretch.end,
            name: Approach::Stretch,
            velocity: stretch.velocity,
            limits,
        })
    }

    /// A plan to 0 beside a line of this `velocity` (u/s), no faster than there is `room` beside it, and the limits it has: the command's, or higher ones where those do
    /// not keep the axis inside its own; none where these do not either.
    fn beside_line(
        &self,
        start: &Setpoint,
        velocity: f64,
        room: impl Fn(&Limits) -> f64,
        limits: &Limits,
        before: &Limits,
    ) -> Option<(P::Plan, Limits)> {
        // Speed that falls beside a line may be speed that grows: the lower rate holds both ways.
        let beside = |limits: &Limits, velocity: f64| {
            let lower = limits.lower_acceleration();
            Limits {
                velocity,
                acceleration: lower,
                deceleration: lower,
                ..*limits
            }
        };
        let axis = &self.config.limits;
        let steady = Setpoint {
            velocity,
            ..Setpoint::at_rest(0.0)
        };
        let line = self.planner.ramp_to(&steady, velocity, axis, axis).ok()?;
        [*limits]
            .into_iter()
            .chain(self.higher(limits, before))
            .find_map(|limits| {
                let own = beside(&limits, room(&limits));
                let wider = before.or_larger(&limits);
                let wider = beside(&wider, wider.velocity + velocity.abs());
                let plan = self
                    .planner
                    .move_to(MoveProfile::Online, start, 0.0, &own, &wider)
                    .ok()?;
                let both = Some((&plan, 0));
                self.planner
                    .fits_behind((&line, 0), 1.0, &self.setpoint, both, axis)
                    .then_some((plan, limits))
            })
    }

    /// Beside the law: the difference comes to 0, or before the slave was in gear its velocity does.
    fn beside_law(
        &self,
        view: &View<'_, P::Plan>,
        anchor: Anchor,
        difference: &Setpoint,
        line: f64,
        limits: &Limits,
    ) -> Option<Way<P::Plan>> {
        if difference.is_at_rest() && difference.position == 0.0 {
            return None;
        }
        let coupling = self.coupling.as_ref()?;
        let factor = coupling.factor(&view.future);
        // The step of a plan that ended in this scan can't be looked at any more.
        let (plan, from, 0) = view.future.plan()? else {
            return None;
        };
        let to_place = coupling.anchor.is_some();
        let is_syncing = coupling.is_syncing();
        // On its way to a sync point the slave goes against the line no faster than it does already.
        let turns = |beside: &P::Plan| {
            let found = self.planner.velocities_behind((plan, from), factor, (beside, 0));
            let (against, start) = match found {
                Some((lowest, _)) if line > 0.0 => (-lowest, -self.setpoint.velocity),
                Some((_, highest)) if line < 0.0 => (highest, self.setpoint.velocity),
                _ => return found.is_none(),
            };
            against > start.max(0.0) + ROUNDING * limits.velocity
        };
        let attempt = |own: &Limits| {
            let planned = if to_place {
                self.planner
                    .move_to(MoveProfile::Online, difference, 0.0, own, own)
            } else {
                self.planner.ramp_to(difference, 0.0, own, own)
            };
            let planned = planned.ok().filter(|beside| {
                let beside = Some((beside, 0));
                self.planner
                    .fits_behind((plan, from), factor, &self.setpoint, beside, limits)
            });
            planned.filter(|beside| !(is_syncing && turns(beside)))
        };
        let asked = attempt(limits);
        let planned = match asked {
            Some(planned) => planned,
            None => attempt(&self.room_beside((plan, from), factor, limits)?)?,
        };
        let lock = u64::from(planned.scans());
        Some(Way {
            motion: closing(planned),
            rung: Rung::BesideLaw(anchor),
            lock,
            left: u64::MAX,
            name: Approach::Difference,
            velocity: difference.velocity,
            limits: *limits,
        })
    }

    /// What the law leaves of `limits` whatever is added when; none where it leaves nothing.
    pub(super) fn room_beside(&self, rest: (&P::Plan, u64), factor: f64, limits: &Limits) -> Option<Limits> {
        let factor = factor.abs();
        if factor == 0.0 {
            return None;
        }
        let scaled = |limits: &Limits, by: f64| Limits {
            velocity: limits.velocity * by,
            acceleration: limits.acceleration * by,
            deceleration: limits.deceleration * by,
            jerk: limits.jerk * by,
            snap: limits.snap * by,
        };
        let room = scaled(&self.planner.room(rest, &scaled(limits, 1.0 / factor)), factor);
        let least = room
            .velocity
            .min(room.acceleration)
            .min(room.deceleration)
            .min(room.jerk)
            .min(room.snap);
        (least > 0.0).then_some(room)
    }

    /// As fast as it may, the way the law leads.
    ///
    /// # Errors
    /// Why it may not go there.
    fn at_pace(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        velocity: f64,
    ) -> Result<Way<P::Plan>, ErrorId> {
        let most = self.limits_of_approach(owner).velocity;
        let goal = if velocity < 0.0 { -most } else { most };
        let (motion, limits) = self.to_velocity(owner, goal)?;
        let left = match view.future.plan() {
            Some((plan, from, late)) => {
                let switch = self.planner.next_switch((plan, from));
                let scans = switch.saturating_sub(from).saturating_add(late);
                if switch > from { scans } else { u64::MAX }
            }
            None => UNKNOWN,
        };
        Ok(Way {
            motion,
            rung: Rung::Own,
            lock: u64::MAX,
            left,
            name: Approach::Pace,
            velocity: goal,
            limits,
        })
    }

    /// A ramp in the slave's own coordinates, planned as MC_MoveVelocity's is, and the limits in force along it.
    ///
    /// # Errors
    /// Why it may not go there.
    fn to_velocity(&self, owner: &Entry, velocity: f64) -> Result<(Motion<P::Plan>, Limits), ErrorId> {
        let limits = self.limits_of_approach(owner);
        let mut entry = Entry {
            work: Work::Velocity {
                velocity,
                along: false,
            },
            limits,
            paused: false,
            end: None,
            turns: 0,
            ..*owner
        };
        let before = self.limits_before(&limits);
        let motion = self.plan_from(&entry, &self.setpoint, &before)?;
        let motion = self.kept_inside(&mut entry, motion, &self.setpoint, &before)?;
        let limits = Self::limits_of(&entry.limits, &motion);
        Ok((motion, limits))
    }

    /// From now on along `way`; the motion before was within `before`.
    fn take_way(&mut self, way: Way<P::Plan>, before: Limits, scope: &mut Scope<'_>) {
        let scans = scans_of(&way.motion);
        self.before = before;
        let limits = way.limits;
        self.in_force = limits;
        self.motion = way.motion;
        self.arrival = Arrival::default();
        self.replan_due = false;
        if self.modulo.is_some() {
            self.start_of_plan();
        }
        self.watched = self.owner.is_some_and(|owner| self.needs_watching(&owner));
        let told = Some((way.name, way.velocity));
        let mut is_told = false;
        if let Some(coupling) = &mut self.coupling {
            coupling.rung = way.rung;
            coupling.left = way.left;
            is_told = coupling.told == told;
            coupling.told = told;
        }
        self.stir();
        // The same way looked for again is no news.
        if !is_told {
            let event = Event::Approaching {
                way: way.name,
                velocity: way.velocity,
                scans: u32::try_from(scans).unwrap_or(u32::MAX),
            };
            self.record(event, &mut self.owner_scope(scope));
            if let Some(owner) = &self.owner {
                let asked = self.limits_of_approach(owner);
                self.record_raised(&asked, &limits, &mut self.owner_scope(scope));
            }
        }
    }

    /// No way leads on. What MC_Power or a limit switch bars waits to be permitted.
    fn stay_back(&mut self, error: ErrorId, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if let Some(coupling) = &mut self.coupling {
            coupling.rung = Rung::Due;
            coupling.left = u64::MAX;
        }
        match error {
            ErrorId::PositiveBarred | ErrorId::NegativeBarred | ErrorId::OutwardFromLimitSwitch => {
                self.pause(error, scope);
                if !self.is_coupled() {
                    // One that no block follows has become a halt.
                    self.advance(scope);
                }
            }
            ErrorId::OutwardFromSoftwareLimit => self.fail(ErrorId::SoftwareLimitReached, scope),
            ErrorId::MasterTooFast => self.give_up(view, scope),
            other => self.fail(other, scope),
        }
    }

    /// The owner can't come to its sync point: it fails, and the slave comes to rest.
    #[cold]
    fn give_up(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(owner) = self.owner else { return };
        let (velocity, speed) = (self.limits_of_approach(&owner).velocity, self.law_speed(view));
        let scope = &mut self.owner_scope(scope);
        self.refuse("Velocity", velocity, speed, ErrorId::MasterTooFast, scope);
        self.end_owner(Fate::Failed(ErrorId::MasterTooFast));
        self.lose_heir(owner.id, scope);
        let stopped = Entry {
            limits: self.stop_limits(),
            ..owner
        };
        self.halt_after(&stopped, scope);
        self.advance(scope);
    }

    /// What the law asks for beyond the limits in the master's plan: its name, the value and the limit.
    fn reason(&self, view: &View<'_, P::Plan>) -> Option<Beyond> {
        let coupling = self.coupling.as_ref()?;
        let factor = coupling.factor(&view.future).abs();
        let (plan, from, _) = view.future.plan()?;
        let peaks = self.planner.peaks((plan, from))?;
        let limits = &coupling.limits;
        let told = [
            ("velocity", peaks.velocity, limits.velocity),
            ("acceleration", peaks.acceleration, limits.lower_acceleration()),
            ("jerk", peaks.jerk, limits.jerk),
            ("snap", peaks.snap, limits.snap),
        ];
        let told = told.map(|(what, peak, limit)| (what, factor * peak, limit));
        told.into_iter()
            .find(|(_, value, limit)| *value > limit * (1.0 + 1e-9))
    }
}

fn closing<Q: Plan>(plan: Q) -> Motion<Q> {
    Motion::Closing {
        plan,
        elapsed: 0,
        scans: u64::from(plan.scans()),
    }
}

fn scans_of<Q>(motion: &Motion<Q>) -> u64 {
    match motion {
        Motion::Run { scans, .. } | Motion::Closing { scans, .. } => *scans,
        _ => 0,
    }
}
