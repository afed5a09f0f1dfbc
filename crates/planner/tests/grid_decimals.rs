//! Decimal inputs give their nominal counts, although binary numbers differ from them in the last place.
//!
//! The nominal count is computed from the digits, in whole numbers.

use crate::grid_support::{Move, limits};
use standstill_planner::Method;

const NONE: f64 = f64::INFINITY;
const METHODS: [Method; 3] = [Method::Sequential, Method::Grid, Method::Overlapped];

/// `digits` thousandths, read as a decimal number.
fn thousandths(digits: u64) -> f64 {
    format!("{digits}e-3").parse().expect("a number")
}

#[test]
fn velocity_alone_takes_the_nominal_scans() {
    let mut strict_would_differ = 0;
    for distance in 1..200_u64 {
        for velocity in [1, 3, 7, 10, 30, 70, 100, 300, 1100] {
            // distance / (velocity * 0.001 s), at order 2 with one scan more for the acceleration.
            let nominal = (distance * 1000).div_ceil(velocity) + 1;
            let request = Move {
                start: 0.0,
                target: thousandths(distance),
                limits: limits(thousandths(velocity), NONE, NONE, NONE),
                cycle: 0.001,
            };
            for method in METHODS {
                let plan = request.plan(method).expect("valid");
                assert_eq!(u64::from(plan.scans()), nominal, "{request:?}");
            }
            let ratio = request.target / (request.limits.velocity * request.cycle);
            strict_would_differ += u32::from(ratio.ceil() as u64 + 1 != nominal);
        }
    }
    assert!(strict_would_differ > 10, "no input here needs the slack");
}

#[test]
fn snap_alone_takes_the_nominal_scans() {
    let mut strict_would_differ = 0;
    for n in 1..300_u64 {
        for snap in [1_u64, 3, 7, 50, 700] {
            // 8 snap (n * 0.01 s)^4 is covered in 8 n scans exactly.
            let digits = 8 * snap * n * n * n * n;
            let request = Move {
                start: 0.0,
                target: format!("{digits}e-8").parse().expect("a number"),
                limits: limits(NONE, NONE, NONE, snap as f64),
                cycle: 0.01,
            };
            let sequential = request.plan(Method::Sequential).expect("valid");
            assert_eq!(u64::from(sequential.scans()), 8 * n, "{request:?}");
            let grid = request.plan(Method::Grid).expect("valid");
            assert_eq!(u64::from(grid.scans()), 8 * n, "{request:?}");
            let t = request.cycle;
            let ratio = request.target / (snap as f64 * t * t * t * t);
            strict_would_differ += u32::from(ratio > (8 * n * n * n * n) as f64);
        }
    }
    assert!(strict_would_differ > 10, "no input here needs the slack");
}

/// The steps of the sequential planner that compare two bounds use the same slack.
#[test]
fn ratios_of_two_bounds_take_the_nominal_scans() {
    for tenths in 1..100_u64 {
        // jerk / (snap * 0.001 s) = tenths, acceleration / (jerk * 0.001 s) = 2 tenths, and so on: each
        // segment a nominal whole number of scans.
        let parse =
            |digits: u64, exponent: i32| -> f64 { format!("{digits}e{exponent}").parse().expect("a number") };
        let (nd, n2, n3) = (tenths, 3 * tenths, 7 * tenths);
        let request = Move {
            start: 0.0,
            // The velocity for 20 times its run-up.
            target: parse(nd * n2 * n3 * 20 * n3 * 7, -13),
            limits: limits(
                parse(nd * n2 * n3 * 7, -10),
                parse(nd * n2 * 7, -7),
                parse(nd * 7, -4),
                parse(7, -1),
            ),
            cycle: 0.001,
        };
        let plan = request.plan(Method::Sequential).expect("valid");
        let expected = [nd, n2, n3, 20 * n3].map(|n| n as u32);
        assert_eq!(plan.boxes(), expected, "{request:?}");
    }
}
