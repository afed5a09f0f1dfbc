//! The definition of excess, and ramps without motion.

use standstill_planner::{Limits, PlanError, RampPlan, Setpoint};

/// Bounds so low that the times of a ramp are too large for numbers: refused, not left out.
#[test]
fn a_ramp_that_never_arrives_is_too_long() {
    for (acceleration, jerk) in [
        (1e-297, 2e5),
        (1e-297, f64::INFINITY),
        (1e-300, 1e-300),
        (2e3, 1e-300),
    ] {
        let limits = Limits {
            velocity: 5.0,
            acceleration,
            deceleration: acceleration,
            jerk,
            ..Limits::NONE
        };
        let start = Setpoint {
            velocity: 3.6,
            ..Setpoint::default()
        };
        let plan = RampPlan::new(&start, 1.44, &limits, &limits, 0.001);
        assert!(
            matches!(plan, Err(PlanError::TooLong { .. })),
            "{limits:?} {plan:?}"
        );
    }
}

/// A jerk that builds up in 1e-9 s, half a second after the start. The last place of the clock is more than 1e-9 of
/// this duration there. The piece keeps its duration, so the jerk keeps its bound.
#[test]
fn a_piece_shorter_than_the_clock_resolves_keeps_its_bound() {
    let limits = Limits {
        velocity: 100.0,
        acceleration: 6e4,
        deceleration: 5e4,
        jerk: 2e6,
        snap: 6e15,
    };
    for case in 0..1000 {
        let start = Setpoint {
            velocity: -60.0 - 0.01 * f64::from(case),
            acceleration: 100.0,
            ..Setpoint::default()
        };
        let slow = Limits {
            acceleration: 150.0,
            deceleration: 200.0,
            ..limits
        };
        let plan = RampPlan::new(&start, 50.0, &slow, &limits, 0.001).unwrap();
        assert!(plan.peaks().jerk <= limits.jerk * (1.0 + 1e-9), "{start:?}");
        assert_eq!(plan.excess(), None, "{start:?}");
        assert_eq!(plan.excess_over(&limits), None, "{start:?}");
    }
}

/// A start whose acceleration is allowed while it brakes and too high after zero velocity.
#[test]
fn excess_over_higher_limits_looks_at_each_side_of_zero() {
    let limits = Limits {
        velocity: 1.0,
        acceleration: 150.0,
        deceleration: 200.0,
        jerk: 2e5,
        ..Limits::NONE
    };
    let axis = Limits {
        acceleration: 200.0,
        deceleration: 400.0,
        ..limits
    };
    let start = Setpoint {
        velocity: -0.03,
        acceleration: 350.0,
        ..Setpoint::default()
    };
    let plan = RampPlan::new(&start, 0.0, &limits, &axis, 0.00025).unwrap();
    let over = plan.excess_over(&axis).unwrap();
    // Passing zero at a, with a^2 = 350^2 - 2 j 0.03, under 200.
    let at_zero = (350.0_f64 * 350.0 - 2.0 * 2e5 * 0.03).sqrt();
    assert!((over.acceleration - (at_zero - 200.0)).abs() < 1e-6, "{over:?}");
    assert!(plan.excess().unwrap().acceleration >= 350.0 - 200.0);
    let within = Limits {
        acceleration: 400.0,
        ..axis
    };
    assert_eq!(
        plan.excess_over(&within).map_or(0.0, |over| over.acceleration),
        0.0
    );
}
