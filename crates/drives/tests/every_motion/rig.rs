//! An axis over a drive that can fail, scan by scan, with the claims that hold in every scan.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BlockDetection, Comms, Drive, DriveCommand, DriveFeedback,
    DriveOrder, DrivePosition, DriveReport, ErrorId, Homing, Limits, Log, Permission, Procedure, Scaling,
    Scope, Standard, StartState,
};
use standstill_drives::cia402::{Cia402Drive, MotorLoad, NodeHoming, Reaction, Settings, TorqueScale};
use standstill_drives::mechanism::{Gains, Mechanism, Plant, PlantDrive, Servo, Stops};
use standstill_drives::switches::{Marker, Switches, Travel};
pub use standstill_testkit::Random;

const CYCLE: f64 = 0.001;

/// Increments a unit.
const SCALE: f64 = 10_000.0;

pub const LIMITS: Limits = Limits {
    velocity: 100.0,
    acceleration: 2000.0,
    deceleration: 2000.0,
    jerk: 200_000.0,
    snap: f64::INFINITY,
};

/// Largest distance from one set-point to the next (u): a scan at the velocity limit, and an increment.
pub const STEP: f64 = LIMITS.velocity * CYCLE + 1.0 / SCALE;

/// The kind of drive.
enum Kind {
    Cia402(Box<Cia402Drive>),
    Plant(Box<PlantDrive>),
}

/// A failure, or its repair.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Upset {
    Fault,
    Power,
    Communication,
    Clear,
    Displace(i32),
    Remote(bool),
}

/// Values that a drive reports instead of its measurements.
#[derive(Clone, Copy, Debug, Default)]
pub struct Told {
    pub position: Option<f64>,
    pub torque: Option<f64>,
    /// Something else in the report.
    pub beside: Option<fn(&mut DriveReport)>,
}

impl Told {
    pub fn position(position: f64) -> Self {
        Self {
            position: Some(position),
            ..Self::default()
        }
    }

    pub fn torque(torque: f64) -> Self {
        Self {
            torque: Some(torque),
            ..Self::default()
        }
    }

    pub fn beside(change: fn(&mut DriveReport)) -> Self {
        Self {
            beside: Some(change),
            ..Self::default()
        }
    }

    /// Applies the false values to a feedback and a report. A count of increments is always a number.
    fn over(&self, feedback: &mut DriveFeedback, report: &mut DriveReport) {
        if let Some(told) = self.position {
            feedback.position = match feedback.position {
                DrivePosition::Units(_) => DrivePosition::Units(told),
                DrivePosition::Increments(_) if told.is_finite() => DrivePosition::Increments(told as i64),
                DrivePosition::Increments(increments) => DrivePosition::Increments(increments),
            };
        }
        if let (Some(told), Some(torque)) = (self.torque, &mut report.torque) {
            torque.actual = told;
        }
        if let Some(change) = self.beside {
            change(report);
        }
    }
}

struct Device {
    kind: Kind,
    travel: Travel,
}

impl Device {
    fn upset(&mut self, upset: Upset) {
        match (&mut self.kind, upset) {
            (Kind::Cia402(drive), Upset::Fault) => drive.node_mut().fail(7),
            (Kind::Cia402(drive), Upset::Power) => drive.node_mut().cut_power(),
            (Kind::Cia402(drive), Upset::Communication) => drive.node_mut().cut_communication(),
            (Kind::Cia402(drive), Upset::Clear) => drive.node_mut().clear_cause(),
            // Refused while there is torque, which is correct.
            (Kind::Cia402(drive), Upset::Displace(by)) => {
                drive.node_mut().displace(by.into()).unwrap_or_default()
            }
            (Kind::Cia402(drive), Upset::Remote(remote)) => drive.node_mut().set_remote(remote),
            (Kind::Plant(drive), Upset::Fault) => drive.stage_mut().fail(7),
            (Kind::Plant(drive), Upset::Power) => drive.stage_mut().cut_power(),
            (Kind::Plant(drive), Upset::Communication) => drive.stage_mut().cut_communication(),
            (Kind::Plant(drive), Upset::Clear) => drive.stage_mut().clear_cause(),
            (Kind::Plant(drive), Upset::Displace(by)) => {
                drive.displace(f64::from(by) / SCALE).unwrap_or_default()
            }
            (Kind::Plant(_), Upset::Remote(_)) => {}
        }
    }

    fn read(&mut self) -> DriveFeedback {
        let mut feedback = match &mut self.kind {
            Kind::Cia402(drive) => drive.read(0),
            Kind::Plant(drive) => drive.read(0),
        };
        self.travel.drop_increments(self.origin());
        self.travel.read(&mut feedback);
        feedback
    }

    /// Increments the drive has taken off its own count.
    fn origin(&self) -> i64 {
        match &self.kind {
            Kind::Cia402(drive) => drive.node().origin(),
            Kind::Plant(_) => 0,
        }
    }

