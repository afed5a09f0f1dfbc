//! Random numbers that are the same on every machine.

use std::vec::IntoIter;

use standstill_testkit as testkit;

/// The numbers of [`testkit::Random`]. A fuzzer can supply the first ones.
#[derive(Debug)]
pub struct Random {
    given: IntoIter<u64>,
    stream: testkit::Random,
}

impl Random {
    /// Independent streams for every `seed` and `stream`.
    pub fn new(seed: u64, stream: u64) -> Self {
        let first = |counter| testkit::Random(counter).bits();
        Self {
            given: Vec::new().into_iter(),
            stream: testkit::Random(first(seed) ^ first(stream)),
        }
    }

    /// Each eight bytes are a number; after the bytes it continues with stream 0 of seed 0.
    pub fn of_bytes(bytes: &[u8]) -> Self {
        let given = bytes.as_chunks().0.iter().map(|word| u64::from_le_bytes(*word));
        Self {
            given: given.collect::<Vec<_>>().into_iter(),
            ..Self::new(0, 0)
        }
    }

    fn bits(&mut self) -> u64 {
        self.given.next().unwrap_or_else(|| self.stream.bits())
    }

    /// One of the whole numbers from 0 to `count` - 1.
    pub fn below(&mut self, count: u64) -> u64 {
        self.bits() % count
    }

    /// True once in `count` times.
    pub fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    /// Evenly from `low` to below `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        let unit = (self.bits() >> 11) as f64 / (1_u64 << 53) as f64;
        low + (high - low) * unit
    }

    /// From `low` to `high` with every power equally likely.
    ///
    /// The binary digits of the exponent choose square roots of `high / low`: a logarithm would not give
    /// the same bits everywhere.
    pub fn log_between(&mut self, low: f64, high: f64) -> f64 {
        let (mut value, mut root) = (low, high / low);
        let mut digits = self.bits();
        for _ in 0..24 {
            root = root.sqrt();
            if digits & 1 == 1 {
                value *= root;
            }
            digits >>= 1;
        }
        value
    }

    /// `value` or `-value`.
    pub fn signed(&mut self, value: f64) -> f64 {
        if self.one_in(2) { value } else { -value }
    }
}
