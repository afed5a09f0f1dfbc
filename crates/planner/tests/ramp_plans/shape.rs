//! Least time, symmetry, continuity: the properties of a ramp besides its limits.

use super::support::{self, ORDERS, Random, UNITS, scaled, scaled_limits, scaled_state};
use crate::papers_plans::support::cube_root;
use standstill_planner::{Limits, Order, PlanError, RampPlan, Setpoint};
use std::vec::Vec;

fn plan(start: &Setpoint, goal: f64, limits: &Limits, cycle: f64) -> RampPlan {
    RampPlan::new(start, goal, limits, limits, cycle).unwrap()
}

/// From and to steady velocities the time is a sum of at most three boxes, longest last, whose product is
/// the change of velocity.
fn steady_duration(change: f64, acceleration: f64, limits: &Limits) -> f64 {
    let jerk_time = limits.jerk / limits.snap;
    match limits.order() {
        Order::Two => change / acceleration,
        Order::Three => {
            let rise = (acceleration / limits.jerk).min((change / limits.jerk).sqrt());
            rise + change / (limits.jerk * rise)
        }
        Order::Four => {
            // The first box of the snap; the second of the jerk, at least as long; the third of the
            // acceleration, at least as long as both.
            let first = cube_root(change / (2.0 * limits.snap))
                .min((acceleration / limits.snap).sqrt())
                .min(jerk_time);
            let by_acceleration = acceleration / (limits.snap * first);
            let unbounded = change / (limits.snap * first);
            let second = ((-first + (first * first + 4.0 * unbounded).sqrt()) / 2.0)
                .min(by_acceleration)
                .max(first);
            first + second + unbounded / second
        }
    }
}

#[test]
fn between_steady_velocities_the_time_is_the_closed_form() {
    let mut random = Random(21);
    for case in 0..6000 {
        let order = ORDERS[case % 3];
        let limits = support::limits(&mut random, order);
        let (from, to) = (limits.velocity * random.unit(), limits.velocity * random.unit());
        let start = Setpoint {
            velocity: from,
            ..Setpoint::at_rest(0.0)
        };
        let plan = plan(&start, to, &limits, 1e-3);
        let acceleration = if to > from {
            limits.acceleration
        } else {
            limits.deceleration
        };
        let expected = steady_duration((to - from).abs(), acceleration, &limits);
        let error = (plan.duration() - expected).abs() / expected;
        assert!(
            error <= 1e-9,
            "{error:e} {} {expected} {from} {to} {limits:?}",
            plan.duration()
        );
    }
}

/// Least numbers of samples found by linear programming (`least_samples.py`, seed 1, none dropped).
#[test]
fn no_linear_programme_is_faster() {
    let text = include_str!("least_samples.json");
    let file: serde_json::Value = serde_json::from_str(text).unwrap();
    let cases = file["cases"].as_array().unwrap();
    assert_eq!(cases.len(), 300);
    let mut ratios = Vec::new();
    for case in cases {
        let get = |key: &str| case[key].as_f64().unwrap();
        let limits = Limits {
            velocity: f64::INFINITY,
            acceleration: get("acceleration_bound"),
            deceleration: get("deceleration_bound"),
            jerk: get("jerk_bound"),
            snap: 1.0,
        };
        let start = Setpoint {
            position: 0.0,
            velocity: get("velocity"),
            acceleration: get("acceleration"),
            jerk: get("jerk"),
            snap: 0.0,
        };
        let plan = plan(&start, get("goal"), &limits, get("cycle"));
        let ratio = plan.duration() / (get("cycle") * get("samples"));
        assert!(ratio <= 1.0 + 1e-3, "{ratio} {case}");
        assert!(f64::from(plan.scans()) + 3.0 >= get("samples"), "{ratio} {case}");
        ratios.push(ratio);
    }
    ratios.sort_by(f64::total_cmp);
    println!("duration / programme: median {} max {}", ratios[150], ratios[299]);
}

