//! Curves against curves.

use std::collections::VecDeque;

use super::{Deviation, Finding};

/// The permitted differences of two curves.
#[derive(Clone, Copy, Debug)]
pub struct Tolerances {
    /// In units of the trace.
    pub value: f64,
    /// In ns.
    pub time: i64,
}

/// The recorded value at a time, on the straight line between its neighbours; beyond the ends the first
/// or last value. `None` without samples. Cost: logarithmic in the samples.
pub fn at(samples: &[(i64, f64)], ns: i64) -> Option<f64> {
    let behind = samples.partition_point(|(time, _)| *time <= ns);
    let before = behind.checked_sub(1).and_then(|index| samples.get(index));
    match (before, samples.get(behind)) {
        (Some(&(t0, v0)), Some(&(t1, v1))) => {
            let part = (ns - t0) as f64 / (t1 - t0) as f64;
            Some(v0 + (v1 - v0) * part)
        }
        (Some(&(_, only)), None) | (None, Some(&(_, only))) => Some(only),
        (None, None) => None,
    }
}

/// The least and the largest value in windows that only move forward.
struct Range<'s> {
    samples: &'s [(i64, f64)],
    /// The next sample to add.
    next: usize,
    /// Candidates for the least value: times and values rise.
    low: VecDeque<(i64, f64)>,
    /// Candidates for the largest: times rise, values fall.
    high: VecDeque<(i64, f64)>,
}

impl<'s> Range<'s> {
    fn new(samples: &'s [(i64, f64)]) -> Self {
        Self {
            samples,
            next: 0,
            low: VecDeque::new(),
            high: VecDeque::new(),
        }
    }

    /// The least and the largest value of the curve from `from` to `to`, neither below those of the last
    /// call. Every sample is added and removed once, so all calls together cost as many steps as there
    /// are samples.
    fn of(&mut self, from: i64, to: i64) -> Option<(f64, f64)> {
        while let Some(&(ns, value)) = self.samples.get(self.next)
            && ns <= to
        {
            while self.low.back().is_some_and(|(_, last)| *last >= value) {
                self.low.pop_back();
            }
            while self.high.back().is_some_and(|(_, last)| *last <= value) {
                self.high.pop_back();
            }
            self.low.push_back((ns, value));
            self.high.push_back((ns, value));
            self.next += 1;
        }
        for queue in [&mut self.low, &mut self.high] {
            while queue.front().is_some_and(|(ns, _)| *ns < from) {
                queue.pop_front();
            }
        }
        let (start, end) = (at(self.samples, from)?, at(self.samples, to)?);
        let low = self.low.front().map_or(start, |(_, value)| *value);
        let high = self.high.front().map_or(start, |(_, value)| *value);
        Some((low.min(start).min(end), high.max(start).max(end)))
    }
}

/// Compares the rows of a trace with a recording. A row agrees if the curve comes within the tolerance of
/// values anywhere within the tolerance of time; `time` gives the recording's time (ns) of a scan.
pub fn compare(
    samples: &[(i64, f64)],
    rows: impl Iterator<Item = (usize, f64)>,
    tolerances: Tolerances,
    time: impl Fn(usize) -> i64,
) -> Finding {
    let mut range = Range::new(samples);
    let mut worst: Option<Deviation> = None;
    let mut first = None;
    let mut outside = 0;
    for (scan, found) in rows {
        let ns = time(scan);
        let around = range.of(
            ns.saturating_sub(tolerances.time),
            ns.saturating_add(tolerances.time),
        );
        let Some((low, high)) = around else { continue };
        // The curve takes every value between its least and its largest. NaN stays NaN, and fails below.
        let recorded = if found < low {
            low
        } else if found > high {
            high
        } else if found.is_nan() {
            at(samples, ns).unwrap_or(low)
        } else {
            found
        };
        let deviation = Deviation {
            scan,
            found,
            recorded,
        };
        let size = deviation.size();
        if worst.is_none_or(|worst| size > worst.size() || (size.is_nan() && !worst.size().is_nan())) {
            worst = Some(deviation);
        }
        if !(size <= tolerances.value) {
            outside += 1;
            first = first.or(Some(deviation));
        }
    }
    Finding::Curve {
        tolerance: tolerances.value,
        worst: worst.unwrap_or(Deviation {
            scan: 0,
            found: 0.0,
            recorded: 0.0,
        }),
        first,
        outside,
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const RAMP: [(i64, f64); 4] = [(0, 0.0), (10, 1.0), (20, -1.0), (40, 3.0)];

    #[test]
    fn between_samples_the_line_counts_and_outside_the_last_value() {
        let values = [-5, 0, 5, 15, 30, 40, 99].map(|ns| at(&RAMP, ns));
        assert_eq!(values, [0.0, 0.0, 0.5, 0.0, 1.0, 3.0, 3.0].map(Some));
        assert_eq!(at(&[], 0), None);
    }

    #[test]
    fn moving_windows_have_the_range_of_a_search_over_all_times() {
        for half in 0..15 {
            let mut range = Range::new(&RAMP);
            for middle in -10..60 {
                let times = middle - half..=middle + half;
                let all: Vec<f64> = times.map(|ns| at(&RAMP, ns).unwrap()).collect();
                let low = all.iter().copied().fold(f64::INFINITY, f64::min);
                let high = all.iter().copied().fold(f64::NEG_INFINITY, f64::max);
                assert_eq!(
                    range.of(middle - half, middle + half),
                    Some((low, high)),
                    "{middle} +- {half}"
                );
            }
        }
    }
}
