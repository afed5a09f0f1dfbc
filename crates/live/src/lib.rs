//! A scan script as a cyclic task of Linux: one scan in each period of the wall clock.
//!
//! The crate paces scans (`pace`), measures the pacing (`Timing`) and requests real-time services from Linux
//! (`System`). The run itself is a `Session` of `standstill-script`, which also reads scripts.
#![forbid(unsafe_code)]

mod pace;
#[cfg(target_os = "linux")]
mod system;
mod timing;

pub use pace::{Clock, Ended, OnOverrun, RAMP_NS_MAX, Stopped, pace};
#[cfg(target_os = "linux")]
pub use system::{Memory, Scheduling, System};
pub use timing::{Histogram, OVERRUNS_KEPT, Overrun, Timing};
