//! Converts user units to drive increments and back, by an integer ratio.

use crate::ConfigError;
use core::num::NonZero;
use standstill_planner::turns::split;

/// `increments` drive increments are `units` user units.
///
/// A set-point is rounded once, from the exact position, half away from zero; nothing is accumulated.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scaling {
    // Not zero by type, so that a division by them cannot panic.
    increments: NonZero<u32>,
    units: NonZero<u32>,
    invert: bool,
    offset: f64,
}

impl Scaling {
    /// `increments` (>= 1) increments are `units` (>= 1) user units; with `invert` the drive counts the
    /// other way; `offset` (u) is the user position at increment 0.
    ///
    /// # Errors
    /// [`ConfigError::Scaling`] if one of the integers is 0 or `offset` is not finite.
    pub const fn new(increments: u32, units: u32, invert: bool, offset: f64) -> Result<Self, ConfigError> {
        match (NonZero::new(increments), NonZero::new(units)) {
            (Some(increments), Some(units)) if offset.is_finite() => Ok(Self {
                increments,
                units,
                invert,
                offset,
            }),
            _ => Err(ConfigError::Scaling {
                increments,
                units,
                offset,
            }),
        }
    }

    /// Increments of the ratio.
    pub const fn increments(&self) -> u32 {
        self.increments.get()
    }

    /// User units of the ratio.
    pub const fn units(&self) -> u32 {
        self.units.get()
    }

    /// Whether the drive counts the other way.
    pub const fn invert(&self) -> bool {
        self.invert
    }

    /// Position (u) at increment 0.
    pub const fn offset(&self) -> f64 {
        self.offset
    }

    /// The increments nearest to `position` (u); saturates at the range of `i64`.
    ///
    /// The product is split into whole units and a fraction so that positions up to 2^53 u keep every bit
    /// of their whole part.
    #[inline(never)]
    pub fn to_increments(&self, position: f64) -> i64 {
        let (units, fraction) = self.split(position);
        match divided(units, self.increments, self.units) {
            Some((whole, rest)) => whole.saturating_add(rounded(self.rest_of(rest, fraction))),
            None => self.increments_wide(units, fraction),
        }
    }

    /// The same where the product takes more than 64 bits.
    #[cold]
    #[inline(never)]
    fn increments_wide(&self, units: i64, fraction: f64) -> i64 {
        let (whole, rest) = divided_wide(units, self.increments, self.units);
        nearest(whole, self.rest_of(rest, fraction))
    }

    /// The distance of `position` (u) from the offset, with the sign of the drive: whole units and the
    /// rest.
    #[inline]
    fn split(&self, position: f64) -> (i64, f64) {
        let position = if self.invert {
            self.offset - position
        } else {
            position - self.offset
        };
        // A saturating conversion: NaN gives 0, but the axis never passes NaN here.
        let whole = position as i64;
        (whole, position - whole as f64)
    }

    /// The increments of the fraction of a unit, plus the remainder of the whole units: a few increments.
    #[inline]
    fn rest_of(&self, rest: f64, fraction: f64) -> f64 {
        (rest + fraction * f64::from(self.increments.get())) / f64::from(self.units.get())
    }

    /// The position (u) of `increments`.
    #[inline(never)]
    pub fn to_units(&self, increments: i64) -> f64 {
        let (whole, rest) = match divided(increments, self.units, self.increments) {
            Some((whole, rest)) => (whole as f64, rest),
            None => {
                let (whole, rest) = divided_wide(increments, self.units, self.increments);
                (whole as f64, rest)
            }
        };
        let distance = whole + rest / f64::from(self.increments.get());
        if self.invert {
            self.offset - distance
        } else {
            distance + self.offset
        }
    }
}

/// `value * factor / divisor` as a whole number, rounded towards minus infinity, and the remainder. None
/// if the product takes more than 64 bits, which is far beyond a machine's way.
#[inline]
fn divided(value: i64, factor: NonZero<u32>, divisor: NonZero<u32>) -> Option<(i64, f64)> {
    let scaled = value.checked_mul(i64::from(factor.get()))?;
    let divisor = i64::from(divisor.get());
    if divisor == 1 {
        return Some((scaled, 0.0));
    }
    Some((scaled.div_euclid(divisor), scaled.rem_euclid(divisor) as f64))
}

