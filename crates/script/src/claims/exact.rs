//! Integers that hold every finite number exactly, for judges without rounding.
//!
//! Every finite f64 is a whole multiple of the least one above 0, 2^-1074. Here it is stored as that
//! multiple, with room for a product with three factors of 64 bits. Nothing divides except
//! [`Exact::quotient`], which rounds once and is for messages.

use std::cmp::Ordering;

/// 2^2098 is the largest number, in units of the least; 64 bits each.
const WORDS: usize = 38;

/// A whole multiple of 2^-1074, in two's complement, the least word first.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Exact([u64; WORDS]);

impl Exact {
    pub(super) const ZERO: Self = Self([0; WORDS]);
    /// 2^-1074.
    pub(super) const LEAST: Self = {
        let mut words = [0; WORDS];
        words[0] = 1;
        Self(words)
    };

    /// A finite number, as it is.
    pub(super) fn of(value: f64) -> Self {
        let bits = value.abs().to_bits();
        let (power, fraction) = (bits >> 52, bits & ((1 << 52) - 1));
        // Subnormal numbers have the power of the least normal ones, and no leading 1.
        let (significand, shift) = match power.checked_sub(1) {
            None => (fraction, 0),
            Some(shift) => (fraction | 1 << 52, shift as usize),
        };
        let mut words = [0; WORDS];
        let parts = u128::from(significand) << (shift % 64);
        for (word, part) in words
            .iter_mut()
            .skip(shift / 64)
            .zip([parts as u64, (parts >> 64) as u64])
        {
            *word = part;
        }
        if value < 0.0 { -Self(words) } else { Self(words) }
    }

    /// This number, `by` times.
    pub(super) fn times(self, by: i64) -> Self {
        let mut words = [0; WORDS];
        let mut carry = 0;
        for (product, word) in words.iter_mut().zip(self.0) {
            carry += u128::from(word) * u128::from(by.unsigned_abs());
            *product = carry as u64;
            carry >>= 64;
        }
        if by < 0 { -Self(words) } else { Self(words) }
    }

    fn is_negative(&self) -> bool {
        self.0.last().is_some_and(|word| word >> 63 == 1)
    }

    /// The quotient by a number above 0, rounded to the nearest f64; below 1e-300 low bits may be cut
    /// off.
    pub(super) fn quotient(self, by: u64) -> f64 {
        let size = if self.is_negative() { -self } else { self };
        let mut words = size.0;
        let mut rest = 0;
        for word in words.iter_mut().rev() {
            let of = u128::from(rest) << 64 | u128::from(*word);
            *word = (of / u128::from(by)) as u64;
            rest = (of % u128::from(by)) as u64;
        }
        // The leading 64 bits; the last of them also represents all lower bits.
        let bits = words.iter().rposition(|word| *word != 0).map_or(0, |top| {
            let leading = words.get(top).map_or(0, |word| word.leading_zeros() as usize);
            64 * (top + 1) - leading
        });
        let shift = bits.saturating_sub(64);
        let word = |at: usize| words.get(at).copied().unwrap_or(0);
        let pair = u128::from(word(shift / 64 + 1)) << 64 | u128::from(word(shift / 64));
        let leading = (pair >> (shift % 64)) as u64;
        let is_cut = shift > 0
            && (rest != 0
                || words.iter().take(shift / 64).any(|word| *word != 0)
                || word(shift / 64) & ((1 << (shift % 64)) - 1) != 0);
        let value = (leading | u64::from(is_cut)) as f64 * least_times_power(shift);
        if self.is_negative() { -value } else { value + 0.0 }
    }
}

/// 2^-1074 times this power of two.
fn least_times_power(power: usize) -> f64 {
    match power {
        0..=51 => f64::from_bits(1 << power),
        _ => f64::from_bits((power as u64 - 51).min(0x7ff) << 52),
    }
}

impl std::ops::Add for Exact {
    type Output = Self;

    fn add(self, other: Self) -> Self {
        let mut words = self.0;
        let mut carry = false;
        for (word, other) in words.iter_mut().zip(other.0) {
            let (sum, over) = word.overflowing_add(other);
            let (sum, again) = sum.overflowing_add(u64::from(carry));
            *word = sum;
            carry = over || again;
        }
        Self(words)
    }
}

impl std::ops::Neg for Exact {
    type Output = Self;

    fn neg(self) -> Self {
        Self(self.0.map(|word| !word)) + Self::LEAST
    }
}

impl std::ops::Sub for Exact {
    type Output = Self;

    fn sub(self, other: Self) -> Self {
        self + -other
    }
}

impl Ord for Exact {
    fn cmp(&self, other: &Self) -> Ordering {
        let signs = other.is_negative().cmp(&self.is_negative());
        signs.then_with(|| self.0.iter().rev().cmp(other.0.iter().rev()))
    }
}

impl PartialOrd for Exact {
    fn partial_cmp(&self, other: &Self) -> Option<Ordering> {
        Some(self.cmp(other))
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_testkit::Random;

    /// Numbers of every size and both signs, the extremes among them.
    fn numbers() -> Vec<f64> {
        let mut random = Random(17);
        let mut numbers = vec![
            0.0,
            5e-324,
            -5e-324,
            f64::MIN_POSITIVE,
            f64::MAX,
            f64::MIN,
            1.0,
            -0.1,
            360.0,
        ];
        while numbers.len() < 300 {
            let value = f64::from_bits(random.bits());
            numbers.extend(value.is_finite().then_some(value));
        }
        numbers
    }

    #[test]
    fn every_number_comes_back_and_keeps_its_order() {
        for one in numbers() {
            assert_eq!(
                Exact::of(one).quotient(1).to_bits(),
                (one + 0.0).to_bits(),
                "{one:?}"
            );
            assert_eq!((-Exact::of(one)).quotient(1), -one);
            assert_eq!(Exact::of(one) - Exact::of(one), Exact::ZERO);
            for other in numbers() {
                let order = Exact::of(one).cmp(&Exact::of(other));
                assert_eq!(Some(order), one.partial_cmp(&other), "{one:?} {other:?}");
            }
        }
    }

    #[test]
    fn sums_and_quotients_are_rounded_once() {
        for one in numbers() {
            for other in numbers() {
                let sum = (Exact::of(one) + Exact::of(other)).quotient(1);
                assert_eq!(sum, one + other, "{one:?} + {other:?}");
            }
            for by in [1_u32, 2, 3, 7, 65_535, 131_070] {
                if one != 0.0 && one.abs() < 1e-295 {
                    continue;
                }
                let quotient = Exact::of(one).quotient(by.into());
                assert_eq!(quotient, one / f64::from(by), "{one:?} / {by}");
            }
            for by in [0, 1, -1, 3, -32_768, 1 << 40] {
                let product = Exact::of(one).times(by).quotient(1);
                assert_eq!(product, one * by as f64, "{one:?} * {by}");
            }
        }
    }
}
