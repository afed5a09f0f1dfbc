//! The law of an electronic gear: the slave's position for a position of its master, or of its two masters.
//!
//! This module has a ratio of integers, places with whole turns, and the law as a pure function of the master's
//! place. So no error accumulates from scan to scan. A master that returns to a place returns the slave to the same
//! bits. After any number of turns the slave has the place of the exact ratio. The module does not bring a slave
//! onto the law.

use crate::turns::{two_product, two_sum};

/// Bits of the significand of an f64.
const BITS: u32 = 53;

/// Whole turns must stay below this, so that their products fit into 128 bits.
const WHOLE_MOST: u128 = 1 << 63;

/// Products with larger numbers might overflow: 2^900.
const LARGE: f64 = 8.452_712_498_170_644e270;

/// Larger numbers are first multiplied by this factor, which changes no bit of them: 2^-120.
const SMALLER: f64 = 7.523_163_845_262_64e-37;

/// Distances times the ratio down to this size are found without a product that underflows.
const SHORTEST: f64 = 1e-200;

/// The remaining error of a few operations, relative to the summands: 2^-98.
const SHORT: f64 = 3.155_443_620_884_047e-30;

/// The place of an axis: whole turns, and the position (u), in the first turn on an axis with turns. An
/// axis without turns has 0 of them.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Place {
    /// Whole turns.
    pub turns: i64,
    /// Position (u).
    pub position: f64,
    /// The phase shift by which the axis is seen ahead of that (u); it is not part of the place. For a slave's
    /// place in an [`Anchor`]: the distance added to the law.
    pub phase: f64,
}

impl Place {
    /// The place in this turn, without a phase shift.
    #[inline]
    pub const fn new(turns: i64, position: f64) -> Self {
        Self {
            turns,
            position,
            phase: 0.0,
        }
    }

    /// The place at another `position` (u), counted from the same turn.
    #[inline]
    #[must_use]
    pub const fn moved_to(&self, position: f64) -> Self {
        Self { position, ..*self }
    }
}

/// A place of the master, and the slave's place when the master is there.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Anchor {
    /// The place of the master.
    pub master: Place,
    /// The place of the second master, for a slave that has two.
    pub second: Place,
    /// The place of the slave.
    pub slave: Place,
}

/// The turns of a slave for one turn of its master: two integers without a common divisor.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Turns {
    slave: i64,
    master: i64,
}

/// A gear between two axes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gear {
    /// Integers: of 16 bits and a sign, and of 16 bits.
    numerator: f64,
    denominator: f64,
    /// Length of a turn (u), for axes that have turns.
    master_turn: Option<f64>,
    slave_turn: Option<f64>,
    /// Where both have turns.
    turns: Option<Turns>,
}

/// A number of about 106 bits: the rounded value, and the rounding error.
pub(crate) type Double = (f64, f64);

impl Gear {
    /// The slave moves `numerator` / `denominator` times the distance of the master. The turns (u) are those of
    /// modulo axes, above 0 and finite.
    ///
    /// `None` if the denominator is 0, or if both axes have turns and the ratio of their turns is not a ratio of
    /// integers below 2^63.
    pub fn new(
        numerator: i16,
        denominator: u16,
        master_turn: Option<f64>,
        slave_turn: Option<f64>,
    ) -> Option<Self> {
        if denominator == 0 {
            return None;
        }
        let turns = match (master_turn, slave_turn) {
            (Some(master), Some(slave)) => Some(ratio_of_turns(numerator, denominator, master, slave)?),
            _ => None,
        };
        Some(Self {
            numerator: numerator.into(),
            denominator: denominator.into(),
            master_turn,
            slave_turn,
            turns,
        })
    }

    /// The largest magnitude of the numerator and the largest denominator that [`Gear::new`] accepts with
    /// any value of the other, if both axes have these turns (u); 0 if it accepts none.
    pub fn largest_ratio(master_turn: f64, slave_turn: f64) -> [f64; 2] {
        let Some([up, down]) = common_measures(master_turn, slave_turn) else {
            return [0.0; 2];
        };
        let divisor = common_divisor(up, down);
        let most = |turn: u128| (WHOLE_MOST - 1).checked_div(turn / divisor);
        [up, down].map(|turn| most(turn).map_or(0.0, |most| most as f64))
    }

