//! The rows of a run, stored as bits.

use std::collections::BTreeMap;
use std::sync::Arc;

use serde::{Deserialize, Serialize};

use crate::cells::Cells;
use crate::column::{Cell, Column, Kind, canonical_bits};
use crate::header::{CAMS_MAX, Cam, Claim, Header};
use crate::printable::{make_printable, printable};

/// An event that is no column: an accepted plan, a refused or clamped command.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Note {
    /// The scan in which it happened.
    pub scan: usize,
    /// Its axis or instance.
    pub subject: String,
    /// One line of text.
    pub text: String,
}

/// The reason why a row was refused.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum RowError {
    /// The row and the columns have different lengths.
    #[error("a row of {found} cells where the trace has {expected} columns")]
    Length {
        /// Columns of the trace.
        expected: usize,
        /// Cells of the row.
        found: usize,
    },
    /// A cell is of another kind than its column.
    #[error("column `{column}` holds {expected:?} cells, found {found:?}")]
    Kind {
        /// Name of the column.
        column: String,
        /// Its kind.
        expected: Kind,
        /// Kind of the cell.
        found: Kind,
    },
    /// A name has a line break or another control character, which no text form can have.
    #[error("column `{column}`: a name with a control character")]
    ControlCharacter {
        /// Name of the column.
        column: String,
    },
}

/// Number of rows that are assembled at once to be read one after the other.
const ROWS_AT_ONCE: usize = 16;

/// A run: its header, one row for each scan from scan 0, and its notes. All its texts are
/// [`printable`](crate::printable) and one line each, from any source.
///
/// A long run need not be held as a whole: [`Trace::forget`] drops rows that were read.
#[derive(Clone, Debug)]
pub struct Trace {
    header: Header,
    /// Shared by the traces of all cases of a sweep, with their indices.
    columns: Arc<[Column]>,
    by_name: Arc<BTreeMap<String, usize>>,
    /// The scan of the first row that is held.
    first: usize,
    /// The scan of the next row.
    end: usize,
    /// The cells of each column. The next row begins as a copy of the last one.
    cells: Vec<Cells>,
    names: Names,
    notes: Vec<Note>,
    /// Notes that were forgotten.
    notes_forgotten: usize,
}

impl Trace {
    /// An empty trace with the columns of the header.
    #[must_use]
    pub fn new(header: Header) -> Self {
        let columns = header.columns();
        Self::with_columns(header, columns)
    }

    /// An empty trace with only some columns of the header. `kept` gives their indices in `all`, the list of all
    /// columns ([`Header::columns`]).
    #[must_use]
    pub fn with_some(header: Header, all: Vec<Column>, kept: impl Fn(usize) -> bool) -> Self {
        let columns = (0..).zip(all);
        let columns = columns.filter(|(place, _)| kept(*place));
        let columns = columns.map(|(_, column)| column).collect();
        Self::with_columns(header, columns)
    }

    /// An empty trace with columns of its own: for traces that were read without their header, or with
    /// columns that this version does not know.
    pub(crate) fn with_columns(mut header: Header, mut columns: Vec<Column>) -> Self {
        // Text from outside is made printable here, where every trace begins.
        header.texts_mut().for_each(make_printable);
        columns
            .iter_mut()
            .for_each(|column| make_printable(&mut column.name));
        let places = columns.iter().enumerate();
        let by_name = places.map(|(at, column)| (column.name.clone(), at)).collect();
        Self {
            header,
            cells: columns.iter().map(|column| Cells::new(column.kind)).collect(),
            columns: columns.into(),
            by_name: Arc::new(by_name),
            first: 0,
            end: 0,
            names: Names::default(),
            notes: Vec::new(),
            notes_forgotten: 0,
        }
    }

    /// The description of the run.
    #[must_use]
    pub const fn header(&self) -> &Header {
        &self.header
    }

