//! Conditions on the rows of a trace.

use super::cells;
use super::formulas::Truths;
use super::layout::Layout;
use crate::model::{AxisNumber, Comparison, Condition, Point, Script, Signal, Test, Variable};
use standstill_fb::{PinType, Value};
use standstill_record::told::enum_number;
use standstill_trace::{Cell, Trace};
use std::ops::Range;

/// Number of rows before the next ones that conditions, claims and events may read: a difference of order 4, and
/// that of the last scan, take six.
pub(super) const ROWS_KEPT: usize = 8;

/// The rows of a run so far, reached by a script's signals.
#[derive(Clone, Copy)]
pub(crate) struct Rows<'a> {
    pub(crate) script: &'a Script,
    pub(crate) layout: &'a Layout,
    pub(crate) trace: &'a Trace,
    /// In order of scans.
    pub(crate) shifts: &'a [Shift],
    /// The results of expressions.
    pub(crate) truths: &'a Truths,
}

/// A shift of the coordinates of an axis in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    pub(crate) scan: u64,
    pub(crate) axis: usize,
    /// The shift of its positions from then on (u).
    pub(crate) by: f64,
}

impl<'a> Rows<'a> {
    /// The number of rows: scans 0 to this, exclusive.
    pub(crate) fn count(&self) -> u64 {
        self.trace.scans() as u64
    }

