//! The table of methods. A method that is built later gets its function here, and its own fields if it has
//! some; everything else follows from the table.

use crate::json::number;
use crate::plan::fields::{Fields, Problem};
use crate::plan::papers;
use crate::plan::refusal::{Code, Refusal};
use standstill_planner::grid::{Counts, Method, Peaks};
use standstill_planner::{Excess, Field, GridPlan, Limits, Order, PlanError, Segment, Setpoint};

/// A method of `standstill plan`.
#[derive(Debug)]
pub struct MethodInfo {
    /// Its name on a line.
    pub name: &'static str,
    /// The fields it takes besides those that all take.
    fields: &'static [&'static str],
    /// What plans; none if it is not built yet.
    plan: Option<PlanFn>,
}

type PlanFn = fn(&Fields<'_>, &Problem) -> Result<Planned, Refusal>;

/// Every method of the interface.
const METHODS: [&MethodInfo; 9] = [
    &MethodInfo {
        name: "sequential",
        fields: &[],
        plan: Some(|fields, problem| grid(fields, problem, Method::Sequential)),
    },
    &MethodInfo {
        name: "grid",
        fields: &[],
        plan: Some(|fields, problem| grid(fields, problem, Method::Grid)),
    },
    OVERLAPPED,
    ONLINE,
    &MethodInfo {
        name: "s-curve",
        fields: &[],
        plan: Some(papers::s_curve),
    },
    &MethodInfo {
        name: "timed",
        fields: &["duration", "gamma", "phi"],
        plan: Some(papers::timed),
    },
    &MethodInfo {
        name: "trapezoid",
        fields: &["duration"],
        plan: Some(papers::trapezoid),
    },
    &MethodInfo {
        name: "short-path",
        fields: &["policy"],
        plan: Some(papers::short_path),
    },
    &MethodInfo {
        name: "tracking",
        fields: &["targets"],
        plan: Some(papers::tracking),
    },
];

/// The default from rest to rest.
const OVERLAPPED: &MethodInfo = &MethodInfo {
    name: "overlapped",
    fields: &[],
    plan: Some(|fields, problem| grid(fields, problem, Method::Overlapped)),
};

/// The default for everything else.
const ONLINE: &MethodInfo = &MethodInfo {
    name: "online",
    fields: &[],
    plan: None,
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
    /// Which of its cases the method found, if it has some.
    pub case: Option<&'static str>,
    /// The velocity at the target (u/s), of methods that may change the one asked for.
    pub end_velocity: Option<f64>,
    /// By how much the start state forces the plan out of its limits, if it does.
    pub unavoidable: Option<Excess>,
    /// What is published last.
    pub end: Setpoint,
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

/// Plans what a line asks for; gives the name of the method as well.
pub fn plan(fields: &Fields<'_>) -> Result<(&'static str, Planned), Refusal> {
    let problem = fields.problem()?;
    let chosen = fields.method()?;
    let motion = problem.first_motion();
    let method = chosen.unwrap_or(if motion.is_some() { ONLINE } else { OVERLAPPED });
    let Some(plan) = method.plan else {
        // Without a method on the line it is the motion that asks for one.
        let field = motion
            .filter(|_| chosen.is_none())
            .map_or("method", |(field, _)| field.name());
        let message = format!("method `{}` is not built yet", method.name);
        return Err(Refusal::of_field(Code::Unsupported, fields, field, message));
    };
    for name in fields.names() {
        check_extra_field(fields, name, method)?;
    }
    Ok((method.name, plan(fields, &problem)?))
}

/// Refuses a field that only other methods take.
fn check_extra_field(fields: &Fields<'_>, name: &str, method: &MethodInfo) -> Result<(), Refusal> {
    let takers: Vec<_> = METHODS
        .into_iter()
        .filter(|other| other.fields.contains(&name))
        .collect();
    if takers.is_empty() || method.fields.contains(&name) {
        return Ok(());
    }
    let (code, remark) = if takers.iter().any(|taker| taker.plan.is_some()) {
        (Code::InvalidInput, "")
    } else {
        (Code::Unsupported, ", and not built yet")
    };
    let takers = takers
        .iter()
        .map(|taker| taker.name)
        .collect::<Vec<_>>()
        .join(", ");
    let message = format!("`{name}` is a field of {takers}, not of {}{remark}", method.name);
    Err(Refusal::of_field(code, fields, name, message))
}

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

/// Rest to rest on the sample grid.
fn grid(fields: &Fields<'_>, problem: &Problem, method: Method) -> Result<Planned, Refusal> {
    check_rest(fields, problem)?;
    let cycle = fields.required("Ts")?;
    let target = fields.required("target")?;
    let limits = problem.limits;
    let with = |limits: &Limits| GridPlan::new(method, problem.start.position, target, limits, cycle);
    let plan = with(&limits).map_err(|error| {
        let nearest = nearest_limit(error, &limits, |limits| with(limits).is_ok());
        Refusal::of_plan_error(fields, error).nearest(nearest.map(number))
    })?;
    let symmetric = limits.acceleration == limits.deceleration;
    Ok(Planned {
        duration: plan.duration(),
        scans: plan.scans(),
        segments: plan.segments().map(segment).collect(),
        peak: plan.peaks(),
        boxes: symmetric.then(|| boxes(&plan)),
        counts: (method != Method::Overlapped).then(|| counts(&plan)),
        case: None,
        end_velocity: None,
        unavoidable: None,
        end: plan.at(plan.scans().into()),
    })
}

fn segment(segment: standstill_planner::grid::Segment) -> Segment {
    Segment {
        duration: segment.duration,
        velocity: segment.velocity,
        acceleration: segment.acceleration,
        jerk: segment.jerk,
        snap: segment.snap,
    }
}

/// As many boxes as the order, also of a move of no length, so that readers need no special case.
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

/// The least value of the limit a refusal names with which the move can be counted; none if it is not this
/// limit alone that makes it too long. Bounded: one trial per bit of an `f64`, at most 64.
fn nearest_limit(error: PlanError, limits: &Limits, works: impl Fn(&Limits) -> bool) -> Option<f64> {
    let PlanError::TooLong { field, value } = error else {
        return None;
    };
    let with = |value| {
        let mut limits = *limits;
        let bound = match field {
            Field::LimitVelocity => &mut limits.velocity,
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
