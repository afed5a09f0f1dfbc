//! The refusals of a grid plan, with the named field, and the unusual inputs that it accepts.

use crate::grid_support::{Move, limits};
use standstill_planner::{Field, Limits, Method, PlanError};

const METHODS: [Method; 3] = [Method::Sequential, Method::Grid, Method::Overlapped];

fn sound() -> Move {
    Move {
        start: 0.0,
        target: 1.0,
        limits: limits(1.0, 10.0, 100.0, 1000.0),
        cycle: 0.001,
    }
}

fn assert_invalid(request: &Move, field: Field) {
    for method in METHODS {
        match request.plan(method) {
            Err(PlanError::InvalidInput { field: named, .. }) => assert_eq!(named, field),
            other => panic!("{request:?}: {other:?}"),
        }
    }
}

#[test]
fn bad_numbers_are_refused_with_their_name() {
    for cycle in [0.0, -0.0, -0.001, f64::NAN, f64::INFINITY, 1e-90, 5e-324] {
        assert_invalid(&Move { cycle, ..sound() }, Field::Cycle);
    }
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        assert_invalid(
            &Move {
                start: bad,
                ..sound()
            },
            Field::Position,
        );
        assert_invalid(
            &Move {
                target: bad,
                ..sound()
            },
            Field::Target,
        );
    }
    // Each end is finite, their distance is not.
    let apart = Move {
        start: -1e308,
        target: 1e308,
        ..sound()
    };
    assert_invalid(&apart, Field::Target);
    type Set = fn(&mut Limits, f64);
    let bounds: [(Field, Set); 5] = [
        (Field::LimitVelocity, |l, x| l.velocity = x),
        (Field::LimitAcceleration, |l, x| l.acceleration = x),
        (Field::LimitDeceleration, |l, x| l.deceleration = x),
        (Field::LimitJerk, |l, x| l.jerk = x),
        (Field::LimitSnap, |l, x| l.snap = x),
    ];
    for (field, set) in bounds {
        for bad in [0.0, -0.0, -1.0, f64::NAN, f64::NEG_INFINITY] {
            let mut request = sound();
            set(&mut request.limits, bad);
            assert_invalid(&request, field);
            // A move of length 0 is refused for it too.
            request.target = request.start;
            assert_invalid(&request, field);
        }
    }
}

#[test]
fn no_bound_at_all_is_refused() {
    for target in [0.0, 1.0] {
        let request = Move {
            target,
            limits: Limits::NONE,
            ..sound()
        };
        for method in METHODS {
            assert_eq!(request.plan(method), Err(PlanError::Unbounded));
        }
    }
}

#[test]
fn any_single_bound_is_enough() {
    let none = f64::INFINITY;
    let bounds = [
        limits(1.0, none, none, none),
        limits(none, 1.0, none, none),
        limits(none, none, 1.0, none),
        limits(none, none, none, 1.0),
    ];
    for limits in bounds {
        for method in METHODS {
            let plan = Move { limits, ..sound() }.plan(method).expect("one bound");
            assert_eq!(plan.at(u64::from(plan.scans())).position, 1.0);
        }
    }
}

#[test]
fn a_move_too_long_names_the_bound() {
    let cases: [(Limits, Field); 6] = [
        (limits(1e-7, 10.0, 100.0, 1000.0), Field::LimitVelocity),
        (limits(1.0, 1e-13, 100.0, 1000.0), Field::LimitAcceleration),
        (limits(1.0, 10.0, 1e-20, 1000.0), Field::LimitJerk),
        (limits(1.0, 10.0, 100.0, 1e-24), Field::LimitSnap),
        (limits(5e-324, 10.0, 100.0, 1000.0), Field::LimitVelocity),
        (
            Limits {
                deceleration: 1e-13,
                ..limits(1.0, 10.0, 100.0, 1000.0)
            },
            Field::LimitDeceleration,
        ),
    ];
    for (limits, expected) in cases {
        for method in METHODS {
            match (Move { limits, ..sound() }).plan(method) {
                Err(PlanError::TooLong { field, .. }) => assert_eq!(field, expected),
                other => panic!("{limits:?}: {other:?}"),
            }
        }
    }
}

#[test]
fn the_longest_plan_is_just_below_two_to_the_31() {
    let none = f64::INFINITY;
    let of = |scans: f64| Move {
        start: 0.0,
        target: scans,
        limits: limits(1.0, 1.0, none, none),
        cycle: 1.0,
    };
    for method in METHODS {
        let plan = of(2_147_483_646.0).plan(method).expect("the longest");
        assert_eq!(plan.scans(), 2_147_483_647);
        assert_eq!(plan.at(2_147_483_647).position, 2_147_483_646.0);
        // K4 alone is in range here, with the acceleration the sum is not.
        match of(2_147_483_647.0).plan(method) {
            Err(PlanError::TooLong { field, .. }) => assert_eq!(field, Field::LimitVelocity),
            other => panic!("{other:?}"),
        }
    }
}

#[test]
fn no_distance_takes_no_scans() {
    for (start, target) in [(2.5, 2.5), (0.0, -0.0), (-0.0, 0.0)] {
        for method in METHODS {
            let plan = Move {
                start,
                target,
                ..sound()
            }
            .plan(method)
            .expect("nothing to do");
            assert_eq!(plan.scans(), 0);
            assert!(plan.boxes().is_empty() && plan.counts().is_none());
            assert_eq!(plan.segments().count(), 0);
            for scan in [0, 1, u64::MAX] {
                assert!(plan.at(scan).is_at_rest());
                assert_eq!(plan.at(scan).position.to_bits(), target.to_bits());
            }
        }
    }
}

#[test]
fn the_lower_one_of_acceleration_and_deceleration_holds_for_both() {
    let both = limits(1.0, 4.0, 100.0, 1000.0);
    let pairs = [(4.0, 9.0), (9.0, 4.0)];
    for method in METHODS {
        let expected = Move {
            limits: both,
            ..sound()
        }
        .plan(method)
        .expect("valid");
        for (acceleration, deceleration) in pairs {
            let limits = Limits {
                acceleration,
                deceleration,
                ..both
            };
            let plan = Move { limits, ..sound() }.plan(method).expect("valid");
            assert_eq!(plan, expected);
        }
    }
}

/// Numbers at the edges of `f64` either plan soundly or are refused; nothing is NaN or infinite.
#[test]
fn extreme_numbers_give_finite_set_points_or_a_refusal() {
    let extremes = [
        5e-324,
        1e-300,
        1e-150,
        1e-30,
        1.0,
        1e30,
        1e150,
        1e300,
        f64::INFINITY,
    ];
    let mut planned = 0;
    for cycle in [1e-70, 1e-3, 1.0, 1e60] {
        for target in [5e-324, 1e-200, 1.0, 1e200, 1e307] {
            for v in extremes {
                for a in extremes {
                    for (j, s) in [(1.0, 1.0), (1e-300, f64::INFINITY), (f64::INFINITY, 1e300)] {
                        let request = Move {
                            start: 0.0,
                            target,
                            limits: limits(v, a, j, s),
                            cycle,
                        };
                        for method in METHODS {
                            let Ok(plan) = request.plan(method) else {
                                continue;
                            };
                            planned += 1;
                            let scans = u64::from(plan.scans());
                            for scan in [0, 1, scans / 2, scans - 1, scans] {
                                let state = plan.at(scan);
                                assert!(state.is_finite(), "{request:?} at {scan}: {state:?}");
                            }
                            assert_eq!(plan.at(scans).position, target);
                        }
                    }
                }
            }
        }
    }
    assert!(planned > 100, "{planned}");
}
