//! The state of an axis at one instant.

/// Position and its derivatives at one instant, as published at the end of a scan.
///
/// At orders 3 and 2 the highest bounded derivative jumps. Its value is then the one just before the
/// instant, like that of `snap` at order 4, and the derivatives above it are 0.
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

    /// At a constant `velocity` (u/s), at `position` (u).
    #[inline]
    pub const fn at_velocity(position: f64, velocity: f64) -> Self {
        Self {
            velocity,
            ..Self::at_rest(position)
        }
    }

    /// The same motion at another `position` (u).
    #[inline]
    #[must_use]
    pub const fn moved_to(&self, position: f64) -> Self {
        Self { position, ..*self }
    }

    /// The same motion at position 0, where positions have the finest resolution.
    #[inline]
    #[must_use]
    pub const fn at_origin(&self) -> Self {
        self.moved_to(0.0)
    }

    /// Whether velocity, acceleration and jerk are all exactly zero.
    pub fn is_at_rest(&self) -> bool {
        self.velocity == 0.0 && self.acceleration == 0.0 && self.jerk == 0.0
    }

    /// The sum of both, which is published if one motion is beside another.
    #[inline]
    #[must_use]
    pub fn plus(&self, other: &Self) -> Self {
        Self {
            position: self.position + other.position,
            velocity: self.velocity + other.velocity,
            acceleration: self.acceleration + other.acceleration,
            jerk: self.jerk + other.jerk,
            snap: self.snap + other.snap,
        }
    }

    /// Position and derivatives `factor` times as large.
    pub fn times(&self, factor: f64) -> Self {
        Self {
            position: factor * self.position,
            velocity: factor * self.velocity,
            acceleration: factor * self.acceleration,
            jerk: factor * self.jerk,
            snap: factor * self.snap,
        }
    }

    /// Position and derivatives, in the order of the fields. A caller can keep numbers that a function returns in registers.
    /// It would keep a returned set-point in memory, together with those it computed itself.
    #[inline]
    pub const fn numbers(self) -> [f64; 5] {
        [
            self.position,
            self.velocity,
            self.acceleration,
            self.jerk,
            self.snap,
        ]
    }

    /// The set-point of these [`Setpoint::numbers`].
    #[inline]
    pub(crate) const fn of(numbers: [f64; 5]) -> Self {
        let [position, velocity, acceleration, jerk, snap] = numbers;
        Self {
            position,
            velocity,
            acceleration,
            jerk,
            snap,
        }
    }

    /// Whether all five values are finite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        // One check of the sum instead of five: infinity and NaN remain in it. Of finite values only huge
        // ones have a sum that is not finite.
        let sum = self.position + self.velocity + self.acceleration + self.jerk + self.snap;
        sum.is_finite() || each_is_finite(self.numbers())
    }
}

#[cold]
#[inline(never)]
fn each_is_finite(numbers: [f64; 5]) -> bool {
    numbers.iter().all(|number| number.is_finite())
}

#[cfg(test)]
mod tests {
    use super::Setpoint;

    #[test]
    fn finite_is_what_each_value_is_whatever_their_sum() {
        assert!(Setpoint::of([f64::MAX; 5]).is_finite());
        assert!(Setpoint::of([f64::MIN; 5]).is_finite());
        for broken in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
            for place in 0..5 {
                for others in [0.0, 1.0, -f64::MAX, -broken] {
                    let mut values = [others; 5];
                    values[place] = broken;
                    assert!(!Setpoint::of(values).is_finite(), "{values:?}");
                }
            }
        }
    }
}
