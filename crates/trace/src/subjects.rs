//! Digests by subject, which judge goldens: each axis, block instance and program has one, and the input
//! variables have one. They are meant to stay: additions of a later version change no existing digest.
//!
//! A column is hashed by itself, over one word of 64 bits a scan: a number's bits, 0 or 1 for a BOOL, the
//! hash of a name's text. A subject's digest is over the digests of its columns in the order of their
//! names, so the order of columns and the numbers of pins do not count. A column that keeps its
//! [default](crate::Column::default) in all rows, and that the script does not name, is left out. So a
//! new pin that nobody uses is not part of any digest.
//!
//! Every step maps the word and the state before it one to one, so one changed word always changes the
//! digest of its subject. Several changes are missed about once in 2^64 times. The digests find
//! accidents, not attacks.

use std::collections::BTreeMap;

use crate::column::{Cell, Column, Kind, canonical_bits};
use crate::events::groups;
use crate::trace::Trace;

/// A subject and its digest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Subject {
    /// The axis, instance or program; `inputs` for the input variables.
    pub name: String,
    /// The digest of its columns that count.
    pub digest: u64,
}

/// A hash of words.
#[derive(Clone, Copy)]
struct Words(u64);

impl Words {
    const START: Self = Self(0x9ae1_6a3b_2f90_404f);

    /// An odd factor and a shift of more than half: both can be undone, so different words give different
    /// states. The shift moves high bits down, where signs and exponents are.
    const fn with(self, word: u64) -> Self {
        let product = (self.0 ^ word).wrapping_mul(0x9e37_79b9_7f4a_7c15);
        Self(product ^ (product >> 32))
    }

    fn all(self, words: impl IntoIterator<Item = u64>) -> Self {
        words.into_iter().fold(self, Self::with)
    }
}

/// The hash of a text: eight bytes a word, least significant first, then its length.
fn of_text(text: &str) -> u64 {
    let words = text.as_bytes().chunks(8).map(|chunk| {
        let bytes = chunk.iter().rev();
        bytes.fold(0, |word, byte| (word << 8) | u64::from(*byte))
    });
    Words::START.all(words).with(text.len() as u64).0
}

/// A cell as the word that is hashed.
fn word(cell: Cell<'_>) -> u64 {
    match cell {
        Cell::Bool(value) => u64::from(value),
        Cell::Real(value) => canonical_bits(value),
        Cell::Integer(value) => value.cast_unsigned(),
        Cell::Name(text) => of_text(text),
    }
}

/// The start of the hash of a column: its name within the subject, and its kind.
fn start(column: &Column) -> Words {
    let kind = match column.kind {
        Kind::Bool => 0,
        Kind::Real => 1,
        Kind::Integer => 2,
        Kind::Name => 3,
    };
    Words::START.with(of_text(column.signal())).with(kind)
}

/// The digest of every column, and whether it counts. A column that the script names, or without a
/// default, always counts; another one counts if it ever left its default.
fn of_columns(trace: &Trace) -> Vec<(u64, bool)> {
    struct State {
        hash: Words,
        is_name: bool,
        default: Option<u64>,
        counts: bool,
    }
    let mut states: Vec<State> = trace
        .columns()
        .iter()
        .map(|column| {
            let default = column.unsaid().map(word);
            State {
                hash: start(column),
                is_name: column.kind == Kind::Name,
                default,
                counts: default.is_none(),
            }
        })
        .collect();
    let names: Vec<u64> = trace.names().iter().map(|text| of_text(text)).collect();
    trace.each_row(trace.first(), |row| {
        for (state, &word) in states.iter_mut().zip(row) {
            let word = match state.is_name {
                true => usize::try_from(word).ok().and_then(|at| names.get(at)),
                false => Some(&word),
            };
            let word = word.copied().unwrap_or_default();
            state.counts |= state.default.is_some_and(|default| default != word);
            state.hash = state.hash.with(word);
        }
    });
    states
        .into_iter()
        .map(|state| (state.hash.0, state.counts))
        .collect()
}

/// The subjects of some columns, in the order of events.
fn by_subject(trace: &Trace, digests: &[(u64, bool)]) -> Vec<Subject> {
    let of_group = |(name, columns): (String, Vec<usize>)| {
        let own = columns.iter().filter_map(|&at| {
            let (digest, counts) = *digests.get(at)?;
            counts.then_some((trace.columns().get(at)?.signal(), digest))
        });
        let own: BTreeMap<&str, u64> = own.collect();
        let hash = Words::START.all(own.values().copied());
        (!own.is_empty()).then(|| Subject {
            name,
            digest: hash.with(own.len() as u64).with(trace.scans() as u64).0,
        })
    };
    let groups = groups(trace.columns()).into_iter();
    groups
        .map(|group| (group.subject, group.columns))
        .filter_map(of_group)
        .collect()
}

/// The subjects of a trace in the order of events: the input variables, instances in call order, axes. A
/// subject with only columns at their defaults is left out. Cost: one pass over the rows.
#[must_use]
pub fn subjects(trace: &Trace) -> Vec<Subject> {
    by_subject(trace, &of_columns(trace))
}

/// The same as [`subjects`], with all columns, even those that keep their defaults.
pub(crate) fn of_all_columns(trace: &Trace) -> Vec<Subject> {
    let mut digests = of_columns(trace);
    digests.iter_mut().for_each(|(_, counts)| *counts = true);
    by_subject(trace, &digests)
}

/// The columns that count, by their indices: all except those that keep their defaults in all rows and
/// that no script names.
pub(crate) fn counted(trace: &Trace) -> Vec<usize> {
    let digests = of_columns(trace).into_iter().enumerate();
    digests
        .filter_map(|(at, (_, counts))| counts.then_some(at))
        .collect()
}

/// One digest for all subjects, independent of their order.
#[must_use]
pub fn together(subjects: &[Subject]) -> u64 {
    let mut all: Vec<(&str, u64)> = subjects
        .iter()
        .map(|subject| (subject.name.as_str(), subject.digest))
        .collect();
    all.sort_unstable();
    let words = all.into_iter().flat_map(|(name, digest)| [of_text(name), digest]);
    Words::START.all(words).0
}

#[cfg(test)]
mod tests {
    use super::*;

    /// The published digests depend on these: a change of any changes all goldens.
    #[test]
    fn the_hash_is_what_it_was() {
        let hashes = [
            of_text(""),
            of_text("X"),
            of_text("Position"),
            of_text("Standstill"),
        ];
        let found = hashes.map(|hash| format!("{hash:016x}"));
        assert_eq!(
            found,
            [
                "164381959b920bee",
                "4d234ad4fa87904b",
                "ad78238dd9dd741f",
                "c88141269f50bbc3"
            ]
        );
        assert_eq!(
            format!("{:016x}", Words::START.all([0, 1, u64::MAX, 1.5_f64.to_bits()]).0),
            "e6e3867eccc611b4"
        );
    }

    #[test]
    fn flipped_signs_next_to_each_other_do_not_cancel() {
        let sign = 1_u64 << 63;
        for bit in 0..64 {
            let (flip, other) = (1_u64 << bit, sign);
            for (a, b) in [(flip, flip), (flip, other), (other, flip)] {
                let plain = Words::START.all([7, 9, 11]).0;
                assert_ne!(plain, Words::START.all([7 ^ a, 9 ^ b, 11]).0, "{bit}");
                assert_ne!(plain, Words::START.all([7 ^ a, 9, 11 ^ b]).0, "{bit}");
            }
        }
    }
}
