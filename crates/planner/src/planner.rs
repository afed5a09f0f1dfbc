//! The interface between an axis and the maths: the questions of an axis to a planner.

use crate::grid::Family;
use crate::{
    DirectedLimits, Excess, GridPlan, Leads, Limits, Method, OnlinePlan, Passage, PlanError, ProfileFault,
    ProfileKind, ProfilePlan, ProfilePoint, RampPlan, Rung, SampledPlan, Segment, Setpoint, UnequalPlan,
    online, ramp, sum,
};

/// Plans moves for an axis.
///
/// An axis knows only this trait, so a test can use a countdown as planner and a host can bring its own.
/// Every method is bounded work without heap and never panics.
pub trait Planner {
    /// A plan: a plain value.
    type Plan: Plan;

    /// The sample time (s): the time between two set-points.
    fn cycle(&self) -> f64;

    /// A move from `start` that ends at rest exactly on `target` (u) within `limits`.
    ///
    /// `profile` is the method of the axis; a planner may support only one. `before` are the limits of
    /// the motion that `start` belongs to: until the state is inside `limits` the larger of the two
    /// apply.
    ///
    /// # Errors
    /// [`PlanError`] if an input is invalid or the move too long.
    fn move_to(
        &self,
        profile: MoveProfile,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Self::Plan, PlanError>;

    /// A change from `start` to the constant `velocity` (u/s) within `limits`; `before` as in
    /// [`Planner::move_to`].
    ///
    /// # Errors
    /// [`PlanError`] if an input is invalid or the ramp too long.
    fn ramp_to(
        &self,
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Self::Plan, PlanError>;

    /// A move from `start` that has `velocity` (u/s, signed, at most that of `limits`) at `target` (u),
    /// and keeps it from there on; `before` as in [`Planner::move_to`]. If the velocity points against
    /// the direction of the target, the move passes the target, reverses, and reaches it again.
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

    /// A move that passes `target` (u) as `passage` says, with the wanted speed or the nearest one that needs no
    /// overshoot and no reversal; `None` if there is none. The wanted speed may be above that of `limits`, which
    /// then applies until just before the target. If the move turns there, [`Plan::turn`] gives the scan. `before`
    /// as in [`Planner::move_to`].
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

    /// A move from `start` that ends at rest exactly on `target` (u), with switches anywhere and a
    /// velocity bound for each direction; `before` as in [`Planner::move_to`]. A planner with only one
    /// velocity bound uses the lower one.
    ///
    /// # Errors
    /// [`PlanError`] if an input is not usable or the move too long.
    fn move_by_direction(
        &self,
        start: &Setpoint,
        target: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
    ) -> Result<Self::Plan, PlanError> {
        let lower = Limits {
            velocity: limits.lower_velocity(),
            ..limits.limits
        };
        self.move_to(MoveProfile::Online, start, target, &lower, &before.either())
    }

    /// The curve through `points` from `start`, inside `limits` and, if given, inside a range of
    /// positions (u).
    ///
    /// # Errors
    /// [`ProfileFault`] names the point and its fault.
    fn profile(
        &self,
        kind: ProfileKind,
        start: &Setpoint,
        points: &[ProfilePoint],
        limits: &Limits,
        range: Option<(f64, f64)>,
    ) -> Result<Self::Plan, ProfileFault>;

    /// The largest speed (u/s), at most `wanted`, at which a move over `distance` (u, not negative) can begin up to
    /// one scan late and still pass its end with no more than the speed `exit`. With `brake` it begins while
    /// slowing down with that acceleration (u/s^2); 0 if that is not possible.
    fn entry_speed(&self, wanted: f64, brake: f64, distance: f64, exit: f64, limits: &Limits) -> f64;

    /// Whether two plans, each at its number of scans after its start, together keep `limits` from now on
    /// and do not turn outside `range` (u), which applies to the sum of their positions.
    fn fits(
        &self,
        first: (&Self::Plan, u64),
        second: (&Self::Plan, u64),
        limits: &Limits,
        range: Option<(f64, f64)>,
    ) -> bool;

    /// The part of `limits` that the rest of a plan always leaves to another motion; 0 if it leaves
    /// nothing.
    fn room(&self, rest: (&Self::Plan, u64), limits: &Limits) -> Limits;

    /// The scan of a plan, counted from its start, at which it next changes its highest derivative; the
    /// given scan if it never does again.
    fn next_switch(&self, rest: (&Self::Plan, u64)) -> u64;

    /// The distances (u) that the rest of a plan covers up to its goal: upwards, and downwards.
    fn ways(&self, rest: (&Self::Plan, u64)) -> (f64, f64);

    /// The range (u) of the rest of a plan, relative to its present position: to its lowest and to its highest
    /// position.
    fn reach(&self, rest: (&Self::Plan, u64)) -> (f64, f64) {
        let (up, down) = self.ways(rest);
        (-down, up)
    }

    /// Whether the rest of the masters' plans and the slave's additional motion together keep `limits` from now on,
    /// and no derivative jumps whose own derivative is bounded. `now` is the sum as published. A planner that can't
    /// decide returns FALSE; its slaves are then checked scan by scan.
    fn fits_behind(
        &self,
        _leads: &Leads<'_, Self::Plan>,
        _now: &Setpoint,
        _beside: Option<(&Self::Plan, u64)>,
        _limits: &Limits,
    ) -> bool {
        false
    }

    /// The lowest and the highest velocity (u/s) of the motions of [`Planner::fits_behind`]; `None` if
    /// they are not known.
    fn velocities_behind(
        &self,
        _leads: &Leads<'_, Self::Plan>,
        _beside: (&Self::Plan, u64),
    ) -> Option<(f64, f64)> {
        None
    }

    /// The next stretch in which the masters' plans together have a constant velocity: the scans until it
    /// begins and until it ends, the largest number if it has no end. `None` if that is not known.
    fn stretch(&self, _leads: &Leads<'_, Self::Plan>) -> Option<(u64, u64)> {
        None
    }

    /// Whether a plan is on a curve through points, whose motion ahead is not known.
    fn is_curve(&self, _rest: (&Self::Plan, u64)) -> bool {
        false
    }

    /// The largest magnitudes of the derivatives of the rest of a plan; `None` if they are not known.
    fn peaks(&self, _rest: (&Self::Plan, u64)) -> Option<Setpoint> {
        None
    }

    /// The same for the next scan alone, including everything that begins and ends in it.
    fn peaks_in_scan(&self, _rest: (&Self::Plan, u64)) -> Option<Setpoint> {
        None
    }

    /// The velocity (u/s) of `start` after its acceleration and jerk have become zero as soon as `limits`
    /// allow.
    fn coasting(&self, start: &Setpoint, _limits: &Limits) -> f64 {
        start.velocity
    }
}

/// How the moves of an axis to a position are planned (docs/planner.md, section 13).
///
/// Every profile ends at rest exactly on the target within the limits. If the requested method cannot
/// plan a move, the move is planned as [`MoveProfile::Online`]. For all methods except `ShortPath` this
/// is every move that starts in motion.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum MoveProfile {
    /// Every switch on the sample grid, the fewest scans if two snap pulses may overlap: [`GridPlan`]
    /// with [`Method::Overlapped`], [`UnequalPlan`] if acceleration and deceleration differ.
    #[default]
    Overlapped,
    /// As `Overlapped`, without the overlap: [`Method::Grid`].
    Grid,
    /// The published steps on the sample grid, [`Method::Sequential`]; the lower one of acceleration and
    /// deceleration applies to both.
    Sequential,
    /// Switches anywhere: [`OnlinePlan`].
    Online,
    /// `Overlapped` or `Online`: the one with fewer scans, or `Overlapped` if they are equal.
    Fastest,
    /// [`SCurve`](crate::papers::SCurve): moves from rest with a bound on jerk and none on snap; the
    /// lower one of acceleration and deceleration applies to both.
    SCurve,
    /// [`Trapezoid`](crate::papers::Trapezoid): moves from rest with no bound on jerk and none on snap.
    Trapezoid,
    /// [`ShortPath`](crate::papers::ShortPath): moves with a bound on jerk and none on snap, from rest or from a
    /// velocity towards the target without acceleration, if the distance is long enough to stop.
    ShortPath,
}

impl MoveProfile {
    /// All of them.
    pub const ALL: [Self; 8] = [
        Self::Overlapped,
        Self::Grid,
        Self::Sequential,
        Self::Online,
        Self::Fastest,
        Self::SCurve,
        Self::Trapezoid,
        Self::ShortPath,
    ];

