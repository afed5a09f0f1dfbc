//! How a slave gets onto the law of its gear. The way is searched each time the master gets another plan or a way has
//! ended.
//!
//! | rung | the slave moves | in gear |
//! | --- | --- | --- |
//! | in gear | on the law | at once, if it is on the law and the law keeps its limits as far as is known |
//! | beside the law | on the law plus a plan that takes its difference to 0; the sum keeps the limits | at the end of the plan |
//! | onto a stretch | to the velocity of the law in its next stretch of constant velocity | at the end of the plan, or where the stretch begins |
//! | pace | as fast as possible, in the direction of the law; along the law as long as that is slower | not yet |
//!
//! Of the first three, the one that is in gear soonest is used. The last two always exist, so a slave always has a
//! plan. Before the slave was in gear, only the velocity counts, and lost distance is not made up. After that it
//! catches up with the same law.

use super::super::commands::ROUNDING;
use super::super::commands::{Entry, Work};
use super::super::supervision::Arrival;
use super::super::{Axis, Motion};
use super::follow::{Beyond, off};
use super::needs::RESOLVED;
use super::view::{Kind, UNKNOWN, View, anchor_at, way_to_rest};
use super::{Coupling, Rung};
use crate::{Approach, ErrorId, Event, Fate, Scope};
use standstill_planner::{
    Anchor, CamBounds, DirectedLimits, Excess, Lead, Leads, Limits, MoveProfile, Place, Plan, Planner,
    Setpoint,
};

/// The room for a velocity relative to a line must be more than this share of the limit.
const LEAST: f64 = 1e-6;

/// The share of its velocity limit up to which a slave approaches a law that will be too fast.
const SLOW: f64 = 0.9;

/// The number of points on a way back at which its velocity is checked.
const LOOKS: u64 = 16;

/// The law's next stretch of constant velocity.
#[derive(Clone, Copy)]
struct Stretch {
    /// Scans until it begins and until it ends; the end is the largest number if there is none.
    begin: u64,
    end: u64,
    /// Velocity of the law on it (u/s).
    velocity: f64,
    /// The present position of a line of that velocity through it (u), in the slave's turn.
    now: f64,
}

/// The speeds (u/s) that a slave may have relative to a line: in the direction of the line, and against it.
#[derive(Clone, Copy)]
struct Room {
    along: f64,
    against: f64,
}

/// A way onto the law: a plan, and the scan in which the slave is in gear.
pub(super) struct Way<Plan> {
    motion: Motion<Plan>,
    rung: Rung,
    /// Scans until in gear; the largest number if this way does not lead there.
    lock: u64,
    /// Scans until the way is searched again.
    left: u64,
    name: Approach,
    velocity: f64,
    /// Limits in force along it.
    limits: Limits,
}

impl<Plan> Way<Plan> {
    /// Scans until in gear, if this way leads there.
    pub(super) fn scans_to_lock(&self) -> Option<u64> {
        (self.lock != u64::MAX).then_some(self.lock)
    }
}

impl<P: Planner> Axis<P> {
    /// Finds the way onto the law, from the state at the end of the last scan. The slave is in gear at once only if
    /// it `may_lock`.
    pub(super) fn approach(&mut self, view: &View<'_, P::Plan>, may_lock: bool, scope: &mut Scope<'_>) {
        let (Some(coupling), Some(owner)) = (&self.follower.coupling, self.owner) else {
            return;
        };
        let was_locked = coupling.rung.is_locked();
        let here = anchor_at(&coupling.was, self.place());
        let anchor = coupling.anchor.unwrap_or(here);
        let (law_place, law) = coupling.law(&anchor, &coupling.was);
        let difference = self.difference(coupling, &anchor);
        // A turn may have changed its masters' positions by a rounding error.
        let is_kept = was_locked && difference.position.abs() <= self.resolved_of(coupling, law_place);
        if difference.is_at_rest() && (difference.position == 0.0 || is_kept) {
            // A step off the law may not have been checked against a plan of the master that has ended since.
            let was_on_law = coupling.anchor.is_some();
            let is_seen = match view.future.kind() {
                Kind::Still => law.is_at_rest(),
                Kind::Plan => !view.future.is_late(),
                Kind::Unknown | Kind::Measured | Kind::NotSeen => true,
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
                if way.name == Approach::Pace {
                    let near = self.near_law(&owner, view, anchor, &difference, may_lock);
                    way = near.unwrap_or(way);
                }
                if let Some(error) = self.begins_barred(&way, view) {
                    return self.stay_back(error, view, scope);
                }
                if view.future.is_late() {
                    way.left = 0;
                }
                let told = self
                    .follower
                    .coupling
                    .as_mut()
                    .and_then(|coupling| coupling.told.as_mut());
                // Ways that are searched again after some scans differ each time.
                let is_passing = view.future.unforeseen().is_some() || way.left == UNKNOWN;
                if let (Some((name, velocity)), true) = (told, is_passing)
                    && *name == way.name
                {
                    *velocity = way.velocity;
                }
                self.take_way(way, before, scope);
            }
            Err(error) => self.stay_back(error, view, scope),
        }
    }

