//! The simulated drives with all their parts: motion, switches along the travel, digital inputs and
//! outputs, probes.
//!
//! This module describes a drive in the units of its axis and makes the drive from that. The parts
//! themselves are in the modules they come from. Scan scripts and the C library use these drives.

use crate::cia402::{Cia402Drive, MotorLoad, NodeHoming, Reaction, Settings, TorqueScale};
use crate::mechanism::{Gains, Mechanism, MechanismError, Plant, PlantDrive, Servo, Stops};
use crate::peripherals::Peripherals;
use crate::switches::{Switches, Travel};
use standstill_axis::{
    AxisConfig, Drive, DriveCommand, DriveFeedback, DriveOrder, DrivePosition, DriveReport, IdealDrive,
    Powered, StartState,
};

/// The drive of an axis.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveSetup {
    /// Follows its command exactly.
    Ideal(IdealDriveSetup),
    /// A simulated CiA 402 drive.
    Cia402(Cia402Setup),
    /// Turns a mechanism.
    Plant(PlantSetup),
}

/// Parameters of a drive with a mechanism.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantSetup {
    /// Scans until power is confirmed; `None` for never.
    pub power_on: Option<u32>,
    /// The moving parts.
    pub plant: Plant,
    /// The mechanical stops, if any.
    pub stops: Option<Stops>,
    /// The loops.
    pub gains: Gains,
    /// Along its travel.
    pub switches: Switches,
}

impl PlantSetup {
    /// A start value: no inertia, friction or load, and gains not chosen yet.
    pub const NONE: Self = Self {
        power_on: Some(0),
        plant: Plant {
            inertia: 0.0,
            viscous: 0.0,
            coulomb: 0.0,
            load: None,
        },
        stops: None,
        gains: Gains {
            position: f64::NAN,
            velocity: f64::NAN,
            integral: f64::NAN,
            feed_velocity: 1.0,
            feed_acceleration: 1.0,
            torque: f64::INFINITY,
        },
        switches: Switches::NONE,
    };

    /// Replaces gains that are NaN by those of [`Gains::of`] in scans of `cycle` seconds.
    #[must_use]
    pub fn with_gains(self, cycle: f64) -> Self {
        let own = Gains::of(&self.plant, cycle);
        let or = |given: f64, own: f64| if given.is_nan() { own } else { given };
        let gains = Gains {
            position: or(self.gains.position, own.position),
            velocity: or(self.gains.velocity, own.velocity),
            integral: or(self.gains.integral, own.integral),
            ..self.gains
        };
        Self { gains, ..self }
    }
}

impl Cia402Setup {
    /// A drive without delay that ramps down at a quick stop and at a fault, and coasts when it is
    /// disabled.
    pub const PLAIN: Self = Self {
        delay: 0,
        power_on: Some(0),
        start_up: 0,
        deceleration: None,
        quick_stop: Reaction::Ramp,
        on_disable: Reaction::Coast,
        on_fault: Reaction::Ramp,
        homing: None,
        motor: None,
        switches: Switches::NONE,
    };
}

impl IdealDriveSetup {
    /// A drive without delay.
    pub const PLAIN: Self = Self {
        delay: 0,
        power_on: Some(0),
        switches: Switches::NONE,
    };
}

impl DriveSetup {
    /// The switches along its travel.
    pub fn switches(&self) -> &Switches {
        match self {
            Self::Ideal(setup) => &setup.switches,
            Self::Cia402(setup) => &setup.switches,
            Self::Plant(setup) => &setup.switches,
        }
    }
}

impl Default for DriveSetup {
    fn default() -> Self {
        Self::Ideal(IdealDriveSetup::PLAIN)
    }
}

/// Parameters of a simulated CiA 402 drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Cia402Setup {
    /// Scans from command to actual position.
    pub delay: usize,
    /// Scans from Switched on to Operation enabled; `None` for never.
    pub power_on: Option<u32>,
    /// Scans of self-test.
    pub start_up: u32,
    /// Rate of the drive's own ramps (u/s^2), above 0; the deceleration of the axis limits if absent.
    pub deceleration: Option<f64>,
    /// Object 605Ah.
    pub quick_stop: Reaction,
    /// Objects 605Bh and 605Ch.
    pub on_disable: Reaction,
    /// Object 605Eh.
    pub on_fault: Reaction,
    /// Homing mode: whether it goes upwards, and the velocity (u/s), above 0.
    pub homing: Option<(bool, f64)>,
    /// The motor in torque mode; none if it does not have the mode.
    pub motor: Option<MotorSetup>,
    /// Along its travel.
    pub switches: Switches,
}

