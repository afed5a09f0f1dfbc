//! The exact companion of a golden: every bit of a trace in a small file.
//!
//! A golden text judges all bits by digest, but cannot say which one differs. The companion can. It is
//! small because signals of motion are smooth: each number is predicted from those before it, and only
//! the distance from the prediction, counted in representable numbers, is stored and deflated.
//!
//! Layout: a line of text with the version; the digest of the trace (8 bytes, least significant first: that of all
//! subjects together, in version 1 of all rows, [`digest::whole`]); then in zlib form: cycle, number of rows and
//! columns, the columns, the names, and column after column the distances. Whole numbers are LEB128, signed ones
//! zigzag. Predictions use `+ - *` on f64 in a fixed order, so the same trace gives the same bytes everywhere. A
//! new version of the compressor may pack tighter; [`crate::golden::accept`] does not change a file that has the
//! right content.

mod bytes;
mod predict;

use std::collections::BTreeMap;

use bytes::{Reader, put, put_signed, put_text};
use miniz_oxide::inflate::TINFLStatus;
pub(crate) use predict::ordered;
use predict::{EXTRAPOLATION_ORDERS, Predictor, cheapest};

use crate::column::{Cell, Column, Kind, Role};
use crate::digest;
use crate::header::{Axis, Header};
use crate::subjects::{of_all_columns, together};
use crate::trace::Trace;

/// The first bytes of a companion, with the version of its form.
const MAGIC: &[u8] = b"standstill exact 2\n";

/// The same for version 1, which is still read: only its digest differs.
const MAGIC_1: &[u8] = b"standstill exact 1\n";

/// Bytes that are enough for the cycle and the numbers of rows and columns.
const HEAD_BYTES: usize = 64;

/// Largest number of bytes of a cell: a number of 64 bits, seven a byte.
const CELL_BYTES: usize = 10;

/// Largest number of bytes of a companion beside its cells: the names of its columns, and those in them.
const NAMES_BYTES: usize = 1 << 22;

/// Number of cells that may always be unpacked, if a companion gives no other bound ..
const CELLS_FREE: usize = 1 << 22;

/// .. and how many more for each byte of the file.
const CELLS_PER_BYTE: usize = 256;

/// The reason why a companion could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExactError {
    /// It does not begin like a companion of this version.
    #[error("no exact trace of this version")]
    Foreign,
    /// It is cut short or altered.
    #[error("the exact trace is damaged")]
    Damaged,
    /// It has more cells than may be unpacked.
    #[error("the exact trace is larger than the {most} cells that are read of it")]
    TooLarge {
        /// The largest number of cells that would have been read.
        most: usize,
    },
}

/// The companion of a trace. Same trace, same bytes. Cost: some ten passes over the columns of reals.
#[must_use]
pub fn encode(trace: &Trace) -> Vec<u8> {
    let mut body = Vec::new();
    put(&mut body, trace.header().cycle_ns);
    put(&mut body, trace.scans() as u64);
    put(&mut body, trace.columns().len() as u64);
    for column in trace.columns() {
        put_text(&mut body, &column.name);
        body.extend([
            code(&KINDS, &column.kind),
            code(&ROLES, &column.role),
            u8::from(column.is_time),
        ]);
    }
    let names = names(trace);
    put(&mut body, names.len() as u64);
    let mut in_order: Vec<_> = names.iter().collect();
    in_order.sort_by_key(|(_, index)| **index);
    for (text, _) in in_order {
        put_text(&mut body, text);
    }
    let mut reals: Vec<Vec<f64>> = Vec::new();
    for (at, column) in trace.columns().iter().enumerate() {
        if column.kind == Kind::Real {
            let values: Vec<f64> = trace.reals(at).collect();
            put_reals(&mut body, &values, &reals);
            reals.push(values);
        } else {
            put_words(&mut body, trace.cells(at).map(|cell| word(cell, &names)));
        }
    }
    let mut file = MAGIC.to_vec();
    file.extend(together(&of_all_columns(trace)).to_le_bytes());
    file.extend(miniz_oxide::deflate::compress_to_vec_zlib(&body, 9));
    file
}

