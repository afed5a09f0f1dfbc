//! Axes that follow the pointer: planned again from frame to frame to its present position.

use crate::project::refused;
use serde::Deserialize;
use serde_json::{Value, json};
use standstill_planner::{Limits, OnlinePlan, Setpoint};

/// Largest number of axes side by side.
const AXES_MAX: usize = 8;

/// Largest number of scans of a frame.
const SCANS_MAX: u32 = 1_000;

/// Steps of the load's own motion in a scan.
const STEPS: u32 = 4;

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Request {
    /// Length of a scan (s).
    cycle: f64,
    /// Scans of this frame.
    scans: u32,
    /// The target of the axes (u).
    target: f64,
    limits: Bounds,
    /// The limits of the last frame: a state above the new limits comes inside within these.
    before: Bounds,
    load: Spring,
    axes: Vec<Axis>,
}

#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Bounds {
    /// (u/s)
    velocity: f64,
    /// Of both directions (u/s^2).
    acceleration: f64,
    /// (u/s^3)
    jerk: f64,
    /// (u/s^4)
    snap: f64,
}

/// A load on a spring.
#[derive(Clone, Copy, Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Spring {
    /// Natural frequency, undamped (rad/s).
    rate: f64,
    /// Damping ratio.
    damping: f64,
}

#[derive(Debug, Deserialize)]
#[serde(deny_unknown_fields)]
struct Axis {
    /// 2, 3 or 4: the limits that apply.
    order: u8,
    /// Position, velocity, acceleration, jerk.
    state: [f64; 4],
    /// Position and velocity of the load.
    load: [f64; 2],
}

/// Takes every axis through the scans of one frame, on an online plan from its state to the target: `{"axes": [{"state", "load",
/// "duration"}]}`, or `{"refused": ".."}`. Work: a plan for each axis, and that of sampling it.
#[must_use]
pub fn hand(request: &str) -> String {
    let led = serde_json::from_str::<Request>(request)
        .map_err(|error| error.to_string())
        .and_then(|request| led(&request));
    led.unwrap_or_else(|why| refused(&why)).to_string()
}

fn led(request: &Request) -> Result<Value, String> {
    if request.axes.len() > AXES_MAX || request.scans > SCANS_MAX {
        return Err(format!(
            "at most {AXES_MAX} axes and {SCANS_MAX} scans of a frame"
        ));
    }
    let axes: Vec<Value> = request
        .axes
        .iter()
        .map(|axis| led_axis(request, axis))
        .collect::<Result<_, _>>()?;
    Ok(json!({"axes": axes}))
}

fn led_axis(request: &Request, axis: &Axis) -> Result<Value, String> {
    let [position, velocity, acceleration, jerk] = axis.state;
    let start = Setpoint {
        position,
        velocity,
        acceleration: if axis.order > 2 { acceleration } else { 0.0 },
        jerk: if axis.order > 3 { jerk } else { 0.0 },
        snap: 0.0,
    };
    let (limits, before) = (
        limits(request.limits, axis.order),
        limits(request.before, axis.order),
    );
    let plan = OnlinePlan::new(&start, request.target, &limits, &before, request.cycle)
        .map_err(|error| error.to_string())?;
    let Spring { rate, damping } = request.load;
    let [mut place, mut speed] = axis.load;
    let mut at = start;
    let step = request.cycle / f64::from(STEPS);
    for scan in 1..=request.scans {
        at = plan.at(scan.into());
        for _ in 0..STEPS {
            let force = rate * rate * (at.position - place) + 2.0 * damping * rate * (at.velocity - speed);
            speed += force * step;
            place += speed * step;
        }
    }
    Ok(json!({
        "state": [at.position, at.velocity, at.acceleration, at.jerk],
        "load": [place, speed],
        "duration": plan.duration(),
    }))
}

/// The limits that apply at this order; the others are infinite.
fn limits(bounds: Bounds, order: u8) -> Limits {
    Limits {
        velocity: bounds.velocity,
        acceleration: bounds.acceleration,
        deceleration: bounds.acceleration,
        jerk: if order > 2 { bounds.jerk } else { f64::INFINITY },
        snap: if order > 3 { bounds.snap } else { f64::INFINITY },
    }
}
