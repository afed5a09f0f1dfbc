//! Drives behind an axis: CiA 402 as controllers see it, and simulated ones that behave like the real thing.
//!
//! What stands here: the decoding of status words, the sequencer of control words, the adapter that makes a
//! [`Drive`](standstill_axis::Drive) of any CiA 402 node, and a simulated node with all states and transitions.
//! What does not: buses, object dictionaries of makers, the axis. Nothing allocates.
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
