//! Long chains of ramps, each starting in the middle of the one before.

use super::support::{self, ORDERS, Random, integrate};
use standstill_planner::{Limits, Order, RampPlan, Setpoint};

/// The worst figures of a chain.
#[derive(Debug, Default)]
struct Worst {
    plans: u64,
    excess: f64,
    end: f64,
    steps: u32,
    segments: usize,
}

/// All goals are forwards: then no plan may exceed a limit, reverse, or report an excess.
fn forward_chains(seed: u64, chains: u64) -> Worst {
    let mut random = Random(seed);
    let mut worst = Worst::default();
    for chain in 0..chains {
        let order = ORDERS[(chain % 3) as usize];
        let limits = support::limits(&mut random, order);
        let cycle = random.log(1e-4, 1e-2) * limits.velocity / limits.acceleration;
        let mut start = Setpoint::at_rest(random.between(-1.0, 1.0));
        for link in 0..10 {
            let goal = match random.below(5) {
                0 => 0.0,
                1 => limits.velocity,
                _ => limits.velocity * random.unit(),
            };
            let plan = RampPlan::new(&start, goal, &limits, &limits, cycle).unwrap();
            let seen = integrate(&start, &plan, order);
            let context = || {
                format!(
                    "seed {seed} chain {chain} link {link}: {start:?} -> {goal:?} {limits:?}\n{seen:?}\n{plan:?}"
                )
            };
            worst.plans += 1;
            worst.steps = worst.steps.max(plan.steps());
            worst.segments = worst.segments.max(plan.segments().count());
            let over = seen.over(limits);
            let excess = over.into_iter().fold(-seen.v_min / limits.velocity, f64::max);
            assert!(excess <= 1e-9, "{over:?} {}", context());
            worst.excess = worst.excess.max(excess);
            assert_eq!(plan.excess(), None, "{}", context());
            let end = (seen.end.velocity - goal).abs() / limits.velocity;
            assert!(end <= 1e-12, "end {end:e} {}", context());
            worst.end = worst.end.max(end);
            if order >= Order::Three {
                assert!(
                    seen.end.acceleration.abs() <= 1e-7 * limits.acceleration,
                    "{}",
                    context()
                );
            }
            let last = plan.at(u64::from(plan.scans()));
            assert_eq!(
                (last.velocity, last.acceleration, last.jerk, last.snap),
                (goal, 0.0, 0.0, 0.0)
            );
            start = plan.at(random.below(u64::from(plan.scans()) + 2));
        }
    }
    worst
}

#[test]
fn forward_chains_keep_every_limit_and_never_reverse() {
    let worst = forward_chains(1, 1500);
    println!("{worst:?}");
    assert!(worst.steps < 40, "{worst:?}");
}

/// `cargo test --release -p standstill-planner --test all ramp_plans -- --ignored --nocapture`
#[test]
#[ignore = "some seconds in release"]
fn a_million_chained_ramps() {
    let worst = forward_chains(2, 100_000);
    println!("{worst:?}");
}

/// At the turn of a motion the velocity may be exactly 0 and the acceleration a rounding residue, or more. A state
/// that needs less than a scan to settle takes at most two.
#[test]
fn what_is_almost_at_rest_is_at_rest_in_two_scans() {
    let cycle = 0.001;
    for order in [Order::Three, Order::Four] {
        let limits = Limits {
            velocity: 167.0,
            acceleration: 1822.0,
            deceleration: 583.0,
            jerk: 8320.0,
            snap: if order == Order::Four { 1e7 } else { f64::INFINITY },
        };
        for size in [
            1e-2, 1e-3, 1e-4, 1e-5, 1e-6, 1e-7, 1e-8, 1e-9, 1e-10, 1e-12, 1e-13, 1e-15, 1e-18, 1e-60, 1e-300,
        ] {
            for acceleration in [0.0, size, -size] {
                for velocity in [0.0, 1e-9, 1e-15, -1e-18, 1e-30, 1e-200] {
                    // At order 3 the jerk of the start plays no part.
                    let jerk = if order == Order::Four {
                        acceleration
                    } else {
                        limits.jerk
                    };
                    let start = Setpoint {
                        position: 3.5945805461077804,
                        velocity,
                        acceleration,
                        jerk,
                        snap: 0.0,
                    };
                    let ramp = RampPlan::new(&start, 0.0, &limits, &limits, cycle);
                    let scans = ramp.map(|ramp| ramp.scans());
                    assert!(
                        scans.is_ok_and(|scans| scans <= 2),
                        "{order:?} {start:?}: {scans:?}"
                    );
                }
            }
        }
    }
}
