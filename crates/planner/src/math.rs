//! The few real functions the planner needs beyond `+ - * /`.

/// Square root, correctly rounded as IEEE 754 asks: the same bits from hardware and from software.
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

/// The smallest whole number >= `x`, for 0 <= `x` < 2^63.
#[inline]
pub fn ceil(x: f64) -> f64 {
    let whole = x as i64 as f64;
    if whole < x { whole + 1.0 } else { whole }
}

/// Cube root of a normal `x` > 0 within 6 %, a start for Newton's steps.
///
/// A third of the bit pattern is a third of the logarithm, up to a constant.
#[inline]
pub fn rough_cbrt(x: f64) -> f64 {
    const TWO_THIRDS_OF_ONE: u64 = 0x2A9F_7893_0000_0000;
    f64::from_bits(x.to_bits() / 3 + TWO_THIRDS_OF_ONE)
}
