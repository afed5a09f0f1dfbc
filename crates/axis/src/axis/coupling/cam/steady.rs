//! A scan in which nothing is new for a slave in sync, like [`steady`](super::super::steady) for a slave in gear.

use super::super::super::Axis;
use super::super::view::{Kind, Source};
use super::{OnCam, Shadow};
use crate::{Scope, ValueSource};
use standstill_planner::{Limits, Planner};

impl OnCam {
    /// Whether the cam permits a next step in which nothing is new. The slave is in sync with the set-point of its
    /// master, the cam is not over and has no corners, the slave has these limits, and its coordinates were shifted
    /// this number of times.
    pub(in crate::axis::coupling) fn may_go_on(&self, limits: &Limits, moves: u32) -> bool {
        self.rung.is_locked()
            && self.camming.source == ValueSource::Set
            && self.anchor.is_some()
            && !self.ends.is_over()
            && !self.has_corners()
            && self.known[0].kind == Kind::Plan
            && self.moves == moves
            && self.limits == *limits
            && self.left == u64::MAX
    }
}

impl<P: Planner> Axis<P> {
    /// [`Axis::follow_steadily`] on a cam, with a master that follows this `plan`: its axis, and the scans after its
    /// start. A scan in which an end of the cam is reached also counts as new.
    ///
    /// Cost: one evaluation of the cam.
    pub(in crate::axis::coupling) fn follow_cam_steadily(
        &mut self,
        master: &Self,
        plan: (usize, u64),
        scope: &mut Scope<'_>,
    ) -> bool {
        let (Some(on_cam), Some(room)) = (&mut self.follower.on_cam, &self.follower.steady.room) else {
            return false;
        };
        let (Some(anchor), Some(cam)) = (&on_cam.anchor, scope.cams.cam(on_cam.camming.cam)) else {
            return false;
        };
        if !on_cam.known[0].goes_on(plan) {
            return false;
        }
        let place = master.place();
        let moving = master.mover.setpoint().moved_to(place.position);
        let law = &on_cam.camming.law;
        let at = law.at(&cam, anchor, place, &moving, on_cam.at.piece);
        let mut ends = on_cam.ends;
        if ends.note(&cam, &at).is_some() || !room.holds(&at.state) {
            return false;
        }
        (_, on_cam.known[0].elapsed) = plan;
        on_cam.ends = ends;
        on_cam.at = at;
        on_cam.shadow = Some(Shadow { place, at: moving });
        self.follower.steady.source = Source::Other;
        self.publish_steadily(at.place, at.state, scope);
        true
    }
}
