//! What a machine did, scan by scan: a recorder of fixed size, and its rows as a trace.
//!
//! A ring of the last scans freezes around a trigger ([`Ring`]). With the feature `alloc` a recorder keeps them on
//! the heap (`Recorder`). Hosts without a heap write its text as a trace ([`text`]). The feature `std` adds the
//! words for axes, pins, values and records that every trace uses (`told`). The crate knows no block and no
//! executor: the host passes the values in every scan.
//!
//! The recorder allocates memory once, when it is made. In a scan it copies numbers: no heap, no text,
//! work proportional to the number of signals.
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
