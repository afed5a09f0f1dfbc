//! The cells of a column, as wide as its kind needs.

use crate::column::{Kind, canonical_bits};

/// The cells of a column in the rows that are held. Cells at the end that are equal to the next one take no memory,
/// so a column that does not change costs nothing.
///
/// A cell is stored as a word: a BOOL is 0 or 1, a number its bits, a whole number itself, a name its index.
#[derive(Clone, Debug)]
pub(crate) struct Cells {
    /// The first cells, up to the last one that differs from the next one.
    first: First,
    /// The word of all cells behind them, and of the next row.
    next: u64,
}

#[derive(Clone, Debug)]
enum First {
    Bool(Vec<bool>),
    Real(Vec<f64>),
    Integer(Vec<i64>),
    Name(Vec<u32>),
}

/// Runs the same code for cells of any width; `$of_word` converts a word to a cell of `$cells`.
macro_rules! each {
    ($first:expr, $cells:ident, $of_word:ident => $code:expr) => {
        match $first {
            First::Bool($cells) => {
                let $of_word = |word: u64| word != 0;
                $code
            }
            First::Real($cells) => {
                let $of_word = f64::from_bits;
                $code
            }
            First::Integer($cells) => {
                let $of_word = u64::cast_signed;
                $code
            }
            First::Name($cells) => {
                // The memory cannot hold more names than that.
                let $of_word = |word: u64| u32::try_from(word).unwrap_or(u32::MAX);
                $code
            }
        }
    };
}

impl Cells {
    pub(crate) const fn new(kind: Kind) -> Self {
        Self {
            first: match kind {
                Kind::Bool => First::Bool(Vec::new()),
                Kind::Real => First::Real(Vec::new()),
                Kind::Integer => First::Integer(Vec::new()),
                Kind::Name => First::Name(Vec::new()),
            },
            next: 0,
        }
    }

    /// The row from which on all rows have the same word.
    #[inline]
    pub(crate) fn same_from(&self) -> usize {
        each!(&self.first, cells, _word => cells.len())
    }

    /// The word of the next row.
    pub(crate) const fn next(&self) -> u64 {
        self.next
    }

    /// The word of a row.
    #[inline]
    pub(crate) fn word(&self, row: usize) -> u64 {
        let word = match &self.first {
            First::Bool(cells) => cells.get(row).map(|cell| u64::from(*cell)),
            First::Real(cells) => cells.get(row).map(|cell| cell.to_bits()),
            First::Integer(cells) => cells.get(row).map(|cell| cell.cast_unsigned()),
            First::Name(cells) => cells.get(row).map(|cell| u64::from(*cell)),
        };
        word.unwrap_or(self.next)
    }

