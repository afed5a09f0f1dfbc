//! The drives an axis may have: the host's own, and simulated ones.

use crate::config::SetupFault;
use crate::{Code, Command, DriveSetup, Feedback};
use standstill_axis::{
    AxisConfig, Comms, Drive, DriveCommand, DriveFeedback, DriveHoming, DriveOrder, DrivePosition,
    DriveReport, DriveRequest, DriveSignals, Edge, Equipment, Fault, ProbeReport, TorqueReport,
};
use standstill_drives::simulated::SimulatedDrive;

/// A drive. Drives are stored beside each other in the storage of the runtime, so the larger kind
/// determines the size of both.
#[allow(clippy::large_enum_variant)]
pub(crate) enum AnyDrive {
    Host(HostDrive),
    Simulated(SimulatedDrive),
}

/// The reports of a host since the begin of the last tick.
#[derive(Clone, Copy, PartialEq, Eq)]
enum News {
    /// No report.
    None,
    /// Only values that were refused, because they are not numbers.
    NoNumber,
    /// A feedback.
    Fresh,
}

/// A drive of the host: the feedback that it reports and the commands that it receives.
pub(crate) struct HostDrive {
    feedback: DriveFeedback,
    report: DriveReport,
    /// The reports of the host since the begin of the last tick.
    news: News,
    command: DriveCommand,
    order: DriveOrder,
}

/// The feedback before there is any.
pub(crate) fn no_feedback(position: DrivePosition) -> DriveFeedback {
    DriveFeedback {
        enabled: false,
        voltage: false,
        fault: None,
        position,
        comms: Comms::Lost,
        signals: DriveSignals::default(),
    }
}

impl HostDrive {
    fn new(position: DrivePosition) -> Self {
        Self {
            feedback: no_feedback(position),
            report: DriveReport::default(),
            news: News::None,
            command: DriveCommand {
                request: DriveRequest::Off,
                position,
                velocity: 0.0,
                rename: None,
            },
            order: DriveOrder::default(),
        }
    }

    /// Takes the feedback of the host. Refused if an enumeration has an unknown value or a number is not
    /// finite.
    pub fn tell(&mut self, told: &Feedback) -> Result<(), Code> {
        let counts = matches!(self.feedback.position, DrivePosition::Increments(_));
        let at = |units: f64, increments: i64| {
            if counts {
                DrivePosition::Increments(increments)
            } else {
                DrivePosition::Units(units)
            }
        };
        let probe = |armed: u8, latched: u8, units: f64, increments: i64| ProbeReport {
            armed: armed != 0,
            latched: (latched != 0).then(|| at(units, increments)),
        };
        let reference = at(told.home_position, told.home_increments);
        let homing = match told.homing {
            0 => DriveHoming::Off,
            1 => DriveHoming::Busy,
            2 => DriveHoming::Attained(reference),
            3 => DriveHoming::Done(reference),
            4 => DriveHoming::Failed(told.fault_code),
            _ => return Err(Code::BadValue),
        };
        let torque = (told.torque_known != 0).then_some(TorqueReport {
            actual: told.torque,
            most: told.torque_max,
            limited: told.torque_limited != 0,
        });
        let [armed, other_armed] = told.probe_armed;
        let [latched, other_latched] = told.probe_latched;
        let [units, other_units] = told.probe_position;
        let [increments, other_increments] = told.probe_increments;
        let report = DriveReport {
            torque,
            inputs: told.inputs,
            outputs: told.outputs,
            probes: [
                probe(armed, latched, units, increments),
                probe(other_armed, other_latched, other_units, other_increments),
            ],
            marker: probe(
                told.marker_armed,
                told.marker_latched,
                told.marker_position,
                told.marker_increments,
            ),
            homing,
            equipment: Equipment {
                home_switch: told.has_home_switch != 0,
                limit_switches: told.has_limit_switches != 0,
                marker: told.has_marker != 0,
                homing: told.has_homing != 0,
            },
        };
        let position = at(told.position, told.increments);
        if !(position.is_finite() && report.is_finite()) {
            if self.news == News::None {
                self.news = News::NoNumber;
            }
            return Err(Code::BadValue);
        }
        self.feedback = DriveFeedback {
            enabled: told.enabled != 0,
            voltage: told.voltage != 0,
            fault: (told.fault != 0).then_some(Fault {
                code: told.fault_code,
                cause_present: told.cause_present != 0,
            }),
            position,
            comms: if told.lost != 0 { Comms::Lost } else { Comms::Ok },
            signals: DriveSignals {
                simulated: told.simulated != 0,
                home_switch: told.home_switch != 0,
                limit_switch_positive: told.limit_switch_positive != 0,
                limit_switch_negative: told.limit_switch_negative != 0,
                warning: told.warning != 0,
            },
        };
        self.report = report;
        self.news = News::Fresh;
        Ok(())
    }

