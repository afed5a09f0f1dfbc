//! From any moving state to a constant velocity.
//!
//! This module has the start state with its sign and its limits, the plan, and its set-point at any scan. The maths
//! of one transfer is in [`kernel`](crate::kernel). The module does not have target positions. Equations (R1) and
//! on, and the definition of a viable state, are in `docs/planner-ramps.md`.

#[cfg(feature = "count")]
mod count;
pub(crate) mod excess;
mod inside;
pub(crate) mod path;
mod slope;
pub(crate) mod solve;
mod turn;

#[cfg(feature = "count")]
pub use count::solved;
pub use excess::{Excess, Peaks};

use crate::error::check_positive;
use crate::kernel::ON_LIMIT;
use crate::turns::{split, two_product, two_sum};
use crate::{DirectedLimits, Field, Limits, Order, PlanError, Setpoint};
use path::Path;
use solve::{Course, Ramp, Ramps, heading, unmoved};

/// Largest number of pieces of a plan.
const MAX_PIECES: usize = 20;

/// Largest number of scans of a plan.
const MAX_SCANS: f64 = 2_147_483_647.0;

/// Largest distance of `duration / cycle` above a whole number, relative to itself, at which it still counts as
/// that number.
const GRID_SLACK: f64 = 1e-9;

/// The same in scans: a plan that is shortened by this at its end has the same last set-point.
const SCAN_SLACK: f64 = 1.0 / 4096.0;

/// A plan from any state to a constant velocity: at most 20 pieces of constant snap (order 4), jerk (3) or
/// acceleration (2).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RampPlan {
    start: Setpoint,
    /// The part of the start's position that f64 does not hold (u); not 0 only in a motion that was brought back.
    carry: f64,
    goal: f64,
    cycle: f64,
    scans: u32,
    steps: u32,
    path: Path<MAX_PIECES>,
    excess: Option<Excess>,
}

/// A stretch of a plan with a constant highest derivative.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Segment {
    /// Duration (s); always above 0.
    pub duration: f64,
    /// Velocity at its start (u/s).
    pub velocity: f64,
    /// Acceleration at its start, after any jump (u/s^2).
    pub acceleration: f64,
    /// Jerk at its start, after any jump (u/s^3).
    pub jerk: f64,
    /// The constant snap (u/s^4).
    pub snap: f64,
}

impl Segment {
    /// A stretch from this state on, just after any jump.
    pub(crate) const fn of(duration: f64, state: &Setpoint) -> Self {
        Self {
            duration,
            velocity: state.velocity,
            acceleration: state.acceleration,
            jerk: state.jerk,
            snap: state.snap,
        }
    }

    /// The state at its start, at position 0.
    pub(crate) const fn first(&self) -> Setpoint {
        Setpoint {
            position: 0.0,
            velocity: self.velocity,
            acceleration: self.acceleration,
            jerk: self.jerk,
            snap: self.snap,
        }
    }

    /// A wait at rest of this duration (s), if there is any.
    pub(crate) fn wait(duration: f64) -> Option<Self> {
        (duration > 0.0).then(|| Self::of(duration, &Setpoint::at_rest(0.0)))
    }
}

impl From<crate::grid::Segment> for Segment {
    fn from(segment: crate::grid::Segment) -> Self {
        Self {
            duration: segment.duration,
            velocity: segment.velocity,
            acceleration: segment.acceleration,
            jerk: segment.jerk,
            snap: segment.snap,
        }
    }
}

impl RampPlan {
    /// Plans from `start` to `velocity` (u/s) in least time with sample time `cycle` (s).
    ///
    /// The order is that of `limits` ([`Limits::order`]). At order 3 the start's jerk is not used, at order 2 its
    /// acceleration is not used either: they may jump. `limits.acceleration` bounds the acceleration while the
    /// speed grows, `limits.deceleration` while it falls. In a ramp whose velocity changes sign the lower one of
    /// the two holds (R11).
    ///
    /// A start outside `limits` is brought inside first, in least time, under the larger ones of `limits` and
    /// `before`; an infinite bound in `before` counts as that of `limits`. The excess is the least possible;
    /// [`RampPlan::excess`] reports it.
    ///
    /// Bounded work: two ramps of closed forms and at most seven roots of
    /// [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS) steps; most have none or one.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] for a `cycle` that is not positive and finite, a start or velocity that is not
    /// finite, a bound that is not positive, an infinite acceleration or deceleration, and a `velocity` beyond
    /// `limits.velocity`; [`PlanError::TooLong`] for more than 2^31 - 1 scans and for a time beyond the range of
    /// numbers.
    pub fn new(
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::by_direction(start, velocity, &(*limits).into(), &(*before).into(), cycle)
    }

