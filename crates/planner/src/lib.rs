//! Motion planning on a sample grid.
//!
//! From limits, a start and a goal it makes a plan, and from a plan the set-point of any scan. All motion maths is
//! here. The crate knows no axis states, no function blocks and no PLCopen. It has no clock, no heap, no panic and
//! no libm transcendental. It uses only `+ - * /`, square root and integers, so that every processor gives the same
//! bits.
//!
//! Lengths are in the user's unit `u`, times in seconds. The derivations with numbered equations are in
//! `docs/planner.md` (rest to rest), `docs/planner-ramps.md` (to a velocity) and `docs/planner-online.md`
//! (from motion to a position); the code cites their numbers.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(any(test, feature = "std", feature = "count"))]
extern crate std;

pub mod cam;
mod error;
mod gear;
pub mod grid;
pub mod kernel;
mod limits;
pub mod math;
pub mod online;
pub mod papers;
mod planner;
pub mod profile;
pub mod ramp;
mod setpoint;
pub mod shaper;
mod sum;
pub mod turns;

pub use cam::{
    Cam, CamAt, CamBounds, CamBuild, CamCause, CamFault, CamHead, CamLaw, CamPiece, CamRow, CamShape,
    CamSmooth,
};
pub use error::{Field, PlanError};
pub use gear::{Anchor, Gear, Place};
pub use grid::{GridPlan, Method, UnequalPlan};
pub use limits::{DirectedLimits, Limits, Order};
pub use online::{Goal, OnlinePlan, Passage, Rung};
pub use papers::SampledPlan;
pub use planner::{MoveProfile, Plan, Planner, Standard, StandardPlan};
pub use profile::{PROFILE_POINTS, ProfileCause, ProfileFault, ProfileKind, ProfilePlan, ProfilePoint};
pub use ramp::{Excess, Peaks, RampPlan, Segment};
pub use setpoint::Setpoint;
pub use shaper::{Shaper, ShaperKind, Shapers, VibrationMode};
pub use sum::{Lead, Leads};