    /// The value of a signal in a scan; `None` outside the run.
    pub(crate) fn cell(&self, signal: &Signal, scan: u64) -> Option<Cell<'a>> {
        match *signal {
            Signal::Difference(axis, order) => {
                let [.., last] = self.differences(axis, scan, order)?;
                Some(Cell::Real(last))
            }
            Signal::Formula(formula) => self.truths.get(formula, scan).map(Cell::Bool),
            _ => {
                let column = self.layout.column(signal)?;
                self.trace.cell(usize::try_from(scan).ok()?, column)
            }
        }
    }

    /// Whether a scan is too near to the begin of a recording for the value of a signal, because the
    /// value needs earlier rows.
    pub(crate) fn too_early(&self, signal: &Signal, scan: u64) -> bool {
        match *signal {
            Signal::Difference(_, order) => self.layout.is_of_recording() && scan <= order.into(),
            Signal::Point(_)
            | Signal::State(_)
            | Signal::Axis(..)
            | Signal::Master(..)
            | Signal::Formula(_) => false,
        }
    }

    /// Published position of an axis (u) `back` scans before `scan`. Before scan 0 the axis was at rest at its
    /// start. `None` past the end, and before the begin of a recording, which may be in motion.
    pub(crate) fn position(&self, axis: usize, scan: u64, back: u64) -> Option<f64> {
        let Some(scan) = scan.checked_sub(back) else {
            if self.layout.is_of_recording() {
                return None;
            }
            return Some(self.script.axes.get(axis)?.config.position);
        };
        let column = self.layout.number(axis, AxisNumber::Position)?;
        match self.trace.cell(usize::try_from(scan).ok()?, column)? {
            Cell::Real(position) => Some(position),
            Cell::Bool(_) | Cell::Integer(_) | Cell::Name(_) => None,
        }
    }

    /// Backward differences of published positions of this order (1 to 4) over cycle^order, one scan before `scan`
    /// and at `scan`: [before, now]. On a modulo axis they are the differences of the unwrapped positions. Shifts
    /// of coordinates are no motion.
    ///
    /// Subtracts neighbours `order` times instead of weighting positions with binomial coefficients: neighbours are
    /// close, so nearly every subtraction is exact.
    fn differences(&self, axis: usize, scan: u64, order: u8) -> Option<[f64; 2]> {
        let order = usize::from(order);
        // Newest first; order + 2 positions have order + 1 first differences and give two of the last.
        let mut values = [0.0; 5];
        let used = values.get_mut(..=order)?;
        let mut newer = self.position(axis, scan, 0)?;
        for (back, value) in (1..).zip(used.iter_mut()) {
            let older = self.position(axis, scan, back)?;
            *value = self.way(axis, scan + 1, back, newer - older);
            newer = older;
        }
        let cycle = self.script.cycle_ns as f64 / 1e9;
        let mut unit = cycle;
        for length in (1..order).map(|done| order + 1 - done) {
            unit *= cycle;
            for index in 0..length {
                if let [newer, older] = &mut used[index..index + 2] {
                    *newer -= *older;
                }
            }
        }
        match used {
            [now, before, ..] => Some([*before / unit, *now / unit]),
            _ => None,
        }
    }

    /// The difference between the position `back` scans before `scan` and the one before that. A shift of
    /// coordinates in that scan is removed. On a modulo axis the shorter direction is taken, because no axis moves
    /// half a turn in a scan.
    pub(crate) fn way(&self, axis: usize, scan: u64, back: u64, difference: f64) -> f64 {
        let mut difference = difference;
        if let Some(scan) = scan.checked_sub(back) {
            let first = self.shifts.partition_point(|shift| shift.scan < scan);
            let there = self.shifts.get(first..).unwrap_or(&[]).iter();
            for shift in there.take_while(|shift| shift.scan == scan) {
                if shift.axis == axis {
                    difference -= shift.by;
                }
            }
        }
        let Some(turn) = self.script.axes.get(axis).and_then(|axis| axis.config.modulo) else {
            return difference;
        };
        if difference.abs() <= turn / 2.0 {
            return difference;
        }
        let difference = difference.rem_euclid(turn);
        if difference > turn / 2.0 {
            difference - turn
        } else {
            difference
        }
    }

    /// [`Rows::differences`] of orders 1 to 4, and the first one a scan earlier.
    pub(crate) fn derivatives(&self, axis: usize, scan: u64) -> Option<Derivatives> {
        let [velocity_before, velocity] = self.differences(axis, scan, 1)?;
        let now = |order| self.differences(axis, scan, order).map(|[_, now]| now);
        Some(Derivatives {
            velocity_before,
            orders: [velocity, now(2)?, now(3)?, now(4)?],
        })
    }

    /// The part of `scans` in which the conditions may hold together, from the first such scan to the last; `scans`
    /// are the last ones so far. The conditions hold in no other scan, but the result may be the whole of `scans`.
    ///
    /// Cost: if nothing that a condition reads has changed, one row is read.
    pub(crate) fn may_hold(&self, conditions: &[Condition], scans: Range<u64>) -> Range<u64> {
        let each = conditions.iter();
        each.fold(scans, |scans, condition| self.narrowed(condition, scans, true))
    }

    /// The same for the scans in which a condition may not hold.
    pub(crate) fn may_fail(&self, condition: &Condition, scans: Range<u64>) -> Range<u64> {
        self.narrowed(condition, scans, false)
    }

    /// The same for the scans in which it holds, or does not hold, as `wanted` says.
    fn narrowed(&self, condition: &Condition, scans: Range<u64>, wanted: bool) -> Range<u64> {
        if scans.is_empty() {
            return scans;
        }
        if self.same_since(condition) <= scans.start {
            let is_wanted = self.holds(condition, scans.start) == wanted;
            return scans.start..if is_wanted { scans.end } else { scans.start };
        }
        let first = usize::try_from(scans.start).unwrap_or(usize::MAX);
        let are_last = first >= self.trace.first() && scans.end == self.count();
        let column = self.layout.column(&condition.signal).filter(|_| are_last);
        match (&condition.test, column) {
            (Test::Bool(value), Some(column)) => match self.trace.bools_from(column, first) {
                Some(values) => between(scans, values, |found| (found == *value) == wanted),
                None => scans,
            },
            (Test::Compare(comparisons), Some(column)) => {
                let values = self.trace.reals_from(column, first);
                match values.zip(Comparison::bounds(comparisons)) {
                    Some((values, (least, most))) => between(scans, values, |found| {
                        ((least <= found) & (found <= most)) == wanted
                    }),
                    None => scans,
                }
            }
            _ => scans,
        }
    }

    /// A scan from which on a condition reads the same in all rows so far. The number of rows if that is not known.
    pub(crate) fn same_since(&self, condition: &Condition) -> u64 {
        let each = condition.signals().map(|signal| self.signal_same_since(signal));
        each.max().unwrap_or(0)
    }

    /// The same for a variable or pin.
    pub(crate) fn point_same_since(&self, point: Point) -> u64 {
        self.signal_same_since(&Signal::Point(point))
    }

    fn signal_same_since(&self, signal: &Signal) -> u64 {
        let column = self.layout.column(signal);
        column.map_or(self.count(), |column| self.trace.same_since(column) as u64)
    }

    /// Whether all conditions hold on the row of `scan`.
    pub(crate) fn hold(&self, conditions: &[Condition], scan: u64) -> bool {
        conditions.iter().all(|condition| self.holds(condition, scan))
    }

    /// Whether a condition holds on the row of `scan`; FALSE for a row that does not exist.
    pub(crate) fn holds(&self, condition: &Condition, scan: u64) -> bool {
        self.cell(&condition.signal, scan)
            .is_some_and(|cell| self.meets(&condition.signal, &condition.test, cell, scan))
    }

    fn meets(&self, signal: &Signal, test: &Test, cell: Cell<'_>, scan: u64) -> bool {
        match test {
            Test::Bool(wanted) => cell == Cell::Bool(*wanted),
            Test::State(wanted) => cell == Cell::Name(wanted.name()),
            Test::Exactly(wanted) => match (cell, self.pin_type(signal)) {
                (Cell::Name(name), Some(PinType::Enum(info))) => {
                    enum_number(&info, name).is_some_and(|number| f64::from(number) == *wanted)
                }
                _ => number(cell).is_some_and(|value| same(value, *wanted)),
            },
            Test::Named(wanted) => {
                let Cell::Name(name) = cell else {
                    return false;
                };
                // A value with a name is compared without making its text.
                match (*wanted, self.pin_type(signal)) {
                    (Value::Enum(number), Some(PinType::Enum(info))) if info.name_of(number).is_some() => {
                        info.name_of(number) == Some(name)
                    }
                    (Value::Axis(id), _) => {
                        let axis = self.script.axes.get(id.index());
                        name == axis.map_or("", |axis| axis.name.as_str())
                    }
                    (wanted, ty) => name == cells::value_text(self.script, ty, wanted),
                }
            }
            Test::Word(wanted) => cell == Cell::Name(wanted),
            Test::Compare(comparisons) => comparisons
                .iter()
                .all(|comparison| self.compares(signal, comparison, cell, scan)),
        }
    }

    fn compares(&self, signal: &Signal, comparison: &Comparison, cell: Cell<'_>, scan: u64) -> bool {
        match comparison {
            Comparison::NearTo { of, plus, within, .. } => {
                let other = self.cell(of, scan).and_then(number).map(|other| other + plus);
                let near = other.map(|near| Comparison::Near {
                    near,
                    within: *within,
                });
                near.is_some_and(|near| number(cell).and_then(|value| near.meets(value)) == Some(true))
            }
            Comparison::Ne(test) => !self.meets(signal, test, cell, scan),
            Comparison::SameAs(_, other) => match self.cell(other, scan) {
                Some(other) => match (number(cell), number(other)) {
                    (Some(one), Some(other)) => same(one, other),
                    _ => cell == other,
                },
                None => false,
            },
            Comparison::Whole(relation, bound) => {
                let whole = self.variable(signal).and_then(|variable| variable.whole_in(cell));
                whole.is_some_and(|whole| relation.holds(whole, *bound))
            }
            Comparison::Near { .. }
            | Comparison::Le(_)
            | Comparison::Ge(_)
            | Comparison::Lt(_)
            | Comparison::Gt(_)
            | Comparison::AbsLe(_) => number(cell).and_then(|value| comparison.meets(value)) == Some(true),
        }
    }

    /// The variable of Structured Text behind a signal, if it is one.
    fn variable(&self, signal: &Signal) -> Option<&'a Variable> {
        match *signal {
            Signal::Point(point) => self.script.variable(point),
            _ => None,
        }
    }

    /// Type of the pin behind a signal, if it is one.
    pub(crate) fn pin_type(&self, signal: &Signal) -> Option<PinType> {
        match *signal {
            Signal::Point(point) => self.script.type_of(point),
            _ => None,
        }
    }
}

