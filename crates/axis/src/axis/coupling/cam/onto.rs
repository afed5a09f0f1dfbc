//! How a slave gets onto its cam, and in step with its master. The way is searched each time the master gets another
//! plan or a way has ended.
//!
//! | the slave is | way |
//! | --- | --- |
//! | on the cam at its master's place, moving as the cam needs | in sync at once, if that keeps its limits as far as is known |
//! | on the curve elsewhere | its shadow, a master of its own, gets in step with the real one: beside it, or onto its next stretch of constant velocity, or as fast as possible |
//! | on the curve, and none of these keeps its limits | off the curve, and back as below |
//! | off the curve, master at rest | a move to the cam at the master's place |
//! | off the curve, master moving | a move to a place of the curve further ahead; the slave is at rest there until its shadow starts, in time to be in step with the arriving master |

use super::super::super::commands::{Entry, ROUNDING, refusal};
use super::super::super::{Axis, Motion};
use super::super::follow::{apart, meet, off};
use super::super::needs::RESOLVED;
use super::super::view::{Kind, UNKNOWN, View};
use super::{Curve, OnCam, Rung, Shadow};
use crate::{Approach, ErrorId, Event, Scope};
use standstill_planner::{Anchor, Cam, CamLaw, Limits, Place, Plan, Planner, Setpoint};

/// The room for a velocity relative to a line must be more than this share of the limit.
pub(super) const LEAST: f64 = 1e-6;

/// Places of the cam ahead of the master that are tried, one by one.
const PLACES: u32 = 4;

/// The master's next stretch of constant velocity: the scans until it begins and until it ends, its velocity (u/s),
/// and the present place of a line of that velocity through it.
#[derive(Clone, Copy)]
pub(super) struct Stretch {
    pub begin: u64,
    pub end: u64,
    pub velocity: f64,
    pub now: Place,
    /// The line is ahead of the master until the stretch begins.
    pub is_ahead: bool,
    /// The master's future motion is not known: the line is an estimate that is renewed at its end.
    pub is_guess: bool,
}

/// How a shadow starts from rest: the distance that its master gains until then, without a sign, and its own signed
/// distance (both in u of the cam's master side).
struct Ramp {
    gained: f64,
    way: f64,
}

/// A way onto the cam: a plan, and the scan in which the slave is in sync.
pub(super) struct Way<Q> {
    pub motion: Motion<Q>,
    pub rung: Rung,
    /// Scans until in sync; the largest number if this way does not lead there.
    pub lock: u64,
    /// Scans until the way is searched again.
    pub left: u64,
    pub name: Approach,
    pub velocity: f64,
    /// Limits of the shadow along it.
    pub shadow: Limits,
    /// With these limits the slave keeps its own only along this way, not at every place of the cam.
    pub slows: bool,
    /// The place of the shadow is increased by this distance (u of the master): whole periods, because the master
    /// passes once more.
    pub laps: f64,
    /// It begins outside these limits.
    pub exceeds: bool,
    /// It gets ahead of its master.
    pub ahead: bool,
}

impl<Q: Plan> Way<Q> {
    /// By `plan`, which leads to no place in sync. The shadow has these limits at every place of the cam.
    pub fn by(plan: Q, rung: Rung, name: Approach, velocity: f64, shadow: Limits) -> Self {
        Self {
            motion: Motion::closing(plan),
            rung,
            lock: u64::MAX,
            left: u64::MAX,
            name,
            velocity,
            shadow,
            slows: false,
            laps: 0.0,
            exceeds: false,
            ahead: false,
        }
    }
}

/// The decision.
pub(super) enum Choice<Q> {
    Lock,
    Take(Way<Q>),
    /// It continues on its way.
    Stay,
    /// There is no way now. It is searched again after this number of scans.
    Wait(u64),
    Fail(ErrorId),
}

