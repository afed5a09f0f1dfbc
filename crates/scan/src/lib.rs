//! The deterministic cyclic executor: tasks, the order of one scan, axes and their drives.
//!
//! What stands here: which program runs in which scan ([`Executor`]), and the steps of a scan on axes and
//! drives ([`Machine`]). The order of a scan is behaviour and stands in one place, [`Executor::scan`].
//! What does not: no function block (a host brings its own through [`Programs`]), no script, no text. Time
//! is an argument; nothing reads a clock. The heap is used while setting up and never in a scan.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;

mod config;
mod executor;
mod fault;
mod machine;
mod programs;
mod task;

pub use config::{ConfigError, ProgramConfig, TaskConfig, Watchdog, common_tick_ns};
pub use executor::{Executor, Mode, ScanReport, TimeRanBackwards};
pub use fault::{Fault, FaultText};
pub use machine::{Machine, MachineError, RUNTIME};
pub use programs::{NotOff, ProgramFault, ProgramId, Programs, ScanTime, Start, TaskId};
pub use task::TaskCounts;
