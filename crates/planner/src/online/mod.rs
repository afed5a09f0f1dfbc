//! From any moving state to a position.
//!
//! This module has the plan, and the ladder of methods to find one; each candidate is verified before it is taken.
//! Its ramps are those of [`ramp`](mod@crate::ramp), their maths that of [`kernel`](mod@crate::kernel). It does not
//! choose the next move of an axis. Equations (O1) and on are in `docs/planner-online.md`.

mod blend;
mod ends;
mod ladder;
mod search;
mod turn;

pub use blend::{Passage, entry_speed};
pub use ladder::Rung;
pub use search::MAX_SOLVES;

use crate::grid::GridPlan;
use crate::kernel::{ON_LIMIT, Sides};
use crate::ramp::excess::{self, Excess, Peaks};
use crate::ramp::{self, Segment};
use crate::{DirectedLimits, Field, Limits, Order, PlanError, RampPlan, Setpoint};
use ladder::{Found, Tail};

/// Largest number of pieces of a plan.
pub(crate) const MAX_PIECES: usize = 30;

/// A plan from any state to a position, at rest there or with an end velocity: at most 30 pieces of
/// constant snap (order 4), jerk (3) or acceleration (2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct OnlinePlan {
    start: Setpoint,
    target: f64,
    end_velocity: f64,
    end_acceleration: f64,
    cycle: f64,
    scans: u32,
    found: Found,
}

/// The end of a move.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct Goal {
    /// Position (u).
    pub position: f64,
    /// Velocity there (u/s), of either sign.
    pub velocity: f64,
    /// Acceleration there (u/s^2), of either sign; without jerk. At order 2 it can only be 0.
    pub acceleration: f64,
}

impl OnlinePlan {
    /// Plans from `start` to rest at `target` (u) in the least time this planner knows, with sample time
    /// `cycle` (s).
    ///
    /// The order is that of `limits` ([`Limits::order`]). At order 3 the start's jerk is not used, at order 2 its
    /// acceleration is not used either: they may jump. `limits.acceleration` bounds the acceleration while the
    /// speed grows, `limits.deceleration` while it falls. In a ramp whose velocity changes sign the lower one of
    /// the two holds (R11, O5).
    ///
    /// A start outside `limits` is brought inside first, in least time, under the larger ones of `limits` and
    /// `before`; an infinite bound in `before` counts as that of `limits`. [`OnlinePlan::excess`] reports the
    /// excess.
    ///
    /// Bounded work: at most [`MAX_SOLVES`] ramps, in practice about 5 ([`OnlinePlan::solves`]), each with at
    /// most seven roots of [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS) steps.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a `cycle` that is not positive and finite, a start or target that is
    /// not finite or too far from each other, a bound that is not positive, and an infinite velocity,
    /// acceleration or deceleration; [`PlanError::TooLong`] for more than 2^31 - 1 scans.
    pub fn new(
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::with(Rung::PushThenStop, start, target, 0.0, limits, before, cycle)
    }

    /// The same as [`OnlinePlan::new`], but the plan passes `target` with `end_velocity` (u/s) and keeps it. It
    /// ends at the first instant at which it can be there with that velocity and no acceleration or jerk.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::new`], and [`PlanError::InvalidInput`] for an `end_velocity` beyond the limit.
    pub fn passing(
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::with(
            Rung::PushThenStop,
            start,
            target,
            end_velocity,
            limits,
            before,
            cycle,
        )
    }

    /// The same as [`OnlinePlan::passing`], but the search begins on the rung `first`: for comparing rungs, and for
    /// testing those that are hardly ever needed.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
    pub fn with(
        first: Rung,
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let (limits, before) = (&(*limits).into(), &(*before).into());
        Self::by_direction_with(first, start, target, end_velocity, limits, before, cycle)
    }

