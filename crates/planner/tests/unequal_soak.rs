//! Many random moves with unequal rates. 200 in a plain test run, 10,000 in `.ci/run`; `STANDSTILL_SOAK=1000000` runs more
//! and prints the largest work of one.

use crate::grid_support::{Move, Random, keeps, servo};
use standstill_planner::grid::{Family, UnequalWork};
use standstill_planner::{Method, UnequalPlan};

fn rounds() -> u64 {
    standstill_testkit::soak(standstill_testkit::cases(10_000))
}

/// A servo-like move whose deceleration is 0.2 to 5 times the acceleration, now and then 1000 times more or
/// less.
fn unequal(random: &mut Random) -> Move {
    let mut request = servo(random);
    let limits = &mut request.limits;
    if limits.acceleration.is_infinite() {
        limits.acceleration = limits.velocity * random.log(1.0, 300.0);
    }
    let most = if random.below(10) == 0 { 1000.0 } else { 5.0 };
    limits.deceleration = limits.acceleration * random.log(1.0 / most, most);
    request
}

#[test]
fn random_moves_never_fail_overshoot_break_a_bound_or_lose_to_the_lower_rate() {
    let mut random = Random(1958);
    let mut worst = UnequalWork::default();
    let (mut saved, mut scans, mut samples) = (0_u64, 0_u64, 0_u64);
    let mut solves = Vec::new();
    for round in 0..rounds() {
        let request = unequal(&mut random);
        let Move {
            start,
            target,
            limits: bounds,
            cycle,
        } = request;
        for (family, method) in [
            (Family::Separate, Method::Grid),
            (Family::Overlapped, Method::Overlapped),
        ] {
            let planned = UnequalPlan::new_counted(family, start, target, &bounds, cycle);
            let (plan, work) = planned.unwrap_or_else(|error| panic!("{round} {request:?}: {error}"));
            worst.counts = worst.counts.max(work.counts);
            worst.solves = worst.solves.max(work.solves);
            worst.rows = worst.rows.max(work.rows);
            worst.capped |= work.capped;
            solves.push(work.solves);
            let lower = request.plan(method).expect("a valid move");
            assert!(plan.scans() <= lower.scans(), "{round} {request:?}");
            saved += u64::from(lower.scans() - plan.scans());
            scans += u64::from(lower.scans());
            assert!(
                keeps(&plan.peaks(), &bounds),
                "{round} {request:?}: {:?}",
                plan.peaks()
            );
            let n = u64::from(plan.scans());
            // All scans of a short move, about a hundred of a long one, always the last ones.
            let step = (n / 100).max(1);
            let mut last = start;
            for k in (0..n).step_by(step as usize).chain(n.saturating_sub(3)..=n) {
                samples += 1;
                let state = plan.at(k);
                let speed = if target >= start {
                    state.velocity
                } else {
                    -state.velocity
                };
                assert!(speed >= 0.0, "{round} {request:?} at {k}");
                if k >= n.saturating_sub(3) {
                    last = state.position;
                    continue;
                }
                let onwards = if target >= start {
                    last <= state.position && state.position <= target
                } else {
                    last >= state.position && state.position >= target
                };
                assert!(onwards, "{round} {request:?} at {k}: {last} {}", state.position);
                last = state.position;
            }
            assert_eq!(last.to_bits(), target.to_bits(), "{round} {request:?}");
            assert!(plan.at(n).is_at_rest());
        }
    }
    solves.sort_unstable();
    println!(
        "{} moves in 2 families, {samples} samples, {:.1} % shorter than with the lower rate; solves: median {}, 99 % {}; {worst:?}",
        rounds(),
        100.0 * saved as f64 / scans as f64,
        solves[solves.len() / 2],
        solves[solves.len() / 100 * 99]
    );
    assert!(!worst.capped);
}
