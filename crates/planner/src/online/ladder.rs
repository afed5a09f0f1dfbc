//! The ladder: each candidate is verified against the true limits before it is taken.

use super::ends::{Ends, Wide};
use super::search::{Candidate, Search, Work};
use super::{MAX_PIECES, OnlinePlan, grid_from};
use crate::grid::GridPlan;
use crate::kernel::{NOISE, ON_LIMIT, Sides, Spans};
use crate::math::sqrt;
use crate::ramp::excess::{self, Excess};
use crate::ramp::path::Path;
use crate::ramp::solve::{RAMP_SPANS, Ramps, heading};
use crate::ramp::{is_there, scans};
use crate::{DirectedLimits, Limits, Order, PlanError, Setpoint};

/// Largest excess over a limit by the correction that closes a plan on its target: half of what the contract
/// permits.
const UNSEEN: f64 = 0.5e-9;

/// The method by which a plan was found, best first. A plan of a later rung is longer, not less exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    /// Push towards a velocity bound, then the fastest stop.
    PushThenStop,
    /// A ramp to a peak velocity and one from it.
    TwoPhase,
    /// Acceleration and jerk to zero, then push and stop.
    Arrest,
    /// To rest, then on from there: on the grid, or, with an end velocity, two ramps and a cruise. With an end
    /// velocity also the ramp to it and a cruise, if that leads to the target.
    Brake,
}

impl Rung {
    /// All rungs, in the order they are tried.
    pub const ALL: [Self; 4] = [Self::PushThenStop, Self::TwoPhase, Self::Arrest, Self::Brake];

    /// Name for traces and command lines.
    pub const fn name(self) -> &'static str {
        match self {
            Self::PushThenStop => "push-then-stop",
            Self::TwoPhase => "two-phase",
            Self::Arrest => "arrest",
            Self::Brake => "brake",
        }
    }
}

/// The parts of a plan beyond its path.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Tail {
    /// A grid plan after the brake, from the scan in which it begins.
    Grid { grid: GridPlan, begin: u32 },
    /// The scan in which it turns, and the position and acceleration there, both exactly.
    Turn {
        scan: u32,
        position: f64,
        acceleration: f64,
    },
}

impl Tail {
    /// The grid plan after the brake, and the scan in which it begins.
    pub(super) const fn grid(&self) -> Option<(&GridPlan, u32)> {
        match self {
            Self::Grid { grid, begin } => Some((grid, *begin)),
            Self::Turn { .. } => None,
        }
    }
}

/// A plan as found. It is large, so it is built in its final place.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) rung: Rung,
    /// Ramps solved.
    pub(super) solves: u32,
    /// Largest number of steps of one root.
    pub(super) steps: u32,
    /// Positions count from the start.
    pub(super) path: Path<MAX_PIECES>,
    /// The distance to the target that the rounding of the path leaves; it is spread over the whole plan (O9).
    pub(super) residual: f64,
    /// The residual moves no set-point by more than a unit in its last place from scan to scan.
    pub(super) is_rounding: bool,
    pub(super) tail: Option<Tail>,
    pub(super) excess: Option<Excess>,
}

impl Found {
    /// Nothing yet.
    pub(super) const fn nothing(order: Order) -> Self {
        Self {
            rung: Rung::PushThenStop,
            solves: 0,
            steps: 0,
            path: Path::new(order),
            residual: 0.0,
            is_rounding: true,
            tail: None,
            excess: None,
        }
    }

    /// Takes over the work of its search.
    pub(super) const fn count(&mut self, work: &Work) {
        (self.solves, self.steps) = (work.solves(), work.steps());
    }
}

/// A problem, its search, and the data for verifying a candidate.
struct Climb<'a> {
    search: Search<'a>,
    ramps: &'a Ramps,
    /// Start in the kernel's units, at position 0.
    inward: Setpoint,
    start: Setpoint,
    distance: f64,
    end_velocity: f64,
    end_acceleration: f64,
    cycle: f64,
    /// The largest distance (u) between positions of one scan that is rounding alone.
    resolved: f64,
    limits: &'a DirectedLimits,
    /// The unavoidable excess, once it was needed.
    unavoidable: Option<Excess>,
}

