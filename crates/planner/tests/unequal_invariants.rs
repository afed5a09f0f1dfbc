//! The invariants of plans whose acceleration and deceleration differ, over seeded random moves.

use crate::grid_support::{Digest, Move, Random, four, power, servo};
use crate::ramp_plans::support::scaled_limits;
use standstill_planner::grid::Family;
use standstill_planner::{Field, Limits, Method, OnlinePlan, Order, PlanError, Setpoint, UnequalPlan};

const FAMILIES: [Family; 2] = [Family::Separate, Family::Overlapped];

fn plan(request: &Move, family: Family) -> UnequalPlan {
    try_plan(request, family).unwrap_or_else(|error| panic!("{request:?}: {error}"))
}

fn try_plan(request: &Move, family: Family) -> Result<UnequalPlan, PlanError> {
    let Move {
        start,
        target,
        limits,
        cycle,
    } = request;
    UnequalPlan::new(family, *start, *target, limits, *cycle)
}

/// A servo-like move whose rates differ up to 6 times.
fn unequal(random: &mut Random) -> Move {
    let mut request = servo(random);
    let limits = &mut request.limits;
    if limits.acceleration.is_infinite() {
        limits.acceleration = limits.velocity * random.log(1.0, 300.0);
    }
    limits.deceleration = limits.acceleration * random.log(1.0 / 6.0, 6.0);
    request
}

/// Random moves planned in both families, no plan longer than `longest` scans.
fn plans(seed: u64, count: usize, longest: u32) -> Vec<(Move, UnequalPlan)> {
    let mut random = Random(seed);
    let mut plans = Vec::new();
    for _ in 0..count {
        let request = unequal(&mut random);
        for family in FAMILIES {
            let plan = plan(&request, family);
            if (1..=longest).contains(&plan.scans()) {
                plans.push((request, plan));
            }
        }
    }
    plans
}

/// The state `t` into a stretch of constant snap.
fn moved([x, v, a, j, s]: [f64; 5], t: f64) -> [f64; 5] {
    [
        x + t * (v + t / 2.0 * (a + t / 3.0 * (j + t / 4.0 * s))),
        v + t * (a + t / 2.0 * (j + t / 3.0 * s)),
        a + t * (j + t / 2.0 * s),
        j + t * s,
        s,
    ]
}

#[test]
fn segments_lead_to_the_target_through_the_published_states_with_the_peaks_told() {
    let mut overlapped = 0;
    for (request, plan) in plans(21, 2000, u32::MAX) {
        let distance = request.target - request.start;
        let peaks = four(&plan.peaks());
        let (mut x, mut scan, mut count) = (0.0, 0, 0);
        let mut seen = [0.0_f64; 4];
        for segment in plan.segments() {
            count += 1;
            assert!(segment.scans > 0);
            let first = [
                x,
                segment.velocity,
                segment.acceleration,
                segment.jerk,
                segment.snap,
            ];
            let last = moved(first, segment.duration);
            // The velocity peaks where a changes its sign inside a segment. Jerk is constant or falls linearly
            // there, so it is a root of a quadratic.
            let mut instants = vec![0.0, segment.duration];
            let (a, j, s) = (segment.acceleration, segment.jerk, segment.snap);
            if a * last[2] < 0.0 {
                overlapped += 1;
                let (mut low, mut high) = (0.0, segment.duration);
                for _ in 0..80 {
                    let middle = 0.5 * (low + high);
                    let there = a + middle * (j + middle / 2.0 * s);
                    if there * a > 0.0 {
                        low = middle
                    } else {
                        high = middle
                    }
                }
                instants.push(low);
            }
            for t in instants {
                let [_, derivatives @ ..] = moved(first, t);
                for (seen, value) in seen.iter_mut().zip(derivatives) {
                    *seen = seen.max(value.abs());
                }
            }
            scan += u64::from(segment.scans);
            x = last[0];
            // The end of a segment just before the jump is what `at` publishes.
            let state = plan.at(scan);
            assert!(
                (state.position - request.start - x).abs()
                    <= 1e-9 * distance.abs() + 1e-15 * request.start.abs(),
                "{request:?} at {scan}"
            );
            let published = [state.velocity, state.acceleration, state.jerk, state.snap];
            let ended = scan == u64::from(plan.scans());
            for (degree, ((value, published), scale)) in (1..).zip(last[1..].iter().zip(published).zip(peaks))
            {
                // At orders 3 and 2 the last jump is to rest.
                if degree == plan.order().degree() && degree < 4 && ended {
                    assert_eq!(published, 0.0);
                    continue;
                }
                assert!(
                    (value - published).abs() <= 1e-9 * scale,
                    "{request:?} at {scan}, {degree}: {value} {published}"
                );
            }
        }
        assert!((1..=15).contains(&count));
        assert_eq!(scan, u64::from(plan.scans()));
        for (seen, told) in seen.into_iter().zip(peaks) {
            assert!((seen - told).abs() <= 1e-9 * told, "{request:?}: {seen} {told}");
        }
    }
    assert!(overlapped > 100, "{overlapped}");
}

