//! The shadow: a master of the slave's own. It gets in step with the real master, within limits with which the slave
//! keeps its own limits at every place of the cam.

use super::super::super::commands::ROUNDING;
use super::super::super::{Axis, Motion};
use super::super::approach::{directed, half_left};
use super::super::follow::apart;
use super::super::needs::RESOLVED;
use super::super::view::{UNKNOWN, View};
use super::onto::{Choice, LEAST, Stretch, Way};
use super::{Curve, Rung, Shadow};
use crate::Approach;
use standstill_planner::{Excess, Lead, Limits, Plan, Planner, Setpoint};

/// Velocities of a shadow that are tried.
const SPEEDS: usize = 4;

/// The numbers of scans over which a shadow that has to slow down looks ahead.
const AHEAD: [f64; 7] = [10.0, 25.0, 50.0, 100.0, 200.0, 400.0, 800.0];

/// A shadow that has to slow down still gets faster until its acceleration is 0. It is left this factor times the
/// velocity that it gains, because with the rates that a higher velocity leaves it gains more.
const GAINED: f64 = 1.25;

/// A part of a cam flatter than this share of its steepest part bounds a shadow as if it were that steep.
const FLAT: f64 = 1e-3;

/// The largest share of the highest velocity of its cam that a shadow may have. Above it nothing is left for its
/// acceleration.
pub(super) const FASTEST: f64 = 0.98;

impl<P: Planner> Axis<P> {
    /// Limits of the shadow with a velocity of its own (u/s of the master). `None` if nothing is left of the slave's
    /// limits.
    pub(super) fn limits_of_shadow(
        &self,
        curve: &Curve<'_>,
        shadow: &Setpoint,
        wanted: f64,
    ) -> Option<Limits> {
        let limits = self.slowed(&self.parameters.limits);
        let bounds = curve.bounds();
        let highest = bounds.highest_velocity(&limits).min(f64::MAX);
        // Its present velocity is always allowed.
        let present = shadow.velocity.abs().min(0.999 * highest);
        let found = bounds.shadow(&limits, wanted.max(present), present)?;
        Some(bounded(&found))
    }

    /// Velocities of a shadow that gets in step with a stretch. The lowest one leaves most of the acceleration, the
    /// highest one least. The distance decides which is in step soonest. If the stretch is too fast, these are lower
    /// velocities, with which the shadow falls behind.
    pub(super) fn speeds_of_shadow(&self, curve: &Curve<'_>, stretch: &Stretch) -> [f64; SPEEDS] {
        let limits = self.slowed(&self.parameters.limits);
        let highest = curve.bounds().highest_velocity(&limits).min(1e12);
        let speed = stretch.velocity.abs();
        if speed >= FASTEST * highest {
            return [0.9, 0.7, 0.5, 0.3].map(|share| share * highest);
        }
        [0.1, 0.4, 0.7, 1.0].map(|share| speed + share * (FASTEST * highest - speed))
    }

