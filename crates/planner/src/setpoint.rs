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
    #[inline]
    pub fn is_finite(&self) -> bool {
        // One look at the sum instead of five: infinity and NaN stay in it. Of finite values only huge ones have
        // a sum that is not finite.
        (self.position + self.velocity + self.acceleration + self.jerk + self.snap).is_finite() || Self::is_each_finite(*self)
    }

    // By value, so that a set-point need not be in memory to be checked.
    #[cold]
    #[inline(never)]
    fn is_each_finite(self) -> bool {
        self.position.is_finite()
            && self.velocity.is_finite()
            && self.acceleration.is_finite()
            && self.jerk.is_finite()
            && self.snap.is_finite()
    }
}

#[cfg(test)]
mod tests {
    use super::Setpoint;

    #[test]
    fn finite_is_what_each_value_is_whatever_their_sum() {
        let of = |values: [f64; 5]| {
            let [position, velocity, acceleration, jerk, snap] = values;
            Setpoint { position, velocity, acceleration, jerk, snap }
        };
        assert!(of([f64::MAX; 5]).is_finite());
        assert!(of([f64::MIN; 5]).is_finite());
        for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..5 {
                for others in [0.0, 1.0, -f64::MAX, -broken] {
                    let mut values = [others; 5];
                    values[place] = broken;
                    assert!(!of(values).is_finite(), "{values:?}");
                }
            }
        }
    }
}