    /// Its name in scan scripts and messages.
    pub const fn name(self) -> &'static str {
        match self {
            Self::Overlapped => "overlapped",
            Self::Grid => "grid",
            Self::Sequential => "sequential",
            Self::Online => "online",
            Self::Fastest => "fastest",
            Self::SCurve => "s-curve",
            Self::Trapezoid => "trapezoid",
            Self::ShortPath => "short-path",
        }
    }
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

    /// The set-point at its goal.
    #[inline]
    fn end(&self) -> Setpoint {
        self.at(self.scans().into())
    }

    /// The same as [`Plan::at`], for the motion in progress, in rising scans. A plan may store its present phase.
    #[inline]
    fn next(&mut self, scan: u64) -> Setpoint {
        self.at(scan)
    }

    /// The amount by which the start state forced the plan out of its limits, if it did.
    fn excess(&self) -> Option<Excess>;

    /// The part of [`Plan::excess`] that is also beyond `limits`, which are not lower than those of the
    /// plan.
    fn excess_over(&self, limits: &Limits) -> Option<Excess>;

    /// The rung of the online planner's ladder that made the plan, for hosts that count them; none for
    /// plans of another kind.
    fn rung(&self) -> Option<Rung> {
        None
    }

    /// The scan in which the plan turns at the target of [`Planner::blend`]; behind it the plan comes to rest
    /// somewhere.
    fn turn(&self) -> Option<u32> {
        None
    }

