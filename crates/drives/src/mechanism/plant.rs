//! Motor, friction, and a load on a spring.

use super::SUBSTEPS;
use super::matrix::{Matrix, SIZE, exponential};
use core::fmt;

/// Rounds of the iteration for the distance of a substep and the torque of a stop. Each round leaves at most three
/// quarters of the error.
const ROUNDS: u32 = 100;

/// A load behind an elastic coupling.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Load {
    /// Torque per acceleration (torque s^2/u), above 0.
    pub inertia: f64,
    /// Torque per twist (torque/u), above 0.
    pub stiffness: f64,
    /// Torque per difference of velocities (torque s/u), from 0.
    pub damping: f64,
}

/// The load of a motor. The unit of torque is chosen by the user; u is the unit of the axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Plant {
    /// Torque per acceleration of the motor alone (torque s^2/u), above 0.
    pub inertia: f64,
    /// Friction at the motor that grows with velocity (torque s/u), from 0.
    pub viscous: f64,
    /// Friction at the motor that does not (torque), from 0.
    pub coulomb: f64,
    /// The load on a spring; `None` if everything is rigid.
    pub load: Option<Load>,
}

impl Plant {
    /// Torque per acceleration of motor and load together.
    pub fn total_inertia(&self) -> f64 {
        self.inertia + self.load.map_or(0.0, |load| load.inertia)
    }

    fn check(&self) -> Result<(), MechanismError> {
        let positive = |value: f64| value.is_finite() && value > 0.0;
        let not_negative = |value: f64| value.is_finite() && value >= 0.0;
        let rows = [
            ("inertia", self.inertia, positive(self.inertia)),
            ("viscous", self.viscous, not_negative(self.viscous)),
            ("coulomb", self.coulomb, not_negative(self.coulomb)),
        ];
        let of_load = self.load.map(|load| {
            [
                ("load.inertia", load.inertia, positive(load.inertia)),
                ("load.stiffness", load.stiffness, positive(load.stiffness)),
                ("load.damping", load.damping, not_negative(load.damping)),
            ]
        });
        match rows
            .iter()
            .chain(of_load.iter().flatten())
            .find(|(.., good)| !good)
        {
            Some((key, value, _)) => Err(MechanismError { key, value: *value }),
            None => Ok(()),
        }
    }
}

/// Mechanical stops at the ends of the travel. They act as springs on the motor.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Stops {
    /// The lower stop begins at the first (u), the upper stop at the second.
    pub ends: (f64, f64),
    /// Torque per depth (torque/u), above 0.
    pub stiffness: f64,
    /// Torque per velocity while it is touched (torque s/u), from 0.
    pub damping: f64,
}

impl Stops {
    /// The mean torque on a motor that moves by `way` (u) in `time` seconds from the position `from` (u). With this
    /// mean a spring returns the energy it has taken.
    fn torque(&self, from: f64, way: f64, time: f64) -> f64 {
        let (low, high) = self.ends;
        let between = |place: f64| place.max(low).min(high);
        let to = from + way;
        let free = between(to) - between(from);
        let touched = if free == 0.0 { 1.0 } else { 1.0 - free / way };
        let depth = 0.5 * ((from - between(from)) + (to - between(to)));
        let torque = touched * (self.stiffness * depth + self.damping * way / time);
        // A stop pushes and never pulls.
        if torque * depth > 0.0 { torque } else { 0.0 }
    }
}

/// An invalid parameter of a mechanism or its servo.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MechanismError {
    /// The parameter.
    pub key: &'static str,
    /// Its value.
    pub value: f64,
}

impl fmt::Display for MechanismError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self { key, value } = self;
        let wanted = match *key {
            "inertia" | "load.inertia" | "load.stiffness" | "torque" => "a finite number above 0",
            "stiffness of the whole" => "softer, or a shorter cycle",
            "stops.stiffness" => {
                "a number above 0, low enough for the cycle: at most the inertia of the motor by the square of a quarter of it"
            }
            "stops.damping" => {
                "a number from 0, low enough for the cycle: at most the inertia of the motor by a quarter of it"
            }
            "stops.negative" => "a number below `stops.positive`",
            _ => "a finite number from 0",
        };
        write!(f, "`{key}` is {value:?}; give {wanted}")
    }
}

