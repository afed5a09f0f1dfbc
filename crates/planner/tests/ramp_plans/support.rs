//! Random numbers, random problems, and an integrator that shares no code with the planner.

use standstill_planner::{DirectedLimits, Limits, OnlinePlan, Order, Peaks, RampPlan, Segment, Setpoint};
pub use standstill_testkit::Random;

/// Limits of the size servo axes have, with every order and a snap bound without a jerk bound among them.
pub fn limits(random: &mut Random, order: Order) -> Limits {
    let velocity = random.log(0.01, 10.0);
    let acceleration = velocity * random.log(1.0, 300.0);
    let deceleration = acceleration
        * if random.below(3) == 0 {
            1.0
        } else {
            random.log(0.2, 5.0)
        };
    let jerk = acceleration * random.log(1.0, 1000.0);
    let snap = jerk * random.log(1.0, 3000.0);
    let unbounded = f64::INFINITY;
    Limits {
        velocity,
        acceleration,
        deceleration,
        jerk: match order {
            Order::Two => unbounded,
            Order::Three => jerk,
            Order::Four => {
                if random.below(8) == 0 {
                    unbounded
                } else {
                    jerk
                }
            }
        },
        snap: if order == Order::Four { snap } else { unbounded },
    }
}

pub const ORDERS: [Order; 3] = [Order::Two, Order::Three, Order::Four];

/// Each bound times a factor of its own.
pub fn each_times(limits: &Limits, mut factor: impl FnMut() -> f64) -> Limits {
    Limits {
        velocity: limits.velocity * factor(),
        acceleration: limits.acceleration * factor(),
        deceleration: limits.deceleration * factor(),
        jerk: limits.jerk * factor(),
        snap: limits.snap * factor(),
    }
}

/// Units of length and time a million times larger or smaller, which is no power of two.
pub const UNITS: [(f64, f64); 4] = [(1e6, 1.0), (1e-6, 1.0), (1.0, 1e6), (1.0, 1e-6)];

/// A value with this many units of time in its denominator, in other units of length and time.
pub fn scaled(value: f64, degree: u32, (length, time): (f64, f64)) -> f64 {
    (0..degree).fold(value * length, |value, _| value / time)
}

pub fn scaled_limits(limits: &Limits, unit: (f64, f64)) -> Limits {
    Limits {
        velocity: scaled(limits.velocity, 1, unit),
        acceleration: scaled(limits.acceleration, 2, unit),
        deceleration: scaled(limits.deceleration, 2, unit),
        jerk: scaled(limits.jerk, 3, unit),
        snap: scaled(limits.snap, 4, unit),
    }
}

pub fn scaled_state(state: &Setpoint, unit: (f64, f64)) -> Setpoint {
    Setpoint {
        position: scaled(state.position, 0, unit),
        velocity: scaled(state.velocity, 1, unit),
        acceleration: scaled(state.acceleration, 2, unit),
        jerk: scaled(state.jerk, 3, unit),
        snap: scaled(state.snap, 4, unit),
    }
}

/// A plan as its segments.
pub trait Segmented: std::fmt::Debug {
    fn list(&self) -> Vec<Segment>;
    fn largest(&self) -> Peaks;
}

impl Segmented for RampPlan {
    fn list(&self) -> Vec<Segment> {
        self.segments().collect()
    }
    fn largest(&self) -> Peaks {
        self.peaks()
    }
}

impl Segmented for OnlinePlan {
    fn list(&self) -> Vec<Segment> {
        self.segments().collect()
    }
    fn largest(&self) -> Peaks {
        self.peaks()
    }
}

/// What happened along a plan, as [`integrate`] saw it.
#[derive(Clone, Copy, Debug, Default)]
pub struct Seen {
    pub end: Setpoint,
    pub v_max: f64,
    pub v_min: f64,
    /// Largest acceleration with, and against, the direction of motion.
    pub speeding: f64,
    pub slowing: f64,
    pub jerk: f64,
    pub snap: f64,
    pub duration: f64,
}

impl Seen {
    /// By how much velocity, acceleration, jerk and snap were above their bounds, relative to them.
    pub fn over(&self, limits: impl Into<DirectedLimits>) -> [f64; 4] {
        let DirectedLimits {
            positive,
            negative,
            limits,
        } = limits.into();
        let over = |value: f64, bound: f64| value / bound - 1.0;
        [
            over(self.v_max, positive).max(over(-self.v_min, negative)),
            over(self.speeding, limits.acceleration).max(over(self.slowing, limits.deceleration)),
            over(self.jerk, limits.jerk),
            over(self.snap, limits.snap),
        ]
    }

