//! The deterministic cyclic executor: tasks, the order of one scan, axes and their drives.
//!
//! It has two parts: [`Executor`] decides which program runs in which scan, and [`Machine`] has the steps
//! of a scan on axes and drives. The order of a scan is behaviour, so one function holds it:
//! [`Executor::scan`]. The crate has no function block (a host brings its own through [`Programs`]), no
//! script and no text. Time is an argument; nothing reads a clock. The heap is used at set-up and never
//! in a scan.
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