impl core::error::Error for MechanismError {}

/// A substep of a mechanism: the distance of its motor (u), and the state at its end.
struct Moved {
    way: f64,
    twist: f64,
    velocity: f64,
    load_velocity: f64,
}

/// A plant in motion.
///
/// Between two steps the torque is constant. So the linear part is solved exactly, by one matrix that is computed
/// when the mechanism is made. Friction that does not depend on velocity reduces the velocity in a step as far as
/// it can, down to 0. So a mechanism at rest stays there to the last bit.
#[derive(Clone, Copy, Debug)]
pub struct Mechanism {
    plant: Plant,
    stops: Option<Stops>,
    /// The effect of 1 of the twist, the motor velocity, the load velocity and the torque on [motor velocity,
    /// distance, twist, load velocity] one step later. In this order two of them are computed at once.
    step: [[f64; 4]; 4],
    /// The effect of the twist and the load velocity on [twist, load velocity] one step later if friction holds the
    /// motor.
    held: [[f64; 2]; 2],
    /// Torque that changes the motor's velocity by 1 u/s in a step.
    stopping: f64,
    /// Duration of a step (s).
    time: f64,
    /// Motor position (u).
    position: f64,
    /// Motor velocity (u/s).
    velocity: f64,
    /// Motor minus load (u).
    twist: f64,
    /// Load velocity (u/s).
    load_velocity: f64,
}

impl Mechanism {
    /// At rest at `position` (u), for scans of `cycle` seconds.
    ///
    /// # Errors
    /// [`MechanismError`] names the invalid parameter.
    pub fn new(plant: Plant, position: f64, cycle: f64) -> Result<Self, MechanismError> {
        plant.check()?;
        let time = cycle / f64::from(SUBSTEPS);
        let after_a_step = |derivative: Matrix| {
            exponential(&derivative.map(|row| row.map(|value| value * time))).ok_or(MechanismError {
                key: "stiffness of the whole",
                value: plant.load.map_or(plant.viscous, |load| load.stiffness),
            })
        };
        let full = after_a_step(derivative(&plant))?;
        let [of_twist, _, of_load, ..] = derivative(&plant);
        let nothing = [0.0; SIZE];
        let held = after_a_step([of_twist, nothing, of_load, nothing, nothing])?;
        let [twist, motor, load, way, _] = full;
        let of_each = |column: usize| [motor, way, twist, load].map(|row| row[column]);
        let [held_twist, _, held_load, ..] = held;
        Ok(Self {
            plant,
            stops: None,
            step: [0, 1, 2, SIZE - 1].map(of_each),
            held: [0, 2].map(|column: usize| [held_twist, held_load].map(|row| row[column])),
            stopping: 1.0 / motor[4],
            time,
            position,
            velocity: 0.0,
            twist: 0.0,
            load_velocity: 0.0,
        })
    }

    /// The same with `stops`, in scans of `cycle` seconds.
    ///
    /// # Errors
    /// [`MechanismError`] if they are in the wrong order, or too hard to be followed in a step.
    pub fn between(mut self, stops: Stops, cycle: f64) -> Result<Self, MechanismError> {
        let Stops {
            ends: (low, high),
            stiffness,
            damping,
        } = stops;
        let time = cycle / f64::from(SUBSTEPS);
        let inertia = self.plant.inertia;
        // Both ends must be finite; the other comparisons exclude the rest.
        let ordered = low < high && (high - low).is_finite();
        let hard = !(stiffness > 0.0 && stiffness * time * time <= inertia);
        let stiff = !(damping >= 0.0 && damping * time <= inertia);
        let rows = [
            ("stops.negative", low, !ordered),
            ("stops.stiffness", stiffness, hard),
            ("stops.damping", damping, stiff),
        ];
        if let Some((key, value, _)) = rows.into_iter().find(|(.., bad)| *bad) {
            return Err(MechanismError { key, value });
        }
        self.stops = Some(stops);
        Ok(self)
    }