    /// The commands for the drive.
    pub fn told(&self, size: u32) -> Command {
        let (position, increments) = match self.command.position {
            DrivePosition::Units(units) => (units, 0),
            DrivePosition::Increments(increments) => (0.0, increments),
        };
        let (least, most) = self.order.torque.map_or((0.0, 0.0), |order| order.velocity);
        Command {
            size,
            request: match self.command.request {
                DriveRequest::Off => 0,
                DriveRequest::Enable => 1,
                DriveRequest::QuickStop => 2,
                DriveRequest::FaultReset => 3,
            },
            position,
            increments,
            velocity: self.command.velocity,
            rename: self.command.rename.unwrap_or_default(),
            torque: self.order.torque.map_or(0.0, |order| order.torque),
            velocity_min: least,
            velocity_max: most,
            outputs: self.order.outputs,
            renamed: self.command.rename.is_some().into(),
            has_torque: self.order.torque.is_some().into(),
            marker: self.order.marker.into(),
            homing: self.order.homing.into(),
            probe_edge: self.order.probes.map(|edge| match edge {
                None => 0,
                Some(Edge::Rising) => 1,
                Some(Edge::Falling) => 2,
            }),
            reserved: [0; 6],
        }
    }
}

impl AnyDrive {
    /// The drive of this setup under an axis of this configuration. `cycle_ns` is the cycle in
    /// nanoseconds.
    pub fn new(setup: &DriveSetup, axis: &AxisConfig, cycle_ns: i64) -> Result<Self, SetupFault> {
        if setup.kind == 0 {
            let position = match &axis.scaling {
                Some(scaling) => DrivePosition::Increments(scaling.to_increments(axis.position)),
                None => DrivePosition::Units(axis.position),
            };
            return Ok(Self::Host(HostDrive::new(position)));
        }
        let setup = setup.simulated(axis, cycle_ns)?;
        let made = SimulatedDrive::new(&setup, axis, cycle_ns);
        made.map(Self::Simulated).map_err(|error| SetupFault {
            key: error.key,
            value: error.value,
        })
    }

    /// The drive, if it is a simulated one.
    pub fn simulated(&mut self) -> Result<&mut SimulatedDrive, Code> {
        match self {
            Self::Host(_) => Err(Code::WrongDrive),
            Self::Simulated(drive) => Ok(drive),
        }
    }
}

impl Drive for HostDrive {
    fn read(&mut self, _now_ns: i64) -> DriveFeedback {
        match core::mem::replace(&mut self.news, News::None) {
            News::None => self.feedback.comms = Comms::Lost,
            News::NoNumber => self.feedback.comms = Comms::Invalid,
            News::Fresh => {}
        }
        self.feedback
    }

    fn write(&mut self, _now_ns: i64, command: &DriveCommand) {
        self.command = *command;
    }

    fn report(&mut self, report: &mut DriveReport) {
        *report = self.report;
    }

    fn order(&mut self, order: &DriveOrder) {
        self.order = *order;
    }
}

impl Drive for AnyDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        match self {
            Self::Host(drive) => drive.read(now_ns),
            Self::Simulated(drive) => drive.read(now_ns),
        }
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        match self {
            Self::Host(drive) => drive.write(now_ns, command),
            Self::Simulated(drive) => drive.write(now_ns, command),
        }
    }

    fn report(&mut self, report: &mut DriveReport) {
        match self {
            Self::Host(drive) => drive.report(report),
            Self::Simulated(drive) => drive.report(report),
        }
    }

    fn order(&mut self, order: &DriveOrder) {
        match self {
            Self::Host(drive) => drive.order(order),
            Self::Simulated(drive) => drive.order(order),
        }
    }
}
