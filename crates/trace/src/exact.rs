//! The exact companion of a golden: every bit of a trace in a small file.
//!
//! A golden text judges all bits by digest, but cannot say which one differs. The companion can, and is
//! small because signals of motion are smooth: each number is predicted from the ones before it, and only
//! the distance between prediction and truth, counted in representable numbers, is kept and deflated.
//!
//! Layout: [`MAGIC`], then the digest of the trace (8 bytes, least significant first), then in zlib form: cycle,
//! number of rows and columns, the columns, the names, and column after column the distances. Whole
//! numbers are LEB128, signed ones zigzag. Predictions use `+ - *` on f64 in a fixed order, so the same
//! trace gives the same bytes everywhere.

use std::collections::BTreeMap;

use crate::digest;
use crate::header::{Axis, Header};
use crate::trace::{Cell, Column, Kind, Role, Trace, canonical_bits};

/// The first bytes of a companion, with the version of its form.
const MAGIC: &[u8] = b"standstill exact 1\n";

/// More than this a companion cannot unpack to (bytes): a guard against damaged files.
const UNPACKED_MAX: usize = 1 << 30;

/// Coefficients of the extrapolations of order 0 to 6, last value first: a polynomial through as many
/// values as the order, continued by one step (the binomials with alternating signs).
const EXTRAPOLATIONS: [&[f64]; 7] = [
    &[],
    &[1.0],
    &[2.0, -1.0],
    &[3.0, -3.0, 1.0],
    &[4.0, -6.0, 4.0, -1.0],
    &[5.0, -10.0, 10.0, -5.0, 1.0],
    &[6.0, -15.0, 20.0, -15.0, 6.0, -1.0],
];

/// Up to so many scans back an earlier column may be what this one repeats (feedback of an ideal drive).
const LAG_MAX: usize = 3;

/// Why a companion could not be read.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ExactError {
    /// It does not begin as a companion of this version does.
    #[error("no exact trace of this version")]
    Foreign,
    /// It is cut short or altered.
    #[error("the exact trace is damaged")]
    Damaged,
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
    file.extend(digest::whole(trace).to_le_bytes());
    file.extend(miniz_oxide::deflate::compress_to_vec_zlib(&body, 9));
    file
}

/// The digest of the trace in a companion, without unpacking it.
///
/// # Errors
/// Another file, or one cut short.
pub fn digest_of(file: &[u8]) -> Result<u64, ExactError> {
    let rest = file.strip_prefix(MAGIC).ok_or(ExactError::Foreign)?;
    rest.first_chunk()
        .map(|bytes| u64::from_le_bytes(*bytes))
        .ok_or(ExactError::Damaged)
}

/// Unpacks a companion. Of the header only the cycle and the names of the axes are known.
///
/// # Errors
/// Another file, or one whose content does not have the digest it states.
pub fn decode(file: &[u8]) -> Result<Trace, ExactError> {
    let stated = digest_of(file)?;
    let packed = file.get(MAGIC.len() + 8..).unwrap_or_default();
    let body = miniz_oxide::inflate::decompress_to_vec_zlib_with_limit(packed, UNPACKED_MAX)
        .map_err(|_| ExactError::Damaged)?;
    let trace = Reader(&body).trace().ok_or(ExactError::Damaged)?;
    if digest::whole(&trace) == stated {
        Ok(trace)
    } else {
        Err(ExactError::Damaged)
    }
}

/// The names that occur, numbered in the order a reader of the file meets them.
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

/// Words as differences of their differences: counters and running times become zeros.
fn put_words(body: &mut Vec<u8>, words: impl Iterator<Item = u64>) {
    let (mut last, mut step) = (0_u64, 0_u64);
    for word in words {
        let new_step = word.wrapping_sub(last);
        put_signed(body, new_step.wrapping_sub(step).cast_signed());
        (last, step) = (word, new_step);
    }
}

/// How a column of reals is predicted.
#[derive(Clone, Copy)]
enum Predictor<'a> {
    /// By the polynomial through so many of its own last values.
    Extrapolation(usize),
    /// By an earlier column, so many scans ago.
    Copy { values: &'a [f64], lag: usize },
}

