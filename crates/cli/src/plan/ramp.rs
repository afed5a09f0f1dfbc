//! The method `ramp`: from any state to a constant velocity.

use crate::plan::fields::{Fields, Problem};
use crate::plan::methods::Planned;
use crate::plan::refusal::Refusal;
use crate::plan::samples::Setpoints;
use crate::plan::shared::{
    bounded, check_end_direction, check_end_velocity, check_limits, check_no_end_acceleration, cycle,
};
use standstill_planner::{Field, RampPlan, Setpoint};

/// From any state to the constant `end_velocity`, at any position.
pub fn ramp(fields: &Fields<'_>, problem: &Problem) -> Result<Planned, Refusal> {
    let Problem {
        start,
        end_velocity,
        limits,
        ..
    } = problem;
    let cycle = cycle(fields)?;
    if fields.has("target") {
        let message = "this method ends at `end_velocity`, wherever that is: leave `target` out".to_owned();
        return Err(fields.invalid("target", message));
    }
    check_limits(fields, limits, &[Field::LimitAcceleration], &[])?;
    check_no_end_acceleration(fields, problem)?;
    check_end_velocity(fields, problem)?;
    let before = fields.limits_before(limits)?.into();
    let limits = fields.directed(limits)?;
    check_end_direction(fields, *end_velocity, &limits)?;
    let plan = RampPlan::keeping_velocities(start, *end_velocity, &limits, &before, cycle)
        .map_err(|error| Refusal::of_plan_error(fields, error))?;
    let end = Setpoint {
        velocity: *end_velocity,
        ..Setpoint::at_rest(plan.end_position())
    };
    let segments = plan.segments().collect();
    let peak = bounded(&plan.peaks());
    Ok(Planned {
        unavoidable: plan.excess(),
        ..Planned::new(
            plan.duration(),
            plan.scans(),
            segments,
            peak,
            end,
            Setpoints::Ramp(Box::new(plan)),
        )
    })
}