    /// The same as [`OnlinePlan::passing`], with a velocity bound for each direction: a push goes for the bound of
    /// its own direction.
    ///
    /// A start beyond its bound is brought inside like any start outside its limits.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
    pub fn by_direction(
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let first = Rung::PushThenStop;
        Self::by_direction_with(first, start, target, end_velocity, limits, before, cycle)
    }

    /// The same as [`OnlinePlan::with`], with a velocity bound for each direction.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
    pub fn by_direction_with(
        first: Rung,
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let top = limits.sides();
        Self::cruising(first, start, target, end_velocity, top, limits, before, cycle)
    }

    /// The frame of a plan that ends with this velocity and acceleration, without a path.
    const fn nothing(
        start: &Setpoint,
        target: f64,
        (end_velocity, end_acceleration): (f64, f64),
        order: Order,
        cycle: f64,
    ) -> Self {
        Self {
            start: *start,
            target,
            end_velocity,
            end_acceleration,
            cycle,
            scans: 0,
            found: Found::nothing(order),
        }
    }

    /// The same as [`OnlinePlan::by_direction_with`], but until its last ramp the plan goes for the velocity `top`
    /// (u/s), at most that of `limits`. So an `end_velocity` above `top` is reached at the end and not before.
    #[expect(clippy::too_many_arguments, reason = "a problem, as it was given")]
    fn cruising(
        first: Rung,
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        top: Sides,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        check(start, target, end_velocity, limits, before, cycle)?;
        let acting =
            |limits: &DirectedLimits| limits.acting_for(start, end_velocity, target - start.position, cycle);
        let given = limits;
        let limits = &acting(given);
        let wider = if before == given {
            *limits
        } else {
            acting(&given.or_larger(before))
        };
        let end = (end_velocity, 0.0);
        let mut plan = Self::nothing(start, target, end, limits.limits.order(), cycle);
        let too_long = PlanError::too_far(target);
        if limits.outside(end_velocity) > 0.0 {
            return Err(too_long);
        }
        let top = Sides {
            minus: top.minus.min(limits.negative),
            plus: top.plus.min(limits.positive),
        };
        plan.climb(first, top, limits, &wider)?;
        plan.found.excess = plan.excess_beyond(given);
        let moving = ramp::scans(plan.found.path.duration(), cycle).ok_or(too_long)?;
        // Both counts are below 2^31, so the sum fits.
        let grid = plan.found.tail.as_ref().and_then(Tail::grid);
        plan.scans = moving + grid.map_or(0, |(grid, _)| grid.scans());
        Ok(plan)
    }

    /// Plans from `start` to a `goal` that may have an acceleration, with a velocity bound for each direction. It
    /// ends at the first known instant at which it can have that velocity and acceleration at the target, and no
    /// jerk.
    ///
    /// Without an end acceleration it is [`OnlinePlan::by_direction`]. With one, the plan continues behind its end
    /// with that acceleration, so the caller must take over before the velocity reaches its bound. The plan is the
    /// shortest of several candidates, each verified: pushes towards both bounds with a last ramp that is a move of
    /// one order less, and moves that meet ramps computed back from the end (docs/planner-online.md, section 8).
    ///
    /// Bounded work: at most 2,000 last ramps of at most [`MAX_SOLVES`] ramps each; in practice some thousand
    /// ramps.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`]; [`PlanError::Unreachable`] for an end state that is outside the limits,
    /// that no motion inside them can reach, or from which none inside them can continue, with the nearest possible
    /// one.
    pub fn reaching(
        start: &Setpoint,
        goal: &Goal,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let Goal {
            position: target,
            velocity,
            acceleration,
        } = *goal;
        if !acceleration.is_finite() {
            return Err(PlanError::InvalidInput {
                field: Field::EndAcceleration,
                value: acceleration,
            });
        }
        check(start, target, 0.0, limits, before, cycle)?;
        let bound = limits.velocity(velocity);
        if velocity.abs() > bound {
            return Err(PlanError::Unreachable {
                field: Field::EndVelocity,
                value: velocity,
                nearest: bound.copysign(velocity),
            });
        }
        if acceleration == 0.0 {
            return Self::by_direction(start, target, velocity, limits, before, cycle);
        }
        let steepest = Setpoint {
            acceleration: start.acceleration.abs().max(acceleration.abs()),
            ..*start
        };
        let distance = target - start.position;
        let acting = |limits: &DirectedLimits| limits.acting_for(&steepest, velocity, distance, cycle);
        let (given, wider) = (limits, acting(&limits.or_larger(before)));
        let limits = &acting(limits);
        let end = Setpoint {
            velocity,
            acceleration,
            ..Setpoint::default()
        };
        let jumps = limits.limits.order() == Order::Two;
        if jumps || !ends::is_kept(&end, limits) {
            return Err(PlanError::Unreachable {
                field: Field::EndAcceleration,
                value: acceleration,
                nearest: if jumps {
                    0.0
                } else {
                    ends::nearest_kept(&end, limits)
                },
            });
        }
        let end = (velocity, acceleration);
        let mut plan = Self::nothing(start, target, end, limits.limits.order(), cycle);
        plan.climb_to_end(limits.sides(), limits, &wider)?;
        plan.found.excess = plan.excess_beyond(given);
        plan.scans = ramp::scans(plan.found.path.duration(), cycle).ok_or(PlanError::too_far(target))?;
        Ok(plan)
    }

