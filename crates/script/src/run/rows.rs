//! Conditions on the rows of a trace.

use super::cells;
use super::formulas::Truths;
use super::layout::Layout;
use crate::model::{AxisNumber, Comparison, Condition, Point, Script, Signal, Test, Variable};
use standstill_fb::{PinType, Value};
use standstill_record::told::enum_number;
use standstill_trace::{Cell, Trace};
use std::ops::Range;

/// Rows before the next ones that conditions, claims and events may read: a difference of order 4, and
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
    /// What expressions were.
    pub(crate) truths: &'a Truths,
}

/// The coordinates of an axis moved in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(crate) struct Shift {
    pub(crate) scan: u64,
    pub(crate) axis: usize,
    /// The shift of its positions from then on (u).
    pub(crate) by: f64,
}

impl<'a> Rows<'a> {
    /// Rows there are: scans 0 to this, exclusive.
    pub(crate) fn count(&self) -> u64 {
        self.trace.scans() as u64
    }

    /// The value of a signal in a scan; `None` outside the run.
    pub(crate) fn cell(&self, signal: &Signal, scan: u64) -> Option<Cell<'a>> {
        let column = match *signal {
            Signal::Point(point) => self.layout.point(point)?,
            Signal::State(axis) => self.layout.state(axis)?,
            Signal::Master(axis, which) => self.layout.master(axis, which)?,
            Signal::Axis(axis, number) => self.layout.number(axis, number)?,
            Signal::Difference(axis, order) => {
                let [.., last] = self.differences(axis, scan, order)?;
                return Some(Cell::Real(last));
            }
            Signal::Formula(formula) => return self.truths.get(formula, scan).map(Cell::Bool),
        };
        self.trace.cell(usize::try_from(scan).ok()?, column)
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

    /// Published position of an axis (u) `back` scans before `scan`; before scan 0 it stood still where
    /// it started. `None` past the end, and before the begin of a recording, which may be in motion.
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

    /// Backward differences of published positions of this order (1 to 4) over cycle^order, one scan
    /// before `scan` and at `scan`: [before, now]. On a modulo axis they are the differences of the
    /// unwrapped positions; moves of coordinates are no motion.
    ///
    /// Subtracts neighbours `order` times instead of weighting positions with binomial coefficients:
    /// neighbours are close, so nearly every subtraction is exact.
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

    /// The difference between the position `back` scans before `scan` and the one before that. The move
    /// of coordinates in that scan is removed. On a modulo axis it is the shorter way round, because no
    /// axis goes half a turn in a scan.
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

    /// Of these scans, which are the last ones so far, those from the first to the last in which the conditions may hold
    /// together. There are no others, but it may be all that are asked for.
    ///
    /// Cost: where nothing of what a condition reads changes, one row is read.
    pub(crate) fn may_hold(&self, conditions: &[Condition], scans: Range<u64>) -> Range<u64> {
        let each = conditions.iter();
        each.fold(scans, |scans, condition| self.narrowed(condition, scans, true))
    }

    /// The same of those in which a condition may not hold.
    pub(crate) fn may_fail(&self, condition: &Condition, scans: Range<u64>) -> Range<u64> {
        self.narrowed(condition, scans, false)
    }

    /// The same of those in which it holds or does not, as `wanted`.
    fn narrowed(&self, condition: &Condition, scans: Range<u64>, wanted: bool) -> Range<u64> {
        if scans.is_empty() {
            return scans;
        }
        if self.same_since(condition) <= scans.start {
            let is_wanted = self.holds(condition, scans.start) == wanted;
            return scans.start..if is_wanted { scans.end } else { scans.start };
        }
        let (Signal::Axis(axis, number), Test::Compare(comparisons)) = (&condition.signal, &condition.test)
        else {
            return scans;
        };
        let Some(values) = self.layout.number(*axis, *number).and_then(|column| {
            let first = usize::try_from(scans.start).ok()?;
            let values = self.trace.reals_from(column, first);
            (first >= self.trace.first() && values.len() as u64 >= scans.end - scans.start).then_some(values)
        }) else {
            return scans;
        };
        if !comparisons.iter().all(Comparison::is_alone) {
            return scans;
        }
        let is_wanted = |value: &f64| {
            let meets = |comparison: &Comparison| comparison.meets(*value) == Some(true);
            comparisons.iter().all(meets) == wanted
        };
        let mut found = scans.clone().zip(values).filter(|(_, value)| is_wanted(value));
        let Some((from, _)) = found.next() else {
            return scans.start..scans.start;
        };
        let to = found.last().map_or(from, |(to, _)| to);
        from..to + 1
    }

    /// A scan from which on a condition reads the same in all rows so far; the number of rows if that is not known.
    pub(crate) fn same_since(&self, condition: &Condition) -> u64 {
        let own = self.signal_same_since(&condition.signal);
        own.max(self.test_same_since(&condition.test))
    }

    fn test_same_since(&self, test: &Test) -> u64 {
        let Test::Compare(comparisons) = test else {
            return 0;
        };
        let each = comparisons.iter().map(|comparison| match comparison {
            Comparison::SameAs(_, other) | Comparison::NearTo { of: other, .. } => {
                self.signal_same_since(other)
            }
            Comparison::Ne(test) => self.test_same_since(test),
            _ => 0,
        });
        each.max().unwrap_or(0)
    }

    /// The same for a variable or pin.
    pub(crate) fn point_same_since(&self, point: Point) -> u64 {
        self.signal_same_since(&Signal::Point(point))
    }

    fn signal_same_since(&self, signal: &Signal) -> u64 {
        let column = match *signal {
            Signal::Point(point) => self.layout.point(point),
            Signal::State(axis) => self.layout.state(axis),
            Signal::Master(axis, which) => self.layout.master(axis, which),
            Signal::Axis(axis, number) => self.layout.number(axis, number),
            // They depend on more than a row.
            Signal::Difference(..) | Signal::Formula(_) => None,
        };
        column.map_or(self.count(), |column| self.trace.same_since(column) as u64)
    }

    /// Whether all conditions hold on the row of `scan`.
    pub(crate) fn hold(&self, conditions: &[Condition], scan: u64) -> bool {
        conditions.iter().all(|condition| self.holds(condition, scan))
    }

    /// Whether a condition holds on the row of `scan`; on a row that does not exist it does not.
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
        let Signal::Point(Point::Symbol(program, symbol)) = *signal else {
            return None;
        };
        let program = self.script.programs.get(program)?;
        program.symbols.get(symbol)?.variable.as_ref()
    }

    /// Type of the pin behind a signal, if it is one.
    pub(crate) fn pin_type(&self, signal: &Signal) -> Option<PinType> {
        match *signal {
            Signal::Point(Point::Pin(instance, pin)) => {
                let instance = self.script.blocks.get(instance)?;
                instance.block.pins().nth(pin).map(|pin| pin.ty)
            }
            Signal::Point(Point::Symbol(program, symbol)) => {
                let program = self.script.programs.get(program)?;
                program.symbols.get(symbol).map(|symbol| symbol.ty)
            }
            Signal::Point(Point::Input(_) | Point::Formula(_))
            | Signal::State(_)
            | Signal::Axis(..)
            | Signal::Master(..)
            | Signal::Difference(..)
            | Signal::Formula(_) => None,
        }
    }
}

impl Comparison {
    /// Whether it is met by a number alone.
    fn is_alone(&self) -> bool {
        self.meets(0.0).is_some()
    }

    /// Whether a number meets it; none if more than the number counts.
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