impl OnlinePlan {
    /// Finds the first candidate from rung `first` on that keeps the limits and arrives (O8), for an empty plan.
    /// Before its last ramp it goes for the velocity `top` of its direction.
    pub(super) fn climb(
        &mut self,
        first: Rung,
        top: Sides,
        limits: &DirectedLimits,
        wider: &DirectedLimits,
    ) -> Result<(), PlanError> {
        let Self {
            start,
            target,
            end_velocity,
            cycle,
            ref mut found,
            ..
        } = *self;
        let ramps = Ramps::new(limits, wider);
        let mut climb = Climb::new(&ramps, start, target, (end_velocity, 0.0), top, limits, cycle);
        for rung in Rung::ALL.into_iter().filter(|rung| *rung >= first) {
            let from = climb.inward;
            found.rung = rung;
            let is_plan = match rung {
                Rung::PushThenStop => match climb.search.profile(&from) {
                    Some(spans) => climb.verify(found, &spans),
                    None => {
                        let mut spans = Candidate::new();
                        climb.search.push_then_stop(&mut spans, &from);
                        climb.verify(found, &spans)
                    }
                },
                Rung::TwoPhase => climb.verify(found, &climb.search.two_phase(&from)),
                Rung::Arrest => climb.verify(found, &climb.search.arrest_then_push(&from)),
                Rung::Brake if end_velocity != 0.0 => {
                    let run_up = climb.search.rest_then_run_up(&from);
                    let straight = climb.search.ramp_then_cruise(&from);
                    let shorter = straight.filter(|spans| spans.duration() < run_up.duration());
                    shorter.is_some_and(|spans| climb.verify_straight(found, &spans))
                        || climb.verify(found, &run_up)
                }
                Rung::Brake => {
                    climb.brake_to_grid(found, start.position, target, cycle)?;
                    true
                }
            };
            if is_plan {
                found.count(&climb.search.work);
                return Ok(());
            }
            found.path = Path::new(ramps.order());
        }
        Err(PlanError::too_far(target))
    }

    /// The same as [`OnlinePlan::climb`], for a plan with an end acceleration: the shortest of the candidates that
    /// keep the limits and arrive.
    pub(super) fn climb_to_end(
        &mut self,
        top: Sides,
        limits: &DirectedLimits,
        wider: &DirectedLimits,
    ) -> Result<(), PlanError> {
        let Self {
            start,
            target,
            end_velocity,
            end_acceleration,
            cycle,
            ref mut found,
            ..
        } = *self;
        let ramps = &Ramps::new(limits, wider);
        let end = (end_velocity, end_acceleration);
        let mut climb = Climb::new(ramps, start, target, end, top, limits, cycle);
        let ends = Ends::new(
            ramps,
            ramps.inward(climb.distance, 0),
            (ramps.inward(end_velocity, 1), ramps.inward(end_acceleration, 2)),
            top.map(|top| ramps.inward(top, 1)),
            NOISE * ramps.inward(start.position.abs() + target.abs(), 0),
        );
        let from = climb.inward;
        let order = ramps.order();
        let mut best: Option<Found> = None;
        let take = |climb: &mut Climb<'_>, best: &mut Option<Found>, rung, spans: &Wide| {
            let mut found = Found::nothing(order);
            found.rung = rung;
            let duration = ramps
                .scale()
                .outward(spans)
                .fold(0.0, |sum, (time, _)| sum + time);
            let is_shorter = best.as_ref().is_none_or(|best| duration < best.path.duration());
            if is_shorter && climb.verify(&mut found, spans) {
                *best = Some(found);
            }
        };
        let is_steady = (order < Order::Four || from.jerk == 0.0)
            && (order < Order::Three || from.acceleration == 0.0)
            && limits.outside(start.velocity) <= 0.0;
        if is_steady {
            let mut spans = Wide::new();
            spans.extend(&ends.of_steady_start(&from));
            take(&mut climb, &mut best, Rung::PushThenStop, &spans);
        }
        for side in [1.0, -1.0] {
            ends.pushes(&from, side, |spans| {
                take(&mut climb, &mut best, Rung::PushThenStop, spans)
            });
        }
        take(&mut climb, &mut best, Rung::TwoPhase, &ends.two_phase(&from));
        take(&mut climb, &mut best, Rung::Arrest, &ends.arrest(&from));
        if best.is_none() {
            take(&mut climb, &mut best, Rung::Brake, &ends.rest_then_run_up(&from));
        }
        let Some(best) = best else {
            return Err(PlanError::too_far(target));
        };
        *found = best;
        found.count(&ends.work);
        Ok(())
    }

    /// Takes `spans` as the path to the target. The plan passes the target with this velocity and an acceleration
    /// against the motion, or, without velocity, turns there. Behind it the motion comes to rest. Returns whether
    /// the path arrives.
    pub(super) fn climb_to_brake(
        &mut self,
        ramps: &Ramps,
        spans: &Wide,
        (velocity, acceleration): (f64, f64),
        limits: &DirectedLimits,
    ) -> bool {
        let Self {
            start,
            target,
            cycle,
            ref mut found,
            ..
        } = *self;
        let top = Sides::both(limits.lower_velocity());
        let mut climb = Climb::new(ramps, start, target, (velocity, acceleration), top, limits, cycle);
        found.rung = Rung::TwoPhase;
        let side = (target - start.position).signum();
        let arrives = climb.verify(found, spans)
            && found.is_rounding
            && found.path.keeps_side(side, ON_LIMIT * limits.limits.velocity);
        let Some(scan) = scans(found.path.duration(), cycle).filter(|_| arrives) else {
            return false;
        };
        // After a passage between two scans, the next motion takes over up to one scan later.
        let held = if velocity == 0.0 { 0.0 } else { cycle };
        let mut spans = *spans;
        spans.push(ramps.scale().moments(held), 0.0);
        let released = Setpoint {
            velocity: ramps.inward(velocity + acceleration * held, 1),
            acceleration: ramps.inward(acceleration, 2),
            ..Setpoint::default()
        };
        let stop = climb.search.ramp(&released, 0.0);
        found.path = Path::new(ramps.order());
        let outward = ramps.scale().outward(&spans).chain(ramps.scale().outward(&stop));
        let bound = limits.limits.lower_acceleration();
        found.path.fill(&climb.start, bound, outward);
        found.path.pin(0.0);
        found.excess = excess::excess(&found.path, 0.0, None, limits);
        found.tail = (velocity == 0.0).then_some(Tail::Turn {
            scan,
            position: target,
            acceleration,
        });
        let rest = found.path.end_position().unwrap_or(0.0) + found.residual;
        let is_plan = spans.len() + stop.len() <= MAX_PIECES
            && found.excess.is_none_or(|excess| climb.is_unavoidable(&excess));
        self.target = start.position + rest;
        is_plan
    }
}