/// The motor of a simulated CiA 402 drive, in a unit of torque that the host chooses.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct MotorSetup {
    /// Object 6076h, above 0.
    pub rated_torque: f64,
    /// Object 6072h, above 0 and within the range of the bus.
    pub max_torque: f64,
    /// Torque for an acceleration (torque s^2/u), above 0.
    pub inertia: f64,
    /// Friction that grows with velocity (torque s/u), from 0.
    pub viscous: f64,
    /// Friction that does not (torque), from 0.
    pub coulomb: f64,
}

/// Parameters of the ideal drive.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct IdealDriveSetup {
    /// Scans from command to actual position.
    pub delay: usize,
    /// Scans until power is confirmed; `None` for never.
    pub power_on: Option<u32>,
    /// Along its travel.
    pub switches: Switches,
}

/// A disturbance of a drive other than a fault.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DriveChange {
    /// Someone pushes the axis while its power is off (u; increments at drives that count them).
    Displace(f64),
    /// Whether a CiA 402 drive obeys its controller.
    Remote(bool),
    /// Whether a CiA 402 drive shows a warning.
    Warning(bool),
    /// A digital input.
    Input {
        /// From 0.
        number: u32,
        /// The level from this scan on.
        level: bool,
    },
    /// The input of a touch probe.
    Probe {
        /// From 0.
        number: usize,
        /// The part of the scan that ends with this feedback (0 to 1).
        at: f64,
        /// The level from there on.
        level: bool,
    },
    /// The encoder is broken: from this scan on the drive reports this position, independent of the position of the
    /// axis, until the cause is cleared.
    ReportPosition(DrivePosition),
    /// The same for the actual torque. No effect on a drive that reports none.
    ReportTorque(f64),
}

/// A drive with its peripherals.
///
/// It powers up, moves and fails as its [`DriveSetup`] says, in cycles of fixed length.
#[derive(Clone, Debug)]
pub struct SimulatedDrive {
    kind: Kind,
    peripherals: Peripherals,
    travel: Travel,
    /// The last reported position.
    position: DrivePosition,
    /// Reported instead of the measured position.
    told_position: Option<DrivePosition>,
    told_torque: Option<f64>,
    /// The last command in units.
    commanded: f64,
}

/// The part that moves.
#[derive(Clone, Debug)]
// Without a heap all kinds share this place, so the largest determines the size.
#[allow(clippy::large_enum_variant)]
enum Kind {
    Ideal(IdealDrive),
    Cia402(Cia402Drive),
    Plant(PlantDrive),
}

