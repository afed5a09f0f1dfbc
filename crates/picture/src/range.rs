//! The places of values and scans in a picture, and curves with as few points as possible.

use std::fmt::Write;

use crate::panels::Curve;

/// A point this near to the line between its neighbours is left out.
const NEAR: f64 = 0.1;

/// About the number of ticks on the time axis.
const TICKS: f64 = 8.0;

/// The range of a curve: its values, with some room around them.
pub struct Range {
    pub least: f64,
    pub greatest: f64,
    low: f64,
    high: f64,
}

impl Range {
    pub fn of(least: f64, greatest: f64) -> Self {
        // Halved first, so that no difference of finite numbers overflows.
        let room = match 0.15 * (0.5 * greatest - 0.5 * least) {
            0.0 => 1.0_f64.max(0.5 * greatest.abs()),
            room => room,
        };
        Self {
            least,
            greatest,
            low: least - room,
            high: greatest + room,
        }
    }

    pub fn has(&self, value: f64) -> bool {
        (self.low..=self.high).contains(&value)
    }

    /// 0 at the bottom, 1 at the top.
    pub fn part(&self, value: f64) -> f64 {
        (0.5 * value - 0.5 * self.low) / (0.5 * self.high - 0.5 * self.low)
    }
}

/// The limits of the curve.
pub fn limits(curve: &Curve<'_>) -> Vec<f64> {
    let limits = &curve.axis.limits;
    let both = |bound: Option<f64>| bound.into_iter().flat_map(|bound| [-bound, bound]).collect();
    match curve.signal {
        "Position" | "ActualPosition" => [limits.position_min, limits.position_max]
            .into_iter()
            .flatten()
            .collect(),
        "Velocity" => both(limits.velocity),
        "Acceleration" => both(limits.acceleration),
        "Jerk" => both(limits.jerk),
        "Snap" => both(limits.snap),
        _ => Vec::new(),
    }
}

/// Scans at round numbers.
pub fn ticks(scans: usize) -> Vec<usize> {
    let step = (0..)
        .map_while(|exponent| 10_usize.checked_pow(exponent))
        .flat_map(|ten| [1, 2, 5].map(|factor| ten.saturating_mul(factor)))
        .find(|step| *step as f64 * TICKS >= scans as f64)
        .unwrap_or(usize::MAX);
    (0..=scans).step_by(step).collect()
}

/// A line through the points, without those that a reader cannot distinguish from the line between the
/// others.
pub fn path(points: &[[f64; 2]]) -> String {
    let mut text = String::new();
    let mut points = points.iter().copied();
    let Some(mut from) = points.next() else {
        return text;
    };
    let _ = write!(text, "M{:.1} {:.1}", from[0], from[1]);
    let (mut last, mut slopes) = (from, f64::NEG_INFINITY..=f64::INFINITY);
    for [x, y] in points {
        let slope = |y: f64, from: [f64; 2]| (y - from[1]) / (x - from[0]);
        if !slopes.contains(&slope(y, from)) {
            let _ = write!(text, "L{:.1} {:.1}", last[0], last[1]);
            from = last;
            slopes = f64::NEG_INFINITY..=f64::INFINITY;
        }
        let (low, high) = (slope(y - NEAR, from), slope(y + NEAR, from));
        slopes = slopes.start().max(low)..=slopes.end().min(high);
        last = [x, y];
    }
    if last != from {
        let _ = write!(text, "L{:.1} {:.1}", last[0], last[1]);
    }
    text
}
