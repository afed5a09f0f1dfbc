//! The fewest samples: a walk over (n1, n2) outwards from the real optimum, pruned by a real lower bound
//! (docs/planner.md, section 5).

use super::problem::{Boxes, LONGEST, Problem};
use crate::Order;
use crate::math::{self, max, min, sqrt};

/// Largest number of rows (values of n1) that a search may visit before it returns the best found.
pub const MAX_ROWS: u32 = 1024;

/// Largest number of pairs (n1, n2) that a search may try before it returns the best found.
pub const MAX_CANDIDATES: u32 = 2048;

/// Share by which the budget of the real bound is raised, so that rounding can only add candidates, never lose one.
const MARGIN: f64 = 1e-12;

/// Newton steps of a cubic root: the start is within 13 %, and four steps end at the last place.
const NEWTON_STEPS: u32 = 4;

/// The work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Work {
    /// Values of n1 that were tried.
    pub rows: u32,
    /// Pairs (n1, n2) solved for n3 and n4.
    pub candidates: u32,
    /// Whether a cap ended the search, so that the result is valid but not proven shortest.
    pub capped: bool,
}

/// How close the ramp down may come to the ramp up.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Family {
    /// The ramps do not overlap, `n4 >= n1 + n2 + n3`: the published 15 segments.
    Separate,
    /// The last snap pulse of the one and the first of the other may overlap, `n4 >= n2 + n3`.
    Overlapped,
}

/// One search: the problem, numbers that its bounds need often, and the best result so far.
///
/// Box lengths are whole numbers held as `f64`, exact below 2^53, so that bounds and candidates share them.
struct Search<'a> {
    problem: &'a Problem,
    /// The part of n1 in the gap between n3 and n4, in addition to n2: 1, or 0 if pulses may overlap.
    share: f64,
    best: [f64; 4],
    /// Sum of `best`; one more than the longest plan until there is one.
    scans: f64,
    /// The largest sum that is better than the best, plus [`MARGIN`].
    budget: f64,
    work: Work,
}

/// A value of n1 with what follows from it.
#[derive(Clone, Copy)]
struct Row {
    n1: f64,
    /// Least n2 n3 n4, not rounded.
    m2: f64,
    /// The real n2 at which the real bound is least.
    n2: f64,
}

/// The boxes of the least sum in `family`, and the work it took; no boxes (all 0) if that sum is above the
/// longest a plan can count.
///
/// At most [`MAX_ROWS`] rows and [`MAX_CANDIDATES`] candidates; when a cap ends it, [`Work::capped`] is set
/// and the result is the best found.
pub(super) fn fewest(problem: &Problem, family: Family) -> (Boxes, Work) {
    let mut search = Search {
        problem,
        share: match family {
            Family::Separate => 1.0,
            Family::Overlapped => 0.0,
        },
        best: [0.0; 4],
        scans: LONGEST as f64 + 1.0,
        budget: LONGEST as f64,
        work: Work::default(),
    };
    match problem.order {
        Order::Four => search.rows(),
        Order::Three => search.first_row(&search.row(0.0)),
        Order::Two => search.solve(0.0, 0.0, problem.k3),
    }
    (search.best.map(|n| n as u32), search.work)
}

