//! Random numbers, random problems, and an integrator that shares no code with the planner.

use standstill_planner::{Limits, OnlinePlan, Order, Peaks, RampPlan, Segment, Setpoint};
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
