//! The claim that an axis stays within its limits, judged on published positions alone.
//!
//! A backward difference of order k over cycle^k is a mean of the k-th derivative, so where the continuous
//! plan keeps a limit the difference keeps it too. The published positions are roundings of that plan. Each
//! is taken to be off by at most one unit in the last place of the largest position P of the run (a move
//! from far away towards 0 carries the rounding of where it began), and the k-th difference adds 2^k of
//! them. So in every scan
//!
//! ```text
//! |d_k| <= limit_k * factor * (1 + 1e-9) + 2^k * ulp(P) / cycle^k
//! ```
//!
//! The 1e-9 is the accuracy the planner states for its limits.

use super::Failure;
use super::judge::{Listed, failure, within_run};
use crate::model::Range;
use crate::run::{Derivatives, Rows};
use standstill_trace::shortest;

/// Relative accuracy of limits.
const RELATIVE: f64 = 1e-9;

/// d1 to d4 of the axis stay within its limits times `factor`, and what positions resolve.
pub(super) fn within(rows: &Rows<'_>, path: &str, range: Range, axis: usize, factor: f64) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        Ok(scans) => scans,
        Err(failure) => return vec![failure],
    };
    let slack = resolved(rows, axis);
    let mut first: [Option<(u64, f64, f64)>; 4] = [None; 4];
    let mut broken = [Listed::default(); 4];
    for scan in scans {
        let Some(derivatives) = rows.derivatives(axis, scan) else {
            continue;
        };
        let limits = limits(rows, axis, &derivatives);
        for order in 0..4 {
            let value = derivatives.orders[order];
            let bound = limits[order] * factor;
            // Written so that a NaN breaks the limit.
            if !(value.abs() <= bound * (1.0 + RELATIVE) + slack[order]) {
                first[order].get_or_insert((scan, value, bound));
                broken[order].add(scan);
            }
        }
    }
    let name = rows.script.axes.get(axis).map_or("", |axis| axis.name.as_str());
    let mut failures = Vec::new();
    for (order, (first, broken)) in first.into_iter().zip(broken).enumerate() {
        if let Some((scan, value, bound)) = first {
            let text = format!(
                "{} at scan {scan}, expected of magnitude <= {}; broken {}",
                shortest(value),
                shortest(bound),
                broken
            );
            let path = format!("{path}.within_limits.{name}.Position.d{}", order + 1);
            failures.push(failure(&path, Some(scan), text));
        }
    }
    failures
}

/// The limits of d1 to d4 in a scan. Where the speed falls the deceleration limit holds; where the velocity
/// changes sign or begins, the larger one, since the difference is a mean over both. It may do so within a scan:
/// then its mean there is at most what one scan of acceleration changes.
fn limits(rows: &Rows<'_>, axis: usize, derivatives: &Derivatives) -> [f64; 4] {
    let Some(axis) = rows.script.axes.get(axis) else {
        return [0.0; 4];
    };
    let limits = &axis.config.limits;
    let (before, now) = (derivatives.velocity_before, derivatives.orders[0]);
    let larger = limits.acceleration.max(limits.deceleration);
    let cycle = rows.script.cycle_ns as f64 / 1e9;
    let acceleration = if before * now <= 0.0 || now.abs().min(before.abs()) <= larger * cycle {
        larger
    } else if now.abs() > before.abs() {
        limits.acceleration
    } else {
        limits.deceleration
    };
    [limits.velocity, acceleration, limits.jerk, limits.snap]
}

/// What positions resolve in d1 to d4: 2^k units in the last place of the run's largest position, over
/// cycle^k. On a modulo axis it is the largest one of the unwrapped positions, and no less than a turn: from
/// there and back to the first turn a plan may lead.
fn resolved(rows: &Rows<'_>, axis: usize) -> [f64; 4] {
    let turn = rows.script.axes.get(axis).and_then(|axis| axis.config.modulo);
    let first = rows.position(axis, 0, 1).or_else(|| rows.position(axis, 0, 0));
    let mut position = first.unwrap_or(0.0);
    let mut largest = position.abs().max(turn.unwrap_or(0.0));
    for scan in 0..rows.count() {
        let Some(now) = rows.position(axis, scan, 0) else {
            break;
        };
        let before = rows.position(axis, scan, 1).unwrap_or(now);
        position = match turn {
            Some(_) => position + rows.way(axis, scan, 0, now - before),
            None => now,
        };
        if position.is_finite() {
            largest = largest.max(position.abs());
        }
    }
    let unit = largest.next_up() - largest;
    let cycle = rows.script.cycle_ns as f64 / 1e9;
    let mut slack = [0.0; 4];
    let mut scale = unit;
    for order in &mut slack {
        scale = 2.0 * scale / cycle;
        *order = scale;
    }
    slack
}
