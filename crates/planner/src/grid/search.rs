//! The fewest samples: a walk over (n1, n2) outwards from the real optimum, pruned by a real lower bound
//! (docs/planner.md, section 5).

use super::problem::{Boxes, LONGEST, Problem};
use crate::{Order, math};

/// Most rows (values of n1) a search may visit before it settles for the best found.
pub const MAX_ROWS: u32 = 1024;

/// Most pairs (n1, n2) a search may try before it settles for the best found.
pub const MAX_CANDIDATES: u32 = 4096;

/// Share by which the real bound is lowered, so that rounding can only add candidates, never lose one.
const MARGIN: f64 = 1e-12;

/// Newton steps of a cubic root: the start is within 16 %, each step squares the error.
const NEWTON_STEPS: u32 = 5;

/// How much work a search took.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Values of n1 looked at.
    pub rows: u32,
    /// Pairs (n1, n2) solved for n3 and n4.
    pub candidates: u32,
    /// Whether a cap ended the search, so that the result is valid but not proven shortest.
    pub capped: bool,
}

/// How close box 4 may come to the others.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Family {
    /// `n4 >= n1 + n2 + n3`: the published 15 segments.
    Separate,
    /// `n4 >= n2 + n3`: the two middle jerk pulses may overlap.
    Overlapped,
}

/// One search: the problem, the thresholds as reals, and the best so far.
struct Search<'a> {
    problem: &'a Problem,
    family: Family,
    k4: f64,
    k3: f64,
    best: Boxes,
    /// Sum of `best`; one more than the longest plan until there is one.
    scans: u64,
    work: Work,
}

/// The boxes of the least sum in `family`, and the work it took; no boxes (all 0) if that sum is above the
/// longest a plan can count.
///
/// At most [`MAX_ROWS`] rows and [`MAX_CANDIDATES`] candidates; when a cap ends it, [`Work::capped`] is set
/// and the result is the best found.
pub(super) fn fewest(problem: &Problem, family: Family) -> (Boxes, Work) {
    let mut search = Search {
        problem,
        family,
        k4: problem.k4 as f64,
        k3: problem.k3 as f64,
        best: [0; 4],
        scans: LONGEST + 1,
        work: Work::default(),
    };
    match problem.order {
        Order::Four => search.rows(),
        Order::Three => {
            let k2 = problem.k2 as f64;
            search.columns(0.0, search.best_n2(0.0, k2), k2);
        }
        Order::Two => search.solve(0, 0),
    }
    (search.best, search.work)
}