impl<P: Planner> Axis<P> {
    /// Finds the way onto the cam, from the state at the end of the last scan. The slave is in sync at once only if
    /// it `may_lock`.
    pub(super) fn decide_on_cam(&mut self, view: &View<'_, P::Plan>, may_lock: bool, scope: &mut Scope<'_>) {
        let Some(on_cam) = self.follower.on_cam else {
            return;
        };
        if on_cam.ends.is_over() {
            // It holds its last place for any motion of the master.
            return self.stay_at_end(view, scope);
        }
        let Some(owner) = self.owner else { return };
        let was_locked = on_cam.rung.is_locked();
        let chosen = {
            let Some(cam) = scope.cams.cam(on_cam.camming.cam) else {
                return self.fail(ErrorId::CamUnknown, scope);
            };
            let Some(curve) = self.lay_cam(cam) else { return };
            self.tell_shadow_near(&curve);
            self.drop_periods(&curve);
            let beyond = self.keeps_on_cam(&curve, view, false);
            let choice = self.choose(&curve, view, &owner, may_lock && beyond.is_ok());
            (choice, beyond)
        };
        let (choice, beyond) = chosen;
        if let (true, Choice::Take(_) | Choice::Stay | Choice::Wait(_), Err(reason)) =
            (was_locked, &choice, beyond)
        {
            self.lose_sync(reason, scope);
        }
        match choice {
            Choice::Lock if was_locked => {}
            Choice::Stay => {}
            Choice::Lock => self.lock_on_cam(scope),
            Choice::Take(way) => {
                if way.laps != 0.0 {
                    self.lap_shadow(way.laps, scope);
                }
                self.take_way_on_cam(way, scope);
            }
            Choice::Wait(left) => self.wait_on_cam(left, scope),
            Choice::Fail(error) => self.give_up_cam(error, scope),
        }
    }

