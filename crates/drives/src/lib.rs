//! Drives behind an axis: CiA 402 from the controller's side, and simulated drives that behave like real
//! ones.
//!
//! The crate decodes status words and chooses control words. Its adapter makes a
//! [`Drive`](standstill_axis::Drive) of any CiA 402 node, and its simulated node has all states and
//! transitions. It has no bus, no manufacturer's object dictionary and no axis. Nothing allocates.
//!
//! Source: CiA 402 (IEC 61800-7-201), sections on the power drive system's state machine and its modes.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod cia402;
pub mod keys;
pub mod mechanism;
pub mod peripherals;
pub mod simulated;
pub mod switches;
mod wire;

/// The whole number nearest to `value`, half away from zero.
fn nearest(value: f64) -> i64 {
    (if value < 0.0 { value - 0.5 } else { value + 0.5 }) as i64
}