impl Predictor<'_> {
    /// The next value of a column that so far holds `own`.
    fn predict(self, own: &[f64]) -> f64 {
        let prediction = match self {
            Self::Extrapolation(order) => {
                let coefficients = EXTRAPOLATIONS
                    .get(order.min(own.len()))
                    .copied()
                    .unwrap_or_default();
                let terms = own.iter().rev().zip(coefficients);
                terms.fold(0.0, |sum, (value, coefficient)| sum + value * coefficient)
            }
            Self::Copy { values, lag } => {
                let source = own.len().checked_sub(lag).and_then(|at| values.get(at));
                source.copied().unwrap_or(0.0)
            }
        };
        // An overflow is no use, and which NaN it gives differs between processors.
        if prediction.is_finite() {
            prediction
        } else {
            own.last().copied().unwrap_or(0.0)
        }
    }

    /// How far the value is from its prediction, in representable numbers.
    fn distance(self, own: &[f64], value: f64) -> i64 {
        ordered(value).wrapping_sub(ordered(self.predict(own)))
    }

    /// The value at this distance from its prediction.
    fn at_distance(self, own: &[f64], distance: i64) -> f64 {
        from_ordered(ordered(self.predict(own)).wrapping_add(distance))
    }

    /// The bytes a column takes under this predictor, or `None` as soon as they reach `bound`.
    fn cost(self, values: &[f64], bound: usize) -> Option<usize> {
        let mut cost = 0;
        for (scan, value) in values.iter().enumerate() {
            cost += len_signed(self.distance(values.get(..scan)?, *value));
            if cost >= bound {
                return None;
            }
        }
        Some(cost)
    }
}

/// A column of reals under its cheapest predictor, found by trying all. The predictor is written as its
/// order, or as the number of extrapolations plus the lag and then the column it copies.
fn put_reals(body: &mut Vec<u8>, values: &[f64], earlier: &[Vec<f64>]) {
    let extrapolations = (0..EXTRAPOLATIONS.len()).map(|order| (order, 0, Predictor::Extrapolation(order)));
    let copies = earlier.iter().enumerate().flat_map(|(from, values)| {
        (0..=LAG_MAX).map(move |lag| (EXTRAPOLATIONS.len() + lag, from, Predictor::Copy { values, lag }))
    });
    let mut best = (0, 0, Predictor::Extrapolation(0));
    let mut best_cost = usize::MAX;
    for candidate in extrapolations.chain(copies) {
        if let Some(cost) = candidate.2.cost(values, best_cost) {
            (best, best_cost) = (candidate, cost);
        }
    }
    let (code, from, predictor) = best;
    put(body, code as u64);
    if matches!(predictor, Predictor::Copy { .. }) {
        put(body, from as u64);
    }
    for (scan, value) in values.iter().enumerate() {
        put_signed(
            body,
            predictor.distance(values.get(..scan).unwrap_or_default(), *value),
        );
    }
}

/// Floats as integers in the same order, neighbours one apart.
pub(crate) fn ordered(value: f64) -> i64 {
    let bits = canonical_bits(value).cast_signed();
    if bits < 0 {
        i64::MIN.wrapping_sub(bits)
    } else {
        bits
    }
}

fn from_ordered(order: i64) -> f64 {
    let bits = if order < 0 {
        i64::MIN.wrapping_sub(order)
    } else {
        order
    };
    f64::from_bits(bits.cast_unsigned())
}

fn put(body: &mut Vec<u8>, mut number: u64) {
    while number >= 0x80 {
        body.push((number & 0x7f) as u8 | 0x80);
        number >>= 7;
    }
    body.push(number as u8);
}

fn zigzag(number: i64) -> u64 {
    ((number << 1) ^ (number >> 63)).cast_unsigned()
}

fn put_signed(body: &mut Vec<u8>, number: i64) {
    put(body, zigzag(number));
}

/// Bytes that [`put_signed`] appends.
fn len_signed(number: i64) -> usize {
    let bits = 64 - (zigzag(number) | 1).leading_zeros();
    bits.div_ceil(7) as usize
}

fn put_text(body: &mut Vec<u8>, text: &str) {
    put(body, text.len() as u64);
    body.extend(text.as_bytes());
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

/// The rest of an unpacked companion. Every read is `None` where the bytes end or make no sense.
struct Reader<'a>(&'a [u8]);