    /// The same as [`RampPlan::new`], with a velocity bound for each direction.
    ///
    /// # Errors
    /// Those of [`RampPlan::new`].
    pub fn by_direction(
        start: &Setpoint,
        velocity: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        check(start, velocity, limits, before, cycle)?;
        let acting = |limits: &DirectedLimits| limits.acting_for(start, velocity, 0.0, cycle);
        let (given, wider) = (limits, acting(&limits.or_larger(before)));
        let directed = &acting(limits);
        let limits = &directed.limits;
        let too_long = PlanError::TooLong {
            field: Field::EndVelocity,
            value: velocity,
        };
        if directed.outside(velocity) > 0.0 {
            return Err(too_long);
        }
        let order = limits.order();
        let heading = heading(start, velocity, directed.lower_velocity(), order);
        let ramps = Ramps::new(directed, &wider);
        let proposed = |course| {
            let Ramp {
                spans, steps, viable, ..
            } = ramps.ramp(
                &ramps.state_inward(start),
                ramps.inward(velocity, 1),
                heading,
                course,
            );
            let fits = spans.len() <= MAX_PIECES;
            let mut path = Path::new(order);
            let end = path.fill(start, limits.lower_acceleration(), ramps.scale().outward(&spans));
            path.pin(velocity);
            let arrives = is_there(&end, velocity, (start, limits, path.duration()));
            // A ramp from a viable state has no excess, as tests show, so it is not searched. A stop that is free
            // to turn has one because of the turn.
            let excess = if viable && (course == Course::Kept || velocity != 0.0) {
                None
            } else {
                excess::excess(&path, velocity, Some(heading), directed)
            };
            (path, steps, excess, fits, arrives)
        };
        // A goal on the other side of zero needs the turn that a stop must not make (O5). If a turn has more pieces
        // than a plan holds, or exceeds the velocity, the lower bound is used throughout (R11).
        let turned = (velocity * heading < 0.0).then(|| proposed(Course::Free));
        let (path, steps, excess, _, arrives) = turned
            .filter(|(_, _, excess, fits, arrives)| {
                *fits && *arrives && excess.is_none_or(|excess| excess.velocity == 0.0)
            })
            .unwrap_or_else(|| {
                let kept = proposed(Course::Kept);
                // A stop that must turn back turns once: a smaller turn would need two of them (R11a).
                let turns = velocity == 0.0
                    && kept.2.is_some()
                    && !kept.0.keeps_side(heading, unmoved(directed.lower_velocity()));
                let once = turns.then(|| proposed(Course::Free));
                once.filter(|(path, _, _, fits, arrives)| {
                    *fits && *arrives && path.duration() < kept.0.duration()
                })
                .unwrap_or(kept)
            });
        if !arrives {
            return Err(too_long);
        }
        let mut plan = Self {
            start: *start,
            carry: 0.0,
            goal: velocity,
            cycle,
            scans: scans(path.duration(), cycle).ok_or(too_long)?,
            steps,
            excess,
            path,
        };
        plan.excess = plan.excess_beyond(given);
        Ok(plan)
    }

    /// The same as [`RampPlan::new`], with one exception. If the rates of `limits`, once inside, would lead out of
    /// the velocity of both limits and those of `before` would not, the rates of `before` hold throughout.
    ///
    /// # Errors
    /// Those of [`RampPlan::new`].
    pub fn keeping_velocity(
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::keeping_velocities(start, velocity, &(*limits).into(), &(*before).into(), cycle)
    }