/// The excess of `spans` (seconds, highest derivative) from `start` over `limits`.
pub(super) fn excess_along(
    order: Order,
    start: &Setpoint,
    spans: impl Iterator<Item = (f64, f64)>,
    limits: &DirectedLimits,
) -> Option<Excess> {
    let path = Path::<MAX_PIECES>::follow(order, start, limits.limits.lower_acceleration(), spans);
    excess::excess(&path, 0.0, None, limits)
}

impl<'a> Climb<'a> {
    fn new(
        ramps: &'a Ramps,
        start: Setpoint,
        target: f64,
        (end_velocity, end_acceleration): (f64, f64),
        top: Sides,
        limits: &'a DirectedLimits,
        cycle: f64,
    ) -> Self {
        let origin = start.at_origin();
        let distance = target - start.position;
        let resolution = NOISE * ramps.inward(start.position.abs() + target.abs(), 0);
        Climb {
            search: Search::new(
                ramps,
                ramps.inward(distance, 0),
                ramps.inward(end_velocity, 1),
                top.map(|top| ramps.inward(top, 1)),
                resolution,
            ),
            ramps,
            inward: ramps.state_inward(&origin),
            start: origin,
            distance,
            end_velocity,
            end_acceleration,
            cycle,
            resolved: f64::EPSILON * (start.position.abs() + target.abs()),
            limits,
            unavoidable: None,
        }
    }

    /// Puts `candidate` into `found`. Returns whether it arrives and, except on the last rung, exceeds no more than
    /// is unavoidable.
    fn verify<const N: usize>(&mut self, found: &mut Found, candidate: &Spans<N>) -> bool {
        if candidate.len() > MAX_PIECES {
            return false;
        }
        let path = &mut found.path;
        let end = path.fill(
            &self.start,
            self.limits.limits.lower_acceleration(),
            self.ramps.scale().outward(candidate),
        );
        path.pin_both(self.end_velocity, self.end_acceleration);
        found.residual = self.distance - path.end_position().unwrap_or(0.0);
        let fastest = self.limits.limits.velocity;
        let duration = path.duration();
        let way = fastest.max(self.start.velocity.abs()) * duration;
        let arrives = found.residual.abs() <= ON_LIMIT * way + NOISE * self.distance.abs()
            && (end.velocity - self.end_velocity).abs() <= ON_LIMIT * fastest
            && (self.end_acceleration == 0.0 || self.accelerates(&end));
        let moving = scans(duration, self.cycle).map_or(0.0, f64::from);
        found.is_rounding = found.residual.abs() <= self.resolved * moving;
        if !arrives || !(found.is_rounding || self.closes_gently(found.residual, duration)) {
            return false;
        }
        found.excess = excess::excess(path, self.end_velocity, None, self.limits);
        // There is nothing after the last rung.
        found.rung == Rung::Brake || found.excess.is_none_or(|excess| self.is_unavoidable(&excess))
    }

