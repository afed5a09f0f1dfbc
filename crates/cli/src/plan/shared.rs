//! Checks and answers that several methods share.

use crate::json::number;
use crate::plan::fields::{Fields, Problem};
use crate::plan::refusal::{Code, Refusal};
use standstill_planner::{DirectedLimits, Field, Limits, Peaks, grid};

/// Refuses a start or an end that moves.
pub fn check_rest(fields: &Fields<'_>, problem: &Problem) -> Result<(), Refusal> {
    match problem.first_motion() {
        None => Ok(()),
        Some((field, _)) => {
            let message = format!("`{}` must be 0: this method goes from rest to rest", field.name());
            Err(fields.invalid(field.name(), message).nearest(Some(number(0.0))))
        }
    }
}

/// Refuses an end acceleration.
pub fn check_no_end_acceleration(fields: &Fields<'_>, problem: &Problem) -> Result<(), Refusal> {
    if problem.end_acceleration == 0.0 {
        return Ok(());
    }
    let message = "`end_acceleration` must be 0: only `online` ends with another".to_owned();
    Err(fields
        .invalid("end_acceleration", message)
        .nearest(Some(number(0.0))))
}

/// The sample time.
pub fn cycle(fields: &Fields<'_>) -> Result<f64, Refusal> {
    let cycle = fields.required("Ts")?;
    if cycle > 0.0 {
        Ok(cycle)
    } else {
        Err(fields.invalid("Ts", format!("Ts is {cycle:?}: it must be positive")))
    }
}

/// Refuses a line that lacks a limit of `needed`, or has one of `unkept`, which its method cannot keep.
pub fn check_limits(
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

/// Refuses an end velocity above its limit. The limit is the nearest permitted value.
pub fn check_end_velocity(fields: &Fields<'_>, problem: &Problem) -> Result<(), Refusal> {
    let (value, limit) = (problem.end_velocity, problem.limits.velocity);
    // The planner refuses an invalid limit.
    if limit > 0.0 && value.abs() > limit {
        let message = "`end_velocity` is above `limits.velocity`".to_owned();
        let nearest = number(limit.copysign(value));
        return Err(fields.invalid("end_velocity", message).nearest(Some(nearest)));
    }
    Ok(())
}

/// Refuses an end velocity above the bound of its direction, because it cannot be reached. The bound is the nearest
/// permitted value.
pub fn check_end_direction(
    fields: &Fields<'_>,
    end_velocity: f64,
    limits: &DirectedLimits,
) -> Result<(), Refusal> {
    let (side, name) = if end_velocity < 0.0 {
        (limits.negative, "velocity_limits.negative")
    } else {
        (limits.positive, "velocity_limits.positive")
    };
    // The planner refuses an invalid limit.
    if !(side > 0.0 && end_velocity.abs() > side) {
        return Ok(());
    }
    let name = if side < limits.limits.velocity {
        name
    } else {
        "limits.velocity"
    };
    let message = format!("`end_velocity` is above `{name}`: it cannot be reached");
    let refusal = Refusal::of_field(Code::Unreachable, fields, "end_velocity", message);
    Err(refusal.nearest(Some(number(side.copysign(end_velocity)))))
}

/// The answer to a move of more scans than a plan counts.
pub fn too_long(fields: &Fields<'_>) -> Refusal {
    let message = "the move takes more than 2147483647 scans";
    Refusal::of_field(Code::TooLong, fields, "Ts", message)
}

/// Peaks that are empty where the order leaves them unbounded.
pub fn bounded(peaks: &Peaks) -> grid::Peaks {
    let bounded = |value: f64| value.is_finite().then_some(value);
    grid::Peaks {
        velocity: peaks.velocity,
        acceleration: peaks.acceleration,
        jerk: bounded(peaks.jerk),
        snap: bounded(peaks.snap),
    }
}
