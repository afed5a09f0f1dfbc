//! The bounds a plan keeps.

use crate::{Field, PlanError};

/// Largest magnitudes a plan may use; `f64::INFINITY` means no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration while the speed grows (u/s^2).
    pub acceleration: f64,
    /// Acceleration while the speed falls (u/s^2).
    pub deceleration: f64,
    /// Jerk (u/s^3).
    pub jerk: f64,
    /// Snap (u/s^4).
    pub snap: f64,
}

/// Which derivative of position is the highest that stays finite, that is, how smooth a plan is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Acceleration jumps (no jerk and no snap bound).
    Two,
    /// Jerk jumps (no snap bound).
    Three,
    /// Snap jumps.
    Four,
}

impl Order {
    /// The order as a number: 2, 3 or 4.
    pub const fn degree(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
            Self::Four => 4,
        }
    }
}

impl Limits {
    /// No bound at all.
    pub const NONE: Self = Self {
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        deceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    };

    /// The order of plans under these bounds: 4 with a snap bound, else 3 with a jerk bound, else 2.
    pub const fn order(&self) -> Order {
        if self.snap.is_finite() {
            Order::Four
        } else if self.jerk.is_finite() {
            Order::Three
        } else {
            Order::Two
        }
    }

    /// The lower one of acceleration and deceleration (u/s^2).
    pub const fn lower_acceleration(&self) -> f64 {
        if self.acceleration <= self.deceleration {
            self.acceleration
        } else {
            self.deceleration
        }
    }

    /// The larger one of each finite pair; an infinite bound of `before` says nothing, that of these limits stays.
    pub fn or_larger(&self, before: &Self) -> Self {
        let larger = |new: f64, old: f64| {
            if old.is_finite() && old > new { old } else { new }
        };
        Self {
            velocity: larger(self.velocity, before.velocity),
            acceleration: larger(self.acceleration, before.acceleration),
            deceleration: larger(self.deceleration, before.deceleration),
            jerk: larger(self.jerk, before.jerk),
            snap: larger(self.snap, before.snap),
        }
    }

    /// Whether no bound is given at all.
    pub const fn is_unbounded(&self) -> bool {
        self.velocity.is_infinite()
            && self.lower_acceleration().is_infinite()
            && self.jerk.is_infinite()
            && self.snap.is_infinite()
    }

    /// Checks that every bound is positive and none is NaN.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] names the first bound that is NaN, zero or negative.
    pub const fn check(&self) -> Result<(), PlanError> {
        let bounds = [
            (Field::LimitVelocity, self.velocity),
            (Field::LimitAcceleration, self.acceleration),
            (Field::LimitDeceleration, self.deceleration),
            (Field::LimitJerk, self.jerk),
            (Field::LimitSnap, self.snap),
        ];
        let mut index = 0;
        while index < bounds.len() {
            let (field, value) = bounds[index];
            if !(value > 0.0) {
                return Err(PlanError::InvalidInput { field, value });
            }
            index += 1;
        }
        Ok(())
    }
}
