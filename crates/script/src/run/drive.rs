//! The drives a script can have.

use crate::model::{Axis, Cia402Setup, DriveChange, DriveSetup, IdealDriveSetup, MotorSetup, PlantSetup};
use standstill_axis::{
    Drive, DriveCommand, DriveFeedback, DriveOrder, DrivePosition, DriveReport, IdealDrive, Powered,
    StartState,
};
use standstill_drives::cia402::{Cia402Drive, MotorLoad, NodeHoming, Settings, TorqueScale};
use standstill_drives::mechanism::{Mechanism, MechanismError, PlantDrive, Servo};
use standstill_drives::peripherals::Peripherals;
use standstill_drives::switches::{Switches, Travel};

/// A drive, and what it has beside its motion.
#[derive(Clone, Debug)]
pub(crate) struct ScriptDrive {
    kind: Kind,
    peripherals: Peripherals,
    travel: Travel,
    /// As last fed back.
    position: DrivePosition,
    /// The last command in units.
    commanded: f64,
}

/// What moves.
#[derive(Clone, Debug)]
enum Kind {
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
        let kind = match axis.drive {
            DriveSetup::Ideal(IdealDriveSetup { delay, power_on, .. }) => {
                let position = match position {
                    Some(increments) => DrivePosition::Increments(increments),
                    None => DrivePosition::Units(axis.config.position),
                };
                Kind::Ideal(Box::new(IdealDrive::new(position, delay, power_on, enabled)))
            }
            DriveSetup::Cia402(setup) => {
                let ordered = |(one, other): (f64, f64)| {
                    let (one, other) = (increments(one)?, increments(other)?);
                    // The drive may count the other way.
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
                        // Four scans from any distance to the bound: no swing, and little left of it.
                        gain: 0.25 * motor.inertia * rate,
                    });
                }
                Kind::Cia402(Box::new(drive))
            }
            DriveSetup::Plant(PlantSetup {
                power_on,
                plant,
                stops,
                gains,
                ..
            }) => {
                let cycle = cycle_ns as f64 / 1e9;
                let mut mechanism = Mechanism::new(plant, axis.config.position, cycle)?;
                if let Some(stops) = stops {
                    mechanism = mechanism.between(stops, cycle)?;
                }
                let servo = Servo::new(mechanism, gains, cycle)?;
                Kind::Plant(Box::new(PlantDrive::new(
                    servo,
                    axis.config.scaling,
                    power_on,
                    enabled,
                )))
            }
        };
        let switches = Switches {
            turn: axis.config.modulo,
            ..*axis.drive.switches()
        };
        Ok(Self {
            kind,
            travel: Travel::new(switches, axis.config.scaling),
            peripherals: Peripherals::new(axis.config.modulo),
            commanded: axis.config.position,
            position: position.map_or(
                DrivePosition::Units(axis.config.position),
                DrivePosition::Increments,
            ),
        })
    }

    /// A drive fault with the drive's own `code`.
    pub(crate) fn fail(&mut self, code: u16) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.fail(code),
            Kind::Cia402(drive) => drive.node_mut().fail(code),
            Kind::Plant(drive) => drive.fail(code),
        }
    }

    /// The power stage loses its supply.
    pub(crate) fn cut_power(&mut self) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.cut_power(),
            Kind::Cia402(drive) => drive.node_mut().cut_power(),
            Kind::Plant(drive) => drive.cut_power(),
        }
    }

    /// Feedback no longer arrives.
    pub(crate) fn cut_communication(&mut self) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.cut_communication(),
            Kind::Cia402(drive) => drive.node_mut().cut_communication(),
            Kind::Plant(drive) => drive.cut_communication(),
        }
    }

    /// The cause of whatever fault is gone.
    pub(crate) fn clear_cause(&mut self) {
        match &mut self.kind {
            Kind::Ideal(drive) => drive.clear_cause(),
            Kind::Cia402(drive) => drive.node_mut().clear_cause(),
            Kind::Plant(drive) => drive.clear_cause(),
        }
    }

    /// What a step does to it; one that the drive does not know was refused when the script was read.
    ///
    /// # Errors
    /// [`Powered`] if it is to be pushed while it has torque.
    pub(crate) fn change(&mut self, change: DriveChange) -> Result<(), Powered> {
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
        }
    }
}

fn counts_down(axis: &Axis) -> bool {
    axis.config.scaling.is_some_and(|scaling| scaling.invert())
}

/// In thousandths of the rated torque, increments and scans, `per_unit` increments a unit and `rate` scans a second.
fn load(motor: &MotorSetup, per_unit: f64, rate: f64) -> MotorLoad {
    let thousandths = 1000.0 / motor.rated_torque;
    MotorLoad {
        inertia: motor.inertia * thousandths * (rate * rate) / per_unit,
        viscous: motor.viscous * thousandths * rate / per_unit,
        coulomb: motor.coulomb * thousandths,
        // Within 16 bits since it was read.
        most: (motor.max_torque * thousandths + 0.5) as u16,
    }
}

fn increments_per_unit(axis: &Axis) -> f64 {
    axis.config.scaling.map_or(1.0, |scaling| {
        f64::from(scaling.increments()) / f64::from(scaling.units())
    })
}

/// In increments/scan^2.
fn deceleration(axis: &Axis, setup: &Cia402Setup, cycle_ns: i64) -> f64 {
    let rate = setup.deceleration.unwrap_or(axis.config.limits.deceleration);
    let cycle = cycle_ns as f64 / 1e9;
    rate * increments_per_unit(axis) * cycle * cycle
}

impl Drive for ScriptDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        let mut feedback = match &mut self.kind {
            Kind::Ideal(drive) => drive.read(now_ns),
            Kind::Cia402(drive) => drive.read(now_ns),
            Kind::Plant(drive) => drive.read(now_ns),
        };
        self.position = feedback.position;
        if let Kind::Cia402(drive) = &self.kind {
            self.travel.drop_increments(drive.node().origin());
        }
        self.travel.read(&mut feedback);
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
        // A CiA 402 node has probes of its own, which take the place of these.
        self.peripherals.report(self.position, report);
        match &mut self.kind {
            Kind::Ideal(drive) => drive.report(report),
            Kind::Cia402(drive) => drive.report(report),
            Kind::Plant(drive) => drive.report(report),
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
