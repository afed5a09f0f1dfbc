//! The invariants of grid plans, over the reference vectors and seeded random moves.

use crate::grid_support::{Digest, Move, Random, four, keeps, limits, power, servo, vector_move, vectors};
use crate::ramp_plans::support::scaled_limits;
use standstill_planner::grid::Euler;
use standstill_planner::{GridPlan, Method, Order, Setpoint};

const METHODS: [Method; 3] = [Method::Sequential, Method::Grid, Method::Overlapped];

/// The valid vectors and random moves, planned by all methods, no plan longer than `longest` scans.
fn plans(seed: u64, count: usize, longest: u32) -> Vec<(Move, GridPlan)> {
    let mut random = Random(seed);
    let moves = vectors()
        .iter()
        .filter(|vector| vector.get("error").is_none())
        .map(vector_move)
        .chain((0..count).map(|_| servo(&mut random)))
        .collect::<Vec<_>>();
    let mut plans = Vec::new();
    for request in moves {
        for method in METHODS {
            let plan = request.plan(method).expect("a valid move");
            if (1..=longest).contains(&plan.scans()) {
                plans.push((request, plan));
            }
        }
    }
    plans
}

fn degree(plan: &GridPlan) -> u64 {
    plan.order().degree() as u64
}

/// Invariant 1: the closed form equals the recurrence, which ends exactly at P with all derivatives 0.
#[test]
fn forward_euler_is_the_integer_recurrence_and_lands_exactly() {
    for (request, plan) in plans(1, 60, 3000) {
        let n = u64::from(plan.scans());
        let order = plan.order();
        let mut state = Euler::default();
        for k in 0..=n + 3 {
            let closed = plan.euler(k);
            state.input = closed.input;
            assert_eq!(closed, state, "{request:?} at {k}");
            assert!((-1..=1).contains(&closed.input));
            assert!(k < degree(&plan) || k == n || closed.position > 0);
            assert!(k >= degree(&plan) || closed.position == 0);
            // The integrators of the order, each from the value its input had before.
            state.position += state.velocity;
            match order {
                Order::Four => {
                    state.velocity += state.acceleration;
                    state.acceleration += state.jerk;
                    state.jerk += state.input;
                }
                Order::Three => {
                    state.velocity += state.acceleration;
                    state.acceleration += state.input;
                }
                Order::Two => state.velocity += state.input,
            }
            if k >= n {
                let rest = Euler {
                    position: plan.product() as i128,
                    ..Euler::default()
                };
                assert_eq!(closed, rest, "{request:?} at {k}");
            }
        }
    }
}

/// Invariants 2 and 3, and 12 for the velocity of overlapped plans.
#[test]
fn forward_euler_is_symmetric_one_way_and_peaks_where_the_products_say() {
    for (request, plan) in plans(2, 60, 3000) {
        let n = u64::from(plan.scans());
        let product = plan.product() as i128;
        let states = (0..=n).map(|k| plan.euler(k)).collect::<Vec<_>>();
        let last = n + degree(&plan) - 1;
        for k in degree(&plan) - 1..=n {
            let sum = states[k as usize].position + states[(last - k) as usize].position;
            assert_eq!(sum, product, "{request:?} at {k}");
        }
        assert!(states.iter().all(|state| state.velocity >= 0));
        let [a, b, c, d] = {
            let mut boxes = [0_i128; 4];
            for (slot, length) in boxes.iter_mut().zip(plan.boxes()) {
                *slot = i128::from(*length);
            }
            boxes
        };
        let highest = |of: fn(&Euler) -> i128| {
            let most = states.iter().map(of).max().unwrap_or(0);
            let least = states.iter().map(of).min().unwrap_or(0);
            (most, least)
        };
        match plan.order() {
            Order::Four => {
                let tail = {
                    let e = (a + b + c - d - 2).max(0);
                    let (r, q) = (e / 2, e - e / 2);
                    let pyramid = |n: i128| n * (n + 1) * (n + 2) / 6;
                    pyramid(r) + pyramid(q)
                };
                assert_eq!(highest(|s| s.velocity).0, a * b * c - tail, "{request:?}");
                assert_eq!(highest(|s| s.acceleration), (a * b, -a * b), "{request:?}");
                assert_eq!(highest(|s| s.jerk), (a, -a), "{request:?}");
            }
            Order::Three => {
                assert_eq!(highest(|s| s.velocity).0, a * b, "{request:?}");
                assert_eq!(highest(|s| s.acceleration), (a, -a), "{request:?}");
            }
            Order::Two => assert_eq!(highest(|s| s.velocity).0, a, "{request:?}"),
        }
    }
}

