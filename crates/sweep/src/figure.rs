//! The figures of measures, taken as rows arrive.

use standstill_script::sweep::{Measure, Take};
use standstill_trace::{Cell, Trace, cell_text, greatest};

/// The figure of a measure so far.
pub(crate) struct Figure {
    take: Take,
    /// The signal's column; none if the run has no such signal.
    column: Option<usize>,
    /// Number of scans that were read.
    scans: usize,
    /// The last cell as text.
    last: String,
    /// The number that ranks first, and its rank.
    best: Option<(f64, Cell<'static>)>,
    /// The first scan in which it is TRUE, and the number of such scans.
    first: Option<usize>,
    count: usize,
}

impl Figure {
    pub(crate) fn new(measure: &Measure, trace: &Trace) -> Self {
        Self {
            take: measure.take,
            column: trace.column(&measure.signal),
            scans: 0,
            last: String::new(),
            best: None,
            first: None,
            count: 0,
        }
    }

    /// Reads the rows that the trace has received since the last call.
    pub(crate) fn look(&mut self, trace: &Trace) {
        let Some(column) = self.column else { return };
        let next = self.scans..trace.scans();
        self.scans = next.end;
        match self.take {
            Take::Last => self.last = last(trace, column).map(cell_text).unwrap_or_default(),
            Take::First | Take::Count => {
                let Some((flags, then)) = trace.bools_from(column, next.start) else {
                    return;
                };
                if let Some(first) = flags.iter().position(|flag| *flag) {
                    self.first.get_or_insert(next.start + first);
                    self.count += flags.iter().filter(|flag| **flag).count();
                }
                if then == Some(true) {
                    self.first.get_or_insert(next.start + flags.len());
                    self.count += next.len() - flags.len();
                }
            }
            Take::Max | Take::Min | Take::AbsMax => match trace.reals_from(column, next.start) {
                Some((numbers, then)) => {
                    let first = match self.take {
                        Take::Min => greatest(numbers, |number| -number).map(|least| -least),
                        Take::AbsMax => greatest(numbers, f64::abs),
                        _ => greatest(numbers, |number| number),
                    };
                    first
                        .into_iter()
                        .chain(then)
                        .for_each(|number| self.rank(Cell::Real(number)));
                }
                // A column of whole numbers.
                None => (next.start..next.end.min(trace.same_since(column).saturating_add(1)))
                    .filter_map(|scan| trace.cell(scan, column))
                    .for_each(|cell| self.rank(cell)),
            },
        }
    }

    /// A NaN ranks before all, so that it is not missed.
    fn rank(&mut self, cell: Cell<'_>) {
        let (value, cell) = match if self.take == Take::AbsMax {
            magnitude(cell)
        } else {
            cell
        } {
            Cell::Real(value) => (value, Cell::Real(value)),
            Cell::Integer(value) => (value as f64, Cell::Integer(value)),
            Cell::Bool(_) | Cell::Name(_) => return,
        };
        let value = if self.take == Take::Min { -value } else { value };
        let beaten = |(best, _): (f64, Cell<'_>)| !best.is_nan() && (value.is_nan() || value > best);
        if self.best.is_none_or(beaten) {
            self.best = Some((value, cell));
        }
    }

    /// In the form of a table; empty if a signal never was TRUE.
    pub(crate) fn text(&self) -> String {
        match self.take {
            _ if self.column.is_none() => String::new(),
            Take::Last => self.last.clone(),
            Take::Max | Take::Min | Take::AbsMax => {
                self.best.map(|(_, cell)| cell_text(cell)).unwrap_or_default()
            }
            Take::First => self.first.map(|scan| scan.to_string()).unwrap_or_default(),
            Take::Count => self.count.to_string(),
        }
    }
}

/// The cell of the last row.
fn last(trace: &Trace, column: usize) -> Option<Cell<'_>> {
    trace.cell(trace.scans().checked_sub(1)?, column)
}

fn magnitude(cell: Cell<'_>) -> Cell<'_> {
    match cell {
        Cell::Real(value) => Cell::Real(value.abs()),
        Cell::Integer(value) => Cell::Integer(value.saturating_abs()),
        other => other,
    }
}
