//! Many random moves: 2,000 in a plain test run, 10,000 in `.ci/run`. `STANDSTILL_SOAK=1000000` runs more and prints
//! the most work of one.

use crate::grid_support::{Move, Random, keeps, limits, servo};
use standstill_planner::grid::Work;
use standstill_planner::{GridPlan, Limits, Method};

fn rounds() -> u64 {
    standstill_testkit::soak(standstill_testkit::whole_or(10_000, 2_000))
}

#[test]
fn random_moves_never_fail_overshoot_or_break_a_bound() {
    let mut random = Random(2026);
    let mut worst = Work::default();
    let mut samples = 0_u64;
    let mut longest = 0;
    for round in 0..rounds() {
        let request = servo(&mut random);
        let Move {
            start,
            target,
            limits: bounds,
            cycle,
        } = request;
        for method in [Method::Sequential, Method::Grid, Method::Overlapped] {
            let planned = GridPlan::new_counted(method, start, target, &bounds, cycle);
            let (plan, work) = planned.unwrap_or_else(|error| panic!("{round} {request:?}: {error}"));
            worst.rows = worst.rows.max(work.rows);
            worst.candidates = worst.candidates.max(work.candidates);
            worst.capped |= work.capped;
            longest = longest.max(plan.scans());
            assert!(keeps(&plan.peaks(), &bounds), "{round} {request:?}");
            let n = u64::from(plan.scans());
            // All scans of a short move, about a hundred of a long one, always the last ones.
            let step = (n / 100).max(1);
            for k in (0..n).step_by(step as usize).chain(n.saturating_sub(3)..n) {
                samples += 1;
                let position = plan.at(k).position;
                let between = if target >= start {
                    start <= position && position <= target
                } else {
                    target <= position && position <= start
                };
                assert!(between, "{round} {request:?} at {k}: {position}");
            }
            let end = plan.at(n);
            assert!(
                end.is_at_rest() && end.position.to_bits() == target.to_bits(),
                "{round} {request:?}"
            );
        }
    }
    println!(
        "{} moves by 3 methods, {samples} samples, longest {longest} scans; {worst:?}",
        rounds()
    );
    assert!(!worst.capped);
}

/// Moves with snap alone or jerk alone need the longest searches; they stay inside the caps up to 10^6 scans.
#[test]
fn moves_with_one_active_bound_stay_inside_the_caps() {
    let mut random = Random(7);
    let mut worst = Work::default();
    for _ in 0..rounds() / 10 {
        let n = random.log(1e2, 1e6);
        let none = f64::INFINITY;
        let bounds: [Limits; 3] = [
            limits(none, none, none, 512.0 / (n * n * n * n)),
            limits(none, none, 32.0 / (n * n * n), none),
            limits(none, none, 32.0 / (n * n * n), 1.0),
        ];
        for limits in bounds {
            for method in [Method::Grid, Method::Overlapped] {
                let planned = GridPlan::new_counted(method, 0.0, random.log(0.9, 1.1), &limits, 1.0);
                let (_, work) = planned.expect("valid");
                worst.rows = worst.rows.max(work.rows);
                worst.candidates = worst.candidates.max(work.candidates);
                worst.capped |= work.capped;
            }
        }
    }
    println!("one active bound: {worst:?}");
    assert!(!worst.capped);
}

/// A thousand moves there and back, each from where the last one ended, end bit-exactly at 0.
#[test]
fn a_thousand_moves_there_and_back_end_at_zero() {
    let bounds = limits(50.0, 200.0, 2000.0, 40000.0);
    for method in [Method::Sequential, Method::Grid, Method::Overlapped] {
        let mut position = 0.0_f64;
        for round in 0..1000 {
            let target = if round % 2 == 0 { 10.1 } else { 0.0 };
            let plan = GridPlan::new(method, position, target, &bounds, 0.001).expect("valid");
            position = plan.at(u64::from(plan.scans())).position;
        }
        assert_eq!(position.to_bits(), 0.0_f64.to_bits());
    }
}

/// Beyond the caps a plan is still valid, no longer than the sequential one, and says so.
#[test]
fn a_capped_search_is_never_worse_than_the_published_steps() {
    let none = f64::INFINITY;
    let mut capped = 0;
    for scans in [1e7, 3e7, 1e8, 3e8] {
        let limits = limits(none, none, none, 503.0 / (scans * scans * scans * scans));
        for method in [Method::Grid, Method::Overlapped] {
            let (plan, work) = GridPlan::new_counted(method, 0.0, 1.0, &limits, 1.0).expect("valid");
            let sequential = GridPlan::new(Method::Sequential, 0.0, 1.0, &limits, 1.0).expect("valid");
            assert!(plan.scans() <= sequential.scans());
            assert!(plan.peaks().snap <= Some(limits.snap * (1.0 + 1e-11)));
            assert_eq!(plan.at(u64::from(plan.scans())).position, 1.0);
            println!("{scans:e} scans, {method:?}: {work:?}");
            capped += u32::from(work.capped);
            assert!(work.rows <= standstill_planner::grid::MAX_ROWS);
            assert!(work.candidates <= standstill_planner::grid::MAX_CANDIDATES);
        }
    }
    assert!(capped > 0, "no search was long enough to be capped");
}