/// In the forward direction the speed rises at most with the acceleration and falls at most with the deceleration:
/// in the continuous plan and in every backward difference of the published positions.
#[test]
fn each_rate_and_every_other_bound_holds_in_differences_of_published_positions() {
    for (request, plan) in plans(22, 300, 3000) {
        let Limits {
            velocity,
            acceleration,
            deceleration,
            jerk,
            snap,
        } = request.limits;
        let sign = 1.0_f64.copysign(request.target - request.start);
        let positions: Vec<_> = (0..u64::from(plan.scans()) + 4)
            .map(|k| sign * plan.at(k).position)
            .collect();
        let largest = request.start.abs().max(request.target.abs());
        let mut differences = [vec![positions[0]; 4], positions].concat();
        for (degree, (least, most)) in [
            (0.0, velocity),
            (-deceleration, acceleration),
            (-jerk, jerk),
            (-snap, snap),
        ]
        .into_iter()
        .enumerate()
        {
            differences = differences.windows(2).map(|pair| pair[1] - pair[0]).collect();
            let degree = degree as u64 + 1;
            // The most that 2^degree roundings of a position can produce.
            let resolution = power(2.0, degree) * largest * f64::EPSILON;
            for difference in &differences {
                let cycles = power(request.cycle, degree);
                assert!(
                    *difference <= most * (1.0 + 1e-9) * cycles + resolution
                        && *difference >= least * (1.0 + 1e-9) * cycles - resolution,
                    "{request:?} degree {degree}: {} not in {least}..{most}",
                    difference / cycles
                );
            }
        }
    }
}

#[test]
fn positions_never_step_back_or_past_an_end() {
    for (request, plan) in plans(23, 200, 5000) {
        let sign = 1.0_f64.copysign(request.target - request.start);
        let mut last = sign * request.start;
        for k in 0..=u64::from(plan.scans()) {
            let position = sign * plan.at(k).position;
            assert!(
                last <= position && position <= sign * request.target,
                "{request:?} at {k}"
            );
            last = position;
        }
        assert_eq!(
            plan.at(u64::from(plan.scans())).position.to_bits(),
            request.target.to_bits()
        );
        assert_eq!(plan.at(u64::MAX), Setpoint::at_rest(request.target));
    }
}

#[test]
fn a_mirrored_move_is_the_exact_negative_and_swapped_rates_take_as_long() {
    let mut random = Random(24);
    for _ in 0..500 {
        let request = unequal(&mut random);
        let mirrored = Move {
            start: -request.start,
            target: -request.target,
            ..request
        };
        let swapped = Move {
            limits: Limits {
                acceleration: request.limits.deceleration,
                deceleration: request.limits.acceleration,
                ..request.limits
            },
            ..request
        };
        for family in FAMILIES {
            let (one, two) = (plan(&request, family), plan(&mirrored, family));
            let n = u64::from(one.scans());
            assert_eq!(n, u64::from(two.scans()));
            for k in (0..=n + 1).step_by((n as usize / 100).max(1)) {
                assert_eq!(one.at(k), two.at(k).times(-1.0), "{request:?} at {k}");
            }
            let reversed = plan(&swapped, family);
            assert_eq!(one.scans(), reversed.scans(), "{request:?}");
            assert_eq!(
                (one.up(), one.down()),
                (reversed.down(), reversed.up()),
                "{request:?}"
            );
        }
    }
}