/// Whether a companion is of the version that [`encode`] writes.
pub(crate) fn is_current(file: &[u8]) -> bool {
    file.starts_with(MAGIC)
}

/// The digest of the trace in a companion, without unpacking it.
///
/// # Errors
/// The file is no companion, or it is cut short.
pub fn digest_of(file: &[u8]) -> Result<u64, ExactError> {
    let rest = file.strip_prefix(MAGIC).or_else(|| file.strip_prefix(MAGIC_1));
    rest.ok_or(ExactError::Foreign)?
        .first_chunk()
        .map(|bytes| u64::from_le_bytes(*bytes))
        .ok_or(ExactError::Damaged)
}

/// Unpacks a companion without its golden. Of the header only the cycle and the names of the axes are
/// known.
///
/// Memory is in proportion to the file: beyond 2^22 cells a companion may have at most 256 cells per
/// byte. Goldens are bounded by their runs instead, see [`decode_within`].
///
/// # Errors
/// The file is no companion, its content does not have the stated digest, or it would take too much memory.
pub fn decode(file: &[u8]) -> Result<Trace, ExactError> {
    decode_within(file, CELLS_FREE.max(file.len().saturating_mul(CELLS_PER_BYTE)))
}

/// Unpacks a companion with a limited number of cells, that is rows times columns. Memory: at most some 30 bytes
/// for each cell, and 4 MiB.
///
/// # Errors
/// Those of [`decode`].
pub fn decode_within(file: &[u8], most: usize) -> Result<Trace, ExactError> {
    let stated = digest_of(file)?;
    let packed = file.get(MAGIC.len() + 8..).unwrap_or_default();
    let room = most.saturating_mul(CELL_BYTES).saturating_add(NAMES_BYTES);
    // The head of the packed data gives its size, so a file with too large a size is not unpacked.
    let head = match miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(packed, HEAD_BYTES) {
        Ok(whole) => whole,
        Err(error) if error.status == TINFLStatus::HasMoreOutput => error.output,
        Err(_) => return Err(ExactError::Damaged),
    };
    let cells = Reader(&head).cells().ok_or(ExactError::Damaged)?;
    if cells > most {
        return Err(ExactError::TooLarge { most });
    }
    let body = match miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(packed, room) {
        Ok(body) => body,
        Err(error) if error.status == TINFLStatus::HasMoreOutput => {
            return Err(ExactError::TooLarge { most });
        }
        Err(_) => return Err(ExactError::Damaged),
    };
    let trace = Reader(&body).trace().ok_or(ExactError::Damaged)?;
    let found = if file.starts_with(MAGIC_1) {
        digest::whole(&trace)
    } else {
        together(&of_all_columns(&trace))
    };
    if found == stated {
        Ok(trace)
    } else {
        Err(ExactError::Damaged)
    }
}

/// The names that occur, numbered in the order in which a reader of the file meets them.
fn names(trace: &Trace) -> BTreeMap<&str, u64> {
    let mut names = BTreeMap::new();
    for at in 0..trace.columns().len() {
        for cell in trace.cells(at) {
            if let Cell::Name(text) = cell {
                let next = names.len() as u64;
                names.entry(text).or_insert(next);
            }
        }
    }
    names
}

fn word(cell: Cell<'_>, names: &BTreeMap<&str, u64>) -> u64 {
    match cell {
        Cell::Bool(value) => u64::from(value),
        Cell::Real(value) => value.to_bits(),
        Cell::Integer(value) => value.cast_unsigned(),
        Cell::Name(text) => names.get(text).copied().unwrap_or(0),
    }
}

/// Words as second differences: counters and running times become zeros.
fn put_words(body: &mut Vec<u8>, words: impl Iterator<Item = u64>) {
    let (mut last, mut step) = (0_u64, 0_u64);
    for word in words {
        let new_step = word.wrapping_sub(last);
        put_signed(body, new_step.wrapping_sub(step).cast_signed());
        (last, step) = (word, new_step);
    }
}

