//! The bounds that a plan keeps.

use crate::kernel::Sides;
use crate::math::sqrt;
use crate::{Field, PlanError, Setpoint};

/// The shortest part of a cycle in which a derivative reaches its bound: differences of set-points cannot
/// resolve a shorter one.
const SOONEST: f64 = 1.0 / 1024.0;

/// The largest number of scans in which it reaches its bound: no plan has more.
const LATEST: f64 = 2_147_483_648.0;

/// While the velocity goes from one bound to the other, the acceleration rises and falls with at most the jerk
/// bound. So it stays below this factor times the square root of jerk bound times velocity bound. The same holds
/// for the jerk, with the bounds of snap and acceleration.
const REACHED: f64 = 4.0;

/// The largest ratio of the velocity bound to the speed a motion may reach.
pub(crate) const REACH: f64 = 64.0;

/// Largest magnitudes a plan may use; `f64::INFINITY` means no bound.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limits {
    /// Velocity (u/s).
    pub velocity: f64,
    /// Acceleration while the speed grows (u/s^2).
    pub acceleration: f64,
    /// Acceleration while the speed falls (u/s^2).
    pub deceleration: f64,
    /// Jerk (u/s^3).
    pub jerk: f64,
    /// Snap (u/s^4).
    pub snap: f64,
}

/// Bounds with a separate velocity bound for each direction.
///
/// A move beside a moving line needs them: beside a line of velocity `v`, 0 or more, an axis with
/// velocity bound `V` has `V - v` left forwards and `V + v` backwards.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DirectedLimits {
    /// Velocity towards larger positions (u/s), above 0; `f64::INFINITY` means no bound.
    pub positive: f64,
    /// The same towards smaller positions, as a magnitude.
    pub negative: f64,
    /// All other bounds; its velocity is not used.
    pub limits: Limits,
}

impl From<Limits> for DirectedLimits {
    /// The same velocity in both directions.
    fn from(limits: Limits) -> Self {
        Self {
            positive: limits.velocity,
            negative: limits.velocity,
            limits,
        }
    }
}

impl DirectedLimits {
    /// The bounds without a direction: the velocity is the larger one of both.
    pub fn either(&self) -> Limits {
        let velocity = if self.positive >= self.negative {
            self.positive
        } else {
            self.negative
        };
        Limits {
            velocity,
            ..self.limits
        }
    }

    /// The velocities of both directions (u/s).
    pub(crate) const fn sides(&self) -> Sides {
        Sides {
            minus: self.negative,
            plus: self.positive,
        }
    }

    /// The lower one of both velocities (u/s).
    pub(crate) const fn lower_velocity(&self) -> f64 {
        self.sides().lower()
    }

    /// The bound of a velocity with the sign of `side`.
    pub(crate) const fn velocity(&self, side: f64) -> f64 {
        self.sides().towards(side)
    }

    /// The excess of a velocity over its bound (u/s); negative inside.
    pub(crate) fn outside(&self, velocity: f64) -> f64 {
        velocity.abs() - self.velocity(velocity)
    }

    /// The same as [`Limits::or_larger`].
    pub fn or_larger(&self, before: &Self) -> Self {
        Self {
            positive: larger(self.positive, before.positive),
            negative: larger(self.negative, before.negative),
            limits: self.limits.or_larger(&before.limits),
        }
    }

    /// The same as [`Limits::acting_for`].
    pub(crate) fn acting_for(&self, start: &Setpoint, end: f64, distance: f64, cycle: f64) -> Self {
        let given = self.either();
        let limits = given.acting_for(start, end, distance, cycle);
        let side = |side: f64| {
            if side >= given.velocity {
                limits.velocity
            } else {
                side.min(limits.velocity).max(f64::MIN_POSITIVE)
            }
        };
        Self {
            positive: side(self.positive),
            negative: side(self.negative),
            limits,
        }
    }

    /// The same as [`Limits::check`].
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] names the first bound that is NaN, zero or negative.
    pub fn check(&self) -> Result<(), PlanError> {
        let sides = [
            (Field::VelocityLimitPositive, self.positive),
            (Field::VelocityLimitNegative, self.negative),
        ];
        for (field, value) in sides {
            if !(value > 0.0) && self.positive.to_bits() != self.negative.to_bits() {
                return Err(PlanError::InvalidInput { field, value });
            }
        }
        self.either().check()
    }
}