    /// The reason why the first step of a way from rest beside the law is barred.
    fn begins_barred(&self, way: &Way<P::Plan>, view: &View<'_, P::Plan>) -> Option<ErrorId> {
        if !self.bars_any() || !self.mover.setpoint().is_at_rest() {
            return None;
        }
        let (Motion::Closing { plan, .. }, Some(coupling)) = (&way.motion, &self.follower.coupling) else {
            return None;
        };
        let frame = match way.rung {
            Rung::BesideLine { velocity, .. } => velocity,
            Rung::BesideLaw(anchor) | Rung::BesideMeasured { anchor, .. } => {
                coupling.law(&anchor, &view.seen()).1.velocity
            }
            _ => return None,
        };
        self.way_barred(frame + plan.at(1).velocity)
    }

    /// The smallest difference (u) from the law, which is at `law` now, that rounding does not hide.
    pub(super) fn resolved_of(&self, coupling: &Coupling, law: Place) -> f64 {
        let length = self.config.modulo.unwrap_or(0.0);
        let masters = coupling.size_of_masters(&coupling.was);
        RESOLVED * 4.0 * (self.place().position.abs() + law.position.abs() + masters + length)
    }

    /// The difference of the slave from the law through `anchor` at the end of the last scan.
    pub(super) fn difference(&self, coupling: &Coupling, anchor: &Anchor) -> Setpoint {
        let (place, law) = coupling.law(anchor, &coupling.was);
        let length = self.config.modulo.unwrap_or(0.0);
        Setpoint {
            position: off(self.place(), place, length),
            velocity: self.mover.setpoint().velocity - law.velocity,
            acceleration: self.mover.setpoint().acceleration - law.acceleration,
            jerk: self.mover.setpoint().jerk - law.jerk,
            snap: 0.0,
        }
    }

    /// The way onto the law through `anchor` that is in gear soonest, starting at the end of the last
    /// scan.
    ///
    /// # Errors
    /// The reason why there is none: the direction is barred, or before the first sync the master is too fast.
    pub(super) fn way_onto(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        anchor: Anchor,
        difference: &Setpoint,
    ) -> Result<Way<P::Plan>, ErrorId> {
        let Some(coupling) = &self.follower.coupling else {
            return Err(ErrorId::PlanRefused);
        };
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let (place, law) = coupling.law(&anchor, &coupling.was);
        let (place_now, law_now) = coupling.law(&anchor, &view.seen());
        let step = off(place_now, place, length);
        let stretch = self.next_stretch(view, here.position - difference.position, step);
        let mut limits = self.limits_of_approach(owner);
        let before = self.limits_before(&limits);
        if self.gets_too_fast(&limits, &before) {
            limits = self
                .slowed(&self.parameters.limits)
                .with_velocity(limits.velocity);
        }
        let velocity = stretch.map_or(law.velocity, |stretch| stretch.velocity);
        // If the master's motion is not known, the slave may have to make up lost distance.
        if let (true, Some(stretch), Kind::Plan) = (coupling.is_syncing(), &stretch, view.future.kind()) {
            if coupling.goes_slowly() && velocity != 0.0 {
                limits.velocity = limits.velocity.min(velocity.abs());
            }
            self.is_in_reach(stretch, &limits)?;
        }
        let mut onto = stretch.and_then(|stretch| self.onto(owner, view, &stretch, &limits, &before));
        let mut soonest = onto.as_ref().map_or(u64::MAX, |way| way.lock);
        if let (Some(way), Some(scans)) = (&mut onto, view.future.unforeseen()) {
            // The line is a good estimate that only leads near the law. The last part of the way is beside the law. A
            // slave that waits for its sync point waits at rest beside the line, because the law itself may jitter.
            (way.lock, way.left) = (way.motion.scans(), scans);
            let near = 2 * scans;
            let is_ahead = difference.position * velocity > 0.0;
            let waits = coupling.waits_ahead() && is_ahead && way.lock > near;
            // A law with constant velocity now may be the line itself. Measured values are never quite constant.
            let is_even = law_now.acceleration == 0.0 && law_now.jerk == 0.0;
            let is_line = is_even && view.future.measured().is_none();
            soonest = match (waits, is_line) {
                (true, _) => 0,
                (false, true) => way.lock,
                (false, false) => way.lock.saturating_add(near),
            };
        }
        let beside = self
            .beside_law(view, anchor, difference, velocity, &limits)
            .filter(|way| way.lock < soonest);
        if beside.is_none() && self.lets_law_come(view, difference, velocity) {
            let waits = self.to_pace(owner, 0.0)?;
            return Ok(Way {
                left: UNKNOWN,
                ..waits
            });
        }
        match beside.or(onto) {
            Some(way) => Ok(way),
            None => self.at_pace(owner, view, limits.velocity, velocity),
        }
    }

