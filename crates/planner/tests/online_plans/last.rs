//! The last rung of the ladder, and the caps: the last rung never fails, and no search is cut short.

use super::support::{self, ORDERS, Random, arrive};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::online::{MAX_SOLVES, Rung};
use standstill_planner::{Limits, OnlinePlan, Segment, Setpoint};

/// Limits, other limits, and a state on a plan under the others: often outside the first.
fn outside(random: &mut Random, case: usize) -> (Limits, Limits, Setpoint, f64) {
    let before = support::limits(random, ORDERS[case % 3]);
    let cycle = 0.01 * before.velocity / before.acceleration;
    let rest = Setpoint::at_rest(random.between(-1.0, 1.0));
    let way = before.velocity * cycle * random.between(-300.0, 300.0);
    let plan = OnlinePlan::new(&rest, rest.position + way, &before, &before, cycle).expect("a plan");
    let start = plan.at(random.below(u64::from(plan.scans()) + 1));
    let now = support::each_times(&before, || random.between(0.3, 1.0));
    (now, before, start, cycle)
}

/// The most ramps solved, root steps and pieces of plans from rung `first` on. Targets are reached at rest or
/// passed; the present position is among them.
fn hardest(first: Rung, seed: u64, count: usize) -> (u32, u32, usize) {
    let mut random = Random(seed);
    let mut most = (0, 0, 0);
    for case in 0..count {
        let (limits, before, start, cycle) = outside(&mut random, case);
        let target = match random.below(4) {
            0 => start.position,
            _ => start.position + limits.velocity * cycle * random.between(-300.0, 300.0),
        };
        let end_velocity = match random.below(3) {
            0 => 0.0,
            1 => limits.velocity * random.between(-1.0, 1.0),
            _ => limits.velocity * random.log(1e-9, 1.0),
        };
        let plan = OnlinePlan::with(first, &start, target, end_velocity, &limits, &before, cycle)
            .unwrap_or_else(|error| {
                panic!("case {case}: {error} {start:?} {target} {end_velocity} {limits:?} {before:?} {cycle}")
            });
        assert!(plan.solves() < MAX_SOLVES && plan.steps() < MAX_STEPS, "{plan:?}");
        let (_, miss) = arrive(&start, &plan, target, limits.order());
        assert!(miss <= 1e-9, "case {case}: {miss:e} {plan:?}");
        most.0 = most.0.max(plan.solves());
        most.1 = most.1.max(plan.steps());
        most.2 = most.2.max(plan.segments().count());
    }
    most
}

#[test]
fn the_last_rung_has_a_plan_for_every_state() {
    println!("ramps, steps, pieces: {:?}", hardest(Rung::Brake, 77, 6000));
}

#[test]
fn no_cap_is_reached_from_outside_the_limits() {
    println!(
        "ramps, steps, pieces: {:?}",
        hardest(Rung::PushThenStop, 79, 6000)
    );
}

/// `cargo test --release -p standstill-planner --features std --test all online_plans -- --ignored --nocapture`
#[test]
#[ignore = "a minute in release"]
fn millions_of_plans_reach_no_cap() {
    for rung in Rung::ALL {
        println!(
            "{rung:?}: ramps, steps, pieces: {:?}",
            hardest(rung, 78, 1_000_000)
        );
    }
}

/// The present position can be passed with a velocity that the axis does not have: it goes back and through it
/// again.
#[test]
fn the_present_position_can_be_passed_with_another_velocity() {
    let limits = Limits {
        velocity: 0.03828521217795212,
        acceleration: 0.018846312884366185,
        deceleration: 0.03805165195768225,
        jerk: 0.019092483913020108,
        snap: 0.007167337987682951,
    };
    let start = Setpoint {
        velocity: limits.velocity,
        ..Setpoint::at_rest(-0.2)
    };
    let pass = |end_velocity: f64| {
        OnlinePlan::passing(&start, start.position, end_velocity, &limits, &limits, 0.15).expect("a plan")
    };
    let plan = pass(0.025);
    assert_eq!(plan.rung(), Rung::PushThenStop);
    let first = plan.segments().next().expect("a segment");
    assert!(first.snap < 0.0, "{first:?}");
    assert!((0..u64::from(plan.scans())).any(|scan| plan.at(scan).velocity < 0.0));
    // With its own velocity it is already there.
    let there = pass(limits.velocity);
    assert_eq!((there.scans(), there.duration()), (0, 0.0));
}

/// A last span too short to move the clock does not affect the cruise before it.
#[test]
fn a_span_too_short_for_the_clock_leaves_no_trace() {
    for (jerk, snap) in [
        (f64::INFINITY, f64::INFINITY),
        (1e15, f64::INFINITY),
        (1e15, 1e21),
    ] {
        let limits = Limits {
            velocity: 95450.50494123837,
            acceleration: 2024861011.1706011,
            deceleration: 6591331420.376002,
            jerk,
            snap,
        };
        let start = Setpoint::at_rest(6.3);
        // One unit in the last place below the limit.
        let end_velocity = f64::from_bits(limits.velocity.to_bits() - 1);
        let plan = OnlinePlan::passing(&start, 134.98, end_velocity, &limits, &limits, 1e-5).expect("a plan");
        assert_eq!((plan.rung(), plan.excess()), (Rung::PushThenStop, None));
        let longest = |one: &Segment, other: &Segment| one.duration.total_cmp(&other.duration);
        let cruise = plan.segments().max_by(longest).expect("a segment");
        assert_eq!((cruise.acceleration, cruise.jerk, cruise.snap), (0.0, 0.0, 0.0));
    }
}

/// The root of the first rungs is between two numbers, and neither is near enough: the target is almost exactly
/// where the turn to nearly the opposite velocity ends.
#[test]
fn a_root_between_two_numbers_is_no_refusal() {
    let limits = Limits {
        velocity: 4826061.544148344,
        acceleration: 709697782968.1647,
        deceleration: 709697782968.1647,
        jerk: 7.096969063479478e17,
        snap: 1.1752384962276695e24,
    };
    let start = Setpoint {
        velocity: limits.velocity,
        ..Setpoint::at_rest(22.713484468049487)
    };
    let plan = OnlinePlan::passing(
        &start,
        22.71348443522261,
        -4826061.267729214,
        &limits,
        &limits,
        6.8e-7,
    )
    .expect("a plan");
    assert_eq!(plan.excess(), None);
    assert!(plan.duration() < 1e-3, "{plan:?}");
}