impl SimulatedDrive {
    /// The drive under an axis of this configuration. `cycle_ns` is the cycle in nanoseconds, above 0.
    ///
    /// Only a mechanism is checked. A CiA 402 drive under an axis without a scaling counts one increment
    /// per unit. Values outside the ranges of [`Cia402Setup`] and [`MotorSetup`] give a useless drive.
    ///
    /// # Errors
    /// [`MechanismError`], of a plant.
    pub fn new(setup: &DriveSetup, axis: &AxisConfig, cycle_ns: i64) -> Result<Self, MechanismError> {
        let increments = |position: f64| axis.scaling.map(|scaling| scaling.to_increments(position));
        let position = increments(axis.position);
        let enabled = axis.start == StartState::Standstill;
        let kind = match *setup {
            DriveSetup::Ideal(IdealDriveSetup { delay, power_on, .. }) => {
                let position = match position {
                    Some(increments) => DrivePosition::Increments(increments),
                    None => DrivePosition::Units(axis.position),
                };
                Kind::Ideal(IdealDrive::new(position, delay, power_on, enabled))
            }
            DriveSetup::Cia402(setup) => {
                let ordered = |(one, other): (f64, f64)| {
                    let (one, other) = (increments(one)?, increments(other)?);
                    // The drive may count in the other direction.
                    Some((one.min(other), one.max(other)))
                };
                let per_unit = increments_per_unit(axis);
                let rate = 1e9 / cycle_ns as f64;
                let mut drive = Cia402Drive::simulated_node(Settings {
                    position: position.unwrap_or_default(),
                    enabled,
                    deceleration: deceleration(axis, &setup, cycle_ns),
                    delay: setup.delay,
                    start_up: setup.start_up,
                    power_on: setup.power_on,
                    quick_stop: setup.quick_stop,
                    leaving: setup.on_disable,
                    fault: setup.on_fault,
                    ends: setup.switches.limits.and_then(ordered),
                    home: setup.switches.home.and_then(ordered),
                    homing: setup.homing.map(|(up, velocity)| NodeHoming {
                        up: up != counts_down(axis),
                        velocity: velocity * per_unit / rate,
                    }),
                    load: setup.motor.map(|motor| load(&motor, per_unit, rate)),
                    rate,
                    ..Settings::default()
                });
                if let Some(motor) = setup.motor {
                    drive = drive.with_torque(TorqueScale {
                        rated: motor.rated_torque,
                        increments: if counts_down(axis) { -per_unit } else { per_unit },
                        // The bound is reached in about four scans: no oscillation, and little distance
                        // left.
                        gain: 0.25 * motor.inertia * rate,
                    });
                }
                Kind::Cia402(drive)
            }
            DriveSetup::Plant(PlantSetup {
                power_on,
                plant,
                stops,
                gains,
                ..
            }) => {
                let cycle = cycle_ns as f64 / 1e9;
                let mut mechanism = Mechanism::new(plant, axis.position, cycle)?;
                if let Some(stops) = stops {
                    mechanism = mechanism.between(stops, cycle)?;
                }
                let servo = Servo::new(mechanism, gains, cycle)?;
                Kind::Plant(PlantDrive::new(servo, axis.scaling, power_on, enabled))
            }
        };
        let switches = Switches {
            turn: axis.modulo,
            ..*setup.switches()
        };
        Ok(Self {
            kind,
            travel: Travel::new(switches, axis.scaling),
            peripherals: Peripherals::new(axis.modulo),
            commanded: axis.position,
            told_position: None,
            told_torque: None,
            position: position.map_or(DrivePosition::Units(axis.position), DrivePosition::Increments),
        })
    }

    /// Whether it is a CiA 402 drive.
    pub fn is_cia402(&self) -> bool {
        matches!(self.kind, Kind::Cia402(_))
    }

    /// The scans from command to actual position, for an ideal drive. Its behaviour then depends on no earlier
    /// command.
    pub fn delay(&self) -> Option<usize> {
        match &self.kind {
            Kind::Ideal(drive) => Some(drive.delay()),
            Kind::Cia402(_) | Kind::Plant(_) => None,
        }
    }

    /// Raises a drive fault with the drive's own `code`.
    pub fn fail(&mut self, code: u16) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.fail(code),
            Kind::Cia402(drive) => drive.node_mut().fail(code),
            Kind::Plant(drive) => drive.stage_mut().fail(code),
        }
    }

    /// The power stage loses its supply.
    pub fn cut_power(&mut self) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.cut_power(),
            Kind::Cia402(drive) => drive.node_mut().cut_power(),
            Kind::Plant(drive) => drive.stage_mut().cut_power(),
        }
    }

    /// Feedback no longer arrives.
    pub fn cut_communication(&mut self) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.cut_communication(),
            Kind::Cia402(drive) => drive.node_mut().cut_communication(),
            Kind::Plant(drive) => drive.stage_mut().cut_communication(),
        }
    }

    /// Removes the causes of all faults.
    pub fn clear_cause(&mut self) {
        (self.told_position, self.told_torque) = (None, None);
        match &mut self.kind {
            Kind::Ideal(drive) => drive.clear_cause(),
            Kind::Cia402(drive) => drive.node_mut().clear_cause(),
            Kind::Plant(drive) => drive.stage_mut().clear_cause(),
        }
    }

    /// Applies a disturbance. One that only a CiA 402 drive knows has no effect on others.
    ///
    /// # Errors
    /// [`Powered`] if it is pushed while it has torque.
    pub fn change(&mut self, change: DriveChange) -> Result<(), Powered> {
        match (&mut self.kind, change) {
            (Kind::Ideal(drive), DriveChange::Displace(distance)) => drive.displace(distance),
            (Kind::Plant(drive), DriveChange::Displace(distance)) => drive.displace(distance),
            (Kind::Cia402(drive), DriveChange::Displace(distance)) => {
                drive.node_mut().displace(distance as i64).map_err(|_| Powered)
            }
            (Kind::Cia402(drive), DriveChange::Remote(remote)) => {
                drive.node_mut().set_remote(remote);
                Ok(())
            }
            (Kind::Cia402(drive), DriveChange::Warning(warning)) => {
                drive.node_mut().set_warning(warning);
                Ok(())
            }
            (Kind::Ideal(_) | Kind::Plant(_), DriveChange::Remote(_) | DriveChange::Warning(_)) => Ok(()),
            (_, DriveChange::Input { number, level }) => {
                self.peripherals.set_input(number, level);
                Ok(())
            }
            (Kind::Cia402(drive), DriveChange::Probe { number, at, level }) => {
                drive.node_mut().set_probe(number, at, level);
                Ok(())
            }
            (_, DriveChange::Probe { number, at, level }) => {
                self.peripherals.set_probe(number, at, level);
                Ok(())
            }
            (_, DriveChange::ReportPosition(position)) => {
                self.told_position = Some(position);
                Ok(())
            }
            (_, DriveChange::ReportTorque(torque)) => {
                self.told_torque = Some(torque);
                Ok(())
            }
        }
    }
}

