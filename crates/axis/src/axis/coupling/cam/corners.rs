//! Corners: rows of a cam at which a derivative jumps that may not jump within the limits of the slave. The slave
//! comes to rest there.
//!
//! On the curve a slave keeps its limits at a corner only at rest. It is in sync until its shadow has to brake for
//! the next corner. Then it comes to rest exactly on the corner, and follows its master again from there. A slave
//! that must not lag is in sync until its master has passed a corner.

use super::super::super::commands::ROUNDING;
use super::super::super::{Axis, Motion};
use super::super::follow::Beyond;
use super::super::needs::RESOLVED;
use super::super::view::{UNKNOWN, View};
use super::onto::Way;
use super::shadow::{FASTEST, leaves};
use super::{Curve, OnCam, Rung, Shadow};
use crate::{Approach, OnLimit, Scope};
use standstill_planner::{DirectedLimits, Excess, Lead, Limits, Plan, Planner, Setpoint};

/// Velocities of a shadow that are tried on the way to a corner, as shares of the range up to the highest velocity. A
/// higher velocity leaves less acceleration.
const SHARES: [f64; 4] = [0.01, 0.1, 0.3, 1.0];

/// A shadow that still accelerates gets faster until its acceleration is 0, and only then comes to rest. Its limits
/// are searched in `FADING` rounds. In each they leave it `GAINED` times the velocity that it gains, because a higher
/// velocity leaves other rates, with which it gains more.
const FADING: u32 = 3;
const GAINED: f64 = 1.25;

/// A shadow moves on to rest at a corner only if that takes at most this number of times the scans of a stop.
const NEAR: u32 = 4;

/// How a shadow comes to rest: the plan, its distance `on` in the direction of the corner (u of the master), and its
/// distance `back` behind the present place.
struct Stop<Q> {
    plan: Q,
    on: f64,
    back: f64,
}

/// A corner ahead of a shadow.
#[derive(Clone, Copy)]
pub(super) struct Corner {
    /// Place on the master's side of the cam (u), not reduced to one period.
    x: f64,
    /// Order of the derivative that jumps, less 1.
    derivative: usize,
}

impl Corner {
    /// The derivative that the cam needs there, and its limit.
    pub fn asks(&self, limits: &Limits) -> Beyond {
        match self.derivative {
            0 => ("acceleration", f64::INFINITY, limits.lower_acceleration()),
            1 => ("jerk", f64::INFINITY, limits.jerk),
            _ => ("snap", f64::INFINITY, limits.snap),
        }
    }
}

impl OnCam {
    /// Whether the cam has a jump in a derivative that may not jump within the limits of the slave.
    pub(super) fn has_corners(&self) -> bool {
        let order = self.limits.order().degree().saturating_sub(1);
        usize::from(self.camming.continuity) < order
    }
}

impl<P: Planner> Axis<P> {
    /// The number of derivatives of a cam that may not jump within the limits of the slave.
    pub(super) fn corner_order(&self) -> usize {
        let limits = self.slowed(&self.parameters.limits);
        limits.order().degree().saturating_sub(1)
    }

    /// The cam at its place, if it has corners for this slave and is not over.
    fn curve_with_corners<'a>(&self, scope: &'a Scope<'_>) -> Option<Curve<'a>> {
        let on_cam = self.on_cam()?;
        if !on_cam.has_corners() || on_cam.ends.is_over() {
            return None;
        }
        on_cam.stored_curve(&scope.cams)
    }

    /// In sync: the next corner, if the slave could no longer come to rest at it from its place in sync at the end of
    /// this scan. For a slave that must not lag: the corner that it would have passed.
    pub(super) fn corner_in_sync(&mut self, view: &View<'_, P::Plan>, scope: &Scope<'_>) -> Option<Corner> {
        let curve = self.curve_with_corners(scope)?;
        let now = Shadow::of(&view.now);
        if self.config.following.on_limit == OnLimit::Error {
            return self.corner_passed(&curve, &now);
        }
        let found = self.stops_in_time(&curve, &now);
        self.note_brakes(found)
    }

