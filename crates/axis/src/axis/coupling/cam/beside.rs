//! The part of its limits that a slave in sync leaves: to a shift between it and its master, to the master itself
//! (`on_limit` `slow_master`), and to a superimposed motion.
//!
//! The first two are boxes: within them the slave keeps its limits at every place of the cam. A box with a higher
//! velocity leaves less of the other three derivatives.

use super::super::super::Axis;
use super::super::follow::Beyond;
use super::super::view::{Kind, View};
use super::Rung;
use super::shadow::FASTEST;
use crate::{Cams, OnLimit};
use standstill_planner::{CamBounds, Limits, Plan, Planner, Setpoint};

/// The share of the highest velocity of its cam that a slave leaves to its master.
const LEFT: f64 = 0.8;

/// The velocity of a shift that has no velocity of its own, as a share of the difference between the master's
/// velocity and the highest one.
const SHARE: f64 = 0.4;

impl<P: Planner> Axis<P> {
    /// Called before bounds are collected: a slave that has lost its master leaves no bound.
    pub(in crate::axis::coupling) fn begin_bound_on_cam(&mut self) {
        if let Some(on_cam) = &mut self.follower.on_cam
            && on_cam.rung == Rung::Lost
        {
            on_cam.bound = None;
        }
    }

    /// The limits left to its master, if the master keeps the limits of the slave.
    pub(in crate::axis::coupling) fn bound_on_cam(&self) -> Option<Limits> {
        self.on_cam()?.bound
    }

