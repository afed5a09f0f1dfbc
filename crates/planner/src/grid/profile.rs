//! The continuous profile: exact whole numbers at scan ends, scaled once (docs/planner.md, section 6).

use core::num::Wrapping;
use core::ops::{Add, Mul};

use super::GridPlan;
use crate::{Order, Setpoint};

/// Signs of the switching instants in the first half: + for a sum of an even number of boxes
/// (docs/planner.md, eq. 3). Orders 3 and 2 use the first four and two.
const SIGNS: [i64; 8] = [1, -1, -1, 1, -1, 1, 1, -1];

/// Which of two values holds at an instant where a derivative jumps.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Side {
    /// The one in force just before the instant.
    Before,
    /// The one in force just after it.
    After,
}

/// Largest magnitudes of the continuous plan; none where the order leaves a derivative unbounded.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Peaks {
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
    /// Jerk (u/s^3); none at order 2.
    pub jerk: Option<f64>,
    /// Snap (u/s^4); none at orders 3 and 2.
    pub snap: Option<f64>,
}

/// A stretch of constant snap (order 4), jerk (order 3) or acceleration (order 2): the state at its start,
/// just after any jump.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Length (scans), at least 1.
    pub scans: u32,
    /// Length (s).
    pub duration: f64,
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
    /// Jerk (u/s^3).
    pub jerk: f64,
    /// Snap held (u/s^4).
    pub snap: f64,
}

impl Segment {
    /// A stretch of so many scans from this state on.
    pub(super) const fn of(scans: i64, cycle: f64, state: &Setpoint) -> Self {
        Self {
            scans: scans as u32,
            duration: scans as f64 * cycle,
            velocity: state.velocity,
            acceleration: state.acceleration,
            jerk: state.jerk,
            snap: state.snap,
        }
    }
}

/// The segments of a plan in order, at most 15; made by [`GridPlan::segments`].
#[derive(Clone, Debug)]
pub struct Segments {
    plan: GridPlan,
    index: usize,
}

impl Iterator for Segments {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        let last = self.plan.instant_count().checked_sub(1)?;
        while self.index < last {
            let from = self.plan.instant(self.index);
            let to = self.plan.instant(self.index + 1);
            self.index += 1;
            if to > from {
                let state = self.plan.state(from, Side::After);
                return Some(Segment::of(to - from, self.plan.cycle, &state));
            }
        }
        None
    }
}

/// The part of a plan at constant velocity, in closed form (docs/planner.md, eq. 21a). Most scans of a
/// long move are in it.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Cruise {
    /// Distance from both ends beyond which the velocity is constant (scans): the sum of all boxes but
    /// the longest. If the velocity is never constant, or the sums need more than 64 bits, it is more
    /// than any plan has.
    after: u32,
    /// The growth of the position sum in half a scan: m!/2 times the product of all boxes but the
    /// longest.
    half_step: i64,
    /// Velocity (u/s).
    velocity: f64,
}

impl Cruise {
    /// A plan that never has constant velocity.
    pub const NONE: Self = Self {
        after: u32::MAX,
        half_step: 0,
        velocity: 0.0,
    };

    /// The cruise of a plan with these boxes and factors, whose sums fit 64 bits.
    pub fn new(order: Order, boxes: [u32; 4], scale: &[f64; 5]) -> Self {
        let [a, b, c, _] = boxes;
        let [p, q, r] = [a, b, c].map(i64::from);
        let (after, half_step, velocity) = match order {
            Order::Four => (a + b + c, 12 * (p * q * r), 6 * (p * q * r)),
            Order::Three => (a + b, 3 * (p * q), 2 * (p * q)),
            Order::Two => (a, p, p),
        };
        let [_, f1, ..] = *scale;
        Self {
            after,
            half_step,
            // Adding 0 turns -0 into 0.
            velocity: velocity as f64 * f1 + 0.0,
        }
    }
}