impl Reader<'_> {
    fn byte(&mut self) -> Option<u8> {
        let (first, rest) = self.0.split_first()?;
        self.0 = rest;
        Some(*first)
    }

    fn number(&mut self) -> Option<u64> {
        let mut number = 0;
        for shift in (0..64).step_by(7) {
            let byte = self.byte()?;
            number |= u64::from(byte & 0x7f) << shift;
            if byte < 0x80 {
                return Some(number);
            }
        }
        None
    }

    /// A count of things that take at least a byte each, so it cannot exceed the bytes left.
    fn count(&mut self) -> Option<usize> {
        let count = usize::try_from(self.number()?).ok()?;
        (count <= self.0.len()).then_some(count)
    }

    fn signed(&mut self) -> Option<i64> {
        let number = self.number()?;
        Some((number >> 1).cast_signed() ^ -(number & 1).cast_signed())
    }

    fn text(&mut self) -> Option<String> {
        let len = self.count()?;
        let (text, rest) = self.0.split_at_checked(len)?;
        self.0 = rest;
        String::from_utf8(text.to_vec()).ok()
    }

    fn column(&mut self) -> Option<Column> {
        let name = self.text()?;
        let kind = *KINDS.get(usize::from(self.byte()?))?;
        let role = *ROLES.get(usize::from(self.byte()?))?;
        Some(Column {
            name,
            kind,
            role,
            is_time: self.byte()? != 0,
        })
    }

    fn words(&mut self, rows: usize) -> Option<Vec<u64>> {
        let (mut last, mut step) = (0_u64, 0_u64);
        let word = || {
            step = step.wrapping_add(self.signed()?.cast_unsigned());
            last = last.wrapping_add(step);
            Some(last)
        };
        std::iter::repeat_with(word).take(rows).collect()
    }

    fn reals(&mut self, rows: usize, earlier: &[Vec<f64>]) -> Option<Vec<f64>> {
        let code = usize::try_from(self.number()?).ok()?;
        let predictor = match code.checked_sub(EXTRAPOLATIONS.len()) {
            None => Predictor::Extrapolation(code),
            Some(lag) => {
                let values = earlier.get(usize::try_from(self.number()?).ok()?)?;
                Predictor::Copy { values, lag }
            }
        };
        let mut values = Vec::with_capacity(rows);
        for _ in 0..rows {
            let distance = self.signed()?;
            values.push(predictor.at_distance(&values, distance));
        }
        Some(values)
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
        let mut reals: Vec<Vec<f64>> = Vec::new();
        let mut words: Vec<Vec<u64>> = Vec::new();
        for column in &columns {
            if column.kind == Kind::Real {
                let values = self.reals(rows, &reals)?;
                words.push(values.iter().map(|value| value.to_bits()).collect());
                reals.push(values);
            } else {
                words.push(self.words(rows)?);
            }
        }
        let axes = columns.iter().filter(|column| column.role == Role::AxisState);
        let axes = axes
            .map(|column| Axis {
                name: column.subject().to_owned(),
                ..Axis::default()
            })
            .collect();
        let kinds: Vec<Kind> = columns.iter().map(|column| column.kind).collect();
        let mut trace = Trace::with_columns(
            Header {
                cycle_ns,
                axes,
                ..Header::default()
            },
            columns,
        );
        for scan in 0..rows {
            let cells = kinds
                .iter()
                .zip(&words)
                .map(|(kind, words)| cell(*kind, *words.get(scan)?, &names));
            trace.push_row(&cells.collect::<Option<Vec<_>>>()?).ok()?;
        }
        Some(trace)
    }
}

fn cell(kind: Kind, word: u64, names: &[String]) -> Option<Cell<'_>> {
    match kind {
        Kind::Bool => Some(Cell::Bool(word != 0)),
        Kind::Real => Some(Cell::Real(f64::from_bits(word))),
        Kind::Integer => Some(Cell::Integer(word.cast_signed())),
        Kind::Name => names
            .get(usize::try_from(word).ok()?)
            .map(|text| Cell::Name(text)),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_order_of_floats_is_the_order_of_their_integers() {
        let rising = [
            f64::NEG_INFINITY,
            f64::MIN,
            -1.0,
            -5e-324,
            0.0,
            5e-324,
            1.0,
            f64::MAX,
            f64::INFINITY,
        ];
        for pair in rising.windows(2) {
            assert!(ordered(pair[0]) < ordered(pair[1]), "{pair:?}");
        }
        for value in rising {
            assert_eq!(from_ordered(ordered(value)).to_bits(), value.to_bits());
        }
        assert_eq!(ordered(5e-324) - ordered(-5e-324), 2);
        assert_eq!(ordered(-0.0), 0);
    }

    #[test]
    fn numbers_take_the_bytes_they_are_said_to_take() {
        for number in [0, 1, -1, 63, 64, -64, -65, 8191, 8192, i64::MAX, i64::MIN] {
            let mut body = Vec::new();
            put_signed(&mut body, number);
            assert_eq!(body.len(), len_signed(number), "{number}");
            assert_eq!(Reader(&body).signed(), Some(number));
        }
    }

    #[test]
    fn polynomials_are_extrapolated() {
        let cubic: Vec<f64> = (0..8).map(|x| f64::from(x * x * x - 4 * x)).collect();
        for order in 4..=6 {
            assert_eq!(
                Predictor::Extrapolation(order).predict(&cubic[..7]),
                cubic[7],
                "order {order}"
            );
        }
        assert_eq!(Predictor::Extrapolation(6).predict(&[]), 0.0);
        assert_eq!(
            Predictor::Extrapolation(2).predict(&[f64::MAX, -f64::MAX]),
            -f64::MAX
        );
    }
}
