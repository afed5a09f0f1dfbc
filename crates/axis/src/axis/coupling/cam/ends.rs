//! Ends of a cam. Each end reached is reported once, in either direction. A master that trembles at an end causes no
//! further reports.

use standstill_planner::{Cam, CamAt};

/// A reported end is reported again only after the slave was this part of the period away from it.
const AWAY: f64 = 0.25;

/// The same for the end at which it began, which was never reported.
const OFF: f64 = 0.01;

/// A place this near to an end counts as on it, relative to the period or to the positions of both ends.
const ROUNDING: f64 = 1e-12;

/// The state of the ends of a cam.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ends {
    /// The place at the end of the last scan.
    before: Option<(i64, f64)>,
    /// The end reported last, or the one at which it began, while the slave is near it.
    told: Option<Told>,
    /// Without periods: it has been between its first and its last row, and it has reached an end.
    has_begun: bool,
    is_over: bool,
}

/// An end that is not reported now.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Told {
    /// The number of periods before it.
    end: i64,
    /// It may be reported once the slave was this part of the period away from it.
    away: f64,
}

impl Told {
    /// Whether the slave, at this share of this period, is far enough away.
    fn is_left(&self, periods: i64, share: f64) -> bool {
        ((periods - self.end) as f64 + share).abs() >= self.away
    }
}

/// The result of a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    /// The number of ends reached.
    pub ends: u32,
    /// The end reached last: the number of periods before it.
    pub end: i64,
    /// It was reached with the cam running forwards.
    pub forwards: bool,
}

impl Ends {
    /// The slave has been on the curve, or has to be from now on.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// A cam without periods has come to its end.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// Adds this number of periods to the place of the slave, which has not moved.
    pub fn renumber(&mut self, periods: i64) {
        if let Some((before, _)) = &mut self.before {
            *before = before.saturating_add(periods);
        }
        if let Some(told) = &mut self.told {
            told.end = told.end.saturating_add(periods);
        }
    }

    /// Notes that the slave is `at` this place of the curve now.
    pub fn note(&mut self, cam: &Cam<'_>, at: &CamAt) -> Option<Passed> {
        let head = cam.head;
        let length = head.end - head.begin;
        let way = at.x - head.begin;
        let Some((periods, before)) = self.before else {
            self.before = Some((at.periods, way));
            self.has_begun = head.periodic || at.periods == 0;
            self.told = begun_at(at.periods, way / length);
            return None;
        };
        self.before = Some((at.periods, way));
        if self.is_over {
            return None;
        }
        let mut passed = if at.periods > periods {
            let first = periods.saturating_add(1);
            self.passed(first, at.periods, true)
        } else if at.periods < periods {
            let last = at.periods.saturating_add(1);
            // If it was on that end before, the end was reached already.
            let first = if before == 0.0 {
                periods.saturating_sub(1)
            } else {
                periods
            };
            (first >= last).then(|| self.passed(first, last, false)).flatten()
        } else if way == 0.0 && before > 0.0 {
            self.passed(at.periods, at.periods, false)
        } else {
            None
        };
        if !head.periodic {
            passed.take_if(|passed| !self.has_begun || (passed.end == 1) != passed.forwards);
            // On its first or last row, except for rounding, it has not begun yet.
            let rounding = ROUNDING * (head.begin.abs() + head.end.abs());
            self.has_begun |= at.periods == 0 && way > rounding && length - way > rounding;
            self.is_over = passed.is_some();
        }
        if let Some(passed) = &passed {
            self.told = Some(Told {
                end: passed.end,
                away: AWAY,
            });
        }
        if head.periodic || at.periods == 0 {
            self.told.take_if(|told| told.is_left(at.periods, way / length));
        }
        passed
    }

    /// The ends from the first to the last, except for one that was reported and not left since.
    fn passed(&mut self, first: i64, last: i64, forwards: bool) -> Option<Passed> {
        let all = last.abs_diff(first).saturating_add(1);
        let told = u64::from(self.told.is_some_and(|told| told.end == first));
        let ends = u32::try_from(all.saturating_sub(told)).unwrap_or(u32::MAX);
        (ends > 0).then_some(Passed {
            ends,
            end: last,
            forwards,
        })
    }
}

