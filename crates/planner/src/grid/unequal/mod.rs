//! Rest to rest with every switching instant on the sample grid where acceleration and deceleration differ
//! (docs/planner.md, section 12).

mod lattice;
mod profile;
mod search;

pub use lattice::MAX_RAMP_ROWS;
pub use profile::UnequalSegments;
pub use search::UnequalWork;

use super::plan::{checked_distance, choose, highest};
use super::problem::Problem;
use super::search::Family;
use super::{Method, profile::scale};
use crate::{Limits, Order, PlanError};
use lattice::{Ramp, Thresholds};
use search::Found;

/// A ramp between rest and the velocity in the middle.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Half {
    /// The m - 1 box lengths, shortest first, then zeros.
    boxes: [u32; 3],
    /// The factors of its whole-number derivatives 0 to m (docs/planner.md, eq. 36).
    scale: [f64; 5],
    /// Whether the position sums need more than 64 bits.
    wide: bool,
}

/// A rest-to-rest plan that speeds up with one rate and slows down with another: a plain value.
///
/// It has two ramps of up to three boxes each, and a cruise between them, which may have a negative
/// length. As for [`GridPlan`](super::GridPlan), every output is computed from the scan count alone, and
/// the last set-point is the target to the bit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct UnequalPlan {
    start: f64,
    target: f64,
    cycle: f64,
    /// Velocity between the ramps (u/s), signed.
    velocity: f64,
    /// Half the distance of a scan at that velocity (u), signed.
    half_way: f64,
    up: Half,
    down: Half,
    scans: u32,
    order: Order,
}

/// A plan is copied about by value, so it stays small.
const _: () = assert!(size_of::<UnequalPlan>() <= 176);

impl UnequalPlan {
    /// The same move in coordinates moved by `by` (u).
    pub(crate) fn shift(&mut self, by: f64) {
        self.start += by;
        self.target += by;
    }

    /// Plans from rest at `start` to rest at `target` (u) with sample time `cycle` (s): the fewest scans
    /// in `family`. The speed grows by at most `limits.acceleration` and falls by at most
    /// `limits.deceleration`. Never longer than [`GridPlan`](super::GridPlan) with the lower one of both.
    ///
    /// Cost: see [`UnequalPlan::new_counted`].
    ///
    /// # Errors
    /// Those of [`GridPlan::new`](super::GridPlan::new).
    pub fn new(
        family: Family,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        Self::new_counted(family, start, target, limits, cycle).map(|(plan, _)| plan)
    }

    /// The same as [`UnequalPlan::new`], with the work of the search.
    ///
    /// Bounded: at most twice [`MAX_RAMP_ROWS`] rows (measured counts in docs/planner.md, section 12). A search cut
    /// short by them returns the shorter one of its best and [`GridPlan`](super::GridPlan) with the lower rate.
    ///
    /// # Errors
    /// Those of [`GridPlan::new`](super::GridPlan::new).
    pub fn new_counted(
        family: Family,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
    ) -> Result<(Self, UnequalWork), PlanError> {
        let distance = checked_distance(start, target, limits, cycle)?;
        let nothing = Half {
            boxes: [0; 3],
            scale: [0.0; 5],
            wide: false,
        };
        let mut plan = Self {
            start,
            target,
            cycle,
            velocity: 0.0,
            half_way: 0.0,
            up: nothing,
            down: nothing,
            scans: 0,
            order: limits.order(),
        };
        if distance == 0.0 {
            return Ok((plan, UnequalWork::default()));
        }
        let length = distance.abs();
        // A move that is too long here is too long with any rates (docs/planner.md, eq. 8).
        let one_rate = Problem::new(length, limits, cycle)?;
        let (mut found, work) = search::fewest(&Thresholds::new(length, limits, cycle), family);
        if work.capped {
            let method = match family {
                Family::Separate => Method::Grid,
                Family::Overlapped => Method::Overlapped,
            };
            let (boxes, _) = choose(method, &one_rate, length, limits, cycle);
            found = shorter(found, boxes.map(f64::from));
        }
        let found = found.ok_or_else(|| one_rate.too_long(limits))?;
        let ramps = lattice::sum(found.up) + lattice::sum(found.down);
        plan.scans = found.scans as u32;
        // M, at most 2^32.
        let m = 2.0 * found.scans - ramps;
        plan.half_way = distance / m;
        plan.velocity = 2.0 * (distance / (m * cycle));
        plan.up = half(plan.order, found.up, m, distance, cycle);
        plan.down = half(plan.order, found.down, m, distance, cycle);
        Ok((plan, work))
    }

    /// Start of the move (u).
    pub const fn start(&self) -> f64 {
        self.start
    }

    /// Target of the move (u).
    pub const fn target(&self) -> f64 {
        self.target
    }

    /// The order of the plan.
    pub const fn order(&self) -> Order {
        self.order
    }

    /// Number of scans N; 0 when the target is the start.
    pub const fn scans(&self) -> u32 {
        self.scans
    }

    /// Duration (s), `scans * cycle`.
    pub fn duration(&self) -> f64 {
        f64::from(self.scans) * self.cycle
    }

    /// The box lengths of the ramp up in scans, shortest first: one fewer than the order; none when there is
    /// nothing to move.
    pub fn up(&self) -> &[u32] {
        self.boxes(&self.up)
    }

    /// The box lengths of the ramp down, as [`UnequalPlan::up`].
    pub fn down(&self) -> &[u32] {
        self.boxes(&self.down)
    }

    /// The signed snap (order 4, u/s^4), jerk (order 3, u/s^3) or acceleration (order 2, u/s^2) that the ramp up
    /// switches on and off, and that of the ramp down (docs/planner.md, eq. 28).
    pub fn amplitudes(&self) -> [f64; 2] {
        [&self.up, &self.down].map(|half| highest(self.order, &half.scale))
    }

    fn boxes<'a>(&self, half: &'a Half) -> &'a [u32] {
        let count = if self.scans == 0 {
            0
        } else {
            self.order.degree() - 1
        };
        half.boxes.get(..count).unwrap_or(&[])
    }
}

/// The ramps found, or those of a plan with one rate if that is shorter.
fn shorter(found: Option<Found>, boxes: [f64; 4]) -> Option<Found> {
    let [n1, n2, n3, n4] = boxes;
    let scans = n1 + n2 + n3 + n4;
    let one_rate = Found {
        scans,
        up: [n1, n2, n3],
        down: [n1, n2, n3],
    };
    match found {
        Some(found) if scans == 0.0 || found.scans <= scans => Some(found),
        _ => (scans > 0.0).then_some(one_rate),
    }
}

/// A ramp as it is evaluated, where the velocity between the ramps is 2 distance / (m cycle).
fn half(order: Order, ramp: Ramp, m: f64, distance: f64, cycle: f64) -> Half {
    let [n1, n2, n3] = ramp.map(|n| n as u32);
    let boxes = match order {
        Order::Four => [n1, n2, n3],
        Order::Three => [n2, n3, 0],
        Order::Two => [n3, 0, 0],
    };
    let product = boxes.iter().map(|n| u128::from((*n).max(1))).product::<u128>();
    // P of a plan with one rate is half of this, so the factors are twice as large: exactly so.
    let (scale, _) = scale(order, product * m as u128, distance, cycle);
    // The largest position sum asked for: that of a whole ramp, m!/2 times the product and the sum.
    let largest = 12 * product * boxes.iter().map(|n| u128::from(*n)).sum::<u128>();
    Half {
        boxes,
        scale: scale.map(|factor| 2.0 * factor),
        wide: largest > i64::MAX as u128,
    }
}