impl Comparison {
    /// The least and the greatest number that meet all of these. None if they depend on more than the number.
    fn bounds(all: &[Self]) -> Option<(f64, f64)> {
        let mut both = (f64::NEG_INFINITY, f64::INFINITY);
        for comparison in all {
            let (least, most) = match *comparison {
                Self::Le(bound) => (f64::NEG_INFINITY, bound),
                Self::Ge(bound) => (bound, f64::INFINITY),
                Self::AbsLe(bound) => (-bound, bound),
                Self::Lt(bound) if bound.is_finite() => (f64::NEG_INFINITY, bound.next_down()),
                Self::Gt(bound) if bound.is_finite() => (bound.next_up(), f64::INFINITY),
                _ => return None,
            };
            if least.is_nan() || most.is_nan() {
                return None;
            }
            both = (both.0.max(least), both.1.min(most));
        }
        Some(both)
    }

    /// Whether a number meets it. None if it depends on more than the number.
    fn meets(&self, value: f64) -> Option<bool> {
        Some(match self {
            // Equal infinities have no difference.
            Self::Near { near, within } => value == *near || (value - near).abs() <= *within,
            Self::Le(bound) => value <= *bound,
            Self::Ge(bound) => value >= *bound,
            Self::Lt(bound) => value < *bound,
            Self::Gt(bound) => value > *bound,
            Self::AbsLe(bound) => value.abs() <= *bound,
            Self::NearTo { .. } | Self::Ne(_) | Self::SameAs(..) | Self::Whole(..) => return None,
        })
    }
}