/// A column of reals under its cheapest predictor: the order of an extrapolation, or the number of orders
/// plus the lag and then the number of the copied column; then the distances.
fn put_reals(body: &mut Vec<u8>, values: &[f64], earlier: &[Vec<f64>]) {
    let predictor = cheapest(values, earlier);
    match predictor {
        Predictor::Extrapolation(order) => put(body, order as u64),
        Predictor::Copy { from, lag } => {
            put(body, (EXTRAPOLATION_ORDERS + lag) as u64);
            put(body, from as u64);
        }
    }
    for (scan, value) in values.iter().enumerate() {
        put_signed(
            body,
            predictor.distance(values.get(..scan).unwrap_or_default(), earlier, *value),
        );
    }
}

const KINDS: [Kind; 4] = [Kind::Bool, Kind::Real, Kind::Integer, Kind::Name];

const ROLES: [Role; 6] = [
    Role::AxisState,
    Role::AxisValue,
    Role::Variable,
    Role::InOut,
    Role::Input,
    Role::Output,
];

fn code<T: PartialEq>(all: &[T], one: &T) -> u8 {
    all.iter()
        .zip(0_u8..)
        .find(|(other, _)| *other == one)
        .map_or(u8::MAX, |(_, code)| code)
}

impl Reader<'_> {
    fn column(&mut self) -> Option<Column> {
        let name = self.text()?;
        let kind = *KINDS.get(usize::from(self.byte()?))?;
        let role = *ROLES.get(usize::from(self.byte()?))?;
        Some(Column {
            name,
            kind,
            role,
            is_time: self.byte()? != 0,
            default: None,
            named: false,
        })
    }

    /// The words of a column.
    fn words(&mut self, rows: usize) -> Option<Vec<u64>> {
        let (mut last, mut step) = (0_u64, 0_u64);
        let mut words = Vec::with_capacity(rows);
        for _ in 0..rows {
            step = step.wrapping_add(self.signed()?.cast_unsigned());
            last = last.wrapping_add(step);
            words.push(last);
        }
        Some(words)
    }

    fn reals(&mut self, rows: usize, earlier: &[Vec<f64>]) -> Option<Vec<f64>> {
        let code = usize::try_from(self.number()?).ok()?;
        let predictor = match code.checked_sub(EXTRAPOLATION_ORDERS) {
            None => Predictor::Extrapolation(code),
            Some(lag) => Predictor::Copy {
                from: usize::try_from(self.number()?).ok()?,
                lag,
            },
        };
        let mut values = Vec::with_capacity(rows);
        for _ in 0..rows {
            let distance = self.signed()?;
            values.push(predictor.at_distance(&values, earlier, distance));
        }
        Some(values)
    }

    /// Rows times columns, from the first numbers.
    fn cells(mut self) -> Option<usize> {
        let _cycle_ns = self.number()?;
        let rows = usize::try_from(self.number()?).ok()?;
        let width = usize::try_from(self.number()?).ok()?;
        rows.checked_mul(width)
    }

    fn trace(mut self) -> Option<Trace> {
        let cycle_ns = self.number()?;
        let rows = self.count()?;
        let width = self.count()?;
        let columns: Vec<Column> = std::iter::repeat_with(|| self.column())
            .take(width)
            .collect::<Option<_>>()?;
        let count = self.count()?;
        let names: Vec<String> = std::iter::repeat_with(|| self.text())
            .take(count)
            .collect::<Option<_>>()?;
        let cells = rows.checked_mul(width)?;
        // A cell takes at least a byte, so memory is not allocated for a count that the file cannot have.
        if cells > self.0.len() || (width == 0 && rows > 0) {
            return None;
        }
        let mut words: Vec<Vec<u64>> = Vec::with_capacity(width);
        let mut reals: Vec<Vec<f64>> = Vec::new();
        for column in &columns {
            if column.kind == Kind::Real {
                let values = self.reals(rows, &reals)?;
                words.push(values.iter().map(|value| value.to_bits()).collect());
                reals.push(values);
            } else {
                words.push(self.words(rows)?);
            }
        }
        drop(reals);
        let axes = columns.iter().filter(|column| column.role == Role::AxisState);
        let axes = axes
            .map(|column| Axis {
                name: column.subject().to_owned(),
                ..Axis::default()
            })
            .collect();
        let header = Header {
            cycle_ns,
            axes,
            ..Header::default()
        };
        Trace::with_words(header, columns, (rows, &words), &names)
    }
}
