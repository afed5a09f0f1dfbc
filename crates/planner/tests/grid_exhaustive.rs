//! `Grid` and `Overlapped` are proven shortest: no boxes of a smaller sum reach the thresholds.
//!
//! A longer last box breaks no condition, so it is enough that no boxes sum to N - 1. The thresholds and
//! the conditions are written here again, without the planner's code.

use crate::grid_support::{Move, Random, limits, power};
use standstill_planner::{GridPlan, Method};

const ABSENT: f64 = f64::INFINITY;
const METHODS: [Method; 2] = [Method::Grid, Method::Overlapped];

/// K4, K3, K2, K1 of a move.
fn thresholds(request: &Move) -> [u128; 4] {
    let x = (request.target - request.start).abs();
    let (l, t) = (request.limits, request.cycle);
    [
        x / (l.velocity * t),
        x / (l.acceleration * t * t),
        x / (l.jerk * t * t * t),
        x / (l.snap * t * t * t * t),
    ]
    .map(|ratio| (ratio * (1.0 - 1.0 / power(2.0, 40))).ceil().max(1.0) as u128)
}

/// All four boxes; those that an order does not have are 0.
fn boxes(plan: &GridPlan) -> [u128; 4] {
    let mut boxes = [0; 4];
    let given = plan.boxes();
    for (slot, length) in boxes[4 - given.len()..].iter_mut().zip(given) {
        *slot = u128::from(*length);
    }
    boxes
}

/// Whether boxes are in the family of a method, for an order given by how many leading ones are missing.
fn in_family(method: Method, [n1, n2, n3, n4]: [u128; 4], missing: usize) -> bool {
    let least_n4 = match method {
        Method::Overlapped => n2 + n3,
        _ => n1 + n2 + n3,
    };
    let lengths = [n1, n2, n3, n4];
    lengths[missing..].iter().all(|n| *n >= 1)
        && lengths[..missing].iter().all(|n| *n == 0)
        && n1 <= n2
        && n1 + n2 <= n3
        && least_n4 <= n4
}

fn reaches([n1, n2, n3, n4]: [u128; 4], [k4, k3, k2, k1]: [u128; 4]) -> bool {
    let (n1, n2) = (n1.max(1), n2.max(1));
    n4 >= k4 && n3 * n4 >= k3 && n2 * n3 * n4 >= k2 && n1 * n2 * n3 * n4 >= k1
}

/// Whether any boxes of the given sum meet the conditions, by trying all of them.
fn exists(method: Method, missing: usize, k: [u128; 4], sum: u128) -> bool {
    let n1s = if missing >= 1 { 0..=0 } else { 1..=sum / 7 };
    n1s.into_iter().any(|n1| {
        let n2s = if missing >= 2 { 0..=0 } else { n1.max(1)..=sum / 2 };
        n2s.into_iter().any(|n2| {
            (1..=(sum - n1 - n2) / 2).any(|n3| {
                let boxes = [n1, n2, n3, sum - n1 - n2 - n3];
                in_family(method, boxes, missing) && reaches(boxes, k)
            })
        })
    })
}

/// The same with the best n3 of each pair in closed form: n3 n4 grows with n3 while n4 is long enough.
fn exists_by_pairs(method: Method, missing: usize, k: [u128; 4], sum: u128) -> bool {
    let n1s = if missing >= 1 { 0..=0 } else { 1..=sum / 7 };
    n1s.into_iter().any(|n1| {
        (n1.max(1)..=sum / 4).any(|n2| {
            let rest = sum - n1 - n2;
            let gap = if method == Method::Overlapped { n2 } else { n1 + n2 };
            let n3 = ((rest - gap) / 2).min(rest.saturating_sub(k[0]));
            let boxes = [n1, n2, n3, rest - n3];
            in_family(method, boxes, missing) && reaches(boxes, k)
        })
    })
}

fn check(
    request: &Move,
    missing: usize,
    longest: u32,
    exists: impl Fn(Method, [u128; 4], u128) -> bool,
) -> bool {
    let k = thresholds(request);
    let mut checked = false;
    for method in METHODS {
        let plan = request.plan(method).expect("a valid move");
        let found = boxes(&plan);
        assert!(
            in_family(method, found, missing),
            "{method:?} {found:?} {request:?}"
        );
        assert!(
            reaches(found, k),
            "{method:?} {found:?} misses {k:?}: {request:?}"
        );
        if plan.scans() <= longest {
            let less = u128::from(plan.scans()) - 1;
            assert!(
                !exists(method, k, less),
                "{method:?} {found:?} can be shorter: {request:?}"
            );
            checked = true;
        }
    }
    checked
}