/// Sum of `sign max(k - t, 0)^power` over all switching instants, with those at k itself left out.
fn powers(plan: &GridPlan, k: i128, power: u32) -> i128 {
    let boxes = plan.boxes();
    (0_u32..1 << boxes.len())
        .map(|subset| {
            let instant: i128 = boxes
                .iter()
                .enumerate()
                .filter(|(bit, _)| subset >> bit & 1 == 1)
                .map(|(_, length)| i128::from(*length))
                .sum();
            let sign = 1 - 2 * i128::from(subset.count_ones() % 2);
            if instant < k {
                sign * (k - instant).pow(power)
            } else {
                0
            }
        })
        .sum()
}

/// The published set-points are the exact ones, rounded: positions to 2 units of the last place of the
/// larger of start and position, derivatives to 6 of their own.
#[test]
fn set_points_are_the_exact_profile() {
    for (request, plan) in plans(3, 60, 100_000) {
        let n = u64::from(plan.scans());
        let order = plan.order().degree() as u32;
        let distance = plan.target() - plan.start();
        let (p, t) = (plan.product() as f64, plan.cycle());
        let step = (n / 50).max(1);
        for k in (0..n).step_by(step as usize).chain([n.saturating_sub(1)]) {
            let state = plan.at(k);
            let factorial = [1.0, 1.0, 2.0, 6.0, 24.0];
            let exact = |derivative: u32| {
                if derivative > order {
                    return 0.0;
                }
                let left = order - derivative;
                let sum = powers(&plan, i128::from(k), left) as f64;
                distance * (sum / p) / factorial[left as usize] / power(t, u64::from(derivative))
            };
            let position = plan.start() + exact(0);
            let room = 2.0 * f64::EPSILON * plan.start().abs().max(position.abs());
            assert!(
                (state.position - position).abs() <= room,
                "{request:?} at {k}: {} {position}",
                state.position
            );
            let derivatives = [state.velocity, state.acceleration, state.jerk, state.snap];
            for (derivative, value) in (1..).zip(derivatives) {
                let expected = exact(derivative);
                let room = 6.0 * f64::EPSILON * expected.abs();
                assert!(
                    (value - expected).abs() <= room,
                    "{request:?} at {k}, derivative {derivative}: {value} {expected}"
                );
            }
        }
    }
}

/// Invariants 2 and 9 as published: the position never moves back and never leaves the path. At the end it is the
/// target to the bit, and stays there.
#[test]
fn positions_are_one_way_and_end_on_the_target_to_the_bit() {
    for (request, plan) in plans(4, 200, 20_000) {
        let n = u64::from(plan.scans());
        let forward = plan.target() >= plan.start();
        let mut before = plan.start();
        assert_eq!(plan.at(0), Setpoint::at_rest(plan.start()), "{request:?}");
        for k in 0..=n {
            let position = plan.at(k).position;
            let onward = if forward {
                position >= before
            } else {
                position <= before
            };
            let inside = if forward {
                position <= plan.target()
            } else {
                position >= plan.target()
            };
            assert!(onward && inside, "{request:?} at {k}: {before} {position}");
            before = position;
        }
        // One hour of milliseconds, and the end of counting.
        for k in [n, n + 1, n + 3_600_000, u64::MAX] {
            let state = plan.at(k);
            assert_eq!(state.position.to_bits(), request.target.to_bits());
            assert!(state.is_at_rest());
            let last_segment = k == n && plan.order() == Order::Four;
            assert_eq!(state.snap, if last_segment { -plan.amplitude() } else { 0.0 });
        }
    }
}

/// Invariant 4: the continuous plan keeps every bound to 2^-39, the published samples keep the peaks.
#[test]
fn bounds_hold() {
    for (request, plan) in plans(5, 1000, u32::MAX) {
        let peaks = plan.peaks();
        assert!(keeps(&peaks, &request.limits), "{request:?}");
        assert_eq!(peaks.jerk.is_some(), plan.order() >= Order::Three);
        assert_eq!(peaks.snap.is_some(), plan.order() == Order::Four);
        let n = u64::from(plan.scans());
        let rounding = 1.0 + 4.0 * f64::EPSILON;
        for k in (0..=n).step_by((n as usize / 300).max(1)) {
            let [_, derivatives @ ..] = plan.at(k).numbers();
            let inside = |(value, peak): (f64, f64)| value.abs() <= peak * rounding;
            assert!(
                derivatives.into_iter().zip(four(&peaks)).all(inside),
                "{request:?} at {k}"
            );
        }
    }
}

