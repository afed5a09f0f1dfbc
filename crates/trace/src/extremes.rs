//! How far an axis went, and how much of its limits it used.

use std::fmt::Write;

use crate::header::Axis;
use crate::number::{fixed, shortest};
use crate::trace::Trace;

/// The extreme of one quantity of an axis over a whole trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Extreme {
    /// The axis.
    pub axis: String,
    /// What it is: `least position`, `greatest position`, or a magnitude: `velocity`, `acceleration`,
    /// `deceleration`, `jerk`, `snap`.
    pub quantity: &'static str,
    /// Its value (u, u/s .. u/s^4); NaN if one occurred.
    pub value: f64,
    /// The first scan that reached it.
    pub scan: usize,
    /// The axis limit, if there is one.
    pub limit: Option<f64>,
}

/// The extremes of every axis in order. `deceleration` is told apart from `acceleration` where their
/// limits differ. Signals that the trace lacks are left out.
#[must_use]
pub fn extremes(trace: &Trace) -> Vec<Extreme> {
    trace
        .header()
        .axes
        .iter()
        .flat_map(|axis| of_axis(trace, axis))
        .collect()
}

/// The extremes as aligned lines, one block per axis.
#[must_use]
pub fn extremes_text(trace: &Trace) -> String {
    let mut text = String::new();
    for axis in &trace.header().axes {
        let unit = if axis.unit.is_empty() {
            String::new()
        } else {
            format!(" ({})", axis.unit)
        };
        // Writing to a String cannot fail, here and below.
        let _ = writeln!(text, "extremes of {}{unit}", axis.name);
        for Extreme {
            quantity,
            value,
            scan,
            limit,
            ..
        } in of_axis(trace, axis)
        {
            let bound = match limit {
                None if quantity.ends_with("position") => String::new(),
                None => "no limit".to_owned(),
                Some(limit) if quantity.ends_with("position") => format!("limit {}", shortest(limit)),
                Some(limit) => format!("{:.2} % of {}", 100.0 * value / limit, shortest(limit)),
            };
            let line = format!("  {quantity:<17} {:>16}  at {scan:<7} {bound}", fixed(value));
            let _ = writeln!(text, "{}", line.trim_end());
        }
    }
    text
}

/// The axis and its unit: `X (mm)`.
pub(crate) fn axis_title(axis: &Axis) -> String {
    if axis.unit.is_empty() {
        axis.name.clone()
    } else {
        format!("{} ({})", axis.name, axis.unit)
    }
}

fn of_axis(trace: &Trace, axis: &Axis) -> Vec<Extreme> {
    let signal = |name: &str| -> Vec<f64> {
        let column = trace.column(&format!("{}.{name}", axis.name));
        column
            .map(|column| trace.reals(column).collect())
            .unwrap_or_default()
    };
    let limits = &axis.limits;
    let [positions, velocities, accelerations] = ["Position", "Velocity", "Acceleration"].map(signal);
    let magnitudes = |values: &[f64]| values.iter().map(|value| value.abs()).collect::<Vec<_>>();
    let mut found = vec![
        (
            "least position",
            greatest(positions.iter().map(|p| -p)).map(|(p, at)| (-p, at)),
            limits.position_min,
        ),
        (
            "greatest position",
            greatest(positions.iter().copied()),
            limits.position_max,
        ),
        (
            "velocity",
            greatest(magnitudes(&velocities).into_iter()),
            limits.velocity,
        ),
    ];
    if limits.acceleration == limits.deceleration {
        let peak = greatest(magnitudes(&accelerations).into_iter());
        found.push(("acceleration", peak, limits.acceleration));
    } else {
        let (speeding, slowing) = by_sense(&velocities, &accelerations);
        found.push((
            "acceleration",
            greatest(speeding.into_iter()),
            limits.acceleration,
        ));
        found.push(("deceleration", greatest(slowing.into_iter()), limits.deceleration));
    }
    found.push((
        "jerk",
        greatest(magnitudes(&signal("Jerk")).into_iter()),
        limits.jerk,
    ));
    found.push((
        "snap",
        greatest(magnitudes(&signal("Snap")).into_iter()),
        limits.snap,
    ));
    found
        .into_iter()
        .filter_map(|(quantity, peak, limit)| {
            let (value, scan) = peak?;
            Some(Extreme {
                axis: axis.name.clone(),
                quantity,
                value,
                scan,
                limit,
            })
        })
        .collect()
}

/// Magnitudes of the accelerations that speed up (or start from rest), and of those that slow down.
fn by_sense(velocities: &[f64], accelerations: &[f64]) -> (Vec<f64>, Vec<f64>) {
    let pairs = velocities.iter().zip(accelerations);
    pairs
        .map(|(velocity, acceleration)| {
            let slows = (*velocity > 0.0 && *acceleration < 0.0) || (*velocity < 0.0 && *acceleration > 0.0);
            let size = acceleration.abs();
            if slows { (0.0, size) } else { (size, 0.0) }
        })
        .unzip()
}

/// The greatest value and where it first stands. A NaN is greater than all: it must not stay unseen.
fn greatest(values: impl Iterator<Item = f64>) -> Option<(f64, usize)> {
    let mut peak: Option<(f64, usize)> = None;
    for (scan, value) in values.enumerate() {
        let beaten = peak.is_none_or(|(peak, _)| !peak.is_nan() && (value.is_nan() || value > peak));
        if beaten {
            peak = Some((value, scan));
        }
    }
    peak
}
