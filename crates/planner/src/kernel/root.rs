//! The one root of the third-order problem: the end of a rising push and the begin of the stop.

use super::third::depth_term;
use crate::math::{max, min, rough_cbrt, sqrt};

/// Largest number of steps that a root may take. A false position needs at most 94, a [`zero`](super::zero) 114;
/// the tests show how many the others need.
pub const MAX_STEPS: u32 = 116;

/// A Newton step this small, relative to the root, is the last one: the next would be of rounding size.
const CONVERGED: f64 = 1e-9;

/// The switch from push to stop.
pub(super) struct Intercept {
    /// `a` at the switch.
    pub(super) a: f64,
    /// `v + a^2/2` at the switch: the squared depth of the stop without a bound.
    pub(super) drop: f64,
    /// Root steps taken.
    pub(super) steps: u32,
}

/// A push with input 1 that has to end where the downward stop ends on the target (R7).
pub(super) struct Rising {
    /// `v - a^2/2`, the same all along the push.
    offset: f64,
    /// Right-hand side of (R7).
    budget: f64,
    /// `a` at the start of the push.
    start: f64,
    /// Bound on `a` in the stop.
    brake: f64,
}

impl Rising {
    /// From `(v, a)` with the target `left` further.
    pub(super) fn new(left: f64, v: f64, a: f64, brake: f64) -> Self {
        let offset = v - 0.5 * a * a;
        Self {
            offset,
            budget: left + a * (offset + a * a / 6.0),
            start: a,
            brake,
        }
    }

    /// The switch, which is between the start and `highest`.
    ///
    /// The left side of (R7) does not fall between them. It is smooth except at the two points where the stop just
    /// touches its bound. These points show which of the three stretches has the root.
    pub(super) fn solve(&self, highest: f64) -> Intercept {
        let Self { offset, brake, .. } = *self;
        // Below these the stop continues the push, and nothing changes (R6).
        let lowest = max(self.start, -brake);
        let lowest = if offset < 0.0 {
            min(max(sqrt(-offset), lowest), highest)
        } else {
            lowest
        };
        let square = brake * brake - offset;
        if square <= 0.0 {
            return self.clipped(lowest, highest);
        }
        let touch = sqrt(square);
        if lowest < -touch && self.surplus(-touch) >= 0.0 {
            self.clipped(lowest, -touch)
        } else if highest <= touch || self.surplus(touch) >= 0.0 {
            self.pointed(max(-touch, lowest), min(touch, highest))
        } else {
            self.clipped(max(touch, lowest), highest)
        }
    }

    /// Left minus right side of (R7).
    fn surplus(&self, a: f64) -> f64 {
        let drop = max(a * a + self.offset, 0.0);
        a * (a * a + 2.0 * self.offset) + depth_term(drop, self.brake) - self.budget
    }

    /// The root if the stop does not reach its bound: a quartic in the sum of `a` and the depth (R9).
    fn pointed(&self, lowest: f64, highest: f64) -> Intercept {
        let Self { offset, budget, .. } = *self;
        let sum = |a: f64| {
            let depth = sqrt(max(a * a + offset, 0.0));
            if a >= 0.0 { a + depth } else { offset / (depth - a) }
        };
        let (low, high) = (sum(lowest), sum(highest));
        let guess = min(max(guess_sum(offset, budget), low), high);
        let (sum, steps) = bracketed(low, high, guess, |s| {
            let ratio = offset / s;
            let terms = [s * s * s, 4.0 * offset * s, -offset * ratio, -4.0 * budget];
            Sample::new(terms, (3.0 * s + ratio) * (s + ratio))
        });
        let ratio = if sum > 0.0 { offset / sum } else { 0.0 };
        let depth = 0.5 * (sum + ratio);
        Intercept {
            a: max(0.5 * (sum - ratio), self.start),
            drop: depth * depth,
            steps,
        }
    }

    /// The root if the stop holds its bound for some time: a quartic in `a + brake/2` (R10).
    fn clipped(&self, lowest: f64, highest: f64) -> Intercept {
        let Self {
            offset,
            budget,
            brake,
            ..
        } = *self;
        let half = 0.5 * brake;
        let shift = offset - half * half;
        let (low, high) = (lowest + half, highest + half);
        // With `offset` 0 the equation is a square, and the guess the root.
        let near = if offset > 0.0 { low } else { high };
        let square = 2.0 * brake * (budget - offset * near);
        let guess = sqrt(max(sqrt(max(square, 0.0)) - shift, 0.0));
        let guess = min(max(guess, low), high);
        let (x, steps) = bracketed(low, high, guess, |x| {
            let y = x * x + shift;
            let linear = 2.0 * brake * offset;
            let terms = [x * x * y, shift * y, linear * x, -2.0 * brake * budget];
            Sample::new(terms, 4.0 * x * y + linear)
        });
        let a = max(x - half, self.start);
        Intercept {
            a,
            drop: a * a + offset,
            steps,
        }
    }
}