/// The factors of the derivatives, and whether the position sums need more than 64 bits
/// (docs/planner.md, eq. 25).
pub(super) fn scale(order: Order, product: u128, distance: f64, cycle: f64) -> ([f64; 5], bool) {
    // A conversion of 128 bits is slow and rarely needed.
    let p = match u64::try_from(product) {
        Ok(product) => product as f64,
        Err(_) => product as f64,
    };
    let (t2, p_t) = (cycle * cycle, p * cycle);
    let (p_t2, p_t3, p_t4) = (p * t2, p_t * t2, p * (t2 * t2));
    // The largest position sum asked for is half of m! P.
    let (scale, half_factorial) = match order {
        Order::Four => (
            [
                distance / (24.0 * p),
                distance / (6.0 * p_t),
                distance / (2.0 * p_t2),
                distance / p_t3,
                distance / p_t4,
            ],
            12,
        ),
        Order::Three => (
            [
                distance / (6.0 * p),
                distance / (2.0 * p_t),
                distance / p_t2,
                distance / p_t3,
                0.0,
            ],
            3,
        ),
        Order::Two => (
            [distance / (2.0 * p), distance / p_t, distance / p_t2, 0.0, 0.0],
            1,
        ),
    };
    (scale, half_factorial * product > i64::MAX as u128)
}

impl GridPlan {
    /// The continuous profile at `scan` cycles after the start, in O(1): at most eight terms.
    ///
    /// From [`GridPlan::scans`] on the profile is at rest on the target, to the bit. Only at order 4 the snap of
    /// the last segment shows at the last scan itself. The position is always between start and target and never
    /// steps back.
    #[inline(always)]
    pub fn at(&self, scan: u64) -> Setpoint {
        let scans = u64::from(self.scans);
        if scan < scans {
            let left = scans - scan;
            let near = scan.min(left);
            return if near > u64::from(self.cruise.after) {
                self.cruise_at(near as i64, near < scan)
            } else {
                self.state(scan as i64, Side::Before)
            };
        }
        let mut end = Setpoint::at_rest(self.target);
        if scan == scans {
            end.snap = 0.0 - self.scale[4];
        }
        end
    }

    /// The segments from start to end; none of zero length.
    pub fn segments(&self) -> Segments {
        Segments {
            plan: *self,
            index: 0,
        }
    }

    /// Largest magnitudes of the continuous plan (docs/planner.md, eq. 6 and 22).
    pub fn peaks(&self) -> Peaks {
        let [a, b, c, d] = self.boxes.map(i128::from);
        let [_, f1, f2, f3, f4] = self.scale.map(f64::abs);
        match self.order {
            Order::Four => {
                // The part of the velocity pulse that the overlap cuts off at both of its ends.
                let overlap = (a + b + c - d).max(0);
                let velocity = 24 * a * b * c - overlap * overlap * overlap;
                Peaks {
                    velocity: 0.25 * f1 * velocity as f64,
                    acceleration: f2 * (2 * a * b) as f64,
                    jerk: Some(f3 * a as f64),
                    snap: Some(f4),
                }
            }
            Order::Three => Peaks {
                velocity: f1 * (2 * a * b) as f64,
                acceleration: f2 * a as f64,
                jerk: Some(f3),
                snap: None,
            },
            Order::Two => Peaks {
                velocity: f1 * a as f64,
                acceleration: f2,
                jerk: None,
                snap: None,
            },
        }
    }

    /// The number of switching instants: two to the power of the order.
    fn instant_count(&self) -> usize {
        if self.scans == 0 {
            0
        } else {
            1 << self.order.degree()
        }
    }

    /// The switching instant `index` in ascending order, in scans from the start (docs/planner.md, eq. 3).
    fn instant(&self, index: usize) -> i64 {
        let count = self.instant_count();
        let instants = self.early_instants();
        if index < count / 2 {
            instants.get(index).copied().unwrap_or(0)
        } else {
            let mirrored = count.saturating_sub(index + 1);
            i64::from(self.scans) - instants.get(mirrored).copied().unwrap_or(0)
        }
    }

    /// The switching instants of the first half in ascending order; the first four are those of order 3, the
    /// first two those of order 2 (docs/planner.md, eq. 20).
    #[inline]
    fn early_instants(&self) -> [i64; 8] {
        let [a, b, c, d] = self.boxes.map(i64::from);
        [0, a, b, a + b, c, a + c, b + c, (a + b + c).min(d)]
    }

