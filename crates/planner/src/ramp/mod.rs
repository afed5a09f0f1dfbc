//! From any moving state to a constant velocity.

use crate::{Limits, PlanError, Setpoint};

/// By how much a start state forced a plan out of its limits, as magnitudes above the limit.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Excess {
    /// Velocity above its limit, or against the sign a stop should keep (u/s).
    pub velocity: f64,
    /// Acceleration above its limit (u/s^2).
    pub acceleration: f64,
    /// Jerk above its limit (u/s^3).
    pub jerk: f64,
}

/// A plan from any state to a constant velocity: at most a fixed number of constant-snap segments.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampPlan {
    goal: f64,
    start: Setpoint,
}

impl RampPlan {
    /// Plans from `start` to `velocity` (u/s) with sample time `cycle` (s); see
    /// [`Planner::ramp_to`](crate::Planner::ramp_to) for `before`.
    ///
    /// # Errors
    /// [`PlanError`] as its variants say.
    pub fn new(
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let _ = (limits, before, cycle);
        Ok(Self {
            goal: velocity,
            start: *start,
        })
    }

    /// Number of scans until the goal velocity.
    pub fn scans(&self) -> u32 {
        1
    }

    /// The set-point `scan` cycles after the start.
    pub fn at(&self, scan: u64) -> Setpoint {
        let _ = (scan, self.goal);
        self.start
    }

    /// By how much the start state forced the plan out of its limits, if it did.
    pub fn excess(&self) -> Option<Excess> {
        None
    }
}
