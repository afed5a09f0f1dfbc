//! The seam between an axis and the maths: what an axis may ask of any planner.

use crate::{
    Excess, GridPlan, Limits, OnlinePlan, Passage, PlanError, RampPlan, Rung, Segment, Setpoint, online, sum,
};

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

    /// A move from `start` that has the `velocity` (u/s, signed, at most that of `limits`) when it is at
    /// `target` (u), and keeps it from there on; `before` as in [`Planner::move_to`]. Against the direction
    /// in which the target lies it passes, turns, and is there again.
    ///
    /// # Errors
    /// [`PlanError`] if an input is not usable or the move too long.
    fn pass(
        &self,
        start: &Setpoint,
        target: f64,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Self::Plan, PlanError>;

    /// A move that passes `target` (u) as `passage` says, with the wanted speed or the nearest that needs no
    /// overshoot and no reversal; `None` if there is none. The wanted speed may be above that of `limits`,
    /// which then holds until just before the target; `before` as in [`Planner::move_to`].
    ///
    /// # Errors
    /// [`PlanError`] if an input is not usable or the move too long.
    fn blend(
        &self,
        start: &Setpoint,
        target: f64,
        passage: &Passage,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Option<Self::Plan>, PlanError>;

    /// The largest speed (u/s), at most `wanted`, at which a move over `distance` (u, not negative) can
    /// begin up to one scan late and still pass its end with no more than the speed `exit`.
    fn entry_speed(&self, wanted: f64, distance: f64, exit: f64, limits: &Limits) -> f64;

    /// Whether two plans, each so many scans after its start, keep `limits` together from now on and do not
    /// turn outside `range` (u), which is one of the sum of their positions.
    fn fits(
        &self,
        first: (&Self::Plan, u64),
        second: (&Self::Plan, u64),
        limits: &Limits,
        range: Option<(f64, f64)>,
    ) -> bool;

    /// What the rest of a plan leaves of `limits` whatever is added when; 0 where it leaves nothing.
    fn room(&self, rest: (&Self::Plan, u64), limits: &Limits) -> Limits;

    /// The scan of a plan, counted from its start, at which it next changes its highest derivative, or what
    /// is given if it never does again.
    fn next_switch(&self, rest: (&Self::Plan, u64)) -> u64;
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

impl StandardPlan {
    #[inline(never)]
    fn numbers_at(&self, scan: u64) -> [f64; 5] {
        let setpoint = match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Ramp(ramp) => ramp.at(scan),
            Self::Online(plan) => plan.at(scan),
        };
        setpoint.numbers()
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

    fn pass(
        &self,
        start: &Setpoint,
        target: f64,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<StandardPlan, PlanError> {
        if velocity == 0.0 {
            return self.move_to(start, target, limits, before);
        }
        OnlinePlan::passing(start, target, velocity, limits, before, self.cycle).map(StandardPlan::Online)
    }

    fn blend(
        &self,
        start: &Setpoint,
        target: f64,
        passage: &Passage,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Option<StandardPlan>, PlanError> {
        OnlinePlan::blending(start, target, passage, limits, before, self.cycle)
            .map(|plan| plan.map(StandardPlan::Online))
    }

    fn entry_speed(&self, wanted: f64, distance: f64, exit: f64, limits: &Limits) -> f64 {
        online::entry_speed(wanted, distance, exit, limits, self.cycle)
    }

    fn fits(
        &self,
        first: (&StandardPlan, u64),
        second: (&StandardPlan, u64),
        limits: &Limits,
        range: Option<(f64, f64)>,
    ) -> bool {
        sum::fits(first, second, limits, range, self.cycle)
    }

    fn room(&self, rest: (&StandardPlan, u64), limits: &Limits) -> Limits {
        sum::room(rest, limits, self.cycle)
    }

    fn next_switch(&self, rest: (&StandardPlan, u64)) -> u64 {
        sum::next_switch(rest, self.cycle)
    }
}

impl StandardPlan {
    /// The stretches of constant highest derivative, in order of time; at most 46 of them.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        let (grid, ramp, online) = match self {
            Self::Grid(grid) => (Some(grid), None, None),
            Self::Ramp(ramp) => (None, Some(ramp), None),
            Self::Online(plan) => (None, None, Some(plan)),
        };
        let grid = grid
            .into_iter()
            .flat_map(|grid| grid.segments().map(Segment::from));
        let ramp = ramp.into_iter().flat_map(RampPlan::segments);
        let online = online.into_iter().flat_map(OnlinePlan::segments);
        grid.chain(ramp).chain(online)
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

    // The most frequent kind in line with the axis, the others by a call.
    #[inline(always)]
    fn at(&self, scan: u64) -> Setpoint {
        match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Ramp(_) | Self::Online(_) => Setpoint::of(self.numbers_at(scan)),
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
}