    /// Enters the judged claims into the header.
    pub fn set_claims(&mut self, mut claims: Vec<Claim>) {
        claims
            .iter_mut()
            .flat_map(Claim::texts_mut)
            .for_each(make_printable);
        self.header.claims = claims;
    }

    /// Adds the place of a cam from its first row on, and returns its index in the header; none if there
    /// is no room ([`CAMS_MAX`]).
    pub fn push_cam(&mut self, cam: Cam) -> Option<usize> {
        let place = self.header.cams.len();
        (place < CAMS_MAX).then(|| {
            self.header.cams.push(cam);
            place
        })
    }

    /// Extends the cam at this index of the header up to the row of `scan`: it has stayed at its position.
    pub fn cam_lay_until(&mut self, place: usize, scan: usize) {
        if let Some(cam) = self.header.cams.get_mut(place) {
            let [_, last] = &mut cam.scans;
            *last = scan;
        }
    }

    /// Takes title, units and limits from the header of another run of the same script, for a trace that was read
    /// without its own.
    pub fn describe_as(&mut self, other: &Header) {
        self.header.title.clone_from(&other.title);
        let known = other.axes.iter().map(|axis| (axis.name.as_str(), axis));
        let known: BTreeMap<_, _> = known.collect();
        for axis in &mut self.header.axes {
            if let Some(known) = known.get(axis.name.as_str()) {
                axis.clone_from(known);
            }
        }
    }

    /// The columns in file order, without `scan` and `time_ns`.
    #[must_use]
    pub fn columns(&self) -> &[Column] {
        &self.columns
    }

    /// The index of the column of this name, in the exact spelling; cost: logarithmic in the columns.
    #[must_use]
    pub fn column(&self, name: &str) -> Option<usize> {
        self.by_name.get(name).copied()
    }

    /// Number of rows: scans 0 to `scans() - 1`, including those that were forgotten.
    #[must_use]
    pub const fn scans(&self) -> usize {
        self.end
    }

    /// The first scan whose row is held; others before it were forgotten.
    #[must_use]
    pub const fn first(&self) -> usize {
        self.first
    }

    /// Drops all rows except the last `kept`, and their notes. Methods for all rows, such as
    /// [`Trace::cells`], then return those that are held.
    pub fn forget(&mut self, kept: usize) {
        let first = self.scans().saturating_sub(kept).max(self.first);
        let old = first - self.first;
        self.cells.iter_mut().for_each(|cells| cells.forget(old));
        self.first = first;
        let old = self.notes.partition_point(|note| note.scan < first);
        self.notes.drain(..old);
        self.notes_forgotten += old;
    }

    /// Drops everything that a run has added, for the next run with these columns. The memory for rows is kept.
    pub fn clear(&mut self) {
        self.header.claims.clear();
        self.header.cams.clear();
        self.cells.iter_mut().for_each(Cells::clear);
        self.names = Names::default();
        self.notes.clear();
        (self.first, self.end, self.notes_forgotten) = (0, 0, 0);
    }

    /// The number of forgotten notes, which are those of the first scans.
    pub(crate) const fn notes_forgotten(&self) -> usize {
        self.notes_forgotten
    }

    /// Time of a scan (ns): its number times the cycle, which is the `now` its blocks saw.
    #[must_use]
    pub const fn time_ns(&self, scan: usize) -> u64 {
        self.header.cycle_ns.wrapping_mul(scan as u64)
    }

    /// Makes room for `scans` more rows.
    pub fn reserve(&mut self, scans: usize) {
        let rows = self.held().saturating_add(scans);
        self.cells.iter_mut().for_each(|cells| cells.reserve(rows));
    }

