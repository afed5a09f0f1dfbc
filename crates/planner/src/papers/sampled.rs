//! A profile of a paper at scan ends, in the form that an axis needs.

use super::{Profile, SCurve, ShortPath, ShortPathPolicy, Trapezoid};
use crate::error::check_positive;
use crate::{Field, Limits, PlanError, Setpoint};

/// A [`Profile`] evaluated by scan count.
///
/// The profile keeps its limits in continuous time, and so do its samples (docs/planner.md, eq. 24).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SampledPlan {
    profile: Profile,
    cycle: f64,
    scans: u32,
}

impl SampledPlan {
    /// The same motion in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.profile.shift(by);
    }

    /// `profile` with sample time `cycle` (s).
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a `cycle` that is not positive and finite, [`PlanError::TooLong`] for
    /// more than 2^31 - 1 scans.
    pub fn new(profile: &Profile, cycle: f64) -> Result<Self, PlanError> {
        check_positive(Field::Cycle, cycle)?;
        let too_long = PlanError::too_far(profile.end().position);
        let scans = profile.scans(cycle).ok_or(too_long)?;
        Ok(Self {
            profile: *profile,
            cycle,
            scans,
        })
    }

    /// The same as [`SCurve::new`], from rest at `start` to rest at `target` (u).
    ///
    /// # Errors
    /// Those of [`SCurve::new`] and [`SampledPlan::new`].
    pub fn s_curve(start: f64, target: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        Self::new(
            SCurve::new(start, target, &limits.acting(cycle))?.profile(),
            cycle,
        )
    }

    /// The same as [`Trapezoid::new`], from rest at `start` to rest at `target` (u).
    ///
    /// # Errors
    /// Those of [`Trapezoid::new`] and [`SampledPlan::new`].
    pub fn trapezoid(start: f64, target: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        Self::new(
            Trapezoid::new(start, target, &limits.acting(cycle))?.profile(),
            cycle,
        )
    }

    /// The same as [`ShortPath::new`] with the policy `Nearest`, from the position and velocity of `start` to rest
    /// at `target` (u).
    ///
    /// # Errors
    /// Those of [`ShortPath::new`] and [`SampledPlan::new`].
    pub fn short_path(start: &Setpoint, target: f64, limits: &Limits, cycle: f64) -> Result<Self, PlanError> {
        let policy = ShortPathPolicy::Nearest;
        let limits = limits.acting(cycle);
        let plan = ShortPath::new(start.position, start.velocity, target, 0.0, &limits, policy)?;
        Self::new(plan.profile(), cycle)
    }

    /// The move in continuous time.
    pub const fn profile(&self) -> &Profile {
        &self.profile
    }

    /// Number of scans until the target; 0 if there is nothing to do.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// The set-point `scan` cycles after the start, in closed form: at most
    /// [`MAX_SEGMENTS`](super::MAX_SEGMENTS) comparisons.
    ///
    /// From [`SampledPlan::scans`] on it is the end of the profile, and a move that ends at rest stays there.
    pub fn at(&self, scan: u64) -> Setpoint {
        let end = self.profile.end();
        if scan >= u64::from(self.scans) && end.velocity == 0.0 {
            return end;
        }
        self.profile.at(scan as f64 * self.cycle)
    }
}