/// The larger one of a pair; an infinite bound of `old` is ignored.
fn larger(new: f64, old: f64) -> f64 {
    if old.is_finite() && old > new { old } else { new }
}

/// The highest derivative of position that stays finite: the smoothness of a plan.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Order {
    /// Acceleration jumps (no jerk and no snap bound).
    Two,
    /// Jerk jumps (no snap bound).
    Three,
    /// Snap jumps.
    Four,
}

impl Order {
    /// The order as a number: 2, 3 or 4.
    pub const fn degree(self) -> usize {
        match self {
            Self::Two => 2,
            Self::Three => 3,
            Self::Four => 4,
        }
    }
}

impl Limits {
    /// No bound at all.
    pub const NONE: Self = Self {
        velocity: f64::INFINITY,
        acceleration: f64::INFINITY,
        deceleration: f64::INFINITY,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    };

    /// The order of plans under these bounds: 4 with a snap bound, else 3 with a jerk bound, else 2.
    pub const fn order(&self) -> Order {
        if self.snap.is_finite() {
            Order::Four
        } else if self.jerk.is_finite() {
            Order::Three
        } else {
            Order::Two
        }
    }

    /// The lower one of acceleration and deceleration (u/s^2).
    pub const fn lower_acceleration(&self) -> f64 {
        if self.acceleration <= self.deceleration {
            self.acceleration
        } else {
            self.deceleration
        }
    }

    /// The same with another velocity (u/s).
    #[inline]
    #[must_use]
    pub const fn with_velocity(&self, velocity: f64) -> Self {
        Self { velocity, ..*self }
    }

    /// The larger one of each finite pair; an infinite bound of `before` is ignored, and that of these
    /// limits stays.
    pub fn or_larger(&self, before: &Self) -> Self {
        Self {
            velocity: larger(self.velocity, before.velocity),
            acceleration: larger(self.acceleration, before.acceleration),
            deceleration: larger(self.deceleration, before.deceleration),
            jerk: larger(self.jerk, before.jerk),
            snap: larger(self.snap, before.snap),
        }
    }

    /// The smaller one of each pair.
    pub fn or_smaller(&self, other: &Self) -> Self {
        let smaller = |one: f64, other: f64| if other < one { other } else { one };
        Self {
            velocity: smaller(self.velocity, other.velocity),
            acceleration: smaller(self.acceleration, other.acceleration),
            deceleration: smaller(self.deceleration, other.deceleration),
            jerk: smaller(self.jerk, other.jerk),
            snap: smaller(self.snap, other.snap),
        }
    }

    /// Each of them times `factor`, and at most the largest number, so that a finite one stays finite.
    pub fn times(&self, factor: f64) -> Self {
        self.map(|bound| bound * factor)
    }

    /// Each of them divided by `divisor`, and at most the largest number, so that a finite one stays
    /// finite.
    pub fn over(&self, divisor: f64) -> Self {
        self.map(|bound| bound / divisor)
    }

    fn map(&self, change: impl Fn(f64) -> f64) -> Self {
        let changed = |bound: f64| {
            if bound.is_finite() {
                change(bound).min(f64::MAX)
            } else {
                bound
            }
        };
        Self {
            velocity: changed(self.velocity),
            acceleration: changed(self.acceleration),
            deceleration: changed(self.deceleration),
            jerk: changed(self.jerk),
            snap: changed(self.snap),
        }
    }

