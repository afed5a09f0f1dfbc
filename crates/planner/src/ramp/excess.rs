//! The extremes of a ramp, and by how much they exceed the limits.

use super::path::Path;
use crate::kernel::ON_LIMIT;
use crate::{Limits, Order};

/// By how much a start state forced a plan out of its limits, as magnitudes above the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// Velocity above its limit, or against the sign a stop should keep (u/s).
    pub velocity: f64,
    /// Acceleration above its limit (u/s^2).
    pub acceleration: f64,
    /// Jerk above its limit (u/s^3).
    pub jerk: f64,
}

/// The largest magnitudes of a continuous plan; infinite where its order leaves jumps.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
    /// Jerk (u/s^3); infinite at order 2.
    pub jerk: f64,
    /// Snap (u/s^4); infinite at orders 2 and 3.
    pub snap: f64,
}

/// The largest magnitudes along `path`, which ends at `goal` (R20).
pub(crate) fn peaks<const N: usize>(path: &Path<N>, goal: f64) -> Peaks {
    let mut peaks = Peaks {
        velocity: goal.abs(),
        ..Peaks::default()
    };
    path.extremes(f64::INFINITY, |state, _| {
        peaks.velocity = peaks.velocity.max(state.velocity.abs());
        peaks.acceleration = peaks.acceleration.max(state.acceleration.abs());
        peaks.jerk = peaks.jerk.max(state.jerk.abs());
        peaks.snap = peaks.snap.max(state.snap.abs());
    });
    if path.order() < Order::Four {
        peaks.snap = f64::INFINITY;
    }
    if path.order() < Order::Three {
        peaks.jerk = f64::INFINITY;
    }
    peaks
}

/// By how much `path`, which ends with the velocity `goal`, exceeds `limits`; `None` if by no more than
/// rounding and [`ON_LIMIT`].
///
/// With a `heading` (1 or -1) the path is a ramp that starts in that direction, and a stop that turns back
/// exceeds too; without one the path may turn as it likes.
pub(crate) fn excess<const N: usize>(
    path: &Path<N>,
    goal: f64,
    heading: Option<f64>,
    limits: &Limits,
) -> Option<Excess> {
    let mut excess = Excess::default();
    let scale = if limits.velocity.is_finite() {
        limits.velocity
    } else {
        peaks(path, goal).velocity
    };
    let small = ON_LIMIT * scale;
    // With one bound for both directions nothing changes where the velocity passes zero.
    let sides_differ = limits.acceleration != limits.deceleration;
    let noticed = if sides_differ { small } else { f64::INFINITY };
    path.extremes(noticed, |state, direction| {
        let velocity = state.velocity;
        let outside = velocity.abs() - limits.velocity;
        let reversed = match heading {
            Some(heading) if goal == 0.0 => -heading * velocity,
            _ => 0.0,
        };
        excess.velocity = excess.velocity.max(outside).max(reversed);

        // With the motion it raises the speed, against it it lowers it.
        let bound = match direction {
            None => limits.lower_acceleration(),
            Some(along) if along.abs() <= small => limits.acceleration.max(limits.deceleration),
            Some(along) if state.acceleration * along > 0.0 => limits.acceleration,
            Some(_) => limits.deceleration,
        };
        let over = state.acceleration.abs() - bound;
        excess.acceleration = excess.acceleration.max(beyond(over, bound));
        excess.jerk = excess
            .jerk
            .max(beyond(state.jerk.abs() - limits.jerk, limits.jerk));
    });
    excess.velocity = beyond(excess.velocity, scale);
    (excess != Excess::default()).then_some(excess)
}

/// `over` if it is more than the tolerance for `bound`, else 0.
fn beyond(over: f64, bound: f64) -> f64 {
    if over > ON_LIMIT * bound { over } else { 0.0 }
}
