//! From one velocity to another along a path of any length.
//!
//! Bui, Le and Doan, "An algorithm for planning S-curve motion profile considering arbitrary short path
//! length", with the corrections of `docs/papers.md`. One function of the peak velocity replaces the
//! paper's table of conditions.

use super::{Profile, SLACK, check_limits, invalid};
use crate::error::distance;
use crate::kernel::falling_root;
use crate::math::{cbrt, sqrt};
use crate::{Field, Limits, Order, PlanError, Setpoint};

/// A bound on a root is widened by this factor, so that rounding does not exclude the root.
const NOT_SHORT: f64 = 1.0 + 1e-9;

/// The behaviour if the path is too short to get from the start velocity to the end velocity (type 8B).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ShortPathPolicy {
    /// As in the paper: end with the start velocity.
    Paper,
    /// End with the velocity that a single ramp reaches: upwards the highest, downwards the lowest above the
    /// requested one. A move to rest is refused if the path is too short for it.
    #[default]
    Nearest,
}

/// The paper's types: which of the two ramps have a plateau of acceleration, and whether there is a
/// cruise.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShortPathType {
    /// Both ramps have a plateau; cruise at the feed rate.
    T1,
    /// The ramp up has a plateau; cruise.
    T2,
    /// The ramp down has a plateau; cruise.
    T3,
    /// No plateau; cruise.
    T4,
    /// Both ramps have a plateau; the feed rate is not reached.
    T5,
    /// The ramp up has a plateau; the feed rate is not reached.
    T6,
    /// The ramp down has a plateau; the feed rate is not reached.
    T7,
    /// No plateau; the feed rate is not reached.
    T8A,
    /// The end velocity is out of reach and was modified.
    T8B,
}

impl ShortPathType {
    /// The paper's number.
    pub const fn name(self) -> &'static str {
        match self {
            Self::T1 => "1",
            Self::T2 => "2",
            Self::T3 => "3",
            Self::T4 => "4",
            Self::T5 => "5",
            Self::T6 => "6",
            Self::T7 => "7",
            Self::T8A => "8A",
            Self::T8B => "8B",
        }
    }
}

/// A move between two velocities, with no acceleration at either end, in least time at order 3.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct ShortPath {
    kind: ShortPathType,
    peak: f64,
    steps: u32,
    profile: Profile,
}

impl ShortPath {
    /// Plans from `start` (u) with `start_velocity` to `target` (u) with `end_velocity` (u/s).
    ///
    /// `limits.velocity` is the feed rate. Both velocities point towards the target; on a path of length 0 they
    /// define the direction. The limit on acceleration applies to the ramp up, the one on deceleration to the ramp
    /// down. Bounded work: one root of at most [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS) steps.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a position or velocity that is not finite, a bound that is not
    /// positive, a missing bound on velocity, acceleration, deceleration or jerk, and a bound on snap, which
    /// this profile cannot keep; [`PlanError::OutOfRange`] for a velocity above the feed rate or pointing
    /// away; [`PlanError::Unreachable`] if the policy is `Nearest` and the end velocity 0 is out of reach.
    pub fn new(
        start: f64,
        start_velocity: f64,
        target: f64,
        end_velocity: f64,
        limits: &Limits,
        policy: ShortPathPolicy,
    ) -> Result<Self, PlanError> {
        let distance = distance(start, target)?;
        let needed = [
            Field::LimitVelocity,
            Field::LimitAcceleration,
            Field::LimitDeceleration,
            Field::LimitJerk,
        ];
        check_limits(limits, &needed, &[Field::LimitSnap])?;
        let sign = forwards(distance, start_velocity, end_velocity);
        let path = Path {
            length: sign * distance,
            from: speed(Field::Velocity, start_velocity, sign, limits)?,
            to: speed(Field::EndVelocity, end_velocity, sign, limits)?,
            limits,
        };
        let shape = match (path.reaches_end(), policy) {
            (true, _) => path.least_time(),
            (false, ShortPathPolicy::Paper) => Shape {
                kind: ShortPathType::T8B,
                ..Path {
                    to: path.from,
                    ..path
                }
                .least_time()
            },
            (false, ShortPathPolicy::Nearest) => {
                let shape = path.single_ramp();
                if path.to == 0.0 {
                    return Err(PlanError::Unreachable {
                        field: Field::EndVelocity,
                        value: end_velocity,
                        nearest: sign * shape.end,
                    });
                }
                shape
            }
        };
        let spans = shape
            .spans()
            .map(|(time, jerk)| (time, sign * jerk * limits.jerk));
        let first = Setpoint {
            velocity: start_velocity,
            ..Setpoint::at_rest(start)
        };
        Ok(Self {
            kind: shape.kind,
            peak: sign * shape.peak,
            steps: shape.steps,
            // Adding 0.0 removes the sign of zero.
            profile: Profile::lay(Order::Three, &first, spans, target, sign * shape.end + 0.0)?,
        })
    }

