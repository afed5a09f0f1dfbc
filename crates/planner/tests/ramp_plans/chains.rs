//! Long chains of ramps, each starting in the middle of the one before.

use crate::support::{self, ORDERS, Random, integrate};
use standstill_planner::{Order, RampPlan, Setpoint};

/// The worst figures of a chain.
#[derive(Debug, Default)]
struct Worst {
    plans: u64,
    excess: f64,
    end: f64,
    steps: u32,
    segments: usize,
}

/// Goals all forwards: then no plan may exceed a limit, reverse, or report an excess.
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
            let ratios = [
                seen.v_max / limits.velocity,
                1.0 - seen.v_min / limits.velocity,
                seen.speeding / limits.acceleration,
                seen.slowing / limits.deceleration,
                if order >= Order::Three {
                    seen.jerk / limits.jerk
                } else {
                    0.0
                },
                if order >= Order::Four {
                    seen.snap / limits.snap
                } else {
                    0.0
                },
            ];
            let excess = ratios.into_iter().fold(0.0, f64::max) - 1.0;
            assert!(excess <= 1e-9, "{ratios:?} {}", context());
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
