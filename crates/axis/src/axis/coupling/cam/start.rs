//! MC_CamIn with a MasterStartDistance: a start that waits for a position of the master, and a way that is in sync at
//! its sync position.

use super::super::super::Axis;
use super::super::super::commands::{Camming, Entry, ROUNDING};
use super::super::sync::NotInTime;
use super::super::view::{Seen, View};
use super::onto::Choice;
use super::{Curve, OnCam, Rung};
use crate::{AxisId, ErrorId, Event, Scope};
use standstill_planner::turns::split;
use standstill_planner::{CamHead, Place, Plan, Planner};

impl Camming {
    /// The place of the cam at its master, which was at `was` at the end of the last scan, and the place of the cam
    /// there.
    pub(in crate::axis::coupling) fn laid(&self, was: Place, head: &CamHead) -> (Place, f64) {
        let place = Place {
            turns: was.turns,
            position: self.master_offset,
            phase: if self.master_absolute {
                0.0
            } else {
                was.position + was.phase
            },
        };
        // A cam with relative master positions begins at the master's place.
        (place, if self.master_absolute { 0.0 } else { head.begin })
    }
}

impl<P: Planner> Axis<P> {
    /// Notes the place of the owner's cam, which was fixed while it waited for its start point.
    pub(in crate::axis::coupling) fn note_start_on_cam(&mut self, laid: Option<(Place, f64)>) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.begins = laid;
            on_cam.is_timed = true;
        }
    }

    /// Checks that a cam that starts now is in sync in time, behind a master `seen` there and at the place `laid`
    /// before.
    pub(in crate::axis::coupling) fn cam_starts(
        &mut self,
        entry: &Entry,
        camming: Camming,
        (seen, laid): (Seen, Option<(Place, f64)>),
        view: &View<'_, P::Plan>,
        scope: &Scope<'_>,
    ) -> Result<(), NotInTime> {
        let on_cam = OnCam {
            was: seen,
            begins: laid,
            is_timed: true,
            ..OnCam::new(camming, self.slowed(&self.parameters.limits), self.frame.moves())
        };
        let gear = self.follower.coupling.take();
        let own = self.follower.on_cam.replace(on_cam);
        let found = self.way_at_start_on_cam(entry, view, scope);
        self.follower.on_cam = own;
        self.follower.coupling = gear;
        found
    }

    fn way_at_start_on_cam(
        &mut self,
        entry: &Entry,
        view: &View<'_, P::Plan>,
        scope: &Scope<'_>,
    ) -> Result<(), NotInTime> {
        let master = self.master_on_cam().map_or(0, AxisId::number);
        let not_at_all = |error| ("Master", f64::from(master), f64::NAN, error);
        self.gear_motion(entry, self.mover.setpoint())
            .map_err(not_at_all)?;
        let cam = self.on_cam().map(|on_cam| on_cam.camming.cam);
        let cam = cam.and_then(|id| scope.cams.cam(id));
        let Some(curve) = cam.and_then(|cam| self.lay_cam(cam)) else {
            return Err(("CamTableID", 0.0, f64::NAN, ErrorId::CamUnknown));
        };
        let keeps = self.keeps_on_cam(&curve, view, false).is_ok();
        let choice = self.choose(&curve, view, entry, keeps);
        let Some(on_cam) = &self.follower.on_cam else {
            return Ok(());
        };
        let distance = on_cam.camming.start_distance;
        let too_short = |least| ("MasterStartDistance", distance, least, ErrorId::SyncNotReachable);
        let way = match choice {
            Choice::Lock => return Ok(()),
            Choice::Take(way) => way,
            Choice::Fail(ErrorId::SyncNotReachable) | Choice::Stay | Choice::Wait(_) => {
                return Err(too_short(f64::NAN));
            }
            Choice::Fail(error) => return Err(not_at_all(error)),
        };
        if way.lock == u64::MAX {
            return Err(too_short(f64::NAN));
        }
        let heading = 1.0_f64.copysign(distance);
        let further = match way.rung {
            // The slave is there in time, and in sync from that place of the master on.
            Rung::Moving { to: Some(to), .. } => curve.unwound(to) - curve.unwound(on_cam.was.place),
            _ => self.way_of_cam_master(view, way.lock) / curve.law.master_scaling,
        };
        let late = heading * (further - curve.left_to_sync(on_cam));
        if late > ROUNDING * (distance.abs() + curve.cam.head.end.abs()) {
            return Err(too_short(distance + heading * late));
        }
        Ok(())
    }

    /// The distance (u) that the master covers in this many scans from the end of the last one, as far as is known.
    fn way_of_cam_master(&self, view: &View<'_, P::Plan>, scans: u64) -> f64 {
        let even = view.now.at.velocity * self.planner.cycle();
        match self.lead_of_master(view) {
            Some(lead) => {
                let late = u64::from(view.future.is_late());
                let to = lead.elapsed.saturating_add(scans.saturating_sub(late));
                let way = lead.plan.at(to).position - lead.plan.at(lead.elapsed).position;
                way * lead.factor + if late > 0 { even } else { 0.0 }
            }
            None => even * scans as f64,
        }
    }

    /// In sync for the first time: records if the master has passed its sync position by more than a scan.
    pub(super) fn note_sync_on_cam(&self, scope: &mut Scope<'_>) {
        let Some(on_cam) = &self.follower.on_cam else {
            return;
        };
        let (Some(sync), Some(cam)) = (on_cam.camming.sync, scope.cams.cam(on_cam.camming.cam)) else {
            return;
        };
        let (distance, scaling) = (on_cam.camming.start_distance, on_cam.camming.law.master_scaling);
        if distance == 0.0 {
            return;
        }
        let length = cam.head.end - cam.head.begin;
        let past = (on_cam.at.x - sync) * 1.0_f64.copysign(distance);
        let past = if cam.head.periodic {
            split(past, length).1
        } else {
            past
        };
        // More than half a period behind means ahead of the next one.
        let is_before = cam.head.periodic && past > 0.5 * length;
        let speed = on_cam.shadow.map_or(0.0, |shadow| shadow.at.velocity.abs());
        let by = past * scaling.abs();
        if !is_before && by > speed * self.planner.cycle() + ROUNDING * length {
            self.record(Event::SyncLate { by }, &mut self.owner_scope(scope));
        }
    }
}

impl Curve<'_> {
    /// The distance from the master to its sync position (u of the cam's master side), in the direction in which it
    /// starts.
    pub(super) fn left_to_sync(&self, on_cam: &OnCam) -> f64 {
        let head = self.cam.head;
        let heading = 1.0_f64.copysign(on_cam.camming.start_distance);
        let left = heading * (on_cam.camming.sync.unwrap_or(0.0) - self.unwound(on_cam.was.place));
        let left = if head.periodic {
            split(left, head.end - head.begin).1
        } else {
            left
        };
        heading * left
    }
}
