//! The published sequence of steps: snap time, jerk time, acceleration time, velocity time, each the
//! smallest whole number of scans for which an inequality holds (docs/planner.md, section 4).

use super::problem::{Boxes, LONGEST, Problem, Ratio};
use crate::{Limits, Order};

/// The quantity that is exactly at its bound after a step, and so sets the amplitude of the next.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Held {
    /// The distance is covered.
    Distance,
    /// The velocity peak is the bound.
    Velocity,
    /// The acceleration peak is the bound.
    Acceleration,
    /// The jerk peak is the bound.
    Jerk,
}

/// The steps, with their ratios of bounds.
struct Steps<'a> {
    problem: &'a Problem,
    limits: &'a Limits,
    acceleration: f64,
    distance: f64,
    cycle: f64,
}

/// The box lengths of the published steps, or none (all 0) if one is too long to count. At most seven
/// bisections of 32 steps each.
pub(super) fn plan(problem: &Problem, distance: f64, limits: &Limits, cycle: f64) -> Boxes {
    let steps = Steps {
        problem,
        limits,
        acceleration: limits.lower_acceleration(),
        distance,
        cycle,
    };
    let (nd, held) = match problem.order {
        Order::Four => steps.snap_time(),
        // Without a snap bound the jerk jumps: the next step starts at its bound.
        Order::Three => (0, Held::Jerk),
        Order::Two => (0, Held::Acceleration),
    };
    let (nj, held) = match problem.order {
        Order::Four | Order::Three => steps.jerk_time(nd, held),
        Order::Two => (0, held),
    };
    let n2 = nd + nj;
    let m = nd + n2;
    let n3 = m + steps.acceleration_time(m, held);
    // The last step is n4 >= K4. If two ratios are reached only within the slack, their product can miss
    // its threshold; the thresholds of the products then require one scan more.
    let n4 = (m + n3).max(problem.least_n4(nd, n2, n3));
    let lengths = [nd, n2, n3, n4];
    if lengths.iter().any(|n| *n > LONGEST) {
        return [0; 4];
    }
    lengths.map(|n| n as u32)
}

