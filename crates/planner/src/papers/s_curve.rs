//! Rest to rest in least time under bounds on velocity, acceleration and jerk.
//!
//! Blejan and Blejan, "Mathematics for real-time S-curve profile generator", Hidraulica 4/2020: six cases and
//! their formulas, with the corrections of `docs/papers.md`.

use super::profile::Times;
use super::{Profile, check_limits};
use crate::error::distance;
use crate::math::{cbrt, sqrt};
use crate::ramp::path::moved;
use crate::{Field, Limits, Order, PlanError, Setpoint};

/// The bounds that a move reaches.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SCurveCase {
    /// A long move with a low velocity bound: acceleration has no plateau, velocity has one.
    A,
    /// A short move: neither acceleration nor velocity reach their bounds.
    B,
    /// As [`SCurveCase::A`], but too short to reach the acceleration bound if velocity had none.
    C1,
    /// As [`SCurveCase::B`], under a velocity bound below the one acceleration allows.
    C2,
    /// Acceleration and velocity have plateaus.
    D1,
    /// Acceleration has plateaus, velocity has none.
    D2,
}

impl SCurveCase {
    /// The letters of the paper.
    pub const fn name(self) -> &'static str {
        match self {
            Self::A => "A",
            Self::B => "B",
            Self::C1 => "C1",
            Self::C2 => "C2",
            Self::D1 => "D1",
            Self::D2 => "D2",
        }
    }
}

/// A move from rest to rest in least time at order 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SCurve {
    case: SCurveCase,
    times: Times,
    profile: Profile,
}

impl SCurve {
    /// Plans from rest at `start` to rest at `target` (u). Closed form.
    ///
    /// If acceleration and deceleration differ, the lower one applies to both, because the paper has only
    /// one.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a position that is not finite, a bound that is not positive, a missing
    /// bound on velocity, acceleration or jerk, and a bound on snap, which this profile cannot keep.
    pub fn new(start: f64, target: f64, limits: &Limits) -> Result<Self, PlanError> {
        let distance = distance(start, target)?;
        let needed = [Field::LimitVelocity, Field::LimitAcceleration, Field::LimitJerk];
        check_limits(limits, &needed, &[Field::LimitSnap])?;
        let (case, times) = times(distance.abs(), limits);
        let profile = if distance == 0.0 {
            Profile::nothing(Order::Three, start)
        } else {
            Profile::symmetric(start, target, limits.jerk.copysign(distance), &times)?
        };
        Ok(Self { case, times, profile })
    }

    /// The bounds that the move reaches. On the border of two cases either may be returned; the times
    /// agree.
    pub const fn case(&self) -> SCurveCase {
        self.case
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

/// Case and times of a move over `s` >= 0 (P2, P3).
fn times(s: f64, limits: &Limits) -> (SCurveCase, Times) {
    use SCurveCase::{A, B, C1, C2, D1, D2};
    let (v, a, j) = (limits.velocity, limits.lower_acceleration(), limits.jerk);
    // The distances at which acceleration just reaches its bound, and at which velocity does.
    let v_a = a * a / j;
    let s_a = 2.0 * v_a * (a / j);
    let s_v = if v < v_a {
        2.0 * v * sqrt(v / j)
    } else {
        v * (v / a + a / j)
    };
    let case = match (v < v_a, s >= s_v) {
        (true, true) if s > s_a => A,
        (true, true) => C1,
        (true, false) => C2,
        (false, true) => D1,
        (false, false) if s > s_a => D2,
        (false, false) => B,
    };
    let times = match case {
        B | C2 => {
            let t_j = cbrt(s / (2.0 * j));
            Times {
                jerk: t_j,
                acceleration: t_j,
                velocity: 2.0 * t_j,
            }
        }
        A | C1 => {
            let t_j = sqrt(v / j);
            Times {
                jerk: t_j,
                acceleration: t_j,
                velocity: s / v,
            }
        }
        D1 => Times {
            jerk: a / j,
            acceleration: v / a,
            velocity: s / v,
        },
        D2 => {
            let t_j = a / j;
            let t_a = (sqrt(4.0 * s / a + t_j * t_j) - t_j) / 2.0;
            Times {
                jerk: t_j,
                acceleration: t_a,
                velocity: t_a + t_j,
            }
        }
    };
    (case, times)
}

/// The second form of a move: the state carried from call to call, as in the paper's section 4.
///
/// Each step starts from the state of the last step. That is exact only if a step ends wherever the jerk
/// changes, so a step is split there. The paper does not split, and misses the target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stepper<'a> {
    profile: &'a Profile,
    time: f64,
    state: Setpoint,
}

impl<'a> Stepper<'a> {
    /// At the start of `profile`.
    pub fn new(profile: &'a Profile) -> Self {
        Self {
            profile,
            time: 0.0,
            state: profile.at(0.0),
        }
    }

    /// The state `dt` (s, not negative) later; at most one part for each segment.
    pub fn step(&mut self, dt: f64) -> Setpoint {
        let until = self.time + dt;
        for (switch, segment) in self.profile.switches().zip(self.profile.segments()) {
            let part = switch.min(until) - self.time;
            if part > 0.0 {
                self.state.jerk = segment.jerk;
                self.state = moved(&self.state, part);
                self.time += part;
            }
        }
        self.time = until;
        if until >= self.profile.duration() {
            self.state = self.profile.at(until);
        }
        self.state
    }
}
