//! From limits and a distance to four whole numbers. This is the only rounding of planning.

use crate::{Field, Limits, Order, PlanError, math};

/// A ratio counts as reached when it is missed by less than 2^-40 of itself, so that decimal inputs give
/// their nominal counts (docs/planner.md, eq. 7).
const ONE_LESS_SLACK: f64 = 1.0 - 1.0 / (1_u64 << 40) as f64;

/// Largest number of scans that a plan can count: 2^31 - 1.
pub(super) const LONGEST: u64 = (1 << 31) - 1;

/// Box lengths n1..n4 in scans; boxes that an order does not have are 0 (docs/planner.md, eq. 4).
pub(super) type Boxes = [u32; 4];

/// A rest-to-rest problem on the grid: find the boxes of the least sum whose products reach the thresholds.
///
/// The thresholds are whole numbers. As `f64` they are exact: a ratio of 2^53 or more is whole already.
#[derive(Clone, Copy, Debug)]
pub(super) struct Problem {
    /// The number of boxes.
    pub order: Order,
    /// Least n4, at most 2^31.
    pub k4: f64,
    /// Least n3 n4, at most 2^62.
    pub k3: f64,
    /// Least n2 n3 n4, at most 2^93.
    pub k2: f64,
    /// Least n1 n2 n3 n4, at most 2^116.
    pub k1: f64,
    /// Whether all are at most 2^53, so that a rounded product of whole numbers is below a threshold only if
    /// the exact one is (docs/planner.md, eq. 9).
    small: bool,
}

impl Problem {
    /// The thresholds of a move of `distance` > 0 (u) under checked `limits` and `cycle` (s)
    /// (docs/planner.md, eq. 7).
    ///
    /// # Errors
    /// [`PlanError::TooLong`] names the first bound that alone needs more than 2^31 scans.
    pub fn new(distance: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        let ratios = ratios(distance, limits.lower_acceleration(), limits, cycle);
        // No countable plan reaches more (docs/planner.md, eq. 8).
        let most = [31, 62, 93, 116].map(|bits| (1_u128 << bits) as f64);
        for ((ratio, most), bound) in ratios.iter().zip(most).zip(bounds(limits)) {
            if *ratio > most {
                let (field, value) = bound;
                return Err(PlanError::TooLong { field, value });
            }
        }
        let [k4, k3, k2, k1] = ratios.map(threshold);
        Ok(Self {
            order: limits.order(),
            k4,
            k3,
            k2,
            k1,
            small: math::max(math::max(k3, k2), k1) <= (1_u64 << 53) as f64,
        })
    }

    /// The least n4 that reaches all thresholds with the other boxes given; a missing box is 0.
    pub fn least_n4(&self, n1: u64, n2: u64, n3: u64) -> u64 {
        let [n1, n2, n3] = [n1, n2, n3].map(|n| u128::from(n.max(1)));
        // The compiler does not know that no product is 0, so a division that cannot panic must be
        // written as such.
        let least_times = |threshold: f64, others: u128| (threshold as u128).div_ceil(others.max(1));
        let least = (self.k4 as u128)
            .max(least_times(self.k3, n3))
            .max(least_times(self.k2, n2 * n3))
            .max(least_times(self.k1, n1 * n2 * n3));
        u64::try_from(least).unwrap_or(u64::MAX)
    }

    /// Whether whole box lengths below 2^32 reach all thresholds; missing boxes are 0.
    pub fn reached_by(&self, boxes: [f64; 4]) -> bool {
        let [n1, n2, n3, n4] = boxes;
        if n4 < self.k4 {
            return false;
        }
        let (n1, n2) = (math::max(n1, 1.0), math::max(n2, 1.0));
        if self.small {
            let p3 = n3 * n4;
            let p2 = n2 * p3;
            return p3 >= self.k3 && p2 >= self.k2 && n1 * p2 >= self.k1;
        }
        let [n1, n2, n3, n4] = [n1, n2, n3, n4].map(|n| n as u64);
        let p3 = n3 * n4;
        let p2 = u128::from(n2) * u128::from(p3);
        p3 >= self.k3 as u64 && p2 >= self.k2 as u128 && u128::from(n1) * p2 >= self.k1 as u128
    }