    /// Appends the row of the next scan. -0.0 becomes 0.0 and every NaN the same NaN: the text forms do
    /// not distinguish them, and which NaN an operation gives differs between processors.
    ///
    /// # Errors
    /// A row of wrong length, a cell of a wrong kind, or a name with a control character; the trace is
    /// then as it was before.
    pub fn push_row(&mut self, cells: &[Cell<'_>]) -> Result<(), RowError> {
        self.push_cells(cells.iter().copied())
    }

    /// The same as [`Trace::push_row`], for cells that need not be in a list.
    ///
    /// # Errors
    /// Those of [`Trace::push_row`].
    pub fn push_cells<'c>(&mut self, cells: impl IntoIterator<Item = Cell<'c>>) -> Result<(), RowError> {
        let mut found = 0;
        let mut row = Vec::with_capacity(self.columns.len());
        for cell in cells {
            // The rest of a row that is too long is only counted.
            if let (Some(column), Some(before)) = (self.columns.get(found), self.cells.get(found)) {
                row.push(word_of(&mut self.names, column, cell, before.next())?);
            }
            found += 1;
        }
        if found != self.columns.len() {
            return Err(RowError::Length {
                expected: self.columns.len(),
                found,
            });
        }
        for (place, word) in row.into_iter().enumerate() {
            self.set_next_word(place, word);
        }
        self.push_next(1);
        Ok(())
    }

    /// Sets a cell of the next row, which begins as a copy of the last one; see [`Trace::push_next`].
    ///
    /// # Errors
    /// Those of [`Trace::push_row`]; for an index without a column, [`RowError::Length`].
    pub fn set_next(&mut self, place: usize, cell: Cell<'_>) -> Result<(), RowError> {
        let Some(column) = self.columns.get(place) else {
            return Err(RowError::Length {
                expected: self.columns.len(),
                found: place + 1,
            });
        };
        let before = self.cells.get(place).map_or(0, Cells::next);
        let word = word_of(&mut self.names, column, cell, before)?;
        self.set_next_word(place, word);
        Ok(())
    }

    /// Sets a number of the next row, as [`Trace::set_next`] does, if the column is one of reals.
    // Called in every scan by other crates.
    #[inline]
    pub fn set_next_real(&mut self, place: usize, value: f64) {
        let rows = self.held();
        if let Some(cells) = self.cells.get_mut(place) {
            cells.set_next_real(rows, value);
        }
    }

    #[inline]
    fn set_next_word(&mut self, place: usize, word: u64) {
        let rows = self.held();
        if let Some(cells) = self.cells.get_mut(place) {
            cells.set_next(rows, word);
        }
    }

    /// Number of rows that are held.
    const fn held(&self) -> usize {
        self.end - self.first
    }

    /// Appends the next row `times` times. Use it for rows with few changed cells: only these are set
    /// ([`Trace::set_next`]), and only these take time and memory.
    #[inline]
    pub fn push_next(&mut self, times: usize) {
        // A trace without columns has no rows.
        self.end += if self.cells.is_empty() { 0 } else { times };
    }

    /// Stores the cells of one column one by one up to now; call it after each row, and it takes the columns in
    /// turn. Without it, a column that has not changed is stored all at once when it changes. In a scan of a paced
    /// run that would take long.
    pub fn keep_up(&mut self) {
        let rows = self.held();
        let place = self.end.checked_rem(self.cells.len());
        if let Some(cells) = place.and_then(|place| self.cells.get_mut(place)) {
            cells.fill(rows);
        }
    }

    /// Calls `write` to put numbers into columns of reals, in the last `rows` rows. [`Trace::push_next`] must have
    /// added these rows at once. `write` receives for each column its cells in those rows, and for `None` an empty
    /// slice.
    pub fn write_last_reals<const N: usize>(
        &mut self,
        rows: usize,
        columns: &[Option<usize>; N],
        write: impl FnOnce(&mut [&mut [f64]; N]),
    ) {
        let before = self.held().saturating_sub(rows);
        let mut of_columns: [&mut [f64]; N] = std::array::from_fn(|_| [].as_mut_slice());
        for (place, cells) in self.cells.iter_mut().enumerate() {
            let mut each = columns.iter().zip(&mut of_columns);
            if let Some((_, of_column)) = each.find(|(column, _)| **column == Some(place)) {
                *of_column = cells.more_reals(before, rows);
            }
        }
        write(&mut of_columns);
        for &place in columns.iter().flatten() {
            let cells = self.cells.get_mut(place).into_iter();
            cells.for_each(|cells| cells.take_reals(before));
        }
    }