    fn report(&mut self, report: &mut DriveReport) {
        match &mut self.kind {
            Kind::Cia402(drive) => drive.report(report),
            Kind::Plant(drive) => drive.report(report),
        }
        self.travel.report(report);
    }

    fn write(&mut self, order: &DriveOrder, command: &DriveCommand) {
        self.travel.order(order);
        match &mut self.kind {
            Kind::Cia402(drive) => {
                drive.order(order);
                drive.write(0, command);
            }
            Kind::Plant(drive) => {
                drive.order(order);
                drive.write(0, command);
            }
        }
    }

    /// A position in the coordinates of the start (u).
    fn place(&self, position: DrivePosition) -> f64 {
        match position {
            DrivePosition::Units(units) => units,
            DrivePosition::Increments(increments) => (increments + self.origin()) as f64 / SCALE,
        }
    }
}

pub struct Rig {
    pub axis: Axis,
    device: Device,
    pub log: Log,
    pub scan: u64,
    /// The last set-point in operation (u), and whether the axis was commanded to go there. Under a torque, and
    /// while the drive moves by itself, the set-point is the actual position.
    last: Option<(f64, bool)>,
    pub enabled: u32,
    pub worst: f64,
    /// The false values that the drive reports.
    pub told: Told,
    /// The axis may believe false values, so it may move anywhere.
    pub believes_lies: bool,
    /// Scans in which the axis refused the report of the drive.
    pub refused: u32,
}

impl Rig {
    /// With a drive and a kind of homing drawn from `random`.
    pub fn new(random: &mut Random, is_plant: bool) -> Self {
        let procedures = if is_plant {
            &Procedure::ALL[..5]
        } else {
            &Procedure::ALL[..]
        };
        let procedure = random.one_of(procedures);
        let config = AxisConfig {
            start: StartState::Standstill,
            scaling: (!is_plant).then(|| Scaling::new(SCALE as u32, 1, false, 0.0).expect("a scaling")),
            software_limits: random.below(3).eq(&0).then_some((-30.0, 30.0)),
            max_following_error: random.below(4).eq(&0).then(|| 0.01 + random.unit()),
            homing: Homing {
                procedure,
                velocity: if matches!(procedure, Procedure::Direct | Procedure::Drive) {
                    0.0
                } else {
                    50.0
                },
                creep: (random.below(2) == 0
                    && matches!(procedure, Procedure::AbsoluteSwitch | Procedure::LimitSwitch))
                .then_some(5.0),
                block: (procedure == Procedure::Block).then_some(BlockDetection {
                    velocity: 2.0,
                    scans: 20,
                }),
                time_limit: (procedure != Procedure::Direct).then_some(2000),
                ..Homing::DIRECT
            },
            ..AxisConfig::new(LIMITS)
        };
        let switches = Switches {
            limits: Some((-20.0, 20.0)),
            home: Some((3.0, 30.0)),
            marker: Some(Marker {
                at: 1.0,
                every: Some(7.0),
            }),
            turn: None,
        };
        let kind = if is_plant { plant() } else { node(random) };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect("a good configuration"),
            device: Device {
                kind,
                travel: Travel::new(switches, config.scaling),
            },
            log: Log::default(),
            scan: 0,
            last: None,
            enabled: 0,
            worst: 0.0,
            told: Told::default(),
            believes_lies: false,
            refused: 0,
        }
    }

    pub fn upset(&mut self, upset: Upset) {
        self.device.upset(upset);
    }

    /// One scan with MC_Power as wanted and `during` between feedback and motion.
    pub fn step(
        &mut self,
        power: bool,
        permitted: Permission,
        during: impl FnOnce(&mut Axis, &mut Scope<'_>),
    ) {
        let feedback = self.device.read();
        self.device.report(self.axis.report_mut());
        let mut told = feedback;
        self.told.over(&mut told, self.axis.report_mut());
        self.axis.follow_report();
        self.axis
            .follow_feedback(&told, &mut Scope::new(self.scan, &mut self.log));
        self.look_at_feedback(&told);
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.set_power(power, permitted, scope);
        during(&mut self.axis, scope);
        self.axis.step_alone(scope);
        let command = self.axis.drive_command();
        let order = *self.axis.order();
        self.look_at_numbers(&command, &order);
        if !self.believes_lies {
            self.look(&feedback, &command, &order);
        }
        self.device.write(&order, &command);
        self.scan += 1;
    }

    /// A value that is no number is no feedback: the axis fails, and keeps its last values.
    fn look_at_feedback(&mut self, told: &DriveFeedback) {
        let is_number = told.position.is_finite() && self.axis.report().is_finite();
        if !is_number && told.comms == Comms::Ok {
            self.refused += 1;
            assert_eq!(self.axis.state(), AxisState::ErrorStop, "scan {}", self.scan);
            assert_eq!(self.axis.fresh_position(), Err(ErrorId::FeedbackInvalid));
        }
        assert!(self.axis.actual_position().is_finite());
        assert!(self.axis.actual_velocity().is_ok_and(f64::is_finite) || self.axis.fresh_position().is_err());
    }

    /// For any report of a drive, the commands to it are numbers, and no torque is above its largest one.
    fn look_at_numbers(&self, command: &DriveCommand, order: &DriveOrder) {
        let scan = self.scan;
        let rename = command.rename.unwrap_or_default();
        assert!(
            command.position.is_finite() && rename.is_finite(),
            "scan {scan}: {command:?}"
        );
        assert!(command.velocity.is_finite(), "scan {scan}: {command:?}");
        assert!(self.axis.setpoint().is_finite(), "scan {scan}");
        if let Some(torque) = order.torque {
            let most = self.axis.report().torque.map_or(0.0, |told| told.most.max(0.0));
            let (least, largest) = torque.velocity;
            assert!(torque.torque.abs() <= most, "scan {scan}: {torque:?}");
            assert!(
                least.is_finite() && largest.is_finite(),
                "scan {scan}: {torque:?}"
            );
        }
    }

    /// No set-point in operation is farther from the one before than the axis may move in a scan. The first
    /// set-point is compared with the actual position. Those during and after a torque are compared with either.
    fn look(&mut self, feedback: &DriveFeedback, command: &DriveCommand, order: &DriveOrder) {
        let (target, actual) = (
            self.device.place(command.position),
            self.device.place(feedback.position),
        );
        let rename = command.rename.is_some();
        if feedback.enabled && !rename {
            let from_actual = target - actual;
            let step = match self.last {
                Some((last, true)) => target - last,
                Some((last, false)) if (target - last).abs() < from_actual.abs() => target - last,
                Some(_) | None => from_actual,
            };
            assert!(step.is_finite());
            if step.abs() > STEP {
                let (state, owner) = (self.axis.state(), self.axis.outlook().owner);
                println!(
                    "scan {}: {step} u in {state:?}, {owner:?}, {:?}",
                    self.scan, order.torque
                );
            }
            self.worst = self.worst.max(step.abs());
            self.enabled += 1;
        }
        let leads = order.torque.is_none() && !self.axis.is_following();
        self.last = feedback.enabled.then_some((target, leads));
    }

    /// After any events: once every cause is gone, power, a reset and a halt bring the axis to rest, and it makes a
    /// move.
    pub fn recovers(&mut self) -> Result<(), AxisState> {
        self.upset(Upset::Remote(true));
        self.upset(Upset::Clear);
        // A rising Enable ends the state that a loss of power left.
        for scan in 0..1500 {
            self.step(scan > 3, Permission::BOTH, |axis, scope| {
                axis.clear_cause();
                match axis.state() {
                    AxisState::ErrorStop if scan % 50 == 10 => drop(axis.reset(scope)),
                    AxisState::Stopping => axis.release_stop(axis.newest_command()),
                    _ => {}
                }
            });
            if scan > 20 && self.axis.state() == AxisState::Standstill {
                return Ok(());
            }
        }
        Err(self.axis.state())
    }
}

