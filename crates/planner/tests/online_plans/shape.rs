//! The properties of single plans: units, continuity, rungs, special targets, refusals.

use super::support::{self, ORDERS, Random, UNITS, arrive, scaled, scaled_limits, scaled_state};
use standstill_planner::{
    Limits, MoveProfile, OnlinePlan, Order, Plan, PlanError, Planner, Rung, Setpoint, Standard,
};

fn plan(start: &Setpoint, target: f64, limits: &Limits, cycle: f64) -> OnlinePlan {
    OnlinePlan::new(start, target, limits, limits, cycle).expect("a plan")
}

/// Limits, a cycle that suits them, and a state in the middle of some move under them.
fn moving(random: &mut Random, order: Order) -> (Limits, f64, Setpoint) {
    let limits = support::limits(random, order);
    let time = limits.velocity / limits.acceleration;
    let cycle = 0.02 * time;
    let way = limits.velocity * time;
    let mut start = Setpoint::at_rest(way * random.between(-1.0, 1.0));
    for _ in 0..2 {
        let before = plan(&start, way * random.between(-3.0, 3.0), &limits, cycle);
        start = before.at(random.below(u64::from(before.scans()) + 1));
    }
    (limits, cycle, start)
}

/// Other units by a factor of a million, which is no power of two: the same scans. By powers of two: the same bits.
#[test]
fn other_units_change_no_scan() {
    let mut random = Random(61);
    for case in 0..3000 {
        let (limits, cycle, start) = moving(&mut random, ORDERS[case % 3]);
        let target = start.position + limits.velocity * cycle * random.between(-300.0, 300.0);
        let reference = plan(&start, target, &limits, cycle);
        let within = |unit: (f64, f64)| {
            plan(
                &scaled_state(&start, unit),
                scaled(target, 0, unit),
                &scaled_limits(&limits, unit),
                cycle * unit.1,
            )
        };
        for unit in UNITS {
            let other = within(unit);
            assert_eq!(
                other.scans(),
                reference.scans(),
                "case {case} {unit:?} {start:?} -> {target:?} {limits:?} {cycle}"
            );
            assert_eq!(other.rung(), reference.rung());
        }
        let unit = (1_048_576.0, 1.0 / 8192.0);
        let other = within(unit);
        for scan in 0..=u64::from(reference.scans()) {
            assert_eq!(
                other.at(scan),
                scaled_state(&reference.at(scan), unit),
                "case {case} scan {scan}"
            );
        }
    }
}

#[test]
fn the_mirrored_move_is_the_mirror_image() {
    let mut random = Random(63);
    for case in 0..3000 {
        let (limits, cycle, start) = moving(&mut random, ORDERS[case % 3]);
        let target = start.position + limits.velocity * cycle * random.between(-300.0, 300.0);
        let one = plan(&start, target, &limits, cycle);
        let other = plan(&start.times(-1.0), -target, &limits, cycle);
        for scan in 0..=u64::from(one.scans()) {
            assert_eq!(one.at(scan), other.at(scan).times(-1.0));
        }
    }
}

/// At or near a velocity of zero, which has no direction, the higher derivatives decide; also where they cannot be
/// stopped inside the limits.
#[test]
fn the_mirrored_move_from_no_velocity_is_the_mirror_image() {
    let mut random = Random(64);
    let mut outside = 0;
    for case in 0..6000 {
        let limits = support::limits(&mut random, ORDERS[case % 3]);
        let within = |random: &mut Random, bound: f64| match random.below(4) {
            0 => 0.0,
            _ => bound.min(1e6) * random.between(-1.0, 1.0),
        };
        let start = Setpoint {
            velocity: 1e-10 * within(&mut random, limits.velocity) * random.below(2) as f64,
            acceleration: within(&mut random, limits.acceleration.min(limits.deceleration)),
            jerk: within(&mut random, limits.jerk),
            ..Setpoint::default()
        };
        let time = limits.velocity / limits.acceleration;
        let cycle = time * random.log(0.001, 0.3);
        let target = within(&mut random, 30.0 * limits.velocity * time) * random.log(1e-9, 1.0);
        let planned = |start: &Setpoint, target| OnlinePlan::new(start, target, &limits, &limits, cycle);
        // The move leads too far to come back in any time that can be counted.
        let Ok(one) = planned(&start, target) else {
            assert!(planned(&start.times(-1.0), -target).is_err());
            continue;
        };
        let other = plan(&start.times(-1.0), -target, &limits, cycle);
        let context = || format!("case {case} {start:?} -> {target:?} {limits:?} {cycle}");
        assert_eq!(one.scans(), other.scans(), "{}", context());
        assert_eq!(one.rung(), other.rung(), "{}", context());
        assert_eq!(one.peaks(), other.peaks(), "{}", context());
        assert_eq!(one.excess(), other.excess(), "{}", context());
        for scan in (0..=u64::from(one.scans())).step_by(1 + one.scans() as usize / 50) {
            assert_eq!(one.at(scan), other.at(scan).times(-1.0), "{}", context());
        }
        outside += u32::from(one.excess().is_some());
    }
    assert!(outside > 600, "{outside} of 6000 begin outside what can be kept");
}