    /// A scan from which on all rows that are held have the same value in this column. The number of rows if that
    /// is not known.
    // Asked for in every scan by other crates.
    #[inline]
    #[must_use]
    pub fn same_since(&self, column: usize) -> usize {
        let cells = self.cells.get(column);
        cells.map_or(self.scans(), |cells| self.first + cells.same_from())
    }

    /// The numbers of a column of reals from a scan on, or from the first row that is held. They end before the
    /// equal ones at the end ([`Trace::same_since`]). The second result is the value of those, if there are such
    /// rows. `None` for another column.
    // Read in every scan by other crates.
    #[inline]
    #[must_use]
    pub fn reals_from(&self, column: usize, scan: usize) -> Option<(&[f64], Option<f64>)> {
        let (cells, same) = self
            .cells
            .get(column)?
            .reals_from(scan.saturating_sub(self.first))?;
        Some((cells, self.has_same(column, scan).then_some(same)))
    }

    /// The same for a column of BOOLs.
    #[inline]
    #[must_use]
    pub fn bools_from(&self, column: usize, scan: usize) -> Option<(&[bool], Option<bool>)> {
        let (cells, same) = self
            .cells
            .get(column)?
            .bools_from(scan.saturating_sub(self.first))?;
        Some((cells, self.has_same(column, scan).then_some(same)))
    }

    /// Whether there are rows from a scan on that have the same value in this column as all later ones.
    fn has_same(&self, column: usize, scan: usize) -> bool {
        self.same_since(column).max(scan) < self.scans()
    }

    /// Whether any of these columns has another value in a scan than in the one before. In the first scan all have.
    pub(crate) fn moves(&self, scan: usize, columns: &[usize]) -> bool {
        let Some(before) = scan.checked_sub(1) else {
            return true;
        };
        let may_move = |at: &&usize| self.same_since(**at) >= scan;
        let mut columns = columns.iter().filter(may_move);
        columns.any(|&at| self.word(before, at) != self.word(scan, at))
    }

