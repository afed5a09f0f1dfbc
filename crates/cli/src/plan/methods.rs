//! The table of methods. A new method needs its function here, and its own fields if it has some;
//! everything else follows from the table.

use crate::plan::fields::{Fields, Problem};
use crate::plan::grid::grid;
use crate::plan::refusal::Refusal;
use crate::plan::samples::Setpoints;
use crate::plan::{online, papers, ramp, shaped};
use standstill_planner::grid::{Counts, Method, Peaks};
use standstill_planner::{Excess, Segment, Setpoint};

/// A method of `standstill plan`.
#[derive(Debug)]
pub struct MethodInfo {
    /// Its name on a line.
    pub name: &'static str,
    /// Its fields in addition to those of all methods.
    fields: &'static [&'static str],
    /// Its function.
    plan: PlanFn,
}

type PlanFn = fn(&Fields<'_>, &Problem) -> Result<Planned, Refusal>;

/// Every method of the interface.
const METHODS: [&MethodInfo; 10] = [
    &MethodInfo {
        name: "sequential",
        fields: &[],
        plan: |fields, problem| grid(fields, problem, Method::Sequential),
    },
    &MethodInfo {
        name: "grid",
        fields: &[],
        plan: |fields, problem| grid(fields, problem, Method::Grid),
    },
    OVERLAPPED,
    ONLINE,
    &MethodInfo {
        name: "s-curve",
        fields: &[],
        plan: papers::s_curve,
    },
    &MethodInfo {
        name: "timed",
        fields: &["duration", "gamma", "phi"],
        plan: papers::timed,
    },
    &MethodInfo {
        name: "trapezoid",
        fields: &["duration"],
        plan: papers::trapezoid,
    },
    &MethodInfo {
        name: "short-path",
        fields: &["policy"],
        plan: papers::short_path,
    },
    &MethodInfo {
        name: "tracking",
        fields: &["targets"],
        plan: online::tracking,
    },
    &MethodInfo {
        name: "ramp",
        fields: &["limits_before", "velocity_limits"],
        plan: ramp::ramp,
    },
];

/// The default from rest to rest.
const OVERLAPPED: &MethodInfo = &MethodInfo {
    name: "overlapped",
    fields: &[],
    plan: |fields, problem| grid(fields, problem, Method::Overlapped),
};

/// The default for everything else.
const ONLINE: &MethodInfo = &MethodInfo {
    name: "online",
    fields: &["limits_before", "velocity_limits"],
    plan: online::online,
};

/// A plan in the terms of the answer.
#[derive(Clone, Debug, PartialEq)]
pub struct Planned {
    /// Time until the target is reached (s).
    pub duration: f64,
    /// The least scan count at whose end the target is reached.
    pub scans: u32,
    /// Stretches of constant snap.
    pub segments: Vec<Segment>,
    /// Largest magnitudes.
    pub peak: Peaks,
    /// Lengths of the moving sums (scans), if the plan is made of them.
    pub boxes: Option<Vec<u32>>,
    /// Lengths of the published segments (scans), if the method has them.
    pub counts: Option<Counts>,
    /// The case that the method found, if it has cases.
    pub case: Option<&'static str>,
    /// The velocity at the target (u/s), of methods that may change the requested one.
    pub end_velocity: Option<f64>,
    /// The excess that the start state forces on the plan, if there is any.
    pub unavoidable: Option<Excess>,
    /// The rung of the ladder an online plan is from.
    pub rung: Option<&'static str>,
    /// The last set-point.
    pub end: Setpoint,
    /// The set-points in between.
    pub setpoints: Setpoints,
}

impl Planned {
    /// A plan without the fields that only some methods have.
    pub const fn new(
        duration: f64,
        scans: u32,
        segments: Vec<Segment>,
        peak: Peaks,
        end: Setpoint,
        setpoints: Setpoints,
    ) -> Self {
        Self {
            duration,
            scans,
            segments,
            peak,
            boxes: None,
            counts: None,
            case: None,
            end_velocity: None,
            unavoidable: None,
            rung: None,
            end,
            setpoints,
        }
    }
}

/// The method called `name`.
pub fn find(name: &str) -> Option<&'static MethodInfo> {
    METHODS.into_iter().find(|method| method.name == name)
}

/// The names of all methods.
pub fn names() -> impl Iterator<Item = &'static str> + Clone {
    METHODS.into_iter().map(|method| method.name)
}

/// The fields that only some methods take.
pub fn extra_fields() -> impl Iterator<Item = &'static str> + Clone {
    METHODS
        .into_iter()
        .flat_map(|method| method.fields.iter().copied())
}

/// All methods.
pub fn all() -> impl Iterator<Item = &'static MethodInfo> {
    METHODS.into_iter()
}

/// Plans a line; also returns the name of the method.
pub fn plan(fields: &Fields<'_>) -> Result<(&'static str, Planned), Refusal> {
    let problem = fields.problem()?;
    let default = if problem.first_motion().is_some() || fields.has("velocity_limits") {
        ONLINE
    } else {
        OVERLAPPED
    };
    let method = fields.method()?.unwrap_or(default);
    Ok((method.name, plan_with(fields, &problem, method)?))
}

/// Plans with the given method; the name on the line is not used.
pub fn plan_with(fields: &Fields<'_>, problem: &Problem, method: &MethodInfo) -> Result<Planned, Refusal> {
    for name in fields.names() {
        check_extra_field(fields, name, method)?;
    }
    shaped::shaped(fields, (method.plan)(fields, problem)?)
}

/// Refuses a field that only other methods take.
fn check_extra_field(fields: &Fields<'_>, name: &str, method: &MethodInfo) -> Result<(), Refusal> {
    let takers = METHODS.into_iter().filter(|other| other.fields.contains(&name));
    let takers: Vec<_> = takers.map(|taker| taker.name).collect();
    if takers.is_empty() || takers.contains(&method.name) {
        return Ok(());
    }
    let message = format!(
        "`{name}` is a field of {}, not of {}",
        takers.join(", "),
        method.name
    );
    Err(fields.invalid(name, message))
}
