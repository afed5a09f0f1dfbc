//! Random numbers that are the same on every machine.

/// splitmix64 (Steele, Lea, Flood 2014): a counter and a mixing function.
#[derive(Debug)]
pub struct Random(u64);

impl Random {
    /// Independent streams for every `seed` and `stream`.
    pub fn new(seed: u64, stream: u64) -> Self {
        let mut seeded = Self(seed);
        Self(seeded.bits() ^ Self(stream).bits())
    }

    fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9e37_79b9_7f4a_7c15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xbf58_476d_1ce4_e5b9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94d0_49bb_1331_11eb);
        z ^ (z >> 31)
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

    /// From `low` to `high` with every power as likely.
    ///
    /// The binary digits of the exponent pick square roots of `high / low`: a logarithm would not give the
    /// same bits everywhere.
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
