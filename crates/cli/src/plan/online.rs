//! The methods that start anywhere: `online` and `tracking`.

use crate::json::number;
use crate::plan::fields::{Fields, Problem};
use crate::plan::methods::Planned;
use crate::plan::refusal::{Code, Refusal};
use crate::plan::samples::Setpoints;
use crate::plan::shared::{
    bounded, check_end_direction, check_limits, check_no_end_acceleration, cycle, too_long,
};
use standstill_planner::papers::{Tracking, peaks, scans};
use standstill_planner::{Excess, Field, Goal, OnlinePlan, Order, PlanError, Setpoint};

/// The limits that both need.
const NEEDED: [Field; 2] = [Field::LimitVelocity, Field::LimitAcceleration];

/// `online`: from any state to a position, at rest there or with a velocity and an acceleration.
pub fn online(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    let Problem {
        start,
        end_velocity,
        end_acceleration,
        limits: given,
    } = problem;
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    let limits = fields.directed(given)?;
    check_limits(fields, &limits.either(), &NEEDED, &[])?;
    let before = fields.limits_before(given)?.into();
    check_end_direction(fields, *end_velocity, &limits)?;
    let plan = if *end_acceleration == 0.0 {
        OnlinePlan::keeping_velocities(start, target, *end_velocity, &limits, &before, cycle)
    } else {
        let goal = Goal {
            position: target,
            velocity: *end_velocity,
            acceleration: *end_acceleration,
        };
        OnlinePlan::reaching(start, &goal, &limits, &before, cycle)
    };
    let plan = plan.map_err(|error| match error {
        PlanError::Unreachable {
            field: Field::EndAcceleration,
            nearest,
            ..
        } => {
            let message = if limits.limits.order() == Order::Two {
                "without `limits.jerk` or `limits.snap` acceleration jumps, so `end_acceleration` can only be 0"
            } else {
                "no motion inside `limits` can come to this `end_acceleration` at `end_velocity` and go on from it"
            };
            Refusal::of_field(Code::Unreachable, fields, "end_acceleration", message).nearest(Some(number(nearest)))
        }
        other => Refusal::of_plan_error(fields, other),
    })?;
    let end = if *end_velocity == 0.0 && *end_acceleration == 0.0 {
        plan.at(plan.scans().into())
    } else {
        // The position at the first instant with both velocity and acceleration, not at the scan after it.
        Setpoint {
            velocity: *end_velocity,
            acceleration: *end_acceleration,
            ..Setpoint::at_rest(target)
        }
    };
    let segments = plan.segments().collect();
    Ok(Planned {
        unavoidable: plan.excess(),
        rung: Some(plan.rung().name()),
        ..Planned::new(
            plan.duration(),
            plan.scans(),
            segments,
            bounded(&plan.peaks()),
            end,
            Setpoints::Online(vec![(0, plan)]),
        )
    })
}

/// `tracking`: to a target that moves; planned anew whenever it changes.
pub fn tracking(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    let limits = &problem.limits;
    if problem.end_velocity != 0.0 {
        let message = "`end_velocity` must be 0: this method ends at rest".to_owned();
        return Err(fields.invalid("end_velocity", message).nearest(Some(number(0.0))));
    }
    check_no_end_acceleration(fields, problem)?;
    let cycle = cycle(fields)?;
    let targets = targets(fields, cycle)?;
    check_limits(fields, limits, &NEEDED, &[])?;
    let refuse = |error| match error {
        PlanError::InvalidInput {
            field: Field::Target, ..
        } => fields.invalid("targets", "a target is too far away".to_owned()),
        other => Refusal::of_plan_error(fields, other),
    };
    let mut changes = targets.iter();
    // The list is not empty, and its first target applies at once.
    let first = changes.next().map_or(0.0, |(_, target)| *target);
    let mut tracking = Tracking::new(&problem.start, first, limits, cycle).map_err(refuse)?;
    let mut unavoidable = tracking.plan().excess();
    let mut segments = Vec::new();
    let mut plans = vec![(0, *tracking.plan())];
    let (mut began, mut scan) = (0, 0);
    for &(at, target) in changes {
        tracking.advance(at - scan);
        scan = at;
        let executed: Vec<_> = tracking.executed().collect();
        if tracking.retarget(target).map_err(refuse)? {
            segments.extend(executed);
            began = at;
            plans.push((at, *tracking.plan()));
            unavoidable = larger(unavoidable, tracking.plan().excess());
        }
    }
    segments.extend(tracking.plan().segments());
    let plan = tracking.plan();
    let scans = began.checked_add(plan.scans()).ok_or_else(|| too_long(fields))?;
    let mut peak = peaks(limits.order(), segments.iter().copied());
    peak.velocity = peak.velocity.max(problem.start.velocity.abs());
    let duration = f64::from(began) * cycle + plan.duration();
    let end = plan.at(plan.scans().into());
    Ok(Planned {
        unavoidable,
        ..Planned::new(
            duration,
            scans,
            segments,
            bounded(&peak),
            end,
            Setpoints::Online(plans),
        )
    })
}

/// The larger one of each part of the excess of two plans.
fn larger(one: Option<Excess>, other: Option<Excess>) -> Option<Excess> {
    let (Some(a), Some(b)) = (one, other) else {
        return one.or(other);
    };
    Some(Excess {
        velocity: a.velocity.max(b.velocity),
        acceleration: a.acceleration.max(b.acceleration),
        jerk: a.jerk.max(b.jerk),
    })
}

/// The scans at which targets change, and the targets: pairs of time and position, the first at 0.
fn targets(fields: &Fields<'_>, cycle: f64) -> Result<Vec<(u32, f64)>, Refusal> {
    let refuse = |message: &str| fields.invalid("targets", message.to_owned());
    let Some(pairs) = fields.pairs("targets")? else {
        return Err(refuse("`targets` is missing: this method needs it"));
    };
    let Some(&(first, _)) = pairs.first() else {
        return Err(refuse("`targets` is empty"));
    };
    if first != 0.0 {
        return Err(refuse("the first of `targets` must be at time 0"));
    }
    if pairs.windows(2).any(|pair| pair[1].0 < pair[0].0) {
        return Err(refuse("the times of `targets` must not fall"));
    }
    if let (Some(target), Some((_, last))) = (fields.number("target")?, pairs.last())
        && target != *last
    {
        let message = "`target` is not the last of `targets`: leave it out".to_owned();
        return Err(fields.invalid("target", message).nearest(Some(number(*last))));
    }
    let mut changes = Vec::new();
    for (time, target) in pairs {
        let scan = scans(time, cycle).ok_or_else(|| too_long(fields))?;
        // If there are several targets in one scan the last one counts.
        changes.pop_if(|(last, _)| *last == scan);
        changes.push((scan, target));
    }
    Ok(changes)
}