    /// Shifts the motion to other coordinates: every position of the plan becomes larger by `by` (u).
    fn shift(&mut self, by: f64);

    /// If `scan` is past the goal of an endless motion: makes that scan the start, and takes whole `length`s (u)
    /// off its position so that it starts within one. Returns their number. `None`, and no change, for any other
    /// scan or plan.
    ///
    /// A motion that is brought back many times has the error of one or two roundings, and not one for each time.
    fn bring_back(&mut self, _scan: u64, _length: f64) -> Option<i64> {
        None
    }
}

/// The standard planner: moves to a position by [`MoveProfile`], ramps for velocities.
#[derive(Clone, Copy, Debug)]
pub struct Standard {
    cycle: f64,
}

/// A plan of [`Standard`].
#[derive(Clone, Copy, Debug)]
pub enum StandardPlan {
    /// From rest to rest, every switch on the grid.
    Grid(GridPlan),
    /// The same if acceleration and deceleration differ.
    Unequal(UnequalPlan),
    /// To a velocity.
    Ramp(RampPlan),
    /// To rest, from motion or with switches anywhere.
    Online(OnlinePlan),
    /// To rest, by the method of a paper.
    Sampled(SampledPlan),
    /// Through points.
    Profile(ProfilePlan),
}

/// A plan is copied by value, once a command, so it stays small.
const _: () = assert!(size_of::<StandardPlan>() <= 1832);

impl Standard {
    /// A planner for the sample time `cycle` (s).
    pub const fn new(cycle: f64) -> Self {
        Self { cycle }
    }
}

impl Standard {
    /// From rest, every switch on the grid. The published steps have only one rate.
    fn on_grid(
        &self,
        method: Method,
        start: f64,
        target: f64,
        limits: &Limits,
    ) -> Result<StandardPlan, PlanError> {
        let family = match method {
            Method::Grid => Family::Separate,
            Method::Overlapped => Family::Overlapped,
            Method::Sequential => {
                return GridPlan::new(method, start, target, limits, self.cycle).map(StandardPlan::Grid);
            }
        };
        if limits.acceleration == limits.deceleration {
            GridPlan::new(method, start, target, limits, self.cycle).map(StandardPlan::Grid)
        } else {
            UnequalPlan::new(family, start, target, limits, self.cycle).map(StandardPlan::Unequal)
        }
    }

    /// The plan of `profile`; none if it cannot plan the move.
    fn by_profile(
        &self,
        profile: MoveProfile,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
    ) -> Option<Result<StandardPlan, PlanError>> {
        let rest = start.is_at_rest();
        let grid = |method| rest.then(|| self.on_grid(method, start.position, target, limits));
        // A method of a paper that cannot plan the move returns an error.
        let sampled =
            |plan: Result<SampledPlan, PlanError>| plan.ok().map(|plan| Ok(StandardPlan::Sampled(plan)));
        match profile {
            MoveProfile::Overlapped | MoveProfile::Fastest => grid(Method::Overlapped),
            MoveProfile::Grid => grid(Method::Grid),
            MoveProfile::Sequential => grid(Method::Sequential),
            MoveProfile::Online => None,
            MoveProfile::SCurve if rest => {
                sampled(SampledPlan::s_curve(start.position, target, limits, self.cycle))
            }
            MoveProfile::Trapezoid if rest => {
                sampled(SampledPlan::trapezoid(start.position, target, limits, self.cycle))
            }
            MoveProfile::ShortPath if start.acceleration == 0.0 => {
                sampled(SampledPlan::short_path(start, target, limits, self.cycle))
            }
            MoveProfile::SCurve | MoveProfile::Trapezoid | MoveProfile::ShortPath => None,
        }
    }
}

