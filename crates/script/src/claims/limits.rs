//! The claim that an axis stays within its limits, judged on published positions alone.
//!
//! A backward difference of order k over cycle^k is a mean of the k-th derivative. So where the continuous plan
//! keeps a limit, the difference keeps it too. The published positions are roundings of that plan. Each may be off
//! by at most one unit in the last place of the largest position P of the run: a move from far away towards 0
//! carries the rounding of its start. The k-th difference adds 2^k of these units. So in every scan
//!
//! ```text
//! |d_k| <= limit_k * factor * (1 + 1e-9) + 2^k * ulp(P) / cycle^k
//! ```
//!
//! The 1e-9 is the accuracy the planner states for its limits.

use super::judge::{Listed, failure};
use super::place::{Stretch, within_run};
use super::{Failure, Judge, describe};
use crate::model::Range;
use crate::run::{Derivatives, Rows};
use standstill_trace::shortest;
use std::collections::BTreeMap;
use std::ops;

/// Relative accuracy of limits.
const RELATIVE: f64 = 1e-9;

/// d1 to d4 of the axis stay within its limits times `factor`, plus the resolution of positions.
pub(super) struct WithinLimits {
    axis: usize,
    factor: f64,
    reach: Reach,
    /// By order, and by the least unit in the last place with which a scan would keep the limit; the unit
    /// of the run is known only at its end. With a NaN no unit is enough.
    broken: [BTreeMap<Unit, Broken>; 4],
}

/// A power of two, or infinity; its bits, which have the same order. [`NEVER`] is greater than all.
type Unit = u64;

const NEVER: Unit = u64::MAX;

/// Scans outside the limit.
#[derive(Clone, Copy, Debug)]
struct Broken {
    /// The first of them, its value and the limit.
    first: (u64, f64, f64),
    scans: Listed,
}

impl WithinLimits {
    pub(super) fn new(axis: usize, factor: f64) -> Self {
        Self {
            axis,
            factor,
            reach: Reach::default(),
            broken: Default::default(),
        }
    }

    /// The scans of an order that are outside at this unit.
    fn outside(&self, order: usize, unit: f64) -> Option<Broken> {
        let above = self.broken.get(order)?.range(unit.to_bits() + 1..);
        above.map(|(_, broken)| *broken).reduce(|one, other| Broken {
            first: if one.first.0 < other.first.0 {
                one.first
            } else {
                other.first
            },
            scans: one.scans.with(&other.scans),
        })
    }
}

impl Judge for WithinLimits {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let axis = self.axis;
        self.reach.look(rows, axis, &stretch.next);
        let cycle = rows.script.cycle_ns as f64 / 1e9;
        let unit = self.reach.unit();
        let slack = resolved(unit, cycle);
        for scan in stretch.inside.clone() {
            let Some(derivatives) = rows.derivatives(axis, scan) else {
                continue;
            };
            let limits = limits(rows, axis, &derivatives);
            for order in 0..4 {
                let value = derivatives.orders[order];
                let bound = limits[order] * self.factor;
                // Written so that a NaN breaks the limit.
                let keeps = |slack: f64| value.abs() <= bound * (1.0 + RELATIVE) + slack;
                if keeps(slack[order]) {
                    continue;
                }
                // At most 2098 of them.
                let mut greater =
                    std::iter::successors(Some(unit), |unit| (*unit < f64::INFINITY).then_some(unit * 2.0));
                let least = greater.find(|unit| keeps(resolved(*unit, cycle)[order]));
                let new = Broken {
                    first: (scan, value, bound),
                    scans: Listed::default(),
                };
                let broken = self.broken[order]
                    .entry(least.map_or(NEVER, f64::to_bits))
                    .or_insert(new);
                broken.scans.add(scan);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        if let Err(failure) = within_run(rows, path, range) {
            return vec![failure];
        }
        let name = describe::axis_name(rows, self.axis);
        let unit = self.reach.unit();
        let orders = (0..4).filter_map(|order| Some((order + 1, self.outside(order, unit)?)));
        orders
            .map(|(order, broken)| {
                let (scan, value, bound) = broken.first;
                let text = format!(
                    "{} at scan {scan}, expected of magnitude <= {}; broken {}",
                    shortest(value),
                    shortest(bound),
                    broken.scans
                );
                let path = format!("{path}.within_limits.{name}.Position.d{order}");
                failure(&path, Some(scan), text)
            })
            .collect()
    }
}

/// The limits of d1 to d4 in a scan. While the speed falls the deceleration limit applies. If the velocity begins
/// or changes its sign, the larger limit applies, because the difference is a mean over both. The sign may change
/// within a scan; its mean there is at most the change by one scan of acceleration.
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

/// The largest position of the run so far. On a modulo axis it is the largest of the unwrapped positions,
/// and at least a turn, because a plan may go from there back to the first turn.
#[derive(Clone, Copy, Debug, Default)]
struct Reach {
    /// Unwrapped.
    position: Option<f64>,
    largest: f64,
}

impl Reach {
    fn look(&mut self, rows: &Rows<'_>, axis: usize, next: &ops::Range<u64>) {
        let turn = rows.script.axes.get(axis).and_then(|axis| axis.config.modulo);
        let mut position = match self.position {
            Some(position) => position,
            None => {
                let first = rows.position(axis, 0, 1).or_else(|| rows.position(axis, 0, 0));
                let first = first.unwrap_or(0.0);
                self.largest = first.abs().max(turn.unwrap_or(0.0));
                first
            }
        };
        for scan in next.clone() {
            let Some(now) = rows.position(axis, scan, 0) else {
                break;
            };
            let before = rows.position(axis, scan, 1).unwrap_or(now);
            position = match turn {
                Some(_) => position + rows.way(axis, scan, 0, now - before),
                None => now,
            };
            if position.is_finite() {
                self.largest = self.largest.max(position.abs());
            }
        }
        self.position = Some(position);
    }

    /// Its unit in the last place.
    fn unit(&self) -> f64 {
        self.largest.next_up() - self.largest
    }
}

/// The resolution of d1 to d4 with this unit in the last place: 2^k of them over cycle^k.
fn resolved(unit: f64, cycle: f64) -> [f64; 4] {
    let mut slack = [0.0; 4];
    let mut scale = unit;
    for order in &mut slack {
        scale = 2.0 * scale / cycle;
        *order = scale;
    }
    slack
}
