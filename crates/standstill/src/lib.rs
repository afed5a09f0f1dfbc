//! standstill: a PLCopen motion runtime to embed in a soft-PLC.
//!
//! It brings the layers a host needs under one name: [`planner`] is motion maths, [`axis`] the state
//! machine with commands and drives, [`fb`] the common part of blocks, [`blocks`] the function blocks and
//! their registry, [`scan`] tasks and the order of a scan, [`record`] the flight recorder. [`runtime`] is
//! above them and puts axes, drives, blocks and programs together. A host that wants to do this itself
//! uses the layers, as here:
//!
//! ```
//! use standstill::prelude::*;
//!
//! /// The host's program: what an IEC PROGRAM would be.
//! #[derive(Default)]
//! struct Program {
//!     to_ten: Instance<McMoveAbsolute>,
//! }
//!
//! impl Programs<Standard, IdealDrive> for Program {
//!     fn run(&mut self, _: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
//!         self.to_ten.inputs.execute = true;
//!         self.to_ten.call(context);
//!         Ok(0)
//!     }
//! }
//!
//! let limits = Limits { velocity: 50.0, acceleration: 200.0, deceleration: 200.0, jerk: 2e3, snap: 4e4 };
//! let config = AxisConfig { start: StartState::Standstill, ..AxisConfig::new(limits) };
//! let drive = IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true);
//! let mut machine = Machine::new();
//! let axis = machine.add_axis(config, Standard::new(0.001), drive)?;
//!
//! let mut program = Program::default();
//! program.to_ten.inputs.axis = axis;
//! program.to_ten.inputs.position = 10.0;
//! program.to_ten.inputs.velocity = 50.0;
//!
//! let mut executor = Executor::new(1_000_000, &[], &[ProgramConfig::free("main")])?;
//! let mut now_ns = 0;
//! while !program.to_ten.outputs.done {
//!     let report = executor.scan(now_ns, &mut program, &mut machine)?;
//!     assert!(report.mode.fault().is_none() && now_ns < 2_000_000_000);
//!     now_ns += 1_000_000;
//! }
//! assert_eq!(machine.axes()[axis.index()].setpoint().position, 10.0);
//! # Ok::<(), Box<dyn std::error::Error>>(())
//! ```
//!
//! The examples of this crate are whole hosts: `single_axis` has forty lines, `own_drive` has blocks and
//! a drive of its own, `recording` has a flight recorder.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

pub mod runtime;

pub use standstill_axis as axis;
pub use standstill_blocks as blocks;
pub use standstill_fb as fb;
pub use standstill_planner as planner;
pub use standstill_record as record;
pub use standstill_scan as scan;

/// The names that nearly every host uses.
pub mod prelude {
    pub use crate::runtime::{BlockId, Blocks, BuildError, Builder, Program, Ready, Running};
    pub use standstill_axis::{
        Axis, AxisConfig, AxisId, AxisState, BufferMode, Direction, Drive, DriveCommand, DriveFeedback,
        DrivePosition, DriveRequest, ErrorId, IdealDrive, InstanceId, Limits, Log, Planner, Raw, Scope,
        Setpoint, Standard, StartState, steps,
    };
    pub use standstill_blocks::administrative::{
        mc_power::McPower, mc_read_actual_position::McReadActualPosition,
        mc_read_axis_error::McReadAxisError, mc_read_status::McReadStatus, mc_reset::McReset,
    };
    pub use standstill_blocks::homing::mc_home::McHome;
    pub use standstill_blocks::single_axis::{
        mc_halt::McHalt, mc_move_absolute::McMoveAbsolute, mc_move_additive::McMoveAdditive,
        mc_move_continuous_absolute::McMoveContinuousAbsolute,
        mc_move_continuous_relative::McMoveContinuousRelative, mc_move_relative::McMoveRelative,
        mc_move_velocity::McMoveVelocity, mc_stop::McStop,
    };
    pub use standstill_blocks::{BlockInstance, REGISTRY};
    pub use standstill_fb::{AnyInstance, Block, Context, Instance, Value};
    pub use standstill_record::{Pins, Recorder, Setup, Trigger};
    pub use standstill_scan::{
        Executor, Machine, ProgramConfig, ProgramFault, ProgramId, Programs, ScanTime, Start, TaskConfig,
        TaskId,
    };
}

// The examples of the README and of the guide are tests of this crate.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/embedding-rust.md")]
mod guide {}

#[cfg(doctest)]
#[doc = include_str!("../../../README.md")]
mod readme {}

// So are the examples of the guide for hosts.
#[cfg(doctest)]
#[doc = include_str!("../../../docs/how-to/embed.md")]
mod embed {}