    /// The value of a column in a scan; `None` outside the trace.
    // Asked for in every scan by other crates.
    #[inline]
    #[must_use]
    pub fn cell(&self, scan: usize, column: usize) -> Option<Cell<'_>> {
        let kind = self.columns.get(column)?.kind;
        Some(self.decode(kind, self.word(scan, column)?))
    }

    /// The stored word of a column in a scan; `None` outside the trace.
    pub(crate) fn word(&self, scan: usize, column: usize) -> Option<u64> {
        let row = scan.checked_sub(self.first).filter(|row| *row < self.held())?;
        self.cells.get(column).map(|cells| cells.word(row))
    }

    /// The cells of a scan in column order; none outside the trace.
    pub fn row(&self, scan: usize) -> impl Iterator<Item = Cell<'_>> {
        (0..self.columns.len()).map_while(move |column| self.cell(scan, column))
    }

    /// The cells of a column from scan 0 on; none if there is no such column.
    pub fn cells(&self, column: usize) -> impl Iterator<Item = Cell<'_>> {
        (self.first..self.end).map_while(move |scan| self.cell(scan, column))
    }

    /// The numbers of a column of reals from scan 0 on; none for another column.
    pub fn reals(&self, column: usize) -> impl Iterator<Item = f64> {
        self.cells(column).filter_map(|cell| match cell {
            Cell::Real(value) => Some(value),
            Cell::Bool(_) | Cell::Integer(_) | Cell::Name(_) => None,
        })
    }

    /// The header as [`Header::to_json`] writes it, with the notes: the text before the rows of a file.
    #[must_use]
    pub fn header_json(&self) -> String {
        self.header.json_with_notes(&self.notes)
    }

    /// Notes in the order of their scans; those of one scan as they were made.
    #[must_use]
    pub fn notes(&self) -> &[Note] {
        &self.notes
    }

    /// Adds a note. Notes are shown among the events; files carry them in their header.
    pub fn push_note(&mut self, mut note: Note) {
        make_printable(&mut note.subject);
        make_printable(&mut note.text);
        // Behind the last note of its scan; usually that is the end.
        let place = self.notes.partition_point(|known| known.scan <= note.scan);
        self.notes.insert(place, note);
    }

    /// A trace of given columns, one word a cell as [`Trace::decode`] reads it; words of names are indices
    /// into `names`. `None` if a name is missing or cannot be in a row.
    pub(crate) fn with_words(
        header: Header,
        columns: Vec<Column>,
        (rows, words): (usize, &[Vec<u64>]),
        names: &[String],
    ) -> Option<Self> {
        if names.iter().any(|name| name.chars().any(char::is_control)) {
            return None;
        }
        let mut trace = Self::with_columns(header, columns);
        trace.end = rows;
        let indices: Vec<u64> = names.iter().map(|name| trace.names.index(name)).collect();
        for ((column, cells), words) in trace.columns.iter().zip(&mut trace.cells).zip(words) {
            for (row, &word) in words.iter().take(rows).enumerate() {
                let word = match column.kind {
                    Kind::Name => *indices.get(usize::try_from(word).ok()?)?,
                    kind => in_order(kind, word),
                };
                cells.set_next(row, word);
            }
        }
        Some(trace)
    }

    /// Calls `take` with each row from a scan on as stored: a word for each cell; for a name its index in
    /// [`Trace::names`].
    pub(crate) fn each_row(&self, scan: usize, mut take: impl FnMut(&[u64])) {
        let width = self.columns.len().max(1);
        let mut block = vec![0; ROWS_AT_ONCE * width];
        let mut from = scan.saturating_sub(self.first);
        let mut before = None;
        while from < self.held() {
            for (place, cells) in self.cells.iter().enumerate() {
                // Otherwise the value is the same in all rows, as in the rows before.
                if before.is_none_or(|before| cells.same_from() > before) {
                    cells.put(from, block.iter_mut().skip(place).step_by(width));
                }
            }
            let rows = (self.held() - from).min(ROWS_AT_ONCE);
            block.chunks_exact(width).take(rows).for_each(&mut take);
            before = Some(from);
            from += rows;
        }
    }

    /// The name of a word.
    pub(crate) fn text(&self, word: u64) -> &str {
        self.names.text(word)
    }

    /// Takes the rows out, row after row, a word a cell: a BOOL is 0 or 1, a number its bits, a whole
    /// number itself, a name its index in [`Trace::names`]. The trace is then empty; [`Trace::put_words`]
    /// returns them.
    #[must_use]
    pub fn take_words(&mut self) -> Vec<u64> {
        let mut words = Vec::with_capacity(self.held() * self.columns.len());
        self.each_row(self.first, |row| words.extend_from_slice(row));
        self.cells = self
            .columns
            .iter()
            .map(|column| Cells::new(column.kind))
            .collect();
        self.end = self.first;
        words
    }

    /// Returns the rows that [`Trace::take_words`] took; an incomplete row at the end is dropped.
    pub fn put_words(&mut self, words: &[u64]) {
        for row in words.chunks_exact(self.columns.len().max(1)) {
            for (place, (column, &word)) in self.columns.iter().zip(row).enumerate() {
                let word = in_order(column.kind, word);
                if let Some(cells) = self.cells.get_mut(place) {
                    cells.set_next(self.end - self.first, word);
                }
            }
            self.push_next(1);
        }
    }

    /// The names that occur in rows.
    #[must_use]
    pub fn names(&self) -> &[String] {
        &self.names.texts
    }

    /// The meaning of a word in a column of this kind.
    pub(crate) fn decode(&self, kind: Kind, word: u64) -> Cell<'_> {
        match kind {
            Kind::Bool => Cell::Bool(word != 0),
            Kind::Real => Cell::Real(f64::from_bits(word)),
            Kind::Integer => Cell::Integer(word.cast_signed()),
            Kind::Name => Cell::Name(self.names.text(word)),
        }
    }
}

