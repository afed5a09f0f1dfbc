//! One stretch of a profile: the polynomial of degree 7 that meets two nodes with three derivatives each.

use super::Node;
use crate::Setpoint;

/// The first three derivatives of a curve at an end.
pub(crate) type Slopes = [f64; 3];

/// A stretch as its control points. A curve stays between the smallest and the largest of them, and so
/// does each derivative between its own.
#[derive(Clone, Copy, Debug)]
pub struct Curve {
    /// Duration (s).
    pub time: f64,
    /// Position at its begin (u).
    pub from: f64,
    /// Control points of the position, counted from there (u).
    pub points: [f64; 8],
}

impl Curve {
    /// From one node to the next.
    pub(super) fn between(from: &Node, to: &Node) -> Self {
        let slopes = |node: &Node| [node.velocity, node.acceleration, node.jerk];
        let way = to.position - from.position;
        Self {
            from: from.position,
            ..Self::meeting(to.time - from.time, way, slopes(from), slopes(to))
        }
    }

    /// The stretch over `time` (s) by `end` (u), with these derivatives at its begin and at its end.
    pub(crate) fn meeting(time: f64, end: f64, from: Slopes, to: Slopes) -> Self {
        let scaled = |[velocity, acceleration, jerk]: Slopes| {
            let velocity = velocity * time / 7.0;
            let acceleration = acceleration * time * time / 42.0;
            let jerk = jerk * time * time * time / 210.0;
            (velocity, acceleration, jerk)
        };
        let (v0, a0, j0) = scaled(from);
        let (v1, a1, j1) = scaled(to);
        Self {
            time,
            from: 0.0,
            points: [
                0.0,
                v0,
                2.0 * v0 + a0,
                3.0 * v0 + 3.0 * a0 + j0,
                end - 3.0 * v1 + 3.0 * a1 - j1,
                end - 2.0 * v1 + a1,
                end - v1,
                end,
            ],
        }
    }

    /// The state `time` (s) after its begin, the position counted from the same place as that of its nodes.
    pub fn at(&self, time: f64) -> Setpoint {
        let way = self.way_at(time);
        Setpoint {
            position: self.from + way.position,
            ..way
        }
    }

    /// The same, with the position counted from its begin.
    pub(crate) fn way_at(&self, time: f64) -> Setpoint {
        let (_, state) = self.cut(time / self.time);
        Setpoint::of(state)
    }

    /// The rest of it `time` (s) after its begin.
    pub fn after(&self, time: f64) -> Self {
        let (after, [begin, ..]) = self.cut(time / self.time);
        Self {
            time: self.time - time,
            from: self.from + begin,
            points: after.map(|point| point - begin),
        }
    }

    /// The control points of its part after the share `share` of its time, and position and derivatives there, by de
    /// Casteljau's scheme.
    fn cut(&self, share: f64) -> ([f64; 8], [f64; 5]) {
        let mut row = self.points;
        let mut after = [0.0; 8];
        let mut differences = [0.0; 5];
        for (level, last) in after.iter_mut().rev().enumerate() {
            let left = 8 - level;
            *last = row.get(left - 1).copied().unwrap_or_default();
            // With n + 1 points left their nth difference is the nth derivative.
            if let Some(slot) = left.checked_sub(1).and_then(|order| differences.get_mut(order)) {
                *slot = difference(row, left - 1);
            }
            row = lerped(row, share);
        }
        let [position, first, second, third, fourth] = differences;
        let per = 1.0 / self.time;
        let state = [
            position,
            7.0 * first * per,
            42.0 * second * per * per,
            210.0 * third * per * per * per,
            840.0 * fourth * per * per * per * per,
        ];
        (after, state)
    }

    /// Control points of the derivatives: velocity, acceleration, jerk, snap.
    pub fn derivatives(&self) -> ([f64; 7], [f64; 6], [f64; 5], [f64; 4]) {
        let per = 1.0 / self.time;
        let velocity = differences::<8, 7>(&self.points, 7.0 * per);
        let acceleration = differences::<7, 6>(&velocity, 6.0 * per);
        let jerk = differences::<6, 5>(&acceleration, 5.0 * per);
        let snap = differences::<5, 4>(&jerk, 4.0 * per);
        (velocity, acceleration, jerk, snap)
    }
}

/// Between each point and the next, at the share `share`; the last one is not used.
fn lerped(row: [f64; 8], share: f64) -> [f64; 8] {
    let [a, b, c, d, e, f, g, h] = row;
    let lerp = |from: f64, to: f64| from + share * (to - from);
    [
        lerp(a, b),
        lerp(b, c),
        lerp(c, d),
        lerp(d, e),
        lerp(e, f),
        lerp(f, g),
        lerp(g, h),
        h,
    ]
}

/// The difference of order `order`, at most 4, of the first points of `row`.
fn difference(row: [f64; 8], order: usize) -> f64 {
    let [a, b, c, d, e, ..] = row;
    match order {
        0 => a,
        1 => b - a,
        2 => (c - b) - (b - a),
        3 => ((d - c) - (c - b)) - ((c - b) - (b - a)),
        _ => {
            let (first, second, third, fourth) = (b - a, c - b, d - c, e - d);
            ((fourth - third) - (third - second)) - ((third - second) - (second - first))
        }
    }
}

fn differences<const N: usize, const M: usize>(points: &[f64; N], factor: f64) -> [f64; M] {
    let mut result = [0.0; M];
    let pairs = points.iter().zip(points.iter().skip(1));
    for (slot, (from, to)) in result.iter_mut().zip(pairs) {
        *slot = (to - from) * factor;
    }
    result
}