/// With more of anything no move is longer; with equal rates the two ramps are never longer than one shape
/// for both; and the lower of two rates for both is never shorter.
#[test]
fn more_of_a_rate_never_costs_a_scan() {
    let mut random = Random(25);
    for _ in 0..1000 {
        let request = unequal(&mut random);
        for (family, method) in FAMILIES.into_iter().zip([Method::Grid, Method::Overlapped]) {
            let scans = plan(&request, family).scans();
            let lower = request.limits.lower_acceleration();
            let both = Limits {
                acceleration: lower,
                deceleration: lower,
                ..request.limits
            };
            let one_rate = Move {
                limits: both,
                ..request
            };
            let least = plan(&one_rate, family).scans();
            let grid = one_rate.plan(method).expect("valid").scans();
            assert!(
                scans <= least && least <= grid,
                "{request:?}: {scans} {least} {grid}"
            );
            for raised in [
                Limits {
                    acceleration: request.limits.acceleration * random.log(1.0, 1.5),
                    ..request.limits
                },
                Limits {
                    deceleration: request.limits.deceleration * random.log(1.0, 1.5),
                    ..request.limits
                },
                Limits {
                    deceleration: f64::INFINITY,
                    ..request.limits
                },
            ] {
                let other = Move {
                    limits: raised,
                    ..request
                };
                assert!(plan(&other, family).scans() <= scans, "{request:?}");
            }
        }
    }
}

/// Powers of two in the units of length and time change no count.
#[test]
fn scaling_by_powers_of_two_changes_no_box() {
    let mut random = Random(26);
    for _ in 0..500 {
        let request = Move {
            start: 0.0,
            ..unequal(&mut random)
        };
        let length = power(2.0, random.below(41)) / power(2.0, 20);
        let time = power(2.0, random.below(21)) / power(2.0, 10);
        let other = Move {
            start: 0.0,
            target: request.target * length,
            limits: scaled_limits(&request.limits, (length, time)),
            cycle: request.cycle * time,
        };
        for family in FAMILIES {
            let (one, two) = (plan(&request, family), plan(&other, family));
            assert_eq!((one.up(), one.down()), (two.up(), two.down()), "{request:?}");
            assert_eq!(one.scans(), two.scans());
        }
    }
}

/// From rest the online planner may switch between scans, so it is never longer. The difference is the cost of
/// placing every switch on the grid, with equal rates and with two (docs/planner.md, section 13).
#[test]
fn the_grid_costs_a_few_scans_over_the_online_plan() {
    let mut random = Random(27);
    for two_rates in [false, true] {
        let mut shares = Vec::new();
        let (mut scans, mut more) = (0_u64, Vec::new());
        for _ in 0..2000 {
            let mut request = unequal(&mut random);
            if !two_rates {
                request.limits.deceleration = request.limits.acceleration;
            }
            if request.limits.velocity.is_infinite() || request.limits.acceleration.is_infinite() {
                continue;
            }
            let grid = if two_rates {
                plan(&request, Family::Overlapped).scans()
            } else {
                request.plan(Method::Overlapped).expect("valid").scans()
            };
            let rest = Setpoint::at_rest(request.start);
            let limits = &request.limits;
            let online =
                OnlinePlan::new(&rest, request.target, limits, limits, request.cycle).expect("valid");
            assert!(grid >= online.scans(), "{request:?}: {grid} {}", online.scans());
            more.push(grid - online.scans());
            // For very few scans, a few more are a large share.
            if online.scans() >= 50 {
                shares.push(f64::from(grid) / f64::from(online.scans()) - 1.0);
            }
            scans += u64::from(online.scans());
        }
        more.sort_unstable();
        shares.sort_by(f64::total_cmp);
        let sum: u32 = more.iter().sum();
        let scan = |share: usize| more[more.len() * share / 100];
        let share = |share: usize| shares[shares.len() * share / 100];
        println!(
            "two rates: {two_rates}, {} moves, {} the same, scans more: median {}, 95 % {}, 99 % {}, most {:?}; {:.2} % in all; \
             from 50 scans on: median {:.4}, 95 % {:.4}, 99 % {:.4}, most {:?}",
            more.len(),
            more.iter().filter(|more| **more == 0).count(),
            scan(50),
            scan(95),
            scan(99),
            more.last(),
            100.0 * f64::from(sum) / scans as f64,
            share(50),
            share(95),
            share(99),
            shares.last()
        );
        assert!(scan(50) <= 1 && scan(95) <= 7);
        assert!(shares.last().is_some_and(|most| *most <= 0.04));
    }
}