/// The word of a column's kind: of a BOOL 0 or 1, of a number without the sign of zero.
fn in_order(kind: Kind, word: u64) -> u64 {
    match kind {
        Kind::Bool => u64::from(word != 0),
        Kind::Real => canonical_bits(f64::from_bits(word)),
        Kind::Integer | Kind::Name => word,
    }
}

/// The word under which a row stores a cell of this column; `before` is that of the row before.
fn word_of(names: &mut Names, column: &Column, cell: Cell<'_>, before: u64) -> Result<u64, RowError> {
    if cell.kind() != column.kind {
        return Err(RowError::Kind {
            column: column.name.clone(),
            expected: column.kind,
            found: cell.kind(),
        });
    }
    match cell {
        Cell::Bool(value) => Ok(u64::from(value)),
        Cell::Real(value) => Ok(canonical_bits(value)),
        Cell::Integer(value) => Ok(value.cast_unsigned()),
        // Most names stay from row to row.
        Cell::Name(text) if names.is(before, text) => Ok(before),
        Cell::Name(text) if text.chars().any(char::is_control) => Err(RowError::ControlCharacter {
            column: column.name.clone(),
        }),
        Cell::Name(text) => Ok(names.index(text)),
    }
}

/// The words that occur, each once.
#[derive(Clone, Debug, Default)]
struct Names {
    texts: Vec<String>,
    /// As they were given.
    given: Vec<String>,
    by_text: BTreeMap<String, u64>,
}

impl Names {
    fn index(&mut self, text: &str) -> u64 {
        if let Some(&index) = self.by_text.get(text) {
            return index;
        }
        let index = self.texts.len() as u64;
        self.texts.push(printable(text).into_owned());
        self.given.push(text.to_owned());
        self.by_text.insert(text.to_owned(), index);
        index
    }

    /// Whether [`Names::index`] returns this index for a text. Most names stay from row to row, and then
    /// no search is needed.
    fn is(&self, index: u64, text: &str) -> bool {
        let given = usize::try_from(index).ok().and_then(|at| self.given.get(at));
        given.is_some_and(|given| given == text)
    }