    /// The way of the shadow that is soonest in step with its master.
    ///
    /// A way that brings a shadow into limits lower than its present ones exceeds them. It is used only if there is
    /// no other.
    pub(super) fn in_step(
        &self,
        curve: &Curve<'_>,
        view: &View<'_, P::Plan>,
        shadow: &Shadow,
        difference: &Setpoint,
        stretch: &Stretch,
    ) -> Choice<P::Plan> {
        let mut best: Option<Way<P::Plan>> = None;
        let mut ahead: Option<Way<P::Plan>> = None;
        let take = |best: &mut Option<Way<P::Plan>>, way: Option<Way<P::Plan>>| {
            let Some(way) = way else { return };
            let order = |way: &Way<P::Plan>| (way.exceeds, way.lock);
            if best.as_ref().is_none_or(|best| order(&way) < order(best)) {
                *best = Some(way);
            }
        };
        // The master passes its present place again one period later.
        let can_wait = curve.repeats() && stretch.velocity != 0.0;
        let speeds = self.speeds_of_shadow(curve, stretch);
        let wanted = speeds.map(|wanted| self.limits_of_shadow(curve, &shadow.at, wanted));
        let all = wanted.into_iter().chain([self.shadow_limits_now()]).flatten();
        for limits in all.clone() {
            let way = self.beside_stretch_of_master(shadow, stretch, &limits, curve, 0.0);
            take(&mut best, way);
            let way = self.beside_master(view, difference, &limits, curve);
            let leads_ahead = way.as_ref().is_some_and(|way| way.ahead);
            take(if leads_ahead { &mut ahead } else { &mut best }, way);
            if can_wait {
                let period = curve.period().copysign(stretch.velocity);
                let way = self.beside_stretch_of_master(shadow, stretch, &limits, curve, period);
                take(&mut best, way);
            }
        }
        if let Some(near) = stretch.near(view) {
            // The line only leads near its master. A shadow that waits for its master waits beside the line, because
            // the master itself may jitter.
            let line = best.as_ref().filter(|way| !way.exceeds);
            let line = line.map_or(u64::MAX, |way| way.lock);
            let waits = stretch.comes(shadow, difference) && line > near;
            let soonest = if waits { 0 } else { line.saturating_add(near) };
            let beside = all
                .clone()
                .filter_map(|limits| {
                    self.beside_measured_master(view, shadow, difference, stretch, &limits, curve)
                })
                .min_by_key(|way| way.lock)
                .filter(|way| way.lock < soonest);
            best = beside.or(best);
        }
        let is_missing = |best: &Option<Way<P::Plan>>| {
            best.as_ref()
                .is_none_or(|way| way.exceeds || way.lock == u64::MAX)
        };
        // A way beside the master that gets ahead of it is used only if the other ways get ahead, too, or do not get
        // in step.
        if is_missing(&best) || best.as_ref().is_some_and(|way| way.ahead) {
            take(&mut best, ahead);
        }
        if is_missing(&best) {
            let is_outside = best.as_ref().is_some_and(|way| way.exceeds);
            for limits in all {
                let mut pace = self.at_shadow_pace(view, shadow, stretch, &limits);
                // A way that exceeds the limits from here may keep them a little later.
                if let (true, Some(way)) = (is_outside, &mut pace) {
                    way.left = way.left.min(self.next_switch_along(way));
                }
                take(&mut best, pace);
            }
        }
        if best.as_ref().is_none_or(|way| way.exceeds) {
            if self.is_slowing_down() {
                return Choice::Stay;
            }
            take(&mut best, self.slowing_down(curve, shadow));
        }
        let Some(mut way) = best else {
            return Choice::Wait(UNKNOWN);
        };
        if view.future.is_late() {
            way.left = 0;
        }
        Choice::Take(way)
    }

    /// Scans until the plan of `way` first changes its highest derivative; the largest number if it never does.
    fn next_switch_along(&self, way: &Way<P::Plan>) -> u64 {
        let Motion::Closing { plan, .. } = &way.motion else {
            return u64::MAX;
        };
        match self.planner.next_switch((plan, 0)) {
            0 => u64::MAX,
            scans => scans,
        }
    }

