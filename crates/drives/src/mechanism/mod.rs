//! A motor with a mechanism, and its control loops: the part of a real axis that follows the set-points.

mod drive;
mod matrix;
mod plant;
mod servo;

pub use drive::PlantDrive;
pub use plant::{Load, Mechanism, MechanismError, Plant, Stops};
pub use servo::{Gains, Servo, SetPoint};

/// Steps of the loops and the mechanism in one scan.
pub const SUBSTEPS: u32 = 4;
