//! The shortest ramps between rest and a given velocity: three boxes of the least sum
//! (docs/planner.md, section 12).

use super::super::problem::{ratios, threshold};
use crate::math::{self, max, sqrt};
use crate::{Limits, Order};

/// Largest number of rows (values of n1) that the ramps of one search may visit together before it returns the best
/// found.
pub const MAX_RAMP_ROWS: u32 = 8192;

/// Share by which a real bound is lowered, so that rounding can only add candidates, never lose one.
pub(super) const LESS_MARGIN: f64 = 1.0 - 1e-12;

/// Box lengths n1, n2, n3 of a ramp in scans; missing boxes are 0.
pub(super) type Ramp = [f64; 3];

/// The scans of a ramp.
pub(super) fn sum([n1, n2, n3]: Ramp) -> f64 {
    n1 + n2 + n3
}

/// The thresholds of a move with two different rates (docs/planner.md, eq. 29): whole numbers, stored as
/// `f64`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Thresholds {
    pub order: Order,
    /// Least M.
    pub k4: f64,
    /// Least n3 M of the ramp up, at most 2^63.
    pub up: f64,
    /// Least n3 M of the ramp down, at most 2^63.
    pub down: f64,
    /// Least n2 n3 M, at most 2^94.
    k2: f64,
    /// Least n1 n2 n3 M, at most 2^117.
    k1: f64,
}

/// A value of n1 with its results: the real n2 of the shortest ramp, and its sum.
#[derive(Clone, Copy)]
struct Row {
    n1: f64,
    n2: f64,
    sum: f64,
}

/// The ramps at one M, where velocity is 2 dx / (M T).
#[derive(Clone, Copy)]
struct Slice<'a> {
    thresholds: &'a Thresholds,
    /// Least n3 M.
    k3: f64,
    m: f64,
}

impl Thresholds {
    /// The thresholds of a move of `distance` > 0 (u) under checked `limits` and `cycle` (s), none of which is
    /// too long by itself.
    pub fn new(distance: f64, limits: &Limits, cycle: f64) -> Self {
        let of = |acceleration| ratios(distance, acceleration, limits, cycle).map(|r| threshold(2.0 * r));
        let [k4, up, k2, k1] = of(limits.acceleration);
        let [_, down, ..] = of(limits.deceleration);
        Self {
            order: limits.order(),
            k4,
            up,
            down,
            k2,
            k1,
        }
    }

    /// The ramp of the least sum with n1 >= `least_n1` at `m`, where `k3` is [`Thresholds::up`] or
    /// [`Thresholds::down`], and the rows visited; none once they would be more than `most_rows`. No ramp is
    /// shorter than `least_sum`.
    pub fn shortest(
        &self,
        k3: f64,
        m: f64,
        least_n1: f64,
        least_sum: f64,
        most_rows: u32,
    ) -> Option<(Ramp, u32)> {
        if most_rows == 0 {
            return None;
        }
        let slice = Slice {
            thresholds: self,
            k3,
            m,
        };
        match self.order {
            Order::Four => slice.rows(max(least_n1, 1.0), least_sum, most_rows),
            Order::Three => Some((slice.best_of(&slice.row(0.0)), 1)),
            Order::Two => Some(([0.0, 0.0, slice.least_n3(0.0, 0.0)], 1)),
        }
    }

    /// Whether the four products reach their thresholds.
    ///
    /// Below 2^53 this is exact (docs/planner.md, eq. 9). Beyond, the products are rounded, by far less
    /// than the slack of eq. 7, and still grow with every factor.
    pub fn reached_by(&self, [n1, n2, n3]: Ramp, k3: f64, m: f64) -> bool {
        let p3 = n3 * m;
        let p2 = max(n2, 1.0) * p3;
        p3 >= k3 && p2 >= self.k2 && max(n1, 1.0) * p2 >= self.k1
    }
}

impl Slice<'_> {
    /// Walks over n1 both ways from the minimiser of the real bound (docs/planner.md, eq. 33).
    fn rows(&self, least_n1: f64, least_sum: f64, most_rows: u32) -> Option<(Ramp, u32)> {
        let first = max(self.best_n1(), least_n1);
        let mut best = self.best_of(&self.row(first));
        let mut rows = 1;
        for step in [1.0, -1.0] {
            let mut n1 = first + step;
            while n1 >= least_n1 {
                let row = self.row(n1);
                if max(row.sum * LESS_MARGIN, least_sum) > sum(best) - 1.0 {
                    break;
                }
                if rows >= most_rows {
                    return None;
                }
                rows += 1;
                let found = self.best_of(&row);
                if sum(found) < sum(best) {
                    best = found;
                }
                n1 += step;
            }
        }
        Some((best, rows))
    }

    /// The real n1 >= 1 at which the ramp is shortest, rounded up (docs/planner.md, eq. 32).
    fn best_n1(&self) -> f64 {
        let Thresholds { k2, k1, .. } = *self.thresholds;
        let mut n = k1 / k2;
        if n * n * self.k3 > k1 {
            n = sqrt(k1 / self.k3);
        }
        if 2.0 * n * n * n * self.m > k1 {
            n = math::cbrt(0.5 * k1 / self.m);
        }
        math::ceil(max(n, 1.0))
    }

    /// The row of `n1`, or the only one at order 3, where `n1` is 0 (docs/planner.md, eq. 31).
    fn row(&self, n1: f64) -> Row {
        let least = max(n1, 1.0);
        let product = max(self.thresholds.k2, self.thresholds.k1 / least) / self.m;
        // Whole, but never above the bounds of the products.
        let n3 = math::ceil(self.k3 / self.m * LESS_MARGIN);
        let mut n2 = product / n3;
        if n2 > least && n2 * (n1 + n2) > product {
            n2 = 0.5 * (sqrt(n1 * n1 + 4.0 * product) - n1);
        }
        n2 = max(n2, least);
        Row {
            n1,
            n2,
            sum: n1 + n2 + max(n3, n1 + n2),
        }
    }

    /// The shortest ramp of a row: next to its real n2 (docs/planner.md, eq. 30).
    fn best_of(&self, row: &Row) -> Ramp {
        let n1 = row.n1;
        let n2 = math::ceil(row.n2);
        let mut best = [n1, n2, self.least_n3(n1, n2)];
        for n2 in [n2 - 1.0, n2 + 1.0] {
            // Not even with the least n3 that the family allows; this is the usual case.
            if n2 >= max(n1, 1.0) && n1 + n2 + (n1 + n2) < sum(best) {
                let other = [n1, n2, self.least_n3(n1, n2)];
                if sum(other) < sum(best) {
                    best = other;
                }
            }
        }
        best
    }

    /// The least n3 that goes with n1 and n2.
    fn least_n3(&self, n1: f64, n2: f64) -> f64 {
        let Thresholds { k2, k1, .. } = *self.thresholds;
        let (least_n1, least_n2) = (max(n1, 1.0), max(n2, 1.0));
        let product = max(self.k3, max(k2, k1 / least_n1) / least_n2);
        let least = max(n1 + n2, 1.0);
        // The quotient is within one of the whole number; the products decide.
        let mut n3 = max(math::ceil(product / self.m), least);
        let reached = |n3| self.thresholds.reached_by([n1, n2, n3], self.k3, self.m);
        for _ in 0..2 {
            if !reached(n3) {
                n3 += 1.0;
            }
        }
        if n3 > least && reached(n3 - 1.0) {
            n3 -= 1.0;
        }
        n3
    }
}
