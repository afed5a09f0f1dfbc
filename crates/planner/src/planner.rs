//! The seam between an axis and the maths: what an axis may ask of any planner.

use crate::{Excess, GridPlan, Limits, OnlinePlan, PlanError, RampPlan, Rung, Setpoint};

/// Plans moves for an axis.
///
/// An axis knows only this trait, so tests can put a countdown in the planner's place and a host can bring
/// its own. Every method is bounded work without heap and never panics.
pub trait Planner {
    /// A plan: a plain value.
    type Plan: Plan;

    /// A move from `start` that ends at rest exactly on `target` (u) within `limits`.
    ///
    /// `before` are the limits that held for the motion `start` belongs to: until the state is inside
    /// `limits` the larger of the two hold.
    ///
    /// # Errors
    /// [`PlanError`] if an input is not usable or the move too long.
    fn move_to(
        &self,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Self::Plan, PlanError>;

    /// A change from `start` to the constant `velocity` (u/s) within `limits`; `before` as in
    /// [`Planner::move_to`].
    ///
    /// # Errors
    /// [`PlanError`] if an input is not usable or the ramp too long.
    fn ramp_to(
        &self,
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Self::Plan, PlanError>;
}

/// A planned motion, evaluated by scan count from its start.
pub trait Plan: Copy + core::fmt::Debug {
    /// Number of scans N until the goal; 0 for a move of no length.
    fn scans(&self) -> u32;

    /// The set-point `scan` scans after the start, in O(1).
    ///
    /// `scan` 0 is the start. From [`Plan::scans`] on it is the goal: exactly the target, or the goal
    /// velocity kept for ever.
    fn at(&self, scan: u64) -> Setpoint;

    /// By how much the start state forced the plan out of its limits, if it did.
    fn excess(&self) -> Option<Excess>;

    /// The rung of the online planner's ladder the plan is from, for hosts that count them; none for plans
    /// of another kind.
    fn rung(&self) -> Option<Rung> {
        None
    }

    /// Where `scan` is past the goal of an endless motion: the same motion with that scan as its start, and
    /// whole `length`s (u) taken off its position so that it starts within one. Returns how many; `None`, and
    /// the plan as it is, for any other scan or plan.
    ///
    /// However often a motion is brought back, its position is off by a rounding or two, not by one for each
    /// time.
    fn bring_back(&mut self, _scan: u64, _length: f64) -> Option<i64> {
        None
    }
}

/// The planner of the product: the shortest grid plan of the overlapped family from rest, a ramp for
/// velocities, and from motion an online plan.
#[derive(Clone, Copy, Debug)]
pub struct Standard {
    cycle: f64,
}

/// A plan of [`Standard`].
#[derive(Clone, Copy, Debug)]
#[expect(
    clippy::large_enum_variant,
    reason = "without a heap a plan is as large as the largest"
)]
pub enum StandardPlan {
    /// From rest to rest, every switch on the grid.
    Grid(GridPlan),
    /// To a velocity.
    Ramp(RampPlan),
    /// From motion to rest.
    Online(OnlinePlan),
}

/// A plan is copied about by value, once a command.
const _: () = assert!(size_of::<StandardPlan>() <= 1728);

impl Standard {
    /// A planner for the sample time `cycle` (s).
    pub const fn new(cycle: f64) -> Self {
        Self { cycle }
    }
}

impl Planner for Standard {
    type Plan = StandardPlan;

    fn move_to(
        &self,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<StandardPlan, PlanError> {
        use crate::Method::Overlapped;
        if start.is_at_rest() {
            return GridPlan::new(Overlapped, start.position, target, limits, self.cycle)
                .map(StandardPlan::Grid);
        }
        OnlinePlan::new(start, target, limits, before, self.cycle).map(StandardPlan::Online)
    }

    fn ramp_to(
        &self,
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<StandardPlan, PlanError> {
        RampPlan::new(start, velocity, limits, before, self.cycle).map(StandardPlan::Ramp)
    }
}

impl Plan for StandardPlan {
    fn scans(&self) -> u32 {
        match self {
            Self::Grid(grid) => grid.scans(),
            Self::Ramp(ramp) => ramp.scans(),
            Self::Online(plan) => plan.scans(),
        }
    }

    #[inline(always)]
    fn at(&self, scan: u64) -> Setpoint {
        match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Ramp(ramp) => ramp.at(scan),
            Self::Online(plan) => plan.at(scan),
        }
    }

    fn excess(&self) -> Option<Excess> {
        match self {
            Self::Grid(_) => None,
            Self::Ramp(ramp) => ramp.excess(),
            Self::Online(plan) => plan.excess(),
        }
    }

    fn rung(&self) -> Option<Rung> {
        match self {
            Self::Grid(_) | Self::Ramp(_) => None,
            Self::Online(plan) => Some(plan.rung()),
        }
    }

    fn bring_back(&mut self, scan: u64, length: f64) -> Option<i64> {
        match self {
            Self::Grid(_) => None,
            Self::Ramp(ramp) => ramp.bring_back(scan, length),
            Self::Online(plan) => {
                let mut cruise = plan.cruise(scan)?;
                let turns = cruise.bring_back(scan, length);
                *self = Self::Ramp(cruise);
                turns
            }
        }
    }
}
