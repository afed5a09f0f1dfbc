//! A velocity bound for each direction: each is kept, and a push uses that of its side.

use super::support::{self, ORDERS, Random, arrive, integrate};
use standstill_planner::{DirectedLimits, Limits, OnlinePlan, RampPlan, Rung, Setpoint};

fn directed(limits: Limits, positive: f64, negative: f64) -> DirectedLimits {
    DirectedLimits {
        positive,
        negative,
        limits,
    }
}

/// Limits, their cycle, and the same limits with one velocity bound lowered.
fn draw(random: &mut Random, case: usize, equal: bool) -> (DirectedLimits, f64) {
    let mut limits = support::limits(random, ORDERS[case % 3]);
    if equal {
        limits.deceleration = limits.acceleration;
    }
    let cycle = limits.velocity / limits.acceleration * random.log(0.003, 0.3);
    let lower = limits.velocity * random.log(1e-3, 1.0);
    let sides = if random.one_in(2) {
        directed(limits, limits.velocity, lower)
    } else {
        directed(limits, lower, limits.velocity)
    };
    (sides, cycle)
}

/// Chains of moves to random targets, some with end velocities, every other chain with A and D apart. No bound is
/// exceeded and every target is met. Returns how often each rung was used.
fn chains(seed: u64, count: usize) -> [u32; 4] {
    let mut random = Random(seed);
    let mut rungs = [0; 4];
    for chain in 0..count {
        let (limits, cycle) = draw(&mut random, chain, chain % 2 == 0);
        let rates = limits.limits;
        let way = rates.velocity * rates.velocity / rates.acceleration;
        let mut start = Setpoint::at_rest(way * random.between(-3.0, 3.0));
        for link in 0..20 {
            let target = match random.below(6) {
                0 => start.position,
                1 => start.position + way * random.sign() * random.log(1e-6, 1e-2),
                _ => way * random.between(-3.0, 3.0),
            };
            let end_velocity = match random.below(3) {
                0 => random.between(-limits.negative, limits.positive),
                _ => 0.0,
            };
            let context =
                || format!("chain {chain} link {link}: {start:?} -> {target:?} {end_velocity:?} {limits:?}");
            let plan = OnlinePlan::by_direction(&start, target, end_velocity, &limits, &limits, cycle)
                .unwrap_or_else(|error| panic!("{error} {}", context()));
            rungs[plan.rung() as usize] += 1;
            let (seen, miss) = arrive(&start, &plan, target, rates.order());
            assert_eq!(plan.excess(), None, "{} {plan:?}", context());
            assert!(seen.inside(limits), "{} {seen:?}", context());
            assert!(miss <= 1e-9, "{} {plan:?}", context());
            start = plan.at(random.below(u64::from(plan.scans()) + 2));
        }
    }
    rungs
}

#[test]
fn chains_keep_the_bound_of_each_direction() {
    let rungs = chains(71, 120);
    println!("{rungs:?}");
    assert!(rungs[1] + rungs[2] + rungs[3] <= 6, "{rungs:?}");
}

#[test]
#[ignore = "a minute; by hand"]
fn many_chains_keep_the_bound_of_each_direction() {
    println!("{:?}", chains(73, 50_000));
}

/// The same bound in both directions, or a bound that the move does not come near, changes no bit.
#[test]
fn a_bound_that_is_not_met_changes_nothing() {
    let mut random = Random(75);
    for case in 0..2000 {
        let (limits, cycle) = draw(&mut random, case, case % 2 == 0);
        let rates = limits.limits;
        let way = rates.velocity * rates.velocity / rates.acceleration;
        let target = way * random.between(0.1, 3.0);
        let rest = Setpoint::default();
        let plan = |limits: &DirectedLimits| {
            OnlinePlan::by_direction(&rest, target, 0.0, limits, limits, cycle).expect("a plan")
        };
        let usual = OnlinePlan::new(&rest, target, &rates, &rates, cycle).expect("a plan");
        assert_eq!(plan(&rates.into()), usual);
        let back = plan(&directed(rates, rates.velocity, 0.1 * rates.velocity));
        assert_eq!(back.scans(), usual.scans());
        assert_eq!(back.peaks(), usual.peaks());
    }
}