    /// The same as [`OnlinePlan::passing`], with one exception. If the rates of `limits`, once inside, would lead
    /// out of the velocity of both limits and those of `before` would not, the rates of `before` hold throughout.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
    pub fn keeping_velocity(
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let (limits, before) = (&(*limits).into(), &(*before).into());
        Self::keeping_velocities(start, target, end_velocity, limits, before, cycle)
    }

    /// The same as [`OnlinePlan::keeping_velocity`], with a velocity bound for each direction.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
    pub fn keeping_velocities(
        start: &Setpoint,
        target: f64,
        end_velocity: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let lowered = |limits| Self::by_direction(start, target, end_velocity, limits, before, cycle);
        let plan = lowered(limits)?;
        let wider = limits.or_larger(before);
        let kept = DirectedLimits {
            limits: Limits {
                velocity: limits.limits.velocity,
                ..wider.limits
            },
            ..*limits
        };
        // A tail is inside the new velocity.
        let leaves = |plan: &Self| {
            plan.found.excess.is_some() && excess::leaves(&plan.found.path, end_velocity, &wider)
        };
        if kept == *limits || !leaves(&plan) {
            return Ok(plan);
        }
        // Too late for the lower rates: the previous ones hold to the end if they keep the velocity.
        match lowered(&kept) {
            Ok(mut other) if !leaves(&other) => {
                other.found.excess = excess::excess(&other.found.path, end_velocity, None, limits);
                Ok(other)
            }
            _ => Ok(plan),
        }
    }

    /// The share of the residual that is corrected after a `part` of the path (O9).
    #[inline]
    fn share(&self, part: f64) -> f64 {
        if self.found.is_rounding {
            part
        } else {
            part * part * part * (10.0 + part * (6.0 * part - 15.0))
        }
    }

    /// Number of scans until the target; 0 if the start is on the target.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// The set-point `scan` cycles after the start, evaluated in closed form from its piece.
    ///
    /// `scan` 0 is the start. From [`OnlinePlan::scans`] on it is the goal: at rest exactly on the target, or
    /// moving on with exactly the end velocity. In between, the highest derivative is the one in force just before
    /// the instant. At most 30 comparisons.
    #[inline]
    pub fn at(&self, scan: u64) -> Setpoint {
        if scan >= u64::from(self.scans) {
            return self.beyond(scan);
        }
        if scan == 0 {
            return self.start;
        }
        match &self.found.tail {
            Some(Tail::Grid { grid, begin }) if scan >= u64::from(*begin) => {
                return grid.at(scan - u64::from(*begin));
            }
            &Some(Tail::Turn {
                scan: turn,
                position,
                acceleration,
            }) if scan == u64::from(turn) => {
                return Setpoint {
                    acceleration,
                    ..Setpoint::at_rest(position)
                };
            }
            _ => {}
        }
        let time = scan as f64 * self.cycle;
        match self.found.path.at(time) {
            Some(state) => self.on_target(state, time / self.found.path.duration()),
            None => self.beyond(scan),
        }
    }

