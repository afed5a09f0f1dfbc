//! The plan value and how it is made.

use super::problem::{Boxes, LONGEST, Problem};
use super::profile::{self, Cruise};
use super::search::{self, Family, Work};
use super::{Method, sequential};
use crate::error::{check_positive, distance};
use crate::{Field, Limits, Order, PlanError};

/// A rest-to-rest plan: a plain value of at most four box lengths and five scale factors.
///
/// Every output is computed from the scan count alone, so nothing accumulates: the last set-point is the
/// target to the bit, and asking for scans in any order gives the same bits.
// The data of a set-point at constant velocity come first: many axes wait for memory.
#[derive(Clone, Copy, Debug, PartialEq)]
#[repr(C)]
pub struct GridPlan {
    pub(super) scans: u32,
    pub(super) order: Order,
    method: Method,
    /// Whether the position sums need more than 64 bits.
    pub(super) wide: bool,
    pub(super) start: f64,
    pub(super) cruise: Cruise,
    /// The factors of the whole-number derivatives 0 to m of the profile (docs/planner.md, eq. 25).
    pub(super) scale: [f64; 5],
    pub(super) target: f64,
    pub(super) cycle: f64,
    /// The m box lengths of order m, shortest first, then zeros.
    pub(super) boxes: [u32; 4],
}

/// A plan is copied about by value, so it stays small.
const _: () = assert!(size_of::<GridPlan>() <= 120);

/// Durations of the segments in scans, as the published planner counts them (docs/planner.md, eq. 2).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Counts {
    /// Constant snap (scans); none at orders 3 and 2.
    pub nd: Option<u32>,
    /// Constant jerk (scans); none at order 2.
    pub nj: Option<u32>,
    /// Constant acceleration (scans).
    pub na: u32,
    /// Constant velocity (scans).
    pub nv: u32,
}

impl GridPlan {
    /// Plans from rest at `start` to rest at `target` (u) with sample time `cycle` (s).
    ///
    /// The bounds that are absent (infinite) set the order; see [`Limits::order`]. If acceleration and
    /// deceleration differ, the lower one applies to both. Cost: see [`GridPlan::new_counted`].
    ///
    /// # Errors
    /// - [`PlanError::InvalidInput`]: `cycle` or a bound is not positive, `start` or `target` is not finite,
    ///   or their distance, or the fourth power of a frequency of scans, is beyond the range of `f64`.
    /// - [`PlanError::Unbounded`]: no bound at all.
    /// - [`PlanError::TooLong`]: more than 2^31 - 1 scans; names the bound that makes it so, or the target where the distance in scans
    ///   is beyond the range of `f64`.
    pub fn new(
        method: Method,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::with_work(method, start, target, limits, cycle, &mut Work::default())
    }

    /// The same as [`GridPlan::new`], with the work of the search.
    ///
    /// Bounded: `Sequential` takes at most seven bisections of 32 steps, `Grid` and `Overlapped` at most
    /// [`MAX_ROWS`](super::MAX_ROWS) rows and [`MAX_CANDIDATES`](super::MAX_CANDIDATES) candidates (measured
    /// counts in docs/planner.md, section 9). A search cut short by these caps returns the shorter one of
    /// its best and the `Sequential` plan.
    ///
    /// # Errors
    /// Those of [`GridPlan::new`].
    pub fn new_counted(
        method: Method,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
    ) -> Result<(Self, Work), PlanError> {
        let mut work = Work::default();
        let plan = Self::with_work(method, start, target, limits, cycle, &mut work)?;
        Ok((plan, work))
    }

    fn with_work(
        method: Method,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
        work: &mut Work,
    ) -> Result<Self, PlanError> {
        let distance = checked_distance(start, target, limits, cycle)?;
        let order = limits.order();
        // Built in one expression: fields written one by one and then copied would wait for their stores.
        let plan = |boxes, scans, scale, wide, cruise| Self {
            start,
            target,
            cycle,
            scale,
            boxes,
            scans,
            order,
            method,
            wide,
            cruise,
        };
        if distance == 0.0 {
            return Ok(plan([0; 4], 0, [0.0; 5], false, Cruise::NONE));
        }
        let length = distance.abs();
        let problem = Problem::new(length, limits, cycle)?;
        let (boxes, searched) = choose(method, &problem, length, limits, cycle);
        *work = searched;
        let scans = sum(&boxes);
        if !(1..=LONGEST).contains(&scans) {
            return Err(problem.too_long(limits));
        }
        let [n1, n2, n3, n4] = boxes;
        let boxes = match order {
            Order::Four => [n1, n2, n3, n4],
            Order::Three => [n2, n3, n4, 0],
            Order::Two => [n3, n4, 0, 0],
        };
        let (scale, wide) = profile::scale(order, product(order, boxes), distance, cycle);
        let cruise = if wide {
            Cruise::NONE
        } else {
            Cruise::new(order, boxes, &scale)
        };
        Ok(plan(boxes, scans as u32, scale, wide, cruise))
    }

