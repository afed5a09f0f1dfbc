//! Profiles: a curve passes its points, is smooth from its start state to its end, and is accepted
//! exactly if it keeps the limits. Only its set-points are judged, sampled between the scans of a coarse
//! cycle.

use standstill_planner::{
    Limits, PROFILE_POINTS, ProfileCause, ProfileKind, ProfilePlan, ProfilePoint, Setpoint,
};
use standstill_testkit::Random;

const FREE: Limits = Limits {
    velocity: 1e9,
    acceleration: 1e9,
    deceleration: 1e9,
    jerk: 1e12,
    snap: 1e18,
};

/// Fine enough to see everything, and a divisor of every time below.
const CYCLE: f64 = 1.0 / 1024.0;

fn points(values: &[(f64, f64)]) -> Vec<ProfilePoint> {
    let mut time = 0.0;
    let of = |(delta, value): &(f64, f64)| {
        time += delta;
        ProfilePoint {
            time,
            value: *value,
            level: false,
        }
    };
    values.iter().map(of).collect()
}

fn value_of(kind: ProfileKind, state: &Setpoint) -> f64 {
    match kind {
        ProfileKind::Position => state.position,
        ProfileKind::Velocity => state.velocity,
        ProfileKind::Acceleration => state.acceleration,
    }
}

const KINDS: [ProfileKind; 3] = [
    ProfileKind::Position,
    ProfileKind::Velocity,
    ProfileKind::Acceleration,
];

fn random_points(random: &mut Random) -> Vec<ProfilePoint> {
    let count = 1 + (random.unit() * 12.0) as usize;
    let mut time = 0.0;
    (0..count)
        .map(|_| {
            // A multiple of the cycle, so that each point is at a scan end.
            time += f64::from(1 + (random.unit() * 300.0) as u32) * CYCLE;
            ProfilePoint {
                time,
                value: random.unit() * 20.0 - 10.0,
                level: random.unit() < 0.2,
            }
        })
        .collect()
}

fn random_start(random: &mut Random) -> Setpoint {
    let mut signed = |most: f64| (random.unit() * 2.0 - 1.0) * most;
    Setpoint {
        position: signed(10.0),
        velocity: signed(5.0),
        acceleration: signed(20.0),
        jerk: signed(100.0),
        snap: 0.0,
    }
}

#[test]
fn a_curve_starts_in_its_start_meets_its_points_and_lands_on_the_last() {
    let mut random = Random(1);
    for case in 0..600 {
        let (kind, start, points) = (
            KINDS[case % 3],
            random_start(&mut random),
            random_points(&mut random),
        );
        let plan = ProfilePlan::new(kind, &start, &points, &FREE, None, CYCLE).unwrap();
        let first = plan.at(0);
        assert_eq!(first.position, start.position);
        assert!((first.velocity - start.velocity).abs() < 1e-12, "{case}");
        assert!((first.acceleration - start.acceleration).abs() < 1e-9, "{case}");
        assert!((first.jerk - start.jerk).abs() < 1e-6, "{case}");
        for point in &points {
            let scan = (point.time / CYCLE).round() as u64;
            let last = point == points.last().unwrap();
            if last && kind == ProfileKind::Acceleration {
                continue;
            }
            let value = value_of(kind, &plan.at(scan));
            let small = if last && kind == ProfileKind::Position {
                0.0
            } else {
                1e-9
            };
            assert!(
                (value - point.value).abs() <= small,
                "{case}: {value} at {point:?}"
            );
        }
        let end = plan.at(u64::from(plan.scans()));
        let later = plan.at(u64::from(plan.scans()) + 1024);
        assert_eq!((end.acceleration, end.jerk, end.snap), (0.0, 0.0, 0.0));
        assert!(
            (later.position - end.position - end.velocity).abs() < 1e-9,
            "{case}"
        );
        assert_eq!(later.velocity, end.velocity);
        if kind == ProfileKind::Position {
            assert_eq!(end.velocity, 0.0);
        }
    }
}