    /// The same as [`OnlinePlan::at`], for a motion in progress that is evaluated scan after scan: the piece is
    /// searched only where it changes.
    // Inlined into its caller: a returned set-point would be written to memory and read again.
    #[inline(always)]
    pub fn next(&mut self, scan: u64) -> Setpoint {
        if scan >= u64::from(self.scans) || self.found.tail.is_some() || scan == 0 {
            return self.at(scan);
        }
        match self.found.path.next(scan as f64 * self.cycle) {
            Some((state, part)) => self.on_target(state, part),
            None => self.beyond(scan),
        }
    }

    /// Whether `scan` is in the piece that [`OnlinePlan::next`] used last.
    #[inline(always)]
    pub(crate) fn is_in_piece(&self, scan: u64) -> bool {
        let is_on_path = scan < u64::from(self.scans) && self.found.tail.is_none();
        is_on_path && self.found.path.is_current(scan as f64 * self.cycle)
    }

    /// The set-point at a `scan` of that piece.
    #[inline(always)]
    pub(crate) fn in_piece(&self, scan: u64) -> Setpoint {
        let (state, part) = self.found.path.on_current(scan as f64 * self.cycle);
        self.on_target(state, part)
    }

    /// A state of the path, a `part` of its duration after the start, in the coordinates of the axis, with its
    /// share of the residual.
    #[inline]
    fn on_target(&self, state: Setpoint, part: f64) -> Setpoint {
        let residual = self.found.residual * self.share(part);
        Setpoint {
            position: self.start.position + (state.position + residual),
            ..state
        }
    }

    /// The state at a scan from the end of the plan on.
    fn beyond(&self, scan: u64) -> Setpoint {
        if self.end_velocity == 0.0 && self.end_acceleration == 0.0 {
            return Setpoint::at_rest(self.target);
        }
        let since = scan as f64 * self.cycle - self.duration();
        // A plan that reaches its target in a scan is on it there, independent of the rounding of the duration.
        let since = if since.abs() <= ON_LIMIT * self.cycle {
            0.0
        } else {
            since
        };
        if self.end_acceleration != 0.0 {
            let gained = self.end_acceleration * since;
            return Setpoint {
                velocity: self.end_velocity + gained,
                acceleration: self.end_acceleration,
                ..Setpoint::at_rest(self.target + (self.end_velocity + 0.5 * gained) * since)
            };
        }
        Setpoint {
            velocity: self.end_velocity,
            ..Setpoint::at_rest(self.target + self.end_velocity * since)
        }
    }

