//! What a machine did, scan by scan: a recorder of fixed size, and its rows as a trace.
//!
//! What stands here: a ring of the last scans that freezes around a trigger ([`Recorder`]), and with the feature `std`
//! the words for axes, pins, values and records that every trace uses ([`told`]). What does not: no block and no
//! executor is known; who runs the machine says in every scan what there is to see.
//!
//! The recorder takes memory once, when it is made. In a scan it copies numbers: no heap, no text, work proportional to
//! the number of signals.
#![no_std]
#![forbid(unsafe_code)]

extern crate alloc;
#[cfg(feature = "std")]
extern crate std;

mod recorder;
#[cfg(feature = "std")]
pub mod told;
mod word;

pub use recorder::{Pins, Recorder, Setup, Signals, State, Trigger};
