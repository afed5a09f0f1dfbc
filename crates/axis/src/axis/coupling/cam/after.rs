//! The change from a cam to the next command, at an end of the cam or at a given position. The next command may be a
//! cam on which the slave stays in sync.
//!
//! If the next cam meets the present one with all derivatives that the slave's order needs, the slave is on the next
//! cam in the scan in which its master passes that position. If not, the slave ends that scan on the present cam. It
//! then gets onto the next cam like onto any other.

use super::super::super::Axis;
use super::super::super::commands::{Camming, ROUNDING, Work};
use super::super::super::feedback::nearest;
use super::super::follow::off;
use super::super::needs::RESOLVED;
use super::super::view::View;
use super::ends::Passed;
use super::onto::goes_on;
use super::{Curve, OnCam, Rung, Shadow};
use crate::{ErrorId, Event, Scope};
use standstill_planner::{Anchor, Cam, CamLaw, Place, Planner, Setpoint};

/// The point where a cam ends and the next command takes over.
#[derive(Clone, Copy)]
struct Ended {
    /// The place of the master there, and the signed distance (u) by which the master has passed it.
    master: Place,
    over: f64,
    /// The place of the slave there.
    slave: Place,
    /// The master moves in positive direction.
    upwards: bool,
}

impl<P: Planner> Axis<P> {
    /// The slave has moved, and its shadow was at `was` before. Checks whether the slave has reached an end of its
    /// cam, and starts the next command.
    pub(super) fn end_of_cam(
        &mut self,
        was: Option<Shadow>,
        view: &View<'_, P::Plan>,
        scope: &mut Scope<'_>,
    ) {
        let is_paused = self.is_paused();
        let switch = self.switch_of_next();
        let cycle = self.planner.cycle();
        let Some(on_cam) = self.follower.on_cam.as_mut().filter(|_| !is_paused) else {
            return;
        };
        let (Some(curve), Some(shadow)) = (on_cam.stored_curve(&scope.cams), on_cam.shadow) else {
            return;
        };
        let cam = curve.cam;
        if !on_cam.rung.is_locked() && curve.is_ahead_past_end(shadow.place, view.now.place) {
            return;
        }
        let at = on_cam.at;
        let passed = on_cam.ends.note(&cam, &at);
        let is_over = on_cam.ends.is_over();
        let ended = match (switch, &passed) {
            (Some(place), _) if !is_over => {
                let here = curve.unwound(shadow.place);
                let before = if on_cam.rung.is_locked() {
                    curve.unwound(on_cam.was.place)
                } else {
                    let step = shadow.at.velocity * cycle / curve.law.master_scaling;
                    let before = was.map_or(here - step, |was| curve.unwound(was.place));
                    // Whole periods may have been dropped since, so it is not exact to the last bit.
                    let period = if cam.head.periodic {
                        cam.head.end - cam.head.begin
                    } else {
                        f64::INFINITY
                    };
                    nearest(before, here - step, period) - step * ROUNDING
                };
                curve
                    .passes(place, before, here)
                    .map(|x| curve.ended(x, here > before, &shadow))
            }
            (_, Some(passed)) => Some(curve.ended(curve.end(passed), passed.forwards, &shadow)),
            _ => None,
        };
        if let Some(passed) = passed {
            self.count_end(&passed, scope);
        }
        if self.queue.is_empty() && is_over {
            return self.stay_at_end(view, scope);
        }
        if self.queue.is_empty() || !(ended.is_some() || is_over) {
            return;
        }
        let before = self.values_on_cam();
        let was = self.follower.on_cam.map(|on_cam| (on_cam.was, on_cam.known));
        self.hand_over(self.mover.setpoint().position, scope);
        let goes_on = before == self.values_on_cam() && self.is_now_due();
        if let (true, Some(ended), Some((was, known))) = (goes_on, ended, was) {
            if let Some(on_cam) = &mut self.follower.on_cam {
                on_cam.was = was;
                on_cam.known = known;
            }
            self.go_on_behind(&ended, &shadow, scope);
        }
    }

    /// Counts an end that was reached, and records that there were several in this scan.
    fn count_end(&mut self, passed: &Passed, scope: &mut Scope<'_>) {
        self.follower.cam_ends = self.follower.cam_ends.wrapping_add(1);
        if passed.ends > 1 {
            let periods = passed.ends;
            self.record(Event::CamPassed { periods }, &mut self.owner_scope(scope));
        }
    }