    /// Whether the slave, braking within `limits`, would exceed its own velocity limit before its
    /// acceleration is 0. Cost: one ramp.
    fn gets_too_fast(&self, limits: &Limits, before: &Limits) -> bool {
        let most = self.parameters.limits.velocity * (1.0 + ROUNDING);
        let stop = self.planner.ramp_to(self.mover.setpoint(), 0.0, limits, before);
        let peaks = stop.ok().and_then(|stop| self.planner.peaks((&stop, 0)));
        peaks.is_some_and(|peaks| peaks.velocity > most)
    }

    /// The limits of the owner until it is on the law.
    pub(super) fn limits_of_approach(&self, owner: &Entry) -> Limits {
        let (asked, axis) = (&owner.limits, &self.slowed(&self.parameters.limits));
        // The Velocity of MC_GearInPos applies until its sync point.
        let is_synced = |coupling: &Coupling| coupling.gearing.sync.is_some() && coupling.was_in_gear;
        let velocity = if self.coupling().is_some_and(is_synced) {
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

    /// The stretch of the law that the slave is led onto. The law was at `on_law` (u), in the slave's
    /// turn, and has moved by `step` (u) in this scan.
    fn next_stretch(&self, view: &View<'_, P::Plan>, on_law: f64, step: f64) -> Option<Stretch> {
        let coupling = self.coupling()?;
        let cycle = self.planner.cycle();
        if coupling.stands(&view.future) || view.future.kind() == Kind::Still {
            return Some(Stretch {
                begin: 0,
                end: u64::MAX,
                velocity: 0.0,
                now: on_law + step,
            });
        }
        let velocity = coupling
            .gearing
            .derivative(view.seen().map(|seen| seen.at.velocity));
        let unknown = Stretch {
            begin: 0,
            end: UNKNOWN,
            velocity,
            now: on_law + (step - velocity * cycle),
        };
        let Some(leads) = coupling.leads(&view.future) else {
            return Some(unknown);
        };
        let Some((begin, end)) = self.planner.stretch(&leads) else {
            return Some(unknown);
        };
        let late = u64::from(view.future.is_late());
        // The sum of all plans at their ends, each with its gear ratio.
        let sum = |of: &dyn Fn(&Lead<'_, P::Plan>) -> f64| {
            let [first, second] = &leads;
            let [first_part, second_part] = &view.future.parts;
            let of_lead = |lead: &Option<Lead<'_, P::Plan>>| lead.as_ref().map_or(0.0, of);
            coupling.gearing.derivative([
                of_lead(first) * first_part.factor,
                of_lead(second) * second_part.factor,
            ])
        };
        let velocity = sum(&|lead| lead.plan.at(lead.elapsed.saturating_add(begin)).velocity);
        // The distance by which the law gets ahead of the line until then.
        let way = leads.iter().flatten().map(|lead| {
            let at = |scan| lead.plan.at(scan).position;
            lead.factor * (at(lead.elapsed.saturating_add(begin)) - at(lead.elapsed))
        });
        let way = way.fold(0.0, |sum, way| sum + way);
        let way = if late > 0 { way + step } else { way };
        let begin = begin.saturating_add(late);
        Some(Stretch {
            begin,
            end: end.saturating_add(late),
            velocity,
            now: on_law + (way - velocity * (begin as f64 * cycle)),
        })
    }

    /// The speed of the law in its next stretch (u/s).
    pub(super) fn law_speed(&self, view: &View<'_, P::Plan>) -> f64 {
        let stretch = self.next_stretch(view, 0.0, 0.0);
        stretch.map_or(0.0, |stretch| stretch.velocity.abs())
    }

    /// The position where a stop beside a line of this `velocity` (u/s) ends (u), positive if ahead of the line.
    /// `start` is the state beside the line.
    fn stop_ahead(&self, start: &Setpoint, velocity: f64, limits: &Limits) -> Option<f64> {
        let lower = limits.lower_acceleration();
        let widest = Limits {
            velocity: limits.velocity + velocity.abs() + start.velocity.abs(),
            acceleration: lower,
            deceleration: lower,
            ..*limits
        };
        let stop = self.planner.ramp_to(start, 0.0, &widest, &widest).ok()?;
        Some(1.0_f64.copysign(velocity) * stop.end().position)
    }

    /// Checks that the slave can get onto a stretch within the velocity of `limits`.
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
            // A slave as fast as the line can wait for it, but cannot catch up.
            let ahead = self.stop_ahead(&self.beside_stretch(stretch), stretch.velocity, limits);
            let resolved = RESOLVED * 4.0 * (stretch.now.abs() + self.mover.setpoint().position.abs());
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
            velocity: self.mover.setpoint().velocity - stretch.velocity,
            ..*self.mover.setpoint()
        }
    }