/// Each derivative is the slope of the one below it, so nothing jumps: between two scans it changes by no more than
/// the next derivative allows.
#[test]
fn position_to_jerk_are_continuous() {
    let mut random = Random(2);
    for case in 0..standstill_testkit::whole_or(300, 60) {
        let (kind, start, points) = (
            KINDS[case % 3],
            random_start(&mut random),
            random_points(&mut random),
        );
        let plan = ProfilePlan::new(kind, &start, &points, &FREE, None, CYCLE / 16.0).unwrap();
        let mut before = plan.at(0);
        let snap_most = (0..=plan.scans())
            .map(|scan| plan.at(scan.into()).snap.abs())
            .fold(0.0, f64::max);
        for scan in 1..=u64::from(plan.scans()) + 100 {
            let now = plan.at(scan);
            let time = CYCLE / 16.0;
            let jump =
                |low: [f64; 2], high: [f64; 2]| ((low[1] - low[0]) / time - (high[0] + high[1]) / 2.0).abs();
            // By the trapezoidal rule, off by less than the change of the slope.
            let steps = [
                (
                    jump([before.position, now.position], [before.velocity, now.velocity]),
                    now.acceleration.abs() + before.acceleration.abs(),
                ),
                (
                    jump(
                        [before.velocity, now.velocity],
                        [before.acceleration, now.acceleration],
                    ),
                    now.jerk.abs() + before.jerk.abs(),
                ),
                (
                    jump([before.acceleration, now.acceleration], [before.jerk, now.jerk]),
                    2.0 * snap_most,
                ),
            ];
            for (order, (off, slope)) in steps.into_iter().enumerate() {
                assert!(
                    off <= (slope + snap_most * time) * time + 1e-4,
                    "{case} {scan} order {order}: {off}, {slope}"
                );
            }
            assert!(
                (now.jerk - before.jerk).abs() <= snap_most * time * 1.5 + 1e-6,
                "{case} {scan}: {before:?} {now:?}"
            );
            before = now;
        }
    }
}

#[test]
fn what_is_accepted_keeps_the_limits_and_what_is_refused_does_not() {
    let limits = Limits {
        velocity: 150.0,
        acceleration: 4e3,
        deceleration: 6e3,
        jerk: 2e5,
        snap: 2e7,
    };
    let mut random = Random(3);
    let mut accepted = [0; 2];
    let count = standstill_testkit::cases(3000) as usize;
    for case in 0..count {
        let kind = KINDS[case % 3];
        let points = random_points(&mut random);
        let start = Setpoint::at_rest(0.0);
        let range = (case % 2 == 0).then_some((-10.0, 10.0));
        let free = ProfilePlan::new(kind, &start, &points, &FREE, None, CYCLE / 8.0).unwrap();
        let mut most: f64 = 0.0;
        for scan in 0..=u64::from(free.scans()) {
            let state = free.at(scan);
            let rate = if state.velocity * state.acceleration >= 0.0 {
                limits.acceleration
            } else {
                limits.deceleration
            };
            let share = (state.velocity.abs() / limits.velocity)
                .max(state.acceleration.abs() / rate)
                .max(state.jerk.abs() / limits.jerk)
                .max(state.snap.abs() / limits.snap);
            most = most.max(share);
            if let Some((min, max)) = range {
                most = most.max(if state.position < min - 1e-6 || state.position > max + 1e-6 {
                    2.0
                } else {
                    0.0
                });
            }
        }
        // How an acceleration fades out depends on the limits.
        if kind == ProfileKind::Acceleration && points.last().unwrap().value != 0.0 {
            continue;
        }
        let plan = ProfilePlan::new(kind, &start, &points, &limits, range, CYCLE);
        accepted[usize::from(plan.is_ok())] += 1;
        match plan {
            Ok(_) => assert!(most <= 1.0 + 1e-9, "{case}: {most}"),
            Err(fault) => {
                // The snap jumps at points, and its peak may be between two scans.
                let seen = if fault.cause == ProfileCause::Snap {
                    0.9
                } else {
                    0.995
                };
                assert!(most > seen, "{case}: {most} {fault:?}");
                assert!((1..=points.len()).contains(&fault.point), "{case}: {fault:?}");
                assert!(
                    fault.value.abs() > fault.limit.abs() * 0.999 || fault.cause == ProfileCause::Position
                );
            }
        }
    }
    assert!(accepted.iter().all(|some| *some > count / 30), "{accepted:?}");
}

#[test]
fn an_acceleration_fades_out_within_jerk_and_snap() {
    let limits = Limits {
        velocity: 1000.0,
        acceleration: 1000.0,
        deceleration: 1000.0,
        jerk: 5e3,
        snap: 1e5,
    };
    let points = points(&[(1.0, 100.0)]);
    let plan = ProfilePlan::new(
        ProfileKind::Acceleration,
        &Setpoint::at_rest(0.0),
        &points,
        &limits,
        None,
        CYCLE,
    )
    .unwrap();
    // 1.5 * 100 / 5000 is 30 ms, sqrt(6 * 100 / 1e5) is 77 ms.
    assert_eq!(plan.scans(), 1024 + 80);
    let end = plan.at(u64::from(plan.scans()));
    assert!(
        (end.velocity - (50.0 + 0.5 * 100.0 * 0.0774597)).abs() < 1e-3,
        "{end:?}"
    );
    // Where nothing bounds the derivatives, the acceleration is gone at once.
    let free = Limits {
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
        ..limits
    };
    let plan = ProfilePlan::new(
        ProfileKind::Acceleration,
        &Setpoint::at_rest(0.0),
        &points,
        &free,
        None,
        CYCLE,
    )
    .unwrap();
    assert_eq!(plan.scans(), 1024);
}

