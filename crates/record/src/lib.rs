//! What a machine did, scan by scan: a recorder of fixed size, and its rows as a trace.
//!
//! What stands here: a ring of the last scans that freezes around a trigger ([`Ring`]), with the feature `alloc` a
//! recorder that keeps them on the heap (`Recorder`), its text as a trace for hosts without one ([`text`]), and with
//! the feature `std` the words for axes, pins, values and records that every trace uses (`told`). What does not: no
//! block and no executor is known; who runs the machine says in every scan what there is to see.
//!
//! The recorder takes memory once, when it is made. In a scan it copies numbers: no heap, no text, work proportional to
//! the number of signals.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(feature = "alloc")]
extern crate alloc;
#[cfg(any(feature = "std", test))]
extern crate std;

#[cfg(feature = "alloc")]
mod recorder;
mod ring;
pub mod text;
#[cfg(feature = "std")]
pub mod told;

#[cfg(feature = "alloc")]
pub use recorder::{Pins, Recorder, Signals};
pub use ring::{AXIS_WORDS, Ring, Setup, State, Trigger, moved, write_axis};
