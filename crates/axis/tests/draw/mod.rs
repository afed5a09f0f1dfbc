//! Limits of an axis and dynamics of commands, drawn at random.

use standstill_axis::{Dynamics, Limits};
use standstill_testkit::Random;

/// A share of an axis limit: all of it, most of it, or some of it.
fn share(random: &mut Random, limit: f64) -> f64 {
    match random.below(3) {
        0 => 0.0,
        1 => limit * 0.8,
        _ => limit * random.between(0.05, 1.0),
    }
}

/// Dynamics of a command on an axis of these limits.
pub fn dynamics(random: &mut Random, limits: &Limits) -> Dynamics {
    let velocity = match random.below(3) {
        0 => limits.velocity,
        _ => limits.velocity * random.between(0.05, 1.0),
    };
    let bounded = |share: f64| if share.is_finite() { share } else { 0.0 };
    let acceleration = share(random, limits.acceleration);
    Dynamics {
        velocity,
        acceleration,
        deceleration: if random.below(2) == 0 {
            acceleration
        } else {
            share(random, limits.deceleration)
        },
        jerk: bounded(share(random, limits.jerk)),
        snap: bounded(share(random, limits.snap)),
    }
}

/// Limits of order 2, 3 or 4; in a third of the cases deceleration and acceleration differ.
pub fn limits(random: &mut Random) -> Limits {
    let order = random.below(3);
    let acceleration = random.between(200.0, 2000.0);
    let deceleration = if random.below(3) == 0 {
        random.between(200.0, 2000.0)
    } else {
        acceleration
    };
    let (mut jerk, mut snap) = (f64::INFINITY, f64::INFINITY);
    if order > 0 {
        jerk = random.between(5e3, 5e4);
    }
    if order > 1 {
        snap = random.between(2e5, 2e6);
    }
    Limits {
        velocity: random.between(20.0, 200.0),
        acceleration,
        deceleration,
        jerk,
        snap,
    }
}
