//! The methods of the papers: lines in their fields, plans in the terms of the answer.

use crate::json::{number, string};
use crate::plan::fields::{Fields, Problem};
use crate::plan::methods::Planned;
use crate::plan::refusal::Refusal;
use crate::plan::samples::Setpoints;
use crate::plan::shared::{bounded, check_limits, check_no_end_acceleration, check_rest, cycle, too_long};
use crate::suggest::nearest;
use standstill_planner::papers::{Profile, SCurve, ShortPath, ShortPathPolicy, Timed, Trapezoid};
use standstill_planner::{Field, PlanError, SampledPlan};

/// The fields that a method of order 3 needs.
const ORDER_THREE: [Field; 3] = [Field::LimitVelocity, Field::LimitAcceleration, Field::LimitJerk];

/// `s-curve`: rest to rest in least time at order 3.
pub fn s_curve(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    check_limits(fields, &problem.limits, &ORDER_THREE, &[Field::LimitSnap])?;
    let plan = SCurve::new(problem.start.position, target, &problem.limits.acting(cycle))
        .map_err(|error| Refusal::of_plan_error(fields, error))?;
    Ok(Planned {
        case: Some(plan.case().name()),
        ..planned(fields, plan.profile(), cycle)?
    })
}

/// `timed`: rest to rest in a given time at order 3.
pub fn timed(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    let [duration, gamma, phi] = [
        fields.required("duration")?,
        fields.required("gamma")?,
        fields.required("phi")?,
    ];
    check_limits(fields, &problem.limits, &[], &[Field::LimitSnap])?;
    let start = problem.start.position;
    let plan = Timed::new(start, target, duration, gamma, phi, &problem.limits)
        .map_err(|error| Refusal::of_plan_error(fields, error))?;
    planned(fields, plan.profile(), cycle)
}

/// `trapezoid`: rest to rest at order 2, in least time or in a given one.
pub fn trapezoid(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    let duration = fields.number("duration")?;
    let needed = [Field::LimitVelocity, Field::LimitAcceleration];
    // With a given time the acceleration is a result.
    let needed = if duration.is_some() { &needed[..1] } else { &needed };
    check_limits(
        fields,
        &problem.limits,
        needed,
        &[Field::LimitJerk, Field::LimitSnap],
    )?;
    let start = problem.start.position;
    let plan = match duration {
        None => Trapezoid::new(start, target, &problem.limits.acting(cycle)),
        Some(duration) => Trapezoid::timed(start, target, duration, &problem.limits),
    };
    let plan = plan.map_err(|error| match error {
        PlanError::InvalidInput {
            field: Field::Duration,
            value,
        } if value > 0.0 => {
            let message = "at `limits.velocity` alone the way takes as long or longer".to_owned();
            fields.invalid("duration", message)
        }
        other => Refusal::of_plan_error(fields, other),
    })?;
    planned(fields, plan.profile(), cycle)
}

/// `short-path`: from one velocity to another at order 3.
pub fn short_path(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    let Problem {
        start,
        end_velocity,
        limits,
        ..
    } = problem;
    let accelerations = [
        (Field::Acceleration, start.acceleration),
        (Field::Jerk, start.jerk),
    ];
    for (field, value) in accelerations {
        if value != 0.0 {
            let message = format!("`{}` must be 0: this method starts at a velocity", field.name());
            return Err(fields.invalid(field.name(), message).nearest(Some(number(0.0))));
        }
    }
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    let policy = policy(fields)?;
    check_no_end_acceleration(fields, problem)?;
    check_limits(fields, limits, &ORDER_THREE, &[Field::LimitSnap])?;
    let plan = ShortPath::new(
        start.position,
        start.velocity,
        target,
        *end_velocity,
        &limits.acting(cycle),
        policy,
    )
    .map_err(|error| Refusal::of_plan_error(fields, error))?;
    Ok(Planned {
        case: Some(plan.kind().name()),
        end_velocity: Some(plan.end_velocity()),
        ..planned(fields, plan.profile(), cycle)?
    })
}

/// The policy of `short-path` if the end velocity cannot be reached.
fn policy(fields: &Fields<'_>) -> Result<ShortPathPolicy, Refusal> {
    match fields.string("policy")?.as_deref() {
        None | Some("nearest") => Ok(ShortPathPolicy::Nearest),
        Some("paper") => Ok(ShortPathPolicy::Paper),
        Some(other) => {
            let near = nearest(other, ["paper", "nearest"].into_iter()).map(string);
            let message = "there are the policies `paper` and `nearest`".to_owned();
            Err(fields.invalid("policy", message).nearest(near))
        }
    }
}

/// A profile in the terms of the answer.
fn planned(fields: &Fields<'_>, profile: &Profile, cycle: f64) -> Result<Planned, Refusal> {
    let plan = SampledPlan::new(profile, cycle).map_err(|_| too_long(fields))?;
    let segments = profile.segments().collect();
    let peak = bounded(&profile.peaks());
    Ok(Planned::new(
        profile.duration(),
        plan.scans(),
        segments,
        peak,
        profile.end(),
        Setpoints::Sampled(Box::new(plan)),
    ))
}
