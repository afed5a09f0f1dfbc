//! The papers' systems, against what they publish and from outside.

mod published;
mod s_curve;
mod support;
mod timed;
