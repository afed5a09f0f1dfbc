//! Plans with unequal rates are proven shortest: no two ramps of their family fit into one scan less.
//!
//! Every plan of N scans fits into N + 1 with a longer cruise, so it is enough that nothing fits into N -
//! 1. The thresholds and the conditions are written here again, without the planner's code.

use crate::grid_support::{Move, Random, limits, power};
use standstill_planner::UnequalPlan;
use standstill_planner::grid::Family;
use standstill_testkit::cases;

const ABSENT: f64 = f64::INFINITY;
const FAMILIES: [Family; 2] = [Family::Separate, Family::Overlapped];

/// What the products of a ramp with M must reach.
#[derive(Clone, Copy, Debug)]
struct Thresholds {
    k4: u128,
    up: u128,
    down: u128,
    k2: u128,
    k1: u128,
}

fn thresholds(request: &Move) -> Thresholds {
    let twice = 2.0 * (request.target - request.start).abs();
    let (l, t) = (request.limits, request.cycle);
    let [k4, up, down, k2, k1] = [
        twice / (l.velocity * t),
        twice / (l.acceleration * t * t),
        twice / (l.deceleration * t * t),
        twice / (l.jerk * t * t * t),
        twice / (l.snap * t * t * t * t),
    ]
    .map(|ratio| (ratio * (1.0 - 1.0 / power(2.0, 40))).ceil().max(1.0) as u128);
    Thresholds { k4, up, down, k2, k1 }
}

/// The three lengths of a ramp; those that an order does not have are 0.
fn lengths(ramp: &[u32]) -> [u128; 3] {
    let mut lengths = [0; 3];
    for (slot, length) in lengths[3 - ramp.len()..].iter_mut().zip(ramp) {
        *slot = u128::from(*length);
    }
    lengths
}

/// Whether the lengths are a valid ramp: which of them are present, and that no two pulses overlap.
fn is_ramp([n1, n2, n3]: [u128; 3], missing: usize) -> bool {
    let lengths = [n1, n2, n3];
    lengths[missing..].iter().all(|n| *n >= 1)
        && lengths[..missing].iter().all(|n| *n == 0)
        && n1 <= n2
        && n1 + n2 <= n3
}

fn reaches([n1, n2, n3]: [u128; 3], k3: u128, k: &Thresholds, m: u128) -> bool {
    let (n1, n2) = (n1.max(1), n2.max(1));
    n3 * m >= k3 && n2 * n3 * m >= k.k2 && n1 * n2 * n3 * m >= k.k1
}

/// Whether a ramp of exactly this sum keeps its bounds at `m`, by trying all of them.
fn exists(sum: u128, k3: u128, k: &Thresholds, m: u128, least_n1: u128, missing: usize) -> bool {
    let n1s = if missing >= 1 {
        0..=0
    } else {
        least_n1.max(1)..=sum / 4
    };
    n1s.into_iter().any(|n1| {
        let n2s = if missing >= 2 { 0..=0 } else { n1.max(1)..=sum / 2 };
        n2s.into_iter().any(|n2| {
            let ramp = [n1, n2, (sum - n1).saturating_sub(n2)];
            is_ramp(ramp, missing) && reaches(ramp, k3, k, m)
        })
    })
}

/// Whether any two ramps fit into `scans`, by trying all lengths of both.
fn fits(family: Family, missing: usize, k: &Thresholds, scans: u128) -> bool {
    let overlaps = family == Family::Overlapped && missing == 0;
    let longest = if overlaps { scans + scans / 7 } else { scans };
    (2..=longest).any(|both| {
        let m = 2 * scans - both;
        let overlap = both.saturating_sub(scans);
        m >= k.k4
            && (1..both).any(|up| {
                exists(up, k.up, k, m, overlap, missing) && exists(both - up, k.down, k, m, overlap, missing)
            })
    })
}

fn check(request: &Move, missing: usize, longest: u32) -> bool {
    let k = thresholds(request);
    let mut checked = false;
    for family in FAMILIES {
        let plan = UnequalPlan::new(
            family,
            request.start,
            request.target,
            &request.limits,
            request.cycle,
        )
        .expect("a valid move");
        let (up, down) = (lengths(plan.up()), lengths(plan.down()));
        let scans = u128::from(plan.scans());
        let both = up.iter().sum::<u128>() + down.iter().sum::<u128>();
        let m = 2 * scans - both;
        let what = || format!("{family:?} {scans} {up:?} {down:?} {k:?} {request:?}");
        assert!(is_ramp(up, missing) && is_ramp(down, missing), "{}", what());
        assert!(m >= k.k4, "{}", what());
        assert!(
            reaches(up, k.up, &k, m) && reaches(down, k.down, &k, m),
            "{}",
            what()
        );
        let room = if family == Family::Overlapped {
            up[0].min(down[0])
        } else {
            0
        };
        assert!(both <= scans + room, "{}", what());
        if plan.scans() <= longest {
            assert!(
                !fits(family, missing, &k, scans - 1),
                "can be shorter: {}",
                what()
            );
            checked = true;
        }
    }
    checked
}

/// A move of about `scans` scans whose bounds are active in all mixtures and whose rates differ up to 6 times.
fn mixed(random: &mut Random, scans: f64) -> Move {
    let n = scans * random.log(0.05, 1.0);
    let bound = |random: &mut Random, degree: u64| {
        if random.below(5) == 0 {
            ABSENT
        } else {
            // A distance of 1 over n samples asks for about 1 / n^degree.
            random.log(1.0, 40.0 * power(8.0, degree - 1)) / power(n, degree)
        }
    };
    let [v, a, j, s] = [1, 2, 3, 4].map(|degree| bound(random, degree));
    let mut limits = limits(v, a, j, s);
    if limits.acceleration == ABSENT {
        limits.acceleration = random.log(1.0, 320.0) / (n * n);
    }
    limits.deceleration = limits.acceleration * random.log(1.0 / 6.0, 6.0);
    Move {
        start: 0.0,
        target: 1.0,
        limits,
        cycle: 1.0,
    }
}

#[test]
fn order_4_is_shortest_by_trying_all_lengths() {
    let mut random = Random(401);
    let mut checked = 0;
    for _ in 0..cases(3000) {
        let mut request = mixed(&mut random, 40.0);
        if request.limits.snap == ABSENT {
            request.limits.snap = random.log(1e-6, 1e3);
        }
        checked += u64::from(check(&request, 0, 64));
    }
    assert!(
        checked > cases(1500),
        "only {checked} moves were short enough to check"
    );
}

#[test]
fn order_3_is_shortest_by_trying_all_lengths() {
    let mut random = Random(301);
    let mut checked = 0;
    for _ in 0..cases(3000) {
        let mut request = mixed(&mut random, 90.0);
        request.limits.snap = ABSENT;
        if request.limits.jerk == ABSENT {
            request.limits.jerk = random.log(1e-5, 1e3);
        }
        checked += u64::from(check(&request, 1, 120));
    }
    assert!(
        checked > cases(1500),
        "only {checked} moves were short enough to check"
    );
}

#[test]
fn order_2_is_shortest_by_trying_all_lengths() {
    let mut random = Random(201);
    let mut checked = 0;
    for _ in 0..cases(1000) {
        let mut request = mixed(&mut random, 150.0);
        request.limits.snap = ABSENT;
        request.limits.jerk = ABSENT;
        checked += u64::from(check(&request, 2, 200));
    }
    assert!(
        checked > cases(500),
        "only {checked} moves were short enough to check"
    );
}