    /// The same for a shadow on a way of its own.
    pub(super) fn corner_on_way(&mut self, next: &Shadow, scope: &Scope<'_>) -> Option<Corner> {
        let is_due = matches!(self.cam_rung(), Some(Rung::Corner { .. }));
        let curve = self.curve_with_corners(scope).filter(|_| !is_due)?;
        let found = self.stops_in_time(&curve, next);
        self.note_brakes(found)
    }

    /// Notes the limits within which the slave can still stop. Returns the corner before which it can't.
    fn note_brakes(&mut self, found: Result<Option<Limits>, Corner>) -> Option<Corner> {
        let on_cam = self.follower.on_cam.as_mut()?;
        match found {
            Ok(limits) => {
                on_cam.brakes = limits.map(|limits| (limits, on_cam.limits));
                None
            }
            Err(corner) => Some(corner),
        }
    }

    /// The corner that the master has passed at `now`, or moves across.
    fn corner_passed(&self, curve: &Curve<'_>, now: &Shadow) -> Option<Corner> {
        let on_cam = self.on_cam()?;
        let (was, here) = (curve.unwound(on_cam.was.place), curve.unwound(now.place));
        let resolved = RESOLVED * (was.abs() + here.abs());
        let corner = self.corner_from(curve, was, here > was, (here - was).abs() + resolved)?;
        let is_past = (here - was).abs() > (corner.x - was).abs() + resolved;
        (is_past || !now.at.is_at_rest()).then_some(corner)
    }

    /// Limits with which a shadow that is at `next` at the end of this scan comes to rest before the next corner.
    /// None if the corner is far away.
    ///
    /// Cost: a check of each row until there, and at most ten ramps if a corner is near.
    ///
    /// # Errors
    /// The corner, if there are no such limits.
    fn stops_in_time(&self, curve: &Curve<'_>, next: &Shadow) -> Result<Option<Limits>, Corner> {
        let at = &next.at;
        let x = curve.unwound(next.place);
        // The step of this scan may cross a corner, too.
        let was = self.on_cam().and_then(|on_cam| on_cam.shadow);
        let from = was.map_or(x, |was| curve.unwound(was.place));
        let ahead = heading(at).unwrap_or_default() * curve.law.master_scaling;
        let forwards = if ahead == 0.0 { x > from } else { ahead > 0.0 };
        let step = if forwards { x - from } else { from - x };
        let (from, step) = if step > 0.0 { (from, step) } else { (x, 0.0) };
        let per = 1.0 / curve.law.master_scaling.abs();
        let found = |way: f64| self.corner_from(curve, from, forwards, step + way * per);
        let Some(near) = found(self.longest_braking(curve, at)) else {
            return Ok(None);
        };
        let goes_up = forwards == (curve.law.master_scaling > 0.0);
        let mut within = self.limits_to_stop(curve, at);
        let stops = within.find(|limits| {
            let stop = self.stopping(at, limits, goes_up);
            stop.is_some_and(|stop| {
                let behind = self.corner_from(curve, x, !forwards, stop.back * per);
                found(stop.on).is_none() && behind.is_none()
            })
        });
        stops.map(Some).ok_or(near)
    }

    fn corner_from(&self, curve: &Curve<'_>, x: f64, forwards: bool, reach: f64) -> Option<Corner> {
        let order = self.corner_order();
        let (x, derivative) = curve.cam.next_corner(x, forwards, reach, order)?;
        Some(Corner { x, derivative })
    }

    /// A distance (u of the master) in which a shadow certainly comes to rest.
    fn longest_braking(&self, curve: &Curve<'_>, at: &Setpoint) -> f64 {
        let Some(limits) = self.limits_to_corner(curve, at).next() else {
            return f64::INFINITY;
        };
        let speed = at.velocity.abs();
        let rise = limits.acceleration / limits.jerk;
        // At order 2 both are infinite.
        let fade = if limits.snap.is_finite() {
            limits.jerk / limits.snap
        } else {
            0.0
        };
        let time = 2.0
            * (speed / limits.acceleration
                + rise
                + fade
                + at.acceleration.abs() / limits.acceleration * rise);
        2.0 * (speed + at.acceleration.abs() * time) * time
    }

