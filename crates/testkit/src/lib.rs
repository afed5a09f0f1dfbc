//! Random numbers for tests: all come from a seed and are the same on every machine. Also validators of other projects.

#![no_std]

#[cfg(not(target_os = "none"))]
extern crate std;

#[cfg(not(target_os = "none"))]
pub mod peers;

/// Whether `STANDSTILL_SEARCH` is in the environment, as in `.ci/run`: then long tests run in full.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn searches() -> bool {
    std::env::var_os("STANDSTILL_SEARCH").is_some()
}

/// The size of a long test: `whole` if it [searches]; else `short`, to keep `cargo test` short.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn whole_or<T>(whole: T, short: T) -> T {
    if searches() { whole } else { short }
}

/// How many of `whole` cases a long random search tries: all of them if it [searches]; else a fiftieth.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn cases(whole: u64) -> u64 {
    whole_or(whole, whole.div_ceil(50))
}

/// The number that the environment gives by this name; without it `usual`.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn given<T: core::str::FromStr>(name: &str, usual: T) -> T {
    let given = std::env::var(name).ok();
    given.and_then(|number| number.parse().ok()).unwrap_or(usual)
}

/// The cases that `STANDSTILL_SOAK` in the environment asks for, as docs/performance.md does; without it `usual`.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn soak(usual: u64) -> u64 {
    given("STANDSTILL_SOAK", usual)
}

/// The step with which a search goes through a long list: 1 if it [searches]; else 23, a prime, so that no column
/// of a table is left out.
#[cfg(not(target_os = "none"))]
#[must_use]
pub fn stride() -> usize {
    whole_or(1, 23)
}

/// splitmix64 (Steele, Lea, Flood 2014): a counter and a mixing function. The seed is the first value of
/// the counter.
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u64);

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// A whole number from 0 to `count` - 1; 0 if `count` is 0.
    pub fn below(&mut self, count: u64) -> u64 {
        self.bits().checked_rem(count).unwrap_or(0)
    }

    /// An index into a list of `len` entries; 0 if it is empty.
    pub fn place(&mut self, len: usize) -> usize {
        self.below(len as u64) as usize
    }

    /// An entry of a list.
    ///
    /// # Panics
    /// If the list is empty.
    pub fn one_of<T: Copy>(&mut self, list: &[T]) -> T {
        list[self.place(list.len())]
    }

    /// True once in `count` times.
    pub fn one_in(&mut self, count: u64) -> bool {
        self.below(count) == 0
    }

    /// -1 or 1.
    pub fn sign(&mut self) -> f64 {
        if self.bits() & 1 == 1 { 1.0 } else { -1.0 }
    }

    /// Evenly from 0 to below 1.
    pub fn unit(&mut self) -> f64 {
        (self.bits() >> 11) as f64 / (1_u64 << 53) as f64
    }

    /// Evenly from `low` to below `high`.
    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * self.unit()
    }

    /// From `low` to `high`, both above 0, with every power equally likely.
    ///
    /// The result is `low` times a random choice of the roots of `high / low`. A logarithm would not give
    /// the same bits everywhere.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        let (mut value, mut root) = (low, high / low);
        for _ in 0..40 {
            root = libm::sqrt(root);
            if self.bits() & 1 == 1 {
                value *= root;
            }
        }
        value
    }
}
