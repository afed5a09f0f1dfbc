//! Random moves of the kind servo axes make.

use standstill_planner::Limits;

/// The generator splitmix64: small, seeded, the same everywhere.
#[derive(Clone, Copy, Debug)]
pub struct Random(pub u64);

/// A rest-to-rest move.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Start (u).
    pub start: f64,
    /// Target (u).
    pub target: f64,
    /// Bounds, all finite.
    pub limits: Limits,
    /// Sample time (s).
    pub cycle: f64,
}

impl Random {
    /// 64 random bits.
    pub fn bits(&mut self) -> u64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        z ^ (z >> 31)
    }

    /// Between `low` and `high`, both above 0: all binades alike, which bit patterns in order are.
    pub fn log(&mut self, low: f64, high: f64) -> f64 {
        let range = high.to_bits().saturating_sub(low.to_bits()).max(1);
        f64::from_bits(low.to_bits() + self.bits() % range)
    }

    /// A move of order 4: 0.1 ms to 10 s at the velocity limit, in cycles of 0.1 ms to 10 ms.
    pub fn servo(&mut self) -> Move {
        let velocity = self.log(0.01, 10.0);
        let acceleration = velocity * self.log(1.0, 300.0);
        let jerk = acceleration * self.log(1.0, 1000.0);
        let snap = jerk * self.log(1.0, 3000.0);
        let distance = velocity * self.log(1e-4, 10.0);
        let (forward, positive) = (self.bits() & 1 == 0, self.bits() & 1 == 0);
        let size = self.log(1e-3, 1e3);
        let start = if positive { size } else { -size };
        Move {
            start,
            target: if forward {
                start + distance
            } else {
                start - distance
            },
            limits: Limits {
                velocity,
                acceleration,
                deceleration: acceleration,
                jerk,
                snap,
            },
            cycle: self.log(1e-4, 1e-2),
        }
    }
}
