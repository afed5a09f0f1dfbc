//! From limits and a distance to four whole numbers: the only rounding of planning.

use crate::{Field, Limits, Order, PlanError};

/// A ratio counts as reached when it is missed by less than 2^-40 of itself, so that decimal inputs give
/// their nominal counts (docs/planner.md, eq. 7).
const ONE_LESS_SLACK: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// Most scans a plan can count: 2^31 - 1.
pub(super) const LONGEST: u64 = (1 << 31) - 1;

/// Box lengths n1..n4 in scans; the boxes an order does without are 0 (docs/planner.md, eq. 4).
pub(super) type Boxes = [u64; 4];

/// A rest-to-rest problem on the grid: find the boxes of the least sum whose products reach the thresholds.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem {
    /// How many boxes there are.
    pub order: Order,
    /// Least n4.
    pub k4: u64,
    /// Least n3 n4.
    pub k3: u64,
    /// Least n2 n3 n4.
    pub k2: u128,
    /// Least n1 n2 n3 n4.
    pub k1: u128,
}

impl Problem {
    /// The thresholds of a move of `distance` > 0 (u) under checked `limits` and `cycle` (s)
    /// (docs/planner.md, eq. 7).
    ///
    /// # Errors
    /// [`PlanError::TooLong`] names the first bound that alone needs more than 2^31 scans.
    pub fn new(distance: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        let Limits {
            velocity: v,
            jerk: j,
            snap: s,
            ..
        } = *limits;
        let a = limits.lower_acceleration();
        // A box product of a plan that can be counted is below (2^31)^m at m boxes, and below 2^116 at four
        // because the boxes sum to N (docs/planner.md, eq. 8).
        let k4 = threshold(distance / (v * cycle), 31, Field::LimitVelocity, v)?;
        let k3 = threshold(distance / (a * cycle * cycle), 62, acceleration_field(limits), a)?;
        let k2 = threshold(distance / (j * cycle * cycle * cycle), 93, Field::LimitJerk, j)?;
        let k1 = threshold(
            distance / (s * cycle * cycle * cycle * cycle),
            116,
            Field::LimitSnap,
            s,
        )?;
        Ok(Self {
            order: limits.order(),
            k4: k4 as u64,
            k3: k3 as u64,
            k2,
            k1,
        })
    }

    /// The least n4 that reaches all thresholds with the other boxes given.
    pub fn least_n4(&self, n1: u64, n2: u64, n3: u64) -> u64 {
        let (n1, n2, n3) = (u128::from(n1.max(1)), u128::from(n2.max(1)), u128::from(n3));
        let least = u128::from(self.k4)
            .max(u128::from(self.k3).div_ceil(n3))
            .max(self.k2.div_ceil(n2 * n3))
            .max(self.k1.div_ceil(n1 * n2 * n3));
        u64::try_from(least).unwrap_or(u64::MAX)
    }

    /// The bound that alone makes the move longest, for the message of a refusal.
    pub fn slowest(&self, limits: &Limits) -> PlanError {
        // Fourth powers of the number of scans each bound needs alone: N = K4, 2 sqrt(K3), cbrt(32 K2) or
        // (512 K1)^(1/4). The jerk's is bracketed without a cube root: (32 K2)^4 against the others cubed
        // would overflow nothing in f64, so all are compared as twelfth powers.
        let cube = |x: f64| x * x * x;
        let fourth = |x: f64| (x * x) * (x * x);
        let (k4, k3) = (self.k4 as f64, self.k3 as f64);
        let (k2, k1) = (self.k2 as f64, self.k1 as f64);
        let candidates = [
            (cube(fourth(k4)), Field::LimitVelocity, limits.velocity),
            (
                cube((4.0 * k3) * (4.0 * k3)),
                acceleration_field(limits),
                limits.lower_acceleration(),
            ),
            (fourth(32.0 * k2), Field::LimitJerk, limits.jerk),
            (cube(512.0 * k1), Field::LimitSnap, limits.snap),
        ];
        let [mut worst, ..] = candidates;
        for candidate in candidates {
            if candidate.0 > worst.0 {
                worst = candidate;
            }
        }
        PlanError::TooLong {
            field: worst.1,
            value: worst.2,
        }
    }
}

/// The smallest whole number, at least 1, that reaches `ratio` within the slack.
fn threshold(ratio: f64, bits: i32, field: Field, value: f64) -> Result<u128, PlanError> {
    if ratio > (1_u128 << bits) as f64 {
        return Err(PlanError::TooLong { field, value });
    }
    Ok(ceil(ratio * ONE_LESS_SLACK).max(1))
}

/// The smallest whole number >= `x`, for 0 <= `x` < 2^127.
fn ceil(x: f64) -> u128 {
    let whole = x as u128;
    whole + u128::from((whole as f64) < x)
}

/// The one of the two fields whose bound is used.
fn acceleration_field(limits: &Limits) -> Field {
    if limits.acceleration <= limits.deceleration {
        Field::LimitAcceleration
    } else {
        Field::LimitDeceleration
    }
}

/// A ratio of two bounds, less the slack, as `mantissa * 2^exponent`: products with whole numbers stay exact.
#[derive(Clone, Copy, Debug)]
pub(super) struct Ratio {
    mantissa: u64,
    exponent: i32,
}

impl Ratio {
    /// From a quotient >= 0.
    pub fn new(quotient: f64) -> Self {
        let bits = (quotient * ONE_LESS_SLACK).to_bits();
        let fraction = bits & ((1 << 52) - 1);
        let exponent = (bits >> 52) as i32;
        if exponent == 0 {
            // Below every ratio that matters; 0 is where an absent bound is the denominator.
            return Self {
                mantissa: 0,
                exponent: 0,
            };
        }
        Self {
            mantissa: fraction | (1 << 52),
            exponent: exponent - 1075,
        }
    }

    /// The smallest whole number >= the ratio times `factor`, for `factor` < 2^75; saturates.
    pub fn ceil_times(self, factor: u128) -> u128 {
        let product = u128::from(self.mantissa) * factor;
        if self.exponent >= 0 {
            let shift = self.exponent as u32;
            return if shift > product.leading_zeros() {
                u128::MAX
            } else {
                product.checked_shl(shift).unwrap_or(0)
            };
        }
        let shift = self.exponent.unsigned_abs();
        let whole = product.checked_shr(shift).unwrap_or(0);
        let exact = whole.checked_shl(shift).unwrap_or(0) == product;
        whole + u128::from(!exact)
    }

    /// The smallest whole number >= the ratio; saturates.
    pub fn ceil(self) -> u128 {
        self.ceil_times(1)
    }
}
