//! Moves that pass their target with a wanted speed, or the nearest there is without turning.
//!
//! What stands here: the choice of that speed, and the largest one the next move can begin with. What does
//! not: buffer modes, queues, which velocity is wanted. Equations (O11) to (O13) are in
//! `docs/planner-online.md`.

use super::search::{Search, follow};
use super::{OnlinePlan, Rung, check};
use crate::kernel::{NOISE, ON_LIMIT, Point, Sides, zero};
use crate::ramp::solve::{Course, Ramps, heading};
use crate::{Limits, PlanError, Setpoint};

/// How far a speed on the border of what can be reached is moved inside until a plan agrees, as parts of the
/// way to the speed that certainly can be.
const INSIDE: [f64; 5] = [0.0, 1e-12, 1e-9, 1e-6, 1.0];

/// How a target is to be passed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// The speed towards the target to pass it with (u/s), 0 or more.
    pub wanted: f64,
    /// The speed from which what comes after the target can still be done (u/s); exceeded only if every way
    /// without turning exceeds it.
    pub most: f64,
    /// The acceleration (u/s^2) against the way to pass it with; below 0 it speeds up. Without a wanted speed the move turns there, with
    /// one above 0.
    pub brake: f64,
}

impl Passage {
    /// At rest.
    pub const REST: Self = Self {
        wanted: 0.0,
        most: 0.0,
        brake: 0.0,
    };

    /// Whether the target is neither passed nor turned at.
    pub fn rests(&self) -> bool {
        self.wanted <= 0.0 && self.brake <= 0.0
    }
}

impl OnlinePlan {
    /// Passes `target` with the speed of `passage`, or with the nearest one that needs no overshoot and no
    /// reversal; `None` if there is none but zero, or if the start is on the target.
    ///
    /// A motion away from the target turns first, as soon as it can. The velocity of `limits` is what the
    /// move keeps on its way; a larger speed at the target is reached with the last ramp, not before.
    /// Everything else as in [`OnlinePlan::passing`], which is what the plan is.
    ///
    /// The nearest speed is found so: the wanted one is tried. Failing that, the one at which the ramp alone
    /// ends on the target, between the wanted one and the one the start comes to when its acceleration goes
    /// to zero (O11). If that is faster than wanted, because the braking comes late, a slower one is looked
    /// for in the same way between zero and the wanted one (O12), and the nearer of the two is taken.
    ///
    /// Bounded work: one plan, in the worst case eleven and two roots of ramps.
    ///
    /// # Errors
    /// As [`OnlinePlan::passing`].
    pub fn blending(
        start: &Setpoint,
        target: f64,
        passage: &Passage,
        limits: &Limits,
        before: &Limits,
        cycle: f64,
    ) -> Result<Option<Self>, PlanError> {
        let distance = target - start.position;
        let wanted = passage.wanted;
        check(start, target, 0.0, &(*limits).into(), &(*before).into(), cycle)?;
        let limits = &limits.acting(cycle);
        if distance == 0.0 {
            return Ok(None);
        }
        let side = if distance < 0.0 { -1.0 } else { 1.0 };
        // One velocity for all speeds tried, so that a start faster than the limit is not brought inside first
        // for one and not for another: the push goes for the limit anyway. Faster than what held before is no
        // start that comes from inside.
        let directed = &(*limits).into();
        let ramps = Ramps::new(directed, directed);
        let arrested = side * ramps.arrested(&ramps.state_inward(start)) / ramps.inward(1.0, 1);
        let raised = Limits {
            velocity: limits.velocity.max(wanted).max(arrested.min(before.velocity)),
            ..*limits
        };
        let wider = raised.or_larger(before).acting(cycle);
        let ramps = Ramps::new(&raised.into(), &wider.into());
        let way = Way {
            start,
            target,
            side,
            top: limits.velocity,
            raised: &raised,
            before,
            cycle,
            ramps: &ramps,
        };
        if let Some(plan) = way.with(wanted)? {
            return Ok(Some(plan));
        }
        let arrested = arrested.max(0.0);
        let fast = match way.search().speed_on_target(
            &way.inward(),
            way.side,
            ramps.inward(arrested, 1),
            ramps.inward(wanted, 1),
        ) {
            Some(border) => way.near(way.outward(border), arrested)?,
            None => None,
        };
        if arrested <= wanted {
            return Ok(fast);
        }
        let slow = way.below(wanted)?;
        Ok(match (slow, fast) {
            (Some(slow), Some(fast)) => {
                let (below, above) = (slow.end_velocity.abs(), fast.end_velocity.abs());
                let nearer = above <= passage.most && above - wanted < wanted - below;
                Some(if nearer { fast } else { slow })
            }
            (slow, fast) => slow.or(fast),
        })
    }
}

/// A target to pass.
struct Way<'a> {
    start: &'a Setpoint,
    target: f64,
    side: f64,
    top: f64,
    raised: &'a Limits,
    before: &'a Limits,
    cycle: f64,
    ramps: &'a Ramps,
}