    /// The same gear in the other direction: where the slave went up it goes down.
    pub fn reversed(self) -> Self {
        let reversed = |turns: Turns| Turns {
            slave: turns.slave.wrapping_neg(),
            ..turns
        };
        Self {
            numerator: -self.numerator,
            turns: self.turns.map(reversed),
            ..self
        }
    }

    /// Numerator and denominator.
    pub const fn ratio(&self) -> (i32, u16) {
        (self.numerator as i32, self.denominator as u16)
    }

    /// The slave's derivative for one of the master: the exact quotient except for two roundings.
    #[inline]
    pub fn derivative(&self, of_master: f64) -> f64 {
        // Adding 0 takes the sign from -0.
        self.numerator * of_master / self.denominator + 0.0
    }

    /// The slave's place for a `master` at its place: the exact value of the law, rounded once. The
    /// exception is a value so near the middle of two numbers that 106 bits do not decide.
    ///
    /// Cost: about 60 operations; about 150 if those leave the last bit open, if there is a shift, or if
    /// the slave has wrapped.
    #[inline(never)]
    pub fn slave(&self, anchor: &Anchor, master: Place) -> Place {
        let (turns, way) = self.way(&anchor.master, &master);
        if anchor.slave.phase == 0.0
            && let Some(position) = self.geared_shortly(anchor.slave.position, way)
            && self
                .slave_turn
                .is_none_or(|length| position >= 0.0 && position < length)
        {
            return Place {
                turns: anchor.slave.turns.wrapping_add(turns),
                position,
                ..Place::default()
            };
        }
        let start = two_sum(anchor.slave.position, anchor.slave.phase);
        self.placed(anchor, turns, self.geared(start, way))
    }

    /// Whether neither axis has turns and neither is shifted at the anchor. A master without a shift then
    /// has its slave at [`Gear::slave_straight`].
    pub fn is_straight(&self, anchor: &Anchor) -> bool {
        let has_turns = self.master_turn.is_some() || self.slave_turn.is_some();
        !has_turns && anchor.master.phase == 0.0 && anchor.slave.phase == 0.0
    }

    /// The position of [`Gear::slave`] for that of the master (u), inlined; `None` if it takes more than
    /// a few operations to decide.
    #[inline(always)]
    pub fn slave_straight(&self, anchor: &Anchor, master: f64) -> Option<f64> {
        debug_assert!(self.is_straight(anchor));
        self.geared_shortly(anchor.slave.position, two_sum(master, -anchor.master.position))
    }

    /// The slave's place for two masters at their places: the distances of both, each times its ratio, are added
    /// and rounded once to less than an ulp.
    ///
    /// Cost: about 200 operations.
    pub fn slave_of_two(&self, second: &Self, anchor: &Anchor, masters: [Place; 2]) -> Place {
        let (turns, way) = self.way(&anchor.master, &masters[0]);
        let (more, second_way) = second.way(&anchor.second, &masters[1]);
        let position = add(
            self.geared(two_sum(anchor.slave.position, anchor.slave.phase), way),
            second.geared((0.0, 0.0), second_way),
        );
        self.placed(anchor, turns.wrapping_add(more), position)
    }

    /// The distance of a master: the whole turns of the slave that it makes, and the rest (u of the master).
    #[inline(always)]
    fn way(&self, from: &Place, to: &Place) -> (i64, Double) {
        let whole = to.turns.wrapping_sub(from.turns);
        let within = two_sum(to.position, -from.position);
        if whole == 0 && to.phase == from.phase {
            return (0, within);
        }
        self.way_round(whole, within, two_sum(to.phase, -from.phase))
    }

