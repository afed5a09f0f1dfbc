//! The zero of a function that is expensive to evaluate.

use super::MAX_STEPS;
use crate::math::{max, min, rough_power};

/// A function at one argument.
#[derive(Clone, Copy, Debug)]
pub struct Point {
    /// The argument.
    pub at: f64,
    /// The value there.
    pub value: f64,
    /// The part of the value that may be rounding.
    pub noise: f64,
    /// The slope of the value over the argument; NaN if it is not known.
    pub slope: f64,
}

/// Steps the bracket may take longer than by halving it every other step.
const PATIENCE: f64 = 16.0;

/// An argument between `low` and `high`, where a continuous function has values of different signs, at which the
/// function is zero up to its rounding. Also returns the number of steps, at most [`MAX_STEPS`].
///
/// A step goes to the zero of the cubic through the last two points if slopes are known, otherwise to that of the
/// inverse quadratic through three points if it is safe (Chandrupatla's rule), otherwise to the middle. It always
/// goes to the middle if the bracket has not been halved in every two steps. So for any function the bracket is
/// below 2^-52 of its first width after 114 steps, which ends the search.
pub fn zero(low: Point, high: Point, mut function: impl FnMut(f64) -> Point) -> (Point, u32) {
    // `new` and `old` have different signs; `last` is the point that the newer of the two replaced.
    let (mut new, mut old) = if low.value.abs() < high.value.abs() {
        (low, high)
    } else {
        (high, low)
    };
    let mut best = new;
    let is_found = |best: &Point| best.value.abs() <= best.noise;
    if is_found(&best) {
        return (best, 0);
    }
    let mut part = by_slopes(&new, &old, &old).unwrap_or_else(|| new.value / (new.value - old.value));
    let narrow = f64::EPSILON * (high.at - low.at).abs();
    let mut wanted = PATIENCE * (high.at - low.at).abs();
    for step in 1..=MAX_STEPS {
        let width = old.at - new.at;
        // A step of less than this counts as no step.
        let least = 2.0 * f64::EPSILON * max(new.at.abs(), old.at.abs()) / width.abs();
        if least >= 0.5 || width.abs() <= narrow {
            return (best, step - 1);
        }
        let point = function(new.at + width * min(max(part, least), 1.0 - least));
        let before = new;
        let last = if (point.value < 0.0) == (new.value < 0.0) {
            new
        } else {
            core::mem::replace(&mut old, new)
        };
        new = point;
        if point.value.abs() < best.value.abs() {
            best = point;
            if is_found(&best) {
                return (best, step);
            }
        }
        wanted *= core::f64::consts::FRAC_1_SQRT_2;
        part = if (old.at - new.at).abs() > wanted {
            0.5
        } else {
            by_slopes(&new, &before, &old)
                .or_else(|| interpolated(&new, &old, &last))
                .unwrap_or(0.5)
        };
    }
    (best, MAX_STEPS)
}

/// The position between `new` (0) and `old` (1) at which the inverse quadratic through three points is zero, if it
/// is monotone there.
fn interpolated(new: &Point, old: &Point, last: &Point) -> Option<f64> {
    let xi = (new.at - old.at) / (last.at - old.at);
    let phi = (new.value - old.value) / (last.value - old.value);
    let safe = phi * phi < xi && (1.0 - phi) * (1.0 - phi) < 1.0 - xi;
    safe.then(|| {
        let (a, b, c) = (new.value, old.value, last.value);
        a / (b - a) * (c / (b - c)) + (last.at - new.at) / (old.at - new.at) * (a / (c - a)) * (b / (c - b))
    })
}

/// The position between `new` (0) and `old` (1) of the zero of a cubic. The cubic has the values and slopes of
/// `new` and of `before`, the previous point. `None` if a slope is not known or is against the chord, or if the
/// zero is not between them.
fn by_slopes(new: &Point, before: &Point, old: &Point) -> Option<f64> {
    let (way, change) = (before.at - new.at, before.value - new.value);
    let (from, to) = (new.slope * way / change, before.slope * way / change);
    if !(from >= 0.0 && to >= 0.0) {
        return None;
    }
    // Without a sign: a zero may have one, and the mirrored function has the other one.
    let part = reached(-new.value / change, from.abs(), to.abs()) * way / (old.at - new.at);
    (part > 0.0 && part < 1.0).then_some(part)
}

/// If the slope at an end is at most this, a cubic from (0, 0) to (1, 1) does not fall between them.
const STEEP: f64 = 3.0;

/// From here on a cubic that is flat at 0 rises, for any slope at 1.
const RISING: f64 = 2.0 / 3.0;

/// The position at which the cubic from (0, 0) to (1, 1) with the slopes `from` and `to` reaches `level`. If it
/// might fall, about the position at which a power with the steeper one of the slopes does.
fn reached(level: f64, from: f64, to: f64) -> f64 {
    let (mut t, mut is_cubic) = (0.0, true);
    if level > 0.0 && level < 1.0 {
        let rises = from < to;
        let (height, flat, steep) = if rises {
            (level, from, to)
        } else {
            (1.0 - level, to, from)
        };
        // Not farther than the line with the other slope.
        let risen = min(rough_power(height, 1.0 / steep), height / flat);
        t = if rises { risen } else { 1.0 - risen };
        is_cubic = steep <= STEEP || risen > RISING;
    }
    if is_cubic {
        let (square, cube) = (3.0 - 2.0 * from - to, from + to - 2.0);
        // Newton's steps; a third one would cost more than it saves.
        for _ in 0..2 {
            let value = t * (from + t * (square + t * cube)) - level;
            t -= value / (from + t * (2.0 * square + 3.0 * t * cube));
        }
    }
    t
}
