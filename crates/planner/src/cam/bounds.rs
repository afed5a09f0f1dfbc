//! The bounds of the derivatives of a cam, and the motion of the master that they permit.

use super::{Cam, CamPiece};
use crate::math::{cbrt, floor, sqrt};
use crate::profile::check::{cut, halved, hull};
use crate::profile::curve::Slopes;
use crate::{Limits, Setpoint};

/// Number of halvings of a piece in the search for its bounds.
const DEPTH: usize = 6;

/// Largest number of parts of a piece that are examined for one of its derivatives.
const PARTS: u32 = 2 << DEPTH;

/// A bound may exceed the largest value by this factor.
const CLOSE: f64 = 1.01;

/// Rounding of a bound, relative to it.
const ROUNDING: f64 = 1e-9;

/// Largest number of pieces of a cam whose parts are examined one by one.
const PASSED: usize = 4;

/// Largest number of halvings of the limits of a shadow.
const HALVINGS: u32 = 40;

/// Bounds of the first four derivatives of a cam, each at most one per cent above its largest magnitude.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct CamBounds {
    /// Slope (y/u).
    pub first: f64,
    /// Curvature (y/u^2).
    pub second: f64,
    /// Third derivative (y/u^3).
    pub third: f64,
    /// Fourth derivative (y/u^4).
    pub fourth: f64,
}

/// Parts that are left to examine, and the number of halvings of each.
struct Parts<const N: usize> {
    waiting: [([f64; N], usize); DEPTH + 2],
    count: usize,
}

impl<const N: usize> Parts<N> {
    fn push(&mut self, part: [f64; N], depth: usize) {
        if let Some(slot) = self.waiting.get_mut(self.count) {
            *slot = (part, depth);
            self.count += 1;
        }
    }

    fn pop(&mut self) -> Option<([f64; N], usize)> {
        self.count = self.count.checked_sub(1)?;
        self.waiting.get(self.count).copied()
    }
}