    /// Which of the paper's types the move is.
    pub const fn kind(&self) -> ShortPathType {
        self.kind
    }

    /// The highest velocity of the move (u/s, signed): the feed rate, or the modified one.
    pub const fn peak_velocity(&self) -> f64 {
        self.peak
    }

    /// The velocity at the target (u/s): the requested one, or the modified one.
    pub const fn end_velocity(&self) -> f64 {
        self.profile.end().velocity
    }

    /// The move itself.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Steps of root finding for the plan, at most [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS).
    pub const fn steps(&self) -> u32 {
        self.steps
    }
}

/// The direction of the move, 1 or -1.
fn forwards(distance: f64, start_velocity: f64, end_velocity: f64) -> f64 {
    let mut decisive = [distance, start_velocity, end_velocity].into_iter();
    let decisive = decisive.find(|value| *value != 0.0);
    if decisive.is_some_and(|value| value < 0.0) {
        -1.0
    } else {
        1.0
    }
}

/// A velocity in the direction of the move, within the feed rate.
fn speed(field: Field, value: f64, sign: f64, limits: &Limits) -> Result<f64, PlanError> {
    let speed = sign * value;
    if !speed.is_finite() {
        return Err(invalid(field, value));
    }
    let nearest = speed.max(0.0).min(limits.velocity);
    if nearest == speed {
        return Ok(speed + 0.0);
    }
    Err(PlanError::OutOfRange {
        field,
        value,
        nearest: sign * nearest,
    })
}

/// A change of velocity by a ramp with no acceleration at its ends (P8).
#[derive(Clone, Copy, Debug, PartialEq)]
struct Ramp {
    /// Length of the jerk pulses (s).
    pulse: f64,
    /// Length of the plateau of acceleration (s).
    plateau: f64,
    /// Whether there is such a plateau, even of length 0.
    ladder: bool,
}

impl Ramp {
    fn new(change: f64, acceleration: f64, jerk: f64) -> Self {
        let pulse = acceleration / jerk;
        let plateau = change / acceleration - pulse;
        if plateau >= 0.0 {
            Self {
                pulse,
                plateau,
                ladder: true,
            }
        } else {
            Self {
                pulse: sqrt(change / jerk),
                plateau: 0.0,
                ladder: false,
            }
        }
    }

    fn duration(&self) -> f64 {
        2.0 * self.pulse + self.plateau
    }
}

/// A problem with the move upwards: the distance, the two speeds and the limits.
#[derive(Clone, Copy)]
struct Path<'a> {
    length: f64,
    from: f64,
    to: f64,
    limits: &'a Limits,
}

/// The result: a ramp up, a cruise, a ramp down.
#[derive(Clone, Copy)]
struct Shape {
    kind: ShortPathType,
    up: Ramp,
    cruise: f64,
    down: Ramp,
    peak: f64,
    end: f64,
    steps: u32,
}

impl Shape {
    /// The segments as (seconds, jerk in units of its bound).
    fn spans(&self) -> [(f64, f64); 7] {
        let Self { up, cruise, down, .. } = self;
        [
            (up.pulse, 1.0),
            (up.plateau, 0.0),
            (up.pulse, -1.0),
            (*cruise, 0.0),
            (down.pulse, -1.0),
            (down.plateau, 0.0),
            (down.pulse, 1.0),
        ]
    }
}