/// Backward differences of published positions keep the bounds to 1e-9, but for what f64 positions resolve.
#[test]
fn backward_differences_of_positions_keep_the_bounds() {
    for (request, plan) in plans(6, 100, 5000) {
        let n = u64::from(plan.scans());
        let t = plan.cycle();
        let bounds = [
            request.limits.velocity,
            request.limits.acceleration,
            request.limits.jerk,
            request.limits.snap,
        ];
        let resolved = 2.0 * f64::EPSILON * request.start.abs().max(request.target.abs());
        let mut differences = [plan.start(), 0.0, 0.0, 0.0, 0.0];
        for k in 0..=n + 4 {
            let mut value = plan.at(k).position;
            for difference in &mut differences {
                let before = std::mem::replace(difference, value);
                value -= before;
            }
            for (degree, (difference, bound)) in (1..).zip(differences[1..].iter().zip(bounds)) {
                let scale = power(t, degree);
                let room = resolved * power(2.0, degree);
                assert!(
                    difference.abs() <= bound * scale * (1.0 + 1e-9) + room,
                    "{request:?} at {k}: difference {degree} is {}",
                    difference / scale
                );
            }
        }
    }
}

/// The segments, integrated one after another, are the move; `at` and `peaks` agree with them.
#[test]
fn segments_add_up_to_the_move() {
    for (request, plan) in plans(7, 300, u32::MAX) {
        let distance = plan.target() - plan.start();
        let (mut scan, mut x) = (0, 0.0);
        let mut peak = [0.0_f64; 4];
        let mut count = 0;
        for segment in plan.segments() {
            count += 1;
            assert!(segment.scans > 0);
            let [v, a, j, s] = [segment.velocity, segment.acceleration, segment.jerk, segment.snap];
            let at = |t: f64| {
                [
                    v + t * (a + t / 2.0 * (j + t / 3.0 * s)),
                    a + t * (j + t / 2.0 * s),
                    j + t * s,
                    s,
                ]
            };
            // The velocity peaks in the middle of the move, which the overlap may put inside a segment.
            for t in [0.0, segment.duration / 2.0, segment.duration] {
                for (peak, value) in peak.iter_mut().zip(at(t)) {
                    *peak = peak.max(value.abs());
                }
            }
            let t = segment.duration;
            x += t * (v + t / 2.0 * (a + t / 3.0 * (j + t / 4.0 * s)));
            scan += u64::from(segment.scans);
            // The end just before the jump is what `at` publishes.
            let state = plan.at(scan);
            let published = [state.velocity, state.acceleration, state.jerk, state.snap];
            let scales = four(&plan.peaks());
            let held_to_the_end = scan < u64::from(plan.scans());
            for (degree, ((value, published), scale)) in (1..).zip(at(t).iter().zip(published).zip(scales)) {
                // At orders 3 and 2 the last jump is to rest.
                if degree == plan.order().degree() && degree < 4 && !held_to_the_end {
                    assert_eq!(published, 0.0);
                    continue;
                }
                assert!(
                    (value - published).abs() <= 1e-9 * scale,
                    "{request:?} at {scan}, {degree}"
                );
            }
        }
        assert!((1..=15).contains(&count));
        assert_eq!(scan, u64::from(plan.scans()));
        assert!((x - distance).abs() <= 1e-9 * distance.abs(), "{request:?}");
        for (peak, expected) in peak.into_iter().zip(four(&plan.peaks())) {
            assert!(
                (peak - expected).abs() <= 1e-9 * expected,
                "{request:?}: {peak} {expected}"
            );
        }
    }
}

/// Invariants 5 and 12: more freedom is never slower, and the published steps waste at most 7 scans here.
#[test]
fn methods_are_ordered() {
    let mut random = Random(8);
    for _ in 0..3000 {
        let request = servo(&mut random);
        let [sequential, grid, overlapped] = METHODS.map(|method| request.plan(method).expect("valid"));
        assert!(overlapped.scans() <= grid.scans(), "{request:?}");
        assert!(grid.scans() <= sequential.scans(), "{request:?}");
        assert!(sequential.scans() - grid.scans() <= 7, "{request:?}");
        if request.limits.order() != Order::Four {
            assert_eq!(
                overlapped.boxes(),
                grid.boxes(),
                "below order 4 the families are one: {request:?}"
            );
        }
    }
}