    /// The state at constant velocity, `near` scans from the start or, mirrored, from the end (docs/planner.md,
    /// eq. 21a).
    #[inline(always)]
    fn cruise_at(&self, near: i64, mirrored: bool) -> Setpoint {
        let [f0, ..] = self.scale;
        let way = (self.cruise.half_step * (2 * near - i64::from(self.cruise.after))) as f64 * f0;
        Setpoint {
            position: if mirrored {
                self.target - way
            } else {
                self.start + way
            },
            velocity: self.cruise.velocity,
            ..Setpoint::default()
        }
    }

    /// The state at `scan` <= N, with the values of one side where a derivative jumps.
    #[inline]
    fn state(&self, scan: i64, side: Side) -> Setpoint {
        Setpoint::of(self.numbers(scan, side))
    }

    /// The same as [`Setpoint::numbers`].
    #[inline(never)]
    fn numbers(&self, scan: i64, side: Side) -> [f64; 5] {
        // Each half is computed from its own end: half the terms, and exact at both ends.
        let twice_left = 2 * scan - i64::from(self.scans);
        let mirrored = match side {
            Side::Before => twice_left > 0,
            Side::After => twice_left >= 0,
        };
        let near = if mirrored {
            i64::from(self.scans) - scan
        } else {
            scan
        };
        // Time runs backwards from the far end, so the sides swap there.
        let through = near + i64::from((side == Side::After) != mirrored);
        let sums = sums(self.order, self.wide, &self.early_instants(), near, through);
        let state = if mirrored {
            backwards(self.target, &sums, &self.scale)
        } else {
            forwards(self.start, &sums, &self.scale)
        };
        state.numbers()
    }
}

/// The derivatives 0 to 4 of a profile of `order` at `near` scans from an end, before scaling, in as many bits
/// as they need; the highest one counts the instants before `through` (docs/planner.md, eq. 21).
#[inline(always)]
pub(super) fn sums(order: Order, wide: bool, instants: &[i64; 8], near: i64, through: i64) -> [f64; 5] {
    match (order, wide) {
        (Order::Four, false) => derivatives::<i64, 8>(instants, near, through),
        (Order::Four, true) => derivatives::<i128, 8>(instants, near, through),
        (Order::Three, false) => derivatives::<i64, 4>(instants, near, through),
        (Order::Three, true) => derivatives::<i128, 4>(instants, near, through),
        // Two boxes of less than 2^31 scans in all: the sums always fit 64 bits.
        (Order::Two, _) => derivatives::<i64, 2>(instants, near, through),
    }
}

/// The state with these sums counted from rest at `start`. Adding 0 turns -0 into 0.
#[inline(always)]
pub(super) fn forwards(start: f64, sums: &[f64; 5], scale: &[f64; 5]) -> Setpoint {
    let ([d0, d1, d2, d3, d4], [f0, f1, f2, f3, f4]) = (sums, scale);
    Setpoint {
        position: start + d0 * f0,
        velocity: d1 * f1 + 0.0,
        acceleration: d2 * f2 + 0.0,
        jerk: d3 * f3 + 0.0,
        snap: d4 * f4 + 0.0,
    }
}

/// The state with these sums counted backwards from rest at `target`.
#[inline(always)]
pub(super) fn backwards(target: f64, sums: &[f64; 5], scale: &[f64; 5]) -> Setpoint {
    let ([d0, d1, d2, d3, d4], [f0, f1, f2, f3, f4]) = (sums, scale);
    Setpoint {
        position: target - d0 * f0,
        velocity: d1 * f1 + 0.0,
        acceleration: 0.0 - d2 * f2,
        jerk: d3 * f3 + 0.0,
        snap: 0.0 - d4 * f4,
    }
}

/// The whole numbers in which the sums are computed, with wrapping arithmetic: partial sums may overflow, but the
/// result is right if it fits.
trait Whole: Copy {
    /// The number as a wrapping one.
    fn of(value: i64) -> Self;
    /// The nearest `f64`.
    fn to_f64(self) -> f64;
}

