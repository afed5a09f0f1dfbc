//! Sums of products without rounding, and the law of a gear compared with them.

/// Bits of a limb; the rest of its 64 bits takes carries.
const BITS: usize = 32;

/// Limbs from 2^-1074 to above the largest number times 2^40.
const LIMBS: usize = 72;

/// A sum without rounding, as a whole number of 2^-1074.
struct Sum([i64; LIMBS]);

impl Sum {
    fn new() -> Self {
        Self([0; LIMBS])
    }

    /// Adds `times` times `value`.
    fn add(&mut self, times: i64, value: f64) {
        assert!(value.is_finite() && times.unsigned_abs() < 1 << 40);
        let bits = value.to_bits();
        let exponent = (bits >> 52 & 0x7ff) as usize;
        let fraction = bits & ((1 << 52) - 1);
        let (significand, power) = match exponent {
            0 => (fraction, 0),
            _ => (fraction | 1 << 52, exponent - 1),
        };
        let sign = if value.is_sign_negative() { -1 } else { 1 } * times.signum();
        let mut left = (u128::from(significand) * u128::from(times.unsigned_abs())) << (power % BITS);
        for limb in &mut self.0[power / BITS..] {
            if left == 0 {
                break;
            }
            *limb += sign * (left & 0xffff_ffff) as i64;
            left >>= BITS;
        }
    }

    /// The sign: -1, 0 or 1.
    fn sign(&self) -> i64 {
        let (mut carry, mut any) = (0, 0);
        for limb in self.0 {
            let value = limb + carry;
            carry = value >> BITS;
            any |= value & 0xffff_ffff;
        }
        if carry < 0 {
            -1
        } else {
            i64::from(carry | any != 0)
        }
    }
}

/// The positions of a master and its slave, as published.
#[derive(Clone, Copy, Debug)]
pub struct Row {
    /// Whole turns of the master.
    pub turns: i64,
    /// Position of the master (u).
    pub master: f64,
    /// The distance by which the slave sees it ahead (u).
    pub phase: f64,
    /// Position of the slave (u).
    pub slave: f64,
}

/// A gear, and the turns (u) of its modulo axes.
#[derive(Clone, Copy, Debug)]
pub struct Law {
    pub numerator: i32,
    pub denominator: u16,
    pub master_turn: Option<f64>,
    pub slave_turn: Option<f64>,
}

impl Law {
    /// Whether the slave of `row` is the exact value of the law through `anchor`, rounded once to the nearest number.
    pub fn holds(&self, anchor: &Row, row: &Row) -> bool {
        let (up, down) = (i64::from(self.numerator), i64::from(self.denominator));
        let turns = row.turns - anchor.turns;
        let length = self.master_turn.unwrap_or(0.0);
        // The approximate place of the law, to find the turn of the slave.
        let way = (row.master - anchor.master) + turns as f64 * length + (row.phase - anchor.phase);
        let about = anchor.slave + f64::from(self.numerator) * way / f64::from(self.denominator);
        let further = self
            .slave_turn
            .map_or(0, |length| ((about - row.slave) / length).round() as i64);
        // Twice `down` times the distance from `bound`, the middle between two numbers (times two), to the exact
        // place.
        let from = |(low, high): (f64, f64)| {
            let mut sum = Sum::new();
            sum.add(2 * down, anchor.slave);
            sum.add(2 * up, row.master);
            sum.add(-2 * up, anchor.master);
            sum.add(2 * up, row.phase);
            sum.add(-2 * up, anchor.phase);
            sum.add(2 * up * turns, length);
            sum.add(-2 * down * further, self.slave_turn.unwrap_or(0.0));
            sum.add(-down, low);
            sum.add(-down, high);
            sum.sign()
        };
        let rounds_to = |value: f64| {
            let is_even = value.to_bits() & 1 == 0;
            let (below, above) = (from((value.next_down(), value)), from((value, value.next_up())));
            (below > 0 && above < 0) || (is_even && below >= 0 && above <= 0)
        };
        // A value that rounds to a whole turn is 0 of the next one.
        let is_turn = |length: f64| {
            row.slave == 0.0 && from((length.next_down(), length)) >= 0 && from((length, length)) < 0
        };
        let others = self.slave_turn.is_some_and(|length| {
            // Below 0 by less than the resolution of a turn: it was counted as the turn before.
            let lower = (length - length.next_down()) / 2.0;
            is_turn(length) || (row.slave == 0.0 && from((-lower, -lower)) >= 0 && from((0.0, 0.0)) < 0)
        });
        rounds_to(row.slave) || others
    }
}

#[test]
fn a_law_is_rounded_once_and_no_neighbour_is_it() {
    let law = Law {
        numerator: 3,
        denominator: 7,
        master_turn: None,
        slave_turn: None,
    };
    let row = |master, slave| Row {
        turns: 0,
        master,
        phase: 0.0,
        slave,
    };
    let anchor = row(0.0, 0.0);
    // 3/7 and 3e-300/7 by one division each, which rounds once; three times these is exact.
    // 1, 2^-900 and 2^900.
    for exponent in [1023, 123, 1923] {
        let scale = f64::from_bits(exponent << 52);
        let exact = 3.0 * scale / 7.0;
        assert!(law.holds(&anchor, &row(scale, exact)));
        assert!(!law.holds(&anchor, &row(scale, exact.next_up())));
        assert!(!law.holds(&anchor, &row(scale, exact.next_down())));
    }
    // In the middle between two numbers it is the even one.
    let half = Law {
        numerator: 1,
        denominator: 2,
        ..law
    };
    let (odd, even) = (1.0_f64.next_up(), 1.0);
    let anchor = row(0.0, even);
    let middle = f64::EPSILON;
    assert!(half.holds(&anchor, &row(middle, even)));
    assert!(!half.holds(&anchor, &row(middle, odd)));
    assert!(half.holds(&anchor, &row(middle.next_up(), odd)));
}

#[test]
fn turns_of_both_are_counted() {
    let law = Law {
        numerator: 3,
        denominator: 7,
        master_turn: Some(360.0),
        slave_turn: Some(360.0),
    };
    let row = |turns, slave| Row {
        turns,
        master: 0.1,
        phase: 0.0,
        slave,
    };
    let anchor = row(0, 0.2);
    assert!(law.holds(&anchor, &row(7_000_000, 0.2)));
    assert!(!law.holds(&anchor, &row(7_000_000, 0.2_f64.next_up())));
    assert!(!law.holds(&anchor, &row(7_000_001, 0.2)));
    // A slave a little before a turn is at 0.
    let law = Law {
        numerator: 1,
        denominator: 1,
        ..law
    };
    let at = |master: f64, slave| Row {
        master,
        ..row(0, slave)
    };
    assert!(law.holds(&at(0.0, 0.0), &at(-1e-300, 0.0)));
    assert!(law.holds(&at(0.0, 0.0), &at(-1e-10, 360.0 - 1e-10)));
    assert!(!law.holds(&at(0.0, 0.0), &at(-1e-10, 0.0)));
}