/// Samples 50 ms apart of t^3 (2 - t)^3 reproduce it, except near its ends, whose jerk a profile does not have.
#[test]
fn close_points_of_a_smooth_motion_give_that_motion() {
    let place = |t: f64| t * t * t * (2.0 - t) * (2.0 - t) * (2.0 - t);
    let samples: Vec<_> = (1..=40)
        .map(|index| (0.05, place(0.05 * f64::from(index))))
        .collect();
    let points = points(&samples);
    let start = Setpoint::at_rest(0.0);
    let plan = ProfilePlan::new(ProfileKind::Position, &start, &points, &FREE, None, CYCLE).unwrap();
    for scan in 300..1700_u32 {
        let t = f64::from(scan) * CYCLE;
        let state = plan.at(scan.into());
        let velocity = 6.0 * t * t * (2.0 - t) * (2.0 - t) * (1.0 - t);
        let acceleration = 6.0 * t * (2.0 - t) * (5.0 * t * t - 10.0 * t + 4.0);
        assert!((state.position - place(t)).abs() < 1e-6, "{scan}: {state:?}");
        assert!((state.velocity - velocity).abs() < 1e-3, "{scan}: {state:?}");
        assert!(
            (state.acceleration - acceleration).abs() < 0.02,
            "{scan}: {state:?}, {acceleration}"
        );
    }
}

#[test]
fn between_two_level_points_of_one_value_nothing_moves() {
    for kind in KINDS {
        let mut points = points(&[(0.5, 10.0), (1.0, 10.0), (0.5, 3.0)]);
        points[0].level = true;
        points[1].level = true;
        let plan = ProfilePlan::new(kind, &Setpoint::at_rest(0.0), &points, &FREE, None, CYCLE).unwrap();
        for scan in 512..=1536 {
            let value = value_of(kind, &plan.at(scan));
            assert!((value - 10.0).abs() < 1e-9, "{kind:?} {scan}: {value}");
        }
    }
}

#[test]
fn the_way_moved_is_that_between_the_turns() {
    let level = |time, value| ProfilePoint {
        time,
        value,
        level: true,
    };
    let points = [level(1.0, 10.0), level(2.0, -5.0), level(3.0, 0.0)];
    let plan = ProfilePlan::new(
        ProfileKind::Position,
        &Setpoint::at_rest(0.0),
        &points,
        &FREE,
        None,
        CYCLE,
    )
    .unwrap();
    let standard = standstill_planner::StandardPlan::Profile(plan);
    let planner = standstill_planner::Standard::new(CYCLE);
    let near =
        |ways: (f64, f64), up: f64, down: f64| (ways.0 - up).abs() < 1e-9 && (ways.1 - down).abs() < 1e-9;
    let ways = |scan| standstill_planner::Planner::ways(&planner, (&standard, scan));
    assert!(near(ways(0), 15.0, 15.0), "{:?}", ways(0));
    assert!(near(ways(1024), 5.0, 15.0), "{:?}", ways(1024));
    assert!(near(ways(1536), 5.0, 7.5), "{:?}", ways(1536));
    assert!(near(ways(3072), 0.0, 0.0));
}

#[test]
fn a_bad_table_is_refused_with_the_point_that_is_bad() {
    let at_rest = Setpoint::at_rest(5.0);
    let refused = |points: &[ProfilePoint]| {
        let plan = ProfilePlan::new(ProfileKind::Position, &at_rest, points, &FREE, None, 0.001);
        let fault = plan.unwrap_err();
        (fault.cause, fault.point)
    };
    assert_eq!(refused(&[]), (ProfileCause::Count, 0));
    let long: Vec<_> = (0..=PROFILE_POINTS).map(|_| (0.1, 5.0)).collect();
    assert_eq!(refused(&points(&long)), (ProfileCause::Count, 0));
    assert_eq!(refused(&points(&[(0.0, 5.0)])), (ProfileCause::Count, 0));
    assert_eq!(
        refused(&points(&[(0.0, 6.0), (1.0, 7.0)])),
        (ProfileCause::Start, 1)
    );
    assert_eq!(
        refused(&points(&[(1.0, 6.0), (0.0, 7.0)])),
        (ProfileCause::Time, 2)
    );
    assert_eq!(
        refused(&points(&[(1.0, 6.0), (-0.5, 7.0)])),
        (ProfileCause::Time, 2)
    );
    assert_eq!(refused(&points(&[(f64::NAN, 6.0)])), (ProfileCause::Time, 1));
    assert_eq!(
        refused(&points(&[(1.0, 6.0), (1.0, f64::INFINITY)])),
        (ProfileCause::Value, 2)
    );
    assert_eq!(refused(&points(&[(1e9, 6.0)])), (ProfileCause::TooLong, 1));
}
