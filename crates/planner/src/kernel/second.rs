//! Second order: `(v, a)` to `(target, 0)` in least time.

use super::{NOISE, Sides, Span, Spans, raised_to};
use crate::math::{max, sqrt};

/// The least-time spans from `(v, a)` to `(target, 0)` with the bounds `rate` on `a` and 1 on its
/// derivative (R2, R3).
///
/// An `a` outside its bounds is brought inside first, at full input. Closed form; one square root.
pub fn second(v: f64, a: f64, target: f64, rate: Sides) -> Spans<3> {
    let mut spans = Spans::new();
    spans.towards(1.0).extend(&second_in_three(v, a, target, rate));
    spans
}

/// The same as [`second`], always as three spans, of which some may have no length: a list would go through memory.
#[inline]
pub(crate) fn second_in_three(v: f64, a: f64, target: f64, rate: Sides) -> [Span; 3] {
    let change = target - v;
    // The change of `v` while `a` is brought to zero as fast as the input allows.
    let arrest = 0.5 * a * a.abs();
    let gap = change - arrest;
    if gap.abs() <= NOISE * (v.abs() + target.abs() + arrest.abs()) {
        let input = if a > 0.0 { -1.0 } else { 1.0 };
        [(a.abs(), input), (0.0, 0.0), (0.0, 0.0)].map(|(duration, input)| Span { duration, input })
    } else if gap > 0.0 {
        rise(1.0, change, a, rate.plus)
    } else {
        rise(-1.0, -change, -a, rate.minus)
    }
}

/// The case `change >= a|a|/2`: up to a peak of `a`, at most `bound`, perhaps hold it, down to zero. The problem is
/// mirrored if `side` is -1.
#[inline]
fn rise(side: f64, change: f64, a: f64, bound: f64) -> [Span; 3] {
    let top = raised_to(a, bound);
    let peak_squared = change + 0.5 * a * a;
    let (first, input, hold, last) = if a > top {
        (a - top, -1.0, (change - 0.5 * a * a) / top, top)
    } else if peak_squared > top * top {
        (top - a, 1.0, (peak_squared - top * top) / top, top)
    } else {
        // Rounding may leave the peak an ulp below the start.
        let peak = max(sqrt(max(peak_squared, 0.0)), a);
        (peak - a, 1.0, 0.0, peak)
    };
    [(first, input), (hold, 0.0), (last, -1.0)].map(|(duration, input)| Span {
        duration,
        input: side * input,
    })
}
