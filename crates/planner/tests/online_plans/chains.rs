//! Chained replans: from rest, again and again to a random target at a random instant.

use super::support::{self, ORDERS, Random, arrive};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::online::MAX_SOLVES;
use standstill_planner::{Limits, OnlinePlan, Order, Setpoint};

/// The worst figures of a run of chains.
#[derive(Debug, Default)]
struct Worst {
    /// Distance from the target where the integrated segments end, relative to the length of the move.
    miss: f64,
    /// Excess over any limit, relative to it.
    excess: f64,
    steps: u32,
    solves: u32,
    pieces: usize,
    rungs: [u32; 4],
    outside: u32,
}

/// Chains of 20 replans; `change` draws the limits of a replan from those of the chain.
fn chains(seed: u64, count: u32, equal: bool, change: impl Fn(&mut Random, &Limits) -> Limits) -> Worst {
    let mut random = Random(seed);
    let mut worst = Worst::default();
    for chain in 0..count {
        let order = ORDERS[chain as usize % 3];
        let mut limits = support::limits(&mut random, order);
        if equal {
            limits.deceleration = limits.acceleration;
        }
        let time = limits.velocity / limits.acceleration;
        let cycle = time * random.log(0.001, 0.3);
        let way = limits.velocity * time;
        let mut start = Setpoint::at_rest(way * random.between(-3.0, 3.0));
        let mut before = limits;
        for link in 0..20 {
            let now = change(&mut random, &limits);
            let target = match random.below(8) {
                0 => start.position,
                1 => start.position + way * random.log(1e-9, 1e-3),
                2 => start.position - way * random.log(1e-9, 1e-3),
                3 => way * random.between(-30.0, 30.0),
                _ => way * random.between(-3.0, 3.0),
            };
            let context =
                || format!("chain {chain} link {link}: {start:?} -> {target:?} {now:?} {before:?} {cycle}");
            let plan = OnlinePlan::new(&start, target, &now, &before, cycle)
                .unwrap_or_else(|error| panic!("{error} {}", context()));
            let (seen, miss) = arrive(&start, &plan, target, order);
            let end = plan.at(u64::from(plan.scans()));
            assert_eq!(end, Setpoint::at_rest(target));
            assert!((f64::from(plan.scans()) - plan.duration() / cycle).abs() <= 1.0);
            assert!(miss <= 1e-9, "miss {miss:e} {} {plan:?}", context());
            worst.miss = worst.miss.max(miss);
            worst.steps = worst.steps.max(plan.steps());
            worst.solves = worst.solves.max(plan.solves());
            worst.pieces = worst.pieces.max(plan.segments().count());
            worst.rungs[plan.rung() as usize] += 1;
            let truth = seen.over(now);
            let said = plan.excess().unwrap_or_default();
            let told = [
                (said.velocity / now.velocity, truth[0]),
                (said.acceleration, truth[1]),
                (said.jerk / now.jerk, truth[2]),
            ];
            for (said, truth) in told {
                if said == 0.0 {
                    assert!(
                        truth <= 1e-9,
                        "excess {truth:e} untold: {} {seen:?} {plan:?}",
                        context()
                    );
                    worst.excess = worst.excess.max(truth);
                }
            }
            // Snap never needs to exceed the larger of the two bounds.
            let snap = seen.snap / now.snap.max(before.snap) - 1.0;
            assert!(snap <= 1e-9, "snap {snap:e} {} {plan:?}", context());
            worst.outside += u32::from(plan.excess().is_some());
            before = now;
            start = plan.at(random.below(u64::from(plan.scans()) + 2));
        }
    }
    assert!(worst.steps < MAX_STEPS && worst.solves < MAX_SOLVES);
    worst
}

fn same(_: &mut Random, limits: &Limits) -> Limits {
    *limits
}

#[test]
fn chains_under_constant_limits_meet_every_target_within_the_limits() {
    let worst = chains(1, 250, true, same);
    println!("{worst:?}");
    assert_eq!(worst.outside, 0);
}

/// The published positions of an axis, with all replans: each divided difference is inside the limit of its
/// derivative.
#[test]
fn published_positions_keep_the_limits() {
    let mut random = Random(5);
    for chain in 0..150 {
        let order = ORDERS[chain % 3];
        let mut limits = support::limits(&mut random, order);
        limits.deceleration = limits.acceleration;
        let time = limits.velocity / limits.acceleration;
        let cycle = time * random.log(0.01, 0.3);
        let way = limits.velocity * time;
        let mut start = Setpoint::at_rest(way * random.between(-1.0, 1.0));
        // At rest for a while, so that the first differences do not go back before the beginning.
        let mut published = vec![start.position; 5];
        for _ in 0..20 {
            let target = way * random.between(-3.0, 3.0);
            let plan = OnlinePlan::new(&start, target, &limits, &limits, cycle).expect("a plan");
            let last = random.below(u64::from(plan.scans()) + 5);
            published.extend((1..=last).map(|scan| plan.at(scan).position));
            start = plan.at(last);
        }
        let farthest = published.iter().fold(0.0f64, |most, p| most.max(p.abs()));
        let mut differences = published;
        let mut divisor = 1.0;
        for (bound, needed) in [
            (limits.velocity, Order::Two),
            (limits.acceleration, Order::Two),
            (limits.jerk, Order::Three),
            (limits.snap, Order::Four),
        ] {
            differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
            divisor *= cycle;
            let largest = differences.iter().fold(0.0f64, |most, d| most.max(d.abs())) / divisor;
            // The weights of the fourth difference add up to 16, each position is off by up to two units.
            let resolved = 32.0 * f64::EPSILON * farthest / divisor;
            assert!(
                order < needed || largest <= bound * (1.0 + 1e-9) + resolved,
                "chain {chain}: {largest} {bound} {resolved:e} {limits:?}"
            );
        }
    }
}

#[test]
fn chains_with_a_deceleration_of_its_own_meet_every_target_within_the_limits() {
    let worst = chains(2, 250, false, same);
    println!("{worst:?}");
    assert_eq!(worst.outside, 0);
}

/// The velocity limit alone is overridden at every replan.
fn overridden(random: &mut Random, limits: &Limits) -> Limits {
    Limits {
        velocity: limits.velocity * random.between(0.2, 1.0),
        ..*limits
    }
}

/// Any limit may change at every replan.
fn all_changed(random: &mut Random, limits: &Limits) -> Limits {
    let factor = || {
        if random.below(2) == 0 {
            1.0
        } else {
            random.between(0.4, 1.0)
        }
    };
    support::each_times(limits, factor)
}

#[test]
fn chains_with_velocity_overrides_meet_every_target() {
    let worst = chains(3, 250, true, overridden);
    println!("{worst:?}");
}

#[test]
fn chains_with_changing_limits_meet_every_target() {
    let worst = chains(4, 250, false, all_changed);
    println!("{worst:?}");
}

/// `cargo test --release -p standstill-planner --features std --test all online_plans -- --ignored --nocapture`
#[test]
#[ignore = "some minutes in release"]
fn millions_of_replans_of_each_kind() {
    println!("constant {:?}", chains(11, 500_000, true, same));
    println!("own deceleration {:?}", chains(12, 50_000, false, same));
    println!("velocity override {:?}", chains(13, 50_000, true, overridden));
    println!("changing {:?}", chains(14, 50_000, false, all_changed));
}
