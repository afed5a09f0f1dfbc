//! Passing a target at the nearest speed: beside the closed forms of order 2, and from any state of a move.

use super::support::{self, ORDERS, Random};
use standstill_planner::{Limits, OnlinePlan, Order, Passage, Setpoint, online::entry_speed};

const CYCLE: f64 = 1e-3;

fn close(one: f64, other: f64) -> bool {
    (one - other).abs() <= 1e-6 * other.abs().max(1e-3)
}

/// At order 2 a steady start at v reaches, over a distance d and without turning, the speeds from the root of v^2 -
/// 2 D d to that of v^2 + 2 A d. The wanted speed is brought between the two.
#[test]
fn order_2_reaches_what_the_closed_form_does() {
    let mut random = Random(71);
    for case in 0..20_000 {
        let limits = Limits {
            velocity: 100.0,
            acceleration: random.between(50.0, 5000.0),
            deceleration: random.between(50.0, 5000.0),
            ..Limits::NONE
        };
        let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let speed = random.between(0.0, 100.0);
        let way = random.between(1e-3, 10.0);
        let wanted = random.between(1e-3, 100.0);
        let start = Setpoint {
            velocity: side * speed,
            ..Setpoint::at_rest(side * 3.0)
        };
        let passage = Passage {
            wanted,
            most: f64::INFINITY,
            brake: 0.0,
        };
        let target = side * (3.0 + way);
        let plan = OnlinePlan::blending(&start, target, &passage, &limits, &limits, CYCLE).expect("a plan");
        let root = |square: f64| if square > 0.0 { square.sqrt() } else { 0.0 };
        let slowest = root(speed * speed - 2.0 * limits.deceleration * way);
        let fastest = root(speed * speed + 2.0 * limits.acceleration * way);
        let nearest = wanted.max(slowest).min(fastest);
        let reached = plan.map_or(0.0, |plan| side * plan.end_velocity());
        assert!(
            close(reached, nearest),
            "case {case}: {reached} instead of {nearest}"
        );
    }
}

/// u^2 / 2D - e^2 / 2D + u Ts = L, and never more than half the distance in a scan.
#[test]
fn order_2_is_entered_as_the_closed_form_says() {
    let mut random = Random(72);
    for case in 0..20_000 {
        let limits = Limits {
            velocity: 100.0,
            acceleration: 1000.0,
            deceleration: random.between(50.0, 5000.0),
            ..Limits::NONE
        };
        let (wanted, exit) = (random.between(0.0, 100.0), random.between(0.0, 100.0));
        let way = random.between(0.0, 5.0);
        let entry = entry_speed(wanted, 0.0, way, exit, &limits, CYCLE);
        let d = limits.deceleration;
        let late = d * CYCLE;
        let most = (late * late + exit * exit + 2.0 * d * way).sqrt() - late;
        let expected = wanted.min(0.5 * way / CYCLE).min(most.max(exit));
        assert!(
            close(entry, expected),
            "case {case}: {entry} instead of {expected}"
        );
    }
}