/// States on a limit, and one ulp or 1e-12 of the limit outside: the plan changes by no more than this difference
/// explains.
#[test]
fn a_nudge_outwards_on_a_limit_changes_nothing() {
    let mut random = Random(65);
    let mut worst: f64 = 0.0;
    for case in 0..2000 {
        let order = ORDERS[1 + case % 2];
        let mut limits = support::limits(&mut random, order);
        limits.jerk = limits.jerk.min(1e6 * limits.acceleration);
        let Limits {
            velocity: v,
            acceleration: a,
            jerk: j,
            snap: s,
            ..
        } = limits;
        let time = v / a;
        // The time and velocity that it takes to end the acceleration.
        let room = if order == Order::Four {
            (2.0 * a / s).sqrt().max(j / s + a / j) * a
        } else {
            0.5 * a * a / j
        };
        let state = |velocity: f64, acceleration: f64, jerk: f64| Setpoint {
            velocity,
            acceleration,
            jerk,
            ..Setpoint::default()
        };
        for nudge in [f64::EPSILON, 1e-12] {
            let out = 1.0 + nudge;
            let mut pairs = vec![
                (state(v, 0.0, 0.0), state(v * out, 0.0, 0.0)),
                (state(v, 0.0, 0.0), state(v, a * nudge, 0.0)),
                (state(v, 0.0, 0.0), state(v, 0.0, j * nudge)),
            ];
            if room < v {
                pairs.extend([
                    (state(v - room, a, 0.0), state(v - room, a * out, 0.0)),
                    (state(v - room, a, 0.0), state(v - room, a, j * nudge)),
                    (state(0.0, a, 0.0), state(0.0, a, 1e-17 * j)),
                    (
                        state(-v + room, -limits.deceleration.min(a), 0.0),
                        state(-v + room, -limits.deceleration.min(a) * out, 0.0),
                    ),
                ]);
            }
            for (there, beyond) in pairs {
                let target = v * time * random.between(-4.0, 4.0);
                let (one, other) = (
                    plan(&there, target, &limits, 0.01 * time),
                    plan(&beyond, target, &limits, 0.01 * time),
                );
                let change = (one.duration() - other.duration()).abs() / one.duration();
                assert!(
                    change <= 1e-6,
                    "{change:e} {there:?} {beyond:?} -> {target} {limits:?}\n{one:?}\n{other:?}"
                );
                worst = worst.max(change);
                assert_eq!(one.rung(), other.rung());
            }
        }
    }
    println!("largest relative change of duration {worst:e}");
}

/// The end velocity 0 is no special case: nearly 0 takes nearly as long.
#[test]
fn passing_nearly_at_rest_is_nearly_stopping() {
    let mut random = Random(67);
    let mut worst: f64 = 0.0;
    for case in 0..2000 {
        let (limits, cycle, start) = moving(&mut random, ORDERS[case % 3]);
        let target = start.position + limits.velocity * cycle * random.between(-300.0, 300.0);
        let stop = plan(&start, target, &limits, cycle);
        let pass = OnlinePlan::passing(&start, target, 1e-12 * limits.velocity, &limits, &limits, cycle)
            .expect("a plan");
        let change = (pass.duration() - stop.duration()).abs() / stop.duration().max(cycle);
        if change > 1e-3 {
            println!("BAD {change} {start:?} {target:?} {limits:?} {cycle}");
        }
        worst = worst.max(change);
    }
    println!("largest relative change of duration {worst:e}");
    assert!(worst <= 1e-3, "{worst:e}");
}