    /// In sync: from now on its master keeps the limits of the slave, if the axis is configured for that.
    pub(super) fn bound_master_on_cam(&mut self, cams: &Cams<'_>) {
        if self.config.following.on_limit != OnLimit::SlowMaster {
            return;
        }
        let Some(on_cam) = &self.follower.on_cam else {
            return;
        };
        let Some(curve) = on_cam.stored_curve(cams) else {
            return;
        };
        let limits = self.slowed(&self.parameters.limits);
        let bounds = curve.bounds();
        let most = LEFT * bounds.highest_velocity(&limits);
        // A cam that does not move its slave leaves everything.
        let bound = (!bounds.is_level())
            .then(|| bounds.shadow(&limits, most, 0.0))
            .flatten();
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.bound = Some(bound.unwrap_or(Limits::NONE));
        }
    }

    /// The limits that the cam leaves to a shift with the limits `asked`, in units of the master. None if it leaves
    /// nothing, or while the slave is not in sync or the master's future motion is not known.
    pub(in crate::axis::coupling) fn room_for_shift_on_cam(
        &self,
        asked: &Limits,
        view: &View<'_, P::Plan>,
        cams: &Cams<'_>,
    ) -> Option<Limits> {
        let on_cam = self.on_cam()?;
        let is_free = on_cam.rung.is_locked() && !self.adds_motion();
        if !is_free || (self.slows_master() && (view.future.is_new || view.future.is_late())) {
            return None;
        }
        let curve = on_cam.stored_curve(cams)?;
        let bounds = curve.bounds();
        let limits = self.slowed(&self.parameters.limits);
        if bounds.is_level() {
            return Some(limits);
        }
        let most = self.most_of_master(view)?;
        let highest = FASTEST * bounds.highest_velocity(&limits).min(1e12);
        let left = highest - most.velocity;
        if !(left > 0.0) {
            return None;
        }
        let share = if asked.velocity.is_finite() {
            asked.velocity.min(left)
        } else {
            SHARE * left
        };
        let own = bounds.shadow(&limits, most.velocity + share, 0.0)?;
        let rate = own.acceleration - most.acceleration;
        let room = Limits {
            velocity: own.velocity - most.velocity,
            acceleration: rate,
            deceleration: rate,
            jerk: own.jerk - most.jerk,
            snap: own.snap - most.snap,
        };
        let all = [room.velocity, rate, room.jerk, room.snap];
        let is_room = all.into_iter().all(|room| room > 0.0);
        is_room.then(|| self.share_of_shift(room, &own))
    }

    /// The part of the slave's limits that the cam always leaves, and whether that never changes because the motion
    /// of the master is endless. None if nothing is left or the master's future motion is not known.
    pub(in crate::axis) fn room_on_cam(
        &self,
        view: &View<'_, P::Plan>,
        cams: &Cams<'_>,
    ) -> Option<(Limits, bool)> {
        let limits = self.slowed(&self.parameters.limits);
        if self.law_stands(view) {
            return Some((limits, false));
        }
        let (used, endless) = self.used_on_cam(view, cams)?;
        let rate = limits.lower_acceleration() - used.acceleration;
        let room = Limits {
            velocity: limits.velocity - used.velocity,
            acceleration: rate,
            deceleration: rate,
            jerk: limits.jerk - used.jerk,
            snap: limits.snap - used.snap,
        };
        let all = [room.velocity, rate, room.jerk, room.snap];
        all.into_iter().all(|room| room > 0.0).then_some((room, endless))
    }

    /// The largest magnitudes of the derivatives that the cam needs along the master's future motion, and whether
    /// that is endless.
    fn used_on_cam(&self, view: &View<'_, P::Plan>, cams: &Cams<'_>) -> Option<(Setpoint, bool)> {
        let on_cam = self.on_cam()?;
        let curve = on_cam.stored_curve(cams)?;
        let lead = self.lead_of_master(view)?;
        // A derivative that jumps leaves nothing, even to a smooth motion beside it.
        let is_rough = view.degree() < on_cam.limits.order().degree();
        if is_rough && self.planner.peaks((lead.plan, lead.elapsed))?.acceleration != 0.0 {
            return None;
        }
        let place = if view.future.is_late() {
            view.now.place
        } else {
            on_cam.was.place
        };
        let end = lead.plan.end();
        Some((self.peaks_on_cam(&curve, &lead, place), end.velocity != 0.0))
    }

    /// The limit of the slave that the cam exceeds together with a motion of these largest magnitudes beside it.
    pub(in crate::axis) fn beyond_beside_cam(
        &self,
        view: &View<'_, P::Plan>,
        beside: &Setpoint,
        cams: &Cams<'_>,
    ) -> Option<Beyond> {
        let limits = self.slowed(&self.parameters.limits);
        let (used, _) = self.used_on_cam(view, cams)?;
        let all = Setpoint {
            position: 0.0,
            velocity: used.velocity + beside.velocity.abs(),
            acceleration: used.acceleration + beside.acceleration.abs(),
            jerk: used.jerk + beside.jerk.abs(),
            snap: used.snap + beside.snap.abs(),
        };
        CamBounds::beyond(&all, &limits)
    }

    /// From now on added distances move the cam, from its present place. The layer is at `place` (u).
    pub(in crate::axis) fn lay_layer_on_cam(&mut self, place: f64) {
        if let Some(on_cam) = &mut self.follower.on_cam {
            on_cam.lead = on_cam.anchor.map_or(0.0, |anchor| anchor.slave.phase) - place;
        }
    }

    /// The largest known magnitudes of the derivatives of the master from now on.
    fn most_of_master(&self, view: &View<'_, P::Plan>) -> Option<Setpoint> {
        match view.future.kind() {
            Kind::Still => Some(Setpoint::default()),
            Kind::Plan => {
                let lead = self.lead_of_master(view)?;
                let peaks = self.planner.peaks((lead.plan, lead.elapsed))?.times(lead.factor);
                Some(Setpoint {
                    position: 0.0,
                    velocity: peaks.velocity.abs(),
                    acceleration: peaks.acceleration.abs(),
                    jerk: peaks.jerk.abs(),
                    snap: peaks.snap.abs(),
                })
            }
            Kind::Unknown | Kind::Measured | Kind::NotSeen => None,
        }
    }
}