impl Steps<'_> {
    /// nd and what holds the amplitude after it (docs/planner.md, eq. 10).
    fn snap_time(&self) -> (u64, Held) {
        let [k4, k3, k2, k1] = self.thresholds();
        let (j, s) = (self.limits.jerk, self.limits.snap);
        let (v, a, t) = (self.limits.velocity, self.acceleration, self.cycle);
        let mut held = Held::Distance;
        let mut n = least(1, |n| 8 * n * n * n * n >= k1);
        if 4 * u128::from(n) < k4 {
            let reach = Ratio::new(v / (s * t * t * t)).ceil();
            n = least(1, |n| 2 * n * n * n >= reach);
            held = Held::Velocity;
        }
        let n_wide = u128::from(n);
        let breaks_acceleration = match held {
            Held::Distance => 8 * n_wide * n_wide < k3,
            _ => 2 * n_wide < self.v_over_a().ceil(),
        };
        if breaks_acceleration {
            let reach = Ratio::new(a / (s * t * t)).ceil();
            n = least(1, |n| n * n >= reach);
            held = Held::Acceleration;
        }
        let n_wide = u128::from(n);
        let breaks_jerk = match held {
            Held::Distance => 8 * n_wide * n_wide * n_wide < k2,
            Held::Velocity => 2 * n_wide * n_wide < self.v_over_j().ceil(),
            _ => n_wide < self.a_over_j().ceil(),
        };
        if breaks_jerk {
            let reach = Ratio::new(j / (s * t)).ceil();
            n = least(1, |n| n >= reach);
            held = Held::Jerk;
        }
        (n, held)
    }

    /// nj and what holds the amplitude after it (docs/planner.md, eq. 11).
    fn jerk_time(&self, nd: u64, from: Held) -> (u64, Held) {
        let [k4, k3, k2, _] = self.thresholds();
        // At order 3 this is the first step, and its time may not be 0.
        let first = u64::from(nd == 0);
        let nd = u128::from(nd);
        let mut held = Held::Distance;
        let cubic = |n: u128| (nd + n) * (2 * nd + n) * (2 * nd + n);
        let mut n = match from {
            Held::Distance => 0,
            Held::Velocity => {
                let reach = self.x_over_v().ceil_times(nd * nd);
                least(first, |n| cubic(n) >= reach)
            }
            Held::Acceleration => {
                let reach = self.x_over_a().ceil_times(nd);
                least(first, |n| 2 * cubic(n) >= reach)
            }
            Held::Jerk => least(first, |n| 2 * cubic(n) >= k2),
        };
        if 2 * (2 * nd + u128::from(n)) < k4 {
            let square = |n: u128| (nd + n) * (2 * nd + n);
            n = match from {
                Held::Distance | Held::Velocity => 0,
                Held::Acceleration => {
                    let reach = self.v_over_a().ceil_times(nd);
                    least(first, |n| square(n) >= reach)
                }
                Held::Jerk => {
                    let reach = self.v_over_j().ceil();
                    least(first, |n| square(n) >= reach)
                }
            };
            held = Held::Velocity;
        }
        let m = 2 * nd + u128::from(n);
        let breaks_acceleration = match held {
            Held::Distance => 2 * m * m < k3,
            _ => m < self.v_over_a().ceil(),
        };
        if breaks_acceleration {
            n = match from {
                Held::Distance | Held::Velocity | Held::Acceleration => 0,
                Held::Jerk => {
                    let reach = self.a_over_j().ceil();
                    least(first, |n| nd + n >= reach)
                }
            };
            held = Held::Acceleration;
        }
        (n, held)
    }

    /// na (docs/planner.md, eq. 12), `m` = 2 nd + nj.
    fn acceleration_time(&self, m: u64, from: Held) -> u64 {
        let [k4, k3, _, _] = self.thresholds();
        let first = u64::from(m == 0);
        let m = u128::from(m);
        let square = |n: u128| (m + n) * (2 * m + n);
        let n = match from {
            Held::Distance => 0,
            Held::Velocity => {
                let reach = self.x_over_v().ceil_times(m);
                least(first, |n| square(n) >= reach)
            }
            Held::Acceleration | Held::Jerk => least(first, |n| square(n) >= k3),
        };
        if 2 * m + u128::from(n) >= k4 {
            return n;
        }
        match from {
            Held::Distance | Held::Velocity => 0,
            Held::Acceleration | Held::Jerk => {
                let reach = self.v_over_a().ceil();
                least(first, |n| m + n >= reach)
            }
        }
    }

    fn thresholds(&self) -> [u128; 4] {
        let Problem { k4, k3, k2, k1, .. } = *self.problem;
        [k4, k3, k2, k1].map(|k| k as u128)
    }

    fn x_over_v(&self) -> Ratio {
        Ratio::new(self.distance / (self.limits.velocity * self.cycle))
    }

    fn x_over_a(&self) -> Ratio {
        Ratio::new(self.distance / (self.acceleration * self.cycle * self.cycle))
    }

    fn v_over_a(&self) -> Ratio {
        Ratio::new(self.limits.velocity / (self.acceleration * self.cycle))
    }

    fn v_over_j(&self) -> Ratio {
        Ratio::new(self.limits.velocity / (self.limits.jerk * self.cycle * self.cycle))
    }

    fn a_over_j(&self) -> Ratio {
        Ratio::new(self.acceleration / (self.limits.jerk * self.cycle))
    }
}

/// The smallest whole number from `from` on for which `holds` is TRUE; it must stay TRUE once it is. The
/// longest count + 1 if there is none. 32 steps of bisection.
fn least(from: u64, holds: impl Fn(u128) -> bool) -> u64 {
    let (mut low, mut high) = (from, LONGEST + 1);
    for _ in 0..32 {
        if low >= high {
            break;
        }
        let middle = (low + high) / 2;
        if holds(u128::from(middle)) {
            high = middle;
        } else {
            low = middle + 1;
        }
    }
    low
}
