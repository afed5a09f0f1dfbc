//! The border between an axis and whatever moves: two plain values and one trait.
//!
//! Nothing here knows buses. Scaling to user units happens above, in the axis.

/// A position at the drive border.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum DrivePosition {
    /// User units (u), for drives of axes without scaling.
    Units(f64),
    /// Increments, already extended past the drive's own counter range.
    Increments(i64),
}

impl DrivePosition {
    /// Whether it is a number; increments always are.
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
    /// No valid feedback; what is given is old.
    Lost,
    /// Feedback came, and something in it is no number. An axis looks itself, so only a drive that drops such feedback has
    /// to say so.
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

/// What a drive may report beside its position and its power stage; what it does not know stays FALSE.
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

/// What a drive tells, latched once a scan.
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

/// What the axis asks of the power stage.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DriveRequest {
    /// Power stage off; the axis coasts.
    #[default]
    Off,
    /// Operation enabled.
    Enable,
    /// The drive stops by itself, then switches off.
    QuickStop,
    /// Clear a pending fault.
    FaultReset,
}

/// What a drive is told, once a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DriveCommand {
    /// Power stage.
    pub request: DriveRequest,
    /// Position set-point for the end of this scan.
    pub position: DrivePosition,
    /// Velocity feed-forward (u/s).
    pub velocity: f64,
    /// For drives that speak units: from now on the present commanded position, that of the command before, is
    /// called this (u), and every other position moves by as much (MC_Home, MC_SetPosition). Increments never
    /// change their names.
    pub rename: Option<f64>,
}

/// Digital inputs, and outputs, of a drive: numbered from 0 to one less, a bit each (V26).
pub const DIGITAL: u32 = u32::BITS;

/// Touch probes of a drive.
pub const PROBES: usize = 2;

/// What a probe has seen since it was armed.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ProbeReport {
    /// It waits for edges, as ordered.
    pub armed: bool,
    /// The position at the first edge since it was armed, measured between scans; none before.
    pub latched: Option<DrivePosition>,
}

/// What a drive tells of its torque, or force, in the unit it is set up with.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TorqueReport {
    /// Actual torque; positive towards larger positions.
    pub actual: f64,
    /// The largest torque it can hold; 0 if it only measures.
    pub most: f64,
    /// It does not hold the torque it is asked for: it is at a limit of the velocity or of its own.
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

/// What a drive has that a homing may need.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Equipment {
    /// A home switch.
    pub home_switch: bool,
    /// Limit switches at both ends.
    pub limit_switches: bool,
    /// It latches the position of the reference pulse of its encoder.
    pub marker: bool,
    /// It homes by itself when asked to.
    pub homing: bool,
}

/// What a drive that homes by itself is doing.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum DriveHoming {
    /// It follows the command.
    #[default]
    Off,
    /// It moves as it likes, or is about to, or has yet to return to the command.
    Busy,
    /// The same, and its positions have been named anew: from this scan on the reference is here.
    Attained(DrivePosition),
    /// It stands, and the reference is here. It stays so until it is asked no longer.
    Done(DrivePosition),
    /// It gave up, with its own error code, 0 if it has none. It stays so until it is asked no longer.
    Failed(u16),
}

/// What a drive tells beside its motion. What it does not know stays as in the default.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveReport {
    /// Its torque; none if it does not know it.
    pub torque: Option<TorqueReport>,
    /// Its digital inputs, 0 to 31, one bit each.
    pub inputs: u32,
    /// What its digital outputs show, 0 to 31.
    pub outputs: u32,
    /// Its probes.
    pub probes: [ProbeReport; PROBES],
    /// The latch of the reference pulse.
    pub marker: ProbeReport,
    /// Homing by itself.
    pub homing: DriveHoming,
    /// What it has.
    pub equipment: Equipment,
}

impl DriveReport {
    /// Whether every number in it is one; only the largest torque may be infinite.
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

/// What a drive is asked beside its motion.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct DriveOrder {
    /// The torque to hold instead of the position; only of a drive that told it can.
    pub torque: Option<TorqueOrder>,
    /// Its digital outputs.
    pub outputs: u32,
    /// Which edge each probe is to latch; none disarms it. A probe is armed anew by one scan without an edge.
    pub probes: [Option<Edge>; PROBES],
    /// It is to latch the next reference pulse.
    pub marker: bool,
    /// It is to home by itself, or to go on doing so. Falling before it is done it stops.
    pub homing: bool,
}

/// A drive. `read` then `write`, each exactly once a scan; then `report` right after the one and `order` right
/// before the other, for what a drive has beside its motion.
pub trait Drive {
    /// This scan's feedback.
    fn read(&mut self, now_ns: i64) -> DriveFeedback;

    /// This scan's command.
    fn write(&mut self, now_ns: i64, command: &DriveCommand);

    /// Fills in what the drive has to tell in this scan; a drive that has nothing leaves it alone.
    fn report(&mut self, _report: &mut DriveReport) {}

    /// What the drive is asked in this scan; a drive that knows none of it leaves it alone.
    fn order(&mut self, _order: &DriveOrder) {}
}