impl StandardPlan {
    /// Replaces the plan by `cruise`, its own motion at its end, brought back.
    fn bring_back_cruise(&mut self, mut cruise: RampPlan, scan: u64, length: f64) -> Option<i64> {
        let turns = cruise.bring_back(scan, length);
        *self = Self::Ramp(cruise);
        turns
    }

    #[inline(never)]
    fn numbers_at(&self, scan: u64) -> [f64; 5] {
        let setpoint = match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Unequal(grid) => grid.at(scan),
            Self::Ramp(ramp) => ramp.at(scan),
            Self::Online(plan) => plan.at(scan),
            Self::Sampled(plan) => plan.at(scan),
            Self::Profile(plan) => plan.at(scan),
        };
        setpoint.numbers()
    }
}

impl StandardPlan {
    #[inline(never)]
    fn next_numbers(&mut self, scan: u64) -> [f64; 5] {
        let setpoint = match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Unequal(grid) => grid.at(scan),
            Self::Ramp(ramp) => ramp.next(scan),
            Self::Online(plan) => plan.next(scan),
            Self::Sampled(plan) => plan.at(scan),
            Self::Profile(plan) => plan.at(scan),
        };
        setpoint.numbers()
    }
}

impl Planner for Standard {
    type Plan = StandardPlan;

    fn cycle(&self) -> f64 {
        self.cycle
    }

    fn move_to(
        &self,
        profile: MoveProfile,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<StandardPlan, PlanError> {
        let online = || OnlinePlan::new(start, target, limits, before, self.cycle).map(StandardPlan::Online);
        match self.by_profile(profile, start, target, limits) {
            None => online(),
            Some(Ok(grid)) if profile == MoveProfile::Fastest => Ok(match online() {
                Ok(other) if other.scans() < grid.scans() => other,
                _ => grid,
            }),
            Some(planned) => planned,
        }
    }

    fn move_by_direction(
        &self,
        start: &Setpoint,
        target: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
    ) -> Result<StandardPlan, PlanError> {
        OnlinePlan::by_direction(start, target, 0.0, limits, before, self.cycle).map(StandardPlan::Online)
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
        let plan = if passage.brake != 0.0 {
            OnlinePlan::braking(start, target, passage, limits, before, self.cycle)
        } else {
            OnlinePlan::blending(start, target, passage, limits, before, self.cycle)
        };
        Ok(plan?.map(StandardPlan::Online))
    }

    fn profile(
        &self,
        kind: ProfileKind,
        start: &Setpoint,
        points: &[ProfilePoint],
        limits: &Limits,
        range: Option<(f64, f64)>,
    ) -> Result<StandardPlan, ProfileFault> {
        ProfilePlan::new(kind, start, points, limits, range, self.cycle).map(StandardPlan::Profile)
    }

    fn entry_speed(&self, wanted: f64, brake: f64, distance: f64, exit: f64, limits: &Limits) -> f64 {
        online::entry_speed(wanted, brake, distance, exit, limits, self.cycle)
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

    fn ways(&self, rest: (&StandardPlan, u64)) -> (f64, f64) {
        sum::ways(rest, self.cycle)
    }

    fn reach(&self, rest: (&StandardPlan, u64)) -> (f64, f64) {
        sum::reach(rest, self.cycle)
    }

    fn fits_behind(
        &self,
        leads: &Leads<'_, StandardPlan>,
        now: &Setpoint,
        beside: Option<(&StandardPlan, u64)>,
        limits: &Limits,
    ) -> bool {
        sum::fits_behind(leads, now, beside, limits, self.cycle)
    }

    fn velocities_behind(
        &self,
        leads: &Leads<'_, StandardPlan>,
        beside: (&StandardPlan, u64),
    ) -> Option<(f64, f64)> {
        sum::velocities_behind(leads, beside, self.cycle)
    }

    fn stretch(&self, leads: &Leads<'_, StandardPlan>) -> Option<(u64, u64)> {
        sum::stretch(leads, self.cycle)
    }

    fn is_curve(&self, rest: (&StandardPlan, u64)) -> bool {
        sum::is_curve(rest)
    }

    fn peaks(&self, rest: (&StandardPlan, u64)) -> Option<Setpoint> {
        sum::peaks(rest, f64::INFINITY, self.cycle)
    }

    fn peaks_in_scan(&self, rest: (&StandardPlan, u64)) -> Option<Setpoint> {
        sum::peaks(rest, self.cycle, self.cycle)
    }

    fn coasting(&self, start: &Setpoint, limits: &Limits) -> f64 {
        ramp::coasting(start, limits, self.cycle)
    }
}

impl StandardPlan {
    /// The stretches of constant highest derivative, in order of time; at most 46 of them, and none for a
    /// profile.
    pub fn segments(&self) -> impl Iterator<Item = Segment> + '_ {
        let (grid, unequal, ramp, online, sampled) = match self {
            // Its stretches have no constant derivative.
            Self::Profile(_) => (None, None, None, None, None),
            Self::Grid(grid) => (Some(grid), None, None, None, None),
            Self::Unequal(grid) => (None, Some(grid), None, None, None),
            Self::Ramp(ramp) => (None, None, Some(ramp), None, None),
            Self::Online(plan) => (None, None, None, Some(plan), None),
            Self::Sampled(plan) => (None, None, None, None, Some(plan)),
        };
        let grid = grid.into_iter().flat_map(GridPlan::segments);
        let unequal = unequal.into_iter().flat_map(UnequalPlan::segments);
        let ramp = ramp.into_iter().flat_map(RampPlan::segments);
        let online = online.into_iter().flat_map(OnlinePlan::segments);
        let sampled = sampled.into_iter().flat_map(|plan| plan.profile().segments());
        let on_grid = grid.chain(unequal).map(Segment::from);
        on_grid.chain(ramp).chain(online).chain(sampled)
    }
}

impl Plan for StandardPlan {
    fn scans(&self) -> u32 {
        match self {
            Self::Grid(grid) => grid.scans(),
            Self::Unequal(grid) => grid.scans(),
            Self::Ramp(ramp) => ramp.scans(),
            Self::Online(plan) => plan.scans(),
            Self::Sampled(plan) => plan.scans(),
            Self::Profile(plan) => plan.scans(),
        }
    }

