//! Endless motions brought back by whole turns: their place after 10^9 turns, against exact integer arithmetic.

use standstill_planner::{Limits, MoveProfile, OnlinePlan, Plan, Planner, RampPlan, Setpoint, Standard};

/// One cycle is 2^-10 s, so that every product below is a whole number of 2^-60 u.
const CYCLE: f64 = 1.0 / 1024.0;

/// f64 as a multiple of 2^-60; exact for the values used here.
fn units(value: f64) -> i128 {
    let scaled = value * (1_u64 << 60) as f64;
    scaled as i128
}

fn limits() -> Limits {
    Limits {
        velocity: 1000.0,
        acceleration: 1e4,
        deceleration: 1e4,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    }
}

#[test]
fn a_thousand_million_turns_in_few_steps_are_exact() {
    let (length, velocity, start) = (7.0 / 3.0, 1000.0 / 3.0, 0.1);
    let at_speed = Setpoint {
        velocity,
        ..Setpoint::at_rest(start)
    };
    let mut plan = RampPlan::new(&at_speed, velocity, &limits(), &limits(), CYCLE).unwrap();
    assert_eq!(plan.scans(), 0);
    // 2^23 scans of a third of a unit each are 1.2 million turns; 1000 times that is more than 10^9.
    let (stride, strides) = (1_u64 << 23, 1000_u64);
    let mut turns = 0_i128;
    for _ in 0..strides {
        turns += i128::from(plan.bring_back(stride, length).unwrap());
    }
    assert!(turns > 1_000_000_000);
    let way = units(velocity) / 1024 * i128::from(stride * strides);
    let expected = (units(start) + way) - turns * units(length);
    let found = units(plan.at(0).position);
    // One unit in the last place of the position, of which f64 has 52 bits below 2.33.
    assert!(
        (found - expected).abs() <= 1 << 10,
        "{} of 2^-60",
        found - expected
    );
}

#[test]
fn bringing_back_at_every_turn_does_not_drift() {
    let (length, velocity) = (1.1, 333.3);
    let at_speed = Setpoint {
        velocity,
        ..Setpoint::at_rest(0.3)
    };
    let mut plan = RampPlan::new(&at_speed, velocity, &limits(), &limits(), CYCLE).unwrap();
    let (mut turns, mut scans) = (0_i128, 0_u64);
    for round in 0..3_000_000_u64 {
        let stride = 3 + round % 5;
        turns += i128::from(plan.bring_back(stride, length).unwrap());
        scans += stride;
    }
    let expected = units(0.3) + units(velocity) / 1024 * i128::from(scans) - turns * units(length);
    let found = units(plan.at(0).position);
    assert!(
        (found - expected).abs() <= 1 << 8,
        "{} of 2^-60",
        found - expected
    );
}

#[test]
fn only_an_endless_motion_past_its_goal_is_brought_back() {
    let planner = Standard::new(CYCLE);
    let (rest, limits) = (Setpoint::at_rest(0.0), limits());
    let mut ramp = planner.ramp_to(&rest, 10.0, &limits, &limits).unwrap();
    let scans = u64::from(ramp.scans());
    let before = ramp.at(scans + 5).position;
    assert_eq!(ramp.bring_back(scans - 1, 0.001), None);
    let turns = ramp.bring_back(scans + 5, 0.001).unwrap();
    assert_eq!(ramp.scans(), 0);
    assert!((before - turns as f64 * 0.001 - ramp.at(0).position).abs() < 1e-15);
    assert_eq!(ramp.at(0).velocity, 10.0);
    let mut grid = planner
        .move_to(MoveProfile::default(), &rest, 10.0, &limits, &limits)
        .unwrap();
    assert_eq!(grid.bring_back(1 << 20, 1.0), None);

    let mut passing = standstill_planner::StandardPlan::Online(
        OnlinePlan::passing(&rest, 5.0, 3.0, &limits, &limits, CYCLE).unwrap(),
    );
    let scan = u64::from(passing.scans()) + 7;
    let before = passing.at(scan).position;
    assert_eq!(passing.bring_back(3, 1.0), None);
    assert_eq!(passing.bring_back(scan, 1.0), Some(5));
    assert!((passing.at(0).position - (before - 5.0)).abs() < 1e-15);
}