    /// The same motion in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.start.position += by;
        self.target += by;
        match &mut self.found.tail {
            Some(Tail::Grid { grid, .. }) => grid.shift(by),
            Some(Tail::Turn { position, .. }) => *position += by,
            None => {}
        }
    }

    /// The motion with the end velocity alone, as a plan of its own with the same count of scans; none before
    /// `scan` is at its end, or if it ends at rest.
    pub(crate) fn cruise(&self, scan: u64) -> Option<RampPlan> {
        if scan < u64::from(self.scans) || self.end_velocity == 0.0 || self.end_acceleration != 0.0 {
            return None;
        }
        let start = self.target - self.end_velocity * self.duration();
        Some(RampPlan::cruising(
            start,
            self.end_velocity,
            self.found.path.order(),
            self.cycle,
        ))
    }

    /// The excess that the start state forced on the plan, if it is more than 1e-9 of the limits.
    pub const fn excess(&self) -> Option<Excess> {
        self.found.excess
    }

    /// The part of [`OnlinePlan::excess`] that is also beyond `limits`, which are no lower than those of the plan.
    /// It is found as by [`RampPlan::excess_over`], in at most 30 pieces.
    pub fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        self.excess_beyond(&(*limits).into())
    }

    fn excess_beyond(&self, limits: &DirectedLimits) -> Option<Excess> {
        self.found.excess?;
        excess::excess(&self.found.path, self.end_velocity, None, limits)
    }

    /// Time until the target (s). It is not rounded to scans unless a grid plan ends the motion.
    pub fn duration(&self) -> f64 {
        match self.grid() {
            Some((grid, begin)) => f64::from(begin) * self.cycle + grid.duration(),
            None => self.found.path.duration(),
        }
    }

    /// The grid plan after the brake, and the scan in which it begins.
    fn grid(&self) -> Option<(&GridPlan, u32)> {
        self.found.tail.as_ref().and_then(Tail::grid)
    }

    /// The scan in which it turns ([`OnlinePlan::braking`]).
    pub const fn turn(&self) -> Option<u32> {
        match self.found.tail {
            Some(Tail::Turn { scan, .. }) => Some(scan),
            Some(Tail::Grid { .. }) | None => None,
        }
    }

    /// Position at the end (u).
    pub const fn target(&self) -> f64 {
        self.target
    }

    /// Velocity at the end (u/s).
    pub const fn end_velocity(&self) -> f64 {
        self.end_velocity
    }

    /// Acceleration at the end (u/s^2).
    pub const fn end_acceleration(&self) -> f64 {
        self.end_acceleration
    }

    /// The rung of the ladder that found the plan.
    pub const fn rung(&self) -> Rung {
        self.found.rung
    }

    /// Number of ramps solved to find the plan, on all tried rungs; at most [`MAX_SOLVES`].
    pub const fn solves(&self) -> u32 {
        self.found.solves
    }

    /// Largest number of steps of one root, at most [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS).
    pub const fn steps(&self) -> u32 {
        self.found.steps
    }

    /// The stretches of constant highest derivative, in order of time; none of no length.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        let behind = self.grid().into_iter().flat_map(|(grid, begin)| {
            // The grid plan begins in a whole scan.
            let wait = Segment::wait(f64::from(begin) * self.cycle - self.found.path.duration());
            wait.into_iter().chain(grid.segments().map(Segment::from))
        });
        self.found.path.segments().chain(behind)
    }

    /// The largest magnitudes of the continuous plan, in closed form.
    pub fn peaks(&self) -> Peaks {
        let peaks = excess::peaks(&self.found.path, self.end_velocity);
        let Some(grid) = self.grid().map(|(grid, _)| grid.peaks()) else {
            return peaks;
        };
        Peaks {
            velocity: peaks.velocity.max(grid.velocity),
            acceleration: peaks.acceleration.max(grid.acceleration),
            jerk: peaks.jerk.max(grid.jerk.unwrap_or(f64::INFINITY)),
            snap: peaks.snap.max(grid.snap.unwrap_or(f64::INFINITY)),
        }
    }
}

fn check(
    start: &Setpoint,
    target: f64,
    end_velocity: f64,
    limits: &DirectedLimits,
    before: &DirectedLimits,
    cycle: f64,
) -> Result<(), PlanError> {
    let invalid = |field, value| Err(PlanError::InvalidInput { field, value });
    ramp::check(start, end_velocity, limits, before, cycle)?;
    if !limits.either().velocity.is_finite() {
        return invalid(Field::LimitVelocity, limits.either().velocity);
    }
    if !(target - start.position).is_finite() {
        return invalid(Field::Target, target);
    }
    Ok(())
}

/// A grid plan from rest, for the last rung.
fn grid_from(rest: f64, target: f64, limits: &Limits, cycle: f64) -> Result<GridPlan, PlanError> {
    GridPlan::new(crate::Method::Overlapped, rest, target, limits, cycle)
}