    /// One substep under a constant torque. Cost: about 25 multiplications; in contact with a stop up to 100 times
    /// that.
    #[inline]
    pub fn step(&mut self, torque: f64) {
        let mut moved = self.moved(torque);
        if let Some(stops) = &self.stops {
            let mut push = 0.0;
            for _ in 0..ROUNDS {
                let next = stops.torque(self.position, moved.way, self.time);
                if next == push {
                    break;
                }
                push = next;
                moved = self.moved(torque - push);
            }
        }
        self.position += moved.way;
        self.twist = moved.twist;
        self.velocity = moved.velocity;
        self.load_velocity = moved.load_velocity;
    }

    /// The result of a substep under this torque and friction.
    #[inline]
    fn moved(&self, torque: f64) -> Moved {
        let [by_twist, by_motor, by_load, by_torque] = &self.step;
        let (twist, motor, load) = (self.twist, self.velocity, self.load_velocity);
        let free: [f64; 4] = core::array::from_fn(|of| {
            by_twist[of] * twist + by_motor[of] * motor + by_load[of] * load + by_torque[of] * torque
        });
        // The torque that would stop the motor in this step. Friction is at most its limit.
        let stopped = free[0].abs() <= self.plant.coulomb * by_torque[0];
        if stopped && motor == 0.0 {
            // Friction holds it for the whole step: it must not move by a rounding error.
            let [by_twist, by_load] = &self.held;
            let [twist, load_velocity] = core::array::from_fn(|of| by_twist[of] * twist + by_load[of] * load);
            return Moved {
                way: 0.0,
                twist,
                velocity: 0.0,
                load_velocity,
            };
        }
        let wanted = if stopped {
            free[0] * self.stopping
        } else {
            self.plant.coulomb.copysign(free[0])
        };
        let friction = match self.plant.load {
            Some(_) => {
                // A hard spring reverses the motor within the step. Full friction over that path would add energy.
                let whole_way = free[1] / by_torque[1];
                wanted.max(whole_way.min(0.0)).min(whole_way.max(0.0))
            }
            None => wanted,
        };
        let [motor, way, twist, load] = core::array::from_fn(|of| free[of] - friction * by_torque[of]);
        Moved {
            way,
            twist,
            velocity: if stopped && friction == wanted { 0.0 } else { motor },
            load_velocity: load,
        }
    }

    /// Motor position (u).
    pub fn position(&self) -> f64 {
        self.position
    }

    /// Motor velocity (u/s).
    pub fn velocity(&self) -> f64 {
        self.velocity
    }

    /// Load position (u).
    pub fn load_position(&self) -> f64 {
        self.position - self.twist
    }

    /// The plant.
    pub fn plant(&self) -> &Plant {
        &self.plant
    }

    /// The mechanism was moved by this distance (u).
    pub fn shift(&mut self, by: f64) {
        self.position += by;
    }

    /// Renames positions: each is `by` (u) more.
    pub fn rename(&mut self, by: f64) {
        self.position += by;
        if let Some(Stops {
            ends: (low, high), ..
        }) = &mut self.stops
        {
            *low += by;
            *high += by;
        }
    }
}

/// The time derivative of (twist, motor velocity, load velocity, way, torque).
fn derivative(plant: &Plant) -> Matrix {
    let motor = 1.0 / plant.inertia;
    let [mut of_motor, mut of_load] = [[0.0; SIZE]; 2];
    of_motor[1] = -plant.viscous * motor;
    of_motor[4] = motor;
    let mut of_twist = [0.0; SIZE];
    if let Some(load) = plant.load {
        let inverse = 1.0 / load.inertia;
        of_twist[1] = 1.0;
        of_twist[2] = -1.0;
        of_motor[0] -= load.stiffness * motor;
        of_motor[1] -= load.damping * motor;
        of_motor[2] += load.damping * motor;
        of_load[0] = load.stiffness * inverse;
        of_load[1] = load.damping * inverse;
        of_load[2] = -load.damping * inverse;
    }
    let mut of_way = [0.0; SIZE];
    of_way[1] = 1.0;
    [of_twist, of_motor, of_load, of_way, [0.0; SIZE]]
}