/// A plan made again from any of its own states, to the same target, continues as it did.
#[test]
fn a_move_planned_again_continues_itself() {
    let mut random = Random(69);
    let mut worst: f64 = 0.0;
    for case in 0..6000 {
        let (limits, cycle, start) = moving(&mut random, ORDERS[case % 3]);
        let target = start.position + limits.velocity * cycle * random.between(-300.0, 300.0);
        let whole = plan(&start, target, &limits, cycle);
        let scan = random.below(u64::from(whole.scans()) + 1);
        let rest = plan(&whole.at(scan), target, &limits, cycle);
        let left = (whole.duration() - scan as f64 * cycle).max(0.0);
        let change = (rest.duration() - left) / whole.duration().max(cycle);
        assert!(change <= 1e-3, "case {case} scan {scan}: {change:e} {limits:?}");
        worst = worst.max(change);
    }
    println!("largest relative change of duration {worst:e}");
}

/// Every rung by itself keeps the limits and reaches the target, and none is shorter than the first.
#[test]
fn every_rung_arrives() {
    let mut random = Random(71);
    let mut longer = [1.0f64; 4];
    for case in 0..4000 {
        let order = ORDERS[case % 3];
        let (limits, cycle, start) = moving(&mut random, order);
        let target = start.position + limits.velocity * cycle * random.between(-300.0, 300.0);
        let end_velocity = if case % 2 == 0 {
            0.0
        } else {
            limits.velocity * random.between(-1.0, 1.0)
        };
        let best =
            OnlinePlan::passing(&start, target, end_velocity, &limits, &limits, cycle).expect("a plan");
        assert_eq!(best.rung(), Rung::PushThenStop);
        for rung in Rung::ALL {
            let plan = OnlinePlan::with(rung, &start, target, end_velocity, &limits, &limits, cycle)
                .unwrap_or_else(|error| {
                    panic!("{error} {rung:?} {start:?} {target} {end_velocity} {limits:?} {cycle}")
                });
            assert!(plan.rung() >= rung, "{rung:?}");
            assert_eq!(plan.excess(), None, "{rung:?} {plan:?}");
            let ratio = plan.duration() / best.duration();
            // With an end velocity a longer distance may take less time.
            assert!(
                ratio >= 1.0 - 1e-9 || end_velocity != 0.0,
                "{rung:?} {ratio} {limits:?} {start:?} {target}"
            );
            longer[plan.rung() as usize] = longer[plan.rung() as usize].max(ratio);
            let (seen, miss) = arrive(&start, &plan, target, order);
            assert!(miss <= 1e-9, "{rung:?} {miss:e} {plan:?}");
            assert!(seen.inside(limits), "{rung:?} {seen:?} {limits:?} {plan:?}");
            // The set-points between are those of the segments: no jump from one to the next.
            let resolved = 32.0 * f64::EPSILON * (start.position.abs() + target.abs());
            let mut last = plan.at(0);
            for scan in 1..=u64::from(plan.scans()) + 2 {
                let now = plan.at(scan);
                let step = (now.position - last.position).abs();
                assert!(
                    step <= limits.velocity * cycle * (1.0 + 1e-9) + resolved,
                    "{rung:?} scan {scan} {plan:?}"
                );
                last = now;
            }
            if end_velocity == 0.0 {
                assert_eq!(last, Setpoint::at_rest(target));
            } else {
                assert_eq!(
                    (last.velocity, last.acceleration, last.jerk),
                    (end_velocity, 0.0, 0.0)
                );
            }
        }
    }
    println!("longest beside push-then-stop, by rung: {longer:?}");
}

/// Limits that change at every replan, and end velocities: always a plan, and it passes the target.
#[test]
fn passing_under_changing_limits_always_has_a_plan() {
    let mut random = Random(75);
    let mut rungs = [0; 4];
    for case in 0..300 {
        let order = ORDERS[case % 3];
        let limits = support::limits(&mut random, order);
        let time = limits.velocity / limits.acceleration;
        let cycle = 0.02 * time;
        let (mut start, mut before) = (Setpoint::default(), limits);
        for link in 0..20 {
            let now = support::each_times(&limits, || random.between(0.3, 1.0));
            let target = limits.velocity * time * random.between(-3.0, 3.0);
            let end_velocity = now.velocity * random.between(-1.0, 1.0);
            let plan = OnlinePlan::passing(&start, target, end_velocity, &now, &before, cycle)
                .unwrap_or_else(|error| panic!("case {case} link {link}: {error}"));
            rungs[plan.rung() as usize] += 1;
            let (_, miss) = arrive(&start, &plan, target, order);
            assert!(miss <= 1e-9, "{miss:e} {plan:?}");
            let end = u64::from(plan.scans());
            let after = plan.at(end + 3);
            assert_eq!(
                (after.velocity, after.acceleration, after.jerk),
                (end_velocity, 0.0, 0.0)
            );
            before = now;
            start = plan.at(random.below(end + 2));
        }
    }
    println!("rungs {rungs:?}");
}