/// The same for every value, at three times the cost.
#[cold]
fn divided_wide(value: i64, factor: NonZero<u32>, divisor: NonZero<u32>) -> (i128, f64) {
    let scaled = i128::from(value) * i128::from(factor.get());
    let divisor = i128::from(divisor.get());
    (scaled.div_euclid(divisor), scaled.rem_euclid(divisor) as f64)
}

/// The whole number nearest to `small`, half away from 0; saturates at the range of `i64`.
#[inline]
fn rounded(small: f64) -> i64 {
    (if small < 0.0 { small - 0.5 } else { small + 0.5 }) as i64
}

/// The whole number nearest to `whole + small`, half away from `whole`; saturates at the range of `i64`.
fn nearest(whole: i128, small: f64) -> i64 {
    let nearest = whole + i128::from(rounded(small));
    nearest.clamp(i128::from(i64::MIN), i128::from(i64::MAX)) as i64
}

/// One turn of a modulo axis in increments: a fraction, so that turns can be counted without rounding.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Turn {
    increments: NonZero<u64>,
    turns: NonZero<u64>,
}

impl Turn {
    /// Largest part of the fraction: with turns or increments of 63 bits the products fit 127.
    const LARGEST: u128 = i64::MAX as u128;

    /// So many increments ..
    pub const fn increments(&self) -> u64 {
        self.increments.get()
    }

    /// .. are this many turns; the two have no common divisor.
    pub const fn turns(&self) -> u64 {
        self.turns.get()
    }
}

impl Scaling {
    /// One turn of `length` (u) in increments, exactly; `None` if `length` is not above 0 and finite, or if
    /// the fraction's parts do not fit 63 bits.
    ///
    /// Bounded: at most 186 steps of Euclid's algorithm.
    pub fn turn(&self, length: f64) -> Option<Turn> {
        if !(length > 0.0 && length.is_finite()) {
            return None;
        }
        // length = mantissa * 2^exponent
        let bits = length.to_bits();
        let (fraction, biased) = (bits & ((1 << 52) - 1), (bits >> 52) as i32);
        let (mantissa, exponent) = if biased == 0 {
            (fraction, -1074)
        } else {
            (fraction | (1 << 52), biased - 1075)
        };
        let zeros = mantissa.trailing_zeros();
        let (mantissa, exponent) = (mantissa >> zeros, exponent + zeros.cast_signed());
        let shifted = |value: u128, by: i32| {
            let by = u32::try_from(by).ok()?;
            (by <= value.leading_zeros()).then(|| value << by)
        };
        let increments = u128::from(mantissa) * u128::from(self.increments.get());
        let turns = u128::from(self.units.get());
        let (increments, turns) = if exponent >= 0 {
            (shifted(increments, exponent)?, turns)
        } else {
            (increments, shifted(turns, exponent.checked_neg()?)?)
        };
        let (mut divisor, mut rest) = (increments, turns);
        while let Some(next) = divisor.checked_rem(rest) {
            (divisor, rest) = (rest, next);
        }
        let part = |value: u128| {
            let reduced = value.checked_div(divisor).filter(|part| *part <= Turn::LARGEST)?;
            NonZero::new(u64::try_from(reduced).ok()?)
        };
        Some(Turn {
            increments: part(increments)?,
            turns: part(turns)?,
        })
    }

    /// The increments nearest to `turns` whole turns and `position` (u); saturates at the range of `i64`.
    ///
    /// Turns are counted in integers: 10^9 of them are as exact as one.
    #[inline(never)]
    pub fn to_increments_turned(&self, turn: &Turn, turns: i64, position: f64) -> i64 {
        let turns = if self.invert {
            -i128::from(turns)
        } else {
            i128::from(turns)
        };
        let scaled = turns * i128::from(turn.increments.get());
        let per_turn = i128::from(turn.turns.get());
        let rest = scaled.rem_euclid(per_turn) as f64 / turn.turns.get() as f64;
        let (units, fraction) = self.split(position);
        let (whole, left) = match divided(units, self.increments, self.units) {
            Some((whole, left)) => (i128::from(whole), left),
            None => divided_wide(units, self.increments, self.units),
        };
        nearest(
            whole + scaled.div_euclid(per_turn),
            self.rest_of(left, fraction) + rest,
        )
    }