fn counts_down(axis: &AxisConfig) -> bool {
    axis.scaling.is_some_and(|scaling| scaling.invert())
}

/// Converts to thousandths of the rated torque, increments and scans. `per_unit` is in increments per
/// unit, `rate` in scans per second.
fn load(motor: &MotorSetup, per_unit: f64, rate: f64) -> MotorLoad {
    let thousandths = 1000.0 / motor.rated_torque;
    MotorLoad {
        inertia: motor.inertia * thousandths * (rate * rate) / per_unit,
        viscous: motor.viscous * thousandths * rate / per_unit,
        coulomb: motor.coulomb * thousandths,
        // The reader has checked that it fits 16 bits.
        most: (motor.max_torque * thousandths + 0.5) as u16,
    }
}

fn increments_per_unit(axis: &AxisConfig) -> f64 {
    axis.scaling.map_or(1.0, |scaling| {
        f64::from(scaling.increments()) / f64::from(scaling.units())
    })
}

/// In increments/scan^2.
fn deceleration(axis: &AxisConfig, setup: &Cia402Setup, cycle_ns: i64) -> f64 {
    let rate = setup.deceleration.unwrap_or(axis.limits.deceleration);
    let cycle = cycle_ns as f64 / 1e9;
    rate * increments_per_unit(axis) * cycle * cycle
}

impl Drive for SimulatedDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        let mut feedback = match &mut self.kind {
            Kind::Ideal(drive) => drive.read(now_ns),
            Kind::Cia402(drive) => drive.read(now_ns),
            Kind::Plant(drive) => drive.read(now_ns),
        };
        if let Kind::Cia402(drive) = &self.kind {
            self.travel.drop_increments(drive.node().origin());
        }
        // Switches have fixed positions, independent of the reports of the encoder.
        self.travel.read(&mut feedback);
        feedback.position = self.told_position.unwrap_or(feedback.position);
        self.position = feedback.position;
        feedback
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        if let Some(name) = command.rename {
            self.peripherals.shift(name - self.commanded);
            self.travel.shift(name - self.commanded);
        }
        if let DrivePosition::Units(position) = command.position {
            self.commanded = position;
        }
        match &mut self.kind {
            Kind::Ideal(drive) => drive.write(now_ns, command),
            Kind::Cia402(drive) => drive.write(now_ns, command),
            Kind::Plant(drive) => drive.write(now_ns, command),
        }
    }

    fn report(&mut self, report: &mut DriveReport) {
        // A CiA 402 node has probes of its own, which replace these.
        self.peripherals.report(self.position, report);
        match &mut self.kind {
            Kind::Ideal(drive) => drive.report(report),
            Kind::Cia402(drive) => drive.report(report),
            Kind::Plant(drive) => drive.report(report),
        }
        if let (Some(told), Some(torque)) = (self.told_torque, &mut report.torque) {
            torque.actual = told;
        }
        self.travel.report(report);
    }

    fn order(&mut self, order: &DriveOrder) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.order(order),
            Kind::Cia402(drive) => drive.order(order),
            Kind::Plant(drive) => drive.order(order),
        }
        self.peripherals.order(order);
        self.travel.order(order);
    }
}
