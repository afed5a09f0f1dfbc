//! The papers' systems, against their published results and from outside.

mod docs;
mod generator;
mod published;
mod s_curve;
mod short_path;
pub mod support;
mod timed;
mod tracking;
