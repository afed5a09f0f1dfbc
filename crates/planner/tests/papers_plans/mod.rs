//! The papers' systems, against what they publish and from outside.

mod docs;
mod generator;
mod published;
mod s_curve;
mod short_path;
mod support;
mod timed;
mod tracking;
