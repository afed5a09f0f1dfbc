//! The zero of a function that costs much to evaluate.

use super::MAX_STEPS;
use crate::math::{max, min};

/// A function at one argument.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The argument.
    pub at: f64,
    /// The value there.
    pub value: f64,
    /// What of the value may be rounding.
    pub noise: f64,
}

/// Steps the bracket may take longer than by halving it every other step.
const PATIENCE: f64 = 16.0;

/// An argument between `low` and `high`, where a continuous function has values of different signs, at
/// which it is zero up to its rounding; also the steps taken, at most [`MAX_STEPS`].
///
/// Inverse quadratic interpolation where it is safe (Chandrupatla's rule), halving elsewhere, and always
/// halving when the bracket has not become half as wide with every two steps. So after
/// 114 steps the bracket is below 2^-52 of what it was, whatever the function, and that ends it.
pub fn zero(low: Point, high: Point, mut function: impl FnMut(f64) -> Point) -> (Point, u32) {
    // `new` and `old` have different signs; `last` is what the newer of the two replaced.
    let (mut new, mut old) = if low.value.abs() < high.value.abs() {
        (low, high)
    } else {
        (high, low)
    };
    let mut best = new;
    let mut part = new.value / (new.value - old.value);
    let narrow = f64::EPSILON * (high.at - low.at).abs();
    let mut wanted = PATIENCE * (high.at - low.at).abs();
    for step in 1..=MAX_STEPS {
        let width = old.at - new.at;
        // A step of less than this is no step.
        let least = 2.0 * f64::EPSILON * max(new.at.abs(), old.at.abs()) / width.abs();
        if best.value.abs() <= best.noise || least >= 0.5 || width.abs() <= narrow {
            return (best, step - 1);
        }
        let point = function(new.at + width * min(max(part, least), 1.0 - least));
        let last = if (point.value < 0.0) == (new.value < 0.0) {
            new
        } else {
            core::mem::replace(&mut old, new)
        };
        new = point;
        if point.value.abs() < best.value.abs() {
            best = point;
        }
        wanted *= core::f64::consts::FRAC_1_SQRT_2;
        part = if (old.at - new.at).abs() > wanted {
            0.5
        } else {
            interpolated(&new, &old, &last).unwrap_or(0.5)
        };
    }
    (best, MAX_STEPS)
}

/// Where between `new` (0) and `old` (1) the inverse quadratic through three points is zero, if it is
/// monotone there.
fn interpolated(new: &Point, old: &Point, last: &Point) -> Option<f64> {
    let xi = (new.at - old.at) / (last.at - old.at);
    let phi = (new.value - old.value) / (last.value - old.value);
    let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
    safe.then(|| {
        let (a, b, c) = (new.value, old.value, last.value);
        a / (b - a) * (c / (b - c)) + (last.at - new.at) / (old.at - new.at) * (a / (c - a)) * (b / (c - b))
    })
}