/// States exactly on a bound: one ulp outwards, on any of them, makes no significant difference.
#[test]
fn an_ulp_outwards_on_a_limit_changes_nothing() {
    let mut random = Random(23);
    for case in 0..4000 {
        let order = ORDERS[1 + case % 2];
        let limits = support::limits(&mut random, order);
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let bound = if sign > 0.0 {
            limits.acceleration
        } else {
            limits.deceleration
        };
        let middle = limits.velocity * random.between(0.4, 0.6);
        let on_acceleration = Setpoint {
            velocity: middle,
            acceleration: sign * bound,
            ..Setpoint::default()
        };
        let up = |x: f64| f64::from_bits(x.to_bits() + 1);
        let mut pairs = Vec::new();
        pairs.push((
            on_acceleration,
            Setpoint {
                acceleration: up(on_acceleration.acceleration),
                ..on_acceleration
            },
        ));
        pairs.push((
            on_acceleration,
            Setpoint {
                jerk: sign * 1e-17 * limits.jerk.min(1e9),
                ..on_acceleration
            },
        ));
        pairs.push((
            on_acceleration,
            Setpoint {
                velocity: up(middle),
                ..on_acceleration
            },
        ));
        let on_velocity = Setpoint {
            velocity: limits.velocity,
            ..Setpoint::default()
        };
        pairs.push((
            on_velocity,
            Setpoint {
                velocity: up(limits.velocity),
                ..on_velocity
            },
        ));
        pairs.push((
            on_velocity,
            Setpoint {
                acceleration: 1e-17 * limits.acceleration,
                ..on_velocity
            },
        ));
        if order == Order::Four && limits.jerk.is_finite() {
            // On the jerk bound, and on the curve that just touches the acceleration bound.
            let room = limits.jerk * limits.jerk / (2.0 * limits.snap);
            if room < bound {
                let on_both = Setpoint {
                    velocity: middle,
                    acceleration: sign * (bound - room),
                    jerk: sign * limits.jerk,
                    ..Setpoint::default()
                };
                pairs.push((
                    on_both,
                    Setpoint {
                        jerk: up(on_both.jerk),
                        ..on_both
                    },
                ));
                pairs.push((
                    on_both,
                    Setpoint {
                        acceleration: up(on_both.acceleration),
                        ..on_both
                    },
                ));
            }
        }
        // The scale is at least the time of a whole ramp.
        let full = steady_duration(limits.velocity, limits.acceleration, &limits);
        let goals = [0.0, limits.velocity, limits.velocity * random.unit()];
        for (there, beyond) in pairs {
            for goal in goals {
                let (one, other) = (
                    plan(&there, goal, &limits, 1e-3),
                    plan(&beyond, goal, &limits, 1e-3),
                );
                let scale = one.duration().max(full);
                let change = (one.duration() - other.duration()).abs() / scale;
                assert!(
                    change <= 1e-6,
                    "{change:e} {there:?} {beyond:?} -> {goal} {limits:?}\n{one:?}\n{other:?}"
                );
            }
        }
    }
}

/// Lengths and times in other units, by powers of two: the same scans, the same bits.
#[test]
fn other_units_change_no_bit() {
    let mut random = Random(25);
    for case in 0..3000 {
        let order = ORDERS[case % 3];
        let limits = support::limits(&mut random, order);
        let rest = Setpoint::at_rest(0.25);
        let first = plan(&rest, limits.velocity * random.between(-1.0, 1.0), &limits, 1e-3);
        let start = first.at(random.below(u64::from(first.scans()) + 1));
        let goal = limits.velocity * random.between(-1.0, 1.0);
        let reference = plan(&start, goal, &limits, 1e-3);
        for unit in [(1048576.0, 1.0), (1.0, 8192.0), (1.0 / 2097152.0, 1.0 / 128.0)] {
            let other = plan(
                &scaled_state(&start, unit),
                scaled(goal, 1, unit),
                &scaled_limits(&limits, unit),
                1e-3 * unit.1,
            );
            assert_eq!(other.scans(), reference.scans());
            for scan in [
                0,
                1,
                reference.scans() / 2,
                reference.scans(),
                reference.scans() + 9,
            ] {
                let scan = u64::from(scan);
                assert_eq!(other.at(scan), scaled_state(&reference.at(scan), unit));
            }
        }
    }
}

