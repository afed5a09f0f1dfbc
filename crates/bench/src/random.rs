//! Random moves: typical moves of servo axes from rest, and moves from any state.

use crate::CYCLE;
use standstill_planner::kernel::{Sides, second};
use standstill_planner::{Limits, OnlinePlan, Order, PlanError, Setpoint};
use standstill_testkit::Random;

/// A rest-to-rest move.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Start (u).
    pub start: f64,
    /// Target (u).
    pub target: f64,
    /// Bounds, all finite.
    pub limits: Limits,
    /// Sample time (s).
    pub cycle: f64,
}

/// A move from any state to rest.
#[derive(Clone, Copy, Debug)]
pub struct Replan {
    /// Start; from it acceleration and jerk can be brought to zero inside the limits.
    pub start: Setpoint,
    /// Target (u).
    pub target: f64,
    /// Bounds, all finite.
    pub limits: Limits,
}

impl Replan {
    /// The plan of order 4, or of 3: without the snap bound, for any jerk at the start.
    ///
    /// # Errors
    /// None for what [`Random`] draws.
    pub fn plan(&self, order: Order) -> Result<OnlinePlan, PlanError> {
        let limits = Limits {
            snap: if order == Order::Four {
                self.limits.snap
            } else {
                f64::INFINITY
            },
            ..self.limits
        };
        OnlinePlan::new(&self.start, self.target, &limits, &limits, CYCLE)
    }
}

/// Between `low` and `high`, both above 0, with all binades equally likely, like bit patterns in order.
fn binades(random: &mut Random, low: f64, high: f64) -> f64 {
    let range = high.to_bits().saturating_sub(low.to_bits()).max(1);
    f64::from_bits(low.to_bits() + random.bits() % range)
}

/// A move of order 4: 0.1 ms to 10 s at the velocity limit, in cycles of 0.1 ms to 10 ms.
pub fn servo(random: &mut Random) -> Move {
    let velocity = binades(random, 0.01, 10.0);
    let acceleration = velocity * binades(random, 1.0, 300.0);
    let jerk = acceleration * binades(random, 1.0, 1000.0);
    let snap = jerk * binades(random, 1.0, 3000.0);
    let distance = velocity * binades(random, 1e-4, 10.0);
    let (forward, positive) = (random.bits() & 1 == 0, random.bits() & 1 == 0);
    let size = binades(random, 1e-3, 1e3);
    let start = if positive { size } else { -size };
    Move {
        start,
        target: if forward {
            start + distance
        } else {
            start - distance
        },
        limits: Limits {
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk,
            snap,
        },
        cycle: binades(random, 1e-4, 1e-2),
    }
}

/// Positions and limits of ordinary size, as in examples for robot planners.
pub fn ordinary(random: &mut Random, is_moving: bool) -> Replan {
    let velocity = random.between(0.1, 12.0);
    let acceleration = random.between(0.1, 12.0);
    let jerk = random.between(0.1, 12.0);
    let snap = random.between(0.1, 12.0);
    let position = random.between(-8.0, 8.0);
    let target = random.between(-8.0, 8.0);
    replan(
        random,
        [velocity, acceleration, jerk, snap],
        position,
        target - position,
        is_moving,
    )
}

/// Limits of servo axes in any unit: spread over binades, with distances from a hundred-thousandth of a
/// second at the velocity limit to a hundred seconds.
pub fn any_unit(random: &mut Random, is_moving: bool) -> Replan {
    let velocity = binades(random, 0.01, 1000.0);
    let acceleration = velocity * binades(random, 1.0, 1000.0);
    let jerk = acceleration * binades(random, 1.0, 1e4);
    let snap = jerk * binades(random, 1.0, 1e4);
    let distance = velocity * binades(random, 1e-5, 100.0);
    let side = if random.bits() & 1 == 0 { 1.0 } else { -1.0 };
    replan(
        random,
        [velocity, acceleration, jerk, snap],
        0.0,
        side * distance,
        is_moving,
    )
}

fn replan(random: &mut Random, bounds: [f64; 4], position: f64, distance: f64, is_moving: bool) -> Replan {
    let [velocity, acceleration, jerk, snap] = bounds;
    let limits = Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk,
        snap,
    };
    let mut start = Setpoint::at_rest(position);
    if is_moving {
        loop {
            start.velocity = random.between(-velocity, velocity);
            start.acceleration = random.between(-acceleration, acceleration);
            start.jerk = random.between(-jerk, jerk);
            if is_viable(&start, &limits) {
                break;
            }
        }
    }
    Replan {
        start,
        target: position + distance,
        limits,
    }
}

/// Whether acceleration and jerk come to zero inside `limits` if they do so as soon as possible; also the
/// acceleration if the snap is unbounded.
fn is_viable(start: &Setpoint, limits: &Limits) -> bool {
    let snap = limits.snap;
    let change = start.acceleration * start.acceleration.abs() / (2.0 * limits.jerk);
    if (start.velocity + change).abs() > limits.velocity {
        return false;
    }
    let sides = Sides::both(limits.jerk / snap);
    let arrest = second(start.acceleration / snap, start.jerk / snap, 0.0, sides);
    let mut state = *start;
    for span in arrest.split(16) {
        let (t, s) = (span.duration, span.input * snap);
        state.velocity += t * (state.acceleration + t * (state.jerk / 2.0 + t * s / 6.0));
        state.acceleration += t * (state.jerk + t * s / 2.0);
        state.jerk += t * s;
        if state.velocity.abs() > limits.velocity || state.acceleration.abs() > limits.acceleration {
            return false;
        }
    }
    true
}
