//! The tests of this crate, in one program: linking one costs more than running most of them.

mod cia402_axis;
mod cia402_modes;
mod cia402_node;
mod every_motion;
mod homing;
mod mechanism;
mod probes;
