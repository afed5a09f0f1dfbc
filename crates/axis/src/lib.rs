//! One PLCopen axis: its states, its commands, its errors, and the drive under it.
//!
//! An axis has a state machine with its arrows as data, one active command and a bounded buffer. It
//! reacts to power and faults, and its motion step turns a plan into a set-point. It knows no function
//! block (they meet through a [`CommandId`]), no script and no clock. Nothing allocates; every loop has a
//! constant bound.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod axis;
mod cam_store;
mod command;
mod config;
mod couple;
mod drive;
mod error_id;
mod fate;
mod homing;
mod ideal_drive;
pub mod keys;
mod log;
mod parameter;
mod scaling;
mod scope;
mod state;
pub mod steps;

pub use axis::{
    Axis, Beside, CamFit, CamLaid, CamTrack, Coupled, Factors, Going, MotionState, Outlook, Pace, Permission,
    Profile, ProfileRow, TouchProbe, Way, WorkKind,
};
pub use cam_store::{
    CAM_PIECES, CAM_ROWS_PER_CALL, CAM_SLOTS, CamCurve, CamId, CamSelection, CamSlot, Cams, NoRoom, StartMode,
};
pub use command::{
    AxisId, BufferMode, CamIn, CombineMode, Command, CommandId, Direction, Dynamics, ExecutionMode, Followed,
    IecEnum, InstanceId, Master, PhaseShift, QUEUE_MAX, Raw, Request, Superimpose, SyncMode, SyncPoint,
    Trigger, ValueSource,
};
pub use config::{
    ACTUAL_FILTER_MAX, AboveLimit, AxisConfig, CAM_CONTINUITY_MAX, ConfigError, Defaults, EdgeWhileBusy,
    Following, InPosition, JogAtLimit, MODULO_MAX, ModuloTargets, OnLimit, OnMasterLost, PowerOff,
    StartState, StopLimits,
};
pub use couple::{couple, update_coupled};
pub use drive::{
    Comms, DIGITAL, Drive, DriveCommand, DriveFeedback, DriveHoming, DriveOrder, DrivePosition, DriveReport,
    DriveRequest, DriveSignals, Edge, Equipment, Fault, PROBES, ProbeReport, TorqueOrder, TorqueReport,
};
pub use error_id::{ErrorClass, ErrorId, RETIRED};
pub use fate::{FATES_KEPT, Fate};
pub use homing::{BlockDetection, HomeDirection, Homing, Procedure, SwitchEdge};
pub use ideal_drive::{DELAY_MAX, IdealDrive, Powered};
pub use log::{Approach, Event, Goal, LOG_KEPT, Log, Record};
pub use parameter::{Parameter, ParameterValue};
pub use scaling::{Scaling, Turn};
pub use scope::Scope;
pub use standstill_planner::cam::CAM_ROWS;
pub use standstill_planner::turns::split;
pub use standstill_planner::{
    Anchor, Cam, CamBounds, CamCause, CamFault, CamHead, CamLaw, CamPiece, CamRow, Excess, Gear, Limits,
    MoveProfile, Order, PROFILE_POINTS, Passage, Place, Plan, PlanError, Planner, ProfileFault, ProfileKind,
    ProfilePoint, Setpoint, ShaperKind, Standard, StandardPlan, VibrationMode,
};
pub use state::{ARROWS, Arrow, AxisEvent, AxisState, Refused, next};
