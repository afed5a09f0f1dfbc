//! What follows a cam at its end: another cam on which the slave may stay in sync, or whatever else waits.

use super::super::super::Axis;
use super::super::super::commands::Camming;
use super::super::follow::off;
use super::super::needs::RESOLVED;
use super::super::view::View;
use super::ends::Passed;
use super::onto::goes_on;
use super::{Curve, OnCam, Rung, Shadow};
use crate::{Event, Scope};
use standstill_planner::{Anchor, CamLaw, Place, Planner};

/// Where a cam ended.
#[derive(Clone, Copy)]
struct Ended {
    /// By how much the master is past it (u), with its sign.
    over: f64,
    /// Of the slave.
    slave: Place,
    /// The master goes up.
    upwards: bool,
}

impl<P: Planner> Axis<P> {
    /// The slave has moved: whether it has come to an end of its cam, and what follows then.
    pub(super) fn end_of_cam(&mut self, view: &View<'_, P::Plan>, scope: &mut Scope<'_>) {
        let is_paused = self.is_paused();
        let Some(on_cam) = self.on_cam.as_mut().filter(|_| !is_paused) else {
            return;
        };
        let (Some(cam), Some(shadow)) = (scope.cams.cam(on_cam.camming.cam), on_cam.shadow) else {
            return;
        };
        let at = on_cam.at;
        let Some(passed) = on_cam.ends.note(&cam, &at) else {
            if on_cam.ends.is_over() && !self.queue.is_empty() {
                self.hand_over(self.setpoint.position, scope);
            }
            return;
        };
        self.cam_ends = self.cam_ends.wrapping_add(1);
        let ended = on_cam.curve(cam).map(|curve| ended(&curve, &passed, &shadow));
        if passed.ends > 1 {
            let periods = passed.ends;
            self.record(Event::CamPassed { periods }, &mut self.owner_scope(scope));
        }
        if self.queue.is_empty() {
            return;
        }
        let before = self.values_on_cam();
        let was = self.on_cam.map(|on_cam| (on_cam.was, on_cam.known));
        let is_locked = self.is_locked_on_cam();
        self.hand_over(self.setpoint.position, scope);
        let goes_on = before == self.values_on_cam() && self.is_now_due();
        if let (true, Some(ended), Some((was, known))) = (goes_on, ended, was) {
            if let Some(on_cam) = &mut self.on_cam {
                on_cam.was = was;
                on_cam.known = known;
            }
            self.go_on_behind(&ended, &shadow, is_locked, view, scope);
        }
    }

    /// A cam has just become the owner's.
    fn is_now_due(&self) -> bool {
        let is_new = |on_cam: &OnCam| on_cam.rung == Rung::Due && on_cam.anchor.is_none();
        self.on_cam.as_ref().is_some_and(is_new)
    }

    /// The next cam begins where the one before ended. Where both meet, the slave stays in sync.
    fn go_on_behind(
        &mut self,
        ended: &Ended,
        shadow: &Shadow,
        is_locked: bool,
        view: &View<'_, P::Plan>,
        scope: &mut Scope<'_>,
    ) {
        let Some(on_cam) = &self.on_cam else { return };
        let Some(cam) = scope.cams.cam(on_cam.camming.cam) else {
            return;
        };
        let Some((camming, anchor)) = self.laid_behind(on_cam, &cam, ended, shadow) else {
            return;
        };
        let curve = Curve {
            cam,
            law: camming.law,
            anchor,
        };
        let at = curve.at(shadow.place, &shadow.at, 0);
        let length = self.modulo.as_ref().map_or(0.0, |modulo| modulo.length);
        let here = self.place();
        let resolved = RESOLVED * 4.0 * (here.position.abs() + at.place.position.abs() + length);
        let limits = self.slowed(&self.parameters.limits);
        let meets =
            off(here, at.place, length).abs() <= resolved && goes_on(&self.setpoint, &at.state, &limits);
        let keeps = self.keeps_on_cam(&curve, view, true).is_ok();
        if let Some(on_cam) = &mut self.on_cam {
            on_cam.camming.law = camming.law;
            on_cam.anchor = Some(anchor);
            on_cam.laid = anchor.slave.phase;
            on_cam.at = at;
            if meets {
                on_cam.shadow = Some(*shadow);
            }
            let _begun = on_cam.ends.note(&cam, &at);
        }
        if meets && keeps && is_locked {
            self.lock_on_cam(scope);
        }
    }

    /// Where the next cam lies if it is counted from the end of the one before.
    fn laid_behind(
        &self,
        on_cam: &OnCam,
        cam: &standstill_planner::Cam<'_>,
        ended: &Ended,
        shadow: &Shadow,
    ) -> Option<(Camming, Anchor)> {
        let mut camming = on_cam.camming;
        if camming.master_absolute {
            return None;
        }
        let forwards = ended.upwards == (camming.law.master_scaling > 0.0);
        let first = if forwards { cam.head.begin } else { cam.head.end };
        camming.law.origin = first + ended.over / camming.law.master_scaling;
        let master = Place {
            turns: shadow.place.turns,
            position: camming.master_offset,
            phase: shadow.place.position,
        };
        let mut anchor = Anchor {
            master,
            slave: Place {
                position: camming.slave_offset,
                ..Place::default()
            },
            ..Anchor::default()
        };
        if !camming.slave_absolute {
            let straight = CamLaw {
                slave_turn: None,
                ..camming.law
            };
            let without = Anchor {
                slave: Place::default(),
                ..anchor
            };
            let begins = Place {
                position: shadow.place.position - ended.over,
                ..shadow.place
            };
            let on_curve = straight.at(cam, &without, begins, &shadow.at, 0).place.position;
            anchor.slave = Place {
                phase: camming.slave_offset - on_curve,
                ..ended.slave
            };
        } else if self.modulo.is_some() {
            // Which turn is meant is found as for any cam.
            return None;
        }
        Some((camming, anchor))
    }
}

/// Where a cam ended that has just been passed by a shadow there.
fn ended(curve: &Curve<'_>, passed: &Passed, shadow: &Shadow) -> Ended {
    let head = curve.cam.head;
    let end = if head.periodic {
        head.begin + passed.end as f64 * (head.end - head.begin)
    } else if passed.forwards {
        head.end
    } else {
        head.begin
    };
    let over = (curve.unwound(shadow.place) - end) * curve.law.master_scaling;
    let place = Place {
        position: shadow.place.position - over,
        ..shadow.place
    };
    Ended {
        over,
        slave: curve.at(place, &shadow.at, 0).place,
        upwards: passed.forwards == (curve.law.master_scaling > 0.0),
    }
}
