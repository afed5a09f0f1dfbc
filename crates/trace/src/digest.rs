//! The digest of all exact bits of a trace, equal on every processor; `run` prints it. Goldens are judged
//! by subject instead ([`subjects`](mod@crate::subjects)), goldens of version 1 by this one.
//!
//! FNV-1a with 64 bits, over the rows in scan order and in each row over the columns in file order. A
//! number counts as its eight bytes, least significant first. A BOOL or a name counts as its text in CSV
//! and a zero byte. So neither the order in which names first occur nor the byte order of the machine
//! matters. Names of columns, the header and the notes do not count.

use crate::column::Kind;
use crate::trace::Trace;

/// FNV-1a, 64 bits: order-sensitive, seedless, four lines. It finds accidents, not attacks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fnv1a(u64);

impl Fnv1a {
    /// The digest of nothing.
    #[must_use]
    pub const fn new() -> Self {
        Self(0xcbf2_9ce4_8422_2325)
    }

    /// Takes in more bytes.
    pub const fn write(&mut self, bytes: &[u8]) {
        let mut rest = bytes;
        while let [byte, later @ ..] = rest {
            self.0 = (self.0 ^ *byte as u64).wrapping_mul(PRIME);
            rest = later;
        }
    }

    /// Adds the bytes of a word, the least significant one first. A byte of 0 only multiplies, and common
    /// numbers begin with some.
    fn write_word(&mut self, word: u64) {
        let zeros = (word.trailing_zeros() / 8) as usize;
        self.0 = self.0.wrapping_mul(POWERS.get(zeros).copied().unwrap_or(0));
        self.write(word.to_le_bytes().get(zeros..).unwrap_or_default());
    }

    /// Adds a prepared text.
    fn write_prepared(&mut self, text: &Prepared) {
        let [low, ..] = self.0.to_le_bytes();
        let added = text.added.get(usize::from(low)).copied().unwrap_or(0);
        self.0 = self.0.wrapping_mul(text.power).wrapping_add(added);
    }

    /// The digest of all bytes so far.
    #[must_use]
    pub const fn finish(self) -> u64 {
        self.0
    }
}

const PRIME: u64 = 0x0000_0100_0000_01b3;

/// Powers of the prime.
const POWERS: [u64; 9] = {
    let mut powers = [1; 9];
    let mut at = 1;
    while at < powers.len() {
        powers[at] = PRIME.wrapping_mul(powers[at - 1]);
        at += 1;
    }
    powers
};

/// A text as one step of the digest. A byte changes only the lowest byte of the digest before the
/// multiplication. So the term that a text adds to the digest times a power of the prime depends only on
/// the digest's lowest byte.
#[derive(Clone, Debug)]
struct Prepared {
    power: u64,
    added: [u64; 256],
}

impl Prepared {
    const fn new(text: &[u8]) -> Self {
        let mut prepared = Self {
            power: 1,
            added: [0; 256],
        };
        let mut at = 0;
        while at < text.len() {
            prepared.power = prepared.power.wrapping_mul(PRIME);
            at += 1;
        }
        let mut low = 0;
        while low < prepared.added.len() {
            let mut digest = Fnv1a(low as u64);
            digest.write(text);
            prepared.added[low] = digest.0.wrapping_sub((low as u64).wrapping_mul(prepared.power));
            low += 1;
        }
        prepared
    }
}

static TRUE: Prepared = Prepared::new(b"TRUE\0");
static FALSE: Prepared = Prepared::new(b"FALSE\0");

/// Largest number of prepared names: the first ones that occur. The limit bounds the memory.
const NAMES_PREPARED: usize = 64;

impl Default for Fnv1a {
    fn default() -> Self {
        Self::new()
    }
}

/// The digest of some bytes, for example a script's text.
#[must_use]
pub fn fnv1a(bytes: &[u8]) -> u64 {
    let mut digest = Fnv1a::new();
    digest.write(bytes);
    digest.finish()
}