const SERVO: Limits = Limits {
    velocity: 1.0,
    acceleration: 10.0,
    deceleration: 10.0,
    jerk: 400.0,
    snap: 20_000.0,
};

#[test]
fn special_targets() {
    let rest = Setpoint::at_rest(0.3);
    // The axis is already there.
    let none = plan(&rest, 0.3, &SERVO, 1e-3);
    assert_eq!(
        (none.scans(), none.duration(), none.segments().count()),
        (0, 0.0, 0)
    );
    assert_eq!(none.at(0), rest);
    assert_eq!(none.at(7), rest);
    let cruising = Setpoint {
        velocity: 1.0,
        ..rest
    };
    // Inside the braking distance: past the target and back, sooner than with a full stop first.
    let near = plan(&cruising, 0.301, &SERVO, 1e-3);
    assert!((0..=u64::from(near.scans())).any(|scan| near.at(scan).velocity < 0.0));
    assert!(
        near.duration()
            < OnlinePlan::with(Rung::Brake, &cruising, 0.301, 0.0, &SERVO, &SERVO, 1e-3)
                .expect("a plan")
                .duration()
    );
    // Behind the axis, and at its place: the same.
    for target in [0.3, -2.0] {
        let back = plan(&cruising, target, &SERVO, 1e-3);
        assert_eq!(back.at(u64::from(back.scans())), Setpoint::at_rest(target));
        assert_eq!(back.excess(), None);
    }
    // Exactly where the fastest stop ends: that stop.
    let stop = standstill_planner::RampPlan::new(&cruising, 0.0, &SERVO, &SERVO, 1e-3).expect("a plan");
    let there = plan(&cruising, stop.end_position(), &SERVO, 1e-3);
    assert_eq!(there.scans(), stop.scans());
    // Far ahead: no slower than cruising.
    let far = plan(&cruising, 10.3, &SERVO, 1e-3);
    assert!(far.duration() < 10.0 + 2.0 * stop.duration());
    // Rest to rest it is at least as fast as the grid.
    let grid =
        standstill_planner::GridPlan::new(standstill_planner::Method::Overlapped, 0.3, 0.9, &SERVO, 1e-3)
            .expect("a plan");
    assert!(plan(&rest, 0.9, &SERVO, 1e-3).scans() <= grid.scans());
}

/// Too fast for a lowered limit: inside it as soon as the old limits allow, with the excess reported, and on to the
/// target.
#[test]
fn over_a_lowered_velocity_limit() {
    let cruising = Setpoint {
        velocity: 1.0,
        ..Setpoint::default()
    };
    let lowered = Limits {
        velocity: 0.4,
        ..SERVO
    };
    for target in [5.0, 0.01, 0.0, -5.0] {
        let plan = OnlinePlan::new(&cruising, target, &lowered, &SERVO, 1e-3).expect("a plan");
        let excess = plan.excess().expect("told");
        assert!((excess.velocity - 0.6).abs() <= 1e-12);
        assert_eq!((excess.acceleration, excess.jerk), (0.0, 0.0));
        assert_eq!(plan.rung(), Rung::PushThenStop);
        // From 1 to 0.4 u/s with A = 10, J = 400, S = 20000: 0.105 s.
        let inside = (0..u64::from(plan.scans()))
            .position(|scan| plan.at(scan).velocity <= 0.4 * (1.0 + 1e-9))
            .expect("inside");
        assert!(inside <= 106, "{inside}");
        assert!(
            (inside as u64..u64::from(plan.scans()))
                .all(|scan| plan.at(scan).velocity.abs() <= 0.4 * (1.0 + 1e-9))
        );
    }
}

/// Above a lowered velocity limit the old limits hold. Where the way back to the target begins at once, the
/// acceleration has to be at its own limit when the velocity passes zero, even if the deceleration may be much
/// higher.
#[test]
fn over_a_lowered_velocity_limit_it_turns_within_both_accelerations() {
    let mut random = Random(67);
    for order in ORDERS {
        for case in 0..standstill_testkit::cases(20_000) {
            let up = random.log(10.0, 1e5);
            let jerk = up * random.log(10.0, 1e7);
            let limits = Limits {
                velocity: random.between(0.05, 1.0),
                acceleration: up,
                // As users write "no limit", too.
                deceleration: if case % 5 == 0 {
                    1e30
                } else {
                    up * random.log(0.1, 1e7)
                },
                jerk: if order > Order::Two { jerk } else { f64::INFINITY },
                snap: if order > Order::Three {
                    jerk * random.log(10.0, 1e6)
                } else {
                    f64::INFINITY
                },
            };
            let before = Limits {
                velocity: 1.0,
                ..limits
            };
            let start = Setpoint {
                velocity: 1.0,
                ..Setpoint::at_rest(0.0)
            };
            let target = if case % 3 == 0 {
                0.0
            } else {
                random.between(-0.01, 0.01)
            };
            let plan = OnlinePlan::new(&start, target, &limits, &before, 0.001).expect("a plan");
            let excess = plan.excess().unwrap_or_default();
            assert_eq!(
                (excess.acceleration, excess.jerk),
                (0.0, 0.0),
                "{limits:?} to {target}"
            );
        }
    }
}