impl Whole for Wrapping<i64> {
    #[inline]
    fn of(value: i64) -> Self {
        Self(value)
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.0 as f64
    }
}

impl Whole for Wrapping<i128> {
    #[inline]
    fn of(value: i64) -> Self {
        Self(i128::from(value))
    }
    #[inline]
    fn to_f64(self) -> f64 {
        self.0 as f64
    }
}

/// The derivatives 0 to 4 of the profile of order log2(2 M) at `near` scans from an end, before scaling:
/// sums of signed powers over the instants passed (docs/planner.md, eq. 21).
///
/// The highest derivative counts the instants before `through`.
#[inline(always)]
fn derivatives<T, const M: usize>(instants: &[i64; 8], near: i64, through: i64) -> [f64; 5]
where
    Wrapping<T>: Whole + Add<Output = Wrapping<T>> + Mul<Output = Wrapping<T>>,
{
    let mut sums = [Wrapping::<T>::of(0); 5];
    for (instant, sign) in instants.iter().zip(SIGNS).take(M) {
        // They ascend, so the rest has not been passed either.
        if *instant >= through {
            break;
        }
        let [s0, s1, s2, s3, s4] = sums;
        let since = Wrapping::<T>::of(near - instant);
        let p0 = Wrapping::<T>::of(sign);
        let p1 = p0 * since;
        let p2 = p1 * since;
        let p3 = p2 * since;
        let p4 = p3 * since;
        sums = [s0 + p0, s1 + p1, s2 + p2, s3 + p3, s4 + p4];
    }
    let [s0, s1, s2, s3, s4] = sums.map(Whole::to_f64);
    match M {
        8 => [s4, s3, s2, s1, s0],
        4 => [s3, s2, s1, s0, 0.0],
        _ => [s2, s1, s0, 0.0, 0.0],
    }
}

#[cfg(test)]
mod tests {
    use super::Cruise;
    use crate::{GridPlan, Limits, Method};

    /// Sums in 64 and in 128 bits, and the closed form at constant velocity, give the same bits.
    #[test]
    fn wide_and_narrow_sums_agree() {
        let bounds = Limits {
            velocity: 1.2,
            acceleration: 15.0,
            deceleration: 15.0,
            jerk: 400.0,
            snap: 21000.0,
        };
        let third = Limits {
            snap: f64::INFINITY,
            ..bounds
        };
        for limits in [bounds, third] {
            for distance in [1e-6, 0.003, 0.35, -0.35, 40.0] {
                let narrow =
                    GridPlan::new(Method::Overlapped, 1.0, 1.0 + distance, &limits, 1e-3).expect("valid");
                assert!(!narrow.wide);
                let mut wide = narrow;
                wide.wide = true;
                wide.cruise = Cruise::NONE;
                for scan in 0..=u64::from(narrow.scans()) {
                    assert_eq!(narrow.at(scan), wide.at(scan));
                }
            }
        }
    }

    /// Just below and just above the border of 64 bits the profile is as exact as elsewhere.
    #[test]
    fn the_border_of_64_bits_is_where_half_the_position_sum_stops_fitting() {
        let of = |snap: f64| {
            let limits = Limits { snap, ..Limits::NONE };
            GridPlan::new(Method::Sequential, 0.0, 1.0, &limits, 1.0).expect("valid")
        };
        // K1 is 1 / snap, and P just above it.
        let border = 12.0 / 9_223_372_036_854_775_808.0;
        assert!(!of(border * 1.01).wide);
        assert!(of(border * 0.99).wide);
        for plan in [of(border * 1.01), of(border * 0.99)] {
            let half = u64::from(plan.scans()) / 2;
            assert_eq!(plan.scans() % 2, 0);
            assert_eq!(plan.at(half).position, 0.5);
            let (before, after) = (plan.at(half - 1), plan.at(half + 1));
            assert!((before.position + after.position - 1.0).abs() <= f64::EPSILON);
            assert_eq!(before.velocity, after.velocity);
        }
    }
}