    /// The same as [`RampPlan::keeping_velocity`], with a velocity bound for each direction.
    ///
    /// # Errors
    /// Those of [`RampPlan::new`].
    pub fn keeping_velocities(
        start: &Setpoint,
        velocity: f64,
        limits: &DirectedLimits,
        before: &DirectedLimits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let plan = Self::by_direction(start, velocity, limits, before, cycle)?;
        let wider = limits.or_larger(before);
        let kept = DirectedLimits {
            limits: Limits {
                velocity: limits.limits.velocity,
                ..wider.limits
            },
            ..*limits
        };
        let leaves = |plan: &Self| plan.excess.is_some() && excess::leaves(&plan.path, velocity, &wider);
        if kept == *limits || !leaves(&plan) {
            return Ok(plan);
        }
        // Too late for the lower rates: the previous ones hold to the end if they keep the velocity.
        match Self::by_direction(start, velocity, &kept, before, cycle) {
            Ok(other) if !leaves(&other) => {
                let heading = heading(start, velocity, limits.lower_velocity(), limits.limits.order());
                let excess = excess::excess(&other.path, velocity, Some(heading), limits);
                Ok(Self { excess, ..other })
            }
            _ => Ok(plan),
        }
    }

    /// Number of scans until the goal velocity; 0 if the start has it.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// The set-point `scan` cycles after the start, evaluated in closed form from its piece.
    ///
    /// `scan` 0 is the start. From [`RampPlan::scans`] on the velocity is exactly the goal, the derivatives above
    /// it are 0, and a position at goal velocity 0 keeps its bits. In between, the highest derivative is the one in
    /// force just before the instant. At most 20 comparisons.
    pub fn at(&self, scan: u64) -> Setpoint {
        let time = scan as f64 * self.cycle;
        let running = if self.is_at_goal(scan) {
            None
        } else if scan == 0 {
            Some(self.start)
        } else {
            self.path.at(time)
        };
        running.unwrap_or_else(|| self.at_goal(scan))
    }

    /// The same as [`RampPlan::at`], for a motion in progress that is evaluated scan after scan: the piece is
    /// searched only where it changes.
    #[inline(always)]
    pub fn next(&mut self, scan: u64) -> Setpoint {
        if self.is_at_goal(scan) || scan == 0 {
            return self.at(scan);
        }
        match self.path.next(scan as f64 * self.cycle) {
            Some((state, _)) => state,
            None => self.at_goal(scan),
        }
    }

    /// Whether the goal velocity is reached at `scan`.
    #[inline]
    pub(crate) fn is_at_goal(&self, scan: u64) -> bool {
        scan >= u64::from(self.scans)
    }

    /// The set-point at a `scan` at which the goal velocity is reached.
    #[inline]
    pub(crate) fn at_goal(&self, scan: u64) -> Setpoint {
        Setpoint {
            position: self.end_position() + self.goal * (scan as f64 * self.cycle - self.duration()),
            velocity: self.goal,
            ..Setpoint::default()
        }
    }

    /// The same motion in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.start.position += by;
        self.path.shift(by);
    }

    /// The constant `velocity` (u/s) from `position` (u) on.
    pub(crate) fn cruising(position: f64, velocity: f64, order: Order, cycle: f64) -> Self {
        Self {
            start: Setpoint {
                velocity,
                ..Setpoint::at_rest(position)
            },
            carry: 0.0,
            goal: velocity,
            cycle,
            scans: 0,
            steps: 0,
            path: Path::follow(order, &Setpoint::default(), f64::INFINITY, core::iter::empty()),
            excess: None,
        }
    }

    /// If the goal velocity is reached at `scan`: makes `scan` the start of the same motion, and takes whole
    /// `length`s (u) off its position so that it starts within one. Returns their number.
    ///
    /// The new start is computed to about 106 bits, and the part that f64 does not hold is kept. So a motion that
    /// was brought back a thousand million times is at the same place as without.
    pub fn bring_back(&mut self, scan: u64, length: f64) -> Option<i64> {
        if scan < u64::from(self.scans) {
            return None;
        }
        let (time, time_error) = two_product(scan as f64, self.cycle);
        let (since, since_error) = two_sum(time, -self.duration());
        let (way, way_error) = two_product(self.goal, since);
        let way_error = way_error + self.goal * (time_error + since_error);
        let (position, position_error) = two_sum(self.end_position(), way);
        let (position, rest) = two_sum(position, position_error + way_error + self.carry);
        let (turns, _) = split(position, length);
        let (whole, whole_error) = two_product(turns as f64, length);
        let (position, error) = two_sum(position, -whole);
        let (position, carry) = two_sum(position, error + (rest - whole_error));
        *self = Self {
            carry,
            ..Self::cruising(position, self.goal, self.path.order(), self.cycle)
        };
        Some(turns)
    }

    /// The excess that the start state forced on the plan, if it is more than 1e-9 of the limits.
    pub const fn excess(&self) -> Option<Excess> {
        self.excess
    }

    /// The part of [`RampPlan::excess`] that is also beyond `limits`, which are no lower than those of the plan.
    ///
    /// The path is examined again: the difference of the limits is not enough if the velocity changes its sign and
    /// another bound holds on each side. Bounded by 20 pieces with at most two roots each.
    pub fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        self.excess_beyond(&(*limits).into())
    }

    fn excess_beyond(&self, limits: &DirectedLimits) -> Option<Excess> {
        self.excess?;
        let acting = limits.acting_for(&self.start, self.goal, 0.0, self.cycle);
        let heading = heading(&self.start, self.goal, acting.lower_velocity(), self.path.order());
        excess::excess(&self.path, self.goal, Some(heading), limits)
    }

    /// Time until the goal velocity (s), not rounded to scans.
    pub fn duration(&self) -> f64 {
        self.path.duration()
    }

    /// The goal velocity (u/s).
    pub const fn end_velocity(&self) -> f64 {
        self.goal
    }

    /// Position at the end of [`RampPlan::duration`] (u).
    pub fn end_position(&self) -> f64 {
        self.path.end_position().unwrap_or(self.start.position)
    }

    /// The stretches of constant highest derivative, in order of time.
    pub fn segments(&self) -> impl Iterator<Item = Segment> {
        self.path.segments()
    }

    /// The largest magnitudes of the continuous plan, in closed form.
    pub fn peaks(&self) -> Peaks {
        excess::peaks(&self.path, self.goal)
    }

    /// Steps of root finding for the plan, at most [`kernel::MAX_STEPS`](crate::kernel::MAX_STEPS).
    pub const fn steps(&self) -> u32 {
        self.steps
    }
}

