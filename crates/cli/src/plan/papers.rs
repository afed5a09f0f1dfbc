//! The methods of the papers: lines in their fields, plans in the terms of the answer.

use crate::json::{number, string};
use crate::plan::fields::{Fields, Problem};
use crate::plan::methods::{Planned, check_rest};
use crate::plan::refusal::{Code, Refusal};
use crate::suggest::nearest;
use standstill_planner::grid;
use standstill_planner::papers::{
    Profile, SCurve, ShortPath, ShortPathPolicy, Timed, Tracking, Trapezoid, peaks, scans,
};
use standstill_planner::{Field, Limits, Peaks, PlanError};

/// What a method of order 3 needs.
const ORDER_THREE: [Field; 3] = [Field::LimitVelocity, Field::LimitAcceleration, Field::LimitJerk];

/// `s-curve`: rest to rest in least time at order 3.
pub fn s_curve(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = cycle(fields)?;
    let target = fields.required("target")?;
    check_limits(fields, &problem.limits, &ORDER_THREE, &[Field::LimitSnap])?;
    let plan = SCurve::new(problem.start.position, target, &problem.limits)
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
    // In a given time the acceleration results.
    let needed = if duration.is_some() { &needed[..1] } else { &needed };
    check_limits(
        fields,
        &problem.limits,
        needed,
        &[Field::LimitJerk, Field::LimitSnap],
    )?;
    let start = problem.start.position;
    let plan = match duration {
        None => Trapezoid::new(start, target, &problem.limits),
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
    check_limits(fields, limits, &ORDER_THREE, &[Field::LimitSnap])?;
    let plan = ShortPath::new(
        start.position,
        start.velocity,
        target,
        *end_velocity,
        limits,
        policy,
    )
    .map_err(|error| Refusal::of_plan_error(fields, error))?;
    Ok(Planned {
        case: Some(plan.kind().name()),
        end_velocity: Some(plan.end_velocity()),
        ..planned(fields, plan.profile(), cycle)?
    })
}

/// `tracking`: to a target that moves; planned anew whenever it changes.
pub fn tracking(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    let limits = &problem.limits;
    if problem.end_velocity != 0.0 {
        let message = "`end_velocity` must be 0: this method ends at rest".to_owned();
        return Err(fields.invalid("end_velocity", message).nearest(Some(number(0.0))));
    }
    let cycle = cycle(fields)?;
    let targets = targets(fields, cycle)?;
    check_limits(fields, limits, &ORDER_THREE[..2], &[])?;
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
    let unavoidable = tracking.plan().excess();
    let mut segments = Vec::new();
    let (mut began, mut scan) = (0, 0);
    for &(at, target) in changes {
        tracking.advance(at - scan);
        scan = at;
        let executed: Vec<_> = tracking.executed().collect();
        if tracking.retarget(target).map_err(refuse)? {
            segments.extend(executed);
            began = at;
        }
    }
    segments.extend(tracking.plan().segments());
    let plan = tracking.plan();
    let scans = began.checked_add(plan.scans()).ok_or_else(|| too_long(fields))?;
    let mut peak = peaks(limits.order(), segments.iter().copied());
    peak.velocity = peak.velocity.max(problem.start.velocity.abs());
    Ok(Planned {
        duration: f64::from(began) * cycle + plan.duration(),
        scans,
        segments,
        peak: bounded(&peak),
        boxes: None,
        counts: None,
        case: None,
        end_velocity: None,
        unavoidable,
        end: plan.at(plan.scans().into()),
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
        // Of several targets at one scan the last holds.
        changes.pop_if(|(last, _)| *last == scan);
        changes.push((scan, target));
    }
    Ok(changes)
}

fn too_long(fields: &Fields<'_>) -> Refusal {
    let message = "the move takes more than 2147483647 scans";
    Refusal::of_field(Code::TooLong, fields, "Ts", message)
}

/// What `short-path` does where the end velocity is out of reach.
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

/// The sample time, which the papers' planners do without.
fn cycle(fields: &Fields<'_>) -> Result<f64, Refusal> {
    let cycle = fields.required("Ts")?;
    if cycle > 0.0 {
        Ok(cycle)
    } else {
        Err(fields.invalid("Ts", format!("Ts is {cycle:?}: it must be positive")))
    }
}

/// Refuses a line that lacks a limit of `needed`, or has one of `unkept`, which its method cannot keep.
fn check_limits(
    fields: &Fields<'_>,
    limits: &Limits,
    needed: &[Field],
    unkept: &[Field],
) -> Result<(), Refusal> {
    let bounds = [
        (Field::LimitVelocity, limits.velocity),
        (Field::LimitAcceleration, limits.acceleration),
        (Field::LimitJerk, limits.jerk),
        (Field::LimitSnap, limits.snap),
    ];
    for (field, bound) in bounds {
        let name = field.name();
        let message = if bound.is_infinite() && needed.contains(&field) {
            format!("`{name}` is missing: this method needs it")
        } else if bound.is_finite() && unkept.contains(&field) {
            format!("this method cannot keep `{name}`: leave it out")
        } else {
            continue;
        };
        return Err(fields.invalid(name, message));
    }
    Ok(())
}

/// A profile in the terms of the answer.
fn planned(fields: &Fields<'_>, profile: &Profile, cycle: f64) -> Result<Planned, Refusal> {
    Ok(Planned {
        duration: profile.duration(),
        scans: profile.scans(cycle).ok_or_else(|| too_long(fields))?,
        segments: profile.segments().collect(),
        peak: bounded(&profile.peaks()),
        boxes: None,
        counts: None,
        case: None,
        end_velocity: None,
        unavoidable: None,
        end: profile.end(),
    })
}

/// Peaks with nothing where the order leaves them unbounded.
fn bounded(peaks: &Peaks) -> grid::Peaks {
    let bounded = |value: f64| value.is_finite().then_some(value);
    grid::Peaks {
        velocity: peaks.velocity,
        acceleration: peaks.acceleration,
        jerk: bounded(peaks.jerk),
        snap: bounded(peaks.snap),
    }
}
