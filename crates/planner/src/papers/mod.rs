//! Profiles of five papers, corrected: each is planned by the steps of its paper.
//!
//! - [`SCurve`]: rest to rest in least time under bounds on velocity, acceleration and jerk
//!   (Blejan and Blejan 2020).
//! - [`Timed`], [`Trapezoid`]: rest to rest in a given time (García-Martínez et al. 2019).
//! - [`ShortPath`]: from one velocity to another along a path of any length (Bui et al. 2021).
//! - [`Tracking`]: to a target that moves while the axis does (Zhang).
//!
//! The fifth, of Pietrusewicz et al. 2019, is [`Method::Sequential`](crate::Method::Sequential) on the
//! grid. The errors in the papers, and every published number beside ours, are in `docs/papers.md`; the
//! code cites its equations as (P1) and on.
//!
//! All results are plain values in continuous time: closed forms, or one bracketed root.

mod profile;
mod s_curve;
mod sampled;
mod short_path;
mod timed;
mod tracking;

pub use profile::{MAX_SEGMENTS, Profile, Times};
pub use s_curve::{SCurve, SCurveCase, Stepper};
pub use sampled::SampledPlan;
pub use short_path::{ShortPath, ShortPathPolicy, ShortPathType};
pub use timed::{Timed, Trapezoid};
pub use tracking::{Tracking, peaks};

use crate::{Field, Limits, PlanError};

/// A request that misses the least duration by this much, relative to it, is still accepted.
const SLACK: f64 = 1e-12;

/// The least count of scans of `cycle` (s) that covers `duration` (s), except for 1e-9 of it; none if
/// that is more than 2^31 - 1.
pub fn scans(duration: f64, cycle: f64) -> Option<u32> {
    crate::ramp::scans(duration, cycle)
}

/// Refuses missing bounds that a method needs, and bounds that it could not keep.
fn check_limits(limits: &Limits, needed: &[Field], unknown: &[Field]) -> Result<(), PlanError> {
    limits.check()?;
    for (field, value) in limits.named() {
        let missing = value.is_infinite() && needed.contains(&field);
        let too_many = value.is_finite() && unknown.contains(&field);
        if missing || too_many {
            return Err(invalid(field, value));
        }
    }
    Ok(())
}

fn invalid(field: Field, value: f64) -> PlanError {
    PlanError::InvalidInput { field, value }
}