impl Search<'_> {
    /// Walks over n1 both ways from the minimiser of the real bound (docs/planner.md, eq. 19).
    fn rows(&mut self) {
        let (k2, k1) = (self.problem.k2 as f64, self.problem.k1 as f64);
        let start = self.best_n1(k2, k1);
        let m2 = k2.max(k1 / start);
        self.work.rows = 1;
        self.columns(start, self.best_n2(start, m2), m2);
        let mut n1 = start + 1.0;
        while self.try_row(n1, k2.max(k1 / n1)) {
            n1 += 1.0;
        }
        let mut n1 = start - 1.0;
        while n1 >= 1.0 && self.try_row(n1, k2.max(k1 / n1)) {
            n1 -= 1.0;
        }
    }

    /// Searches row `n1` unless no real n2 in it could beat the best; false ends the walk.
    fn try_row(&mut self, n1: f64, m2: f64) -> bool {
        let n2 = self.best_n2(n1, m2);
        if !self.may_improve(self.bound(n1, n2, m2)) {
            return false;
        }
        if self.work.rows == MAX_ROWS {
            self.work.capped = true;
        }
        if self.work.capped {
            return false;
        }
        self.work.rows += 1;
        self.columns(n1, n2, m2);
        true
    }

    /// Walks over n2 both ways from `best_n2`, the minimiser of the real bound in row `n1`, where
    /// n2 n3 n4 >= `m2` is asked.
    fn columns(&mut self, n1: f64, best_n2: f64, m2: f64) {
        let start = math::ceil(best_n2);
        self.solve(n1 as u64, start as u64);
        let mut n2 = start + 1.0;
        while self.try_pair(n1, n2, m2) {
            n2 += 1.0;
        }
        let mut n2 = start - 1.0;
        while n2 >= n1.max(1.0) && self.try_pair(n1, n2, m2) {
            n2 -= 1.0;
        }
    }

    /// Solves the pair unless no real n3 and n4 could beat the best; false ends the walk.
    fn try_pair(&mut self, n1: f64, n2: f64, m2: f64) -> bool {
        if !self.may_improve(self.bound(n1, n2, m2)) {
            return false;
        }
        if self.work.candidates >= MAX_CANDIDATES {
            self.work.capped = true;
            return false;
        }
        self.solve(n1 as u64, n2 as u64);
        true
    }

    /// Whether a real lower bound of the sum leaves room for a sum below the best.
    fn may_improve(&self, bound: f64) -> bool {
        bound * (1.0 - MARGIN) <= (self.scans - 1) as f64
    }

    /// Least sum over real n3 and n4 for the pair (docs/planner.md, eq. 16).
    fn bound(&self, n1: f64, n2: f64, m2: f64) -> f64 {
        let m = self.k3.max(m2 / n2);
        let (least_n3, gap) = self.constraints(n1, n2);
        let n3 = least_n3.max((m / self.k4).min(2.0 * m / (gap + math::sqrt(gap * gap + 4.0 * m))));
        n1 + n2 + n3 + self.k4.max(gap + n3)
    }

    /// The least n3, and by how much n4 must exceed n3.
    fn constraints(&self, n1: f64, n2: f64) -> (f64, f64) {
        match self.family {
            Family::Separate => (n1 + n2, n1 + n2),
            Family::Overlapped => (n1 + n2, n2),
        }
    }

    /// The real n1 >= 1 at which the bound is least, rounded up (docs/planner.md, eq. 18).
    fn best_n1(&self, k2: f64, k1: f64) -> f64 {
        let alone = match self.family {
            Family::Separate => 8.0,
            Family::Overlapped => 6.0,
        };
        let mut n1 = (k1 / k2)
            .min(math::sqrt(k1 / self.k3))
            .min(math::sqrt(math::sqrt(k1 / alone)));
        let k1_over_k4 = k1 / self.k4;
        if 2.0 * n1 * n1 * n1 > k1_over_k4 {
            n1 = cubic_root(0.0, 0.0, k1_over_k4);
        }
        math::ceil(n1.max(1.0))
    }

    /// The real n2 >= max(n1, 1) at which the bound is least in row `n1` (docs/planner.md, eq. 17).
    fn best_n2(&self, n1: f64, m2: f64) -> f64 {
        let least = n1.max(1.0);
        let m2_over_k4 = m2 / self.k4;
        let n2 = (m2 / self.k3).min(0.5 * (math::sqrt(n1 * n1 + 4.0 * m2_over_k4) - n1));
        if n2 <= least {
            return least;
        }
        // n (n1 + n) times the n4 that goes with n3 = n1 + n: 2 n1 + 2 n, or n1 + 2 n.
        let (p, q) = match self.family {
            Family::Separate => (1.0, 1.0),
            Family::Overlapped => (1.0, 0.5),
        };
        let reached = |n: f64| 2.0 * n * (n + p * n1) * (n + q * n1) >= m2;
        if !reached(n2) {
            n2
        } else if reached(least) {
            least
        } else {
            cubic_root(p * n1, q * n1, m2)
        }
    }

    /// The best n3 and n4 for a pair (docs/planner.md, eq. 15), kept if they beat the best.
    fn solve(&mut self, n1: u64, n2: u64) {
        self.work.candidates += 1;
        let problem = self.problem;
        let (least_n3, gap) = match self.family {
            Family::Separate => (n1 + n2, n1 + n2),
            Family::Overlapped => (n1 + n2, n2),
        };
        let least_n3 = least_n3.max(1);
        let (some_n1, some_n2) = (u128::from(n1.max(1)), u128::from(n2.max(1)));
        let product = u128::from(problem.k3)
            .max(problem.k2.div_ceil(some_n2))
            .max(problem.k1.div_ceil(some_n1 * some_n2));
        // Longer than a plan can be, which also keeps the products below in 64 bits.
        if least_n3 > LONGEST || product > u128::from(LONGEST) * u128::from(LONGEST) {
            return;
        }
        let product = product as u64;
        let n4_of = |n3: u64| problem.k4.max(gap + n3);
        let (m, g) = (product as f64, gap as f64);
        let root = (m / self.k4).min(2.0 * m / (g + math::sqrt(g * g + 4.0 * m)));
        // The real root is within one of the whole one; the products decide.
        let mut n3 = least_n3.max(root as u64);
        if n3 > least_n3 && (n3 - 1) * n4_of(n3 - 1) >= product {
            n3 -= 1;
        }
        for _ in 0..2 {
            if n3 * n4_of(n3) < product {
                n3 += 1;
            }
        }
        self.keep([n1, n2, n3, n4_of(n3)]);
        if n3 > least_n3 {
            let n3 = n3 - 1;
            self.keep([n1, n2, n3, n4_of(n3).max(product.div_ceil(n3))]);
        }
    }

    /// Keeps the boxes if their sum beats the best.
    fn keep(&mut self, boxes: Boxes) {
        let scans = boxes.iter().sum();
        if scans < self.scans {
            self.best = boxes;
            self.scans = scans;
        }
    }
}

/// The real n > 0 with 2 n (n + p) (n + q) = m, by Newton from the root of the cube with the same mean.
///
/// Asks for a root of at least max(p, q).
fn cubic_root(p: f64, q: f64, m: f64) -> f64 {
    let mut n = math::rough_cbrt(0.5 * m) - (p + q) / 3.0;
    for _ in 0..NEWTON_STEPS {
        let value = 2.0 * n * (n + p) * (n + q) - m;
        let slope = 2.0 * (3.0 * n * n + 2.0 * (p + q) * n + p * q);
        n -= value / slope;
    }
    n
}
