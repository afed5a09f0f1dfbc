//! The tests of this crate, in one program: linking one costs more than running most of them.

mod guests;
mod hostile;
mod memory;
mod ring;