fn node(random: &mut Random) -> Kind {
    let reactions = [Reaction::Coast, Reaction::Ramp, Reaction::RampAndStay];
    let thousandths = 1000.0 / 5.0;
    let rate = 1.0 / CYCLE;
    let drive = Cia402Drive::simulated_node(Settings {
        enabled: true,
        delay: random.below(4) as usize,
        start_up: random.below(5) as u32,
        power_on: Some(random.below(5) as u32),
        deceleration: 1.0 + random.below(100) as f64,
        quick_stop: random.one_of(&reactions),
        leaving: random.one_of(&reactions),
        fault: random.one_of(&reactions),
        ends: Some(((-20.0 * SCALE) as i64, (20.0 * SCALE) as i64)),
        home: Some(((3.0 * SCALE) as i64, (30.0 * SCALE) as i64)),
        homing: Some(NodeHoming {
            up: random.below(2) == 0,
            velocity: 20.0 * CYCLE * SCALE,
        }),
        load: Some(MotorLoad {
            inertia: 0.01 * thousandths * rate * rate / SCALE,
            viscous: 0.01 * thousandths * rate / SCALE,
            coulomb: 0.2 * thousandths,
            most: 3000,
        }),
        mode_change: 0,
        ..Settings::default()
    });
    Kind::Cia402(Box::new(drive.with_torque(TorqueScale {
        rated: 5.0,
        increments: SCALE,
        gain: 0.25 * 0.01 * rate,
    })))
}

fn plant() -> Kind {
    let plant = Plant {
        inertia: 0.01,
        viscous: 0.01,
        coulomb: 0.2,
        load: None,
    };
    let stops = Stops {
        ends: (-25.0, 25.0),
        stiffness: 2000.0,
        damping: 1.0,
    };
    let made = Mechanism::new(plant, 0.0, CYCLE).and_then(|made| made.between(stops, CYCLE));
    let gains = Gains {
        torque: 40.0,
        ..Gains::of(&plant, CYCLE)
    };
    let servo = Servo::new(made.expect("a mechanism"), gains, CYCLE).expect("a servo");
    Kind::Plant(Box::new(PlantDrive::new(servo, None, Some(0), true)))
}
