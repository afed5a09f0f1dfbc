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
