//! Reversals, limits that change on the way, and starts outside them.

use crate::support::{self, ORDERS, Random, integrate};
use standstill_planner::{Excess, Limits, Order, RampPlan, Setpoint};

/// By how much `seen` is outside `limits`, with the sign of velocity a stop should keep in `heading`.
fn excess_seen(seen: &support::Seen, limits: &Limits, goal: f64, heading: f64) -> Excess {
    let fastest = seen.v_max.max(-seen.v_min);
    let against = if heading > 0.0 { -seen.v_min } else { seen.v_max };
    let reversal = if goal == 0.0 { against } else { 0.0 };
    Excess {
        velocity: (fastest - limits.velocity).max(reversal).max(0.0),
        acceleration: (seen.speeding - limits.acceleration)
            .max(seen.slowing - limits.deceleration)
            .max(0.0),
        jerk: (seen.jerk - limits.jerk).max(0.0),
    }
}

/// Any goal, and other limits at every link: each plan arrives, and its excess is what an integrator sees.
#[test]
fn chains_with_changing_limits_arrive_and_tell_their_excess() {
    let mut random = Random(11);
    let (mut largest, mut steps, mut outside) = (0, 0, 0);
    for chain in 0..1200 {
        let order = ORDERS[chain % 3];
        let limits = support::limits(&mut random, order);
        let cycle = random.log(1e-4, 1e-2) * limits.velocity / limits.acceleration;
        let mut before = limits;
        let mut start = Setpoint::at_rest(0.0);
        for link in 0..10 {
            let changed = chain % 2 == 1;
            let mut factor = || if changed { random.between(0.3, 1.0) } else { 1.0 };
            let now = Limits {
                velocity: limits.velocity * factor(),
                acceleration: limits.acceleration * factor(),
                deceleration: limits.deceleration * factor(),
                jerk: limits.jerk * factor(),
                snap: limits.snap * factor(),
            };
            let goal = match random.below(4) {
                0 => 0.0,
                1 => now.velocity,
                _ => now.velocity * random.between(-1.0, 1.0),
            };
            let plan = RampPlan::new(&start, goal, &now, &before, cycle).unwrap();
            let seen = integrate(&start, &plan, order);
            let context = || {
                format!(
                    "chain {chain} link {link}: {start:?} -> {goal:?} {now:?} {before:?}\n{seen:?}\n{plan:?}"
                )
            };
            assert!(
                (seen.end.velocity - goal).abs() <= 1e-12 * limits.velocity,
                "{}",
                context()
            );
            largest = largest.max(plan.segments().count());
            steps = steps.max(plan.steps());
            let said = plan.excess().unwrap_or_default();
            outside += u32::from(plan.excess().is_some());
            let heading = start.velocity;
            let truth = excess_seen(&seen, &now, goal, heading);
            let near = |said: f64, truth: f64, bound: f64| (said - truth).abs() <= 2e-9 * bound.min(1e300);
            // At rest the heading is a matter of definition.
            if start.velocity.abs() > 1e-6 * now.velocity {
                assert!(
                    near(said.velocity, truth.velocity, limits.velocity),
                    "{said:?} {truth:?} {}",
                    context()
                );
            }
            let acceleration = limits.acceleration.max(limits.deceleration);
            assert!(
                near(said.acceleration, truth.acceleration, acceleration),
                "{said:?} {truth:?} {}",
                context()
            );
            if order >= Order::Four {
                assert!(
                    near(said.jerk, truth.jerk, limits.jerk),
                    "{said:?} {truth:?} {}",
                    context()
                );
            }
            if order >= Order::Three {
                let allowed = [now, before]
                    .iter()
                    .map(|l| l.acceleration.max(l.deceleration))
                    .fold(start.acceleration.abs(), f64::max);
                let peak = seen.speeding.max(seen.slowing);
                // Under constant limits the start is viable for acceleration, so nothing exceeds both.
                if !changed {
                    assert!(peak <= allowed * (1.0 + 1e-9), "{peak} {allowed} {}", context());
                }
            }
            before = now;
            start = plan.at(random.below(u64::from(plan.scans()) + 2));
        }
    }
    println!("largest {largest} steps {steps} outside {outside}");
    assert!(outside > 500, "the test must meet starts outside: {outside}");
}
