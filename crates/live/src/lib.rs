//! A scan script as a cyclic task of Linux: one scan a period of the wall clock.
//!
//! What stands here: the pacing (`pace`), its measurement (`Timing`), and what Linux permits a task to ask
//! for (`System`). What does not: the run itself, which is a `Session`, and reading scripts.
#![forbid(unsafe_code)]

mod pace;
#[cfg(target_os = "linux")]
mod system;
mod timing;

pub use pace::{Clock, Ended, OnOverrun, RAMP_NS_MAX, Stopped, pace};
#[cfg(target_os = "linux")]
pub use system::{Memory, Scheduling, System};
pub use timing::{Histogram, OVERRUNS_KEPT, Overrun, Timing};