impl Way<'_> {
    /// The plan that passes with `speed`, if it goes no way that it need not go: `None` where the ramp alone leads beyond the target.
    fn with(&self, speed: f64) -> Result<Option<OnlinePlan>, PlanError> {
        let limits = self.raised;
        let inward = self.ramps.inward(speed, 1);
        if !self.search().ends_short(&self.inward(), self.side, inward) {
            return Ok(None);
        }
        let plan = OnlinePlan::cruising(
            Rung::PushThenStop,
            self.start,
            self.target,
            self.side * speed,
            Sides::both(self.top),
            &(*limits).into(),
            &(*self.before).into(),
            self.cycle,
        )?;
        // A push towards the target turns only what has to be turned; any other may not turn at all.
        let small = ON_LIMIT * limits.velocity;
        let straight = || plan.found.tail.is_none() && plan.found.path.keeps_side(self.side, small);
        let pushes = plan.found.rung == Rung::PushThenStop;
        Ok((pushes || straight()).then_some(plan))
    }

    /// As [`Way::with`] for a speed on the `border` of what can be reached, moved towards `inside` if it must.
    fn near(&self, border: f64, inside: f64) -> Result<Option<OnlinePlan>, PlanError> {
        for part in INSIDE {
            if let Some(plan) = self.with(border + (inside - border) * part)? {
                return Ok(Some(plan));
            }
        }
        Ok(None)
    }

    /// The largest speed below `wanted` from zero on, if the start can come to rest before the target: the one at which the ramp alone ends
    /// on it (O12).
    fn below(&self, wanted: f64) -> Result<Option<OnlinePlan>, PlanError> {
        let far = self.ramps.inward(wanted, 1);
        let border = self.search().speed_on_target(&self.inward(), self.side, 0.0, far);
        match border {
            Some(border) => self.near(self.outward(border), 0.0),
            // What comes to rest on the target to the last digit brackets nothing.
            None => self.with(0.0),
        }
    }

    /// A search for ramps that end on the target, in the kernel's units.
    fn search(&self) -> Search<'_> {
        let distance = self.ramps.inward(self.target - self.start.position, 0);
        let added_up = self.start.position.abs() + self.target.abs();
        let resolution = NOISE * self.ramps.inward(added_up, 0);
        let top = Sides::both(self.ramps.velocity(self.side));
        Search::new(self.ramps, distance, 0.0, top, resolution)
    }

    /// The start in the kernel's units, at position 0.
    fn inward(&self) -> Setpoint {
        let origin = Setpoint {
            position: 0.0,
            ..*self.start
        };
        self.ramps.state_inward(&origin)
    }

    /// A speed out of the kernel's units (u/s).
    fn outward(&self, speed: f64) -> f64 {
        speed / self.ramps.inward(1.0, 1)
    }
}

/// The largest speed (u/s), `wanted` at most, at which a move over `distance` (u, 0 or more) can begin, one
/// scan of that speed late, and still come down to the speed `exit` at its end without overshoot (O13).
///
/// `limits` are those of the move, and hold alone: what it takes over from may allow more, but helps a slower
/// start less than a faster one. Every move takes two scans at least: the speed is at most half of
/// `distance / cycle`.
///
/// With a `brake` above 0 (u/s^2) the move begins slowing down with that acceleration, and the speed is 0 if there is none at which it
/// can without turning.
///
/// Bounded work: one ramp if `wanted` will do, else two roots of ramps.
pub fn entry_speed(wanted: f64, brake: f64, distance: f64, exit: f64, limits: &Limits, cycle: f64) -> f64 {
    let wanted = wanted.min(0.5 * distance / cycle);
    if wanted <= exit {
        return wanted;
    }
    let limits = Limits {
        velocity: limits.velocity.max(wanted),
        ..*limits
    }
    .acting(cycle)
    .into();
    let ramps = Ramps::new(&limits, &limits);
    let way = ramps.inward(distance, 0);
    let beyond = |speed: f64, exit: f64| {
        let goal = ramps.inward(exit, 1);
        let start = Setpoint {
            velocity: ramps.inward(speed, 1),
            acceleration: -ramps.inward(brake, 2),
            ..Setpoint::default()
        };
        let heading = heading(&start, goal, ramps.lower_velocity(), ramps.order());
        let ramp = ramps.ramp(&start, goal, heading, Course::Free);
        let end = follow(&ramps, &start, &ramp.spans).position;
        Point {
            at: speed,
            value: end + ramps.inward(speed * cycle, 0) - way,
            noise: NOISE * way,
            slope: f64::NAN,
        }
    };
    let released = ramps.coasting(&Setpoint {
        acceleration: brake,
        ..Setpoint::default()
    });
    let down_to = |exit: f64| {
        let fastest = beyond(wanted, exit);
        if fastest.value <= 0.0 {
            return wanted;
        }
        let slowest = beyond(exit + released, exit);
        if slowest.at > wanted || slowest.value > 0.0 {
            return if brake > 0.0 { 0.0 } else { exit };
        }
        zero(slowest, fastest, |speed| beyond(speed, exit)).0.at
    };
    let entry = down_to(exit);
    // To brake less takes more way where jerk and snap bind, so coming to rest may be shorter.
    if entry >= wanted || exit == 0.0 || beyond(entry, 0.0).value >= 0.0 {
        return entry;
    }
    entry.max(down_to(0.0))
}