    /// A way for a shadow that is faster than the limit for the whole cam, on a flat part of the cam. It slows down
    /// as fast as the flat part allows. It has slowed down before a steeper part begins, or keeps the limits there,
    /// too. Cost: at most 14 ramps and checks along seven of them.
    fn slowing_down(&self, curve: &Curve<'_>, shadow: &Shadow) -> Option<Way<P::Plan>> {
        let limits = self.slowed(&self.parameters.limits);
        let speed = shadow.at.velocity.abs();
        let goal = 0.5 * FASTEST * curve.bounds().highest_velocity(&limits).min(1e12);
        let start = shadow.at.at_origin();
        let x = curve.unwound(shadow.place);
        let mut found: Option<Way<P::Plan>> = None;
        for scans in AHEAD {
            let reach = shadow.at.velocity * (scans * self.planner.cycle());
            let further = x + reach / curve.law.master_scaling;
            let bounds = curve
                .law
                .bounds_between(&curve.cam, x.min(further), x.max(further))
                .or_larger(&curve.bounds().scaled(1.0, FLAT));
            let goal = goal.copysign(shadow.at.velocity);
            let within = |speed: f64| {
                let most = speed.max(goal.abs());
                let own = bounded(&bounds.shadow(&limits, most, speed)?).with_velocity(most);
                let plan = self.planner.ramp_to(&start, goal, &own, &own).ok()?;
                Some((plan, own))
            };
            let Some((mut plan, mut own)) = within(speed) else {
                continue;
            };
            // It gets faster until its acceleration is 0.
            let gained = plan.excess().map_or(0.0, |excess| excess.velocity);
            if gained > 0.0 {
                let Some(faster) = within(speed + GAINED * gained) else {
                    continue;
                };
                (plan, own) = faster;
            }
            let scans = u64::from(plan.scans());
            let is_inside = plan.at(scans).position.abs() <= reach.abs();
            let fastest = Setpoint::at_velocity(0.0, own.velocity);
            let is_slow = bounds.most(&fastest).velocity <= limits.velocity;
            let stays = is_inside && is_slow && !plan.excess().is_some_and(|excess| leaves(&excess, &own));
            let exceeds = !stays && {
                let lead = Lead::whole(&plan);
                let lead = (&lead, limits.order().degree());
                self.beyond_on_cam(curve, lead, shadow.place, &limits).is_some()
            };
            if found.is_some() && exceeds {
                continue;
            }
            found = Some(Way {
                exceeds,
                left: scans,
                slows: true,
                ..Way::by(plan, shadow.alone(), Approach::Pace, goal, own)
            });
            if !exceeds {
                break;
            }
        }
        found
    }

    /// The limits of the shadow in motion, which it keeps.
    pub(super) fn shadow_limits_now(&self) -> Option<Limits> {
        let on_cam = self.on_cam()?;
        match on_cam.rung {
            Rung::BesideLine { .. }
            | Rung::BesideMaster
            | Rung::BesideMeasured { .. }
            | Rung::Corner { .. }
                if !on_cam.slows =>
            {
                Some(on_cam.shadow_limits)
            }
            _ => None,
        }
    }

    /// Whether it slows down to a velocity that is allowed on the whole cam.
    fn is_slowing_down(&self) -> bool {
        let is_under_way =
            matches!(self.mover.motion(), Motion::Closing { elapsed, scans, .. } if elapsed < scans);
        is_under_way && self.on_cam().is_some_and(|on_cam| on_cam.slows)
    }

    /// A way beside the master that takes the difference to 0. None if it is not known to keep the limits, or moves
    /// the shadow in a direction in which its master does not move.
    fn beside_master(
        &self,
        view: &View<'_, P::Plan>,
        difference: &Setpoint,
        limits: &Limits,
        curve: &Curve<'_>,
    ) -> Option<Way<P::Plan>> {
        let is_there = difference.is_at_rest() && difference.position == 0.0;
        if view.future.is_late() || is_there || curve.is_long(difference.position) {
            return None;
        }
        let lead = self.lead_of_master(view)?;
        let on_cam = self.on_cam()?;
        let now = Setpoint {
            position: difference.position,
            velocity: difference.velocity + on_cam.was.at.velocity,
            acceleration: difference.acceleration + on_cam.was.at.acceleration,
            jerk: difference.jerk + on_cam.was.at.jerk,
            snap: 0.0,
        };
        let leads = [Some(lead), None];
        let turns = |plan: &P::Plan| {
            let found = self.planner.velocities_behind(&leads, (plan, 0));
            found.is_none_or(|(lowest, highest)| {
                let least = ROUNDING * limits.velocity;
                (lowest < -least && !self.goes(&lead, -1.0)) || (highest > least && !self.goes(&lead, 1.0))
            })
        };
        let attempt = |own: &Limits| {
            let plan = self.closing(difference, own, true)?;
            let fits = self.planner.fits_behind(&leads, &now, Some((&plan, 0)), limits);
            (fits && !turns(&plan)).then_some(plan)
        };
        let plan = match attempt(limits) {
            Some(plan) => plan,
            None => attempt(&self.room_beside(&leads, limits)?)?,
        };
        // Whether it starts behind its master and then gets ahead of it.
        let forwards = 1.0_f64.copysign(lead.plan.at(lead.elapsed.saturating_add(1)).velocity * lead.factor);
        let (lowest, highest) = self.planner.reach((&plan, 0));
        let furthest = difference.position + if forwards > 0.0 { highest } else { lowest };
        let resolved = RESOLVED * 4.0 * (difference.position.abs() + on_cam.was.place.position.abs());
        let ahead = difference.position * forwards <= 0.0 && furthest * forwards > resolved;
        Some(Way {
            ahead,
            ..beside(plan, Rung::BesideMaster, difference, limits)
        })
    }