/// The largest of values above 0.
fn larger(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The largest magnitude of a curve with these control points, or up to one per cent more. A part whose
/// control points are close enough to a value of the curve is not halved. Cost: at most [`PARTS`] parts;
/// about ten for a smooth piece.
fn bound<const N: usize>(points: [f64; N]) -> f64 {
    let mut parts = Parts {
        waiting: [([0.0; N], 0); DEPTH + 2],
        count: 0,
    };
    parts.push(points, 0);
    let (mut least, mut most) = (0.0_f64, 0.0_f64);
    for _ in 0..PARTS {
        let Some((part, depth)) = parts.pop() else { break };
        let (low, high) = hull(&part);
        let ends = [part.first(), part.last()];
        for end in ends.into_iter().flatten() {
            least = larger(least, end.abs());
        }
        let outer = larger(-low, high);
        if outer <= CLOSE * least || depth >= DEPTH {
            most = larger(most, outer);
        } else {
            let (before, after) = halved(part);
            parts.push(after, depth + 1);
            parts.push(before, depth + 1);
        }
    }
    larger(most, least)
}

impl CamPiece {
    /// The bounds of its derivatives, from its control points.
    pub(super) fn bounded(&self) -> CamBounds {
        let (first, second, third, fourth) = self.curve().derivatives();
        CamBounds {
            first: bound(first),
            second: bound(second),
            third: bound(third),
            fourth: bound(fourth),
        }
    }

    /// The lowest and the highest position of the slave in it, by control points of its eighths.
    pub(super) fn range(&self) -> (f64, f64) {
        let (mut low, mut high) = (0.0_f64, 0.0_f64);
        let both = |points: [f64; 8]| {
            let (before, after) = halved(points);
            [before, after]
        };
        for half in both(self.points) {
            for quarter in both(half) {
                for eighth in both(quarter) {
                    let (least, most) = hull(&eighth);
                    low = if least < low { least } else { low };
                    high = larger(high, most);
                }
            }
        }
        (self.from + low, self.from + high)
    }
}

/// The control points of the part of a curve between two shares of it.
fn part<const N: usize>(points: [f64; N], (from, to): (f64, f64)) -> [f64; N] {
    let cut = |points, share: f64| cut(points, |left, right| left + share * (right - left));
    let points = if to < 1.0 { cut(points, to).0 } else { points };
    if from > 0.0 {
        cut(points, from / to).1
    } else {
        points
    }
}

impl CamPiece {
    /// The bounds of its derivatives between two shares of it, from the control points of that part.
    fn bounded_between(&self, shares: (f64, f64)) -> CamBounds {
        fn most<const N: usize>(points: [f64; N], shares: (f64, f64)) -> f64 {
            let (low, high) = hull(&part(points, shares));
            larger(-low, high)
        }
        let (first, second, third, fourth) = self.curve().derivatives();
        CamBounds {
            first: most(first, shares).min(self.bounds.first),
            second: most(second, shares).min(self.bounds.second),
            third: most(third, shares).min(self.bounds.third),
            fourth: most(fourth, shares).min(self.bounds.fourth),
        }
    }
}

impl Cam<'_> {
    /// The bounds of its derivatives from `low` to `high`, neither reduced to one period.
    pub(super) fn bounds_between(&self, low: f64, high: f64) -> CamBounds {
        let head = self.head;
        let length = head.end - head.begin;
        if !head.periodic {
            return self.bounds_within(low.max(head.begin), high.min(head.end));
        }
        let periods = {
            let periods = (low - head.begin) / length;
            let whole = floor(periods.abs());
            if periods < 0.0 { -whole - 1.0 } else { whole }
        };
        let (low, high) = (low - periods * length, high - periods * length);
        if !(high - low < length) {
            return head.bounds;
        }
        if high <= head.end {
            return self.bounds_within(low, high);
        }
        let rest = self.bounds_within(head.begin, high - length);
        self.bounds_within(low, head.end).or_larger(&rest)
    }

    /// The same inside one period; zero if `high` is below `low`.
    fn bounds_within(&self, low: f64, high: f64) -> CamBounds {
        if !(low <= high) {
            return CamBounds::default();
        }
        let (from, to) = (self.find(low, 0), self.find(high, 0));
        let count = usize::from(to.saturating_sub(from)) + 1;
        if count > PASSED {
            return self.head.bounds;
        }
        let passed = self.pieces.iter().skip(usize::from(from)).take(count);
        passed.fold(CamBounds::default(), |bounds, piece| {
            let share = |place: f64| ((place - piece.begin) / piece.width).clamp(0.0, 1.0);
            let shares = (share(low), share(high));
            let own = if shares == (0.0, 1.0) {
                piece.bounds
            } else if shares.1 > 0.0 {
                piece.bounded_between(shares)
            } else {
                piece.bounded_between((0.0, f64::MIN_POSITIVE))
            };
            bounds.or_larger(&own)
        })
    }
}

/// The chain rule: the motion behind `master` on a curve with these derivatives; its position is 0.
#[inline]
pub(super) fn behind([first, second, third, fourth]: [f64; 4], master: &Setpoint) -> Setpoint {
    let Setpoint {
        velocity: v,
        acceleration: a,
        jerk: j,
        snap: s,
        ..
    } = *master;
    Setpoint {
        position: 0.0,
        velocity: first * v,
        acceleration: second * v * v + first * a,
        jerk: third * v * v * v + 3.0 * second * v * a + first * j,
        snap: fourth * v * v * v * v
            + 6.0 * third * v * v * a
            + second * (3.0 * a * a + 4.0 * v * j)
            + first * s,
    }
}

impl CamBounds {
    /// The larger one of each pair.
    #[must_use]
    pub fn or_larger(&self, other: &Self) -> Self {
        Self {
            first: larger(self.first, other.first),
            second: larger(self.second, other.second),
            third: larger(self.third, other.third),
            fourth: larger(self.fourth, other.fourth),
        }
    }

    /// The bounds behind scalings: lengths of the slave times `slave`, those of the master times
    /// `master`, neither 0.
    #[must_use]
    pub fn scaled(&self, master: f64, slave: f64) -> Self {
        let (per, by) = (1.0 / master.abs(), slave.abs());
        Self {
            first: self.first * by * per,
            second: self.second * by * per * per,
            third: self.third * by * per * per * per,
            fourth: self.fourth * by * per * per * per * per,
        }
    }

