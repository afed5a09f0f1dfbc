//! Random numbers, limits and dynamic values.

use standstill_axis::{Dynamics, Limits};

/// A linear congruential generator, whose high bits suffice here.
pub struct Random(u64);

impl Random {
    pub fn new(seed: u64) -> Self {
        Self(seed.wrapping_mul(0x9E37_79B9_7F4A_7C15))
    }

    pub fn below(&mut self, count: u64) -> u64 {
        self.0 = self
            .0
            .wrapping_mul(6_364_136_223_846_793_005)
            .wrapping_add(1_442_695_040_888_963_407);
        (self.0 >> 33) % count
    }

    pub fn between(&mut self, low: f64, high: f64) -> f64 {
        low + (high - low) * (self.below(1 << 20) as f64 / f64::from(1 << 20))
    }

    /// One of the axis limits: all of it, most of it, or some of it.
    fn share(&mut self, limit: f64) -> f64 {
        match self.below(3) {
            0 => 0.0,
            1 => limit * 0.8,
            _ => limit * self.between(0.05, 1.0),
        }
    }

    pub fn dynamics(&mut self, limits: &Limits) -> Dynamics {
        let velocity = match self.below(3) {
            0 => limits.velocity,
            _ => limits.velocity * self.between(0.05, 1.0),
        };
        let bounded = |share: f64| if share.is_finite() { share } else { 0.0 };
        let acceleration = self.share(limits.acceleration);
        Dynamics {
            velocity,
            acceleration,
            deceleration: if self.below(2) == 0 {
                acceleration
            } else {
                self.share(limits.deceleration)
            },
            jerk: bounded(self.share(limits.jerk)),
            snap: bounded(self.share(limits.snap)),
        }
    }

    pub fn limits(&mut self) -> Limits {
        let order = self.below(3);
        let acceleration = self.between(200.0, 2000.0);
        let deceleration = if self.below(3) == 0 {
            self.between(200.0, 2000.0)
        } else {
            acceleration
        };
        let (mut jerk, mut snap) = (f64::INFINITY, f64::INFINITY);
        if order > 0 {
            jerk = self.between(5e3, 5e4);
        }
        if order > 1 {
            snap = self.between(2e5, 2e6);
        }
        Limits {
            velocity: self.between(20.0, 200.0),
            acceleration,
            deceleration,
            jerk,
            snap,
        }
    }
}
