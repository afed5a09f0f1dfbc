//! Blocks that find or set the reference.

pub mod mc_home;
