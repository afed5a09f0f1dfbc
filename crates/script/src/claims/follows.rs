//! The claim that a slave is at the position that the law of a gear gives. It is judged on published positions
//! alone, to the bit.
//!
//! The law, rounded once, is y = c + s + (num/den)(m + phase), where s is the superimposed distance. The
//! x of a row is the f64 nearest to y; of two equally near ones it is the even one. c is a number of the
//! anchor, if one is given. Otherwise the first judged row is the anchor, as far as its bits define it:
//! its x is rounded too, so c is within half a unit in the last place of it. Every row narrows the range
//! of c; if no value is left, a row is wrong. All of this uses integers ([`Exact`]), times 2 den, so
//! nothing here is rounded, and no code is shared with the code that moves the axes.
//!
//! A master with turns is unwrapped from row to row in the shorter direction, because no axis moves half a turn in
//! a scan. A slave with turns may differ from y by any whole number of them; a value that rounds to a whole turn is
//! 0 of the next one.

use super::exact::Exact;
use super::judge::{Listed, failure};
use super::place::{Stretch, within_run};
use super::{Failure, Judge, describe};
use crate::model::{AxisNumber, Condition, Follow, Range, Signal};
use crate::run::Rows;
use standstill_trace::{Cell, shortest};
use std::ops::RangeInclusive;

/// The known range of c: the least and the greatest value, both times 2 den.
#[derive(Clone, Copy)]
struct Room {
    least: Exact,
    greatest: Exact,
}

/// The law, as far as the rows define it so far.
struct Law {
    room: Room,
    /// Whole turns of the master since the begin of the law.
    turns: i64,
    /// Position of the master in the row before.
    master: f64,
}

/// The positions of the judged rows are the law's to the bit.
pub(super) struct Follows<'a> {
    during: &'a [Condition],
    follow: &'a Follow,
    /// The first scan that was not read. A row is judged once the next one exists.
    next: u64,
    /// The anchor, until it is used.
    anchor: Option<[f64; 2]>,
    law: Option<Law>,
    /// The first wrong row, the position of the slave in it, and the right position.
    first: Option<(u64, f64, String)>,
    broken: Listed,
}

impl<'a> Follows<'a> {
    pub(super) fn new(during: &'a [Condition], follow: &'a Follow) -> Self {
        Self {
            during,
            follow,
            next: 0,
            anchor: follow.anchor,
            law: None,
            first: None,
            broken: Listed::default(),
        }
    }

    /// Reads a row that has a next one.
    fn row(&mut self, rows: &Rows<'_>, scan: u64, is_judged: bool) {
        let rules = Rules {
            rows,
            follow: self.follow,
        };
        if rules.is_renamed(scan) {
            self.law = None;
        }
        let [Some(master), Some(slave)] =
            [self.follow.master, self.follow.slave].map(|axis| rows.position(axis, scan, 0))
        else {
            return;
        };
        if let Some(law) = &mut self.law {
            law.turns += rules.turns_between(law.master, master);
            law.master = master;
        }
        if !is_judged {
            return;
        }
        if !is_usual(master) || !is_usual(slave) {
            self.wrong(scan, slave, || "a number below 1e300".to_owned());
            return;
        }
        let law = self
            .law
            .get_or_insert_with(|| rules.begin(self.anchor.take(), master, slave, scan));
        match rules.narrowed(law, slave, scan) {
            Ok(room) => law.room = room,
            Err(expected) => self.wrong(scan, slave, || shortest(expected)),
        }
    }

    fn wrong(&mut self, scan: u64, slave: f64, expected: impl FnOnce() -> String) {
        self.first.get_or_insert_with(|| (scan, slave, expected()));
        self.broken.add(scan);
    }
}

impl Judge for Follows<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let Some(from) = stretch.from else { return };
        let begin = self.next.max(from);
        let deadline = stretch.deadline.map_or(u64::MAX, |scan| scan.saturating_add(1));
        let end = deadline.min(stretch.next.end.saturating_sub(1));
        let mut judged = judged(rows, begin..=end.saturating_sub(1), self.during).peekable();
        for scan in begin..end {
            let is_judged = judged.next_if_eq(&scan).is_some();
            self.row(rows, scan, is_judged);
            self.next = scan + 1;
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        if let Err(failure) = within_run(rows, path, range) {
            return vec![failure];
        }
        let Some((scan, slave, expected)) = &self.first else {
            return Vec::new();
        };
        let name = describe::axis_name(rows, self.follow.slave);
        let text = format!(
            "{} at scan {scan}, expected {expected}: {}; broken {}",
            shortest(*slave),
            describe::law(rows, self.follow),
            self.broken
        );
        vec![failure(
            &format!("{path}.follows.{name}.Position"),
            Some(*scan),
            text,
        )]
    }
}

/// The rows that are judged: `while` holds in them and in the next ones.
pub(super) fn judged<'a>(
    rows: &'a Rows<'_>,
    scans: RangeInclusive<u64>,
    during: &'a [Condition],
) -> impl Iterator<Item = u64> + 'a {
    let holds = |scan| scan < rows.count() && rows.hold(during, scan);
    let mut held = None;
    scans.filter(move |&scan| {
        let now = held.unwrap_or_else(|| holds(scan));
        let next = holds(scan + 1);
        held = Some(next);
        now && next
    })
}