    /// The highest constant velocity of a master (u/s) at which the slave keeps `limits`; infinite for a cam that
    /// does not move the slave.
    pub fn highest_velocity(&self, limits: &Limits) -> f64 {
        // Infinite if the derivative is 0, as intended. 0 by 0 does not occur, because no limit is 0.
        let [by_velocity, by_acceleration, by_jerk, by_snap] = [
            limits.velocity / self.first,
            sqrt(limits.lower_acceleration() / self.second),
            root_of_third(limits.jerk / self.third),
            sqrt(sqrt(limits.snap / self.fourth)),
        ];
        by_velocity.min(by_acceleration).min(by_jerk).min(by_snap)
    }

    /// The bounds of the first three derivatives.
    pub(super) const fn of_slopes(&self) -> Slopes {
        [self.first, self.second, self.third]
    }

    /// Whether the slave is at rest for any motion of its master.
    pub fn is_level(&self) -> bool {
        self.first == 0.0
    }

    /// The largest motion of the slave if the derivatives of its master are at most those of `master`
    /// (its position is not used).
    pub fn most(&self, master: &Setpoint) -> Setpoint {
        let master = Setpoint::of(master.numbers().map(f64::abs));
        behind([self.first, self.second, self.third, self.fourth], &master)
    }

    /// Limits of the slave's own virtual master, behind which the slave keeps `limits` anywhere on the cam. The
    /// velocity is `wanted` (u/s), or 0.98 of the highest velocity if that is less. The other three are the rest of
    /// the limits while the velocity is at most that at `present` (u/s).
    ///
    /// `None` if nothing is left: at rest with nothing wanted, or already at the highest velocity. Cost: at most
    /// 120 halvings.
    pub fn shadow(&self, limits: &Limits, wanted: f64, present: f64) -> Option<Limits> {
        let most = self.highest_velocity(limits);
        let velocity = (0.98 * most).min(wanted);
        let v = larger(velocity, present.abs());
        let room = |limit: f64, used: f64| {
            if limit == f64::INFINITY {
                f64::INFINITY
            } else {
                (limit - used) / self.first
            }
        };
        let rate = limits.lower_acceleration();
        let mut acceleration = room(rate, self.second * v * v);
        // At order 2 the jerk has no limit; at order 3 the snap.
        let mut jerk = f64::INFINITY;
        if limits.jerk.is_finite() {
            let mut is_found = false;
            for _ in 0..HALVINGS {
                let used = self.third * v * v * v + 3.0 * self.second * v * acceleration;
                jerk = room(limits.jerk, used);
                is_found = jerk > 0.0;
                if is_found {
                    break;
                }
                acceleration *= 0.5;
            }
            if !is_found {
                return None;
            }
        }
        let mut snap = f64::INFINITY;
        if limits.snap.is_finite() {
            let used = |a: f64, jerk: f64| {
                self.fourth * v * v * v * v
                    + 6.0 * self.third * v * v * a
                    + self.second * (3.0 * a * a + 4.0 * v * jerk)
            };
            // The part for the acceleration alone does not shrink with the jerk. So half of what the velocity
            // leaves is for that part and the snap.
            let half = 0.5 * (limits.snap + used(0.0, 0.0));
            for _ in 0..HALVINGS {
                if used(acceleration, 0.0) <= half {
                    break;
                }
                acceleration *= 0.5;
            }
            let mut is_found = false;
            for _ in 0..HALVINGS {
                snap = room(limits.snap, used(acceleration, jerk));
                is_found = snap > 0.0;
                if is_found {
                    break;
                }
                jerk *= 0.5;
            }
            if !is_found {
                return None;
            }
        }
        let found = Limits {
            velocity,
            acceleration,
            deceleration: acceleration,
            jerk,
            snap,
        };
        let all = [velocity, acceleration, jerk, snap];
        all.into_iter()
            .all(|limit| limit > 0.0 && !limit.is_nan())
            .then_some(found)
    }

    /// The first of `most` that is beyond `limits`: its name, its value and the limit.
    pub fn beyond(most: &Setpoint, limits: &Limits) -> Option<(&'static str, f64, f64)> {
        let told = [
            ("velocity", most.velocity, limits.velocity),
            ("acceleration", most.acceleration, limits.lower_acceleration()),
            ("jerk", most.jerk, limits.jerk),
            ("snap", most.snap, limits.snap),
        ];
        told.into_iter()
            .find(|(_, value, limit)| !(*value <= limit * (1.0 + ROUNDING)))
    }
}

/// The cube root of a number that may be infinite.
fn root_of_third(x: f64) -> f64 {
    if x.is_finite() { cbrt(x) } else { x }
}
