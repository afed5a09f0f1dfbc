//! The continuous profile of two unequal ramps (docs/planner.md, section 12).

use super::super::profile::{Peaks, Segment, Side, backwards, forwards, sums};
use super::{Half, UnequalPlan};
use crate::math::{max, sqrt};
use crate::{Order, Setpoint};

/// Largest number of instants at which the highest derivative jumps.
const MAX_INSTANTS: usize = 16;

impl Half {
    /// Length of the ramp (scans).
    fn scans(&self) -> i64 {
        self.boxes.iter().map(|n| i64::from(*n)).sum()
    }

    /// The switching instants of the ramp, in scans from its end at rest (docs/planner.md, eq. 20): the first
    /// four are those of order 3, the first two those of order 2.
    #[inline]
    fn instants(&self) -> [i64; 8] {
        let [a, b, c] = self.boxes.map(i64::from);
        [0, a, b, a + b, c, a + c, b + c, a + b + c]
    }
}

impl UnequalPlan {
    /// The continuous profile at `scan` cycles after the start, in O(1): at most nine terms.
    ///
    /// From [`UnequalPlan::scans`] on the profile is at rest on the target, to the bit. Only at order 4 the snap of
    /// the last segment shows at the last scan itself. The position is always between start and target and never
    /// steps back.
    pub fn at(&self, scan: u64) -> Setpoint {
        let scans = u64::from(self.scans);
        if scan < scans {
            return self.state(scan as i64, Side::Before);
        }
        let mut end = Setpoint::at_rest(self.target);
        if scan == scans {
            let [.., snap] = self.down.scale;
            end.snap = 0.0 - snap;
        }
        end
    }

    /// The segments from start to end; none of zero length.
    pub fn segments(&self) -> UnequalSegments {
        UnequalSegments {
            plan: *self,
            index: 0,
        }
    }

    /// Largest magnitudes of the continuous plan (docs/planner.md, eq. 6 and 38).
    pub fn peaks(&self) -> Peaks {
        let of = |half: &Half| {
            let [a, b, _] = half.boxes.map(f64::from);
            let [_, _, f2, f3, f4] = half.scale.map(f64::abs);
            match self.order {
                Order::Four => [2.0 * a * b * f2, a * f3, f4],
                Order::Three => [a * f2, f3, 0.0],
                Order::Two => [f2, 0.0, 0.0],
            }
        };
        let ([a_up, j_up, s_up], [a_down, j_down, s_down]) = (of(&self.up), of(&self.down));
        Peaks {
            velocity: self.velocity.abs() - self.cut_off(),
            acceleration: max(a_up, a_down),
            jerk: (self.order != Order::Two).then_some(max(j_up, j_down)),
            snap: (self.order == Order::Four).then_some(max(s_up, s_down)),
        }
    }

    /// The velocity that the overlap of the ramps cuts off between them (u/s) (docs/planner.md, eq. 38).
    fn cut_off(&self) -> f64 {
        let overlap = (self.up.scans() - self.begin_of_down()) as f64;
        if overlap <= 0.0 {
            return 0.0;
        }
        let [_, f_up, ..] = self.up.scale.map(f64::abs);
        let [_, f_down, ..] = self.down.scale.map(f64::abs);
        // At the instant when the effects of both snap pulses are equal the acceleration is zero.
        let (root_up, root_down) = (sqrt(f_up), sqrt(f_down));
        let of_down = overlap * (root_up / (root_up + root_down));
        let of_up = overlap - of_down;
        f_up * (of_up * of_up * of_up) + f_down * (of_down * of_down * of_down)
    }

    /// The scan in which the ramp down begins.
    fn begin_of_down(&self) -> i64 {
        i64::from(self.scans) - self.down.scans()
    }

    /// The state at `scan` <= N, with the values of one side where a derivative jumps.
    #[inline(always)]
    fn state(&self, scan: i64, side: Side) -> Setpoint {
        // Instants before this have been passed.
        let passed = scan + i64::from(side == Side::After);
        let (ramp, begin) = (self.up.scans(), self.begin_of_down());
        if passed <= ramp {
            let sums = sums(self.order, self.up.wide, &self.up.instants(), scan, passed);
            let state = forwards(self.start, &sums, &self.up.scale);
            if passed > begin {
                return self.less_first_pulse(state, (scan - begin) as f64);
            }
            return state;
        }
        let left = i64::from(self.scans) - scan;
        if passed > begin {
            // Time runs backwards from the far end, so the sides swap there.
            let through = left + i64::from(side == Side::Before);
            let sums = sums(self.order, self.down.wide, &self.down.instants(), left, through);
            return backwards(self.target, &sums, &self.down.scale);
        }
        let position = if scan > left {
            self.target - (2 * left - self.down.scans()) as f64 * self.half_way
        } else {
            self.start + (2 * scan - ramp) as f64 * self.half_way
        };
        Setpoint {
            position,
            velocity: self.velocity + 0.0,
            ..Setpoint::default()
        }
    }

    /// The state `since` scans into the overlap: the ramp up less the first snap pulse of the ramp down
    /// (docs/planner.md, eq. 37).
    fn less_first_pulse(&self, up: Setpoint, since: f64) -> Setpoint {
        let [f0, f1, f2, f3, f4] = self.down.scale;
        let squared = since * since;
        Setpoint {
            position: up.position - f0 * (squared * squared),
            velocity: up.velocity - f1 * (squared * since),
            acceleration: up.acceleration - f2 * squared,
            jerk: up.jerk - f3 * since,
            snap: up.snap - f4 + 0.0,
        }
    }

    /// The switching instants in ascending order, in scans from the start, and how many there are.
    fn instants(&self) -> ([i64; MAX_INSTANTS], usize) {
        let each = if self.scans == 0 {
            0
        } else {
            1 << (self.order.degree() - 1)
        };
        let mut instants = [0; MAX_INSTANTS];
        let up = self.up.instants().into_iter().take(each);
        let down = self.down.instants().into_iter().take(each).rev();
        let down = down.map(|instant| i64::from(self.scans) - instant);
        for (slot, instant) in instants.iter_mut().zip(up.chain(down)) {
            *slot = instant;
        }
        // Only the end of the ramp up and the begin of the ramp down can be in the other order.
        if let Some([end_of_up, begin_of_down]) = instants.get_mut(each.max(1) - 1..=each)
            && end_of_up > begin_of_down
        {
            core::mem::swap(end_of_up, begin_of_down);
        }
        (instants, 2 * each)
    }
}

/// The segments of a plan in order, at most 15; made by [`UnequalPlan::segments`].
#[derive(Clone, Debug)]
pub struct UnequalSegments {
    plan: UnequalPlan,
    index: usize,
}

impl Iterator for UnequalSegments {
    type Item = Segment;

    fn next(&mut self) -> Option<Segment> {
        let (instants, count) = self.plan.instants();
        let mut pairs = instants
            .iter()
            .zip(instants.iter().skip(1))
            .take(count.max(1) - 1);
        // Bounded by the instants.
        for (from, to) in pairs.by_ref().skip(self.index) {
            self.index += 1;
            if to > from {
                let state = self.plan.state(*from, Side::After);
                return Some(Segment::of(to - from, self.plan.cycle, &state));
            }
        }
        None
    }
}
