//! Takes whole turns off a position without rounding.
//!
//! This module has sums and products with their rounding errors, and splits a position into whole lengths
//! and a rest. The two exact transformations are Knuth's sum and Dekker's product (T. J. Dekker, "A
//! floating-point technique for extending the available precision", 1971, equations 4.14 and 5.12). They
//! need only rounded `+ - *`.

/// 2^27 + 1 cuts 53 bits into two halves whose products are exact.
const SPLITTER: f64 = 134_217_729.0;

/// `a + b` as the rounded sum and its rounding error.
pub fn two_sum(a: f64, b: f64) -> (f64, f64) {
    let sum = a + b;
    let b_part = sum - a;
    let a_part = sum - b_part;
    (sum, (a - a_part) + (b - b_part))
}

/// `a * b` as the rounded product and its rounding error; exact while neither over- nor underflows.
pub fn two_product(a: f64, b: f64) -> (f64, f64) {
    let halves = |x: f64| {
        let big = SPLITTER * x;
        let high = big - (big - x);
        (high, x - high)
    };
    let product = a * b;
    let ((a_high, a_low), (b_high, b_low)) = (halves(a), halves(b));
    let error = ((a_high * b_high - product) + a_high * b_low + a_low * b_high) + a_low * b_low;
    (product, error)
}

/// `position` (u) as whole `length`s (u, above 0) and a rest in [0, `length`).
///
/// The rest is exact, except for positions less than a length below 0, where it is rounded once; if it
/// rounds to the length it is the 0 of the next one. Positions beyond 2^53 lengths have the rest 0.
#[inline]
pub fn split(position: f64, length: f64) -> (i64, f64) {
    if position >= 0.0 && position < length {
        // Adding 0 removes the sign of -0.
        return (0, position + 0.0);
    }
    split_far(position, length)
}

#[inline(never)]
fn split_far(position: f64, length: f64) -> (i64, f64) {
    let rest = |turns: i64| {
        let (whole, error) = two_product(turns as f64, length);
        (position - whole) - error
    };
    let mut turns = (position / length) as i64;
    let mut left = rest(turns);
    // The quotient is off by one at most.
    if left < 0.0 {
        turns = turns.saturating_sub(1);
        left = rest(turns);
    } else if left >= length {
        turns = turns.saturating_add(1);
        left = rest(turns);
    }
    if left >= 0.0 && left < length {
        (turns, left + 0.0)
    } else if left >= length {
        (turns.saturating_add(1), 0.0)
    } else {
        (turns, 0.0)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn what_rounding_takes_away_is_told() {
        assert_eq!(two_sum(1e16, 1.5), (1e16 + 2.0, -0.5));
        let (product, error) = two_product(1.0 + f64::EPSILON, 1.0 + f64::EPSILON);
        assert_eq!(
            (product, error),
            (1.0 + 2.0 * f64::EPSILON, f64::EPSILON * f64::EPSILON)
        );
    }

    #[test]
    fn a_rest_is_always_inside_and_the_turns_belong_to_it() {
        for (position, turns, rest) in [
            (0.0, 0, 0.0),
            (-0.0, 0, 0.0),
            (359.5, 0, 359.5),
            (360.0, 1, 0.0),
            (-360.0, -1, 0.0),
            (-0.25, -1, 359.75),
            (725.5, 2, 5.5),
            (-725.5, -3, 354.5),
            (360e9 + 0.5, 1_000_000_000, 0.5),
            // So near below 0 that it is 0.
            (-1e-300, 0, 0.0),
        ] {
            assert_eq!(split(position, 360.0), (turns, rest), "{position}");
        }
    }

    #[test]
    fn a_length_of_all_bits_loses_none_of_them() {
        let length = core::f64::consts::TAU;
        assert_eq!(split(4461.0, length).0, 709);
        for position in [4461.0, 1e9, -1e9, 1e14, -1e14] {
            let (turns, rest) = split(position, length);
            assert!((0.0..length).contains(&rest));
            let (whole, error) = two_product(turns as f64, length);
            assert_eq!((position - whole) - error, rest);
        }
    }
}
