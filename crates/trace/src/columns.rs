//! Traces with fewer or more columns than another one.

use std::collections::BTreeSet;

use crate::column::Column;
use crate::subjects::counted;
use crate::trace::Trace;

impl Trace {
    /// The same run with only the columns at these indices, in this order; other indices are skipped. From then on
    /// all of them count, with any values.
    pub(crate) fn only(&self, places: &[usize]) -> Self {
        let kept = places.iter().filter_map(|&at| self.columns().get(at).cloned());
        let kept = kept.map(|column| Column {
            default: None,
            named: false,
            ..column
        });
        let mut only = Self::with_columns(self.header().clone(), kept.collect());
        only.reserve(self.scans());
        for scan in 0..self.scans() {
            let cells = places.iter().filter_map(|&at| self.cell(scan, at));
            // The cells are those of the columns, and were taken once before.
            let _taken = only.push_cells(cells);
        }
        for note in self.notes() {
            only.push_note(note.clone());
        }
        only
    }

    /// The run with only the columns that count: the part that a golden keeps.
    pub(crate) fn only_counted(&self) -> Self {
        self.only(&counted(self))
    }

    /// The inverse for a run stored with only its counting columns: adds the columns that `run` has
    /// besides, at their defaults, and the defaults that `run` gives. Columns of subjects that it does
    /// not have are not added, unless they count in neither.
    pub(crate) fn completed_as(self, run: &Self) -> Self {
        let own = self.columns().iter().map(|column| {
            let other = run.column(&column.name).and_then(|at| run.columns().get(at));
            Column {
                default: other.and_then(|other| other.default.clone()),
                named: other.is_some_and(|other| other.named),
                ..column.clone()
            }
        });
        let subjects: BTreeSet<&str> = self.columns().iter().map(Column::subject).collect();
        let counts: BTreeSet<usize> = counted(run).into_iter().collect();
        let added: Vec<&Column> = run
            .columns()
            .iter()
            .enumerate()
            .filter(|(at, column)| {
                let known = subjects.contains(column.subject()) || !counts.contains(at);
                known && self.column(&column.name).is_none() && column.default_cell().is_some()
            })
            .map(|(_, column)| column)
            .collect();
        // If a pin is named now and kept its default in the stored run, it was not named then.
        let unnamed = added.iter().map(|column| Column {
            named: false,
            ..(*column).clone()
        });
        let columns = own.chain(unnamed).collect();
        let mut whole = Self::with_columns(self.header().clone(), columns);
        whole.reserve(self.scans());
        for scan in 0..self.scans() {
            let defaults = added.iter().filter_map(|column| column.default_cell());
            // Each cell belongs to its column: it is its own, or a default that was read as a value of
            // that kind.
            let _taken = whole.push_cells(self.row(scan).chain(defaults));
        }
        for note in self.notes() {
            whole.push_note(note.clone());
        }
        whole
    }
}