    /// Limits of the shadow on the way to a corner: first those with which it was known to stop in time, then its
    /// present ones, then those of other velocities.
    fn limits_to_corner(&self, curve: &Curve<'_>, at: &Setpoint) -> impl Iterator<Item = Limits> {
        let limits = self.slowed(&self.parameters.limits);
        let highest = FASTEST * curve.bounds().highest_velocity(&limits).min(1e12);
        let speed = at.velocity.abs();
        let left = (highest - speed).max(0.0);
        let others = SHARES.map(|share| self.limits_of_shadow(curve, at, speed + share * left));
        let known = self.on_cam().and_then(|on_cam| on_cam.brakes);
        let known = known.filter(|(_, own)| *own == limits).map(|(known, _)| known);
        let all = [known, self.shadow_limits_now()].into_iter().chain(others);
        all.flatten()
    }

    /// The same, and last those of the velocity that it reaches before its acceleration is 0.
    fn limits_to_stop(&self, curve: &Curve<'_>, at: &Setpoint) -> impl Iterator<Item = Limits> {
        let fastest = core::iter::once_with(|| self.limits_while_fading(curve, at));
        self.limits_to_corner(curve, at).chain(fastest.flatten())
    }

    /// Limits of a shadow that gets faster before it comes to rest. Cost: at most three ramps.
    fn limits_while_fading(&self, curve: &Curve<'_>, at: &Setpoint) -> Option<Limits> {
        let start = Setpoint { position: 0.0, ..*at };
        let speed = at.velocity.abs();
        let mut limits = self.limits_of_shadow(curve, at, speed)?;
        for _ in 0..FADING {
            let ramp = self.planner.ramp_to(&start, 0.0, &limits, &limits).ok()?;
            let gained = self.planner.peaks((&ramp, 0))?.velocity - speed;
            limits = self.limits_of_shadow(curve, at, speed + GAINED * gained)?;
        }
        Some(limits)
    }

    /// How a shadow in this state comes to rest. None if it exceeds these limits.
    fn stopping(&self, at: &Setpoint, limits: &Limits, goes_up: bool) -> Option<Stop<P::Plan>> {
        let start = Setpoint { position: 0.0, ..*at };
        let plan = self.planner.ramp_to(&start, 0.0, limits, limits).ok()?;
        let stays = plan.excess().is_none_or(|excess| {
            let turns = Excess {
                velocity: 0.0,
                ..excess
            };
            let fastest = self.planner.peaks((&plan, 0)).map(|peaks| peaks.velocity);
            // It may reverse before it comes to rest.
            let is_slow = fastest.is_some_and(|fastest| fastest <= limits.velocity * (1.0 + ROUNDING));
            is_slow && !leaves(&turns, limits)
        });
        let (low, high) = self.planner.reach((&plan, 0));
        let (on, back) = if goes_up { (high, -low) } else { (-low, high) };
        stays.then_some(Stop { plan, on, back })
    }

    /// Whether it comes to rest at a corner.
    pub(super) fn is_coming_to_corner(&self) -> bool {
        let is_under_way =
            matches!(self.mover.motion(), Motion::Closing { elapsed, scans, .. } if elapsed < scans);
        is_under_way && matches!(self.cam_rung(), Some(Rung::Corner { .. }))
    }

    /// The same, and its limits have not changed since that plan was made.
    pub(super) fn is_bound_for_corner(&self) -> bool {
        let brakes = self.on_cam().map(|on_cam| (on_cam.brakes, on_cam.limits));
        let is_known = matches!(brakes, Some((Some((_, own)), limits)) if own == limits);
        is_known && self.is_coming_to_corner()
    }

    /// From this scan on the slave moves along the curve to rest at the corner. If its limits leave no such way, it
    /// leaves the curve and comes to rest.
    pub(super) fn brake_for_corner(
        &mut self,
        corner: Corner,
        view: &View<'_, P::Plan>,
        scope: &mut Scope<'_>,
    ) {
        let way = {
            let shadow = self.on_cam().and_then(|on_cam| on_cam.shadow);
            let curve = self.curve_with_corners(scope);
            curve
                .zip(shadow)
                .and_then(|(curve, shadow)| self.way_to_corner(&curve, &shadow, corner))
        };
        match way {
            Some(way) => {
                let limits = way.shadow;
                self.take_way_on_cam(way, scope);
                let _ahead = self.note_brakes(Ok(Some(limits)));
            }
            None => self.wait_on_cam(UNKNOWN, scope),
        }
        if self.is_on_cam() {
            self.step_on_cam(view, scope);
        }
    }

