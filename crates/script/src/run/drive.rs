//! The drives a script can have.

use crate::model::{Axis, Cia402Setup, DriveChange, DriveSetup, IdealDriveSetup, PlantSetup};
use standstill_axis::{Drive, DriveCommand, DriveFeedback, DrivePosition, IdealDrive, Powered, StartState};
use standstill_drives::cia402::{Cia402Drive, Settings};
use standstill_drives::mechanism::{Mechanism, MechanismError, PlantDrive, Servo};

/// One of them.
#[derive(Clone, Debug)]
pub(crate) enum ScriptDrive {
    Ideal(Box<IdealDrive>),
    Cia402(Box<Cia402Drive>),
    Plant(Box<PlantDrive>),
}

impl ScriptDrive {
    /// # Errors
    /// None for what was read: the mechanism was made once then.
    pub(crate) fn new(axis: &Axis, cycle_ns: i64) -> Result<Self, MechanismError> {
        let increments = |position: f64| axis.config.scaling.map(|scaling| scaling.to_increments(position));
        let position = increments(axis.config.position);
        let enabled = axis.config.start == StartState::Standstill;
        Ok(match axis.drive {
            DriveSetup::Ideal(IdealDriveSetup { delay, power_on }) => {
                let position = match position {
                    Some(increments) => DrivePosition::Increments(increments),
                    None => DrivePosition::Units(axis.config.position),
                };
                Self::Ideal(Box::new(IdealDrive::new(position, delay, power_on, enabled)))
            }
            DriveSetup::Cia402(setup) => {
                let ordered = |(one, other): (f64, f64)| {
                    let (one, other) = (increments(one)?, increments(other)?);
                    // The drive may count the other way.
                    Some((one.min(other), one.max(other)))
                };
                Self::Cia402(Box::new(Cia402Drive::simulated_node(Settings {
                    position: position.unwrap_or_default(),
                    enabled,
                    deceleration: deceleration(axis, &setup, cycle_ns),
                    delay: setup.delay,
                    start_up: setup.start_up,
                    power_on: setup.power_on,
                    quick_stop: setup.quick_stop,
                    leaving: setup.on_disable,
                    fault: setup.on_fault,
                    ends: setup.limit_switches.and_then(ordered),
                    home: setup.home_switch.and_then(ordered),
                })))
            }
            DriveSetup::Plant(PlantSetup {
                power_on,
                plant,
                gains,
            }) => {
                let cycle = cycle_ns as f64 / 1e9;
                let mechanism = Mechanism::new(plant, axis.config.position, cycle)?;
                let servo = Servo::new(mechanism, gains, cycle)?;
                let counts = axis.config.scaling.map(|scaling| {
                    let ratio = f64::from(scaling.increments()) / f64::from(scaling.units());
                    (if scaling.invert() { -ratio } else { ratio }, scaling.offset())
                });
                Self::Plant(Box::new(PlantDrive::new(servo, counts, power_on, enabled)))
            }
        })
    }

    /// A drive fault with the drive's own `code`.
    pub(crate) fn fail(&mut self, code: u16) {
        match self {
            Self::Ideal(drive) => drive.fail(code),
            Self::Cia402(drive) => drive.node_mut().fail(code),
            Self::Plant(drive) => drive.fail(code),
        }
    }

    /// The power stage loses its supply.
    pub(crate) fn cut_power(&mut self) {
        match self {
            Self::Ideal(drive) => drive.cut_power(),
            Self::Cia402(drive) => drive.node_mut().cut_power(),
            Self::Plant(drive) => drive.cut_power(),
        }
    }

    /// Feedback no longer arrives.
    pub(crate) fn cut_communication(&mut self) {
        match self {
            Self::Ideal(drive) => drive.cut_communication(),
            Self::Cia402(drive) => drive.node_mut().cut_communication(),
            Self::Plant(drive) => drive.cut_communication(),
        }
    }

    /// The cause of whatever fault is gone.
    pub(crate) fn clear_cause(&mut self) {
        match self {
            Self::Ideal(drive) => drive.clear_cause(),
            Self::Cia402(drive) => drive.node_mut().clear_cause(),
            Self::Plant(drive) => drive.clear_cause(),
        }
    }

    /// What a step does to it; one that the drive does not know was refused when the script was read.
    ///
    /// # Errors
    /// [`Powered`] if it is to be pushed while it has torque.
    pub(crate) fn change(&mut self, change: DriveChange) -> Result<(), Powered> {
        match (self, change) {
            (Self::Ideal(drive), DriveChange::Displace(distance)) => drive.displace(distance),
            (Self::Plant(drive), DriveChange::Displace(distance)) => drive.displace(distance),
            (Self::Cia402(drive), DriveChange::Displace(distance)) => {
                drive.node_mut().displace(distance as i64).map_err(|_| Powered)
            }
            (Self::Cia402(drive), DriveChange::Remote(remote)) => {
                drive.node_mut().set_remote(remote);
                Ok(())
            }
            (Self::Cia402(drive), DriveChange::Warning(warning)) => {
                drive.node_mut().set_warning(warning);
                Ok(())
            }
            (Self::Ideal(_) | Self::Plant(_), DriveChange::Remote(_) | DriveChange::Warning(_)) => Ok(()),
        }
    }
}

/// In increments/scan^2.
fn deceleration(axis: &Axis, setup: &Cia402Setup, cycle_ns: i64) -> f64 {
    let rate = setup.deceleration.unwrap_or(axis.config.limits.deceleration);
    let cycle = cycle_ns as f64 / 1e9;
    let increments = axis.config.scaling.map_or(1.0, |scaling| {
        f64::from(scaling.increments()) / f64::from(scaling.units())
    });
    rate * increments * cycle * cycle
}

impl Drive for ScriptDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        match self {
            Self::Ideal(drive) => drive.read(now_ns),
            Self::Cia402(drive) => drive.read(now_ns),
            Self::Plant(drive) => drive.read(now_ns),
        }
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        match self {
            Self::Ideal(drive) => drive.write(now_ns, command),
            Self::Cia402(drive) => drive.write(now_ns, command),
            Self::Plant(drive) => drive.write(now_ns, command),
        }
    }
}