    /// The bounds that a plan with sample time `cycle` (s) uses: these, but lowered if a bound is so high
    /// that it limits nothing (docs/planner.md, eq. 39).
    ///
    /// The order does not change: an infinite bound stays infinite. If these limits are larger than
    /// others, the bounds used are not lower than theirs.
    pub fn acting(&self, cycle: f64) -> Self {
        let (soonest, latest) = (SOONEST * cycle, LATEST * cycle);
        // In the longest plan no derivative can exceed this.
        let jerk = self.jerk.min(self.snap * latest);
        let highest = jerk * latest;
        let higher = self.acceleration.max(self.deceleration).min(highest);
        let velocity = self.velocity.min(higher * latest);
        // None needs to reach its bound in a shorter time, or to exceed what the bounds of the derivative
        // it changes permit.
        let highest = highest
            .min(velocity / soonest)
            .min(REACHED * sqrt(jerk) * sqrt(velocity));
        let acceleration = self.acceleration.min(highest);
        let deceleration = self.deceleration.min(highest);
        let higher = acceleration.max(deceleration);
        let jerk = jerk
            .min(higher / soonest)
            .min(REACHED * sqrt(self.snap) * sqrt(higher));
        let snap = self.snap.min(jerk / soonest);
        let acting = |given: f64, used: f64| {
            if given.is_finite() {
                used.max(f64::MIN_POSITIVE)
            } else {
                given
            }
        };
        Self {
            velocity: acting(self.velocity, velocity),
            acceleration: acting(self.acceleration, acceleration),
            deceleration: acting(self.deceleration, deceleration),
            jerk: acting(self.jerk, jerk),
            snap: acting(self.snap, snap),
        }
    }

    /// The same as [`Limits::acting`] for one motion. It begins in `start`, ends with the speed `end`
    /// (u/s), and if it goes to a position, is `distance` (u) from it. Speeds are judged relative to the
    /// velocity bound. So a velocity bound far above the speeds of the motion is lowered to [`REACH`]
    /// times the speed it may reach (docs/planner.md, eq. 40).
    pub(crate) fn acting_for(&self, start: &Setpoint, end: f64, distance: f64, cycle: f64) -> Self {
        let acting = self.acting(cycle);
        let fastest = start.velocity.abs().max(end.abs());
        // Then it certainly reaches a speed that the bound is not far above.
        let lower = acting.acceleration.min(acting.deceleration);
        let (part, way) = (self.velocity / (0.5 * REACH), distance.abs());
        if 2.0 * fastest >= part || (way > part * SOONEST * cycle && 4.0 * lower * way > part * part) {
            return acting;
        }
        let Self { jerk, snap, .. } = acting;
        // The time until acceleration and jerk are zero.
        let rising = start.jerk.abs() / snap;
        let steepest = start.acceleration.abs() + 0.5 * start.jerk.abs() * rising;
        let settled = rising + steepest / jerk + 2.0 * sqrt(steepest / snap);
        let speed = fastest + steepest * settled;
        // The time until it could be at rest, and from there to the position.
        let stopped = speed / lower + 2.0 * sqrt(speed / jerk) + 2.0 * sqrt(lower / snap);
        let way = distance.abs() + speed * (settled + stopped);
        let reached = speed + (2.0 * sqrt(lower) * sqrt(way)).min(way / (SOONEST * cycle));
        let reached = if distance == 0.0 { speed } else { reached };
        // A state of almost no speed may settle before any bound is reached. Then the bounds that follow
        // from the speed are not below the state's own acceleration and jerk.
        let soonest = SOONEST * cycle;
        let least = soonest * (steepest + soonest * start.jerk.abs());
        let velocity = REACH * reached.max(least);
        if reached > 0.0 && velocity < self.velocity {
            Self { velocity, ..*self }.acting(cycle)
        } else {
            acting
        }
    }

    /// Whether no bound is given at all.
    pub const fn is_unbounded(&self) -> bool {
        self.velocity.is_infinite()
            && self.lower_acceleration().is_infinite()
            && self.jerk.is_infinite()
            && self.snap.is_infinite()
    }

    /// Checks that every bound is positive and none is NaN.
    ///
    /// # Errors
    /// [`PlanError::InvalidInput`] names the first bound that is NaN, zero or negative.
    pub const fn check(&self) -> Result<(), PlanError> {
        let bounds = self.named();
        let mut index = 0;
        while index < bounds.len() {
            let (field, value) = bounds[index];
            if !(value > 0.0) {
                return Err(PlanError::InvalidInput { field, value });
            }
            index += 1;
        }
        Ok(())
    }

    /// The bounds with their names.
    pub(crate) const fn named(&self) -> [(Field, f64); 5] {
        [
            (Field::LimitVelocity, self.velocity),
            (Field::LimitAcceleration, self.acceleration),
            (Field::LimitDeceleration, self.deceleration),
            (Field::LimitJerk, self.jerk),
            (Field::LimitSnap, self.snap),
        ]
    }
}
