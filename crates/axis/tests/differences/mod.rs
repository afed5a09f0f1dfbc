//! Published set-points and the differences of their positions, checked against limits.

use standstill_axis::{Limits, Setpoint};

/// The last published positions, newest first, for the derivatives.
#[derive(Clone)]
pub struct Seen {
    positions: [f64; 5],
    cycle: f64,
    /// The largest position that was used in one of them (u).
    coarsest: f64,
}

impl Seen {
    /// An axis at rest at 0.
    pub fn new(cycle: f64) -> Self {
        Self {
            positions: [0.0; 5],
            cycle,
            coarsest: 1.0,
        }
    }

    /// A position (u) from which the next ones are computed.
    pub fn made_of(&mut self, position: f64) {
        self.coarsest = self.coarsest.max(position.abs());
    }

    /// Checks that the next set-point and the differences of positions are within `limits`.
    pub fn check(&mut self, now: &Setpoint, limits: &Limits, what: &str) {
        self.positions.rotate_right(1);
        self.positions[0] = now.position;
        let acceleration = limits.acceleration.max(limits.deceleration);
        let bounds = [limits.velocity, acceleration, limits.jerk, limits.snap];
        let derivatives = [now.velocity, now.acceleration, now.jerk, now.snap];
        let mut differences = self.positions;
        // The resolution of f64 positions in a difference of each order.
        let mut grain = 4.0
            * f64::EPSILON
            * self
                .positions
                .iter()
                .fold(self.coarsest, |most: f64, p| most.max(p.abs()));
        for (order, (bound, derivative)) in bounds.iter().zip(derivatives).enumerate() {
            assert!(
                derivative.abs() <= bound * (1.0 + 1e-9),
                "{what}: derivative {} is {derivative}, limit {bound}",
                order + 1
            );
            for place in 0..4 - order {
                differences[place] = (differences[place] - differences[place + 1]) / self.cycle;
            }
            grain *= 2.0 / self.cycle;
            assert!(
                differences[0].abs() <= bound * (1.0 + 1e-9) + grain,
                "{what}: difference {} is {}, limit {bound}",
                order + 1,
                differences[0]
            );
        }
    }
}

/// The last five positions, newest first, and the bounds of their differences.
pub struct Watch {
    positions: [f64; 5],
    cycle: f64,
    limits: Limits,
    /// The largest position so far (u).
    pub largest: f64,
}

impl Watch {
    /// An axis with these limits, at rest at 0.
    pub fn new(cycle: f64, limits: Limits) -> Self {
        Self {
            positions: [0.0; 5],
            cycle,
            limits,
            largest: 0.0,
        }
    }

    /// Takes the next position; the error names the difference that is beyond its limit.
    pub fn see(&mut self, position: f64) -> Result<(), String> {
        self.positions.rotate_right(1);
        self.positions[0] = position;
        self.largest = self.largest.max(position.abs());
        let mut differences = self.positions;
        let wider = self.limits.acceleration.max(self.limits.deceleration);
        let bounds = [self.limits.velocity, wider, self.limits.jerk, self.limits.snap];
        let mut unit = 1.0;
        for (order, bound) in (1..).zip(bounds) {
            for place in 0..differences.len() - order {
                differences[place] -= differences[place + 1];
            }
            unit *= self.cycle;
            let value = differences[0].abs() / unit;
            let resolved = 64.0 * f64::EPSILON * self.largest / unit;
            if value > bound * (1.0 + 1e-9) + resolved {
                return Err(format!("difference {order} is {value}, limit {bound}"));
            }
        }
        Ok(())
    }
}