    /// Onto a law at rest, planned like MC_MoveAbsolute to the place of the law.
    fn onto_rest(&self, view: &View<'_, P::Plan>, limits: &Limits, before: &Limits) -> Option<Way<P::Plan>> {
        let coupling = self.coupling()?;
        let anchor = coupling.anchor?;
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let (law, _) = coupling.law(&anchor, &view.seen());
        let target = (law.turns.wrapping_sub(here.turns)) as f64 * length + law.position;
        let start = self.mover.setpoint().moved_to(here.position);
        let (plan, limits) = self.moved_inside(&start, target, *limits, before).ok()?;
        let lock = u64::from(plan.scans());
        Some(Way {
            motion: Motion::closing(plan),
            rung: Rung::BesideLine {
                start: here.moved_to(0.0),
                velocity: 0.0,
                begin: 0,
            },
            lock,
            left: u64::MAX,
            name: Approach::Stretch,
            velocity: 0.0,
            limits,
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
        let coupling = self.coupling()?;
        let is_syncing = coupling.is_syncing();
        if is_syncing && view.future.kind() == Kind::Still {
            return self.onto_rest(view, limits, before);
        }
        let (motion, rung, limits) = if coupling.anchor.is_none() {
            let (motion, limits) = self.to_velocity(owner, stretch.velocity).ok()?;
            (motion, Rung::Own, limits)
        } else {
            let here = self.place();
            let start = self.beside_stretch(stretch);
            let line = stretch.velocity.abs();
            let is_ahead = line > LEAST * limits.velocity
                && self
                    .stop_ahead(&start, stretch.velocity, limits)
                    .is_some_and(|ahead| ahead > 0.0);
            let track = self.line(stretch.velocity)?;
            // A slave ahead of the line waits for it, or moves back to meet it. In the second case it may be faster
            // against the line than with it.
            let attempt = |waits: bool| {
                let along = |limits: &Limits| if waits { line } else { limits.velocity - line };
                if along(limits) <= LEAST * limits.velocity {
                    return None;
                }
                let room = |limits: &Limits| Room {
                    along: along(limits),
                    against: if is_ahead && !waits {
                        limits.velocity + line
                    } else {
                        along(limits)
                    },
                };
                self.beside_line(&start, (&track, stretch.velocity), room, limits, before)
            };
            let met = (is_ahead && is_syncing && coupling.goes_back)
                .then(|| attempt(false))
                .flatten()
                .filter(|(plan, _)| self.may_go_back(stretch.velocity, plan));
            let (plan, limits) = match met {
                Some(met) => met,
                None => attempt(is_ahead && is_syncing)?,
            };
            let rung = Rung::BesideLine {
                start: here,
                velocity: stretch.velocity,
                begin: stretch.begin,
            };
            (Motion::closing(plan), rung, limits)
        };
        let arrives = motion.scans().max(stretch.begin);
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

    /// A motion at this constant `velocity` (u/s) from 0.
    fn line(&self, velocity: f64) -> Option<P::Plan> {
        let axis = &self.slowed(&self.config.limits);
        let steady = Setpoint::at_velocity(0.0, velocity);
        self.planner.ramp_to(&steady, velocity, axis, axis).ok()
    }

    /// Whether a motion `beside` a line of this `velocity` (u/s) may move against it: that direction is not barred,
    /// and the slave reverses inside its software limits.
    fn may_go_back(&self, velocity: f64, beside: &P::Plan) -> bool {
        let heading = 1.0_f64.copysign(velocity);
        let cycle = self.planner.cycle();
        let speed = |scan: u64| heading * (velocity + beside.at(scan).velocity);
        let scans = u64::from(beside.scans());
        let looks = (0..=LOOKS).map(|look| scans * look / LOOKS);
        let back = looks.min_by(|one, other| speed(*one).total_cmp(&speed(*other)));
        // From there it returns to the velocity of the line.
        let (mut low, mut high) = (back.unwrap_or(0), scans);
        while high - low > 1 {
            let middle = low + (high - low) / 2;
            if speed(middle) < 0.0 {
                low = middle;
            } else {
                high = middle;
            }
        }
        let way = velocity * (low as f64 * cycle) + beside.at(low).position;
        // The distance that it may still move back within a scan.
        let in_scan = heading * self.parameters.limits.lower_acceleration() * cycle * cycle;
        let place = self.mover.setpoint().position + way - in_scan;
        self.allowed(place).is_ok() && self.way_barred(-velocity).is_none()
    }

    /// A plan onto a `line` of this `velocity` (u/s) from the state `start` beside it, within the speeds of `room`.
    /// Returns the plan with its limits: those of the command, or higher ones if these could not keep the axis inside
    /// its own; none if these do not suffice either. Positions are relative to a line through the slave's place,
    /// because far from 0 numbers are coarse.
    fn beside_line(
        &self,
        start: &Setpoint,
        (line, velocity): (&P::Plan, f64),
        room: impl Fn(&Limits) -> Room,
        limits: &Limits,
        before: &Limits,
    ) -> Option<(P::Plan, Limits)> {
        // A decreasing speed beside a line may be an increasing speed of the slave, so the lower rate applies in both
        // directions.
        let beside = |limits: &Limits, velocity: f64| {
            let lower = limits.lower_acceleration();
            Limits {
                velocity,
                acceleration: lower,
                deceleration: lower,
                ..*limits
            }
        };
        let from = start.at_origin();
        let axis = &self.slowed(&self.config.limits);
        let line = [Some(Lead::whole(line)), None];
        [*limits]
            .into_iter()
            .chain(self.higher(limits, before, axis))
            .find_map(|limits| {
                let Room { along, against } = room(&limits);
                let wider = before.or_larger(&limits);
                let wider = beside(&wider, wider.velocity + velocity.abs()).into();
                let plan = |against| {
                    let own = directed(velocity, (along, against), beside(&limits, limits.velocity));
                    self.planner
                        .move_by_direction(&from, -start.position, &own, &wider)
                        .ok()
                };
                let first = plan(along)?;
                // More room against the line helps only if all of the other room is used.
                let uses_all = |peaks: Setpoint| peaks.velocity >= along * (1.0 - LEAST);
                let plan = if against > along && self.planner.peaks((&first, 0)).is_some_and(uses_all) {
                    plan(against)?
                } else {
                    first
                };
                let both = Some((&plan, 0));
                self.planner
                    .fits_behind(&line, self.mover.setpoint(), both, axis)
                    .then_some((plan, limits))
            })
    }

    /// Beside the law: brings the difference to 0, or its velocity only before the slave was in gear.
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
        if view.future.unforeseen().is_some() {
            return self.beside_measured(view, anchor, difference, line, limits);
        }
        let coupling = self.coupling()?;
        // The step of a plan that ended in this scan can no longer be checked.
        let leads = coupling.leads(&view.future).filter(|_| !view.future.is_late())?;
        let to_place = coupling.anchor.is_some();
        let is_syncing = coupling.is_syncing();
        // Until its sync point the slave moves no faster against the law than it already does.
        let heading = heading(&leads, line);
        let may_turn = !is_syncing
            || (coupling.goes_back
                && self.parameters.software_limits.is_none()
                && self.way_barred(-heading).is_none());
        let turns = |beside: &P::Plan| {
            let found = self.planner.velocities_behind(&leads, (beside, 0));
            let (against, start) = match found {
                Some((lowest, _)) if heading > 0.0 => (-lowest, -self.mover.setpoint().velocity),
                Some((_, highest)) if heading < 0.0 => (highest, self.mover.setpoint().velocity),
                _ => return found.is_none(),
            };
            against > start.max(0.0) + ROUNDING * limits.velocity
        };
        let attempt = |own: &Limits| {
            let planned = self.closing(difference, own, to_place).filter(|beside| {
                let beside = Some((beside, 0));
                self.planner
                    .fits_behind(&leads, self.mover.setpoint(), beside, limits)
            });
            planned.filter(|beside| may_turn || !turns(beside))
        };
        let asked = attempt(limits);
        let planned = match asked {
            Some(planned) => planned,
            None => attempt(&self.room_beside(&leads, limits)?)?,
        };
        let lock = u64::from(planned.scans());
        Some(Way {
            motion: Motion::closing(planned),
            rung: Rung::BesideLaw(anchor),
            lock,
            left: u64::MAX,
            name: Approach::Difference,
            velocity: difference.velocity,
            limits: *limits,
        })
    }

    /// The same beside a law whose future motion is not known, with half of the limits that it leaves now. Each step
    /// is checked before it is made. There is no such way again if the half was not enough in this step.
    fn beside_measured(
        &self,
        view: &View<'_, P::Plan>,
        anchor: Anchor,
        difference: &Setpoint,
        line: f64,
        limits: &Limits,
    ) -> Option<Way<P::Plan>> {
        let coupling = self.coupling()?;
        if matches!(coupling.rung, Rung::BesideMeasured { .. }) || !self.is_told_finely(view) {
            return None;
        }
        let mut room = self.room_now(view, limits)?;
        // A slave that is ahead of its sync point waits, and does not move back to meet the law.
        if coupling.waits_ahead() && difference.position * line > 0.0 {
            room.velocity = room.velocity.min(line.abs());
        }
        let planned = self.within_room(difference, &room, coupling.anchor.is_some())?;
        Some(Way {
            motion: Motion::closing(planned),
            rung: Rung::BesideMeasured { anchor, room },
            lock: u64::from(planned.scans()),
            left: u64::MAX,
            name: Approach::Difference,
            velocity: difference.velocity,
            limits: *limits,
        })
    }

    /// A way that does not get ahead of a law that will be too fast. While the law is well within the limits, the
    /// slave moves along it if it `may_follow` it in this step. Otherwise it takes the law's velocity or, from
    /// behind, a higher one.
    fn near_law(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        anchor: Anchor,
        difference: &Setpoint,
        may_follow: bool,
    ) -> Option<Way<P::Plan>> {
        let coupling = self.coupling()?;
        if coupling.anchor.is_none() || coupling.is_syncing() || view.future.kind() != Kind::Plan {
            return None;
        }
        let (place, _) = coupling.law(&anchor, &coupling.was);
        let is_there =
            difference.is_at_rest() && difference.position.abs() <= self.resolved_of(coupling, place);
        if may_follow && is_there {
            return self.along_law(anchor, &Setpoint::default(), coupling.limits, None);
        }
        let limits = self.limits_of_approach(owner);
        let (_, law) = coupling.law(&anchor, &view.seen());
        let velocity = self.planner.coasting(&law, &limits);
        let is_slow = velocity.abs() < SLOW * limits.velocity
            && law.acceleration.abs() < 0.5 * limits.lower_acceleration();
        if !is_slow {
            return None;
        }
        let room = may_follow.then(|| half_left(&law, &limits)).flatten();
        let along = room.and_then(|room| self.along_law(anchor, difference, limits, Some(room)));
        if along.is_some() {
            return along;
        }
        let is_behind = difference.position * velocity < 0.0;
        let goal = if is_behind {
            limits.velocity.copysign(velocity)
        } else {
            velocity
        };
        let way = self.to_pace(owner, goal).ok()?;
        Some(Way { left: UNKNOWN, ..way })
    }

    /// A way along a law that will be too fast later: from beside it within this `room`, or on the law without a
    /// room. Each step is checked before it is made.
    fn along_law(
        &self,
        anchor: Anchor,
        difference: &Setpoint,
        limits: Limits,
        room: Option<Limits>,
    ) -> Option<Way<P::Plan>> {
        let plan = self.within_room(difference, &room.unwrap_or(limits), true)?;
        Some(Way {
            motion: Motion::closing(plan),
            rung: Rung::BesideMeasured {
                anchor,
                room: room.unwrap_or(limits.times(0.0)),
            },
            lock: u64::MAX,
            left: u64::MAX,
            name: Approach::Difference,
            velocity: difference.velocity,
            limits,
        })
    }

    /// A plan within this `room` that takes a difference to 0, or only its velocity.
    pub(super) fn within_room(
        &self,
        difference: &Setpoint,
        room: &Limits,
        to_place: bool,
    ) -> Option<P::Plan> {
        // Outside the room its motion between two scans would be unknown.
        let leaves = |excess: Excess| excess.acceleration > 0.0 || excess.jerk > 0.0;
        self.closing(difference, room, to_place)
            .filter(|plan| !plan.excess().is_some_and(leaves))
    }

    /// A plan within `limits` that takes a difference to 0, or only its velocity.
    pub(super) fn closing(&self, difference: &Setpoint, limits: &Limits, to_place: bool) -> Option<P::Plan> {
        let planned = if to_place {
            let profile = MoveProfile::Online;
            self.planner.move_to(profile, difference, 0.0, limits, limits)
        } else {
            self.planner.ramp_to(difference, 0.0, limits, limits)
        };
        planned.ok()
    }

    /// Half of the limits that the law leaves of `limits` in this scan; none if it leaves nothing.
    pub(in crate::axis) fn room_now(&self, view: &View<'_, P::Plan>, limits: &Limits) -> Option<Limits> {
        let coupling = self.coupling()?;
        let (_, law) = coupling.law(&coupling.anchor.unwrap_or_default(), &view.seen());
        half_left(&law, limits)
    }

    /// The part of `limits` that the law leaves at any time; none if it leaves nothing.
    pub(in crate::axis) fn room_beside(&self, leads: &Leads<'_, P::Plan>, limits: &Limits) -> Option<Limits> {
        let mut room = *limits;
        for lead in leads.iter().flatten() {
            let factor = lead.factor.abs();
            let rest = (lead.plan, lead.elapsed);
            room = self.planner.room(rest, &room.times(1.0 / factor)).times(factor);
        }
        let least = room
            .velocity
            .min(room.acceleration)
            .min(room.deceleration)
            .min(room.jerk)
            .min(room.snap);
        (least > 0.0 && leads.iter().any(Option::is_some)).then_some(room)
    }

    /// Whether a slave that is ahead of the law waits for it. Applies to a law that has constant velocity only at its
    /// rest at the end, which is further ahead.
    fn lets_law_come(&self, view: &View<'_, P::Plan>, difference: &Setpoint, line: f64) -> bool {
        let Some(coupling) = &self.follower.coupling else {
            return false;
        };
        // A start that waits for a place of the master is in time if the slave moves ahead to that rest.
        let is_timed = coupling
            .gearing
            .sync
            .is_some_and(|sync| sync.start_distance != 0.0);
        if !coupling.is_syncing() || is_timed || line != 0.0 {
            return false;
        }
        let left = coupling
            .leads(&view.future)
            .and_then(|leads| way_to_rest(&leads, 0));
        left.is_some_and(|left| difference.position * left > 0.0 && left.abs() > difference.position.abs())
    }

    /// A velocity (u/s) of the slave itself, which does not lead onto the law.
    ///
    /// # Errors
    /// The reason why it may not move.
    fn to_pace(&self, owner: &Entry, velocity: f64) -> Result<Way<P::Plan>, ErrorId> {
        let (motion, limits) = self.to_velocity(owner, velocity)?;
        Ok(Way {
            motion,
            rung: Rung::Own,
            lock: u64::MAX,
            left: u64::MAX,
            name: Approach::Pace,
            velocity,
            limits,
        })
    }

    /// Moves as fast as possible, in the direction of the law, which has this `velocity` (u/s).
    ///
    /// # Errors
    /// The reason why it may not move there.
    fn at_pace(
        &self,
        owner: &Entry,
        view: &View<'_, P::Plan>,
        most: f64,
        velocity: f64,
    ) -> Result<Way<P::Plan>, ErrorId> {
        let goal = if velocity < 0.0 { -most } else { most };
        let way = self.to_pace(owner, goal)?;
        let coupling = self.coupling();
        let left = match coupling.and_then(|coupling| coupling.leads(&view.future)) {
            Some(leads) => {
                let late = u64::from(view.future.is_late());
                let switch = self.scans_to_switch(&leads);
                switch.map_or(u64::MAX, |scans| scans.saturating_add(late))
            }
            None => UNKNOWN,
        };
        Ok(Way { left, ..way })
    }

    /// Scans until one of these plans next changes its highest derivative, if any does.
    pub(in crate::axis) fn scans_to_switch(&self, leads: &Leads<'_, P::Plan>) -> Option<u64> {
        let scans = leads.iter().flatten().map(|lead| {
            let switch = self.planner.next_switch((lead.plan, lead.elapsed));
            switch.saturating_sub(lead.elapsed)
        });
        scans.filter(|scans| *scans > 0).min()
    }

    /// A ramp in the slave's own coordinates, planned like that of MC_MoveVelocity, and its limits.
    ///
    /// # Errors
    /// The reason why it may not move there.
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
        let motion = self.plan_from(&mut entry, self.mover.setpoint(), &before)?;
        let motion = self.kept_inside(&mut entry, motion, self.mover.setpoint(), &before)?;
        let limits = Self::limits_of(&entry.limits, &motion);
        Ok((motion, limits))
    }

    /// Starts the `motion` of a way within `limits`; the motion before was within `before`. With `from` the way ends
    /// at rest, and its positions count from there (u).
    pub(super) fn start_way(
        &mut self,
        motion: Motion<P::Plan>,
        limits: Limits,
        before: Limits,
        from: Option<f64>,
    ) {
        self.mover.take_over_from(before);
        self.mover.start(motion, limits);
        self.arrival = Arrival::default();
        self.replan_due = false;
        if self.modulo.is_some() {
            self.start_of_plan();
        }
        let may_leave = self.may_leave_on_way(from);
        self.mover.watch(may_leave);
        self.end_routine();
    }

    /// Starts `way`; the motion before was within `before`.
    fn take_way(&mut self, way: Way<P::Plan>, before: Limits, scope: &mut Scope<'_>) {
        let (scans, limits) = (way.motion.scans(), way.limits);
        // Beside a line at rest it ends at rest.
        let from = match way.rung {
            Rung::BesideLine {
                start, velocity: 0.0, ..
            } => Some(start.position),
            _ => None,
        };
        self.start_way(way.motion, limits, before, from);
        let told = Some((way.name, way.velocity));
        let mut is_told = false;
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.rung = way.rung;
            coupling.left = way.left;
            is_told = coupling.told == told;
            coupling.told = told;
        }
        // The same way found again is not recorded.
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

    /// There is no way. A way that MC_Power or a limit switch bars waits for permission.
    fn stay_back(&mut self, error: ErrorId, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if let Some(coupling) = &mut self.follower.coupling {
            coupling.rung = Rung::Due;
            coupling.left = u64::MAX;
        }
        match error {
            ErrorId::PositiveBarred | ErrorId::NegativeBarred | ErrorId::OutwardFromLimitSwitch => {
                self.pause(error, scope);
                if !self.is_coupled() {
                    // An owner that no block follows has become a halt.
                    self.advance(scope);
                }
            }
            ErrorId::OutwardFromSoftwareLimit => self.fail(ErrorId::SoftwareLimitReached, scope),
            ErrorId::MasterTooFast => self.give_up(view, scope),
            other => self.fail(other, scope),
        }
    }

    /// The owner cannot reach its sync point: it fails, and the slave comes to rest.
    #[cold]
    fn give_up(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let Some(owner) = self.owner else { return };
        let (velocity, speed) = (self.limits_of_approach(&owner).velocity, self.law_speed(view));
        let (error, scope) = (ErrorId::MasterTooFast, &mut self.owner_scope(scope));
        self.refuse("Velocity", velocity, speed, error, scope);
        self.halt_failed(&owner, error, scope);
    }

    /// The `owner` fails in its motion step with `error`, which was recorded, and the slave comes to rest.
    pub(super) fn halt_failed(&mut self, owner: &Entry, error: ErrorId, scope: &mut Scope<'_>) {
        self.end_owner(Fate::Failed(error));
        self.lose_heir(owner.id, scope);
        let stopped = Entry {
            limits: self.stop_limits(),
            ..*owner
        };
        self.halt_after(&stopped, scope);
        self.advance(scope);
    }

    /// The limit that the law exceeds in the master's plan: its name, the value and the limit.
    fn reason(&self, view: &View<'_, P::Plan>) -> Option<Beyond> {
        self.reason_beside(view, &Setpoint::default())
    }

    /// The same with the largest motion that may be added `beside` it.
    pub(in crate::axis) fn reason_beside(
        &self,
        view: &View<'_, P::Plan>,
        beside: &Setpoint,
    ) -> Option<Beyond> {
        let coupling = self.coupling()?;
        let mut peaks = Setpoint::default();
        for lead in coupling.leads(&view.future)?.iter().flatten() {
            let own = self.planner.peaks((lead.plan, lead.elapsed))?;
            peaks = peaks.plus(&own.times(lead.factor.abs()));
        }
        CamBounds::beyond(&peaks.plus(beside), &coupling.limits)
    }
}

/// The direction of the law, as the sign of a distance (u) or a velocity (u/s): along its next stretch `line`, or to
/// its rest if it has no other stretch.
fn heading<Q: Plan>(leads: &Leads<'_, Q>, line: f64) -> f64 {
    if line == 0.0 {
        way_to_rest(leads, 0).unwrap_or(0.0)
    } else {
        line
    }
}

/// `limits` with these velocities along a line of this `velocity` (u/s), and against it.
pub(super) fn directed(velocity: f64, (along, against): (f64, f64), limits: Limits) -> DirectedLimits {
    let (positive, negative) = if velocity < 0.0 {
        (against, along)
    } else {
        (along, against)
    };
    DirectedLimits {
        positive,
        negative,
        limits,
    }
}

/// Half of the limits that a law in this state leaves of `limits`; none if it leaves nothing.
pub(super) fn half_left(law: &Setpoint, limits: &Limits) -> Option<Limits> {
    let half = |limit: f64, used: f64| 0.5 * (limit - used.abs());
    let rate = half(limits.lower_acceleration(), law.acceleration);
    let room = Limits {
        velocity: half(limits.velocity, law.velocity),
        acceleration: rate,
        deceleration: rate,
        jerk: half(limits.jerk, law.jerk),
        snap: half(limits.snap, law.snap),
    };
    let least = room.velocity.min(rate).min(room.jerk).min(room.snap);
    (least > LEAST * limits.velocity).then_some(room)
}
