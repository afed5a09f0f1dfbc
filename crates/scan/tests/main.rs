//! The tests of this crate, in one program: linking one costs more than running most of them.

mod coast;
mod common;
mod long_gear;
mod scan_order;
mod stopping;
mod tasks;
