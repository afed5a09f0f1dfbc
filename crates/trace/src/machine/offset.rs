//! The offset between the times of a recording and of a trace.

use super::{Map, NotComparable, Offset, Pair, curve, edges, scan_ns, show};
use crate::foreign::Channel;
use crate::trace::Trace;

/// Largest number of whole scans that a fit tries.
pub const FIT_SCANS: i64 = 4000;

/// Largest number of rows that a fit uses; of a longer trace every n-th.
pub const FIT_ROWS: usize = 2000;

/// Rounds of the search between whole scans; each makes the step ten times smaller.
const ROUNDS: u32 = 3;

/// An offset and how it was found.
#[derive(Clone, Debug, PartialEq)]
pub struct Found {
    /// Recording time minus trace time (ns).
    pub ns: i64,
    /// How, in words.
    pub how: String,
    /// Whether a better one may be outside the range that was tried.
    pub at_border: bool,
}

/// Finds the offset as the map says.
pub fn find(pairs: &[Pair<'_>], trace: &Trace, map: &Map, cycle: i64) -> Result<Found, NotComparable> {
    let pair = |name: &str| {
        let found = pairs.iter().find(|pair| pair.signal.name == name);
        found.ok_or_else(|| NotComparable(format!("the map has no signal `{name}` for its offset")))
    };
    match &map.offset {
        Offset::Fixed(ns) => Ok(Found {
            ns: *ns,
            how: "as the map says".to_owned(),
            at_border: false,
        }),
        Offset::Edge { signal, to, number } => {
            let pair = pair(signal)?;
            let sides = [
                ("recording", edges::recorded(pair, 0)),
                ("trace", edges::of_trace(trace, pair.column, cycle)),
            ];
            let [recorded, found] = sides.map(|(side, edges)| {
                let mut those = edges.iter().skip(1).filter(|(_, value)| value == to);
                those
                    .nth(number.saturating_sub(1))
                    .map(|(ns, _)| *ns)
                    .ok_or_else(|| {
                        NotComparable(format!(
                            "no offset: in the {side} {signal} changes to {to} less than {number} times"
                        ))
                    })
            });
            Ok(Found {
                ns: recorded? - found?,
                how: format!("edge {number} of {signal} to {to}"),
                at_border: false,
            })
        }
        Offset::Fit { signal, from, to } => {
            let pair = pair(signal)?;
            let Channel::Curve(samples) = &pair.channel else {
                return Err(NotComparable(format!("no offset: {signal} is no curve")));
            };
            let values: Vec<f64> = trace.reals(pair.column).collect();
            let fit = Fit::new(samples, &values, cycle);
            fit.best(*from, *to, signal)
        }
    }
}

/// The data of a fit.
struct Fit<'f> {
    samples: &'f [(i64, f64)],
    /// Times (ns) and values of the rows.
    rows: Vec<(i64, f64)>,
    cycle: i64,
}

/// The mean square of the differences, over this many rows.
#[derive(Clone, Copy, Debug)]
struct Cost {
    mean: f64,
    rows: usize,
}

impl<'f> Fit<'f> {
    fn new(samples: &'f [(i64, f64)], values: &[f64], cycle: i64) -> Self {
        let every = values.len().div_ceil(FIT_ROWS).max(1);
        let rows = values.iter().enumerate().step_by(every);
        let rows = rows.filter(|(_, value)| value.is_finite());
        Self {
            samples,
            rows: rows.map(|(scan, value)| (scan_ns(scan, cycle), *value)).collect(),
            cycle,
        }
    }

    /// The cost of an offset; `None` if less than half of the shorter of the two overlaps, because a
    /// small piece could fit by chance.
    fn cost(&self, offset: i64) -> Option<Cost> {
        let (first, last) = (self.samples.first()?.0, self.samples.last()?.0);
        let (mut sum, mut rows) = (0.0, 0);
        for (ns, value) in &self.rows {
            let ns = ns.saturating_add(offset);
            if ns >= first && ns <= last {
                let difference = curve::at(self.samples, ns)? - value;
                sum += difference * difference;
                rows += 1;
            }
        }
        let step = match self.rows.get(..2) {
            Some([(a, _), (b, _)]) => b - a,
            _ => self.cycle,
        };
        let recorded = usize::try_from((last - first) / step).unwrap_or(usize::MAX);
        let enough = self.rows.len().min(recorded).div_ceil(2).max(2);
        (rows >= enough).then(|| Cost {
            mean: sum / rows as f64,
            rows,
        })
    }

