//! The function blocks: one file each, and the registry that lists them.
//!
//! A block says which pins it has and which command it gives. Edges and results belong to
//! `standstill-fb`, motion to `standstill-axis`. This crate has no names of scripts, no text and no heap.
//!
//! A new block is one file in the folder of its group, its `pub mod` line in the `mod.rs` there, and one line in
//! [`registry`]. `docs/contributing.md` names the other places that a new block touches; each has a test.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

pub mod administrative;
pub mod homing;
pub mod multi_axis;
pub mod registry;
pub mod single_axis;
pub mod standard;

pub use registry::{BlockInstance, REGISTRY};
