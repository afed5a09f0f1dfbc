//! The tests of this crate, in one program: linking one costs more than running most of them.

mod common;
mod compare;
mod events;
mod exact;
mod file;
mod files;
mod golden_files;
mod golden_text;
mod ring_down;
mod subjects;
mod vcd;
mod version_1;