    /// The same if the slave has wrapped or the master is shifted.
    #[inline(never)]
    fn way_round(&self, whole: i64, within: Double, phase: Double) -> (i64, Double) {
        // First, master turns that make whole turns of the slave are removed, so that no number grows with them.
        // The rest has the sign of the total, so that it is never the larger part.
        let (turns, whole) = match &self.turns {
            Some(ratio) => (
                // It is above 0, but nothing here proves it.
                whole
                    .checked_div(ratio.master)
                    .map_or(0, |turns| turns.wrapping_mul(ratio.slave)),
                whole.checked_rem(ratio.master).unwrap_or(whole),
            ),
            None => (0, whole),
        };
        let way = match self.master_turn {
            Some(length) => add(two_product(whole as f64, length), within),
            None => within,
        };
        let way = if phase.0 == 0.0 { way } else { add(way, phase) };
        (turns, way)
    }

    /// `position` as a place of the slave, this many whole turns further than the anchor.
    fn placed(&self, anchor: &Anchor, turns: i64, position: Double) -> Place {
        placed(self.slave_turn, anchor.slave.turns.wrapping_add(turns), position)
    }

    /// The rounded value of [`Gear::geared`], if a few operations prove it: either their error interval
    /// contains no rounding border, or they are exact. `None` otherwise.
    #[inline(always)]
    fn geared_shortly(&self, start: f64, (way, fine): Double) -> Option<f64> {
        let (numerator, denominator) = (self.numerator, self.denominator);
        let product = numerator * way;
        let product_lost = lost_in_product(numerator, way, product);
        let lost = product_lost + numerator * fine;
        let quotient = product / denominator;
        let left = -lost_in_product(denominator, quotient, product);
        let low = (left + lost) / denominator;
        let (high, below) = two_sum(start, quotient);
        let rest = below + low;
        let size = start.abs() + quotient.abs();
        // Products of numbers in between do not over- or underflow.
        if !(quotient.abs() > SHORTEST && size < LARGE) {
            return None;
        }
        let off = SHORT * size;
        let (least, most) = (high + (rest - off), high + (rest + off));
        if least == most {
            return Some(least + 0.0);
        }
        // A value in the middle of two numbers can be decided only by exact numbers.
        let is_exact = cut(fine) == fine
            && cut(low) == low
            && low * denominator == left + lost
            && is_sum(lost, product_lost, numerator * fine)
            && is_sum(left + lost, left, lost)
            && is_sum(rest, below, low);
        is_exact.then_some(high + rest + 0.0)
    }

    /// `start` and `way` times numerator by denominator. It is divided once, after the exact parts have
    /// been added, so that nothing is lost if they nearly cancel.
    #[inline(never)]
    fn geared(&self, start: Double, way: Double) -> Double {
        if start.0.abs() > LARGE || way.0.abs() > LARGE {
            // The number that is divided at last must not overflow before.
            let times = |number: Double, by: f64| (number.0 * by, number.1 * by);
            let position = self.geared_small(times(start, SMALLER), times(way, SMALLER));
            return times(position, 1.0 / SMALLER);
        }
        self.geared_small(start, way)
    }

    /// The same for numbers up to [`LARGE`].
    fn geared_small(&self, start: Double, way: Double) -> Double {
        let (numerator, denominator) = (self.numerator, self.denominator);
        let coarse = add(two_product(denominator, start.0), two_product(numerator, way.0));
        let fine = two_product(numerator, way.1);
        let fine = if start.1 == 0.0 {
            fine
        } else {
            add(fine, two_product(denominator, start.1))
        };
        divided(add(coarse, fine), denominator)
    }
}

/// The higher 26 bits of a number: its product with an integer of up to 27 bits is exact.
fn cut(number: f64) -> f64 {
    f64::from_bits(number.to_bits() & !((1 << 27) - 1))
}

/// Whether `sum`, that of `a` and `b` rounded, is exact; its excess over the larger one is always exact.
fn is_sum(sum: f64, a: f64, b: f64) -> bool {
    sum - a == b && sum - b == a
}

