//! The tests of this crate, in one program but for the search through all states.

mod bad_input;
mod bench;
mod cam_switch;
mod instances;
mod standard_golden;
