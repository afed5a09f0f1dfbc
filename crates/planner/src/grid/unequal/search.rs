//! The fewest scans where acceleration and deceleration differ (docs/planner.md, section 12).

use super::super::problem::LONGEST;
use super::super::search::Family;
use super::lattice::{LESS_MARGIN, MAX_RAMP_ROWS, Ramp, Thresholds, sum};
use crate::Order;
use crate::math::{ceil, floor, max, min, sqrt};

/// Steps of the first estimate: four digits are enough.
const ESTIMATE_STEPS: u32 = 6;

/// The work of a search.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct UnequalWork {
    /// Scan counts tried.
    pub counts: u32,
    /// Number of times both ramps were solved.
    pub solves: u32,
    /// Values of n1 that were examined, over all ramps.
    pub rows: u32,
    /// Whether the cap ended the search, so that the result is valid but not proven shortest.
    pub capped: bool,
}

/// Two ramps that fit into `scans`.
#[derive(Clone, Copy, Debug)]
pub(super) struct Found {
    pub scans: f64,
    pub up: Ramp,
    pub down: Ramp,
}

impl Found {
    /// Scans of both ramps together.
    fn ramps(&self) -> f64 {
        sum(self.up) + sum(self.down)
    }
}

/// One search: its problem, and the work so far.
struct Search<'a> {
    thresholds: &'a Thresholds,
    overlap: bool,
    work: UnequalWork,
}

/// The ramps of the fewest scans in `family`; none if that is more than a plan can count, or if the cap of
/// [`MAX_RAMP_ROWS`] ended the search before it found any.
pub(super) fn fewest(thresholds: &Thresholds, family: Family) -> (Option<Found>, UnequalWork) {
    let mut search = Search {
        thresholds,
        // Below order 4 there is no snap pulse to cancel.
        overlap: family == Family::Overlapped && thresholds.order == Order::Four,
        work: UnequalWork::default(),
    };
    let found = search.run();
    (found, search.work)
}

impl Search<'_> {
    /// Ramps that fit into N scans also fit into N + 1, so the least N is between a count that is too
    /// short and one that is not. The search gallops from an estimate, then halves the gap. At most 2 *
    /// 31 counts.
    fn run(&mut self) -> Option<Found> {
        let estimate = min(self.estimate()?, LONGEST as f64);
        let mut best = self.fits(estimate, 0.0);
        if best.is_none() && self.work.capped {
            // Near the least count of a long move the sum is raised scan by scan; a start with some more
            // scans is there at once.
            self.work.rows = 0;
            let roomy = estimate + ceil(2.0 * sqrt(estimate));
            best = self.fits(min(roomy, LONGEST as f64), 0.0);
        }
        let mut short = if best.is_some() { 0.0 } else { estimate };
        let mut step = 1.0;
        // Downwards while it fits, in growing steps; or upwards until it fits.
        while best.is_none_or(|best| best.scans - step > short) {
            match best {
                Some(known) => match self.fits(known.scans - step, known.ramps()) {
                    Some(found) => best = Some(found),
                    None => {
                        short = known.scans - step;
                        break;
                    }
                },
                None if short >= LONGEST as f64 || self.work.capped => return None,
                None => {
                    let scans = min(short + step, LONGEST as f64);
                    best = self.fits(scans, 0.0);
                    if best.is_some() {
                        break;
                    }
                    short = scans;
                }
            }
            step *= 2.0;
        }
        let mut best = best?;
        while best.scans - short > 1.0 {
            let middle = short + ceil(0.5 * (best.scans - short));
            let middle = min(middle, best.scans - 1.0);
            match self.fits(middle, best.ramps()) {
                Some(found) => best = found,
                None => short = middle,
            }
        }
        Some(best)
    }

    /// An estimate of the scans: either velocity decides, or M and the ramps meet, less their possible
    /// overlap.
    fn estimate(&mut self) -> Option<f64> {
        let mut m = self.thresholds.k4;
        let mut scans = m;
        for _ in 0..ESTIMATE_STEPS {
            let found = self.solve(m, 0.0, None)?;
            let ([up, ..], [down, ..]) = (found.up, found.down);
            let ramps = found.ramps();
            scans = ceil(0.5 * (m + ramps));
            let apart = if self.overlap {
                ramps - 2.0 * min(up, down)
            } else {
                ramps
            };
            if apart <= m + 1.0 {
                break;
            }
            m = ceil(sqrt(m * apart));
        }
        Some(scans)
    }

    /// Whether some ramps fit into `scans`: the ramps of the least sum, which is at least `least_sum`.
    ///
    /// The more scans the ramps take, the higher is the velocity between them, and the more scans they
    /// need. So the sum can be raised step by step to the least that is enough (docs/planner.md, eq. 34).
    fn fits(&mut self, scans: f64, least_sum: f64) -> Option<Found> {
        self.work.counts += 1;
        // The start of the sum that is raised: the least one for which n3 alone would be enough
        // (docs/planner.md, after eq. 34).
        let both = self.thresholds.up + self.thresholds.down;
        let square = scans * scans - both * LESS_MARGIN;
        if square < 0.0 {
            return None;
        }
        let alone = both * LESS_MARGIN / (scans + sqrt(square));
        let mut ramps = max(least_sum, floor(alone));
        let mut known = None;
        loop {
            let m = 2.0 * scans - ramps;
            let overlap = max(ramps - scans, 0.0);
            if m < self.thresholds.k4 || (overlap > 0.0 && !self.overlap) {
                return None;
            }
            let mut found = self.solve(m, overlap, known)?;
            known = Some(found);
            let needed = found.ramps();
            if needed <= ramps {
                // The remaining scans go to the longer ramp, whose acceleration is lower.
                let [up, down] = [&mut found.up, &mut found.down];
                let [.., n3] = if sum(*up) >= sum(*down) { up } else { down };
                *n3 += ramps - needed;
                return Some(Found { scans, ..found });
            }
            ramps = needed;
        }
    }

    /// The shortest ramps at `m` that may overlap by `overlap` scans; none at the cap. `known` are those
    /// of a larger `m` or a smaller overlap: if one is still valid it is still the shortest.
    fn solve(&mut self, m: f64, overlap: f64, known: Option<Found>) -> Option<Found> {
        self.work.solves += 1;
        let (up, down) = (self.thresholds.up, self.thresholds.down);
        let up = self.ramp(up, m, overlap, known.map(|known| known.up))?;
        let down = self.ramp(down, m, overlap, known.map(|known| known.down))?;
        Some(Found { scans: 0.0, up, down })
    }

    fn ramp(&mut self, k3: f64, m: f64, overlap: f64, known: Option<Ramp>) -> Option<Ramp> {
        if let Some([n1, n2, n3]) = known
            && n1 >= overlap
            && self.thresholds.reached_by([n1, n2, n3], k3, m)
        {
            return known;
        }
        let left = MAX_RAMP_ROWS.saturating_sub(self.work.rows);
        let least_sum = known.map_or(0.0, sum);
        match self.thresholds.shortest(k3, m, overlap, least_sum, left) {
            Some((ramp, rows)) => {
                self.work.rows += rows;
                Some(ramp)
            }
            None => {
                self.work.capped = true;
                self.work.rows = MAX_RAMP_ROWS;
                None
            }
        }
    }
}