    /// Fixes the place of the cam, if that is not known yet, and finds whether the slave is on it.
    pub(super) fn lay_cam<'a>(&mut self, cam: Cam<'a>) -> Option<Curve<'a>> {
        let mut on_cam = self.follower.on_cam?;
        if on_cam.anchor.is_none() {
            let camming = &mut on_cam.camming;
            let settled = on_cam.begins;
            let (master, origin) = settled.unwrap_or_else(|| camming.laid(on_cam.was.place, cam.head));
            camming.law.origin = origin;
            let anchor = self.laid(&on_cam, &cam, master);
            on_cam.laid = anchor.slave.phase;
            on_cam.anchor = Some(anchor);
            self.follower.on_cam = Some(on_cam);
        }
        let curve = on_cam.curve(cam)?;
        self.find_shadow(&curve);
        Some(curve)
    }

    /// The place of a cam that has this place at its `master`, from the places of both at the end of the last scan.
    fn laid(&self, on_cam: &OnCam, cam: &Cam<'_>, master: Place) -> Anchor {
        let camming = &on_cam.camming;
        let was = on_cam.was.place;
        let law = camming.law;
        let offset = Place::new(0, camming.slave_offset);
        let mut anchor = Anchor {
            master,
            slave: offset,
            ..Anchor::default()
        };
        let straight = CamLaw {
            slave_turn: None,
            ..law
        };
        let here = self.place();
        let without = Anchor {
            slave: Place::default(),
            ..anchor
        };
        let on_curve = straight.at(cam, &without, was, &on_cam.was.at, 0).place.position;
        if camming.slave_absolute {
            // The nearest of the turns for the same position.
            if let Some(modulo) = &self.modulo {
                let length = modulo.length;
                let place = law.at(cam, &anchor, was, &on_cam.was.at, 0).place;
                let off = off(here, place, length) / length;
                let nearest = if off < 0.0 { off - 0.5 } else { off + 0.5 };
                anchor.slave.turns = nearest as i64;
            }
        } else {
            // The cam passes through the place of the slave, except for the offset.
            anchor.slave = Place {
                turns: here.turns,
                position: here.position,
                phase: camming.slave_offset - on_curve,
            };
        }
        anchor
    }

    /// Checks whether a slave that is not known to be on the curve is on it, at its master's place.
    pub(super) fn find_shadow(&mut self, curve: &Curve<'_>) {
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let limits = self.slowed(&self.parameters.limits);
        let last = *self.mover.setpoint();
        let Some(on_cam) = &mut self.follower.on_cam else {
            return;
        };
        if on_cam.shadow.is_some() {
            return;
        }
        let at = curve.at(on_cam.was.place, &on_cam.was.at, on_cam.at.piece);
        on_cam.at = at;
        let resolved = RESOLVED * 4.0 * (here.position.abs() + at.place.position.abs() + length);
        if off(here, at.place, length).abs() > resolved {
            return;
        }
        if goes_on(&last, &at.state, &limits) {
            on_cam.shadow = Some(Shadow::of(&on_cam.was));
        } else if last.is_at_rest() {
            on_cam.shadow = Some(Shadow::at_rest(on_cam.was.place));
        }
    }

    /// If a shadow is whole periods behind, increases its place by these periods.
    fn drop_periods(&mut self, curve: &Curve<'_>) {
        let Some(on_cam) = &self.follower.on_cam else {
            return;
        };
        let (Some(shadow), true) = (on_cam.shadow, curve.repeats()) else {
            return;
        };
        let turn = curve.law.master_turn.unwrap_or(0.0);
        let behind = apart(on_cam.was.place, shadow.place, turn);
        let period = curve.period();
        let whole = (behind / period) as i64 as f64;
        // A shadow ahead of a moving master waits for it.
        if whole != 0.0 && whole * on_cam.was.at.velocity >= 0.0 {
            self.move_shadow(curve, whole * period);
        }
    }

    /// Increases the place of the shadow by this distance (u of the master): whole periods.
    fn move_shadow(&mut self, curve: &Curve<'_>, by: f64) {
        let Some(on_cam) = &mut self.follower.on_cam else {
            return;
        };
        let Some(shadow) = &mut on_cam.shadow else { return };
        shadow.place = curve.told_near(shadow.place.moved_to(shadow.place.position + by));
        // The start of its way is moved, too, if it stays on that way.
        if let Rung::BesideLine { start, .. } | Rung::Corner { start } = &mut on_cam.rung {
            start.position += by;
        }
        let periods = by / ((curve.cam.head.end - curve.cam.head.begin) * curve.law.master_scaling);
        let whole = if periods < 0.0 {
            periods - 0.5
        } else {
            periods + 0.5
        };
        on_cam.ends.renumber(whole as i64);
    }

    pub(super) fn choose(
        &self,
        curve: &Curve<'_>,
        view: &View<'_, P::Plan>,
        owner: &Entry,
        may_lock: bool,
    ) -> Choice<P::Plan> {
        let Some(on_cam) = &self.follower.on_cam else {
            return Choice::Wait(u64::MAX);
        };
        let stretch = self.stretch_of_master(on_cam, view);
        let Some(shadow) = on_cam.shadow else {
            return self.onto_curve(curve, owner, &stretch);
        };
        let turn = curve.law.master_turn.unwrap_or(0.0);
        let was = &on_cam.was;
        let difference = Setpoint {
            position: apart(shadow.place, was.place, turn),
            velocity: shadow.at.velocity - was.at.velocity,
            acceleration: shadow.at.acceleration - was.at.acceleration,
            jerk: shadow.at.jerk - was.at.jerk,
            snap: 0.0,
        };
        let is_there = difference.position == 0.0 && difference.is_at_rest();
        // Where the curve is level the slave is at rest for any motion of its master.
        let is_there = is_there
            || ((meet(shadow.place, was.place, turn) || curve.bounds().is_level()) && {
                let at = curve.at(was.place, &was.at, on_cam.at.piece);
                goes_on(self.mover.setpoint(), &at.state, &on_cam.limits)
            });
        if is_there && may_lock {
            return Choice::Lock;
        }
        if self.is_bound_for_corner() {
            return Choice::Stay;
        }
        let along = self.in_step(curve, view, &shadow, &difference, &stretch);
        match along {
            // The limits of the slave come first: if no way along the curve keeps them, it leaves the curve and
            // returns to it.
            Choice::Take(way) if way.exceeds => match self.onto_curve(curve, owner, &stretch) {
                Choice::Wait(left) => self.braking(left).map_or(Choice::Take(way), Choice::Take),
                off => off,
            },
            along => along,
        }
    }

    /// The stretch of its master's plan onto which the shadow is led.
    pub(super) fn stretch_of_master(&self, on_cam: &OnCam, view: &View<'_, P::Plan>) -> Stretch {
        let (was, now) = (&on_cam.was, &view.now);
        let cycle = self.planner.cycle();
        let turn = on_cam.camming.law.master_turn.unwrap_or(0.0);
        let step = apart(now.place, was.place, turn);
        let at = |further: f64| was.place.moved_to(was.place.position + further);
        if view.future.kind() == Kind::Still {
            return Stretch {
                begin: 0,
                end: u64::MAX,
                velocity: 0.0,
                now: at(step),
                is_ahead: false,
                is_guess: false,
            };
        }
        let scans = view.future.measured().unwrap_or(UNKNOWN);
        let velocity = if now.trembles { 0.0 } else { now.at.velocity };
        let unknown = Stretch {
            begin: 0,
            end: scans,
            velocity,
            now: at(step - velocity * cycle),
            is_ahead: false,
            is_guess: true,
        };
        let Some(lead) = self.lead_of_master(view) else {
            return unknown;
        };
        let Some((begin, end)) = self.planner.stretch(&[Some(lead), None]) else {
            return unknown;
        };
        let late = u64::from(view.future.is_late());
        let then = lead
            .plan
            .at(lead.elapsed.saturating_add(begin))
            .times(lead.factor);
        let way = then.position - lead.plan.at(lead.elapsed).position * lead.factor;
        let way = if late > 0 { way + step } else { way };
        let begin = begin.saturating_add(late);
        let further = way - then.velocity * (begin as f64 * cycle);
        Stretch {
            begin,
            end: end.saturating_add(late),
            velocity: then.velocity,
            now: at(further),
            is_ahead: further * was.at.velocity > 0.0,
            is_guess: false,
        }
    }

    /// A move onto the curve: to the master's place if the master is at rest or the curve is level, otherwise to a
    /// place that the master reaches.
    fn onto_curve(&self, curve: &Curve<'_>, owner: &Entry, stretch: &Stretch) -> Choice<P::Plan> {
        let Some(on_cam) = &self.follower.on_cam else {
            return Choice::Wait(u64::MAX);
        };
        if stretch.velocity == 0.0 || curve.bounds().is_level() {
            return match self.move_onto(curve, owner, stretch.now) {
                Ok(way) => Choice::Take(way),
                Err(error) => Choice::Fail(error),
            };
        }
        let head = curve.cam.head;
        let cycle = self.planner.cycle();
        let speed = stretch.velocity / curve.law.master_scaling;
        let forwards = speed > 0.0;
        // The distance that the master gains on a shadow that starts from rest, on the cam's side. None if the shadow
        // can't reach it at all.
        let gained = self.gained(curve, stretch);
        let Some(Ramp { gained, way }) = gained else {
            return self.never_in_step(curve, owner, stretch, head.periodic);
        };
        let (here, line) = (curve.unwound(on_cam.was.place), curve.unwound(stretch.now));
        let length = head.end - head.begin;
        let period = if head.periodic { length } else { 0.0 };
        // To be in sync at a place, its shadow starts before it.
        let starts = on_cam.camming.start_distance != 0.0;
        let goal = on_cam
            .camming
            .sync
            .map(|sync| if starts { sync - way } else { sync });
        let mut place = match goal {
            Some(_) if on_cam.is_timed => {
                let place = here + curve.left_to_sync(on_cam) - way;
                let is_past = if forwards { place < here } else { place > here };
                if is_past {
                    return Choice::Fail(ErrorId::SyncNotReachable);
                }
                place
            }
            Some(goal) => {
                let over = (here - goal) / length;
                let whole = if head.periodic { over as i64 as f64 } else { 0.0 };
                let place = goal + whole * length;
                let is_past = if forwards { place < here } else { place > here };
                let next = if is_past { period.copysign(speed) } else { 0.0 };
                place + next
            }
            None => curve.next_row(here, forwards),
        };
        let mut last = None;
        for look in 0..PLACES {
            let beyond = !head.periodic && (place < head.begin || place > head.end);
            if beyond {
                break;
            }
            let to = curve.place_of(place, on_cam.was.place);
            let way = match self.move_onto(curve, owner, to) {
                Ok(way) => way,
                Err(error) => return Choice::Fail(error),
            };
            let needed = line + speed * (way.motion.scans() as f64 * cycle);
            // The distance by which the master is there before the slave is ready.
            let missing = if forwards { needed - place } else { place - needed } + gained;
            if missing <= 0.0 {
                return Choice::Take(way);
            }
            if on_cam.is_timed {
                return Choice::Fail(ErrorId::SyncNotReachable);
            }
            if head.periodic && look + 2 >= PLACES {
                // No near place is late enough: adds as many periods as needed, and one more, because the way there
                // may differ.
                let periods = (missing / length) as i64 as f64 + 1.0;
                place += (periods * length).copysign(speed);
            } else if on_cam.camming.sync.is_some() {
                if !head.periodic {
                    break;
                }
                place += period.copysign(speed);
            } else {
                place = curve.next_row(place, forwards);
            }
            last = Some(way);
        }
        match last {
            // Onto the last place tried. From there the shadow catches up, or waits for the next period.
            Some(way) if head.periodic || self.catches_up(curve, stretch) => Choice::Take(way),
            _ => Choice::Fail(ErrorId::SyncNotReachable),
        }
    }

    /// Whether the shadow can be faster than the stretch of its master.
    fn catches_up(&self, curve: &Curve<'_>, stretch: &Stretch) -> bool {
        let [.., fastest] = self.speeds_of_shadow(curve, stretch);
        fastest > stretch.velocity.abs() * (1.0 + LEAST)
    }

    /// No shadow can get in step. On a cam with periods the slave still moves onto the curve and lags. On one without
    /// periods it fails.
    fn never_in_step(
        &self,
        curve: &Curve<'_>,
        owner: &Entry,
        stretch: &Stretch,
        periodic: bool,
    ) -> Choice<P::Plan> {
        let Some(on_cam) = &self.follower.on_cam else {
            return Choice::Wait(u64::MAX);
        };
        if !periodic || on_cam.is_timed {
            return Choice::Fail(ErrorId::SyncNotReachable);
        }
        let here = curve.unwound(on_cam.was.place);
        let forwards = stretch.velocity * curve.law.master_scaling > 0.0;
        let to = curve.place_of(curve.next_row(here, forwards), on_cam.was.place);
        match self.move_onto(curve, owner, to) {
            Ok(way) => Choice::Take(way),
            Err(error) => Choice::Fail(error),
        }
    }

    /// How a shadow that starts from rest reaches the velocity of its master; `None` if it can't.
    fn gained(&self, curve: &Curve<'_>, stretch: &Stretch) -> Option<Ramp> {
        let rest = Setpoint::default();
        let [wanted, ..] = self.speeds_of_shadow(curve, stretch);
        let limits = self.limits_of_shadow(curve, &rest, wanted)?;
        if limits.velocity <= stretch.velocity.abs() {
            return None;
        }
        let ramp = self
            .planner
            .ramp_to(&rest, stretch.velocity, &limits, &limits)
            .ok()?;
        let scans = u64::from(ramp.scans());
        let of_master = stretch.velocity * (scans as f64 * self.planner.cycle());
        let way = ramp.at(scans).position;
        Some(Ramp {
            gained: ((of_master - way) / curve.law.master_scaling).abs(),
            way: way / curve.law.master_scaling,
        })
    }

    /// A move to the place of the curve for a master at `to`.
    ///
    /// # Errors
    /// The reason why the slave may not move there.
    fn move_onto(&self, curve: &Curve<'_>, owner: &Entry, to: Place) -> Result<Way<P::Plan>, ErrorId> {
        let near = self.on_cam().map_or(0, |on_cam| on_cam.at.piece);
        let at = curve.at(to, &Setpoint::default(), near);
        let here = self.place();
        let length = self.config.modulo.unwrap_or(0.0);
        let target = off(at.place, here, length) + here.position;
        self.allowed(target)?;
        let start = self.mover.setpoint().moved_to(here.position);
        let limits = self.limits_of_approach(owner);
        let before = self.limits_before(&limits);
        let (plan, _) = self
            .moved_inside(&start, target, limits, &before)
            .map_err(refusal)?;
        if self.bars_any() {
            let (up, down) = self.planner.ways((&plan, 0));
            let barred = self.way_barred(if up > down { 1.0 } else { -1.0 });
            if let Some(error) = barred.filter(|_| up + down > 0.0) {
                return Err(error);
            }
        }
        let rung = Rung::Moving {
            turns: here.turns,
            to: Some(to),
        };
        Ok(Way {
            lock: plan.scans().into(),
            ..Way::by(plan, rung, Approach::Move, target, Limits::NONE)
        })
    }

    /// Increases the place of the shadow by a period.
    fn lap_shadow(&mut self, by: f64, scope: &Scope<'_>) {
        let Some(on_cam) = self.follower.on_cam else {
            return;
        };
        if let Some(curve) = on_cam.stored_curve(&scope.cams) {
            self.move_shadow(&curve, by);
        }
    }

    /// Starts `way`.
    pub(super) fn take_way_on_cam(&mut self, way: Way<P::Plan>, scope: &mut Scope<'_>) {
        let limits = self.slowed(&self.parameters.limits);
        let before = self.limits_before(&limits);
        let scans = way.motion.scans();
        // A move of its own ends at rest.
        let from = matches!(way.rung, Rung::Moving { .. }).then_some(0.0);
        self.start_way(way.motion, limits, before, from);
        let mut is_told = false;
        if let Some(on_cam) = &mut self.follower.on_cam {
            // If the master's motion is not known, the same way along the curve is found many times.
            let is_along = |rung| {
                matches!(
                    rung,
                    Rung::BesideLine { .. } | Rung::BesideMaster | Rung::BesideMeasured { .. }
                )
            };
            let goes_on = is_along(on_cam.rung) && is_along(way.rung) && on_cam.told == Some(way.name);
            is_told = goes_on && !on_cam.known[0].is_foreseen();
            on_cam.told = Some(way.name);
            on_cam.rung = way.rung;
            on_cam.is_timed = false;
            on_cam.left = way.left;
            on_cam.shadow_limits = way.shadow;
            on_cam.slows = way.slows;
            if matches!(way.rung, Rung::Moving { .. }) {
                on_cam.shadow = None;
            }
        }
        if !is_told {
            let event = Event::OntoCam {
                way: way.name,
                value: way.velocity,
                scans: u32::try_from(scans).unwrap_or(u32::MAX),
            };
            self.record(event, &mut self.owner_scope(scope));
        }
    }

    /// A way to rest, within the limits of the slave. The way onto the curve is searched again after this number of
    /// scans.
    fn braking(&self, left: u64) -> Option<Way<P::Plan>> {
        let here = self.place();
        let start = self.mover.setpoint().moved_to(here.position);
        let limits = self.slowed(&self.parameters.limits);
        let before = self.limits_before(&limits);
        let plan = self.planner.ramp_to(&start, 0.0, &limits, &before).ok()?;
        let rung = Rung::Moving {
            turns: here.turns,
            to: None,
        };
        Some(Way {
            left,
            ..Way::by(plan, rung, Approach::Pace, 0.0, Limits::NONE)
        })
    }

    /// There is no way now: the slave stays at rest, or comes to rest.
    pub(super) fn wait_on_cam(&mut self, left: u64, scope: &mut Scope<'_>) {
        if !self.mover.setpoint().is_at_rest() {
            return match self.braking(left) {
                Some(way) => self.take_way_on_cam(way, scope),
                None => self.fail(ErrorId::DeviationTooLarge, scope),
            };
        }
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.rung = Rung::Waiting;
            on_cam.left = left;
        }
        self.mover.hold();
    }

    /// The owner can't get onto its cam.
    #[cold]
    fn give_up_cam(&mut self, error: ErrorId, scope: &mut Scope<'_>) {
        match error {
            ErrorId::PositiveBarred | ErrorId::NegativeBarred | ErrorId::OutwardFromLimitSwitch => {
                if let Some(on_cam) = &mut self.follower.on_cam {
                    on_cam.rung = Rung::Due;
                }
                self.pause(error, scope);
                return;
            }
            _ => {}
        }
        let Some(owner) = self.owner else { return };
        let scope = &mut self.owner_scope(scope);
        self.refuse_plan(&owner, error, scope);
        self.halt_failed(&owner, error, scope);
    }
}