/// The digest of every bit of the trace.
#[must_use]
pub fn whole(trace: &Trace) -> u64 {
    let mut whole = Whole::default();
    whole.look(trace);
    whole.finish()
}

/// The digest of every bit of a trace that grows and may forget rows that were read.
#[derive(Clone, Debug, Default)]
pub struct Whole {
    /// Scans taken in.
    scans: usize,
    digest: Fnv1a,
    names: Vec<Prepared>,
}

impl Whole {
    /// Adds the rows that the trace has got since the last call.
    pub fn look(&mut self, trace: &Trace) {
        let with_end = |text: &str| [text.as_bytes(), &[0]].concat();
        let new = trace.names().iter().take(NAMES_PREPARED).skip(self.names.len());
        self.names.extend(new.map(|text| Prepared::new(&with_end(text))));
        let digest = &mut self.digest;
        let kinds: Vec<Kind> = trace.columns().iter().map(|column| column.kind).collect();
        trace.each_row(self.scans, |row| {
            for (kind, &word) in kinds.iter().zip(row) {
                match kind {
                    Kind::Real | Kind::Integer => digest.write_word(word),
                    Kind::Bool if word != 0 => digest.write_prepared(&TRUE),
                    Kind::Bool => digest.write_prepared(&FALSE),
                    Kind::Name => {
                        let place = usize::try_from(word).ok();
                        match place.and_then(|place| self.names.get(place)) {
                            Some(name) => digest.write_prepared(name),
                            None => digest.write(&with_end(trace.text(word))),
                        }
                    }
                }
            }
        });
        self.scans = trace.scans();
    }

    /// The digest of all rows so far.
    #[must_use]
    pub const fn finish(&self) -> u64 {
        self.digest.finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::column::Cell;
    use crate::header::{Header, Input};

    #[test]
    fn fnv_has_its_published_values() {
        // From the algorithm's authors: the empty string, "a" and "foobar".
        assert_eq!(fnv1a(b""), 0xcbf2_9ce4_8422_2325);
        assert_eq!(fnv1a(b"a"), 0xaf63_dc4c_8601_ec8c);
        assert_eq!(fnv1a(b"foobar"), 0x8594_4171_f739_67e8);
    }

    #[test]
    fn a_step_for_a_word_or_a_text_is_that_of_its_bytes() {
        let mut seed = Fnv1a::new();
        for round in 0..1000_u64 {
            seed.write(&round.to_le_bytes());
            // All digests, words that end in any number of bytes of 0, texts of any length.
            let word = seed.finish() << (8 * (round % 9)).min(63);
            let text = &b"DiscreteMotion\0"[..(round % 15) as usize];
            let (mut bytes, mut steps) = (
                Fnv1a(seed.finish().rotate_left(7)),
                Fnv1a(seed.finish().rotate_left(7)),
            );
            bytes.write(&word.to_le_bytes());
            bytes.write(text);
            steps.write_word(word);
            steps.write_prepared(&Prepared::new(text));
            assert_eq!(bytes, steps, "{word:x} {text:?}");
        }
        let (mut bytes, mut steps) = (Fnv1a::new(), Fnv1a::new());
        bytes.write(&[0; 8]);
        steps.write_word(0);
        assert_eq!(bytes, steps);
    }

    fn trace(words: &[&str]) -> Trace {
        let inputs = vec![Input {
            name: "mode".into(),
            iec_type: "MODE".into(),
        }];
        let mut trace = Trace::new(Header {
            inputs,
            ..Header::default()
        });
        for word in words {
            trace.push_row(&[Cell::Name(word)]).expect("the row fits");
        }
        trace
    }

    #[test]
    fn every_bit_counts_but_not_the_order_in_which_names_turned_up() {
        assert_eq!(whole(&trace(&["a"])), fnv1a(b"a\0"));
        assert_eq!(whole(&trace(&["b", "a"])), fnv1a(b"b\0a\0"));
        assert_ne!(whole(&trace(&["ab", "c"])), whole(&trace(&["a", "bc"])));
    }
}
