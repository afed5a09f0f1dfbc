//! Moves that pass their target with a wanted speed, or with the nearest one that is possible without turning.
//!
//! This module chooses that speed, and the largest speed with which the next move can begin. It does not have
//! buffer modes or queues, and does not choose the wanted velocity. Equations (O11) to (O13) are in
//! `docs/planner-online.md`.

use super::search::{Search, follow};
use super::{OnlinePlan, Rung, check};
use crate::kernel::{NOISE, ON_LIMIT, Point, Sides, zero};
use crate::ramp::solve::Ramps;
use crate::{Limits, PlanError, Setpoint};

/// A speed on the border of what can be reached is moved inside until a plan accepts it. These are the tried parts
/// of the distance to a speed that certainly can be reached.
const INSIDE: [f64; 5] = [0.0, 1e-12, 1e-9, 1e-6, 1.0];

/// How to pass a target.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Passage {
    /// The speed towards the target at which to pass it (u/s), 0 or more.
    pub wanted: f64,
    /// The speed from which the motion behind the target is still possible (u/s). It is exceeded only if every path
    /// without turning exceeds it.
    pub most: f64,
    /// The acceleration (u/s^2) against the direction of motion with which to pass it; below 0 it speeds up. If no
    /// speed is wanted and it is above 0, the move turns at the target.
    pub brake: f64,
}

impl Passage {
    /// At rest.
    pub const REST: Self = Self {
        wanted: 0.0,
        most: 0.0,
        brake: 0.0,
    };

    /// Whether the move neither passes the target nor turns there.
    pub fn rests(&self) -> bool {
        self.wanted <= 0.0 && self.brake <= 0.0
    }
}

impl OnlinePlan {
    /// Passes `target` with the speed of `passage`, or with the nearest one that needs no overshoot and no
    /// reversal. `None` if there is none but zero, or if the start is on the target.
    ///
    /// A motion away from the target turns first, as soon as it can. The move keeps the velocity of `limits`; a
    /// larger speed at the target is reached with the last ramp, not before. In all other respects the plan is that
    /// of [`OnlinePlan::passing`].
    ///
    /// The search for the nearest speed first tries the wanted one. If that fails, it takes the speed at which the
    /// ramp alone ends on the target. This speed is between the wanted one and the one that the start reaches when
    /// its acceleration goes to zero (O11). If it is above the wanted one, because the braking comes late, a slower
    /// one is searched in the same way between zero and the wanted one (O12), and the nearer of the two is taken.
    ///
    /// Bounded work: one plan, in the worst case eleven and two roots of ramps.
    ///
    /// # Errors
    /// Those of [`OnlinePlan::passing`].
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
        // One velocity bound for all tried speeds. Otherwise a start faster than the limit would be brought inside
        // first for one speed and not for another; the push goes for the limit anyway. The speed that the acceleration
        // at the start adds beyond the previous limit does not come from inside.
        let directed = &(*limits).into();
        let ramps = Ramps::new(directed, directed);
        let arrested = side * ramps.arrested(&ramps.state_inward(start)) / ramps.inward(1.0, 1);
        let held = before.velocity.max(side * start.velocity);
        let raised = Limits {
            velocity: limits.velocity.max(wanted).max(arrested.min(held)),
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

/// The path to a target that is passed.
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
    /// The plan that passes with `speed`, if it makes no unnecessary detour. `None` if the ramp alone ends beyond
    /// the target.
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
        // A push towards the target turns only a motion that must turn; any other may not turn at all.
        let small = ON_LIMIT * limits.velocity;
        let straight = || plan.found.tail.is_none() && plan.found.path.keeps_side(self.side, small);
        let pushes = plan.found.rung == Rung::PushThenStop;
        Ok((pushes || straight()).then_some(plan))
    }

    /// The same as [`Way::with`] for a speed on the `border` of what can be reached, which may be moved towards
    /// `inside`.
    fn near(&self, border: f64, inside: f64) -> Result<Option<OnlinePlan>, PlanError> {
        for part in INSIDE {
            if let Some(plan) = self.with(border + (inside - border) * part)? {
                return Ok(Some(plan));
            }
        }
        Ok(None)
    }

    /// The largest speed from zero up to `wanted`, if the start can come to rest before the target: the speed at
    /// which the ramp alone ends on the target (O12).
    fn below(&self, wanted: f64) -> Result<Option<OnlinePlan>, PlanError> {
        let far = self.ramps.inward(wanted, 1);
        let border = self.search().speed_on_target(&self.inward(), self.side, 0.0, far);
        match border {
            Some(border) => self.near(self.outward(border), 0.0),
            // A stop that ends exactly on the target gives no bracket.
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
        self.ramps.state_inward(&self.start.at_origin())
    }

    /// Converts a speed from the kernel's units (u/s).
    fn outward(&self, speed: f64) -> f64 {
        speed / self.ramps.inward(1.0, 1)
    }
}

/// The largest speed (u/s), at most `wanted`, at which a move over `distance` (u, 0 or more) can begin, one scan of
/// that speed late, and still slow down to the speed `exit` at its end without overshoot (O13).
///
/// `limits` are those of the move, and only they count: the previous motion may allow more, but that helps a slower
/// start less than a faster one. Every move takes at least two scans, so the speed is at most half of `distance /
/// cycle`.
///
/// With a `brake` above 0 (u/s^2) the move begins while slowing down with that acceleration. The speed is 0 if no
/// speed permits this without turning.
///
/// Bounded work: one ramp if `wanted` is possible, otherwise two roots of ramps.
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
        let end = follow(&ramps, &start, &ramps.freely(&start, goal)).position;
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
    // Softer braking takes more distance where jerk and snap are bounded, so coming to rest may be shorter.
    if entry >= wanted || exit == 0.0 || beyond(entry, 0.0).value >= 0.0 {
        return entry;
    }
    entry.max(down_to(0.0))
}