/// Other units by a factor of a million, which is no power of two: the same scans.
#[test]
fn units_a_million_apart_change_no_scan() {
    let mut random = Random(27);
    for case in 0..3000 {
        let limits = support::limits(&mut random, ORDERS[case % 3]);
        let goal = limits.velocity * random.unit();
        let rest = Setpoint::at_rest(0.0);
        let cycle = 0.01 * limits.velocity / limits.acceleration;
        let reference = plan(&rest, goal, &limits, cycle);
        for unit in UNITS {
            let bounds = scaled_limits(&limits, unit);
            let goal = scaled(goal, 1, unit).min(bounds.velocity);
            let other = plan(&rest, goal, &bounds, cycle * unit.1);
            assert_eq!(other.scans(), reference.scans());
        }
    }
}

#[test]
fn the_mirrored_ramp_is_the_mirror_image() {
    let mut random = Random(29);
    for case in 0..3000 {
        let limits = support::limits(&mut random, ORDERS[case % 3]);
        let first = plan(
            &Setpoint::at_rest(0.0),
            limits.velocity * random.unit(),
            &limits,
            1e-3,
        );
        let start = first.at(random.below(u64::from(first.scans()) + 1));
        let goal = limits.velocity * random.between(-1.0, 1.0);
        let (one, other) = (
            plan(&start, goal, &limits, 1e-3),
            plan(&start.times(-1.0), -goal, &limits, 1e-3),
        );
        assert_eq!(one.scans(), other.scans());
        for scan in 0..u64::from(one.scans()).min(50) + 2 {
            assert_eq!(one.at(scan), other.at(scan).times(-1.0));
        }
    }
}

/// A ramp made again from any of its own states continues as it did.
#[test]
fn a_ramp_planned_again_continues_itself() {
    let mut random = Random(31);
    let mut worst: f64 = 0.0;
    for case in 0..6000 {
        let limits = support::limits(&mut random, ORDERS[case % 3]);
        let cycle = 0.003 * limits.velocity / limits.acceleration;
        let before = plan(
            &Setpoint::at_rest(0.0),
            limits.velocity * random.unit(),
            &limits,
            cycle,
        );
        let start = before.at(random.below(u64::from(before.scans()) + 1));
        let goal = limits.velocity * random.unit();
        let whole = plan(&start, goal, &limits, cycle);
        let scan = random.below(u64::from(whole.scans()) + 1);
        let rest = plan(&whole.at(scan), goal, &limits, cycle);
        let left = (whole.duration() - scan as f64 * cycle).max(0.0);
        let scale = whole.duration().max(limits.velocity / limits.acceleration);
        worst = worst.max((rest.duration() - left).abs() / scale);
        let middle = rest.scans() / 2;
        let gap = rest.at(u64::from(middle)).velocity - whole.at(scan + u64::from(middle)).velocity;
        assert!(gap.abs() <= 1e-9 * limits.velocity, "{gap:e}");
    }
    println!("worst change of duration {worst:e}");
    assert!(worst <= 1e-4, "{worst:e}");
}

#[test]
fn after_the_end_the_velocity_is_exact_and_a_stop_keeps_its_bits() {
    let mut random = Random(33);
    for case in 0..3000 {
        let order = ORDERS[case % 3];
        let limits = support::limits(&mut random, order);
        let cycle = 0.01 * limits.velocity / limits.acceleration;
        let up = plan(&Setpoint::at_rest(0.1), limits.velocity, &limits, cycle);
        let state = up.at(random.below(u64::from(up.scans())) + 1);
        let stop = plan(&state, 0.0, &limits, cycle);
        let end = u64::from(stop.scans());
        let rest = stop.at(end);
        assert!(rest.is_at_rest() && rest.snap == 0.0);
        assert_eq!(stop.at(end + 1), rest);
        assert_eq!(stop.at(u64::MAX), rest);
        // Neither the speed nor the position turns back on the way.
        let mut last = stop.at(0);
        for scan in 1..=end.min(3000) {
            let now = stop.at(scan);
            assert!(now.velocity >= 0.0, "{now:?}");
            assert!(now.position >= last.position, "{last:?} {now:?}");
            last = now;
        }
        // At constant velocity the position continues in a straight line.
        let after = up.at(u64::from(up.scans()) + 1000);
        let expected =
            up.end_position() + limits.velocity * ((f64::from(up.scans()) + 1000.0) * cycle - up.duration());
        assert_eq!(
            after,
            Setpoint {
                velocity: limits.velocity,
                ..Setpoint::at_rest(expected)
            }
        );
    }
}

