//! Long chains of ramps, each starting in the middle of the one before.

use super::support::{self, ORDERS, Random, integrate};
use standstill_planner::{Limits, Order, RampPlan, Setpoint};
use std::hint::black_box;
use std::time::Instant;

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
    for order in ORDERS {
        let mut random = Random(3);
        let cases: Vec<_> = (0..20_000)
            .map(|_| {
                let limits = support::limits(&mut random, order);
                let first = limits.velocity * random.unit();
                let cycle = 0.01 * limits.velocity / limits.acceleration;
                let rest = Setpoint::at_rest(0.0);
                let plan = RampPlan::new(&rest, first, &limits, &limits, cycle).unwrap();
                let state = plan.at(random.below(u64::from(plan.scans())));
                (state, limits.velocity * random.unit(), limits, cycle)
            })
            .collect();
        // One by one, each timed: the median counts on a shared machine.
        let mut times: Vec<f64> = Vec::new();
        let mut steps = 0;
        for (state, goal, limits, cycle) in &cases {
            let begin = Instant::now();
            let plan = RampPlan::new(state, *goal, limits, limits, *cycle);
            times.push(begin.elapsed().as_nanos() as f64);
            steps += plan.unwrap().steps();
        }
        let mut samples: Vec<f64> = Vec::new();
        for (state, goal, limits, cycle) in &cases {
            let plan = RampPlan::new(state, *goal, limits, limits, *cycle).unwrap();
            let begin = Instant::now();
            for part in 0..32 {
                black_box(plan.at(u64::from(plan.scans()) * part / 32));
            }
            samples.push(begin.elapsed().as_nanos() as f64 / 32.0);
        }
        samples.sort_by(f64::total_cmp);
        times.sort_by(f64::total_cmp);
        let at = |part: f64| times[(part * (times.len() - 1) as f64) as usize];
        println!(
            "{order:?}: ns per plan, timer included: median {} p99 {} p99.9 {}; steps per plan {:.2}; ns per sample {:.1}",
            at(0.5),
            at(0.99),
            at(0.999),
            f64::from(steps) / times.len() as f64,
            samples[samples.len() / 2],
        );
    }
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
