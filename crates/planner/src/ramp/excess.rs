//! The extremes of a ramp, and their excess over the limits.

use super::path::Path;
use crate::kernel::ON_LIMIT;
use crate::limits::REACH;
use crate::{DirectedLimits, Order, Setpoint};

/// The resolution of a 64-bit instant of a path, relative to its duration.
const TICK: f64 = 2.0 * f64::EPSILON;

/// The error of an acceleration, relative to the largest one from which it results.
const CHANGED: f64 = 1e-10;

/// The excess that a start state forced on a plan, as magnitudes above the limit.
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

impl Peaks {
    /// Takes a state on the way into account.
    pub(crate) fn see(&mut self, state: &Setpoint) {
        self.velocity = self.velocity.max(state.velocity.abs());
        self.acceleration = self.acceleration.max(state.acceleration.abs());
        self.jerk = self.jerk.max(state.jerk.abs());
        self.snap = self.snap.max(state.snap.abs());
    }

    /// Infinite where a plan of `order` has jumps.
    pub(crate) fn with_jumps(mut self, order: Order) -> Self {
        if order < Order::Four {
            self.snap = f64::INFINITY;
        }
        if order < Order::Three {
            self.jerk = f64::INFINITY;
        }
        self
    }
}

/// The largest magnitudes along `path`, which ends at `goal` (R20).
pub(crate) fn peaks<const N: usize>(path: &Path<N>, goal: f64) -> Peaks {
    let mut peaks = Peaks {
        velocity: goal.abs(),
        ..Peaks::default()
    };
    path.extremes(f64::INFINITY, |state, _| peaks.see(state));
    peaks.with_jumps(path.order())
}

/// Whether the velocity along `path`, which ends at `goal`, leaves its bounds.
pub(crate) fn leaves<const N: usize>(path: &Path<N>, goal: f64, limits: &DirectedLimits) -> bool {
    let out = |velocity: f64| velocity.abs() > limits.velocity(velocity) * (1.0 + ON_LIMIT);
    let mut leaves = out(goal);
    path.extremes(f64::INFINITY, |state, _| leaves |= out(state.velocity));
    leaves
}

/// The excess of `path`, which ends with the velocity `goal`, over `limits`. `None` if it is no more than rounding:
/// [`ON_LIMIT`], and the change within the resolution of the path's times.
///
/// With a `heading` (1 or -1) the path is a ramp that starts in that direction, and a stop that turns back counts
/// as an excess, too. Without one the path may turn freely.
pub(crate) fn excess<const N: usize>(
    path: &Path<N>,
    goal: f64,
    heading: Option<f64>,
    directed: &DirectedLimits,
) -> Option<Excess> {
    let (limits, lower) = (&directed.either(), directed.lower_velocity());
    // Half the tolerance, so that rounding can't make this result differ from the one below.
    let near = 1.0 + 0.5 * ON_LIMIT;
    if heading.is_none()
        && lower.is_finite()
        && path.is_surely_within(
            lower * near,
            limits.lower_acceleration() * near,
            limits.jerk * near,
        )
    {
        return None;
    }
    let mut excess = Excess::default();
    let peaks = peaks(path, goal);
    let scale = |bound: f64| {
        if bound.is_finite() {
            bound.min(4.0 * REACH * peaks.velocity)
        } else {
            peaks.velocity
        }
    };
    let small = ON_LIMIT * scale(lower);
    // A piece whose end is late by the resolution of the time continues to change for that long.
    let tick = TICK * path.duration();
    // A bound far below the other one is reached by an acceleration that has changed by as much as the other one.
    let rounding = CHANGED
        * limits
            .acceleration
            .max(limits.deceleration)
            .min(peaks.acceleration);
    // With one bound for both directions nothing changes when the velocity passes zero.
    let sides_differ = limits.acceleration != limits.deceleration;
    let noticed = if sides_differ { small } else { f64::INFINITY };
    path.extremes(noticed, |state, direction| {
        let velocity = state.velocity;
        let outside = directed.outside(velocity);
        let reversed = match heading {
            Some(heading) if goal == 0.0 => -heading * velocity,
            _ => 0.0,
        };
        let over = outside.max(reversed);
        excess.velocity = excess.velocity.max(beyond(
            over,
            scale(directed.velocity(velocity)),
            tick * state.acceleration,
        ));

        // In the direction of motion it raises the speed, against it it lowers it.
        let bound = match direction {
            None => limits.lower_acceleration(),
            Some(along) if along.abs() <= small => limits.acceleration.max(limits.deceleration),
            Some(along) if state.acceleration * along > 0.0 => limits.acceleration,
            Some(_) => limits.deceleration,
        };
        let over = state.acceleration.abs() - bound;
        excess.acceleration =
            excess
                .acceleration
                .max(beyond(over, bound, tick * state.jerk.abs() + rounding));
        let over = state.jerk.abs() - limits.jerk;
        excess.jerk = excess.jerk.max(beyond(over, limits.jerk, tick * state.snap));
    });
    (excess != Excess::default()).then_some(excess)
}

/// `over` if it is more than the tolerance for `bound` and the change `within` a tick, otherwise 0.
fn beyond(over: f64, bound: f64, within: f64) -> f64 {
    if over > ON_LIMIT * bound + within.abs() {
        over
    } else {
        0.0
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_testkit::Random;
    use std::vec::Vec;

    #[test]
    fn what_is_surely_within_bounds_has_no_peak_beyond_them() {
        let mut random = Random(5);
        let (mut sure, mut inside) = (0, 0);
        for case in 0..60_000 {
            let order = [Order::Two, Order::Three, Order::Four][case % 3];
            let start = Setpoint {
                position: 0.0,
                velocity: random.between(-1.0, 1.0),
                acceleration: random.between(-1.0, 1.0),
                jerk: random.between(-1.0, 1.0),
                snap: 0.0,
            };
            let mut path = Path::<5>::new(order);
            let inputs = [-1.0, 0.0, 1.0, random.between(-1.0, 1.0)];
            let spans: Vec<(f64, f64)> = (0..1 + case % 5)
                .map(|_| {
                    (
                        1.0 + random.between(-1.0, 1.0),
                        inputs[(2.0 + 2.0 * random.between(-1.0, 1.0)) as usize % 4],
                    )
                })
                .collect();
            let end = path.fill(&start, f64::INFINITY, spans.into_iter());
            let peaks = peaks(&path, end.velocity);
            let mut bound = |peak: f64| peak * (1.0 + 0.3 * random.between(-1.0, 1.0) + 1e-12);
            let bounds = [peaks.velocity, peaks.acceleration, peaks.jerk].map(&mut bound);
            let [velocity, acceleration, jerk] = bounds;
            let is_inside =
                peaks.velocity <= velocity && peaks.acceleration <= acceleration && peaks.jerk <= jerk;
            if path.is_surely_within(velocity, acceleration, jerk) {
                assert!(is_inside, "{path:?} {peaks:?} {bounds:?}");
                sure += 1;
            }
            inside += u32::from(is_inside);
        }
        // Paths at random turn far more often than plans do.
        assert!(2 * sure > inside, "{sure} of {inside}");
    }
}
