//! Units in which the bound on the highest derivative is 1.

use super::Spans;
use crate::math::sqrt;

/// A change of units: time by a power of two, which is exact, and lengths so that the input bound is 1.
///
/// Because time is scaled by a power of two only, problems that differ by powers of two in length and time
/// get the same bits (R1).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Scale {
    time: f64,
    input: f64,
}

impl Scale {
    /// The user's own units, whose input bounds may differ by sign (order 2).
    pub(crate) const NONE: Self = Self {
        time: 1.0,
        input: 1.0,
    };

    /// Units for the input bound `input` and the bound `rate` of the derivative one below (`levels` 1) or
    /// two below (`levels` 2) it.
    pub fn new(rate: f64, input: f64, levels: u32) -> Self {
        let ratio = rate / input;
        let time = if levels == 1 { ratio } else { sqrt(ratio) };
        Self {
            time: power_of_two(time),
            input,
        }
    }

    /// `value`, `levels` (at most 4) integrations above the input, in the units of the kernel.
    pub fn inward(&self, value: f64, levels: u32) -> f64 {
        // Of a power of two, exact.
        let rate = 1.0 / self.time;
        let mut scaled = value / self.input;
        for _ in 0..levels.min(4) {
            scaled *= rate;
        }
        scaled
    }

    /// A value of the kernel, `levels` (at most 4) integrations above the input, in the user's unit.
    pub(crate) fn outward_value(&self, value: f64, levels: u32) -> f64 {
        let mut scaled = value * self.input;
        for _ in 0..levels.min(4) {
            scaled *= self.time;
        }
        scaled
    }

    /// A duration of the kernel in seconds.
    pub const fn seconds(&self, duration: f64) -> f64 {
        duration * self.time
    }

    /// A duration in seconds in the units of the kernel.
    pub(crate) const fn moments(&self, seconds: f64) -> f64 {
        seconds / self.time
    }

    /// Spans as (seconds, input in the user's unit).
    pub(crate) fn outward<const N: usize>(&self, spans: &Spans<N>) -> impl Iterator<Item = (f64, f64)> {
        spans
            .iter()
            .map(|span| (self.seconds(span.duration), self.input(span.input)))
    }

    /// An input of the kernel in the user's unit.
    pub const fn input(&self, input: f64) -> f64 {
        input * self.input
    }
}

/// The power of two at or below a positive number; 1 where there is none.
fn power_of_two(x: f64) -> f64 {
    const EXPONENT: u64 = 0x7ff << 52;
    if x.is_normal() {
        f64::from_bits(x.to_bits() & EXPONENT)
    } else {
        1.0
    }
}
