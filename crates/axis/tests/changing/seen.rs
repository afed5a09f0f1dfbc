//! What published positions say of the limits.

use standstill_axis::{Limits, Setpoint};

/// The last published positions, newest first.
pub struct Seen {
    positions: [f64; 5],
    limits: Limits,
    modulo: Option<f64>,
    cycle: f64,
}

impl Seen {
    pub fn new(limits: Limits, modulo: Option<f64>, cycle: f64) -> Self {
        Self {
            positions: [0.0; 5],
            limits,
            modulo,
            cycle,
        }
    }

    /// Takes the next set-point; says which limit it breaks.
    pub fn check(&mut self, now: &Setpoint) -> Result<(), String> {
        let mut position = now.position;
        if let Some(length) = self.modulo {
            // The name of the turn that is nearest to the position before.
            position += ((self.positions[0] - position) / length).round() * length;
        }
        self.positions.rotate_right(1);
        self.positions[0] = position;
        let limits = &self.limits;
        let acceleration = limits.acceleration.max(limits.deceleration);
        let bounds = [limits.velocity, acceleration, limits.jerk, limits.snap];
        let derivatives = [now.velocity, now.acceleration, now.jerk, now.snap];
        let mut differences = self.positions;
        // How far f64 positions resolve a difference of each order.
        let largest = self
            .positions
            .iter()
            .fold(100.0, |most: f64, p| most.max(p.abs()));
        let mut grain = 8.0 * f64::EPSILON * largest;
        let mut broken = Ok(());
        for (order, (bound, derivative)) in bounds.iter().zip(derivatives).enumerate() {
            for place in 0..4 - order {
                differences[place] = (differences[place] - differences[place + 1]) / self.cycle;
            }
            grain *= 2.0 / self.cycle;
            let most = bound * (1.0 + 1e-9);
            if derivative.abs() > most || differences[0].abs() > most + grain {
                let (order, difference) = (order + 1, differences[0]);
                broken = broken.and(Err(format!(
                    "derivative {order} is {derivative}, the difference {difference}, the limit {bound}"
                )));
            }
        }
        broken
    }
}