    /// The same beside a master whose future motion is not known, with half of the limits that it leaves the shadow
    /// now. Each step is checked before it is made. There is no such way again if the half was not enough in this
    /// step.
    fn beside_measured_master(
        &self,
        view: &View<'_, P::Plan>,
        shadow: &Shadow,
        difference: &Setpoint,
        stretch: &Stretch,
        limits: &Limits,
        curve: &Curve<'_>,
    ) -> Option<Way<P::Plan>> {
        let was_beside = matches!(self.cam_rung(), Some(Rung::BesideMeasured { .. }));
        let is_there = difference.is_at_rest() && difference.position == 0.0;
        if was_beside || is_there || curve.is_long(difference.position) {
            return None;
        }
        let mut room = half_left(&view.now.at, limits)?;
        if stretch.comes(shadow, difference) {
            room.velocity = room.velocity.min(stretch.velocity.abs());
        }
        let plan = self.within_room(difference, &room, true)?;
        Some(beside(plan, Rung::BesideMeasured { room }, difference, limits))
    }

    /// Whether the rest of this plan moves its master in this direction at all: up (1) or down (-1).
    fn goes(&self, lead: &Lead<'_, P::Plan>, side: f64) -> bool {
        let (up, down) = self.planner.ways((lead.plan, lead.elapsed));
        let side = side * lead.factor;
        let end = lead.plan.end().velocity;
        (if side > 0.0 { up } else { down }) > 0.0 || side * end > 0.0
    }

    /// A way onto the next stretch of the master, or onto the same stretch `laps` later (u of the master).
    pub(super) fn beside_stretch_of_master(
        &self,
        shadow: &Shadow,
        stretch: &Stretch,
        limits: &Limits,
        curve: &Curve<'_>,
        laps: f64,
    ) -> Option<Way<P::Plan>> {
        let speed = stretch.velocity.abs();
        let along = limits.velocity - speed;
        let turn = curve.law.master_turn.unwrap_or(0.0);
        // Relative to a line through the shadow: places relative to a line far away would be as coarse as that
        // distance.
        let start = Setpoint {
            position: 0.0,
            velocity: shadow.at.velocity - stretch.velocity,
            ..shadow.at
        };
        let way = -(apart(shadow.place, stretch.now, turn) + laps);
        if !(along > LEAST * limits.velocity) {
            return None;
        }
        let against = if stretch.lets_come(shadow) {
            speed
        } else {
            limits.velocity + speed
        };
        let wider = limits.velocity + speed;
        let own = directed(stretch.velocity, (along, against), *limits);
        let before = directed(stretch.velocity, (wider, wider), *limits);
        let plan = self.planner.move_by_direction(&start, way, &own, &before).ok()?;
        let scans = u64::from(plan.scans());
        let arrives = scans.max(stretch.begin);
        let is_in_time = stretch.is_guess || arrives <= stretch.end;
        // A shadow that still moves against the stretch has a higher velocity relative to it than later, and may
        // nevertheless keep its limits.
        let exceeds = plan.excess().is_some_and(|excess| leaves(&excess, limits))
            && !self.keeps_beside_line(&shadow.at, stretch.velocity, &plan, limits);
        let rung = Rung::BesideLine {
            start: curve.told_near(shadow.place.moved_to(shadow.place.position + laps)),
            velocity: stretch.velocity,
            begin: stretch.begin,
        };
        Some(Way {
            exceeds,
            ahead: stretch.is_ahead && scans < stretch.begin,
            lock: if is_in_time { arrives } else { u64::MAX },
            left: stretch.end,
            laps,
            ..Way::by(plan, rung, Approach::Stretch, stretch.velocity, *limits)
        })
    }