    /// The same as [`Climb::verify`] for a candidate of the last rung that is followed by another one.
    fn verify_straight(&mut self, found: &mut Found, candidate: &Candidate) -> bool {
        let is_plan =
            self.verify(found, candidate) && found.excess.is_none_or(|excess| self.is_unavoidable(&excess));
        if !is_plan {
            found.path = Path::new(self.ramps.order());
        }
        is_plan
    }

    /// Whether a path that ends in `end` has the end acceleration and no jerk.
    fn accelerates(&self, end: &Setpoint) -> bool {
        let Limits {
            acceleration,
            deceleration,
            jerk,
            snap,
            ..
        } = self.limits.limits;
        let steepest = acceleration.max(deceleration);
        let jerk = jerk.min(sqrt(snap) * sqrt(steepest));
        (end.acceleration - self.end_acceleration).abs() <= ON_LIMIT * steepest
            && (self.ramps.order() < Order::Four || end.jerk.abs() <= ON_LIMIT * jerk)
    }

    /// Whether spreading `residual` (u) over `duration` (s) takes no more than an invisible part of each limit: the
    /// largest derivatives of the share (O9). Roots are not searched beyond the noise of their positions.
    fn closes_gently(&self, residual: f64, duration: f64) -> bool {
        let (limits, residual) = (&self.limits.limits, residual.abs());
        let square = duration * duration;
        residual <= NOISE / f64::EPSILON * self.resolved
            || (5.8 * residual <= UNSEEN * limits.lower_acceleration() * square
                && 60.0 * residual <= UNSEEN * limits.jerk * (square * duration)
                && 360.0 * residual <= UNSEEN * limits.snap * (square * square))
    }

    /// Whether an immediate stop, or getting inside the limits as soon as possible, exceeds the limits as much.
    fn is_unavoidable(&mut self, excess: &Excess) -> bool {
        let known = self.unavoidable.unwrap_or_else(|| self.least_excess());
        self.unavoidable = Some(known);
        let within = |value: f64, least: f64| value <= least * (1.0 + ON_LIMIT);
        within(excess.velocity, known.velocity)
            && within(excess.acceleration, known.acceleration)
            && within(excess.jerk, known.jerk)
    }

    fn least_excess(&self) -> Excess {
        let stop = self.search.whole_ramp(&self.inward, 0.0);
        let ramps = self.ramps;
        let side = -heading(&self.inward, 0.0, ramps.lower_velocity(), ramps.order());
        let back = side * ramps.velocity(side);
        let turn = self.search.whole_ramp(&self.inward, back);
        let one = self.excess_of(&stop.spans, stop.spans.len());
        let other = self.excess_of(&turn.spans, turn.lead);
        Excess {
            velocity: one.velocity.max(other.velocity),
            acceleration: one.acceleration.max(other.acceleration),
            jerk: one.jerk.max(other.jerk),
        }
    }

    /// The excess of the first `count` of `spans`.
    fn excess_of(&self, spans: &Spans<RAMP_SPANS>, count: usize) -> Excess {
        let spans = self.ramps.scale().outward(spans).take(count);
        excess_along(self.ramps.order(), &self.start, spans, self.limits).unwrap_or_default()
    }

    /// To rest, and from the next scan on a grid plan: a method that can't fail for lack of accuracy.
    fn brake_to_grid(
        &mut self,
        found: &mut Found,
        origin: f64,
        target: f64,
        cycle: f64,
    ) -> Result<(), PlanError> {
        let stop = self.search.ramp(&self.inward, 0.0);
        let path = &mut found.path;
        let end = path.fill(
            &self.start,
            self.limits.limits.lower_acceleration(),
            self.ramps.scale().outward(&stop),
        );
        path.pin(0.0);
        let rest = origin + path.end_position().unwrap_or(0.0);
        // Inputs are checked, so a grid plan is refused only for lengths and times beyond numbers.
        let too_long = PlanError::too_far(target);
        let limits = &self.limits.limits;
        if !is_there(&end, 0.0, (&self.start, limits, path.duration())) {
            return Err(too_long);
        }
        let begin = scans(path.duration(), cycle).ok_or(too_long)?;
        found.excess = excess::excess(path, 0.0, None, self.limits);
        found.residual = 0.0;
        found.is_rounding = true;
        let onwards = Limits {
            velocity: self.limits.velocity(target - rest),
            ..*limits
        };
        found.tail = Some(Tail::Grid {
            grid: grid_from(rest, target, &onwards, cycle).map_err(|_| too_long)?,
            begin,
        });
        Ok(())
    }
}
