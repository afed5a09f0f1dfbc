//! Second order: `(v, a)` to `(target, 0)` in least time.

use super::{NOISE, Sides, Spans, raised_to};
use crate::math::{max, sqrt};

/// The least-time spans from `(v, a)` to `(target, 0)` with the bounds `rate` on `a` and 1 on its
/// derivative (R2, R3).
///
/// An `a` outside its bounds is brought inside first, at full input. Closed form; one square root.
pub fn second(v: f64, a: f64, target: f64, rate: Sides) -> Spans<3> {
    let change = target - v;
    // The change of `v` while `a` is brought to zero as fast as the input allows.
    let arrest = 0.5 * a * a.abs();
    let gap = change - arrest;
    let mut spans = Spans::new();
    if gap.abs() <= NOISE * (v.abs() + target.abs() + arrest.abs()) {
        spans.push(a.abs(), if a > 0.0 { -1.0 } else { 1.0 });
    } else if gap > 0.0 {
        rise(&mut spans, change, a, rate.plus);
    } else {
        rise(&mut spans, -change, -a, rate.minus);
        spans.mirror();
    }
    spans
}

/// The case `change >= a|a|/2`: up to a peak of `a`, at most `bound`, perhaps hold it, down to zero.
fn rise(spans: &mut Spans<3>, change: f64, a: f64, bound: f64) {
    let top = raised_to(a, bound);
    let peak_squared = change + 0.5 * a * a;
    if a > top {
        spans.push(a - top, -1.0);
        spans.push((change - 0.5 * a * a) / top, 0.0);
        spans.push(top, -1.0);
    } else if peak_squared > top * top {
        spans.push(top - a, 1.0);
        spans.push((peak_squared - top * top) / top, 0.0);
        spans.push(top, -1.0);
    } else {
        // Rounding may leave the peak an ulp below the start.
        let peak = max(sqrt(max(peak_squared, 0.0)), a);
        spans.push(peak - a, 1.0);
        spans.push(peak, -1.0);
    }
}
