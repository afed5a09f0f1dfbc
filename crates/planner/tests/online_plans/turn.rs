//! Moves with an acceleration at their target. They turn there exactly, within a scan, with the acceleration that
//! leads back. Or they pass it while slowing down or speeding up.

use super::support::{self, Random, arrive};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::{DirectedLimits, Goal, Limits, OnlinePlan, Order, Passage, Setpoint};

struct Seen {
    turned: u32,
    /// Turns with less acceleration than asked for.
    softer: u32,
    solves: u32,
    steps: u32,
    /// Scans above the shortest of all candidates, as a fraction of them.
    longer: Vec<f64>,
}

/// A turn with this acceleration.
fn turn(acceleration: f64) -> Passage {
    Passage {
        brake: acceleration,
        ..Passage::REST
    }
}

/// Turns of moves from rest, from any state of a move towards the same target, and from a constant velocity.
fn turns(seed: u64, count: usize) -> Seen {
    let mut random = Random(seed);
    let mut all = Seen {
        turned: 0,
        softer: 0,
        solves: 0,
        steps: 0,
        longer: Vec::new(),
    };
    for case in 0..count {
        let order = [Order::Three, Order::Four][case / 4 % 2];
        let limits = support::limits(&mut random, order);
        let cycle = limits.velocity / limits.acceleration * random.log(0.01, 0.2);
        let side = random.sign();
        let way = side * limits.velocity * cycle * random.log(3.0, 300.0);
        let rest = Setpoint::at_rest(way * random.between(-3.0, 3.0));
        let target = rest.position + way;
        let first = OnlinePlan::new(&rest, target, &limits, &limits, cycle).expect("a plan");
        let start = match case % 4 {
            0 | 1 => first.at(random.below(u64::from(first.scans()))),
            2 => rest,
            _ => Setpoint {
                velocity: side * limits.velocity * random.between(0.1, 1.0),
                ..rest
            },
        };
        let acceleration = limits.lower_acceleration() * random.between(0.05, 1.0);
        let context = || format!("case {case}: {start:?} -> {target} {acceleration} {limits:?} {cycle}");
        let plan = OnlinePlan::braking(&start, target, &turn(acceleration), &limits, &limits, cycle)
            .unwrap_or_else(|error| panic!("{error} {}", context()));
        let Some(plan) = plan else { continue };
        all.turned += 1;
        all.solves = all.solves.max(plan.solves());
        all.steps = all.steps.max(plan.steps());
        let last = u64::from(plan.turn().expect("a turn"));
        let end = plan.at(last);
        let turned = Setpoint {
            acceleration: end.acceleration,
            ..Setpoint::at_rest(target)
        };
        assert_eq!(end, turned, "{}", context());
        // Less only where that makes the scans whole.
        let back = -side * end.acceleration;
        assert!(0.0 < back && back <= acceleration, "{end:?} {}", context());
        all.softer += u32::from(back < acceleration);
        let mut before = start.position;
        for scan in 1..=last {
            let here = plan.at(scan).position;
            let resolved = 1e-9 * way.abs();
            assert!(side * (here - before) >= -resolved, "goes back, {}", context());
            assert!(side * (target - here) >= 0.0, "goes too far, {}", context());
            before = here;
        }
        let behind = plan.at(u64::from(plan.scans()));
        assert_eq!(behind, Setpoint::at_rest(plan.target()), "{}", context());
        assert!(side * (target - behind.position) > 0.0, "{}", context());
        kept(&start, &plan, &limits, &context);
        let goal = Goal {
            position: target,
            velocity: 0.0,
            acceleration: end.acceleration,
        };
        let directed = DirectedLimits::from(limits);
        if let Ok(shortest) = OnlinePlan::reaching(&start, &goal, &directed, &directed, cycle) {
            all.longer.push((last as f64 - 1.0) * cycle / shortest.duration());
        }
    }
    all
}

/// Every limit holds on the whole way.
fn kept(start: &Setpoint, plan: &OnlinePlan, limits: &Limits, context: &dyn Fn() -> String) {
    let (seen, _) = arrive(start, plan, plan.target(), limits.order());
    assert!(
        plan.excess().is_none() && seen.inside(*limits),
        "{} {seen:?} {plan:?}",
        context()
    );
}

#[test]
fn turns_are_in_a_scan_exactly_on_their_target_within_the_limits() {
    let mut seen = turns(41, 3_000);
    seen.longer.sort_by(f64::total_cmp);
    let at = |share: f64| seen.longer[(share * (seen.longer.len() - 1) as f64) as usize];
    let (turned, steps, solves) = (seen.turned, seen.steps, seen.solves);
    let softer = seen.softer;
    println!("{turned} turned, {softer} of them softer, at most {solves} ramps, {steps} steps");
    println!(
        "beside the shortest: {:.3} {:.3} {:.3}",
        at(0.5),
        at(0.95),
        at(1.0)
    );
    assert!(turned > 1_000 && softer > 50 && steps <= MAX_STEPS);
}