    // The most frequent kind is inlined into the axis, the others are called.
    #[inline(always)]
    fn at(&self, scan: u64) -> Setpoint {
        match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Unequal(_) | Self::Ramp(_) | Self::Online(_) | Self::Sampled(_) | Self::Profile(_) => {
                Setpoint::of(self.numbers_at(scan))
            }
        }
    }

    // The case of most scans of a motion is inlined, too.
    #[inline(always)]
    fn next(&mut self, scan: u64) -> Setpoint {
        match self {
            Self::Grid(grid) => grid.at(scan),
            Self::Online(plan) if plan.is_in_piece(scan) => plan.in_piece(scan),
            Self::Ramp(ramp) if ramp.is_at_goal(scan) => ramp.at_goal(scan),
            Self::Unequal(_) | Self::Ramp(_) | Self::Online(_) | Self::Sampled(_) | Self::Profile(_) => {
                Setpoint::of(self.next_numbers(scan))
            }
        }
    }

    fn excess(&self) -> Option<Excess> {
        match self {
            Self::Grid(_) | Self::Unequal(_) | Self::Sampled(_) | Self::Profile(_) => None,
            Self::Ramp(ramp) => ramp.excess(),
            Self::Online(plan) => plan.excess(),
        }
    }

    fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        match self {
            Self::Grid(_) | Self::Unequal(_) | Self::Sampled(_) | Self::Profile(_) => None,
            Self::Ramp(ramp) => ramp.excess_over(limits),
            Self::Online(plan) => plan.excess_over(limits),
        }
    }

    fn rung(&self) -> Option<Rung> {
        match self {
            Self::Grid(_) | Self::Unequal(_) | Self::Ramp(_) | Self::Sampled(_) | Self::Profile(_) => None,
            Self::Online(plan) => Some(plan.rung()),
        }
    }

    fn turn(&self) -> Option<u32> {
        match self {
            Self::Online(plan) => plan.turn(),
            Self::Grid(_) | Self::Unequal(_) | Self::Ramp(_) | Self::Sampled(_) | Self::Profile(_) => None,
        }
    }

    fn shift(&mut self, by: f64) {
        match self {
            Self::Grid(grid) => grid.shift(by),
            Self::Unequal(grid) => grid.shift(by),
            Self::Ramp(ramp) => ramp.shift(by),
            Self::Online(plan) => plan.shift(by),
            Self::Sampled(plan) => plan.shift(by),
            Self::Profile(plan) => plan.shift(by),
        }
    }

    fn bring_back(&mut self, scan: u64, length: f64) -> Option<i64> {
        match self {
            Self::Grid(_) | Self::Unequal(_) | Self::Sampled(_) => None,
            Self::Ramp(ramp) => ramp.bring_back(scan, length),
            Self::Online(plan) => {
                let cruise = plan.cruise(scan)?;
                self.bring_back_cruise(cruise, scan, length)
            }
            Self::Profile(plan) => {
                let cruise = plan.cruise(scan)?;
                self.bring_back_cruise(cruise, scan, length)
            }
        }
    }
}
