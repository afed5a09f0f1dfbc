//! Ramps to the other sign with a deceleration of its own, started in the hardest states: late in a stop
//! that brakes harder than the motion that follows may speed up, or the other way round.

use super::support::{self, ORDERS, Random, integrate};
use standstill_planner::{Limits, Order, RampPlan, Setpoint};

/// Limits whose acceleration and deceleration are up to twenty times apart, either way.
fn apart(random: &mut Random, order: Order) -> Limits {
    let limits = support::limits(random, order);
    let deceleration = limits.acceleration * random.log(0.05, 20.0);
    Limits {
        deceleration,
        ..limits
    }
}

/// Turns begun on random stops; returns the largest excess the integrator saw, relative, and the most
/// pieces and root steps of a plan.
fn late_turns(seed: u64, count: usize) -> (f64, usize, u32) {
    let mut random = Random(seed);
    let (mut worst, mut pieces, mut steps) = (0.0f64, 0, 0);
    for case in 0..count {
        let order = ORDERS[case % 3];
        let limits = apart(&mut random, order);
        let cruising = Setpoint {
            velocity: limits.velocity * random.log(1e-6, 1.0),
            ..Setpoint::default()
        };
        let cycle = 1e-4 * limits.velocity / limits.acceleration;
        let stop = RampPlan::new(&cruising, 0.0, &limits, &limits, cycle).unwrap();
        // Late in the stop: on the release of the brake, where the velocity has little left.
        let scans = u64::from(stop.scans());
        let start = stop.at(scans - (scans as f64 * random.log(1e-3, 1.0)) as u64);
        let goal = -limits.velocity * random.log(1e-6, 1.0);
        let plan = RampPlan::new(&start, goal, &limits, &limits, cycle).unwrap();
        let seen = integrate(&start, &plan, order);
        let context = || format!("case {case}: {start:?} -> {goal:?} {limits:?}\n{seen:?}\n{plan:?}");
        assert_eq!(plan.excess(), None, "{}", context());
        let over = seen.over(limits);
        let excess = over.into_iter().fold(-1.0, f64::max);
        assert!(excess <= 1e-9, "{over:?} {}", context());
        let end = (seen.end.velocity - goal).abs() / limits.velocity;
        assert!(end <= 1e-12, "end {end:e} {}", context());
        worst = worst.max(excess);
        pieces = pieces.max(plan.segments().count());
        steps = steps.max(plan.steps());
    }
    (worst, pieces, steps)
}

#[test]
fn a_turn_begun_late_in_a_stop_keeps_every_limit() {
    println!("{:?}", late_turns(81, standstill_testkit::cases(30_000) as usize));
}

/// `cargo test --release -p standstill-planner --test all ramp_plans -- --ignored --nocapture`
#[test]
#[ignore = "some seconds in release"]
fn millions_of_late_turns() {
    println!("{:?}", late_turns(82, 6_000_000));
}

/// The time of a turn does not jump as its start moves along a stop: a release that comes too late for one way of
/// passing zero velocity becomes the next one.
#[test]
fn the_time_of_a_turn_does_not_jump() {
    let mut random = Random(83);
    let mut worst = 0.0f64;
    for _ in 0..standstill_testkit::cases(200) {
        let limits = apart(&mut random, Order::Four);
        let cruising = Setpoint {
            velocity: limits.velocity * random.log(1e-3, 1.0),
            ..Setpoint::default()
        };
        let goal = -limits.velocity * random.log(1e-3, 1.0);
        let turn = |start: &Setpoint| RampPlan::new(start, goal, &limits, &limits, 1.0).unwrap();
        let duration = RampPlan::new(&cruising, 0.0, &limits, &limits, 1.0)
            .unwrap()
            .duration();
        let start = |time: f64| {
            let stop = RampPlan::new(&cruising, 0.0, &limits, &limits, time).unwrap();
            stop.at(1)
        };
        let at = |time: f64| turn(&start(time)).duration();
        let mut last = at(duration / 100.0);
        for part in 2..100 {
            let now = at(duration * f64::from(part) / 100.0);
            if (now - last).abs() > 0.002 * last {
                // The difference between two neighbouring starts.
                let (mut low, mut high) = (
                    duration * f64::from(part - 1) / 100.0,
                    duration * f64::from(part) / 100.0,
                );
                let (mut below, mut above) = (last, now);
                for _ in 0..40 {
                    let middle = 0.5 * (low + high);
                    let there = at(middle);
                    if (there - below).abs() > (there - above).abs() {
                        (high, above) = (middle, there);
                    } else {
                        (low, below) = (middle, there);
                    }
                }
                // A start at rest is no turn: the rate for rising speed holds, not the lower one of both (R11).
                if start(low).is_at_rest() == start(high).is_at_rest() {
                    worst = worst.max((above - below).abs() / below);
                }
            }
            last = now;
        }
    }
    println!("largest relative jump of the duration {worst:e}");
    assert!(worst <= 1e-9, "{worst:e}");
}