    /// A way along the curve to rest at the corner, or before it.
    fn way_to_corner(&self, curve: &Curve<'_>, shadow: &Shadow, corner: Corner) -> Option<Way<P::Plan>> {
        let start = shadow.at.at_origin();
        let distance = curve.place_of(corner.x, shadow.place).position - shadow.place.position;
        let numbers = (corner.x * curve.law.master_scaling).abs() + shadow.place.position.abs();
        let resolved = RESOLVED * 4.0 * (distance.abs() + numbers);
        let most = distance.abs() + resolved;
        let x = curve.unwound(shadow.place);
        let per = 1.0 / curve.law.master_scaling.abs();
        let mut within = self.limits_to_stop(curve, &shadow.at);
        let (limits, stop) = within.find_map(|limits| {
            let stop = self.stopping(&shadow.at, &limits, distance > 0.0)?;
            let behind = self.corner_from(curve, x, corner.x < x, stop.back * per);
            (stop.on <= most && behind.is_none()).then_some((limits, stop))
        })?;
        let is_near = |plan: &P::Plan| plan.scans() <= stop.plan.scans().saturating_mul(NEAR);
        let move_there = |velocity: f64| {
            let both = DirectedLimits {
                positive: velocity,
                negative: velocity,
                limits,
            };
            self.planner
                .move_by_direction(&start, distance, &both, &both)
                .ok()
        };
        let goes_straight = |plan: &P::Plan| {
            let (up, down) = self.planner.ways((plan, 0));
            let (on, back) = if distance < 0.0 { (down, up) } else { (up, down) };
            let stays = !plan.excess().is_some_and(|excess| leaves(&excess, &limits));
            on <= most && back <= resolved && stays
        };
        // If possible no faster than now, so that it does not get ahead of its master. If no move ends there, or the
        // corner is far away, it comes to rest first.
        let speeds = [shadow.at.velocity.abs(), limits.velocity];
        let there = speeds.into_iter().filter_map(move_there).find(goes_straight);
        let plan = there.filter(is_near).unwrap_or(stop.plan);
        let rung = Rung::Corner { start: shadow.place };
        Some(Way {
            left: u64::from(plan.scans()).saturating_sub(1),
            ..Way::by(plan, rung, Approach::Corner, corner.x, limits)
        })
    }

    /// Whether a slave in sync could not always brake for a corner behind the rest of this plan of its master.
    pub(super) fn is_too_fast_for_corners(&self, curve: &Curve<'_>, lead: &Lead<'_, P::Plan>) -> bool {
        let has_corners = usize::from(curve.cam.head.smooth.continuity) < self.corner_order();
        if !has_corners || self.config.following.on_limit == OnLimit::Error {
            return false;
        }
        let Some(peaks) = self.planner.peaks((lead.plan, lead.elapsed)) else {
            return false;
        };
        let peaks = peaks.times(lead.factor);
        let fits = |limits: Limits| {
            let (rate, up) = (limits.lower_acceleration(), 1.0 + ROUNDING);
            peaks.velocity.abs() <= limits.velocity * up
                && peaks.acceleration.abs() <= rate * up
                && peaks.jerk.abs() <= limits.jerk * up
                && peaks.snap.abs() <= limits.snap * up
        };
        !self.limits_to_corner(curve, &peaks).any(fits)
    }
}

impl Curve<'_> {
    /// One of its corners, at any place.
    pub(super) fn corner(&self) -> Corner {
        Corner {
            x: 0.0,
            derivative: usize::from(self.cam.head.smooth.continuity),
        }
    }
}

/// The direction in which a shadow moves or starts to move; none at rest.
fn heading(at: &Setpoint) -> Option<f64> {
    [at.velocity, at.acceleration, at.jerk]
        .into_iter()
        .find(|part| *part != 0.0)
}