/// The part of `scans` from the first to the last wanted value. The values are those from the first scan on up to
/// the equal ones at the end, and the value of those.
fn between<T: Copy>(
    scans: Range<u64>,
    (values, same): (&[T], Option<T>),
    is_wanted: impl Fn(T) -> bool,
) -> Range<u64> {
    let is_wanted = |value: &T| is_wanted(*value);
    let behind = scans.start + values.len() as u64;
    // Without an early exit the processor compares several at once.
    let is_there = values.iter().fold(false, |found, value| found | is_wanted(value));
    let same = same.filter(is_wanted).map(|_| behind..scans.end);
    let Some(first) = values.iter().position(&is_wanted).filter(|_| is_there) else {
        return same.unwrap_or(scans.start..scans.start);
    };
    let last = values.iter().rposition(is_wanted).unwrap_or(first);
    let end = same.map_or(scans.start + last as u64 + 1, |same| same.end);
    scans.start + first as u64..end
}

/// Backward differences of an axis in one scan.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Derivatives {
    /// The first one, a scan earlier (u/s).
    pub(crate) velocity_before: f64,
    /// Velocity, acceleration, jerk, snap (u/s .. u/s^4).
    pub(crate) orders: [f64; 4],
}

fn number(cell: Cell<'_>) -> Option<f64> {
    match cell {
        Cell::Real(value) => Some(value),
        // Exact up to 2^53: TIME up to 104 days, and every other integer pin.
        Cell::Integer(value) => Some(value as f64),
        Cell::Bool(_) | Cell::Name(_) => None,
    }
}

/// The same bits, except for the sign of zero and the payload of NaN, which a trace does not store.
fn same(one: f64, other: f64) -> bool {
    one == other || (one.is_nan() && other.is_nan())
}

#[cfg(test)]
mod tests {
    use super::Comparison;

    #[test]
    fn a_number_within_the_bounds_meets_the_comparison_and_no_other_does() {
        let numbers = [
            0.0,
            1.0,
            1e-320,
            1e30,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::INFINITY,
            f64::NAN,
        ];
        let numbers = numbers.into_iter().flat_map(|number: f64| {
            let beside = [number.next_down(), number, number.next_up()];
            beside.into_iter().flat_map(|number| [number, -number])
        });
        let numbers: Vec<f64> = numbers.collect();
        let mut told = 0;
        for &bound in &numbers {
            let kinds: [fn(f64) -> Comparison; 5] = [
                Comparison::Le,
                Comparison::Ge,
                Comparison::Lt,
                Comparison::Gt,
                Comparison::AbsLe,
            ];
            for comparison in kinds.map(|kind| kind(bound)) {
                let Some((least, most)) = Comparison::bounds(std::slice::from_ref(&comparison)) else {
                    continue;
                };
                told += 1;
                for &number in &numbers {
                    let is_within = least <= number && number <= most;
                    assert_eq!(
                        Some(is_within),
                        comparison.meets(number),
                        "{comparison:?} of {number:?}"
                    );
                }
            }
        }
        assert!(told > 3 * numbers.len(), "{told}");
    }
}
