//! Position and velocity loop in cascade, with feed-forward.

use super::SUBSTEPS;
use super::plant::{Mechanism, MechanismError, Plant};

/// Default bandwidth of the velocity loop times a step (rad).
const BANDWIDTH: f64 = 0.2;

/// Default ratio of the velocity loop to the position loop, and to its integral part.
const CASCADE: f64 = 4.0;

/// The gains of a servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Gains {
    /// Velocity per position error (1/s), from 0.
    pub position: f64,
    /// Torque per velocity error (torque s/u), from 0.
    pub velocity: f64,
    /// Torque per second and velocity error (torque/u), from 0.
    pub integral: f64,
    /// Part of the set velocity that is fed forward, usually 0 to 1.
    pub feed_velocity: f64,
    /// Part of the torque for the set acceleration that is fed forward.
    pub feed_acceleration: f64,
    /// Largest torque, above 0; infinite for none.
    pub torque: f64,
}

impl Gains {
    /// Stable gains for any plant with steps of a scan of `cycle` seconds: a velocity loop as fast as the
    /// steps allow, a position loop four times as slow, full feed-forward.
    pub fn of(plant: &Plant, cycle: f64) -> Self {
        let bandwidth = BANDWIDTH * f64::from(SUBSTEPS) / cycle;
        let velocity = plant.inertia * bandwidth;
        Self {
            position: bandwidth / CASCADE,
            velocity,
            integral: velocity * bandwidth / (CASCADE * CASCADE),
            feed_velocity: 1.0,
            feed_acceleration: 1.0,
            torque: f64::INFINITY,
        }
    }

    fn check(&self) -> Result<(), MechanismError> {
        let rows = [
            ("gains.position", self.position),
            ("gains.velocity", self.velocity),
            ("gains.integral", self.integral),
            ("gains.feed_velocity", self.feed_velocity),
            ("gains.feed_acceleration", self.feed_acceleration),
        ];
        if let Some((key, value)) = rows
            .into_iter()
            .find(|(_, value)| !(value.is_finite() && *value >= 0.0))
        {
            return Err(MechanismError { key, value });
        }
        if self.torque > 0.0 {
            Ok(())
        } else {
            Err(MechanismError {
                key: "torque",
                value: self.torque,
            })
        }
    }
}

/// A set-point at the end of a scan.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct SetPoint {
    /// Position (u).
    pub position: f64,
    /// Velocity (u/s).
    pub velocity: f64,
}

/// A mechanism under its loops.
#[derive(Clone, Copy, Debug)]
pub struct Servo {
    mechanism: Mechanism,
    gains: Gains,
    cycle: f64,
    /// Scans a second.
    rate: f64,
    /// The set-point at the end of the scan before.
    from: SetPoint,
    /// Torque of the integral part.
    integral: f64,
    torque: f64,
    /// At the end of the last scan the ordered torque was limited.
    limited: bool,
}

impl Servo {
    /// Holds `mechanism` at its present position, in scans of `cycle` seconds.
    ///
    /// # Errors
    /// [`MechanismError`] names the invalid gain.
    pub fn new(mechanism: Mechanism, gains: Gains, cycle: f64) -> Result<Self, MechanismError> {
        gains.check()?;
        Ok(Self {
            mechanism,
            gains,
            cycle,
            rate: 1.0 / cycle,
            from: SetPoint {
                position: mechanism.position(),
                velocity: 0.0,
            },
            integral: 0.0,
            torque: 0.0,
            limited: false,
        })
    }

    /// One scan towards `to`. Between the scans the set-point follows the cubic through both ends with their
    /// velocities. Cost: four steps.
    pub fn follow(&mut self, to: SetPoint) {
        let from = core::mem::replace(&mut self.from, to);
        let step = 1.0 / f64::from(SUBSTEPS);
        let time = self.cycle * step;
        let way = to.position - from.position;
        let (early, late) = (from.velocity * self.cycle, to.velocity * self.cycle);
        // p = from + early s + curve s^2 + twist s^3, s from 0 to 1
        let curve = 3.0 * way - 2.0 * early - late;
        let twist = early + late - 2.0 * way;
        // Derivatives by time, scaled by their feed-forward.
        let per_second = self.gains.feed_velocity * self.rate;
        let inertia = self.gains.feed_acceleration * self.mechanism.plant().total_inertia();
        let per_square = inertia * (self.rate * self.rate);
        let mut part = 0.0;
        for _ in 0..SUBSTEPS {
            let position = from.position + part * (early + part * (curve + part * twist));
            let velocity = per_second * (early + part * (2.0 * curve + part * (3.0 * twist)));
            // The mean over the step, because the torque is constant in it.
            let fed = per_square * (2.0 * curve + 6.0 * twist * (part + 0.5 * step));
            let wanted = velocity + self.gains.position * (position - self.mechanism.position());
            let error = wanted - self.mechanism.velocity();
            let unlimited = self.gains.velocity * error + (self.integral + fed);
            self.torque = if unlimited.abs() <= self.gains.torque {
                self.integral += self.gains.integral * error * time;
                unlimited
            } else {
                // At the torque limit the integral part would wind up.
                self.gains.torque.copysign(unlimited)
            };
            self.mechanism.step(self.torque);
            part += step;
        }
    }

    /// One scan under `torque`, at a velocity from `least` to `most` (u/s). Beyond these bounds a loop
    /// brakes instead. Position control continues from here without a step. Cost: four steps.
    pub fn hold(&mut self, torque: f64, (least, most): (f64, f64)) {
        let bound = self.gains.torque;
        for _ in 0..SUBSTEPS {
            let velocity = self.mechanism.velocity();
            let slower = self.gains.velocity * (most - velocity);
            let faster = self.gains.velocity * (least - velocity);
            let within = torque.min(slower).max(faster);
            self.torque = within.max(-bound).min(bound);
            self.mechanism.step(self.torque);
        }
        self.limited = self.torque != torque;
        self.integral = if self.gains.integral > 0.0 {
            self.torque
        } else {
            0.0
        };
        self.from = SetPoint {
            position: self.mechanism.position(),
            velocity: self.mechanism.velocity(),
        };
    }

    /// Whether the torque of the last [`Servo::hold`] was limited.
    pub fn is_limited(&self) -> bool {
        self.limited
    }

    /// The largest torque.
    pub fn most_torque(&self) -> f64 {
        self.gains.torque
    }

    /// A scan without torque.
    pub fn coast(&mut self) {
        (self.integral, self.torque) = (0.0, 0.0);
        for _ in 0..SUBSTEPS {
            self.mechanism.step(0.0);
        }
        self.from = SetPoint {
            position: self.mechanism.position(),
            velocity: self.mechanism.velocity(),
        };
    }

    /// Someone moved the mechanism by this distance (u).
    pub fn shift(&mut self, by: f64) {
        self.mechanism.shift(by);
        self.from.position += by;
    }

    /// Renames positions: each is `by` (u) more.
    pub fn rename(&mut self, by: f64) {
        self.mechanism.rename(by);
        self.from.position += by;
    }

    /// The mechanism.
    pub fn mechanism(&self) -> &Mechanism {
        &self.mechanism
    }

    /// Torque of the last step.
    pub fn torque(&self) -> f64 {
        self.torque
    }

    /// The last set-point.
    pub fn set_point(&self) -> SetPoint {
        self.from
    }
}