/// Whether its neighbours are numbers, and their products with turns, too.
fn is_usual(position: f64) -> bool {
    position.abs() < 1e300
}

/// The rows, and the law to which they are compared.
struct Rules<'a> {
    rows: &'a Rows<'a>,
    follow: &'a Follow,
}

impl Rules<'_> {
    fn turn_of(&self, axis: usize) -> Option<f64> {
        self.rows.script.axes.get(axis)?.config.modulo
    }

    /// Whether the coordinates of either axis were shifted in this scan.
    fn is_renamed(&self, scan: u64) -> bool {
        let shifts = self.rows.shifts;
        let first = shifts.partition_point(|shift| shift.scan < scan);
        let mut there = shifts.iter().skip(first).take_while(|shift| shift.scan == scan);
        there.any(|shift| [self.follow.master, self.follow.slave].contains(&shift.axis))
    }

    /// Whole turns of the master from one row to the next.
    fn turns_between(&self, before: f64, now: f64) -> i64 {
        match self.turn_of(self.follow.master) {
            Some(turn) if now - before > turn / 2.0 => -1,
            Some(turn) if before - now > turn / 2.0 => 1,
            _ => 0,
        }
    }

    /// A number of the slave in a row.
    fn number(&self, number: AxisNumber, scan: u64) -> Exact {
        match self.rows.cell(&Signal::Axis(self.follow.slave, number), scan) {
            Some(Cell::Real(value)) if is_usual(value) => Exact::of(value),
            _ => Exact::ZERO,
        }
    }

    /// The position at which the slave sees its master, times 2 num, and the superimposed distance, times 2 den.
    fn seen(&self, law: &Law, scan: u64) -> Exact {
        let phase = self.number(AxisNumber::Phase, scan);
        let superimposed = self.number(AxisNumber::Superimposed, scan);
        let turn = self.turn_of(self.follow.master).unwrap_or(0.0);
        let seen = Exact::of(law.master) + phase + Exact::of(turn).times(law.turns);
        seen.times(2 * i64::from(self.follow.num)) + superimposed.times(2 * i64::from(self.follow.den))
    }

    /// The law from this row on. It goes through the anchor at the master position nearest to it, or through this
    /// row.
    fn begin(&self, anchor: Option<[f64; 2]>, master: f64, slave: f64, scan: u64) -> Law {
        let mut law = Law {
            room: Room {
                least: Exact::ZERO,
                greatest: Exact::ZERO,
            },
            turns: 0,
            master,
        };
        law.room = match anchor {
            Some([at, is]) => {
                if let Some(turn) = self.turn_of(self.follow.master) {
                    law.turns = nearest_whole((at - master) / turn);
                }
                let c = self.widened(Exact::of(is)) - Exact::of(at).times(2 * i64::from(self.follow.num));
                Room {
                    least: c,
                    greatest: c,
                }
            }
            None => self.room(&law, slave, 0, scan),
        };
        law
    }

    /// A number of the slave, times 2 den.
    fn widened(&self, value: Exact) -> Exact {
        value.times(2 * i64::from(self.follow.den))
    }

    /// The range of c if the law is rounded to `slave`, `turns` turns of the slave further on.
    fn room(&self, law: &Law, slave: f64, turns: i64, scan: u64) -> Room {
        let turn = self.turn_of(self.follow.slave);
        let den = i64::from(self.follow.den);
        // Twice the midpoints between it and its neighbours. A value that rounds to a whole turn is 0 of the next
        // one.
        let (below, even_below) = match turn {
            Some(turn) if slave == 0.0 => (Exact::of(turn.next_down()) - Exact::of(turn), is_even(turn)),
            _ => (Exact::of(slave.next_down()) + Exact::of(slave), is_even(slave)),
        };
        let above = Exact::of(slave) + Exact::of(slave.next_up());
        let at = self.widened(Exact::of(turn.unwrap_or(0.0)).times(turns)) - self.seen(law, scan);
        // Of two equally near values the even one is taken; c is a whole number here.
        let open = |is_even: bool| if is_even { Exact::ZERO } else { Exact::LEAST };
        Room {
            least: below.times(den) + at + open(even_below),
            greatest: above.times(den) + at - open(is_even(slave)),
        }
    }

    /// The remaining range if the law is rounded to `slave` in this row, or the right position of the slave.
    fn narrowed(&self, law: &Law, slave: f64, scan: u64) -> Result<Room, f64> {
        let target = law.room.least + self.seen(law, scan);
        let whole = 2 * u64::from(self.follow.den);
        let turn = self.turn_of(self.follow.slave);
        let turns = turn.map_or(0, |turn| nearest_whole((target.quotient(whole) - slave) / turn));
        let room = self.room(law, slave, turns, scan);
        let left = Room {
            least: room.least.max(law.room.least),
            greatest: room.greatest.min(law.room.greatest),
        };
        if left.least <= left.greatest {
            return Ok(left);
        }
        let turns = Exact::of(turn.unwrap_or(0.0)).times(turns);
        Err((target - self.widened(turns)).quotient(whole))
    }
}

fn is_even(value: f64) -> bool {
    value.to_bits() & 1 == 0
}

fn nearest_whole(turns: f64) -> i64 {
    turns.round() as i64
}
