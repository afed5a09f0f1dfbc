//! The ladder: each candidate is verified against the true limits before it is taken.

use super::search::Search;
use super::{MAX_PIECES, OnlinePlan, grid_from};
use crate::grid::GridPlan;
use crate::kernel::{NOISE, ON_LIMIT, Spans};
use crate::ramp::excess::{self, Excess};
use crate::ramp::path::Path;
use crate::ramp::solve::{RAMP_SPANS, Ramps};
use crate::ramp::{is_there, scans};
use crate::{Field, Limits, Order, PlanError, Setpoint};

/// By how much a limit may be exceeded by what closes a plan on its target: half of what the contract grants.
const UNSEEN: f64 = 0.5e-9;

/// The way a plan was found, best first. A plan of a later rung is longer, not less exact.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Rung {
    /// Push towards a velocity bound, then the fastest stop.
    PushThenStop,
    /// A ramp to a peak velocity and one from it.
    TwoPhase,
    /// Acceleration and jerk to zero, then push and stop.
    Arrest,
    /// To rest, then on from there: on the grid, or, with an end velocity, two ramps and a cruise.
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

/// A grid plan after the brake.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Tail {
    pub(super) grid: GridPlan,
    /// The scan it begins with.
    pub(super) begin: u32,
}

/// A plan as found. It is large, so it is made where it is to stay.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Found {
    pub(super) rung: Rung,
    /// Ramps solved.
    pub(super) solves: u32,
    /// Most steps of one root.
    pub(super) steps: u32,
    /// Positions count from the start.
    pub(super) path: Path<MAX_PIECES>,
    /// What the rounding of the path leaves to the target; it is spread over the whole plan (O9).
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
}

/// A problem, its search, and what verifies a candidate.
struct Climb<'a> {
    search: Search<'a>,
    ramps: &'a Ramps,
    /// Start in the kernel's units, at position 0.
    inward: Setpoint,
    start: Setpoint,
    distance: f64,
    end_velocity: f64,
    cycle: f64,
    /// How far apart (u) the positions of a scan may be for rounding alone.
    resolved: f64,
    limits: &'a Limits,
    /// What can't be avoided, once it had to be known.
    unavoidable: Option<Excess>,
}

impl OnlinePlan {
    /// Finds the first candidate from rung `first` on that keeps the limits and arrives (O8), for a plan of
    /// which nothing is found yet; before its last ramp it goes for the velocity `top`.
    pub(super) fn climb(
        &mut self,
        first: Rung,
        top: f64,
        limits: &Limits,
        wider: &Limits,
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
        let origin = Setpoint {
            position: 0.0,
            ..start
        };
        let distance = target - start.position;
        let resolution = NOISE * ramps.inward(start.position.abs() + target.abs(), 0);
        let mut climb = Climb {
            search: Search::new(
                &ramps,
                ramps.inward(distance, 0),
                ramps.inward(end_velocity, 1),
                ramps.inward(top, 1),
                resolution,
            ),
            ramps: &ramps,
            inward: ramps.state_inward(&origin),
            start: origin,
            distance,
            end_velocity,
            cycle,
            resolved: f64::EPSILON * (start.position.abs() + target.abs()),
            limits,
            unavoidable: None,
        };
        for rung in Rung::ALL.into_iter().filter(|rung| *rung >= first) {
            let from = climb.inward;
            found.rung = rung;
            let is_plan = match rung {
                Rung::PushThenStop => match climb.search.profile(&from) {
                    Some(spans) => climb.verify(found, &spans),
                    None => climb.verify(found, &climb.search.push_then_stop(&from)),
                },
                Rung::TwoPhase => climb.verify(found, &climb.search.two_phase(&from)),
                Rung::Arrest => climb.verify(found, &climb.search.arrest_then_push(&from)),
                Rung::Brake if end_velocity != 0.0 => {
                    climb.verify(found, &climb.search.rest_then_run_up(&from))
                }
                Rung::Brake => {
                    climb.brake_to_grid(found, start.position, target, cycle)?;
                    true
                }
            };
            if is_plan {
                found.solves = climb.search.solves();
                found.steps = climb.search.steps();
                return Ok(());
            }
            found.path = Path::new(ramps.order());
        }
        Err(PlanError::TooLong {
            field: Field::Target,
            value: target,
        })
    }
}