/// From above the velocity of the move, and with little room: with a stretch at constant velocity it would take 16
/// scans.
#[test]
fn a_turn_close_behind_a_fast_start_is_come_to_in_one_go() {
    let limits = Limits {
        velocity: 59.699,
        acceleration: 16_300.0,
        deceleration: 20_347.0,
        jerk: 2_364_200.0,
        ..Limits::NONE
    };
    let start = Setpoint {
        velocity: 97.165,
        ..Setpoint::at_rest(2.485_98)
    };
    let before = Limits {
        velocity: 97.165,
        ..limits
    };
    let plan = OnlinePlan::braking(&start, 3.2491, &turn(9_780.0), &limits, &before, 1e-3);
    let plan = plan.expect("a plan").expect("a turn");
    assert_eq!(plan.turn(), Some(14));
    let slower = |scan: &u64| plan.at(scan + 1).velocity < plan.at(*scan).velocity;
    assert!((0..14).all(|scan| slower(&scan)), "{plan:?}");
    let at_turn = plan.at(14);
    assert_eq!((at_turn.position, at_turn.velocity), (3.2491, 0.0));
    assert!((at_turn.acceleration + 9_780.0).abs() < 1e-6, "{at_turn:?}");
}

/// How many random targets are passed with the requested acceleration, a fraction of `bound` against the direction
/// of motion, and at most at the wanted speed.
fn passed(seed: u64, bound: impl Fn(&Limits) -> f64) -> u32 {
    let mut random = Random(seed);
    let mut passed = 0;
    for case in 0..3_000 {
        let order = [Order::Three, Order::Four][case % 2];
        let limits = support::limits(&mut random, order);
        let cycle = limits.velocity / limits.acceleration * random.log(0.01, 0.2);
        let side = random.sign();
        let rest = Setpoint::at_rest(limits.velocity * cycle * random.between(-30.0, 30.0));
        let start = Setpoint {
            velocity: [0.0, side * limits.velocity * random.between(0.0, 0.8)][case / 2 % 2],
            ..rest
        };
        let way = side * limits.velocity * cycle * random.log(3.0, 300.0);
        let target = start.position + way;
        let passage = Passage {
            wanted: limits.velocity * random.between(0.1, 1.2),
            brake: bound(&limits) * random.between(0.05, 0.9),
            ..Passage::REST
        };
        let context = || format!("case {case}: {start:?} -> {target} {passage:?} {limits:?} {cycle}");
        let plan = OnlinePlan::braking(&start, target, &passage, &limits, &limits, cycle)
            .unwrap_or_else(|error| panic!("{error} {}", context()));
        let Some(plan) = plan else { continue };
        passed += 1;
        let last = u64::from(plan.scans());
        let is_past = |scan: &u64| side * (plan.at(*scan).position - target) >= 0.0;
        let scan = (0..=last).find(is_past).expect("it passes");
        let state = plan.at(scan);
        let slowing = -side * state.acceleration;
        assert!(
            (slowing - passage.brake).abs() <= 1e-9 * bound(&limits).abs(),
            "{state:?} {}",
            context()
        );
        // While speeding up it may gain some speed in the rest of the scan.
        let gained = (-passage.brake * cycle).max(0.0);
        assert!(
            side * state.velocity <= passage.wanted * (1.0 + 1e-9) + gained,
            "{}",
            context()
        );
        assert!(
            (1..=scan).all(|scan| side * plan.at(scan).velocity >= 0.0),
            "goes back, {}",
            context()
        );
        assert_eq!(plan.at(last), Setpoint::at_rest(plan.target()), "{}", context());
        kept(&start, &plan, &limits, &context);
    }
    passed
}

#[test]
fn what_brakes_through_its_target_keeps_the_limits_and_comes_to_rest() {
    let passed = passed(42, |limits| limits.deceleration);
    assert!(passed > 1_000, "only {passed}");
}

#[test]
fn what_speeds_up_through_its_target_keeps_the_limits_and_comes_to_rest() {
    let passed = passed(43, |limits| -limits.acceleration);
    // Most moves have room for the wanted speed without acceleration.
    assert!(passed > 200, "only {passed}");
}

#[test]
fn at_order_2_nothing_is_gained_by_a_turn() {
    let limits = Limits {
        velocity: 1.0,
        acceleration: 10.0,
        deceleration: 10.0,
        ..Limits::NONE
    };
    let rest = Setpoint::at_rest(0.0);
    let plan = OnlinePlan::braking(&rest, 1.0, &turn(10.0), &limits, &limits, 1e-3);
    assert_eq!(plan, Ok(None));
}