    /// Whether a motion from `now` by this plan beside a line of this `velocity` (u/s) keeps the limits.
    fn keeps_beside_line(&self, now: &Setpoint, velocity: f64, plan: &P::Plan, limits: &Limits) -> bool {
        let steady = Setpoint::at_velocity(0.0, velocity);
        let Ok(line) = self.planner.ramp_to(&steady, velocity, limits, limits) else {
            return false;
        };
        let line = Lead::whole(&line);
        self.planner
            .fits_behind(&[Some(line), None], now, Some((plan, 0)), limits)
    }

    /// A way as fast as the shadow may go, in the direction of its master.
    pub(super) fn at_shadow_pace(
        &self,
        view: &View<'_, P::Plan>,
        shadow: &Shadow,
        stretch: &Stretch,
        limits: &Limits,
    ) -> Option<Way<P::Plan>> {
        let start = shadow.at.at_origin();
        let goal = limits.velocity.copysign(stretch.velocity);
        let plan = self.planner.ramp_to(&start, goal, limits, limits).ok()?;
        let left = match self.lead_of_master(view) {
            Some(lead) => self.scans_to_switch(&[Some(lead), None]).unwrap_or(u64::MAX),
            None => UNKNOWN,
        };
        Some(Way {
            exceeds: plan.excess().is_some_and(|excess| leaves(&excess, limits)),
            left,
            ..Way::by(plan, shadow.alone(), Approach::Pace, goal, *limits)
        })
    }
}

/// The way by a `plan` that takes the `difference` to 0, within these `limits` of the shadow.
fn beside<Q: Plan>(plan: Q, rung: Rung, difference: &Setpoint, limits: &Limits) -> Way<Q> {
    Way {
        lock: plan.scans().into(),
        ..Way::by(plan, rung, Approach::Difference, difference.velocity, *limits)
    }
}

impl Shadow {
    /// On a way of its own from here, which does not lead to its master.
    fn alone(&self) -> Rung {
        Rung::BesideLine {
            start: self.place,
            velocity: 0.0,
            begin: u64::MAX,
        }
    }
}

impl Stretch {
    /// Whether a shadow ahead of the line waits for it, and does not move against the master. A shadow that already
    /// moves against the line continues to do so. Onto a master at rest it may move in either direction.
    fn lets_come(&self, shadow: &Shadow) -> bool {
        self.velocity != 0.0 && shadow.at.velocity * self.velocity >= 0.0
    }

    /// Whether the shadow is ahead of its master and waits for it.
    fn comes(&self, shadow: &Shadow, difference: &Setpoint) -> bool {
        difference.position * self.velocity > 0.0 && self.lets_come(shadow)
    }

    /// The number of scans before the shadow reaches this line at which a way beside the master itself takes over.
    /// None if the motion of the master is known. A master with constant velocity now may be on the line.
    fn near<Q: Plan>(&self, view: &View<'_, Q>) -> Option<u64> {
        let now = &view.now.at;
        let is_on_line = now.velocity == self.velocity && now.acceleration == 0.0 && now.jerk == 0.0;
        let scans = view.future.unforeseen()?;
        Some(if is_on_line { 0 } else { 2 * scans })
    }
}

/// Limits these numbers. A cam that hardly moves leaves more than they can hold.
fn bounded(limits: &Limits) -> Limits {
    let most = |limit: f64, most: f64| if limit.is_finite() { limit.min(most) } else { limit };
    Limits {
        velocity: limits.velocity.min(1e12),
        acceleration: limits.acceleration.min(1e15),
        deceleration: limits.deceleration.min(1e15),
        jerk: most(limits.jerk, 1e18),
        snap: most(limits.snap, 1e21),
    }
}

/// Whether an excess is more than rounding of `limits`.
pub(super) fn leaves(excess: &Excess, limits: &Limits) -> bool {
    let parts = [
        (excess.velocity, limits.velocity),
        (excess.acceleration, limits.acceleration),
        (excess.jerk, limits.jerk),
    ];
    parts.into_iter().any(|(excess, limit)| excess > ROUNDING * limit)
}