impl Curve<'_> {
    /// The position of the next row of the table for a master that moves from `x`; neither is reduced to one period.
    /// Infinite on a cam without periods if there is none.
    fn next_row(&self, x: f64, forwards: bool) -> f64 {
        let cam = &self.cam;
        let (first, length) = (cam.head.begin, cam.head.end - cam.head.begin);
        let base = if cam.head.periodic {
            let over = (x - first) / length;
            let whole = over as i64 as f64;
            length * if whole > over { whole - 1.0 } else { whole }
        } else {
            0.0
        };
        let within = x - base;
        let slack = LEAST * length;
        let look = if forwards { within + slack } else { within - slack };
        let (begin, end) = cam.ends_of(cam.find(look, 0));
        let (is_before, is_behind) = (look < begin, look >= cam.head.end);
        match (forwards, cam.head.periodic) {
            (true, _) if is_before => base + begin,
            (true, true) if is_behind => base + length + cam.ends_of(0).1,
            (true, false) if is_behind || end >= cam.head.end => f64::INFINITY,
            (true, _) => base + end,
            (false, false) if is_behind => base + end,
            (false, true) if is_before => base - length + cam.ends_of(u16::MAX).0,
            (false, false) if is_before || begin <= first => f64::NEG_INFINITY,
            (false, _) => base + begin,
        }
    }
}

/// Whether a motion may change from one state to another at the same place: each derivative that `limits` do not let
/// jump is equal.
pub(super) fn goes_on(last: &Setpoint, next: &Setpoint, limits: &Limits) -> bool {
    let near = |one: f64, other: f64, limit: f64, bound: f64| {
        !bound.is_finite() || (one - other).abs() <= ROUNDING * limit
    };
    let rate = limits.acceleration.max(limits.deceleration);
    near(last.velocity, next.velocity, limits.velocity, rate)
        && near(last.acceleration, next.acceleration, rate, limits.jerk)
        && near(last.jerk, next.jerk, limits.jerk, limits.snap)
}