    /// Whether every bound was kept.
    pub fn inside(&self, limits: impl Into<DirectedLimits>) -> bool {
        self.over(limits).iter().all(|over| *over <= 1e-9)
    }
}

/// Integrates a move to `target` from the position 0, so that a far start costs no digits. Also returns by how much
/// its end misses the target, beyond what the positions themselves resolve and relative to the length of the move.
pub fn arrive(start: &Setpoint, plan: &OnlinePlan, target: f64, order: Order) -> (Seen, f64) {
    let origin = Setpoint {
        position: 0.0,
        ..*start
    };
    let seen = integrate(&origin, plan, order);
    let resolved = 32.0 * f64::EPSILON * (start.position.abs() + target.abs());
    let off = (seen.end.position - (target - start.position)).abs();
    let travelled = plan.peaks().velocity * plan.duration();
    let miss = (off - resolved).max(0.0) / travelled.max(f64::MIN_POSITIVE);
    (seen, miss)
}

/// Follows the highest derivative of each segment from `start` by many small Taylor steps, and finds the
/// extremes between them by bisection on the sign of the derivative.
pub fn integrate(start: &Setpoint, plan: &impl Segmented, order: Order) -> Seen {
    let (mut p, mut v, mut a, mut j) = (start.position, start.velocity, start.acceleration, start.jerk);
    let mut seen = Seen {
        v_max: v,
        v_min: v,
        ..Seen::default()
    };
    const STEPS: u32 = 16;
    let peaks = plan.largest();
    let fastest = peaks.velocity.max(v.abs());
    for segment in plan.list() {
        assert!(segment.duration > 0.0, "a segment of no length");
        let s = segment.snap;
        // Quantities that may not jump continue, within the resolution of a clock that has run for a while; from
        // here on the stated state holds.
        let gap = (segment.velocity - v).abs();
        assert!(gap <= 1e-12 * fastest, "velocity jumps by {gap:e} in {plan:?}");
        if order >= Order::Three {
            let gap = (segment.acceleration - a).abs();
            assert!(
                gap <= 1e-9 * peaks.acceleration,
                "acceleration jumps by {gap:e} in {plan:?}"
            );
        }
        if order >= Order::Four {
            let gap = (segment.jerk - j).abs();
            assert!(gap <= 1e-8 * peaks.jerk, "jerk jumps by {gap:e} in {plan:?}");
        }
        (v, a, j) = (segment.velocity, segment.acceleration, segment.jerk);
        seen.snap = seen.snap.max(s.abs());
        seen.duration += segment.duration;
        let h = segment.duration / f64::from(STEPS);
        for _ in 0..STEPS {
            let vel = |t: f64| v + a * t + j * t * t / 2.0 + s * t * t * t / 6.0;
            let acc = |t: f64| a + j * t + s * t * t / 2.0;
            let jer = |t: f64| j + s * t;
            let mut look = |t: f64| {
                let (v, a) = (vel(t), acc(t));
                seen.v_max = seen.v_max.max(v);
                seen.v_min = seen.v_min.min(v);
                seen.jerk = seen.jerk.max(jer(t).abs());
                if v.abs() <= 1e-12 * fastest {
                    // Rounding decides the sign here; other instants of the segment show it.
                } else if v * a > 0.0 {
                    seen.speeding = seen.speeding.max(a.abs());
                } else {
                    seen.slowing = seen.slowing.max(a.abs());
                }
            };
            look(0.0);
            look(h);
            for f in [&acc as &dyn Fn(f64) -> f64, &jer] {
                if f(0.0) * f(h) < 0.0 {
                    look(zero(f, h));
                }
            }
            // Where the velocity passes zero the acceleration belongs to both directions.
            if vel(0.0).abs().min(vel(h).abs()) > 1e-12 * fastest && vel(0.0) * vel(h) < 0.0 {
                let passing = acc(zero(&vel, h)).abs();
                seen.speeding = seen.speeding.max(passing);
                seen.slowing = seen.slowing.max(passing);
            }
            let t = h;
            (p, v, a, j) = (
                p + v * t + a * t * t / 2.0 + j * t * t * t / 6.0 + s * t * t * t * t / 24.0,
                vel(t),
                acc(t),
                jer(t),
            );
        }
    }
    seen.end = Setpoint {
        position: p,
        velocity: v,
        acceleration: a,
        jerk: j,
        snap: 0.0,
    };
    seen
}

/// The zero of a function that changes its sign between 0 and `high`.
fn zero(function: &dyn Fn(f64) -> f64, mut high: f64) -> f64 {
    let mut low = 0.0;
    for _ in 0..60 {
        let middle = 0.5 * (low + high);
        if function(low) * function(middle) <= 0.0 {
            high = middle;
        } else {
            low = middle;
        }
    }
    low
}