    /// Writes the words of the rows from `row` on to `to`.
    pub(crate) fn put<'w>(&self, row: usize, to: impl Iterator<Item = &'w mut u64>) {
        fn all<'w, T: Copy>(
            (cells, row, next): (&[T], usize, u64),
            to: impl Iterator<Item = &'w mut u64>,
            word: impl Fn(T) -> u64,
        ) {
            let cells = cells.get(row..).unwrap_or_default().iter();
            let words = cells.map(|cell| word(*cell)).chain(std::iter::repeat(next));
            to.zip(words).for_each(|(to, word)| *to = word);
        }
        let next = self.next;
        match &self.first {
            First::Bool(cells) => all((cells, row, next), to, u64::from),
            First::Real(cells) => all((cells, row, next), to, f64::to_bits),
            First::Integer(cells) => all((cells, row, next), to, i64::cast_unsigned),
            First::Name(cells) => all((cells, row, next), to, u64::from),
        }
    }

    /// The numbers from a row on, up to the equal ones at the end, and the value of those. `None` for a column of
    /// another kind.
    #[inline]
    pub(crate) fn reals_from(&self, row: usize) -> Option<(&[f64], f64)> {
        match &self.first {
            First::Real(cells) => Some((cells.get(row..).unwrap_or_default(), f64::from_bits(self.next))),
            _ => None,
        }
    }

    /// The same for BOOLs.
    #[inline]
    pub(crate) fn bools_from(&self, row: usize) -> Option<(&[bool], bool)> {
        match &self.first {
            First::Bool(cells) => Some((cells.get(row..).unwrap_or_default(), self.next != 0)),
            _ => None,
        }
    }

    /// Sets the word of the next row, which is behind `rows` rows.
    #[inline]
    pub(crate) fn set_next(&mut self, rows: usize, word: u64) {
        if self.next == word {
            return;
        }
        self.fill(rows);
        self.next = word;
    }

    /// The same for a number, in a column of reals.
    #[inline]
    pub(crate) fn set_next_real(&mut self, rows: usize, value: f64) {
        let (word, before) = (canonical_bits(value), self.next);
        if let First::Real(cells) = &mut self.first
            && word != before
        {
            self.next = word;
            if cells.len() + 1 == rows {
                cells.push(f64::from_bits(before));
            } else {
                self.fill_with(rows, before);
            }
        }
    }

    /// Stores the cells of the first `rows` rows one by one.
    pub(crate) fn fill(&mut self, rows: usize) {
        self.fill_with(rows, self.next);
    }

    #[inline(never)]
    fn fill_with(&mut self, rows: usize, word: u64) {
        each!(&mut self.first, cells, of_word => {
            if cells.len() < rows {
                cells.resize(rows, of_word(word));
            }
        });
    }

    /// Makes room for the numbers of `more` rows behind the first `rows`; nothing for a column of another kind.
    /// After [`Cells::take_reals`] the next row begins with the last of these numbers.
    pub(crate) fn more_reals(&mut self, rows: usize, more: usize) -> &mut [f64] {
        self.fill(rows);
        match &mut self.first {
            First::Real(cells) => {
                cells.resize(rows + more, 0.0);
                cells.get_mut(rows..).unwrap_or_default()
            }
            _ => &mut [],
        }
    }

    /// Call it after the numbers of the rows from `row` on were written. The last of them becomes that of the next
    /// row, and equal ones at the end are dropped.
    pub(crate) fn take_reals(&mut self, row: usize) {
        let First::Real(cells) = &mut self.first else {
            return;
        };
        for cell in cells.get_mut(row..).unwrap_or_default() {
            *cell = f64::from_bits(canonical_bits(*cell));
        }
        let Some(last) = cells.last().map(|last| last.to_bits()) else {
            return;
        };
        let kept = cells.iter().rposition(|cell| cell.to_bits() != last);
        cells.truncate(kept.map_or(0, |last| last + 1));
        self.next = last;
    }

    /// Drops the cells of the first `rows` rows.
    pub(crate) fn forget(&mut self, rows: usize) {
        each!(&mut self.first, cells, _word => drop(cells.drain(..rows.min(cells.len()))));
    }

    /// Drops all cells and keeps their memory.
    pub(crate) fn clear(&mut self) {
        each!(&mut self.first, cells, _word => cells.clear());
        self.next = 0;
    }

    /// Reserves memory for `rows` rows.
    pub(crate) fn reserve(&mut self, rows: usize) {
        each!(&mut self.first, cells, _word => cells.reserve(rows.saturating_sub(cells.len())));
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const KINDS: [Kind; 4] = [Kind::Bool, Kind::Real, Kind::Integer, Kind::Name];

    #[test]
    fn words_come_back_and_those_that_stay_take_no_memory() {
        for kind in KINDS {
            let mut cells = Cells::new(kind);
            let words = [0, 0, 1, 1, 1, 0, 1, 1];
            for (row, word) in words.into_iter().enumerate() {
                cells.set_next(row, word);
            }
            // The equal cells at the end begin with row 6.
            assert_eq!(cells.same_from(), 6);
            let found: Vec<u64> = (0..10).map(|row| cells.word(row)).collect();
            assert_eq!(found, [0, 0, 1, 1, 1, 0, 1, 1, 1, 1]);
            let mut put = [7; 6];
            cells.put(4, put.iter_mut());
            assert_eq!(put, [1, 0, 1, 1, 1, 1]);
            cells.fill(8);
            cells.forget(5);
            assert_eq!((cells.same_from(), cells.word(0), cells.word(5)), (3, 0, 1));
            cells.forget(100);
            assert_eq!((cells.same_from(), cells.word(0)), (0, 1));
        }
    }

    #[test]
    fn a_cell_is_as_wide_as_its_kind_needs() {
        let bytes = KINDS.map(|kind| {
            let mut cells = Cells::new(kind);
            cells.fill(1000);
            each!(&cells.first, cells, _word => size_of_val(cells.as_slice()))
        });
        assert_eq!(bytes, [1000, 8000, 8000, 4000]);
    }
}