    /// The cam is over: the slave holds its last place, even if its shadow passed the end on a way that leads back.
    /// It reaches an end that is a corner, except for rounding, within the last scan of its way, and is at rest at
    /// the end of that scan.
    pub(super) fn stay_at_end(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        if self.is_locked_on_cam() || self.is_coming_to_corner() {
            return;
        }
        if !self.mover.setpoint().is_at_rest() {
            return self.fail(ErrorId::DeviationTooLarge, scope);
        }
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.shadow = Some(Shadow::of(&view.now));
        }
        self.lock_on_cam(scope);
    }

    /// The position in the present cam at which the next cam takes over, if a cam waits and the position is not the
    /// end.
    fn switch_of_next(&self) -> Option<f64> {
        match self.queue.first()?.work {
            Work::Cam(camming) => camming.switch_at,
            _ => None,
        }
    }

    /// Whether the owner has just got a cam.
    fn is_now_due(&self) -> bool {
        let is_new = |on_cam: &OnCam| on_cam.rung == Rung::Due && on_cam.anchor.is_none();
        self.on_cam().is_some_and(is_new)
    }

    /// The next cam begins where the last one ended, and the slave gets onto it.
    fn go_on_behind(&mut self, ended: &Ended, shadow: &Shadow, scope: &Scope<'_>) {
        let Some(mut on_cam) = self.follower.on_cam else {
            return;
        };
        let Some(cam) = scope.cams.cam(on_cam.camming.cam) else {
            return;
        };
        let Some(curve) = self.laid_behind(&mut on_cam, cam, ended, shadow) else {
            return;
        };
        on_cam.at = curve.at(shadow.place, &shadow.at, 0);
        if self.goes_on_at(
            &(self.place(), *self.mover.setpoint()),
            &(on_cam.at.place, on_cam.at.state),
        ) {
            on_cam.shadow = Some(*shadow);
        }
        let _begun = on_cam.ends.note(&cam, &curve.at(ended.master, &shadow.at, 0));
        self.follower.on_cam = Some(on_cam);
    }

    /// In sync, before the step of this scan: switches to a waiting cam if the master passes the position at which it
    /// takes over and both cams meet there. The slave is on the new cam in the same scan. Returns whether it is.
    pub(super) fn switches_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) -> bool {
        let Some((next, passed)) = self.next_cam_met(view, scope) else {
            return false;
        };
        let shadow = Shadow::of(&view.now);
        let before = self.values_on_cam();
        self.hand_over(self.mover.setpoint().position, scope);
        if !(before == self.values_on_cam() && self.is_now_due()) {
            return false;
        }
        if let Some(passed) = passed {
            self.count_end(&passed, scope);
        }
        self.follower.on_cam = Some(next);
        self.lock_on_cam(scope);
        self.publish_on_cam(&next.at, shadow, scope);
        true
    }

    /// The next cam at the end of this scan, if it takes over in this scan and meets the present one; also the end of
    /// the present one, if it was passed.
    fn next_cam_met(
        &mut self,
        view: &View<'_, P::Plan>,
        scope: &Scope<'_>,
    ) -> Option<(OnCam, Option<Passed>)> {
        let Work::Cam(camming) = self.queue.first().filter(|entry| entry.barred.is_none())?.work else {
            return None;
        };
        let own = self.follower.on_cam?;
        let is_same_master = Some((camming.master, camming.source)) == self.values_on_cam();
        if !is_same_master || self.mover.layer().is_some() || own.ends.is_over() {
            return None;
        }
        let curve = own.stored_curve(&scope.cams)?;
        let cam = scope.cams.cam(camming.cam)?;
        let now = Shadow::of(&view.now);
        let (before, here) = (curve.unwound(own.was.place), curve.unwound(now.place));
        let mut ends = own.ends;
        let passed = ends.note(&curve.cam, &curve.at(now.place, &now.at, own.at.piece));
        let (x, forwards) = match camming.switch_at {
            Some(place) => (curve.passes(place, before, here)?, here > before),
            None => {
                let passed = passed.as_ref()?;
                (curve.end(passed), passed.forwards)
            }
        };
        let ended = curve.ended(x, forwards, &now);
        let limits = self.slowed(&self.parameters.limits);
        let mut next = OnCam {
            was: own.was,
            known: own.known,
            shadow: Some(now),
            ..OnCam::new(camming, limits, self.frame.moves())
        };
        let new = self.laid_behind(&mut next, cam, &ended, &now)?;
        let (last, first) = (
            curve.at(ended.master, &now.at, own.at.piece),
            new.at(ended.master, &now.at, 0),
        );
        let meets = self.goes_on_at(&(last.place, last.state), &(first.place, first.state));
        if !meets {
            return None;
        }
        let _begun = next.ends.note(&cam, &first);
        next.at = new.at(now.place, &now.at, first.piece);
        self.follower.on_cam = Some(next);
        let keeps = self.keeps_on_cam(&new, view, false).is_ok();
        self.follower.on_cam = Some(own);
        keeps.then_some((next, passed))
    }

    /// Whether the motion may change from one state to the other: the place is the same, and so is each derivative
    /// that the limits do not let jump.
    fn goes_on_at(&self, last: &(Place, Setpoint), next: &(Place, Setpoint)) -> bool {
        let length = self.config.modulo.unwrap_or(0.0);
        let numbers = last.0.position.abs() + next.0.position.abs() + length;
        let limits = self.slowed(&self.parameters.limits);
        let is_there = off(last.0, next.0, length).abs() <= RESOLVED * 4.0 * numbers;
        is_there && goes_on(&last.1, &next.1, &limits)
    }

    /// The cam of `next`, placed so that it continues where the last one ended. The master is at `now`.
    fn laid_behind<'a>(
        &self,
        next: &mut OnCam,
        cam: Cam<'a>,
        ended: &Ended,
        now: &Shadow,
    ) -> Option<Curve<'a>> {
        let camming = &mut next.camming;
        let master = if camming.master_absolute {
            camming.laid(next.was.place, cam.head).0
        } else {
            let forwards = ended.upwards == (camming.law.master_scaling > 0.0);
            let first = if forwards { cam.head.begin } else { cam.head.end };
            camming.law.origin = first + ended.over / camming.law.master_scaling;
            Place {
                turns: now.place.turns,
                position: camming.master_offset,
                phase: now.place.position + now.place.phase,
            }
        };
        let slave = self.slave_behind(camming, &cam, master, ended, now);
        let anchor = Anchor {
            master,
            slave,
            ..Anchor::default()
        };
        next.anchor = Some(anchor);
        next.laid = anchor.slave.phase;
        next.curve(cam)
    }

    /// The place of the next cam on the slave's side.
    fn slave_behind(
        &self,
        camming: &Camming,
        cam: &Cam<'_>,
        master: Place,
        ended: &Ended,
        now: &Shadow,
    ) -> Place {
        let at = |law: &CamLaw, slave: Place| {
            let anchor = Anchor {
                master,
                slave,
                ..Anchor::default()
            };
            law.at(cam, &anchor, ended.master, &now.at, 0).place
        };
        if !camming.slave_absolute {
            let straight = CamLaw {
                slave_turn: None,
                ..camming.law
            };
            return Place {
                phase: camming.slave_offset - at(&straight, Place::default()).position,
                ..ended.slave
            };
        }
        let mut slave = Place::new(0, camming.slave_offset);
        if let Some(modulo) = &self.modulo {
            // The nearest of the turns for the same position.
            let away = off(ended.slave, at(&camming.law, slave), modulo.length) / modulo.length;
            let nearest = if away < 0.0 { away - 0.5 } else { away + 0.5 };
            slave.turns = nearest as i64;
        }
        slave
    }
}