    /// The whole turns of `length` (u) in `increments`, and the position (u) in [0, `length`) left.
    #[inline(never)]
    pub fn to_units_turned(&self, turn: &Turn, length: f64, increments: i64) -> (i64, f64) {
        let increments = if self.invert {
            -i128::from(increments)
        } else {
            i128::from(increments)
        };
        // In increments over turn.turns, all whole numbers.
        let scaled = increments * i128::from(turn.turns.get());
        let per_turn = i128::from(turn.increments.get());
        let turns = scaled.div_euclid(per_turn) as i64;
        let scaled = scaled.rem_euclid(per_turn) * i128::from(self.units.get());
        // Both factors are above 0 and their product is below 2^95.
        let ratio = (i128::from(self.increments.get()) * i128::from(turn.turns.get())).max(1);
        let whole = scaled.div_euclid(ratio);
        let rest = scaled.rem_euclid(ratio) as f64 / ratio as f64;
        let (further, position) = split(whole as f64 + rest + self.offset, length);
        (turns.saturating_add(further), position)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn whole_turns_far_out_keep_every_increment() {
        let scaling = Scaling::new(8_388_608, 360, false, 0.0).unwrap();
        for turns in [0_i64, 1, 1_000, 1_000_000, 1_000_000_000] {
            assert_eq!(scaling.to_increments((turns * 360) as f64), turns * 8_388_608);
            assert_eq!(scaling.to_units(turns * 8_388_608), (turns * 360) as f64);
        }
    }

    #[test]
    fn to_the_nearest_increment_and_mirrored_by_invert() {
        let plain = Scaling::new(1000, 3, false, 0.5).unwrap();
        let mirrored = Scaling::new(1000, 3, true, 0.5).unwrap();
        for (position, increments) in [(0.5, 0), (0.503, 1), (0.4955, -2), (3.5, 1000), (-2.5, -1000)] {
            assert_eq!(plain.to_increments(position), increments, "{position}");
            assert_eq!(mirrored.to_increments(position), -increments, "{position}");
        }
        assert_eq!(plain.to_units(1000), 3.5);
        assert_eq!(mirrored.to_units(-1000), 3.5);
    }

    #[test]
    fn zero_and_non_finite_ratios_are_refused() {
        assert!(Scaling::new(0, 1, false, 0.0).is_err());
        assert!(Scaling::new(1, 0, false, 0.0).is_err());
        assert!(Scaling::new(1, 1, false, f64::NAN).is_err());
    }

    #[test]
    fn a_turn_is_the_fraction_of_increments_it_is() {
        // 8388608 increments are 360 u: half a unit is 8388608 / 720 = 524288 / 45 increments.
        let scaling = Scaling::new(8_388_608, 360, false, 0.0).unwrap();
        let parts = |length| scaling.turn(length).map(|turn| (turn.increments(), turn.turns()));
        assert_eq!(parts(360.0), Some((8_388_608, 1)));
        assert_eq!(parts(1.0), Some((1_048_576, 45)));
        assert_eq!(parts(0.5), Some((524_288, 45)));
        assert_eq!(parts(0.375), Some((131_072, 15)));
        assert_eq!(parts(1080.0), Some((25_165_824, 1)));
        // 0.1 is 3602879701896397 / 2^55, and 8388608 / 360 is 2^20 / 45.
        assert_eq!(parts(0.1), Some((3_602_879_701_896_397, 45 << 35)));
    }

    #[test]
    fn what_is_no_length_or_no_fraction_is_no_turn() {
        let scaling = Scaling::new(8_388_608, 360, false, 0.0).unwrap();
        for length in [
            0.0,
            -0.0,
            -360.0,
            f64::NAN,
            f64::INFINITY,
            f64::NEG_INFINITY,
            // Neither part fits 63 bits.
            f64::MAX,
            f64::MIN_POSITIVE,
            f64::from_bits(1),
        ] {
            assert_eq!(scaling.turn(length), None, "{length:?}");
        }
    }

    #[test]
    fn turns_that_are_no_whole_increments_add_up() {
        // A turn of 1 u is 10 / 3 increments.
        let scaling = Scaling::new(10, 3, false, 0.0).unwrap();
        let turn = scaling.turn(1.0).unwrap();
        for (turns, position, increments) in [
            (1, 0.0, 3),
            (2, 0.0, 7),
            (3, 0.0, 10),
            (1, 0.5, 5),
            (2, 0.5, 8),
            (-1, 0.0, -3),
            (-2, 0.0, -7),
        ] {
            assert_eq!(
                scaling.to_increments_turned(&turn, turns, position),
                increments,
                "{turns} {position}"
            );
        }
    }
}