impl Path<'_> {
    /// A rise of velocity by `change`.
    fn up(&self, change: f64) -> Ramp {
        Ramp::new(change, self.limits.acceleration, self.limits.jerk)
    }

    /// A fall of velocity by `change`.
    fn down(&self, change: f64) -> Ramp {
        Ramp::new(change, self.limits.deceleration, self.limits.jerk)
    }

    /// The two ramps over a peak that is `excess` above the larger one of the velocities.
    ///
    /// Computed from the excess and not from the peak, so that a small excess over a large velocity keeps
    /// its digits.
    fn ramps(&self, excess: f64) -> (Ramp, Ramp) {
        let rise = excess + (self.to - self.from).max(0.0);
        let fall = excess + (self.from - self.to).max(0.0);
        (self.up(rise), self.down(fall))
    }

    /// The distance of both ramps together (P9).
    fn ramps_length(&self, excess: f64) -> f64 {
        let peak = self.from.max(self.to) + excess;
        let (up, down) = self.ramps(excess);
        0.5 * ((self.from + peak) * up.duration() + (peak + self.to) * down.duration())
    }

    /// Whether a single ramp between the two velocities is short enough.
    fn reaches_end(&self) -> bool {
        self.length >= self.ramps_length(0.0) * (1.0 - SLACK)
    }

    /// The highest peak that the feed rate and the distance allow (P10).
    fn least_time(&self) -> Shape {
        use ShortPathType::{T1, T2, T3, T4, T5, T6, T7, T8A};
        let base = self.from.max(self.to);
        let feed = self.limits.velocity - base;
        let left = self.length - self.ramps_length(feed);
        let cruises = left >= 0.0;
        let (excess, steps) = if cruises {
            (feed, 0)
        } else {
            let spare = (self.length - self.ramps_length(0.0)).max(0.0);
            let both = self.limits.acceleration.max(self.limits.deceleration);
            let high = feed.min(self.most_rise(spare, base, both));
            falling_root(0.0, high, |excess| self.length - self.ramps_length(excess))
        };
        let (up, down) = self.ramps(excess);
        let kind = match (up.ladder, down.ladder, cruises) {
            (true, true, true) => T1,
            (true, false, true) => T2,
            (false, true, true) => T3,
            (false, false, true) => T4,
            (true, true, false) => T5,
            (true, false, false) => T6,
            (false, true, false) => T7,
            (false, false, false) => T8A,
        };
        let peak = if cruises {
            self.limits.velocity
        } else {
            base + excess
        };
        Shape {
            kind,
            up,
            cruise: if cruises { left / peak } else { 0.0 },
            down,
            peak,
            end: self.to,
            steps,
        }
    }

    /// A single ramp towards the end velocity, as far as the distance allows (P11).
    fn single_ramp(&self) -> Shape {
        let still = self.up(0.0);
        let rising = self.to > self.from;
        let (change, steps) = if rising {
            let most = self.most_rise(self.length, self.from, self.limits.acceleration);
            let high = most.min(self.to - self.from);
            let length = |change: f64| 0.5 * (2.0 * self.from + change) * self.up(change).duration();
            falling_root(0.0, high, |change| self.length - length(change))
        } else {
            let lowest = self.to.max(self.longest_fall());
            let high = self.most_fall(self.length).min(self.from - lowest);
            let length = |change: f64| 0.5 * (2.0 * self.from - change) * self.down(change).duration();
            falling_root(0.0, high, |change| self.length - length(change))
        };
        let (up, down) = if rising {
            (self.up(change), still)
        } else {
            (still, self.down(change))
        };
        let end = if rising {
            self.from + change
        } else {
            self.from - change
        };
        Shape {
            kind: ShortPathType::T8B,
            up,
            cruise: 0.0,
            down,
            peak: self.from.max(end),
            end,
            steps,
        }
    }

    /// A bound on the change of velocity by a ramp up from `base` within `length`: the change without a
    /// bound on acceleration, at constant and at growing velocity, and the change without a bound on jerk
    /// (P12).
    fn most_rise(&self, length: f64, base: f64, acceleration: f64) -> f64 {
        let jerk = self.limits.jerk;
        let time = length / (2.0 * base);
        let near = jerk * time * time;
        let far = cbrt(jerk * length * length);
        let energy = 2.0 * acceleration * length;
        let steady = energy / (sqrt(base * base + energy) + base);
        // `near` and `steady` are NaN if both `length` and `base` are 0; `min` skips them.
        far.min(near).min(steady) * NOT_SHORT
    }

    /// The same for a ramp down from the start velocity to [`Path::longest_fall`] or less far (P12).
    fn most_fall(&self, length: f64) -> f64 {
        let time = length / self.from;
        let jerk = self.limits.jerk * time * time;
        let steady = 2.0 * self.limits.deceleration * time;
        jerk.min(steady) * NOT_SHORT
    }

    /// The end velocity to which a ramp down from the start takes the longest distance. Above it, a lower end
    /// velocity takes more distance, below it less (P13).
    fn longest_fall(&self) -> f64 {
        let change = self.limits.deceleration * (self.limits.deceleration / self.limits.jerk);
        if 2.0 * self.from < 3.0 * change {
            self.from / 3.0
        } else {
            0.5 * change
        }
    }
}