/// A first guess for the sum in (R9), at most about a quarter too large: the larger of the terms decides.
fn guess_sum(offset: f64, budget: f64) -> f64 {
    if offset > 0.0 {
        let cube = offset * offset * offset;
        let root = sqrt(budget * budget + cube);
        if budget > 0.0 {
            let linear = (budget + root) / (2.0 * offset);
            min(linear, rough_cube_root(4.0 * budget))
        } else {
            offset * offset / (2.0 * (root - budget))
        }
    } else if offset < 0.0 {
        let least = sqrt(-offset);
        let excess = max(budget - offset * least, 0.0);
        let near = least + sqrt(2.0 * excess / least);
        let far = max(rough_cube_root(8.0 * excess), 3.0 * least);
        min(near, far)
    } else {
        rough_cube_root(4.0 * budget)
    }
}

/// Cube root to within a few per cent, for first guesses only; 0 where there is no normal one.
fn rough_cube_root(x: f64) -> f64 {
    if x.is_normal() && x > 0.0 {
        rough_cbrt(x)
    } else {
        0.0
    }
}

/// A function at one point.
struct Sample {
    value: f64,
    slope: f64,
    /// The part of the value that may be rounding.
    noise: f64,
}

impl Sample {
    /// A value that is the sum of `terms`.
    fn new(terms: [f64; 4], slope: f64) -> Self {
        let [a, b, c, d] = terms;
        Self {
            value: (a + d) + (b + c),
            slope,
            noise: 2.0 * f64::EPSILON * (a.abs() + b.abs() + c.abs() + d.abs()),
        }
    }
}

/// The root of a function that does not fall between `low` and `high`: Newton's steps, kept in the bracket. If a
/// step is not at most half the one before, the bracket is halved.
///
/// Ends when the value is rounding, with at most [`MAX_STEPS`] evaluations.
fn bracketed(mut low: f64, mut high: f64, guess: f64, function: impl Fn(f64) -> Sample) -> (f64, u32) {
    let mut x = guess;
    let mut last = high - low;
    for step in 1..=MAX_STEPS {
        let Sample { value, slope, noise } = function(x);
        let newton = x - value / slope;
        let small = (newton - x).abs() <= CONVERGED * x.abs();
        if value.abs() <= noise || small || low >= high {
            // The root may be an end of the bracket, and the last step a rounding error beyond it.
            let better = if small {
                min(max(newton, low), high)
            } else {
                newton
            };
            let inside = better >= low && better <= high;
            return (if inside { better } else { x }, step);
        }
        if value > 0.0 {
            high = x;
        } else {
            low = x;
        }
        let good = newton >= low && newton <= high && (newton - x).abs() <= 0.5 * last;
        let next = if good { newton } else { 0.5 * (low + high) };
        last = (next - x).abs();
        x = next;
    }
    (x, MAX_STEPS)
}

/// The first zero of a continuous function that is positive at `low` and not at `high`, by false position with
/// halved weights. Also returns the number of steps, at most [`MAX_STEPS`].
///
/// The result is an argument at which the function is not positive, to 1e-14 of the bracket or one unit in the last
/// place. Every other step halves the bracket, so 94 steps are enough for any function.
pub fn falling_root(low: f64, high: f64, function: impl Fn(f64) -> f64) -> (f64, u32) {
    let tolerance = 1e-14 * (high - low);
    let (mut low, mut high) = (low, high);
    let (mut above, mut below) = (function(low), function(high));
    let mut side = 0;
    for step in 1..=MAX_STEPS {
        let slope = above - below;
        let chord = low + (high - low) * (above / slope);
        let inside = step % 2 != 0 && chord > low && chord < high;
        let x = if inside { chord } else { 0.5 * (low + high) };
        // In a narrow bracket far from zero there may be no number between its ends.
        if !(x > low && x < high) {
            return (high, step - 1);
        }
        let value = function(x);
        if value > 0.0 {
            (low, above) = (x, value);
            below *= if side == 1 { 0.5 } else { 1.0 };
            side = 1;
        } else {
            (high, below) = (x, value);
            above *= if side == -1 { 0.5 } else { 1.0 };
            side = -1;
        }
        if high - low <= tolerance || value == 0.0 {
            return (high, step);
        }
    }
    (high, MAX_STEPS)
}