impl Climb<'_> {
    /// Lays `candidate` into `found`; whether it arrives and, but on the last rung, exceeds no more than what
    /// can't be avoided.
    fn verify<const N: usize>(&mut self, found: &mut Found, candidate: &Spans<N>) -> bool {
        if candidate.len() > MAX_PIECES {
            return false;
        }
        let path = &mut found.path;
        let end = path.fill(
            &self.start,
            self.limits.lower_acceleration(),
            self.ramps.scale().outward(candidate),
        );
        path.pin(self.end_velocity);
        found.residual = self.distance - path.end_position().unwrap_or(0.0);
        let way = self.limits.velocity.max(self.start.velocity.abs()) * path.duration();
        let arrives = found.residual.abs() <= ON_LIMIT * way + NOISE * self.distance.abs()
            && (end.velocity - self.end_velocity).abs() <= ON_LIMIT * self.limits.velocity;
        let moving = scans(path.duration(), self.cycle).map_or(0.0, f64::from);
        found.is_rounding = found.residual.abs() <= self.resolved * moving;
        if !arrives || !(found.is_rounding || self.closes_gently(found.residual, path.duration())) {
            return false;
        }
        found.excess = excess::excess(path, self.end_velocity, None, self.limits);
        // There is nothing after the last rung.
        found.rung == Rung::Brake || found.excess.is_none_or(|excess| self.is_unavoidable(&excess))
    }

    /// Whether what spreads `residual` (u) over `duration` (s) takes no more than a part of each limit that nobody sees: the
    /// most of the derivatives of the share (O9). Roots are not looked for beyond the noise of their positions.
    fn closes_gently(&self, residual: f64, duration: f64) -> bool {
        let (limits, residual) = (self.limits, residual.abs());
        let square = duration * duration;
        residual <= NOISE / f64::EPSILON * self.resolved
            || (5.8 * residual <= UNSEEN * limits.lower_acceleration() * square
                && 60.0 * residual <= UNSEEN * limits.jerk * (square * duration)
                && 360.0 * residual <= UNSEEN * limits.snap * (square * square))
    }

    /// Whether a stop at once, or getting inside the limits as soon as can be, exceeds the limits as much.
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
        let bound = self.ramps.velocity();
        let back = if self.start.velocity < 0.0 { bound } else { -bound };
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
        let path = Path::<MAX_PIECES>::follow(
            self.ramps.order(),
            &self.start,
            self.limits.lower_acceleration(),
            spans,
        );
        excess::excess(&path, 0.0, None, self.limits).unwrap_or_default()
    }

    /// To rest, and with the next scan a grid plan: what can't fail for want of accuracy.
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
            self.limits.lower_acceleration(),
            self.ramps.scale().outward(&stop),
        );
        path.pin(0.0);
        let rest = origin + path.end_position().unwrap_or(0.0);
        // Inputs are checked, so a grid plan is refused only for lengths and times beyond numbers.
        let too_long = PlanError::TooLong {
            field: Field::Target,
            value: target,
        };
        if !is_there(&end, 0.0, (&self.start, self.limits, path.duration())) {
            return Err(too_long);
        }
        let begin = scans(path.duration(), cycle).ok_or(too_long)?;
        found.excess = excess::excess(path, 0.0, None, self.limits);
        found.residual = 0.0;
        found.is_rounding = true;
        found.tail = Some(Tail {
            grid: grid_from(rest, target, self.limits, cycle).map_err(|_| too_long)?,
            begin,
        });
        Ok(())
    }
}
