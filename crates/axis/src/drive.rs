//! The border between an axis and its drive: two plain values and one trait.
//!
//! This module knows no buses. The axis converts to user units.

/// A position at the drive border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrivePosition {
    /// User units (u), for drives of axes without scaling.
    Units(f64),
    /// Increments, extended beyond the range of the drive's own counter.
    Increments(i64),
}

impl DrivePosition {
    /// Whether it is finite; increments always are.
    #[inline]
    pub const fn is_finite(&self) -> bool {
        match self {
            Self::Units(units) => units.is_finite(),
            Self::Increments(_) => true,
        }
    }
}

/// State of the communication with the drive.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Comms {
    /// This scan's feedback is fresh.
    #[default]
    Ok,
    /// No valid feedback; the values are old.
    Lost,
    /// Feedback arrived, and a value in it is not a number. The axis checks this itself, so only a drive
    /// that drops such feedback has to report it.
    Invalid,
}

/// A fault a drive reports.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Fault {
    /// The drive's own error code.
    pub code: u16,
    /// The drive knows that the cause is still there, so that a reset would fail.
    pub cause_present: bool,
}

/// Signals that a drive may report beside its position and its power stage; unknown ones stay FALSE.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct DriveSignals {
    /// The drive is simulated.
    pub simulated: bool,
    /// The home switch is active.
    pub home_switch: bool,
    /// The hardware end switch in positive direction, as the drive counts, is active.
    pub limit_switch_positive: bool,
    /// The one in negative direction is active.
    pub limit_switch_negative: bool,
    /// A warning is present.
    pub warning: bool,
}

/// The feedback of a drive, latched once a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveFeedback {
    /// Operation is enabled: the power stage is on and follows the command (MC_Power.Status).
    pub enabled: bool,
    /// Power for the stage is available.
    pub voltage: bool,
    /// A pending fault; the drive keeps it until it is reset.
    pub fault: Option<Fault>,
    /// Actual position.
    pub position: DrivePosition,
    /// State of the communication.
    pub comms: Comms,
    /// Switches, warnings, and whether it is simulated.
    pub signals: DriveSignals,
}

/// The request of the axis to the power stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveRequest {
    /// Power stage off; the axis coasts.
    #[default]
    Off,
    /// Operation enabled.
    Enable,
    /// The drive stops by itself, then switches off. It is requested until the axis is at rest.
    QuickStop,
    /// Clear a pending fault.
    FaultReset,
}

/// The command for a drive, once a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveCommand {
    /// Power stage.
    pub request: DriveRequest,
    /// Position set-point for the end of this scan.
    pub position: DrivePosition,
    /// Velocity feed-forward (u/s).
    pub velocity: f64,
    /// For drives that use units: the new value (u) of the position in the command before (MC_Home,
    /// MC_SetPosition). Every other position shifts by the same amount. Increments are never shifted.
    pub rename: Option<f64>,
}

/// Number of digital inputs of a drive, and of its outputs (V26). They are numbered from 0, one bit each.
pub const DIGITAL: u32 = u32::BITS;

/// Touch probes of a drive.
pub const PROBES: usize = 2;

/// The events of a probe since it was armed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeReport {
    /// It waits for edges, as ordered.
    pub armed: bool,
    /// The position at the first edge since it was armed, measured between scans; none before.
    pub latched: Option<DrivePosition>,
}

/// The torque, or force, that a drive reports, in its configured unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueReport {
    /// Actual torque; positive towards larger positions.
    pub actual: f64,
    /// The largest torque it can hold; 0 if it only measures.
    pub most: f64,
    /// It does not reach the commanded torque: it is at a limit of the velocity, or at its own limit.
    pub limited: bool,
}

/// A torque to hold instead of following positions.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueOrder {
    /// In the drive's unit.
    pub torque: f64,
    /// The least and the largest velocity (u/s) at which it is held.
    pub velocity: (f64, f64),
}

/// The equipment of a drive that a homing may need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Equipment {
    /// A home switch.
    pub home_switch: bool,
    /// Limit switches at both ends.
    pub limit_switches: bool,
    /// It latches the position of the reference pulse of its encoder.
    pub marker: bool,
    /// It homes by itself on request.
    pub homing: bool,
}

/// The state of a drive that homes by itself.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DriveHoming {
    /// It follows the command.
    #[default]
    Off,
    /// It moves by itself, is about to, or has not returned to the command yet.
    Busy,
    /// Like `Busy`, but its positions have shifted: from this scan on the reference is here.
    Attained(DrivePosition),
    /// It is at rest, and the reference is here. It stays in this state until homing is no longer
    /// requested.
    Done(DrivePosition),
    /// It failed, with its own error code, 0 if it has none. It stays in this state until homing is no
    /// longer requested.
    Failed(u16),
}

/// The report of a drive beside its motion. Unknown values keep their default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveReport {
    /// Its torque; none if it is unknown.
    pub torque: Option<TorqueReport>,
    /// Its digital inputs, 0 to 31, one bit each.
    pub inputs: u32,
    /// The levels of its digital outputs, 0 to 31.
    pub outputs: u32,
    /// Its probes.
    pub probes: [ProbeReport; PROBES],
    /// The latch of the reference pulse.
    pub marker: ProbeReport,
    /// Homing by itself.
    pub homing: DriveHoming,
    /// The equipment of the drive.
    pub equipment: Equipment,
}

impl DriveReport {
    /// Whether all its numbers are finite; only the largest torque may be infinite.
    #[inline]
    pub fn is_finite(&self) -> bool {
        let reference = match self.homing {
            DriveHoming::Attained(reference) | DriveHoming::Done(reference) => Some(reference),
            DriveHoming::Off | DriveHoming::Busy | DriveHoming::Failed(_) => None,
        };
        let [first, second] = self.probes.map(|probe| probe.latched);
        let places = [first, second, self.marker.latched, reference];
        let torque = self.torque.as_ref();
        places.iter().flatten().all(DrivePosition::is_finite)
            && torque.is_none_or(|torque| torque.actual.is_finite() && !torque.most.is_nan())
    }
}

/// The edge of a probe's input.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Edge {
    /// From FALSE to TRUE.
    Rising,
    /// From TRUE to FALSE.
    Falling,
}

/// The orders for a drive beside its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveOrder {
    /// The torque to hold instead of the position; only for a drive that reported that it can.
    pub torque: Option<TorqueOrder>,
    /// Its digital outputs.
    pub outputs: u32,
    /// The edge each probe is to latch; none disarms it. One scan without an edge arms a probe anew.
    pub probes: [Option<Edge>; PROBES],
    /// Whether to latch the next reference pulse.
    pub marker: bool,
    /// Whether to home by itself, or to continue to. If it falls before the homing is done, the homing
    /// stops.
    pub homing: bool,
}

/// A drive. `read` and then `write`, each exactly once a scan. `report` comes right after `read`, and
/// `order` right before `write`; they carry the values beside its motion.
pub trait Drive {
    /// This scan's feedback.
    fn read(&mut self, now_ns: i64) -> DriveFeedback;

    /// This scan's command.
    fn write(&mut self, now_ns: i64, command: &DriveCommand);

    /// Fills in the report of this scan; a drive without one does nothing.
    fn report(&mut self, _report: &mut DriveReport) {}

    /// Takes the orders of this scan; a drive that supports none does nothing.
    fn order(&mut self, _order: &DriveOrder) {}
}
