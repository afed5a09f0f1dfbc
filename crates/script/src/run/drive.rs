//! The drive of a script's axis: a simulated one, whose position a host may override.

use standstill_axis::{
    AxisConfig, Drive, DriveCommand, DriveFeedback, DriveOrder, DrivePosition, DriveReport, DriveRequest,
    Scaling,
};
use standstill_drives::mechanism::MechanismError;
use standstill_drives::simulated::{DriveSetup, SimulatedDrive};

/// The order of an axis to its drive, in the drive's own coordinates: MC_Home and MC_SetPosition do not
/// move them.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Ordered {
    /// The request to the power stage.
    pub request: DriveRequest,
    /// The set-point for the end of the scan (u); on a modulo axis it is not reduced to one turn.
    pub position: f64,
    /// Its velocity (u/s).
    pub velocity: f64,
}

/// The drive of a script.
#[derive(Clone, Debug)]
pub(crate) struct ScriptDrive {
    pub(crate) simulated: SimulatedDrive,
    scaling: Option<Scaling>,
    /// The position that a host gives (u), in the drive's own coordinates.
    told: Option<f64>,
    request: DriveRequest,
    /// The last command, in units as the axis names them or in increments.
    commanded: DrivePosition,
    velocity: f64,
    /// The offset of positions from those at the start (u); increments are never renamed.
    renamed: f64,
}

impl ScriptDrive {
    pub(crate) fn new(setup: &DriveSetup, axis: &AxisConfig, cycle_ns: i64) -> Result<Self, MechanismError> {
        let commanded = match axis.scaling {
            Some(scaling) => DrivePosition::Increments(scaling.to_increments(axis.position)),
            None => DrivePosition::Units(axis.position),
        };
        Ok(Self {
            simulated: SimulatedDrive::new(setup, axis, cycle_ns)?,
            scaling: axis.scaling,
            told: None,
            request: DriveRequest::Off,
            commanded,
            velocity: 0.0,
            renamed: 0.0,
        })
    }

    /// From the next scan on the drive has this position (u), independent of the simulation.
    pub(crate) fn lead(&mut self, position: f64) {
        self.told = Some(position);
    }

    /// The number of scans after which it depends on no earlier command, if it is ideal and no host leads it.
    pub(crate) fn delay(&self) -> Option<usize> {
        self.simulated.delay().filter(|_| self.told.is_none())
    }

    /// Its last order; before the first scan its start.
    pub(crate) fn ordered(&self) -> Ordered {
        let position = match (self.commanded, self.scaling) {
            (DrivePosition::Units(position), _) => position - self.renamed,
            (DrivePosition::Increments(increments), Some(scaling)) => scaling.to_units(increments),
            // A drive counts increments under an axis with a scaling; otherwise one increment is one
            // unit.
            (DrivePosition::Increments(increments), None) => increments as f64,
        };
        Ordered {
            request: self.request,
            position,
            velocity: self.velocity,
        }
    }
}

impl Drive for ScriptDrive {
    fn read(&mut self, now_ns: i64) -> DriveFeedback {
        let mut feedback = self.simulated.read(now_ns);
        if let Some(position) = self.told {
            feedback.position = match (feedback.position, self.scaling) {
                (DrivePosition::Units(_), _) => DrivePosition::Units(position + self.renamed),
                (DrivePosition::Increments(_), Some(scaling)) => {
                    DrivePosition::Increments(scaling.to_increments(position))
                }
                // Saturates; see above.
                (DrivePosition::Increments(_), None) => DrivePosition::Increments(position as i64),
            };
        }
        feedback
    }

    fn write(&mut self, now_ns: i64, command: &DriveCommand) {
        if let (Some(name), DrivePosition::Units(before)) = (command.rename, self.commanded) {
            self.renamed += name - before;
        }
        (self.request, self.commanded, self.velocity) = (command.request, command.position, command.velocity);
        self.simulated.write(now_ns, command);
    }

    fn report(&mut self, report: &mut DriveReport) {
        self.simulated.report(report);
    }

    fn order(&mut self, order: &DriveOrder) {
        self.simulated.order(order);
    }
}