    /// The same move in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.start += by;
        self.target += by;
    }

    /// Start of the move (u).
    pub const fn start(&self) -> f64 {
        self.start
    }

    /// Target of the move (u).
    pub const fn target(&self) -> f64 {
        self.target
    }

    /// Sample time (s).
    pub const fn cycle(&self) -> f64 {
        self.cycle
    }

    /// The order of the plan.
    pub const fn order(&self) -> Order {
        self.order
    }

    /// How the box lengths were chosen.
    pub const fn method(&self) -> Method {
        self.method
    }

    /// Number of scans N, the sum of the boxes; 0 when the target is the start.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// Duration (s), `scans * cycle`.
    pub fn duration(&self) -> f64 {
        f64::from(self.scans) * self.cycle
    }

    /// The box lengths in scans, shortest first: as many as the order; none when there is nothing to move.
    pub fn boxes(&self) -> &[u32] {
        let count = if self.scans == 0 { 0 } else { self.order.degree() };
        self.boxes.get(..count).unwrap_or(&[])
    }

    /// Product of the box lengths: the whole number the distance is divided by (docs/planner.md, eq. 4).
    pub fn product(&self) -> u128 {
        product(self.order, self.boxes)
    }

    /// The published planner's segment durations. None for [`Method::Overlapped`], whose cruise may have
    /// a negative length, and none if there is nothing to move.
    pub fn counts(&self) -> Option<Counts> {
        if self.method == Method::Overlapped || self.scans == 0 {
            return None;
        }
        let [n1, n2, n3, n4] = match (self.order, self.boxes) {
            (Order::Four, boxes) => boxes,
            (Order::Three, [n2, n3, n4, _]) => [0, n2, n3, n4],
            (Order::Two, [n3, n4, _, _]) => [0, 0, n3, n4],
        };
        Some(Counts {
            nd: (self.order == Order::Four).then_some(n1),
            nj: (self.order != Order::Two).then_some(n2 - n1),
            na: n3 - n1 - n2,
            nv: n4 - n1 - n2 - n3,
        })
    }

    /// The signed snap (order 4, u/s^4), jerk (order 3, u/s^3) or acceleration (order 2, u/s^2) the plan
    /// switches on and off (docs/planner.md, eq. 5).
    pub fn amplitude(&self) -> f64 {
        highest(self.order, &self.scale)
    }
}

/// The factor of the highest derivative that a plan of this order has.
pub(super) fn highest(order: Order, scale: &[f64; 5]) -> f64 {
    scale.get(order.degree()).copied().unwrap_or(0.0)
}

/// Product of the boxes of a plan.
fn product(order: Order, boxes: [u32; 4]) -> u128 {
    let [a, b, c, d] = boxes.map(u64::from);
    match order {
        Order::Four => u128::from(a * b) * u128::from(c * d),
        Order::Three => u128::from(a * b) * u128::from(c),
        Order::Two => u128::from(a * b),
    }
}

/// The boxes by one method, none if they are too long to count, and the work of the search.
pub(super) fn choose(
    method: Method,
    problem: &Problem,
    length: f64,
    limits: &Limits,
    cycle: f64,
) -> (Boxes, Work) {
    let step_by_step = || sequential::plan(problem, length, limits, cycle);
    let (best, work) = match method {
        Method::Sequential => return (step_by_step(), Work::default()),
        Method::Grid => search::fewest(problem, Family::Separate),
        Method::Overlapped => search::fewest(problem, Family::Overlapped),
    };
    if work.capped {
        let other = step_by_step();
        if sum(&other) > 0 && sum(&other) < sum(&best) {
            return (other, work);
        }
    }
    (best, work)
}

/// The scans of all boxes together.
fn sum(boxes: &Boxes) -> u64 {
    boxes.iter().map(|n| u64::from(*n)).sum()
}

/// The signed distance (u) of a move whose inputs are all usable.
pub(super) fn checked_distance(
    start: f64,
    target: f64,
    limits: &Limits,
    cycle: f64,
) -> Result<f64, PlanError> {
    check_positive(Field::Cycle, cycle)?;
    let distance = distance(start, target)?;
    limits.check()?;
    if limits.is_unbounded() {
        return Err(PlanError::Unbounded);
    }
    // The first three derivatives can't exceed the larger of this and the distance.
    let squared = cycle * cycle;
    if !(1.0 / (squared * squared)).is_finite() {
        return Err(PlanError::InvalidInput {
            field: Field::Cycle,
            value: cycle,
        });
    }
    if !(distance / (squared * squared)).is_finite() {
        return Err(PlanError::too_far(target));
    }
    Ok(distance)
}
