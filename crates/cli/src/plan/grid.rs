//! The methods on the sample grid: `sequential`, `grid` and `overlapped`.

use crate::json::number;
use crate::plan::fields::{Fields, Problem};
use crate::plan::methods::Planned;
use crate::plan::refusal::Refusal;
use crate::plan::samples::Setpoints;
use crate::plan::shared::check_rest;
use standstill_planner::grid::{Counts, Family, Method};
use standstill_planner::{Field, GridPlan, Limits, Order, PlanError, Segment, UnequalPlan};

/// Rest to rest on the sample grid.
pub fn grid(fields: &Fields<'_>, problem: &Problem, method: Method) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = fields.required("Ts")?;
    let target = fields.required("target")?;
    let start = problem.start.position;
    let limits = problem.limits;
    let one_rate = limits.acceleration == limits.deceleration;
    let family = match method {
        Method::Grid if !one_rate => Family::Separate,
        Method::Overlapped if !one_rate => Family::Overlapped,
        // The published steps have only one rate.
        Method::Sequential | Method::Grid | Method::Overlapped => {
            let plan = refuse_too_long(fields, &limits, |limits| {
                GridPlan::new(method, start, target, limits, cycle)
            })?;
            return Ok(with_one_rate(&plan, one_rate));
        }
    };
    let plan = refuse_too_long(fields, &limits, |limits| {
        UnequalPlan::new(family, start, target, limits, cycle)
    })?;
    Ok(Planned::new(
        plan.duration(),
        plan.scans(),
        plan.segments().map(Segment::from).collect(),
        plan.peaks(),
        plan.at(plan.scans().into()),
        Setpoints::Unequal(plan),
    ))
}

/// A plan whose acceleration and deceleration are the same, whether requested or not.
fn with_one_rate(plan: &GridPlan, asked_for: bool) -> Planned {
    Planned {
        boxes: asked_for.then(|| boxes(plan)),
        counts: (plan.method() != Method::Overlapped).then(|| counts(plan)),
        ..Planned::new(
            plan.duration(),
            plan.scans(),
            plan.segments().map(Segment::from).collect(),
            plan.peaks(),
            plan.at(plan.scans().into()),
            Setpoints::Grid(*plan),
        )
    }
}

/// The plan, or the reason why there is none, with the nearest limit that would permit one.
fn refuse_too_long<T>(
    fields: &Fields<'_>,
    limits: &Limits,
    plan: impl Fn(&Limits) -> Result<T, PlanError>,
) -> Result<T, Refusal> {
    plan(limits).map_err(|error| {
        let nearest = nearest_limit(error, limits, |limits| plan(limits).is_ok());
        Refusal::of_plan_error(fields, error).nearest(nearest.map(number))
    })
}

/// As many boxes as the order, even for a move of no length, so that readers need no special case.
fn boxes(plan: &GridPlan) -> Vec<u32> {
    let mut boxes = plan.boxes().to_vec();
    boxes.resize(plan.order().degree(), 0);
    boxes
}

/// The published counts; all 0 for a move of no length.
fn counts(plan: &GridPlan) -> Counts {
    plan.counts().unwrap_or(Counts {
        nd: (plan.order() == Order::Four).then_some(0),
        nj: (plan.order() != Order::Two).then_some(0),
        na: 0,
        nv: 0,
    })
}

/// The least value of the limit that a refusal names with which the move can be counted. None if other limits also
/// make it too long. Bounded: one trial for each bit of an `f64`, at most 64.
fn nearest_limit(error: PlanError, limits: &Limits, works: impl Fn(&Limits) -> bool) -> Option<f64> {
    let PlanError::TooLong { field, value } = error else {
        return None;
    };
    let with = |value| {
        let mut limits = *limits;
        let follows = limits.deceleration == limits.acceleration;
        let bound = match field {
            Field::LimitVelocity => &mut limits.velocity,
            // A deceleration that is not given has the same value.
            Field::LimitAcceleration if follows => {
                limits.deceleration = value;
                &mut limits.acceleration
            }
            Field::LimitAcceleration => &mut limits.acceleration,
            Field::LimitDeceleration => &mut limits.deceleration,
            Field::LimitJerk => &mut limits.jerk,
            Field::LimitSnap => &mut limits.snap,
            _ => return None,
        };
        *bound = value;
        Some(limits)
    };
    // Positive floats are ordered as their bits are.
    let (mut too_low, mut enough) = (value.to_bits(), f64::MAX.to_bits());
    if !works(&with(f64::MAX)?) {
        return None;
    }
    while enough - too_low > 1 {
        let middle = too_low + (enough - too_low) / 2;
        if works(&with(f64::from_bits(middle))?) {
            enough = middle;
        } else {
            too_low = middle;
        }
    }
    Some(f64::from_bits(enough))
}
