//! The few real functions the planner needs beyond `+ - * /`.

/// Square root, correctly rounded as IEEE 754 requires: the same bits from hardware and from software.
#[inline]
pub fn sqrt(x: f64) -> f64 {
    #[cfg(feature = "std")]
    {
        x.sqrt()
    }
    #[cfg(not(feature = "std"))]
    {
        libm::sqrt(x)
    }
}

/// The larger of two numbers that are not NaN. It is one instruction; `f64::max` also handles NaN.
#[inline]
pub fn max(a: f64, b: f64) -> f64 {
    if a > b { a } else { b }
}

/// The smaller of two numbers that are not NaN.
#[inline]
pub fn min(a: f64, b: f64) -> f64 {
    if a < b { a } else { b }
}

/// From here on every `f64` is whole.
const WHOLE: f64 = (1_u64 << 52) as f64;

/// The nearest whole number to `x` >= 0: from [`WHOLE`] on a sum has no room for a fraction. This takes
/// two additions. A conversion to an integer and back would also check the range.
#[inline]
fn nearest(x: f64) -> f64 {
    if x < WHOLE { (x + WHOLE) - WHOLE } else { x }
}

/// The largest whole number <= `x`, for `x` >= 0.
#[inline]
pub fn floor(x: f64) -> f64 {
    let nearest = nearest(x);
    if nearest > x { nearest - 1.0 } else { nearest }
}

/// The smallest whole number >= `x`, for `x` >= 0.
#[inline]
pub fn ceil(x: f64) -> f64 {
    let nearest = nearest(x);
    if nearest < x { nearest + 1.0 } else { nearest }
}

/// Cube root of a normal `x` > 0 within 6 %, a start for Newton's steps.
///
/// A third of the bit pattern is a third of the logarithm, up to a constant.
#[inline]
pub fn rough_cbrt(x: f64) -> f64 {
    const TWO_THIRDS_OF_ONE: u64 = 0x2A9F_7893_0000_0000;
    f64::from_bits(x.to_bits() / 3 + TWO_THIRDS_OF_ONE)
}

/// `x` to the power of `exponent` within 1 %, for a normal `x` of at most 1 and an `exponent` of 0 to 1.
pub fn rough_power(x: f64, exponent: f64) -> f64 {
    /// Largest distance of a logarithm above the straight line between two powers of two, as a parabola.
    const ABOVE: f64 = 0.335;
    const BIAS: f64 = 1023.0;
    let one = 1.0_f64.to_bits();
    let (mantissa, digits) = (x.to_bits() & ((1 << 52) - 1), x.to_bits() >> 52);
    let part = f64::from_bits(one | mantissa) - 1.0;
    let logarithm = (digits as f64 - BIAS) + part * (1.0 + ABOVE * (1.0 - part));
    let raised = max(exponent * logarithm + BIAS, 0.0);
    let whole = floor(raised);
    let part = raised - whole;
    f64::from_bits((whole as u64) << 52) * (1.0 + part * (1.0 - ABOVE * (1.0 - part)))
}

/// Cube root of `x` >= 0 within an ulp or two: five of Newton's steps are enough from 6 %.
pub fn cbrt(x: f64) -> f64 {
    /// Scales numbers below the normal range into it; its cube root is 2^54.
    const LIFT: f64 = ((1_u128 << 81) as f64) * ((1_u128 << 81) as f64);
    if x == 0.0 {
        return 0.0;
    }
    if !x.is_normal() {
        return cbrt_of_normal(x * LIFT) / (1_u64 << 54) as f64;
    }
    cbrt_of_normal(x)
}

fn cbrt_of_normal(x: f64) -> f64 {
    (0..5).fold(rough_cbrt(x), |root, _| root - (root - x / (root * root)) / 3.0)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rough_power_is_within_one_per_cent() {
        for step in 1..=1000 {
            let root = 1.001 * f64::from(step) / 1001.0;
            let mut power = root;
            for exponent in 1..=6 {
                let found = rough_power(power, 1.0 / f64::from(exponent));
                assert!(
                    (found - root).abs() <= 0.01 * root,
                    "{power} {exponent}: {found}, not {root}"
                );
                power *= root;
            }
        }
    }
}