#[test]
fn there_already_takes_no_scan() {
    for (jerk, snap) in [
        (f64::INFINITY, f64::INFINITY),
        (100.0, f64::INFINITY),
        (100.0, 1e4),
        (f64::INFINITY, 1e4),
    ] {
        let limits = Limits {
            velocity: 5.0,
            acceleration: 10.0,
            deceleration: 8.0,
            jerk,
            snap,
        };
        let steady = Setpoint {
            velocity: 2.0,
            ..Setpoint::at_rest(1.0)
        };
        let plan = plan(&steady, 2.0, &limits, 1e-3);
        assert_eq!(
            (plan.scans(), plan.duration(), plan.segments().count()),
            (0, 0.0, 0)
        );
        assert_eq!(plan.at(0), steady);
        assert_eq!(
            plan.at(500),
            Setpoint {
                position: 1.0 + 2.0 * (500.0 * 1e-3),
                ..steady
            }
        );
        assert_eq!(plan.excess(), None);
    }
}

#[test]
fn the_scan_before_a_switch_shows_what_was_in_force() {
    // 0 -> 1 at 10 u/s^2 and 100 u/s^3: 0.1 s up, 0.1 s down, and the switch is on a scan.
    let limits = Limits {
        velocity: 5.0,
        acceleration: 10.0,
        deceleration: 10.0,
        jerk: 100.0,
        snap: f64::INFINITY,
    };
    let plan = plan(&Setpoint::at_rest(0.0), 1.0, &limits, 0.01);
    assert_eq!(plan.scans(), 20);
    assert_eq!(plan.at(10).jerk, 100.0);
    assert_eq!(plan.at(11).jerk, -100.0);
    assert_eq!(
        plan.at(20),
        Setpoint {
            velocity: 1.0,
            ..Setpoint::at_rest(plan.end_position())
        }
    );
    assert!((plan.end_position() - 0.1).abs() < 1e-15);
    let peaks = plan.peaks();
    assert_eq!(
        (peaks.velocity, peaks.jerk, peaks.snap),
        (1.0, 100.0, f64::INFINITY)
    );
    assert!((peaks.acceleration - 10.0).abs() < 1e-13);
}

#[test]
fn unusable_inputs_are_refused_by_name() {
    let limits = Limits {
        velocity: 5.0,
        acceleration: 10.0,
        deceleration: 10.0,
        jerk: 100.0,
        snap: 1e4,
    };
    let rest = Setpoint::at_rest(0.0);
    let name = |start: Setpoint, goal: f64, limits: Limits, cycle: f64| match RampPlan::new(
        &start,
        goal,
        &limits,
        &Limits::NONE,
        cycle,
    ) {
        Err(PlanError::InvalidInput { field, .. }) => field.name(),
        Err(PlanError::TooLong { .. }) => "too long",
        other => panic!("{other:?}"),
    };
    type Part<T> = (&'static str, fn(&mut T) -> &mut f64);
    let states: [Part<Setpoint>; 4] = [
        ("position", |state| &mut state.position),
        ("velocity", |state| &mut state.velocity),
        ("acceleration", |state| &mut state.acceleration),
        ("jerk", |state| &mut state.jerk),
    ];
    let bounds: [Part<Limits>; 5] = [
        ("limits.velocity", |limits| &mut limits.velocity),
        ("limits.acceleration", |limits| &mut limits.acceleration),
        ("limits.deceleration", |limits| &mut limits.deceleration),
        ("limits.jerk", |limits| &mut limits.jerk),
        ("limits.snap", |limits| &mut limits.snap),
    ];
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        for (field, part) in states {
            let mut start = rest;
            *part(&mut start) = bad;
            assert_eq!(name(start, 1.0, limits, 1e-3), field);
        }
        assert_eq!(name(rest, bad, limits, 1e-3), "end_velocity");
        assert_eq!(name(rest, 1.0, limits, bad), "Ts");
    }
    // An infinite bound is none, which only the accelerations cannot be.
    let invalid = |field, bad: f64| {
        bad != f64::INFINITY || matches!(field, "limits.acceleration" | "limits.deceleration")
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY, 0.0, -1.0] {
        for (field, part) in bounds.into_iter().filter(|(field, _)| invalid(field, bad)) {
            let mut limits = limits;
            *part(&mut limits) = bad;
            assert_eq!(name(rest, 0.0, limits, 1e-3), field);
        }
    }
    for bad in [0.0, -1.0] {
        assert_eq!(name(rest, 1.0, limits, bad), "Ts");
    }
    assert_eq!(name(rest, 5.000001, limits, 1e-3), "end_velocity");
    assert_eq!(name(rest, -5.000001, limits, 1e-3), "end_velocity");
    assert_eq!(name(rest, 5.0, limits, 1e-12), "too long");
    let slow = Limits {
        snap: 1e-300,
        ..limits
    };
    assert_eq!(name(rest, 5.0, slow, 1e-12), "too long");
}

