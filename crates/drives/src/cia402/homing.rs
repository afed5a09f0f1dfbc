//! Homing by the drive, mode 6: the controller's side, and the behaviour of a simulated node.

use super::node::{Inputs, MODE_CSP, MODE_HM};
use super::words::{Command, HomingStatus, State, Statusword};
use standstill_axis::{DriveHoming, DrivePosition};

/// The controller's side. It asks for mode 6, sets bit 4 once the mode is acknowledged (CI-7), and judges
/// the status from then on. Once the drive is at rest it returns to mode 8.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Link {
    /// The axis requests homing by the drive.
    wanted: bool,
    /// Mode 6 has been asked for, and mode 8 is not in force again yet.
    leads: bool,
    /// Bit 4 has been sent.
    started: bool,
    /// Bit 12 has been seen FALSE. From now on it belongs to this homing.
    fresh: bool,
    told: DriveHoming,
}

impl Link {
    /// Takes the request of the axis.
    pub fn order(&mut self, wanted: bool) {
        if wanted && !self.wanted {
            self.leads = true;
            (self.started, self.fresh) = (false, false);
            self.told = DriveHoming::Busy;
        }
        self.wanted = wanted;
    }

    /// Takes the inputs. `reference` is the drive's position of the reference once it is known.
    pub fn take(&mut self, inputs: &Inputs, reference: DrivePosition) {
        if !self.leads {
            return;
        }
        if !self.wanted {
            self.leads = inputs.mode != MODE_CSP;
            self.told = if self.leads {
                DriveHoming::Busy
            } else {
                DriveHoming::Off
            };
            return;
        }
        if matches!(self.told, DriveHoming::Done(_) | DriveHoming::Failed(_)) || !is_in_mode(inputs) {
            return;
        }
        let status = Statusword(inputs.statusword).homing();
        self.fresh |= !matches!(status, HomingStatus::Attained | HomingStatus::Done);
        if self.started && self.fresh {
            self.told = match status {
                HomingStatus::InProgress | HomingStatus::Stopped => DriveHoming::Busy,
                HomingStatus::Attained => DriveHoming::Attained(reference),
                HomingStatus::Done => DriveHoming::Done(reference),
                HomingStatus::ErrorMoving | HomingStatus::ErrorStopped => {
                    DriveHoming::Failed(inputs.error_code)
                }
            };
        }
    }

    /// Mode and additional bits of the control word, from the last inputs and from `enable`: operation is
    /// requested.
    pub fn give(&mut self, inputs: &Inputs, enable: bool) -> (i8, u16) {
        if !self.leads {
            return (MODE_CSP, 0);
        }
        let in_mode = is_in_mode(inputs) && enable;
        if self.wanted {
            self.started |= in_mode;
            return (MODE_HM, if in_mode { Command::HOMING } else { 0 });
        }
        if in_mode && !Statusword(inputs.statusword).homing().is_at_rest() {
            (MODE_HM, Command::HALT)
        } else {
            (MODE_CSP, 0)
        }
    }

    /// Whether the drive may be in a mode other than 8 because of this request.
    pub fn leads(&self) -> bool {
        self.leads
    }

    /// The report for the axis.
    pub fn told(&self) -> DriveHoming {
        self.told
    }
}

fn is_in_mode(inputs: &Inputs) -> bool {
    inputs.mode == MODE_HM && Statusword(inputs.statusword).state() == State::OperationEnabled
}

/// 603Fh of a simulated node whose homing met a limit switch: the profile's "reference limit".
pub(super) const REFERENCE_LIMIT: u16 = 0x8612;

/// Homing of a simulated node in mode 6. It moves to the home switch, sets the position to 0 where the switch
/// becomes active, and comes to rest. An active limit switch on the path is an error.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct NodeHoming {
    /// Towards larger positions.
    pub up: bool,
    /// Velocity (increments/scan), above 0.
    pub velocity: f64,
}

/// The node's side.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub(super) enum Progress {
    /// Not started, or interrupted.
    #[default]
    Idle,
    /// On the way to the switch.
    Searching,
    /// The switch has been found.
    Attained,
    /// It was not found.
    Failed,
}

impl Progress {
    pub fn status(self, is_at_rest: bool) -> HomingStatus {
        match (self, is_at_rest) {
            (Self::Searching, _) | (Self::Idle, false) => HomingStatus::InProgress,
            (Self::Idle, true) => HomingStatus::Stopped,
            (Self::Attained, false) => HomingStatus::Attained,
            (Self::Attained, true) => HomingStatus::Done,
            (Self::Failed, false) => HomingStatus::ErrorMoving,
            (Self::Failed, true) => HomingStatus::ErrorStopped,
        }
    }
}
