//! Time-optimal transfers of a chain of integrators: push, then stop.
//!
//! This module finds the least-time transfer from any state of a second- or third-order chain to rest at a value,
//! under bounds on everything in between. The caller decides what the value is: [`third`] takes `(velocity,
//! acceleration, jerk)` to a velocity under a snap bound, and `(position, velocity, acceleration)` to a position
//! under a jerk bound. The module does not have units, limits with names, or sampling.
//!
//! Everything here is dimensionless: the bound on the highest derivative, the *input*, is 1 (see [`Scale`]).
//! Equations (R1) and on are in `docs/planner-ramps.md`.
//!
//! Continuity is important: a state within [`ON_LIMIT`] of a bound is on it, so that one rounding error outwards
//! never turns into a braking manoeuvre.

mod root;
mod scale;
mod second;
mod spans;
mod third;
mod zero;

pub use root::{MAX_STEPS, falling_root};
pub use scale::Scale;
pub use second::second;
pub(crate) use second::second_in_three;
pub(crate) use spans::Appended;
pub use spans::{Span, Spans};
pub use third::{Bounds, Profile, THIRD_SPANS, third};
pub(crate) use third::{append_third, gain};
pub use zero::{Point, zero};

/// Largest distance outside a bound at which a state still counts as on it, relative to the bound.
pub const ON_LIMIT: f64 = 1e-9;

/// Gaps smaller than this, relative to the sum from which they result, are rounding: nothing moves because of them.
pub(crate) const NOISE: f64 = 16.0 * f64::EPSILON;

/// A pair of bounds as magnitudes: the value stays in `-minus ..= plus`. Infinite means no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sides {
    /// Largest magnitude below zero.
    pub minus: f64,
    /// Largest magnitude above zero.
    pub plus: f64,
}

impl Sides {
    /// The same magnitude on both sides.
    pub const fn both(bound: f64) -> Self {
        Self {
            minus: bound,
            plus: bound,
        }
    }

    /// The bounds of the mirrored problem.
    pub const fn mirrored(self) -> Self {
        Self {
            minus: self.plus,
            plus: self.minus,
        }
    }

    /// Both changed alike.
    pub(crate) fn map(self, change: impl Fn(f64) -> f64) -> Self {
        Self {
            minus: change(self.minus),
            plus: change(self.plus),
        }
    }

    /// The one of a value with the sign of `side`.
    pub(crate) const fn towards(self, side: f64) -> f64 {
        if side < 0.0 { self.minus } else { self.plus }
    }

    /// The lower one.
    pub(crate) const fn lower(self) -> f64 {
        if self.plus <= self.minus {
            self.plus
        } else {
            self.minus
        }
    }
}

/// An upper bound, raised to `value` if `value` is outside by no more than [`ON_LIMIT`].
fn raised_to(value: f64, bound: f64) -> f64 {
    let on = value > bound && value <= bound * (1.0 + ON_LIMIT);
    if on { value } else { bound }
}
