//! The axis.

use crate::{AxisConfig, AxisId, AxisState, ConfigError, InstanceId};
use standstill_planner::{Planner, Standard};

/// Who gives a command and when; goes into the records.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Source {
    /// The scan.
    pub scan: u64,
    /// The block instance.
    pub instance: InstanceId,
}

/// One axis.
#[derive(Clone, Debug)]
pub struct Axis<P: Planner = Standard> {
    id: AxisId,
    config: AxisConfig,
    planner: P,
    state: AxisState,
}

impl<P: Planner> Axis<P> {
    /// An axis.
    ///
    /// # Errors
    /// [`ConfigError`]
    pub fn new(id: AxisId, config: AxisConfig, planner: P) -> Result<Self, ConfigError> {
        config.check()?;
        Ok(Self {
            id,
            config,
            planner,
            state: AxisState::Disabled,
        })
    }
}

impl<P: Planner> Axis<P> {
    /// What became of command `id`.
    pub fn fate(&self, _id: crate::CommandId) -> crate::Fate {
        crate::Fate::Done
    }
}

use crate::*;
impl<P: Planner> Axis<P> {
    /// S.
    pub fn command(&mut self, _r: &Request, _s: Source, _l: &mut Log) -> Result<CommandId, ErrorId> {
        Err(ErrorId::None)
    }
    /// S.
    pub fn release_stop(&mut self, _id: CommandId) {}
    /// S.
    pub fn set_power(&mut self, _on: bool, _s: Source, _l: &mut Log) {}
    /// S.
    pub fn is_powered(&self) -> bool {
        false
    }
    /// S.
    pub fn reset(&mut self, _s: Source, _l: &mut Log) -> Result<CommandId, ErrorId> {
        Err(ErrorId::None)
    }
    /// S.
    pub fn actual_position(&self) -> f64 {
        0.0
    }
    /// S.
    pub fn error_id(&self) -> ErrorId {
        ErrorId::None
    }
    /// S.
    pub fn state(&self) -> AxisState {
        self.state
    }
    /// S.
    pub fn setpoint(&self) -> Setpoint {
        Setpoint::at_rest(0.0)
    }
    /// S.
    pub fn follow_feedback(&mut self, _f: &DriveFeedback, _scan: u64, _l: &mut Log) {}
    /// S.
    pub fn advance(&mut self, _scan: u64, _l: &mut Log) {}
    /// S.
    pub fn drive_command(&mut self) -> DriveCommand {
        DriveCommand {
            request: DriveRequest::Off,
            position: DrivePosition::Units(0.0),
            velocity: 0.0,
            rename: None,
        }
    }
    /// S.
    pub fn raise(&mut self, _e: ErrorId, _code: u16, _s: Source, _l: &mut Log) {}
    /// S.
    pub fn clear_cause(&mut self) {}
}