#[test]
fn unusable_inputs_are_refused_by_name() {
    let rest = Setpoint::at_rest(0.0);
    let name = |start: Setpoint, target: f64, end_velocity: f64, limits: Limits, cycle: f64| {
        match OnlinePlan::passing(&start, target, end_velocity, &limits, &Limits::NONE, cycle) {
            Err(PlanError::InvalidInput { field, .. }) => field.name(),
            Err(PlanError::TooLong { .. }) => "too long",
            other => panic!("{other:?}"),
        }
    };
    for bad in [f64::NAN, f64::INFINITY, f64::NEG_INFINITY] {
        let start = Setpoint { jerk: bad, ..rest };
        assert_eq!(name(start, 1.0, 0.0, SERVO, 1e-3), "jerk");
        assert_eq!(name(rest, bad, 0.0, SERVO, 1e-3), "target");
        assert_eq!(name(rest, 1.0, bad, SERVO, 1e-3), "end_velocity");
        assert_eq!(name(rest, 1.0, 0.0, SERVO, bad), "Ts");
        let limits = Limits {
            velocity: bad,
            ..SERVO
        };
        assert_eq!(name(rest, 1.0, 0.0, limits, 1e-3), "limits.velocity");
    }
    assert_eq!(name(rest, 1.0, 1.0001, SERVO, 1e-3), "end_velocity");
    assert_eq!(name(rest, 1e300, 0.0, SERVO, 1e-3), "too long");
    assert_eq!(name(Setpoint::at_rest(-1e308), 1e308, 0.0, SERVO, 1e-3), "target");
}

/// Bounds of any size against each other: a plan or a refusal, and a plan ends exactly.
#[test]
fn absurd_inputs_end_in_a_plan_or_a_refusal() {
    let mut random = Random(73);
    let (mut planned, mut refused, mut rungs) = (0, 0, [0; 4]);
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
            velocity: size(&mut random),
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
        let target = signed(&mut random);
        match OnlinePlan::new(&start, target, &limits, &before, size(&mut random)) {
            Ok(plan) => {
                planned += 1;
                rungs[plan.rung() as usize] += 1;
                assert_eq!(
                    plan.at(u64::from(plan.scans())),
                    Setpoint::at_rest(target),
                    "case {case}"
                );
                assert!(plan.duration() >= 0.0);
            }
            Err(PlanError::TooLong { .. }) => refused += 1,
            Err(error) => panic!("case {case}: {error}"),
        }
    }
    println!("planned {planned} refused {refused} rungs {rungs:?}");
    assert!(planned > count / 20);
}

/// A plan that remembers its last scan: scan after scan, back again, and with its coordinates moved in between.
#[test]
fn next_is_the_same_as_at() {
    let mut random = Random(31);
    for count in 0..300 {
        let (limits, cycle, start) = moving(&mut random, ORDERS[count % 3]);
        let way = limits.velocity * limits.velocity / limits.acceleration;
        let planner = Standard::new(cycle);
        let (target, velocity) = (way * random.between(-3.0, 3.0), limits.velocity * random.unit());
        let profile = MoveProfile::default();
        let mut plans = [
            planner.move_to(profile, &start, target, &limits, &limits),
            planner.move_to(profile, &Setpoint::at_rest(way), target, &limits, &limits),
            planner.ramp_to(&start, velocity, &limits, &limits),
            planner.pass(&start, target, velocity, &limits, &limits),
        ]
        .map(|plan| plan.expect("a plan"));
        for plan in &mut plans {
            let scans = u64::from(plan.scans());
            let (ahead, back) = (0..scans + 3, (0..scans + 3).rev());
            let anywhere = (0..20).map(|_| random.below(scans + 1)).collect::<Vec<_>>();
            for scan in ahead.chain(back).chain(anywhere) {
                assert_eq!(plan.next(scan), plan.at(scan), "{count}: {scan} of {plan:?}");
                if scan == scans / 3 {
                    plan.shift(way);
                }
            }
        }
    }
}