#[test]
fn nothing_to_move_and_what_cannot_be_planned() {
    let request = Move {
        start: 1.0,
        target: 2.0,
        limits: Limits {
            velocity: 1.0,
            acceleration: 4.0,
            deceleration: 9.0,
            jerk: 100.0,
            snap: 1000.0,
        },
        cycle: 1e-3,
    };
    for family in FAMILIES {
        let still = plan(
            &Move {
                target: 1.0,
                ..request
            },
            family,
        );
        assert_eq!(still.scans(), 0);
        assert!(still.up().is_empty() && still.down().is_empty());
        assert_eq!(still.segments().count(), 0);
        assert_eq!(still.at(0), Setpoint::at_rest(1.0));
        assert_eq!(still.peaks().velocity, 0.0);
        let with = |limits| try_plan(&Move { limits, ..request }, family);
        let refused = with(Limits {
            deceleration: -9.0,
            ..request.limits
        });
        let expected = PlanError::InvalidInput {
            field: Field::LimitDeceleration,
            value: -9.0,
        };
        assert_eq!(refused.err(), Some(expected));
        // Too long for any rate alone, and for all bounds together.
        let refused = with(Limits {
            deceleration: 1e-300,
            ..request.limits
        });
        let expected = PlanError::TooLong {
            field: Field::LimitDeceleration,
            value: 1e-300,
        };
        assert_eq!(refused.err(), Some(expected));
        let slow = Limits {
            velocity: 5e-7,
            acceleration: 1e-12,
            ..request.limits
        };
        assert!(matches!(with(slow), Err(PlanError::TooLong { .. })));
        let target = f64::INFINITY;
        let refused = try_plan(&Move { target, ..request }, family);
        let field = Field::Target;
        assert_eq!(
            refused.err(),
            Some(PlanError::InvalidInput { field, value: target })
        );
    }
}

/// A move that speeds up a million times slower than it slows down.
fn very_unequal(target: f64, velocity: f64) -> Move {
    Move {
        start: 0.0,
        target,
        limits: Limits {
            velocity,
            acceleration: 2.2e-6,
            deceleration: 18.9,
            ..Limits::NONE
        },
        cycle: 0.001,
    }
}

/// A search ended by its cap still returns a plan, never longer than with the lower rate for both.
#[test]
fn a_search_that_meets_its_cap_still_plans() {
    let mut capped = 0;
    for target in [1e6, 1.1e6, 1.3e6, 1.7e6, 2e6, 2.3e6] {
        let request = very_unequal(target, 1e4);
        let planned =
            UnequalPlan::new_counted(Family::Overlapped, 0.0, target, &request.limits, request.cycle);
        let (plan, work) = planned.expect("valid");
        capped += u32::from(work.capped);
        assert!(plan.scans() <= request.plan(Method::Overlapped).expect("valid").scans());
        assert_eq!(plan.at(u64::from(plan.scans())), Setpoint::at_rest(target));
        let peaks = plan.peaks();
        assert!(peaks.acceleration <= 18.9 * (1.0 + 1e-9));
    }
    assert!(capped > 0);
}

/// With the lower rate for both, these moves would take more scans than a plan can count.
#[test]
fn what_is_too_long_by_the_lower_rate_alone_is_planned() {
    for (target, velocity) in [(4e6, 100.0), (3e6, 1e4), (5e6, 1e6), (-4e6, 100.0)] {
        let up = very_unequal(target, velocity);
        let down = Move {
            limits: Limits {
                acceleration: up.limits.deceleration,
                deceleration: up.limits.acceleration,
                ..up.limits
            },
            ..up
        };
        let rates = up.limits.acceleration * up.limits.deceleration
            / (up.limits.acceleration + up.limits.deceleration);
        let least = (2.0 * target.abs() / rates).sqrt() / up.cycle;
        for request in [up, down] {
            assert!(request.plan(Method::Overlapped).is_err());
            for family in [Family::Separate, Family::Overlapped] {
                let plan = try_plan(&request, family).expect("valid");
                let scans = f64::from(plan.scans());
                assert!(
                    scans >= least * (1.0 - 1e-9) && scans <= least * (1.0 + 1e-4),
                    "{scans} {least}"
                );
                assert_eq!(plan.at(u64::from(plan.scans())), Setpoint::at_rest(target));
            }
        }
    }
}

/// One digest for every platform, build and optimisation level.
#[test]
fn every_bit_is_the_recorded_one() {
    let mut digest = Digest::new();
    let mut orders = [0; 5];
    for (_, plan) in plans(28, 300, u32::MAX) {
        orders[plan.order().degree()] += 1;
        let n = u64::from(plan.scans());
        digest.add(n);
        for length in plan.up().iter().chain(plan.down()) {
            digest.add(u64::from(*length));
        }
        for k in (0..=n + 1).step_by((n as usize / 200).max(1)) {
            digest.add_setpoint(&plan.at(k));
        }
        let peaks = plan.peaks();
        digest.add(peaks.velocity.to_bits());
        digest.add(peaks.acceleration.to_bits());
    }
    assert!(orders[Order::Two.degree()] > 10 && orders[Order::Three.degree()] > 10);
    assert_eq!(format!("{:016x}", digest.0), "4ca9af0e45c29f8c");
}
