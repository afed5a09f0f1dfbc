//! A motor with a mechanism behind it, and the loops that hold it: what a real axis adds to its set-points.

mod drive;
mod matrix;
mod plant;
mod servo;

pub use drive::PlantDrive;
pub use plant::{Load, Mechanism, MechanismError, Plant, Stops};
pub use servo::{Gains, Servo, SetPoint};

/// Steps of the loops and the mechanism in one scan.
pub const SUBSTEPS: u32 = 4;