/// The rounding error of `integer`, of up to 17 bits, times `number`, relative to `near`, a number next
/// to that product: exact.
fn lost_in_product(integer: f64, number: f64, near: f64) -> f64 {
    let high = cut(number);
    (integer * high - near) + integer * (number - high)
}

pub(crate) fn add(a: Double, b: Double) -> Double {
    let (sum, error) = two_sum(a.0, b.0);
    let (low, low_error) = two_sum(a.1, b.1);
    let (sum, error) = two_sum(sum, error + low);
    two_sum(sum, error + low_error)
}

/// The same of a single number, in fewer steps.
pub(crate) fn plus(a: Double, b: f64) -> Double {
    let (sum, error) = two_sum(a.0, b);
    two_sum(sum, error + a.1)
}

/// `value` / `by`, as a rounded quotient and what rounding took away.
pub(crate) fn divided(value: Double, by: f64) -> Double {
    let quotient = value.0 / by;
    let (product, error) = two_product(quotient, by);
    let left = add(value, (-product, -error));
    two_sum(quotient, left.0 / by)
}

/// The place of a slave at `position`: after whole turns of its own on top of `turns`, if it has any.
#[inline]
pub(crate) fn placed(turn: Option<f64>, turns: i64, position: Double) -> Place {
    let (turns, position) = match turn {
        None => (0, position.0 + 0.0),
        Some(length) => {
            let (further, position) = in_first_turn(position, length);
            (turns.wrapping_add(further), position)
        }
    };
    Place {
        turns,
        position,
        ..Place::default()
    }
}

/// Whole turns, and the rest in [0, `length`).
fn in_first_turn(position: Double, length: f64) -> (i64, f64) {
    if position.0 > 0.0 && position.0 < length {
        return (0, position.0);
    }
    let rest = |turns: i64| {
        let (whole, error) = two_product(turns as f64, length);
        add(position, (-whole, -error))
    };
    let mut turns = (position.0 / length) as i64;
    let mut left = rest(turns);
    // The quotient is cut towards 0, and off by one at most.
    for _ in 0..2 {
        if left.0 < 0.0 {
            turns = turns.wrapping_sub(1);
            left = rest(turns);
        } else if left.0 >= length {
            turns = turns.wrapping_add(1);
            left = rest(turns);
        }
    }
    if left.0 >= length {
        (turns.wrapping_add(1), 0.0)
    } else {
        (turns, left.0.max(0.0) + 0.0)
    }
}

/// `numerator` / `denominator` times the quotient of two lengths above 0, in lowest terms.
fn ratio_of_turns(numerator: i16, denominator: u16, master: f64, slave: f64) -> Option<Turns> {
    let [master, slave] = common_measures(master, slave)?;
    let up = u128::from(numerator.unsigned_abs()) * master;
    let down = u128::from(denominator) * slave;
    let divisor = common_divisor(up, down);
    let (up, down) = (up / divisor, down / divisor);
    if up >= WHOLE_MOST || down >= WHOLE_MOST {
        return None;
    }
    let up = up as i64;
    Some(Turns {
        slave: if numerator < 0 { -up } else { up },
        master: down as i64,
    })
}

/// Two lengths above 0 as integers of at most 111 bits in a common unit.
fn common_measures(master: f64, slave: f64) -> Option<[u128; 2]> {
    let (master, master_power) = odd(master)?;
    let (slave, slave_power) = odd(slave)?;
    let shift = master_power - slave_power;
    // With 16 bits of a ratio 127; more than 58 bits of shift do not fit, for any common divisor.
    let shifted = |value: u64, by: i32| (by <= 58).then(|| u128::from(value) << by.max(0));
    Some([shifted(master, shift)?, shifted(slave, -shift)?])
}

/// A number above 0 as an odd integer times a power of two.
fn odd(value: f64) -> Option<(u64, i32)> {
    if !(value.is_normal() && value > 0.0) {
        return None;
    }
    let bits = value.to_bits();
    let significand = (bits & ((1 << (BITS - 1)) - 1)) | (1 << (BITS - 1));
    let power = (bits >> (BITS - 1)) as i32 - 1075;
    let zeros = significand.trailing_zeros();
    Some((significand >> zeros, power + zeros as i32))
}