/// Anywhere on a move from rest to rest: the speed is exact at the target, and no set-point turns back or is beyond
/// the target. The wanted speed is reached or was out of reach.
#[test]
fn a_move_can_be_blended_at_any_of_its_scans() {
    let mut random = Random(73);
    let mut wanted_had = 0;
    for case in 0..3_000 {
        let order = ORDERS[case % 3];
        let limits = support::limits(&mut random, order);
        let cycle = 0.02 * limits.velocity / limits.acceleration;
        let way = limits.velocity * cycle * random.between(10.0, 300.0);
        let rest = Setpoint::at_rest(0.0);
        let first = OnlinePlan::new(&rest, way, &limits, &limits, cycle).expect("a plan");
        let start = first.at(random.below(u64::from(first.scans())));
        let wanted = limits.velocity * random.between(0.01, 1.0);
        let passage = Passage {
            wanted,
            most: f64::INFINITY,
            brake: 0.0,
        };
        let Some(plan) =
            OnlinePlan::blending(&start, way, &passage, &limits, &limits, cycle).expect("a plan")
        else {
            continue;
        };
        wanted_had += u32::from(plan.end_velocity() == wanted);
        assert_eq!(plan.excess(), None, "case {case}");
        let mut before = start.position;
        for scan in 1..=u64::from(plan.scans()) {
            let point = plan.at(scan);
            assert!(
                point.velocity >= -1e-8 * limits.velocity,
                "case {case}: {point:?}"
            );
            assert!(point.position >= before - 1e-9 * way, "case {case}: {point:?}");
            if scan < u64::from(plan.scans()) {
                assert!(point.position <= way * (1.0 + 1e-12), "case {case}: {point:?}");
            }
            before = point.position;
        }
        let end = plan.at(u64::from(plan.scans()));
        assert_eq!(end.velocity, plan.end_velocity(), "case {case}");
        assert!(end.position >= way * (1.0 - 1e-12), "case {case}: {end:?}");
    }
    assert!(wanted_had > 1_500, "{wanted_had}");
}

/// The velocity of the move holds until the last ramp, although the target is passed faster (B3).
#[test]
fn a_larger_speed_is_reached_at_the_end() {
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2000.0,
        snap: 40_000.0,
    };
    for order in ORDERS {
        let limits = match order {
            Order::Two => Limits {
                jerk: f64::INFINITY,
                snap: f64::INFINITY,
                ..limits
            },
            Order::Three => Limits {
                snap: f64::INFINITY,
                ..limits
            },
            Order::Four => limits,
        };
        let passage = Passage {
            wanted: 80.0,
            most: f64::INFINITY,
            brake: 0.0,
        };
        let plan = OnlinePlan::blending(&Setpoint::at_rest(0.0), 200.0, &passage, &limits, &limits, CYCLE);
        let plan = plan.expect("a plan").expect("a way");
        assert_eq!(plan.end_velocity(), 80.0);
        // The last ramp takes 30/200 s, and at most 0.15 s more for the jerk and the snap.
        let late = u64::from(plan.scans()) - 300;
        assert!((0..=late).all(|scan| plan.at(scan).velocity <= 50.0 * (1.0 + 1e-9)));
    }
}

/// A distance of a few scans at the speed of the start is passed without turning. Ramps so short are rounding
/// errors beside the positions, the cruise is not. The move may have a lower velocity than it begins with, and the
/// speed at the target may be a little lower.
#[test]
fn a_way_of_a_few_scans_is_passed() {
    let mut random = Random(73);
    for case in 0..standstill_testkit::cases(20_000) as usize {
        let limits = support::limits(&mut random, ORDERS[case % 3]);
        let cycle = 0.02 * limits.velocity / limits.acceleration;
        let speed = limits.velocity * random.between(0.01, 0.9);
        let scans = random.between(0.5, 4.0);
        let side = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let start = Setpoint {
            velocity: side * speed,
            ..Setpoint::at_rest(random.between(-10.0, 10.0))
        };
        let target = start.position + side * speed * scans * cycle;
        let passage = Passage {
            wanted: random.between(0.999 * speed, limits.velocity),
            most: f64::INFINITY,
            brake: 0.0,
        };
        let slower = Limits {
            velocity: limits.velocity * random.between(0.3, 1.0),
            ..limits
        };
        let own = if case % 2 == 0 { limits } else { slower };
        let plan = OnlinePlan::blending(&start, target, &passage, &own, &limits, cycle).expect("valid");
        let plan = plan.unwrap_or_else(|| panic!("case {case}: {limits:?} {start:?} {target} {passage:?}"));
        let reached = side * plan.end_velocity();
        assert!(
            f64::from(plan.scans()) <= 1.1 * scans + 1.0 && reached >= 0.99 * speed,
            "case {case}: {reached} after {} scans of {scans}, {start:?}",
            plan.scans()
        );
    }
}
