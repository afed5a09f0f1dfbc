//! A shadow many turns behind its master. A place relative to a point many turns away is as coarse as that distance,
//! and so is a motion along it. Therefore the place of the shadow is renewed in its present turn, and its way is
//! planned again from there.

use super::super::super::modulo::is_far;
use super::super::super::{Axis, Motion};
use super::super::view::View;
use super::{Curve, Rung};
use crate::Scope;
use standstill_planner::turns::split;
use standstill_planner::{Place, Planner};

impl Curve<'_> {
    /// Whether a distance (u of the master) is several turns long.
    pub(super) fn is_long(&self, way: f64) -> bool {
        self.law.master_turn.is_some_and(|turn| is_far(way, turn))
    }

    /// A place of the master, expressed in its own turn if it was expressed from many turns away.
    pub(super) fn told_near(&self, place: Place) -> Place {
        match self.law.master_turn {
            Some(turn) if self.is_long(place.position) => {
                let (turns, position) = split(place.position, turn);
                Place {
                    turns: place.turns.wrapping_add(turns),
                    position,
                    ..place
                }
            }
            _ => place,
        }
    }
}

impl<P: Planner> Axis<P> {
    /// Expresses the place of the shadow in its own turn.
    pub(super) fn tell_shadow_near(&mut self, curve: &Curve<'_>) {
        if let Some(shadow) = self
            .follower
            .on_cam
            .as_mut()
            .and_then(|on_cam| on_cam.shadow.as_mut())
        {
            shadow.place = curve.told_near(shadow.place);
        }
    }

    /// After a long part of its way the shadow continues with a plan that starts at its present place. Cost: one
    /// plan.
    pub(super) fn go_on_from_near(&mut self, view: &View<'_, P::Plan>, scope: &Scope<'_>) {
        let Some(on_cam) = self.follower.on_cam else {
            return;
        };
        let (Some(mut shadow), Some(curve)) = (on_cam.shadow, on_cam.stored_curve(&scope.cams)) else {
            return;
        };
        let Rung::BesideLine {
            start,
            velocity,
            begin,
        } = on_cam.rung
        else {
            return;
        };
        let Motion::Closing { elapsed, .. } = self.mover.motion() else {
            return;
        };
        let line = velocity * (*elapsed as f64 * self.planner.cycle());
        let gone = shadow.place.position - start.position;
        if on_cam.slows || !(curve.is_long(line) || curve.is_long(gone)) {
            return;
        }
        shadow.place = curve.told_near(shadow.place);
        let stretch = self.stretch_of_master(&on_cam, view);
        let limits = &on_cam.shadow_limits;
        let has_goal = begin != u64::MAX;
        let way = if has_goal {
            self.beside_stretch_of_master(&shadow, &stretch, limits, &curve, 0.0)
        } else {
            self.at_shadow_pace(view, &shadow, &stretch, limits)
        };
        let Some(on_cam) = &mut self.follower.on_cam else {
            return;
        };
        match way.filter(|way| !way.exceeds) {
            Some(way) => {
                on_cam.shadow = Some(shadow);
                on_cam.rung = way.rung;
                self.mover.go_on(way.motion);
            }
            None => on_cam.left = 0,
        }
    }
}
