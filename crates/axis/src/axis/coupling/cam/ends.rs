//! Ends of a cam: told once each time one is reached, whichever way, and nothing is told twice where a master trembles there.

use standstill_planner::{Cam, CamAt};

/// An end that was told is told again only after the slave was this part of the period away from it.
const AWAY: f64 = 0.25;

/// A place so near to an end is on it, relative to the period or to the places of both ends.
const ROUNDING: f64 = 1e-12;

/// What became of the ends of a cam so far.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Ends {
    /// The place at the end of the scan before.
    before: Option<(i64, f64)>,
    /// The end told last, or the one it began at, while the slave is near it.
    told: Option<i64>,
    /// Without periods: it has been between its first and its last row, and it has come to an end.
    has_begun: bool,
    is_over: bool,
}

/// What a scan brought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Passed {
    /// So many ends were reached.
    pub ends: u32,
    /// The end reached last: so many periods lie before it.
    pub end: i64,
    /// It was reached with the cam running forwards.
    pub forwards: bool,
}

impl Ends {
    /// The slave is to be on the curve, or was.
    pub fn has_begun(&self) -> bool {
        self.has_begun
    }

    /// A cam without periods has come to its end.
    pub fn is_over(&self) -> bool {
        self.is_over
    }

    /// The slave is called so many periods further on, and has not moved.
    pub fn renumber(&mut self, periods: i64) {
        if let Some((before, _)) = &mut self.before {
            *before = before.saturating_add(periods);
        }
        self.told = self.told.map(|told| told.saturating_add(periods));
    }

    /// The slave is `at` this place of the curve now.
    pub fn note(&mut self, cam: &Cam<'_>, at: &CamAt) -> Option<Passed> {
        let head = cam.head;
        let length = head.end - head.begin;
        let way = at.x - head.begin;
        let Some((periods, before)) = self.before else {
            self.before = Some((at.periods, way));
            self.has_begun = head.periodic || at.periods == 0;
            self.told = near_end(at.periods, way / length);
            return None;
        };
        self.before = Some((at.periods, way));
        if self.is_over {
            return None;
        }
        if let Some(told) = self.told {
            let from = (at.periods - told) as f64 + way / length;
            if from.abs() >= AWAY && (head.periodic || at.periods == 0) {
                self.told = None;
            }
        }
        let passed = if at.periods > periods {
            let first = periods.saturating_add(1);
            self.passed(first, at.periods, true)
        } else if at.periods < periods {
            let last = at.periods.saturating_add(1);
            // Where it stood on that end before it was reached already.
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
        if head.periodic {
            let passed = self.tell(passed);
            // In a long step it went far enough away from it.
            let is_away = |told: &mut i64| ((at.periods - *told) as f64 + way / length).abs() >= AWAY;
            self.told.take_if(is_away);
            return passed;
        }
        let had_begun = self.has_begun;
        // On its first or last row but for rounding it has not begun yet.
        let rounding = ROUNDING * (head.begin.abs() + head.end.abs());
        self.has_begun |= at.periods == 0 && way > rounding && length - way > rounding;
        let passed = passed.filter(|passed| had_begun && (passed.end == 1) == passed.forwards);
        self.is_over = passed.is_some();
        self.tell(passed)
    }

    /// Ends from the first to the last, but for one that was told and not left since.
    fn passed(&mut self, first: i64, last: i64, forwards: bool) -> Option<Passed> {
        let all = last.abs_diff(first).saturating_add(1);
        let told = u64::from(self.told == Some(first));
        let ends = u32::try_from(all.saturating_sub(told)).unwrap_or(u32::MAX);
        (ends > 0).then_some(Passed {
            ends,
            end: last,
            forwards,
        })
    }

    fn tell(&mut self, passed: Option<Passed>) -> Option<Passed> {
        let passed = passed?;
        self.told = Some(passed.end);
        Some(passed)
    }
}

/// The end next to a place, so many periods and this share of one from the first.
fn near_end(periods: i64, share: f64) -> Option<i64> {
    if share < AWAY {
        Some(periods)
    } else if share > 1.0 - AWAY {
        Some(periods.saturating_add(1)).filter(|_| share >= 1.0 - ROUNDING)
    } else {
        None
    }
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
        // It began at the first row: that is no end that was reached.
        assert_eq!(pulses(&down, true), [(10, 1), (20, 1), (30, 1)]);
        // There and back, over an end and exactly onto one.
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
        // It begins when the master comes in, from whichever side.
        assert_eq!(pulses(&[-50.0, -10.0, 5.0, 99.0, 100.0], false), [(4, 1)]);
        assert_eq!(pulses(&[150.0, 110.0, 99.0, 1.0, -3.0], false), [(4, 1)]);
        assert_eq!(pulses(&[0.0, -10.0, 5.0, 120.0], false), [(3, 1)]);
    }
}