/// Euclid's algorithm; `b` is above 0. Numbers of 128 bits take at most 186 steps.
fn common_divisor(mut a: u128, mut b: u128) -> u128 {
    for _ in 0..186 {
        if b == 0 {
            break;
        }
        (a, b) = (b, a % b);
    }
    a.max(1)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn place(turns: i64, position: f64) -> Place {
        Place {
            turns,
            ..at(position)
        }
    }

    fn at(position: f64) -> Place {
        Place {
            position,
            ..Place::default()
        }
    }

    fn gear(numerator: i16, denominator: u16) -> Gear {
        Gear::new(numerator, denominator, None, None).unwrap()
    }

    /// Covers: G22, G26
    #[test]
    fn powers_of_two_from_zero_are_exact_and_signs_mirror() {
        let anchor = Anchor::default();
        for position in [0.1, 27.000_000_000_000_004, -1e290, 5e-324, 0.0] {
            for (numerator, denominator, factor) in [(1, 2, 0.5), (2, 1, 2.0), (1, 4, 0.25)] {
                let gear = gear(numerator, denominator);
                let mirrored = Gear::new(-numerator, denominator, None, None).unwrap();
                assert_eq!(gear.slave(&anchor, at(position)).position, position * factor);
                assert_eq!(
                    mirrored.slave(&anchor, at(position)).position,
                    -(position * factor) + 0.0
                );
            }
        }
    }

    #[test]
    fn the_largest_positions_have_a_law() {
        let anchor = Anchor {
            slave: at(-2e300),
            ..Anchor::default()
        };
        for (numerator, denominator) in [(1, 3), (-1, 65535), (i16::MAX, 7)] {
            let gear = gear(numerator, denominator);
            assert_eq!(gear.slave(&anchor, at(40.0)).position, -2e300);
            assert_eq!(gear.slave(&Anchor::default(), at(f64::MAX / 32768.0)).position, {
                f64::MAX / 32768.0 * f64::from(numerator) / f64::from(denominator)
            });
        }
        assert_eq!(
            gear(1, 1).slave(&Anchor::default(), at(f64::MAX)).position,
            f64::MAX
        );
        let far = Anchor {
            slave: at(f64::MAX / 2.0),
            ..Anchor::default()
        };
        assert_eq!(gear(1, 2).slave(&far, at(-f64::MAX)).position, 0.0);
    }

    /// The exact law in integers, rounded once: positions are multiples of 2^-20.
    fn exact(numerator: i128, denominator: i128, anchor: (i128, i128), master: i128) -> f64 {
        let up = anchor.1 * denominator + numerator * (master - anchor.0);
        let (sign, up) = (up.signum(), up.unsigned_abs());
        let down = denominator.unsigned_abs();
        // 104 bits of the quotient and whether there is a remainder decide the rounding.
        let shift = up.leading_zeros().saturating_sub(8);
        let (quotient, left) = ((up << shift) / down, (up << shift) % down);
        let odd = quotient | u128::from(left != 0);
        sign as f64 * (odd as f64) / (1_u128 << shift) as f64 / (1_u64 << 20) as f64
    }

    /// Covers: G21, G25, G34
    #[test]
    fn the_law_is_the_exact_value_rounded_once() {
        let mut random = standstill_testkit::Random(1);
        let mut next = |below: u64| i128::from(random.below(below));
        for _ in 0..200_000 {
            let numerator = next(65_535) - 32_767;
            let denominator = 1 + next(65_535);
            let (m0, x0) = (next(1 << 30) - (1 << 29), next(1 << 30) - (1 << 29));
            let m = next(1 << 31) - (1 << 30);
            let unit = 1.0 / (1_u64 << 20) as f64;
            let anchor = Anchor {
                master: at(m0 as f64 * unit),
                slave: at(x0 as f64 * unit),
                ..Anchor::default()
            };
            let gear = gear(numerator as i16, denominator as u16);
            let slave = gear.slave(&anchor, at(m as f64 * unit)).position;
            let expected = exact(numerator, denominator, (m0, x0), m);
            assert_eq!(slave, expected, "{numerator}/{denominator} {m0} {x0} {m}");
        }
    }

    /// Numbers of many and of few bits, of any size, so that sums are exact, are in the middle of two numbers, or
    /// nearly cancel.
    #[test]
    fn in_a_few_operations_the_law_is_the_same_to_the_bit() {
        let mut random = standstill_testkit::Random(4);
        let mut told = 0;
        let rounds = 300_000;
        for _ in 0..rounds {
            let denominator = match random.below(3) {
                0 => 1 << random.below(16),
                1 => 1 + random.below(12),
                _ => 1 + random.below(65_535),
            };
            let numerator = (random.below(32_768) >> random.below(15)) as i16;
            let numerator = if random.below(2) == 0 {
                numerator
            } else {
                -numerator
            };
            let mut number = |size: i32| {
                let bits = 1 + random.below(53) as u32;
                let power = size - 52 + random.below(8) as i32;
                random.sign()
                    * (random.below(1 << bits) as f64)
                    * f64::from_bits(((1023 + i64::from(power)) as u64) << 52)
            };
            let m0 = number(0);
            let m = match (m0.to_bits() >> 7) % 4 {
                0 => m0 + number(-20),
                1 => m0.next_up(),
                2 => number(0),
                _ => number(12),
            };
            let x0 = match (m0.to_bits() >> 9) % 4 {
                0 => -(m - m0) * f64::from(numerator) / denominator as f64,
                1 => number(30),
                2 => number(-30),
                _ => number(0),
            };
            let gear = gear(numerator, denominator as u16);
            let anchor = Anchor {
                master: at(m0),
                slave: at(x0),
                ..Anchor::default()
            };
            let way = two_sum(m, -m0);
            let expected = gear.geared((x0, 0.0), way).0 + 0.0;
            let shortly = gear.geared_shortly(x0, way);
            told += u64::from(shortly.is_some());
            let all = [
                shortly.unwrap_or(expected),
                gear.slave_straight(&anchor, m).unwrap_or(expected),
                gear.slave(&anchor, at(m)).position,
            ];
            for position in all {
                assert_eq!(
                    position.to_bits(),
                    expected.to_bits(),
                    "{gear:?} {m0:e} {m:e} {x0:e}"
                );
            }
        }
        assert!(told > rounds / 2, "{told} of {rounds}");
    }

    /// A slave that returns to 0: the result is far smaller than the numbers it is made of.
    ///
    /// Covers: G25
    #[test]
    fn next_to_zero_it_is_still_the_exact_value_rounded_once() {
        let mut random = standstill_testkit::Random(2);
        let unit = 1.0 / (1_u64 << 20) as f64;
        let in_units = |value: i128| value as f64 * unit;
        for _ in 0..200_000 {
            let numerator = (1 + i128::from(random.below(32_767))) * random.sign() as i128;
            let denominator = 1 + i128::from(random.below(65_535));
            let x0 = i128::from(random.below(1 << 53));
            let m0 = i128::from(random.below(1 << 40)) * i128::from(random.below(2));
            // As near to the master's place for 0 as a number can be.
            let m = (m0 - x0 * denominator / numerator) as f64 as i128;
            let anchor = Anchor {
                master: at(in_units(m0)),
                slave: at(in_units(x0)),
                ..Anchor::default()
            };
            let gear = gear(numerator as i16, denominator as u16);
            let slave = gear.slave(&anchor, at(in_units(m))).position;
            let expected = exact(numerator, denominator, (m0, x0), m);
            assert_eq!(slave, expected, "{numerator}/{denominator} {m0} {x0} {m}");
        }
    }

    /// Covers: G31, GS16
    #[test]
    fn turns_are_integers_however_many() {
        let gear = Gear::new(3, 7, Some(360.0), Some(360.0)).unwrap();
        let anchor = Anchor {
            master: at(0.1),
            slave: at(0.2),
            ..Anchor::default()
        };
        // After 7 turns of the master the slave has the bits it started with; in between a seventh of 3 turns more for each.
        for whole in [0_i64, 1, 6, 7, 1_000_000, 5_000_000, -1, -8, 1 << 60] {
            let slave = gear.slave(&anchor, place(whole, 0.1));
            let sevenths = (i128::from(whole) * 3).rem_euclid(7);
            let expected = 0.2 + 360.0 * sevenths as f64 / 7.0;
            assert!((slave.position - expected).abs() <= 6e-14, "{whole}: {slave:?}");
            assert_eq!(
                i128::from(slave.turns),
                (i128::from(whole) * 3).div_euclid(7),
                "{whole}"
            );
            if whole % 7 == 0 {
                assert_eq!(slave.position, 0.2, "{whole}");
            }
        }
    }

    /// Covers: G60, G64
    #[test]
    fn a_shift_of_the_master_counts_as_its_way_does() {
        let gear = gear(-2, 1);
        let shifted = Place {
            phase: 0.1,
            ..at(0.2)
        };
        let anchor = Anchor {
            master: at(0.0),
            slave: at(1.0),
            ..Anchor::default()
        };
        // The exact sum of both numbers, rounded once.
        assert_eq!(gear.slave(&anchor, shifted).position, 0.399_999_999_999_999_97);
        let anchor = Anchor {
            master: shifted,
            slave: at(1.0),
            ..Anchor::default()
        };
        assert_eq!(gear.slave(&anchor, shifted).position, 1.0);
    }

    /// Covers: G65
    #[test]
    fn the_law_of_two_masters_is_the_sum_of_both_but_for_an_ulp() {
        let mut random = standstill_testkit::Random(3);
        let unit = 1.0 / (1_u64 << 20) as f64;
        let in_units = |value: i128| at(value as f64 * unit);
        for _ in 0..200_000 {
            let mut next = |below: u64| i128::from(random.below(below));
            let numerators = [next(65_535) - 32_767, next(65_535) - 32_767];
            let denominators = [1 + next(65_535), 1 + next(65_535)];
            let from = [next(1 << 30) - (1 << 29), next(1 << 30) - (1 << 29)];
            let to = [next(1 << 31) - (1 << 30), next(1 << 31) - (1 << 30)];
            let x0 = next(1 << 30) - (1 << 29);
            let gears = [0, 1].map(|leg| gear(numerators[leg] as i16, denominators[leg] as u16));
            let anchor = Anchor {
                master: in_units(from[0]),
                second: in_units(from[1]),
                slave: in_units(x0),
            };
            let masters = to.map(in_units);
            let down = denominators[0] * denominators[1];
            let ways = [0, 1].map(|leg| numerators[leg] * denominators[1 - leg] * (to[leg] - from[leg]));
            let sum = |sign: i128| (x0 * down + ways[0] + sign * ways[1]) as f64 / down as f64 * unit;
            for (second, wanted) in [(gears[1], sum(1)), (gears[1].reversed(), sum(-1))] {
                let slave = gears[0].slave_of_two(&second, &anchor, masters).position;
                let ulp = f64::EPSILON * wanted.abs().max(unit);
                assert!((slave - wanted).abs() <= 2.0 * ulp, "{gears:?} {slave} {wanted}");
            }
        }
    }

    /// Covers: G65
    #[test]
    fn turns_of_two_masters_are_integers() {
        let round =
            |numerator, denominator| Gear::new(numerator, denominator, Some(360.0), Some(360.0)).unwrap();
        let (first, second) = (round(3, 7), round(2, 5).reversed());
        let anchor = Anchor {
            master: at(0.1),
            second: at(0.2),
            slave: at(0.3),
        };
        for whole in [0_i64, 1, -1, 5_000_000, 1 << 50] {
            let masters = [place(7 * whole, 0.1), place(5 * whole, 0.2)];
            let slave = first.slave_of_two(&second, &anchor, masters);
            assert_eq!(slave, place(3 * whole - 2 * whole, 0.3), "{whole}");
        }
    }

    /// Covers: G33
    #[test]
    fn a_slave_without_turns_unwinds_those_of_its_master() {
        let gear = Gear::new(3, 7, Some(360.0), None).unwrap();
        let slave = gear.slave(&Anchor::default(), place(1_000_000, 180.0));
        // 3 * 360000180 / 7 to the last bit: numerator and denominator are exact.
        assert_eq!(slave, at(1_080_000_540.0 / 7.0));
    }

    #[test]
    fn turns_without_a_short_common_measure_are_exact_both_ways() {
        let gear = Gear::new(-1, 2, Some(0.05), Some(2.0)).unwrap();
        for (turns, position, expected) in [(-1, 0.04975, 0.000_125), (1, 0.00025, 1.974_875)] {
            let slave = gear.slave(&Anchor::default(), place(turns, position));
            assert!((slave.position - expected).abs() < 1e-15, "{slave:?}");
        }
    }

    #[test]
    fn a_slave_with_turns_stays_in_the_first() {
        let gear = Gear::new(1, 1, None, Some(360.0)).unwrap();
        for (master, turns, position) in [
            (359.0, 0, 359.0),
            (360.0, 1, 0.0),
            (-0.5, -1, 359.5),
            (-360.0, -1, 0.0),
            (725.5, 2, 5.5),
            (-1e-300, 0, 0.0),
        ] {
            assert_eq!(
                gear.slave(&Anchor::default(), at(master)),
                place(turns, position),
                "{master}"
            );
        }
    }

    #[test]
    fn ratios_that_do_not_fit_and_a_denominator_of_0_are_told() {
        assert_eq!(Gear::new(1, 0, None, None), None);
        assert!(Gear::new(1, 32, Some(core::f64::consts::TAU), Some(360.0)).is_some());
        assert_eq!(
            Gear::new(1, 32_767, Some(core::f64::consts::TAU), Some(0.1)),
            None
        );
        assert_eq!(Gear::new(1, 1, Some(1e300), Some(1e-300)), None);
        assert!(Gear::new(0, 5, Some(360.0), Some(100.0)).is_some());
    }

    #[test]
    fn the_largest_ratio_is_taken_and_one_above_it_is_not() {
        // 2 pi is 884279719003555 / 2^47, and 0.45 is 8106479329266893 / 2^54.
        let turns = [core::f64::consts::TAU, 0.45];
        let [numerator, denominator] = Gear::largest_ratio(turns[0], turns[1]);
        assert_eq!([numerator, denominator], [81.0, 1137.0]);
        let takes = |up, down| Gear::new(up, down, Some(turns[0]), Some(turns[1])).is_some();
        assert!(takes(81, 1137) && takes(-81, 1137));
        // An even denominator goes into the even numerator.
        assert!(takes(1, 1138) && !takes(1, 1139) && !takes(82, 1) && !takes(-82, 1));
        assert_eq!(Gear::largest_ratio(1e300, 1e-300), [0.0; 2]);
        let [numerator, denominator] = Gear::largest_ratio(360.0, 400.0);
        assert!(numerator > 1e17 && denominator > 1e17);
    }

    #[test]
    fn a_single_number_is_added_like_a_sum_of_two() {
        let mut random = standstill_testkit::Random(5);
        let mut number = || {
            let any = random.log(1e-20, 1e20);
            random.sign() * random.one_of(&[0.0, 1.0, 5e-324, 1e30, any, any, any])
        };
        for _ in 0..standstill_testkit::cases(100_000) {
            let (a, b) = (two_sum(number(), number()), number());
            assert_eq!(plus(a, b), add(a, (b, 0.0)), "{a:?} and {b}");
        }
    }

    #[test]
    fn a_numerator_of_0_stands() {
        let gear = gear(0, 5);
        assert_eq!(
            gear.slave(
                &Anchor {
                    master: at(3.0),
                    slave: at(7.25),
                    ..Anchor::default()
                },
                at(1e9)
            ),
            at(7.25)
        );
        assert_eq!(gear.derivative(12.0), 0.0);
    }
}