/// A move from rest under the bound of one direction takes as long as under that bound in both. A wider bound in
/// the other direction helps only where the move turns.
#[test]
fn a_push_goes_for_the_bound_of_its_own_side() {
    let mut random = Random(77);
    for case in 0..2000 {
        let (limits, cycle) = draw(&mut random, case, case % 2 == 0);
        let rates = limits.limits;
        let way = rates.velocity * rates.velocity / rates.acceleration;
        let target = random.sign() * way * random.between(0.1, 3.0);
        let side = if target < 0.0 {
            limits.negative
        } else {
            limits.positive
        };
        let one = Limits {
            velocity: side,
            ..rates
        };
        let rest = Setpoint::default();
        let plan = OnlinePlan::by_direction(&rest, target, 0.0, &limits, &limits, cycle).expect("a plan");
        let both = OnlinePlan::new(&rest, target, &one, &one, cycle).expect("a plan");
        assert_eq!(plan.scans(), both.scans(), "{limits:?} {target}");
    }
}

/// A start beyond the bound of its direction is brought inside first, under the limits that held before.
#[test]
fn a_start_beyond_its_bound_is_brought_inside() {
    let mut random = Random(79);
    let (mut outside, count) = (0, standstill_testkit::cases(1500) as usize);
    for case in 0..count {
        let (before, cycle) = draw(&mut random, case, true);
        let rates = before.limits;
        let way = rates.velocity * rates.velocity / rates.acceleration;
        let there = OnlinePlan::by_direction(
            &Setpoint::default(),
            way * random.between(-3.0, 3.0),
            0.0,
            &before,
            &before,
            cycle,
        )
        .expect("a plan");
        let start = there.at(random.below(u64::from(there.scans()) + 1));
        let now = DirectedLimits {
            positive: before.positive * random.between(0.2, 1.0),
            negative: before.negative * random.between(0.2, 1.0),
            ..before
        };
        let target = way * random.between(-3.0, 3.0);
        let plans = [
            OnlinePlan::by_direction(&start, target, 0.0, &now, &before, cycle).expect("a plan"),
            OnlinePlan::by_direction_with(Rung::Brake, &start, target, 0.0, &now, &before, cycle)
                .expect("a plan"),
        ];
        for plan in plans {
            let over = |velocity: f64| {
                let bound = if velocity < 0.0 {
                    now.negative
                } else {
                    now.positive
                };
                velocity.abs() - bound
            };
            // The largest excess is at the start, or where the acceleration of the start leads.
            let told = plan.excess().map_or(0.0, |excess| excess.velocity);
            let mut inside = false;
            let mut seen: f64 = 0.0;
            for scan in 0..=u64::from(plan.scans()) {
                let beyond = over(plan.at(scan).velocity);
                seen = seen.max(beyond);
                assert!(
                    !inside || beyond <= 1e-9 * rates.velocity,
                    "case {case} scan {scan} comes out again: {plan:?}"
                );
                inside |= beyond <= 0.0 && plan.at(scan).acceleration * plan.at(scan).velocity <= 0.0;
            }
            assert!(seen <= told + 1e-9 * rates.velocity, "case {case} {seen} {told}");
            outside += usize::from(told > 0.0);
        }
    }
    assert!(outside > count / 5, "{outside}");
}

#[test]
fn ramps_keep_the_bound_of_each_direction() {
    let mut random = Random(81);
    for case in 0..3000 {
        let (limits, cycle) = draw(&mut random, case, case % 2 == 0);
        let mut start = Setpoint::default();
        for _ in 0..4 {
            let goal = random.between(-limits.negative, limits.positive);
            let plan = RampPlan::by_direction(&start, goal, &limits, &limits, cycle).expect("a plan");
            let seen = integrate(&start, &plan, limits.limits.order());
            assert!(seen.inside(limits), "{limits:?} {plan:?}");
            assert_eq!(plan.at(u64::from(plan.scans())).velocity, goal);
            start = plan.at(random.below(u64::from(plan.scans()) + 1));
        }
        let beyond = RampPlan::by_direction(&start, limits.positive * 1.001, &limits, &limits, cycle);
        assert!(beyond.is_err());
    }
}

/// A direction whose bound is not valid is refused by its name.
#[test]
fn a_bound_that_is_none_is_named() {
    let limits = Limits {
        velocity: 1.0,
        acceleration: 2.0,
        deceleration: 2.0,
        jerk: 3.0,
        snap: f64::INFINITY,
    };
    for value in [0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
        for sides in [directed(limits, value, 1.0), directed(limits, 1.0, value)] {
            let refused = OnlinePlan::by_direction(&Setpoint::default(), 1.0, 0.0, &sides, &sides, 0.01);
            let told = refused.expect_err("no bound").to_string();
            let name = if sides.negative == 1.0 {
                "positive"
            } else {
                "negative"
            };
            assert!(told.starts_with(&format!("velocity_limits.{name} is ")), "{told}");
        }
    }
}