/// A move of about `scans` scans whose bounds are active in all mixtures.
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
    Move {
        start: 0.0,
        target: 1.0,
        limits: limits(
            bound(random, 1),
            bound(random, 2),
            bound(random, 3),
            bound(random, 4),
        ),
        cycle: 1.0,
    }
}

#[test]
fn order_4_is_shortest_by_trying_all_boxes() {
    let mut random = Random(41);
    let mut checked = 0;
    for _ in 0..2000 {
        let mut request = mixed(&mut random, 40.0);
        if request.limits.snap == ABSENT {
            request.limits.snap = random.log(1e-6, 1e3);
        }
        checked += u32::from(check(&request, 0, 64, |m, k, sum| exists(m, 0, k, sum)));
    }
    assert!(checked > 1000, "only {checked} moves were short enough to check");
}

#[test]
fn order_3_is_shortest_by_trying_all_boxes() {
    let mut random = Random(31);
    let mut checked = 0;
    for _ in 0..1000 {
        let mut request = mixed(&mut random, 100.0);
        request.limits.snap = ABSENT;
        if request.limits.jerk == ABSENT {
            request.limits.jerk = random.log(1e-5, 1e3);
        }
        checked += u32::from(check(&request, 1, 150, |m, k, sum| exists(m, 1, k, sum)));
    }
    assert!(checked > 500, "only {checked} moves were short enough to check");
}

#[test]
fn order_2_is_shortest_by_trying_all_boxes() {
    let mut random = Random(21);
    for _ in 0..1000 {
        let mut request = mixed(&mut random, 300.0);
        request.limits.snap = ABSENT;
        request.limits.jerk = ABSENT;
        if request.limits.acceleration == ABSENT {
            request.limits.acceleration = random.log(1e-4, 1e3);
            request.limits.deceleration = request.limits.acceleration;
        }
        check(&request, 2, u32::MAX, |m, k, sum| exists(m, 2, k, sum));
    }
}

#[test]
fn long_moves_are_shortest_by_trying_all_pairs() {
    let mut random = Random(45);
    let mut checked = [0; 2];
    for _ in 0..300 {
        let mut request = mixed(&mut random, 600.0);
        if request.limits.snap == ABSENT && request.limits.jerk == ABSENT {
            continue;
        }
        let missing = usize::from(request.limits.snap == ABSENT);
        if missing == 0 {
            // Snap alone, or nearly so, is the hardest for the search.
            request.limits.jerk *= random.log(1.0, 100.0);
        }
        let done = check(&request, missing, 700, |m, k, sum| {
            exists_by_pairs(m, missing, k, sum)
        });
        checked[missing] += u32::from(done);
    }
    assert!(checked.iter().all(|n| *n > 20), "{checked:?}");
}

/// Where thresholds need more than 53 bits, the products are compared in 128 bits, and the result must be as exact.
/// All pairs would take too long, so those around the result are tried.
#[test]
fn moves_beyond_53_bits_are_shortest_among_the_pairs_around() {
    let mut random = Random(46);
    let mut wide = 0;
    for _ in 0..200 {
        let mut request = mixed(&mut random, 2e5);
        request.limits.snap = random.log(1.0, 1e4) / power(2e5, 4);
        let k = thresholds(&request);
        wide += u32::from(k[3] > 1 << 53);
        for method in METHODS {
            let plan = request.plan(method).expect("a valid move");
            let found = boxes(&plan);
            assert!(
                in_family(method, found, 0) && reaches(found, k),
                "{found:?} {request:?}"
            );
            let [n1, n2, ..] = found;
            let less = u128::from(plan.scans()) - 1;
            for n1 in n1.saturating_sub(4).max(1)..n1 + 5 {
                for n2 in n2.saturating_sub(30).max(n1)..n2 + 31 {
                    let rest = less - n1 - n2;
                    let gap = if method == Method::Overlapped { n2 } else { n1 + n2 };
                    let n3 = ((rest - gap) / 2).min(rest.saturating_sub(k[0]));
                    let boxes = [n1, n2, n3, rest - n3];
                    let shorter = in_family(method, boxes, 0) && reaches(boxes, k);
                    assert!(!shorter, "{boxes:?} beats {found:?}: {request:?}");
                }
            }
        }
    }
    assert!(wide > 100, "only {wide} moves needed more than 53 bits");
}