/// The velocity (u/s) of `start` once its acceleration and jerk are zero, as soon as `limits` allow; its magnitude
/// is at most that of `limits`.
pub(crate) fn coasting(start: &Setpoint, limits: &Limits, cycle: f64) -> f64 {
    let acting = limits.acting_for(start, start.velocity, 0.0, cycle);
    let acting = acting.into();
    let velocity = Ramps::new(&acting, &acting).coasting(start);
    velocity.max(-limits.velocity).min(limits.velocity)
}

pub(crate) fn check(
    start: &Setpoint,
    velocity: f64,
    directed: &DirectedLimits,
    before: &DirectedLimits,
    cycle: f64,
) -> Result<(), PlanError> {
    let limits = &directed.limits;
    let invalid = |field, value| Err(PlanError::InvalidInput { field, value });
    check_positive(Field::Cycle, cycle)?;
    let finite = [
        (Field::Position, start.position),
        (Field::Velocity, start.velocity),
        (Field::Acceleration, start.acceleration),
        (Field::Jerk, start.jerk),
        (Field::EndVelocity, velocity),
        (Field::LimitAcceleration, limits.acceleration),
        (Field::LimitDeceleration, limits.deceleration),
    ];
    if let Some(&(field, value)) = finite.iter().find(|(_, value)| !value.is_finite()) {
        return invalid(field, value);
    }
    directed.check()?;
    before.check()?;
    if directed.outside(velocity) > 0.0 {
        return invalid(Field::EndVelocity, velocity);
    }
    Ok(())
}

/// Whether a ramp that ends in `end` reaches `velocity` except for rounding. With extremely low bounds, times
/// beyond the range of numbers leave out spans.
pub(crate) fn is_there(
    end: &Setpoint,
    velocity: f64,
    (start, limits, duration): (&Setpoint, &Limits, f64),
) -> bool {
    let steepest = limits
        .acceleration
        .max(limits.deceleration)
        .max(start.acceleration.abs());
    let changed = start.velocity.abs() + velocity.abs() + steepest * duration;
    (end.velocity - velocity).abs() <= ON_LIMIT * changed
}

/// The least whole number of cycles that covers `duration`, except for [`GRID_SLACK`]; none if it is too large.
pub(crate) fn scans(duration: f64, cycle: f64) -> Option<u32> {
    let exact = duration / cycle;
    let needed = exact - (exact * GRID_SLACK).min(SCAN_SLACK);
    if !(needed <= MAX_SCANS) {
        return None;
    }
    let whole = needed as u32;
    Some(whole + u32::from(f64::from(whole) < needed))
}