    /// The refusal of a move that no bound alone makes too long, but all together do. It names the bound
    /// that alone would take the most scans.
    pub fn too_long(&self, limits: &Limits) -> PlanError {
        // Alone they take K4, 2 sqrt(K3), cbrt(32 K2) and (512 K1)^(1/4) scans; the twelfth powers compare
        // the same way without roots.
        let square = |x: f64| x * x;
        let cube = |x: f64| x * x * x;
        let powers = [
            cube(square(square(self.k4))),
            cube(square(4.0 * self.k3)),
            square(square(32.0 * self.k2)),
            cube(512.0 * self.k1),
        ];
        let mut most = 0.0;
        let mut error = PlanError::Unbounded;
        for (power, (field, value)) in powers.into_iter().zip(bounds(limits)) {
            if power > most {
                most = power;
                error = PlanError::TooLong { field, value };
            }
        }
        error
    }
}

/// The lower bounds of the products n4, n3 n4, n2 n3 n4, n1 n2 n3 n4, not yet rounded up; `acceleration`
/// is the bound on acceleration (docs/planner.md, eq. 7).
pub(super) fn ratios(distance: f64, acceleration: f64, limits: &Limits, cycle: f64) -> [f64; 4] {
    let t = cycle;
    [
        distance / (limits.velocity * t),
        distance / (acceleration * t * t),
        distance / (limits.jerk * t * t * t),
        distance / (limits.snap * t * t * t * t),
    ]
}

/// The least whole number >= 1 that counts as reaching `ratio` (docs/planner.md, eq. 7).
pub(super) fn threshold(ratio: f64) -> f64 {
    math::max(math::ceil(ratio * ONE_LESS_SLACK), 1.0)
}

/// The bounds in the order of the thresholds K4 to K1, with their names.
fn bounds(limits: &Limits) -> [(Field, f64); 4] {
    let acceleration = if limits.acceleration <= limits.deceleration {
        Field::LimitAcceleration
    } else {
        Field::LimitDeceleration
    };
    [
        (Field::LimitVelocity, limits.velocity),
        (acceleration, limits.lower_acceleration()),
        (Field::LimitJerk, limits.jerk),
        (Field::LimitSnap, limits.snap),
    ]
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
            // Below every relevant ratio; 0 occurs if an absent bound is the denominator.
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

#[cfg(test)]
mod tests {
    use super::{Problem, Ratio};
    use crate::Limits;

    /// Products beyond 53 bits that only rounding lifts to the threshold do not reach it.
    #[test]
    fn products_beyond_53_bits_are_compared_exactly() {
        let limits = Limits {
            snap: 1.0,
            ..Limits::NONE
        };
        let mut told_apart = 0;
        for n in 40_000..40_100 {
            let boxes = [n, n + 3, 2 * n + 1, 5 * n].map(f64::from);
            let product = boxes.iter().map(|n| *n as u128).product::<u128>();
            let rounded = product as f64;
            let slack = 1.0 + 1.0 / (1_u64 << 40) as f64;
            let problem = Problem::new(rounded * slack, &limits, 1.0).expect("valid");
            let reached = product >= problem.k1 as u128;
            assert_eq!(problem.reached_by(boxes), reached);
            told_apart += u32::from(!reached && problem.k1 == rounded);
        }
        assert!(told_apart > 0, "no product here is rounded up to its threshold");
    }

    /// A ratio times a whole number is rounded up exactly, less the slack.
    #[test]
    fn ratios_multiply_exactly() {
        assert_eq!(Ratio::new(3.0).ceil(), 3);
        assert_eq!(Ratio::new(3.0 + 1e-13).ceil(), 3);
        assert_eq!(Ratio::new(3.0 + 1e-11).ceil(), 4);
        assert_eq!(Ratio::new(0.25).ceil_times(12), 3);
        assert_eq!(Ratio::new(0.25).ceil_times(13), 4);
        assert_eq!(Ratio::new(0.0).ceil_times(1 << 62), 0);
        assert_eq!(Ratio::new(1e-300).ceil_times(1), 1);
        // 2^100, less the slack of 2^60.
        let huge = (1_u128 << 100) as f64;
        assert_eq!(Ratio::new(huge).ceil(), (1 << 100) - (1 << 60));
        assert_eq!(Ratio::new(1e300).ceil_times(2), u128::MAX);
    }
}
