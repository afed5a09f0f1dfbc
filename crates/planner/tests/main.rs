//! The tests of this crate, in one program: linking one costs more than running most of them.

mod cam;
mod endless_gear;
mod endless_turns;
mod grid_decimals;
mod grid_exhaustive;
mod grid_invariants;
mod grid_refusals;
mod grid_soak;
mod grid_support;
mod grid_vectors;
mod no_limit;
mod online_plans;
mod papers_plans;
mod profile;
mod ramp_kernel;
mod ramp_plans;
mod shaped_plans;
mod unequal_exhaustive;
mod unequal_invariants;
mod unequal_soak;
mod units;
