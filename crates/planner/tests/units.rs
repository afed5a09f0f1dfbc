//! The unit of length or time does not matter: a factor of a million, which is no power of two, changes no number
//! of scans. Here for the grid and the papers' systems; `online_plans` and `ramp_plans` have their own tests.

use crate::grid_support::{Move, Random, limits, servo};
use crate::ramp_plans::support::{UNITS, scaled, scaled_limits};
use standstill_planner::papers::{Profile, SCurve, ShortPath, ShortPathPolicy, Timed, Tracking, Trapezoid};
use standstill_planner::{Limits, Method, Setpoint};

#[test]
fn grid_plans_have_the_same_scans() {
    let mut random = Random(91);
    for _ in 0..1000 {
        let one = Move {
            start: 0.0,
            ..servo(&mut random)
        };
        for unit in UNITS {
            let other = Move {
                start: 0.0,
                target: scaled(one.target, 0, unit),
                limits: scaled_limits(&one.limits, unit),
                cycle: one.cycle * unit.1,
            };
            for method in [Method::Sequential, Method::Grid, Method::Overlapped] {
                let plans = [
                    one.plan(method).expect("a plan"),
                    other.plan(method).expect("a plan"),
                ];
                assert_eq!(plans[0].scans(), plans[1].scans(), "{one:?} {unit:?}");
            }
        }
    }
}

/// The plans of every paper's system but the tracking one for one set of numbers.
fn papers(way: f64, from: f64, bounds: &Limits, duration: f64) -> [Profile; 5] {
    let timed = Timed::new(0.0, way, duration, 0.3, 0.2, &Limits::NONE);
    let short = ShortPath::new(0.0, from, way, 0.5 * from, bounds, ShortPathPolicy::Nearest);
    let trapezoid = Limits {
        jerk: f64::INFINITY,
        ..*bounds
    };
    [
        *SCurve::new(0.0, way, bounds).expect("a plan").profile(),
        *timed.expect("a plan").profile(),
        *short.expect("a plan").profile(),
        *Trapezoid::new(0.0, way, &trapezoid).expect("a plan").profile(),
        *Trapezoid::timed(0.0, way, duration, &trapezoid)
            .expect("a plan")
            .profile(),
    ]
}

#[test]
fn the_papers_plans_have_the_same_scans() {
    let mut random = Random(92);
    for case in 0..1000 {
        let velocity = random.log(0.01, 10.0);
        let acceleration = velocity * random.log(1.0, 300.0);
        let jerk = acceleration * random.log(1.0, 1000.0);
        let bounds = limits(velocity, acceleration, jerk, f64::INFINITY);
        let way = velocity * velocity / acceleration * random.log(4.0, 1000.0);
        // A third of it each for the plateau and the two ramps.
        let duration = 1.5 * way / velocity;
        let cycle = duration * random.log(1e-4, 1e-1);
        let from = velocity * random.log(1e-3, 0.2);
        let here = papers(way, from, &bounds, duration);
        for unit in UNITS {
            let there = papers(
                scaled(way, 0, unit),
                scaled(from, 1, unit),
                &scaled_limits(&bounds, unit),
                duration * unit.1,
            );
            for (index, (one, other)) in here.iter().zip(&there).enumerate() {
                assert_eq!(
                    one.scans(cycle),
                    other.scans(cycle * unit.1),
                    "case {case}, plan {index}, {unit:?}"
                );
            }
        }
    }
}

#[test]
fn a_chase_has_the_same_scans() {
    let mut random = Random(93);
    for case in 0..200 {
        let velocity = random.log(0.01, 10.0);
        let acceleration = velocity * random.log(1.0, 300.0);
        let jerk = acceleration * random.log(1.0, 1000.0);
        let snap = jerk * random.log(1.0, 1000.0);
        let bounds = limits(velocity, acceleration, jerk, snap);
        let cycle = 0.05 * velocity / acceleration;
        let targets: Vec<f64> = (0..6)
            .map(|_| velocity * velocity / acceleration * random.log(0.1, 10.0))
            .collect();
        let chase = |unit: (f64, f64)| -> Vec<u32> {
            let bounds = scaled_limits(&bounds, unit);
            let first = scaled(targets[0], 0, unit);
            let mut tracking =
                Tracking::new(&Setpoint::default(), first, &bounds, cycle * unit.1).expect("a plan");
            let mut scans = vec![tracking.plan().scans()];
            for target in &targets[1..] {
                tracking.advance(11);
                tracking.retarget(scaled(*target, 0, unit)).expect("a plan");
                scans.push(tracking.plan().scans());
            }
            scans
        };
        let here = chase((1.0, 1.0));
        for unit in UNITS {
            assert_eq!(chase(unit), here, "case {case} {unit:?}");
        }
    }
}