/// Invariant 6: a higher bound never costs a scan, and a longer distance never saves one.
#[test]
fn fewest_scans_are_monotone() {
    let mut random = Random(9);
    for _ in 0..1000 {
        let request = Move {
            start: 0.0,
            ..servo(&mut random)
        };
        for method in [Method::Grid, Method::Overlapped] {
            let scans = request.plan(method).expect("valid").scans();
            for bound in 0..4 {
                let mut looser = request;
                let factor = random.log(1.0, 1.5);
                match bound {
                    0 => looser.limits.velocity *= factor,
                    1 => {
                        looser.limits.acceleration *= factor;
                        looser.limits.deceleration *= factor;
                    }
                    2 => looser.limits.jerk *= factor,
                    _ => looser.limits.snap *= factor,
                }
                assert!(
                    looser.plan(method).expect("valid").scans() <= scans,
                    "{request:?}"
                );
            }
            let mut longer = request;
            longer.target *= random.log(1.0, 1.5);
            assert!(
                longer.plan(method).expect("valid").scans() >= scans,
                "{request:?}"
            );
        }
    }
}

/// Invariant 7: powers of two in the units of length and time change no count.
#[test]
fn scaling_by_powers_of_two_changes_no_box() {
    let mut random = Random(10);
    for _ in 0..1000 {
        let request = Move {
            start: 0.0,
            ..servo(&mut random)
        };
        let length = power(2.0, random.below(41)) / power(2.0, 20);
        let time = power(2.0, random.below(21)) / power(2.0, 10);
        let other = Move {
            start: 0.0,
            target: request.target * length,
            limits: scaled_limits(&request.limits, (length, time)),
            cycle: request.cycle * time,
        };
        for method in METHODS {
            let (one, two) = (request.plan(method), other.plan(method));
            let (one, two) = (one.expect("valid"), two.expect("valid"));
            assert_eq!(one.boxes(), two.boxes(), "{request:?} {length} {time}");
        }
    }
}

/// Invariant 8: the mirrored move gives the exact negatives.
#[test]
fn a_mirrored_move_is_the_exact_negative() {
    let mut random = Random(11);
    for _ in 0..300 {
        let request = servo(&mut random);
        let mirrored = Move {
            start: -request.start,
            target: -request.target,
            ..request
        };
        for method in METHODS {
            let (one, two) = (request.plan(method), mirrored.plan(method));
            let (one, two) = (one.expect("valid"), two.expect("valid"));
            assert_eq!(one.boxes(), two.boxes());
            let n = u64::from(one.scans());
            for k in (0..=n + 1).step_by((n as usize / 100).max(1)) {
                assert_eq!(one.at(k), two.at(k).times(-1.0), "{request:?} at {k}");
            }
        }
    }
}

/// Invariant 11: a move limited by snap only has no other segments in the sequential planner.
#[test]
fn snap_alone_gives_no_spurious_segment() {
    let mut random = Random(12);
    for _ in 0..2000 {
        let request = Move {
            start: 0.0,
            target: random.log(1e-6, 1e3),
            limits: limits(f64::INFINITY, f64::INFINITY, f64::INFINITY, random.log(1e-3, 1e9)),
            cycle: random.log(1e-4, 1e-1),
        };
        let plan = request.plan(Method::Sequential).expect("valid");
        let counts = plan.counts().expect("counts");
        assert_eq!((counts.nj, counts.na, counts.nv), (Some(0), 0, 0), "{request:?}");
    }
}

/// Invariant 10: one digest for every platform, build and optimisation level.
#[test]
fn every_bit_of_the_vectors_is_the_recorded_one() {
    let mut digest = Digest::new();
    for (_, plan) in plans(0, 0, u32::MAX) {
        let n = u64::from(plan.scans());
        digest.add(n);
        for length in plan.boxes() {
            digest.add(u64::from(*length));
        }
        for k in (0..=n + 1).step_by((n as usize / 1000).max(1)) {
            digest.add_setpoint(&plan.at(k));
        }
        for segment in plan.segments() {
            for value in [
                segment.duration,
                segment.velocity,
                segment.acceleration,
                segment.jerk,
                segment.snap,
            ] {
                digest.add(value.to_bits());
            }
        }
        let peaks = plan.peaks();
        let peaks = [
            Some(peaks.velocity),
            Some(peaks.acceleration),
            peaks.jerk,
            peaks.snap,
        ];
        for peak in peaks.into_iter().flatten() {
            digest.add(peak.to_bits());
        }
    }
    assert_eq!(format!("{:016x}", digest.0), "e332a48b9f5e2fca");
}