impl Curve<'_> {
    /// The end that was passed, as a place on the master's side (u), not reduced to one period.
    fn end(&self, passed: &Passed) -> f64 {
        let head = self.cam.head;
        if head.periodic {
            head.begin + passed.end as f64 * (head.end - head.begin)
        } else if passed.forwards {
            head.end
        } else {
            head.begin
        }
    }

    /// Whether a shadow passed an end of a cam without periods because its master braked, while the master itself is
    /// not there yet. The shadow will move back.
    fn is_ahead_past_end(&self, shadow: Place, master: Place) -> bool {
        let head = self.cam.head;
        let (shadow, master) = (self.unwound(shadow), self.unwound(master));
        let is_behind = shadow >= head.end && master < head.end;
        let is_before = shadow <= head.begin && master > head.begin;
        !head.periodic && (is_behind || is_before)
    }

    /// The point at which `place` of the cam (u of the master's side) is passed between `before` and `here`. None of
    /// these is reduced to one period. On a cam with periods it may be in any period.
    fn passes(&self, place: f64, before: f64, here: f64) -> Option<f64> {
        let head = self.cam.head;
        let length = head.end - head.begin;
        let is_in = |x: f64| {
            let forwards = before < x && x <= here;
            forwards || (here <= x && x < before)
        };
        if !head.periodic {
            return is_in(place).then_some(place);
        }
        let whole = ((here - place) / length) as i64 as f64;
        [whole - 1.0, whole, whole + 1.0]
            .into_iter()
            .map(|periods| place + periods * length)
            .find(|x| is_in(*x))
    }

    /// The end of the cam at `x` of the master's side, not reduced to one period. From there on `now` leads the
    /// slave.
    fn ended(&self, x: f64, forwards: bool, now: &Shadow) -> Ended {
        let over = (self.unwound(now.place) - x) * self.law.master_scaling;
        let master = now.place.moved_to(now.place.position - over);
        Ended {
            master,
            over,
            slave: self.at(master, &now.at, 0).place,
            upwards: forwards == (self.law.master_scaling > 0.0),
        }
    }
}
