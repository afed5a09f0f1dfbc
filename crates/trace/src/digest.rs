//! The digest of all exact bits of a trace, equal on every processor: what `run` prints. Goldens are judged by subject
//! instead ([`subjects`](mod@crate::subjects)), those of version 1 by this.
//!
//! FNV-1a with 64 bits, over the rows in scan order and in each row over the columns in file order. A
//! number counts as its eight bytes, least significant first; a BOOL or a name as its text in CSV and a
//! zero byte, so that neither the order in which names turned up nor the machine's byte order matters.
//! Names of columns, the header and the notes do not count.

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
    pub fn write(&mut self, bytes: &[u8]) {
        for &byte in bytes {
            self.0 = (self.0 ^ u64::from(byte)).wrapping_mul(0x0000_0100_0000_01b3);
        }
    }

    /// The digest of all bytes so far.
    #[must_use]
    pub const fn finish(self) -> u64 {
        self.0
    }
}

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
    let mut digest = Fnv1a::new();
    for row in trace.words() {
        for (column, &word) in trace.columns().iter().zip(row) {
            match column.kind {
                Kind::Real | Kind::Integer => digest.write(&word.to_le_bytes()),
                Kind::Bool if word != 0 => digest.write(b"TRUE\0"),
                Kind::Bool => digest.write(b"FALSE\0"),
                Kind::Name => {
                    digest.write(trace.text(word).as_bytes());
                    digest.write(&[0]);
                }
            }
        }
    }
    digest.finish()
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