impl Search<'_> {
    /// Walks over n1 both ways from the minimiser of the real bound (docs/planner.md, eq. 18).
    fn rows(&mut self) {
        let first = self.row(self.best_n1());
        self.first_row(&first);
        let mut row = first;
        // Above the minimiser each step of n1 adds at least one to the bound, so a row that leaves no room
        // for that ends the walk before the next one is computed (docs/planner.md, eq. 19).
        while self.may_improve(&row, row.n2, self.budget - 1.0) {
            row = self.row(row.n1 + 1.0);
            if !self.try_row(&row) {
                break;
            }
        }
        row = first;
        while row.n1 > 1.0 {
            row = self.row(row.n1 - 1.0);
            if !self.try_row(&row) {
                break;
            }
        }
    }

    /// The row of `n1`, or the only one at order 3, where `n1` is 0.
    fn row(&self, n1: f64) -> Row {
        let Problem { k2, k1, .. } = *self.problem;
        let m2 = max(k2, k1 / max(n1, 1.0));
        let n2 = self.best_n2(n1, m2);
        Row { n1, m2, n2 }
    }

    /// Searches the first row; there is nothing to prune it by.
    fn first_row(&mut self, row: &Row) {
        self.work.rows = 1;
        let n2 = math::ceil(row.n2);
        self.solve(row.n1, n2, row.m2);
        self.columns(row, n2 + 1.0, n2 - 1.0);
    }

    /// Searches a row unless no real n2 in it could beat the best; false ends the walk.
    fn try_row(&mut self, row: &Row) -> bool {
        if !self.may_improve(row, row.n2, self.budget) {
            return false;
        }
        if self.work.rows >= MAX_ROWS {
            self.work.capped = true;
        }
        if self.work.capped {
            return false;
        }
        self.work.rows += 1;
        let n2 = math::ceil(row.n2);
        self.columns(row, n2, n2 - 1.0);
        true
    }

    /// Walks over n2 upwards from `up` and downwards from `down`.
    fn columns(&mut self, row: &Row, up: f64, down: f64) {
        let mut n2 = up;
        while self.try_pair(row, n2) {
            n2 += 1.0;
        }
        let mut n2 = down;
        while n2 >= max(row.n1, 1.0) && self.try_pair(row, n2) {
            n2 -= 1.0;
        }
    }

    /// Solves the pair if it may beat the best; false, when not even real n3 and n4 could, ends the walk.
    fn try_pair(&mut self, row: &Row, n2: f64) -> bool {
        if !self.may_improve(row, n2, self.budget) {
            return false;
        }
        if self.work.candidates >= MAX_CANDIDATES {
            self.work.capped = true;
            return false;
        }
        self.solve(row.n1, n2, row.m2);
        true
    }

    /// Whether some real n3 and n4 keep the sum with `n2` within `budget` (docs/planner.md, eq. 15).
    fn may_improve(&self, row: &Row, n2: f64, budget: f64) -> bool {
        let n1 = row.n1;
        let rest = budget - n1 - n2;
        let gap = self.gap(n1, n2);
        // The more n3 takes of the rest the larger is the product, as long as enough is left for n4.
        let n3 = min(rest - self.problem.k4, 0.5 * (rest - gap));
        let product = n3 * (rest - n3);
        n3 >= n1 + n2 && product >= self.problem.k3 && product * n2 >= row.m2
    }

    /// By how much n4 must exceed n3.
    fn gap(&self, n1: f64, n2: f64) -> f64 {
        self.share * n1 + n2
    }

    // The roots below are taken one by one, each only if it is smaller than the last. The same bounds
    // usually decide from move to move, so the processor need not wait for roots that are not needed.

    /// The real n1 >= 1 at which the bound is least, rounded up (docs/planner.md, eq. 17).
    fn best_n1(&self) -> f64 {
        let Problem { k4, k3, k2, k1, .. } = *self.problem;
        let alone = 6.0 + 2.0 * self.share;
        let mut n = k1 / k2;
        if n * n * k3 > k1 {
            n = sqrt(k1 / k3);
        }
        if alone * (n * n) * (n * n) > k1 {
            n = sqrt(sqrt(k1 / alone));
        }
        if n > 1.0 && 2.0 * n * n * n * k4 > k1 {
            n = cubic_root(0.0, 0.0, k1 / k4);
        }
        math::ceil(max(n, 1.0))
    }

    /// The real n2 >= max(n1, 1) at which the bound is least in row `n1` (docs/planner.md, eq. 16).
    fn best_n2(&self, n1: f64, m2: f64) -> f64 {
        let Problem { k4, k3, .. } = *self.problem;
        let least = max(n1, 1.0);
        let mut n = m2 / k3;
        if n * (n1 + n) * k4 > m2 {
            n = 0.5 * (sqrt(n1 * n1 + 4.0 * (m2 / k4)) - n1);
        }
        // n (n1 + n) times the n4 that goes with n3 = n1 + n: n1 + n and the gap.
        let (p, q) = (n1, 0.5 * (1.0 + self.share) * n1);
        let reaches = |n: f64| 2.0 * n * (n + p) * (n + q) > m2;
        if n > least && reaches(n) {
            n = if reaches(least) {
                least
            } else {
                cubic_root(p, q, m2)
            };
        }
        max(n, least)
    }

    /// The best n3 and n4 for a pair (docs/planner.md, eq. 14), kept if they beat the best.
    fn solve(&mut self, n1: f64, n2: f64, m2: f64) {
        self.work.candidates += 1;
        let problem = self.problem;
        let gap = self.gap(n1, n2);
        let least_n3 = max(n1 + n2, 1.0);
        let product = max(problem.k3, m2 / max(n2, 1.0));
        // Longer than a plan can be.
        let longest = LONGEST as f64;
        if least_n3 > longest || product > longest * longest {
            return;
        }
        let n4_of = |n3| max(problem.k4, gap + n3);
        // The real root of n3 n4 = product is within one of the whole one; the exact products decide.
        let mut root = product / problem.k4;
        if gap + root > problem.k4 {
            root = 0.5 * (sqrt(gap * gap + 4.0 * product) - gap);
        }
        let mut n3 = max(math::floor(root), least_n3);
        for _ in 0..2 {
            if !problem.reached_by([n1, n2, n3, n4_of(n3)]) {
                n3 += 1.0;
            }
        }
        let n4 = n4_of(n3);
        // One less with the same n4 may also be enough; nothing else can be shorter.
        if n3 > least_n3 && problem.reached_by([n1, n2, n3 - 1.0, n4]) {
            n3 -= 1.0;
        }
        let scans = n1 + n2 + n3 + n4;
        if scans < self.scans {
            self.best = [n1, n2, n3, n4];
            self.scans = scans;
            self.budget = (scans - 1.0) * (1.0 + MARGIN);
        }
    }
}

/// The real n > 0 with 2 n (n + p) (n + q) = m, by Newton from the root of the cube with the same mean.
///
/// Asks for a root of at least max(p, q).
fn cubic_root(p: f64, q: f64, m: f64) -> f64 {
    // With t = n + mean the square vanishes: t^3 - slope t = rest. That makes the steps short.
    let (mean, pq, half) = ((p + q) / 3.0, p * q, 0.5 * m);
    let slope = 3.0 * mean * mean - pq;
    let rest = half + mean * (pq - 2.0 * mean * mean);
    let mut t = math::rough_cbrt(half);
    for _ in 0..NEWTON_STEPS {
        let square = t * t;
        t = (2.0 * t * square + rest) / (3.0 * square - slope);
    }
    t - mean
}
