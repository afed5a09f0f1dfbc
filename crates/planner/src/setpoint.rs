//! The state of an axis at one instant.

/// Position and its derivatives at one instant, as published at the end of a scan.
///
/// At orders 3 and 2 the highest bounded derivative jumps; its value is then the one in force just before
/// the instant, like that of `snap` at order 4, and the derivatives above it are 0.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Setpoint {
    /// Position (u).
    pub position: f64,
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration (u/s^2).
    pub acceleration: f64,
    /// Jerk (u/s^3).
    pub jerk: f64,
    /// Snap (u/s^4), the one in force just before the instant.
    pub snap: f64,
}

impl Setpoint {
    /// At rest at `position` (u).
    pub const fn at_rest(position: f64) -> Self {
        Self {
            position,
            velocity: 0.0,
            acceleration: 0.0,
            jerk: 0.0,
            snap: 0.0,
        }
    }

    /// Whether velocity, acceleration and jerk are all exactly zero.
    pub fn is_at_rest(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0 && self.jerk == 0.0
    }

    /// Whether all five values are finite.
    pub fn is_finite(&self) -> bool {
        self.position.is_finite()
            && self.velocity.is_finite()
            && self.acceleration.is_finite()
            && self.jerk.is_finite()
            && self.snap.is_finite()
    }
}