    /// The best offset from `from` to `to`: first whole scans, then parts of one around the best.
    fn best(&self, from: i64, to: i64, signal: &str) -> Result<Found, NotComparable> {
        let (low, high) = (
            from.div_euclid(self.cycle) + i64::from(from.rem_euclid(self.cycle) != 0),
            to.div_euclid(self.cycle),
        );
        if high.saturating_sub(low) >= FIT_SCANS {
            return Err(NotComparable(format!(
                "no offset: a fit tries {FIT_SCANS} scans at most"
            )));
        }
        let whole = (low..=high).map(|scans| scans.saturating_mul(self.cycle));
        let costs: Vec<(i64, Cost)> = whole.filter_map(|ns| Some((ns, self.cost(ns)?))).collect();
        let Some(mut best) = least(costs.iter().copied()) else {
            return Err(NotComparable(format!(
                "no offset: from {} to {} trace and recording of {signal} never overlap by half",
                show::time(from),
                show::time(to)
            )));
        };
        let first = costs.first().map_or(0.0, |(_, cost)| cost.mean);
        // A curve that repeats itself except for rounding gives no information about time.
        let largest = costs.iter().map(|(_, cost)| cost.mean).fold(0.0, f64::max);
        let flat = costs
            .iter()
            .all(|(_, cost)| (cost.mean - first).abs() <= 1e-12 * largest);
        if costs.len() > 1 && flat {
            return Err(NotComparable(format!(
                "no offset: every one fits {signal} equally well: it does not move"
            )));
        }
        let mut step = self.cycle;
        for _ in 0..ROUNDS {
            let finer = (step / 10).max(1);
            let around = (-10..=10).map(|part| best.0.saturating_add(part * finer));
            let around = around.filter(|ns| *ns >= from && *ns <= to);
            let costs = around.filter_map(|ns| Some((ns, self.cost(ns)?)));
            best = least(costs).unwrap_or(best);
            step = finer;
        }
        let (ns, cost) = best;
        Ok(Found {
            ns,
            how: format!(
                "fitted on {signal}, {} left over {} rows",
                show::short(cost.mean.sqrt()),
                cost.rows
            ),
            at_border: ns.saturating_sub(from) < self.cycle || to.saturating_sub(ns) < self.cycle,
        })
    }
}

/// The least cost; among equal ones that of the smallest offset, then of the earlier one.
fn least(costs: impl Iterator<Item = (i64, Cost)>) -> Option<(i64, Cost)> {
    costs.min_by(|(a, cost_a), (b, cost_b)| {
        let by_cost = cost_a.mean.total_cmp(&cost_b.mean);
        by_cost
            .then(a.unsigned_abs().cmp(&b.unsigned_abs()))
            .then(a.cmp(b))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    const MS: i64 = 1_000_000;

    /// A smooth hump around 0.5 s.
    fn hump(ns: i64) -> f64 {
        let x = (ns - 500 * MS) as f64 / (100 * MS) as f64;
        1.0 / (1.0 + x * x)
    }

    fn fitted(shift: i64, sample: i64, from: i64, to: i64) -> Result<Found, NotComparable> {
        let samples: Vec<_> = (0..1000 * MS / sample)
            .map(|n| (n * sample, hump(n * sample - shift)))
            .collect();
        let values: Vec<_> = (0..1000).map(|scan| hump(scan * MS)).collect();
        Fit::new(&samples, &values, MS).best(from, to, "v")
    }

    #[test]
    fn whole_and_part_scans_are_found() {
        for (shift, sample) in [
            (0, MS),
            (40 * MS, MS),
            (-17 * MS, 4 * MS),
            (12_345_000, MS),
            (-250_000, 2 * MS),
        ] {
            let found = fitted(shift, sample, -100 * MS, 100 * MS).unwrap();
            assert!((found.ns - shift).abs() <= MS / 50, "{shift}: {}", found.ns);
            assert!(!found.at_border);
        }
    }

    #[test]
    fn an_offset_outside_the_window_is_not_found_and_that_is_said() {
        let found = fitted(60 * MS, MS, -20 * MS, 20 * MS).unwrap();
        assert_eq!((found.ns, found.at_border), (20 * MS, true));
    }

    #[test]
    fn what_cannot_be_fitted_is_refused() {
        let flat = vec![(0, 1.0), (1000 * MS, 1.0)];
        let values = vec![1.0; 1000];
        let fit = Fit::new(&flat, &values, MS);
        assert!(
            fit.best(-5 * MS, 5 * MS, "v")
                .unwrap_err()
                .0
                .contains("does not move")
        );
        let apart = fit.best(900 * MS, 950 * MS, "v").unwrap_err();
        assert!(apart.0.contains("never overlap"), "{apart}");
        let wide = fit.best(0, FIT_SCANS * MS, "v").unwrap_err();
        assert!(wide.0.contains("4000 scans"), "{wide}");
    }
}
