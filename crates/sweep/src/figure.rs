//! The figures of measures, taken while rows come.

use standstill_script::sweep::{Measure, Take};
use standstill_trace::{Cell, Trace, cell_text};

/// The figure of a measure so far.
pub(crate) struct Figure {
    take: Take,
    /// The signal's column; none if the run has no such signal.
    column: Option<usize>,
    /// Scans looked at.
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

    /// Reads the rows that the trace has got since the last call.
    pub(crate) fn look(&mut self, trace: &Trace) {
        let Some(column) = self.column else { return };
        for scan in self.scans..trace.scans() {
            let Some(cell) = trace.cell(scan, column) else {
                continue;
            };
            match (self.take, cell) {
                (Take::First | Take::Count, Cell::Bool(true)) => {
                    self.first.get_or_insert(scan);
                    self.count += 1;
                }
                (Take::Max, cell) => self.rank(cell, |value| value),
                (Take::Min, cell) => self.rank(cell, |value| -value),
                (Take::AbsMax, cell) => self.rank(magnitude(cell), |value| value),
                (Take::Last | Take::First | Take::Count, _) => {}
            }
        }
        self.scans = trace.scans();
        let last = self
            .scans
            .checked_sub(1)
            .and_then(|scan| trace.cell(scan, column));
        self.last = last.map(cell_text).unwrap_or_default();
    }

    /// A NaN ranks before all, so that it is not overlooked.
    fn rank(&mut self, cell: Cell<'_>, rank: impl Fn(f64) -> f64) {
        let (value, cell) = match cell {
            Cell::Real(value) => (rank(value), Cell::Real(value)),
            Cell::Integer(value) => (rank(value as f64), Cell::Integer(value)),
            Cell::Bool(_) | Cell::Name(_) => return,
        };
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

fn magnitude(cell: Cell<'_>) -> Cell<'_> {
    match cell {
        Cell::Real(value) => Cell::Real(value.abs()),
        Cell::Integer(value) => Cell::Integer(value.saturating_abs()),
        other => other,
    }
}
