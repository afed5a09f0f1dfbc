//! The common part of the measurements: the yardstick, the random moves and the axis under test.
//!
//! The measurements themselves are `benches/ratios.rs` (time, relative to the yardstick in the same run),
//! `examples/instructions.rs` (instructions, under valgrind), `examples/worst_plan.rs` (search steps),
//! `panic-probe` (reachable panics), `same-bits` (other processors) and `tests/` (heap use, long runs).
//! Commands and figures are in `docs/performance.md`.
#![forbid(unsafe_code)]

mod many_axes;
mod one_axis;
mod random;
mod trapezoid;

pub use many_axes::{AXES, IN_MOTION, ManyAxes, WAYS};
pub use one_axis::{CYCLE, Executed, LIMITS, OneAxis, Program, TARGET, feedback};
pub use random::{Move, Replan, any_unit, ordinary, servo};
pub use standstill_testkit::Random;
pub use trapezoid::{Sample, Trapezoid, trapezoid};