/// Bounds of any size against each other: a plan or a refusal, and a plan ends exactly.
#[test]
fn absurd_inputs_end_in_a_plan_or_a_refusal() {
    let mut random = Random(35);
    let (mut planned, mut refused) = (0, 0);
    let count = standstill_testkit::whole_or(20_000, 1_000);
    for case in 0..count {
        let size = |random: &mut Random| random.log(1e-40, 1e40);
        let signed = |random: &mut Random| match random.below(4) {
            0 => 0.0,
            1 => -random.log(1e-40, 1e40),
            _ => random.log(1e-40, 1e40),
        };
        let bound = |random: &mut Random| {
            if random.below(4) == 0 {
                f64::INFINITY
            } else {
                random.log(1e-40, 1e40)
            }
        };
        let limits = Limits {
            velocity: bound(&mut random),
            acceleration: size(&mut random),
            deceleration: size(&mut random),
            jerk: bound(&mut random),
            snap: bound(&mut random),
        };
        let before = Limits {
            jerk: bound(&mut random),
            snap: bound(&mut random),
            deceleration: bound(&mut random),
            ..limits
        };
        let start = Setpoint {
            position: signed(&mut random),
            velocity: signed(&mut random),
            acceleration: signed(&mut random),
            jerk: signed(&mut random),
            snap: 0.0,
        };
        let goal = signed(&mut random);
        match RampPlan::new(&start, goal, &limits, &before, size(&mut random)) {
            Ok(plan) => {
                planned += 1;
                let end = plan.at(u64::from(plan.scans()));
                assert_eq!(
                    (end.velocity, end.acceleration, end.jerk),
                    (goal, 0.0, 0.0),
                    "case {case}"
                );
                assert!(plan.segments().count() <= 20, "case {case}");
                assert!(plan.duration() >= 0.0);
            }
            Err(_) => refused += 1,
        }
    }
    println!("planned {planned} refused {refused}");
    assert!(planned > count / 10);
}

/// A ramp that reduces its acceleration for minutes, with a jerk far below all other limits, still ends at a goal
/// close to where it would come to rest.
#[test]
fn an_arrest_of_minutes_hides_no_goal_close_to_its_end() {
    const JERK: f64 = 3e-7;
    const CYCLE: f64 = 2e-5;
    let limits = Limits {
        velocity: 0.015,
        acceleration: 12.0,
        deceleration: 13.0,
        jerk: JERK,
        snap: 1e30,
    };
    for seconds in [20.0, 155.0, 300.0] {
        let speed = 0.5 * JERK * seconds * seconds;
        let start = Setpoint {
            velocity: speed,
            acceleration: -JERK * seconds,
            jerk: JERK,
            ..Setpoint::at_rest(0.0)
        };
        let mut share = 1.0;
        for _ in 0..12 {
            share *= 0.1;
            for goal in [speed * share, -speed * share] {
                let plan = plan(&start, goal, &limits, CYCLE);
                let seen = support::integrate(&start, &plan, Order::Four);
                let off = (seen.end.velocity - goal).abs();
                assert!(off <= 1e-12 * speed, "{seconds} s to {goal:e}: off by {off:e}");
                // Beyond its end the acceleration changes its sign; before it, the ramp only lasts a little longer.
                let least = seconds + 2.0 * (f64::max(goal, 0.0) / JERK).sqrt();
                assert!(plan.duration() >= least * (1.0 - 1e-6), "{seconds} s to {goal:e}");
            }
        }
    }
}
