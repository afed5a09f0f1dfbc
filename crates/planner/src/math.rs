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