/// The end at a place that is this number of periods and this share of one after the first row.
fn begun_at(periods: i64, share: f64) -> Option<Told> {
    let end = if share <= ROUNDING {
        periods
    } else if share >= 1.0 - ROUNDING {
        periods.saturating_add(1)
    } else {
        return None;
    };
    Some(Told { end, away: OFF })
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_planner::CamHead;

    /// The pulses along places of a cam from 0 to 100.
    fn pulses(places: &[f64], periodic: bool) -> std::vec::Vec<(usize, u32)> {
        let head = CamHead {
            begin: 0.0,
            end: 100.0,
            periodic,
            ..CamHead::default()
        };
        let cam = Cam {
            head: &head,
            pieces: &[],
        };
        let mut ends = Ends::default();
        let mut found = std::vec::Vec::new();
        for (step, place) in places.iter().enumerate() {
            let at = |periods: i64, x: f64| CamAt {
                periods,
                x,
                ..CamAt::default()
            };
            let whole = (place / 100.0).floor();
            let at = match periodic {
                true => at(whole as i64, place - whole * 100.0),
                false if *place < 0.0 => at(-1, 0.0),
                false if *place >= 100.0 => at(1, 100.0),
                false => at(0, *place),
            };
            if let Some(passed) = ends.note(&cam, &at) {
                found.push((step, passed.ends));
            }
        }
        found
    }

    /// Covers: G67
    #[test]
    fn each_end_is_told_once_forwards_and_backwards() {
        let up: std::vec::Vec<f64> = (0..=35).map(|step| f64::from(step) * 10.0).collect();
        assert_eq!(pulses(&up, true), [(10, 1), (20, 1), (30, 1)]);
        let down: std::vec::Vec<f64> = (0..=35).map(|step| f64::from(step) * -10.0).collect();
        // It began at the first row, so that end was not reached.
        assert_eq!(pulses(&down, true), [(10, 1), (20, 1), (30, 1)]);
        // Forward and back, over an end and exactly onto one.
        assert_eq!(
            pulses(&[50.0, 90.0, 110.0, 150.0, 110.0, 90.0], true),
            [(2, 1), (5, 1)]
        );
        assert_eq!(
            pulses(&[50.0, 150.0, 100.0, 100.0, 90.0, 60.0, 100.0], true),
            [(1, 1), (2, 1), (6, 1)]
        );
    }

    /// Covers: G70
    #[test]
    fn where_it_begins_on_an_end_but_for_rounding_that_is_no_end_reached() {
        let near = 100.0 - 1e-13;
        assert_eq!(pulses(&[near, 100.0, near, 50.0, -1.0], false), [(4, 1)]);
        assert_eq!(pulses(&[near, 100.0, near, 50.0, 101.0], true), [(4, 1)]);
        assert_eq!(pulses(&[-1.0, 1e-14, -1e-14, 50.0, 101.0], false), [(4, 1)]);
    }

    /// Covers: G67, G70
    #[test]
    fn an_end_that_it_begins_at_is_reached_as_any_other_once_it_was_left() {
        assert_eq!(pulses(&[0.0, 22.0, 3.0, -1.0], true), [(3, 1)]);
        assert_eq!(pulses(&[0.0, 22.0, 3.0, -1.0], false), [(3, 1)]);
        // It does not begin on the first row.
        assert_eq!(pulses(&[20.0, 3.0, -1.0], true), [(2, 1)]);
        assert_eq!(pulses(&[20.0, 3.0, -1.0], false), [(2, 1)]);
        assert_eq!(pulses(&[0.0, 0.5, -0.5, 0.5, -0.5, 0.0], true), []);
        assert_eq!(pulses(&[0.0, 0.5, -0.5, 0.5, -0.5, 50.0], false), []);
        // Over it, except for rounding, in a long step.
        assert_eq!(pulses(&[100.0 - 1e-13, 110.0, 160.0], true), []);
    }

    /// Covers: G68
    #[test]
    fn a_master_that_trembles_on_an_end_tells_it_once() {
        let tremble = [
            50.0, 99.9, 100.1, 99.9, 100.1, 100.0, 99.9, 100.1, 120.0, 99.0, 101.0,
        ];
        assert_eq!(pulses(&tremble, true), [(2, 1)]);
    }

    #[test]
    fn several_ends_in_a_scan_are_one_pulse_with_their_number() {
        assert_eq!(pulses(&[50.0, 450.0, 60.0], true), [(1, 4), (2, 4)]);
    }

    /// Covers: G70
    #[test]
    fn without_periods_there_is_one_end() {
        assert_eq!(pulses(&[0.0, 50.0, 101.0, 50.0, -5.0, 101.0], false), [(2, 1)]);
        assert_eq!(pulses(&[50.0, 10.0, -5.0, 50.0, 120.0], false), [(2, 1)]);
        assert_eq!(pulses(&[50.0, 0.0, 50.0, 120.0], false), [(1, 1)]);
        // It begins when the master enters, from either side.
        assert_eq!(pulses(&[-50.0, -10.0, 5.0, 99.0, 100.0], false), [(4, 1)]);
        assert_eq!(pulses(&[150.0, 110.0, 99.0, 1.0, -3.0], false), [(4, 1)]);
        assert_eq!(pulses(&[0.0, -10.0, 5.0, 120.0], false), [(3, 1)]);
    }
}