    fn text(&self, index: u64) -> &str {
        usize::try_from(index)
            .ok()
            .and_then(|at| self.texts.get(at))
            .map_or("", String::as_str)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::header::{Axis, Input};

    fn small() -> Trace {
        Trace::new(Header {
            cycle_ns: 1_000_000,
            inputs: vec![
                Input {
                    name: "GO".into(),
                    iec_type: "BOOL".into(),
                },
                Input {
                    name: "v".into(),
                    iec_type: "LREAL".into(),
                },
                Input {
                    name: "mode".into(),
                    iec_type: "MC_BUFFER_MODE".into(),
                },
            ],
            ..Header::default()
        })
    }

    #[test]
    fn columns_follow_the_order_of_the_format() {
        let header = Header {
            axes: vec![Axis {
                name: "X".into(),
                ..Axis::default()
            }],
            inputs: vec![Input {
                name: "GO".into(),
                iec_type: "BOOL".into(),
            }],
            ..Header::default()
        };
        let names: Vec<_> = header.columns().into_iter().map(|column| column.name).collect();
        let expected = [
            "X.State",
            "X.Position",
            "X.Velocity",
            "X.Acceleration",
            "X.Jerk",
            "X.Snap",
            "X.ActualPosition",
            "GO",
        ];
        assert_eq!(names, expected);
    }

    #[test]
    fn a_row_comes_back_as_it_was_pushed() {
        let mut trace = small();
        let row = [Cell::Bool(true), Cell::Real(1.5), Cell::Name("mcBuffered")];
        trace.push_row(&row).expect("the row fits");
        assert_eq!(trace.scans(), 1);
        assert_eq!(trace.row(0).collect::<Vec<_>>(), row);
        assert_eq!(trace.cell(0, 2), Some(Cell::Name("mcBuffered")));
        assert_eq!(trace.cell(1, 0), None);
        assert_eq!(trace.cell(0, 3), None);
        assert_eq!(trace.row(1).count(), 0);
        assert_eq!(trace.row(usize::MAX).count(), 0);
        assert_eq!(trace.cell(usize::MAX, 1), None);
    }

    #[test]
    fn a_name_that_stays_is_the_same_one_and_does_not_move() {
        let mut trace = small();
        let hidden = "b\u{202e}";
        let names = ["a", "a", hidden, hidden, "a"];
        for name in names {
            trace
                .push_row(&[Cell::Bool(false), Cell::Real(f64::NAN), Cell::Name(name)])
                .expect("the row fits");
        }
        assert_eq!(trace.names(), ["a", &*printable(hidden)]);
        let told: Vec<_> = trace.cells(2).collect();
        assert_eq!(
            told,
            names.map(|name| Cell::Name(trace.names()[usize::from(name == hidden)].as_str()))
        );
        let moves = |columns: &[usize]| (0..5).map(|scan| trace.moves(scan, columns)).collect::<Vec<_>>();
        assert_eq!(moves(&[0, 2]), [true, false, true, false, true]);
        assert_eq!(moves(&[0, 1]), [true, false, false, false, false]);
    }

    #[test]
    fn numbers_in_the_last_rows_are_as_if_they_were_set_row_by_row() {
        let (mut by_row, mut at_once) = (small(), small());
        for numbers in [
            [1.0, 1.0, 3.0],
            [-0.0, 2.5, 2.5],
            [2.5, 2.5, 2.5],
            [2.5, 0.0, 2.5],
        ] {
            for number in numbers {
                by_row.set_next_real(1, number);
                by_row.push_next(1);
            }
            at_once.push_next(numbers.len());
            at_once.write_last_reals(numbers.len(), &[None, Some(1)], |[none, places]| {
                assert!(none.is_empty());
                places.copy_from_slice(&numbers);
            });
            assert_eq!(by_row.same_since(1), at_once.same_since(1));
        }
        by_row.push_next(1);
        at_once.push_next(1);
        assert_eq!(at_once.scans(), 13);
        assert_eq!(at_once.take_words(), by_row.take_words());
    }

    #[test]
    fn zero_has_no_sign_and_nan_no_payload() {
        let mut trace = small();
        for value in [-0.0, f64::from_bits(0xfff8_0000_0000_0001), f64::NEG_INFINITY] {
            trace
                .push_row(&[Cell::Bool(false), Cell::Real(value), Cell::Name("")])
                .expect("the row fits");
        }
        let bits: Vec<_> = trace.reals(1).map(f64::to_bits).collect();
        assert_eq!(bits, [0, 0x7ff8_0000_0000_0000, 0xfff0_0000_0000_0000]);
    }

    #[test]
    fn a_wrong_row_is_refused_and_leaves_the_trace_alone() {
        let mut trace = small();
        let short = trace.push_row(&[Cell::Bool(true)]);
        assert_eq!(
            short,
            Err(RowError::Length {
                expected: 3,
                found: 1
            })
        );
        let kind = trace.push_row(&[Cell::Bool(true), Cell::Integer(1), Cell::Name("")]);
        assert!(matches!(kind, Err(RowError::Kind { column, .. }) if column == "v"));
        let control = trace.push_row(&[Cell::Bool(true), Cell::Real(1.0), Cell::Name("a\nb")]);
        assert!(matches!(control, Err(RowError::ControlCharacter { .. })));
        assert_eq!(trace.scans(), 0);
    }
}
