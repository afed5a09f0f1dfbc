//! Rest to rest in a given time.
//!
//! García-Martínez et al., "A new seven-segment profile algorithm for an open source architecture in a hybrid
//! electronic platform", Electronics 8(6) 652, 2019, with the corrections of `docs/papers.md`; and the
//! trapezoid of velocity the paper compares with.

use super::profile::Times;
use super::{Profile, SLACK, check_limits, invalid};
use crate::error::{check_positive, distance};
use crate::math::{cbrt, sqrt};
use crate::{Field, Limits, Order, PlanError, Setpoint};

/// A move from rest to rest in a given time at order 3. Two shares define its shape.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Timed {
    times: Times,
    profile: Profile,
}

impl Timed {
    /// Plans from rest at `start` to rest at `target` (u) in `duration` (s). Closed form (P4).
    ///
    /// `gamma` is the share of the duration for speeding up, and also that for slowing down. `phi` is the
    /// share of these in which the jerk acts at each of their ends. Both are in (0, 1/2]. The bounds of
    /// `limits` are only checked; an absent one is infinite. A move of no length takes no time.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a position that is not finite, a bound, share or duration that is not
    /// positive, and a bound on snap, which this profile cannot keep; [`PlanError::OutOfRange`] for a share
    /// above 1/2, and for a duration too short for the limits with the least one for these shares.
    pub fn new(
        start: f64,
        target: f64,
        duration: f64,
        gamma: f64,
        phi: f64,
        limits: &Limits,
    ) -> Result<Self, PlanError> {
        let distance = distance(start, target)?;
        check_limits(limits, &[], &[Field::LimitSnap])?;
        check_share(Field::Gamma, gamma)?;
        check_share(Field::Phi, phi)?;
        let least = least_duration(distance.abs(), gamma, phi, limits);
        check_duration(duration, least)?;
        let times = Times {
            jerk: phi * gamma * duration,
            acceleration: (1.0 - phi) * gamma * duration,
            velocity: (1.0 - gamma) * duration,
        };
        let profile = if distance == 0.0 {
            Profile::nothing(Order::Three, start)
        } else {
            let jerk = distance / times.jerk / times.acceleration / times.velocity;
            Profile::symmetric(start, target, jerk, &times)?
        };
        Ok(Self { times, profile })
    }

    /// The three times of the profile (P1).
    pub const fn times(&self) -> Times {
        self.times
    }

    /// The move itself.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }
}

/// The least duration (s) in which a profile with these shares covers `s` >= 0 within `limits` (P5).
fn least_duration(s: f64, gamma: f64, phi: f64, limits: &Limits) -> f64 {
    let cruising = 1.0 - gamma;
    let rising = gamma * (1.0 - phi);
    let jerking = gamma * phi;
    let for_velocity = s / (cruising * limits.velocity);
    let for_acceleration = sqrt(s / (cruising * rising * limits.lower_acceleration()));
    let for_jerk = cbrt(s / (cruising * rising * jerking * limits.jerk));
    for_velocity.max(for_acceleration).max(for_jerk)
}

fn check_share(field: Field, value: f64) -> Result<(), PlanError> {
    if value > 0.5 {
        let nearest = 0.5;
        return Err(PlanError::OutOfRange {
            field,
            value,
            nearest,
        });
    }
    check_positive(field, value)
}

fn check_duration(value: f64, least: f64) -> Result<(), PlanError> {
    let field = Field::Duration;
    if least > 0.0 && value < least * (1.0 - SLACK) {
        return Err(PlanError::OutOfRange {
            field,
            value,
            nearest: least,
        });
    }
    check_positive(field, value)
}

/// A move from rest to rest at order 2: velocity is a trapezoid, or a triangle over a short distance.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Trapezoid {
    profile: Profile,
}

impl Trapezoid {
    /// Plans from rest at `start` to rest at `target` (u) in least time. Closed form (P6).
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a position that is not finite, a bound that is not positive, a missing
    /// bound on velocity, acceleration or deceleration, and a bound on jerk or snap, which this profile
    /// cannot keep.
    pub fn new(start: f64, target: f64, limits: &Limits) -> Result<Self, PlanError> {
        let distance = distance(start, target)?;
        let needed = [
            Field::LimitVelocity,
            Field::LimitAcceleration,
            Field::LimitDeceleration,
        ];
        check_limits(limits, &needed, &[Field::LimitJerk, Field::LimitSnap])?;
        let (up, down) = (limits.acceleration, limits.deceleration);
        let highest = sqrt(2.0 * distance.abs() / (1.0 / up + 1.0 / down));
        Self::lay(start, target, highest.min(limits.velocity), up, down)
    }

    /// Plans from rest at `start` to rest at `target` (u) in `duration` (s) with the plateau
    /// `limits.velocity`. The acceleration is the result, the same up and down (P7). Closed form.
    ///
    /// # Errors
    /// The errors of [`Trapezoid::new`], but acceleration and deceleration may be absent. In addition
    /// [`PlanError::OutOfRange`] for a velocity that the move does not reach in this time or under these
    /// limits, and for a duration that is too short for the limits. Without a limit on acceleration, a
    /// duration too short for the velocity has no nearest value, because the least one is not reached.
    pub fn timed(start: f64, target: f64, duration: f64, limits: &Limits) -> Result<Self, PlanError> {
        let distance = distance(start, target)?;
        check_limits(
            limits,
            &[Field::LimitVelocity],
            &[Field::LimitJerk, Field::LimitSnap],
        )?;
        let s = distance.abs();
        let (velocity, most) = (limits.velocity, limits.lower_acceleration());
        if s == 0.0 {
            check_duration(duration, 0.0)?;
            return Self::lay(start, target, 0.0, most, most);
        }
        let least = s / velocity + velocity / most;
        let reached = sqrt(s * most).min(2.0 * s / duration.max(0.0));
        if velocity > reached * (1.0 + SLACK) {
            return Err(PlanError::OutOfRange {
                field: Field::LimitVelocity,
                value: velocity,
                nearest: reached,
            });
        }
        if most.is_finite() {
            check_duration(duration, least)?;
        } else if !(duration > least && duration.is_finite()) {
            return Err(invalid(Field::Duration, duration));
        }
        let rising = (duration - s / velocity).min(0.5 * duration);
        let acceleration = (velocity / rising).min(most);
        Self::lay(start, target, velocity, acceleration, acceleration)
    }

    /// Up to `velocity` with `up`, a cruise, down with `down`.
    fn lay(start: f64, target: f64, velocity: f64, up: f64, down: f64) -> Result<Self, PlanError> {
        let distance = target - start;
        if distance == 0.0 {
            let profile = Profile::nothing(Order::Two, start);
            return Ok(Self { profile });
        }
        let sign = 1.0_f64.copysign(distance);
        let (rise, fall) = (velocity / up, velocity / down);
        let cruise = distance.abs() / velocity - 0.5 * (rise + fall);
        let spans = [(rise, sign * up), (cruise, 0.0), (fall, -sign * down)];
        let profile = Profile::lay(Order::Two, &Setpoint::at_rest(start), spans, target, 0.0)?;
        Ok(Self { profile })
    }

    /// The move itself.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }
}
