//! Moves in a given time: limits, landing, the least duration, and the relation to the least-time
//! profile.

use super::support::{Random, bounds, keeps_its_word, random_bounds, rounds};
use standstill_planner::papers::{SCurve, Timed, Trapezoid};
use standstill_planner::{Field, Limits, Order, PlanError};

#[test]
fn timed_moves_land_in_their_time() {
    let mut random = Random(0x71ED);
    for _ in 0..rounds(2000) {
        let (gamma, phi) = (0.5 * (1.0 - random.unit()), 0.5 * (1.0 - random.unit()));
        let duration = random.log(1e-3, 1e3);
        let start = random.sign() * random.log(1e-3, 1e3);
        let target = start + random.sign() * random.log(1e-6, 1e3);
        let plan = Timed::new(start, target, duration, gamma, phi, &Limits::NONE).expect("a plan");
        let profile = plan.profile();
        assert!((profile.duration() - duration).abs() <= 1e-14 * duration);
        let peaks = profile.peaks();
        let limits = bounds(peaks.velocity, peaks.acceleration, peaks.jerk);
        keeps_its_word(profile, [start, 0.0, 0.0], &limits, &format!("{gamma} {phi}"));
        let way = (target - start).abs();
        let v = way / ((1.0 - gamma) * duration);
        assert!((peaks.velocity - v).abs() <= 1e-12 * v);
        let a = v / (gamma * (1.0 - phi) * duration);
        assert!(
            (peaks.acceleration - a).abs() <= 1e-12 * a,
            "{gamma} {phi} {start} {target} {duration}: {} {a}",
            peaks.acceleration
        );
        let j = a / (phi * gamma * duration);
        assert!((peaks.jerk - j).abs() <= 1e-12 * j);
    }
}

/// The least duration is accepted and uses one of the limits to the full; a shorter one is refused with it.
#[test]
fn a_duration_below_the_least_is_refused_with_the_least() {
    let mut random = Random(0x71EE);
    for _ in 0..rounds(1000) {
        let limits = random_bounds(&mut random);
        let (gamma, phi) = (0.5 * (1.0 - random.unit()), 0.5 * (1.0 - random.unit()));
        let way = random.sign() * limits.velocity * random.log(1e-4, 1e2);
        let plan = |duration: f64| Timed::new(0.0, way, duration, gamma, phi, &limits);
        let Err(PlanError::OutOfRange { field, nearest, .. }) = plan(1e-9) else {
            panic!("{limits:?} {way} in 1e-9 s");
        };
        assert_eq!(field, Field::Duration);
        let least = plan(nearest).expect("the least duration");
        keeps_its_word(least.profile(), [0.0; 3], &limits, "the least duration");
        let peaks = least.profile().peaks();
        let used = (peaks.velocity / limits.velocity)
            .max(peaks.acceleration / limits.acceleration)
            .max(peaks.jerk / limits.jerk);
        assert!((used - 1.0).abs() <= 1e-11, "{used}");
        assert!(plan(nearest * (1.0 - 1e-11)).is_err());
        assert!(plan(nearest * 1.5).is_ok());
    }
}

/// The least-time profile is a timed one with the shares of its times; stretched, it keeps its shape.
#[test]
fn the_least_time_profile_is_a_timed_one() {
    let mut random = Random(0x71EF);
    for _ in 0..500 {
        let limits = random_bounds(&mut random);
        let way = random.sign() * limits.velocity * random.log(1e-3, 1e2);
        let fastest = SCurve::new(0.0, way, &limits).expect("a plan");
        let times = fastest.times();
        let duration = times.jerk + times.acceleration + times.velocity;
        let gamma = ((times.jerk + times.acceleration) / duration).min(0.5);
        let phi = (times.jerk / (times.jerk + times.acceleration)).min(0.5);
        let timed = Timed::new(0.0, way, duration, gamma, phi, &limits).expect("the same plan");
        for k in 0..=20 {
            let time = duration * f64::from(k) / 20.0;
            let (a, b) = (timed.profile().at(time), fastest.profile().at(time));
            assert!((a.position - b.position).abs() <= 1e-12 * way.abs());
        }
        let slower = Timed::new(0.0, way, 2.0 * duration, gamma, phi, &limits).expect("a plan");
        let (fast, slow) = (timed.profile().peaks(), slower.profile().peaks());
        assert!((slow.velocity * 2.0 / fast.velocity - 1.0).abs() < 1e-12);
        assert!((slow.acceleration * 4.0 / fast.acceleration - 1.0).abs() < 1e-12);
        assert!((slow.jerk * 8.0 / fast.jerk - 1.0).abs() < 1e-12);
    }
}

#[test]
fn shares_and_durations_out_of_range_are_refused() {
    let plan = |duration, gamma, phi| Timed::new(0.0, 1.0, duration, gamma, phi, &Limits::NONE).unwrap_err();
    let above = |field, value| PlanError::OutOfRange {
        field,
        value,
        nearest: 0.5,
    };
    let invalid = |field, value| PlanError::InvalidInput { field, value };
    assert_eq!(plan(1.0, 0.6, 0.3), above(Field::Gamma, 0.6));
    assert_eq!(plan(1.0, 0.3, 0.6), above(Field::Phi, 0.6));
    assert_eq!(plan(1.0, 0.0, 0.3), invalid(Field::Gamma, 0.0));
    assert_eq!(plan(1.0, 0.3, -0.1), invalid(Field::Phi, -0.1));
    assert!(matches!(
        plan(1.0, f64::NAN, 0.3),
        PlanError::InvalidInput {
            field: Field::Gamma,
            ..
        }
    ));
    assert_eq!(plan(0.0, 0.3, 0.3), invalid(Field::Duration, 0.0));
    assert_eq!(plan(-1.0, 0.3, 0.3), invalid(Field::Duration, -1.0));
    assert_eq!(
        plan(f64::INFINITY, 0.3, 0.3),
        invalid(Field::Duration, f64::INFINITY)
    );
    assert!(Timed::new(0.0, 1.0, 1.0, 0.5, 0.5, &Limits::NONE).is_ok());
    let snap = Limits {
        snap: 1.0,
        ..Limits::NONE
    };
    let refused = Timed::new(0.0, 1.0, 1.0, 0.5, 0.5, &snap).unwrap_err();
    assert_eq!(refused, invalid(Field::LimitSnap, 1.0));
}

fn trapezoid(velocity: f64, acceleration: f64, deceleration: f64) -> Limits {
    Limits {
        velocity,
        acceleration,
        deceleration,
        ..Limits::NONE
    }
}

/// Where constant accelerations lead, with the bounds checked along the path.
fn judge(plan: &Trapezoid, start: f64, limits: &Limits) {
    let profile = plan.profile();
    assert_eq!(profile.order(), Order::Two);
    let (mut p, mut v, mut time) = (start, 0.0_f64, 0.0);
    for segment in profile.segments() {
        let (t, a) = (segment.duration, segment.acceleration);
        assert!((segment.velocity - v).abs() <= 1e-12 * limits.velocity);
        let end = v + a * t;
        let bound = if a * (v + end) > 0.0 {
            limits.acceleration
        } else {
            limits.deceleration
        };
        assert!(a.abs() <= bound * (1.0 + 1e-11));
        assert!(end.abs() <= limits.velocity * (1.0 + 1e-12));
        p += 0.5 * (v + end) * t;
        v = end;
        time += t;
    }
    let length = start.abs() + profile.end().position.abs() + limits.velocity * time;
    assert!((p - profile.end().position).abs() <= 1e-13 * length);
    assert!(v.abs() <= 1e-12 * limits.velocity);
    assert!((time - profile.duration()).abs() <= 1e-14 * time);
}

#[test]
fn trapezoids_land_within_their_limits() {
    let mut random = Random(0x71F0);
    for _ in 0..2000 {
        let velocity = random.log(0.01, 100.0);
        let limits = trapezoid(
            velocity,
            velocity * random.log(0.1, 100.0),
            velocity * random.log(0.1, 100.0),
        );
        let start = random.sign() * random.log(1e-3, 1e3);
        let target = start + random.sign() * velocity * random.log(1e-4, 1e2);
        let plan = Trapezoid::new(start, target, &limits).expect("a plan");
        judge(&plan, start, &limits);
        // The velocity bound or both accelerations are used to the full.
        let peaks = plan.profile().peaks();
        let larger = limits.acceleration.max(limits.deceleration);
        assert!((peaks.acceleration - larger).abs() <= 1e-12 * larger);
        assert!(peaks.jerk.is_infinite() && peaks.snap.is_infinite());
    }
}

/// With a duration: kept, or refused with a value that is accepted in its place.
#[test]
fn a_timed_trapezoid_keeps_its_plateau_or_says_what_would_do() {
    let mut random = Random(0x71F1);
    let mut kinds = [0; 3];
    for _ in 0..rounds(3000) {
        let mut limits = trapezoid(random.log(0.1, 10.0), f64::INFINITY, f64::INFINITY);
        if random.unit() < 0.7 {
            limits.acceleration = limits.velocity * random.log(0.1, 10.0);
            limits.deceleration = limits.acceleration;
        }
        let way = limits.velocity * random.log(0.1, 10.0);
        let mut duration = way / limits.velocity * random.log(0.8, 4.0);
        let mut outcome = Trapezoid::timed(0.0, way, duration, &limits);
        kinds[0] += u32::from(outcome.is_ok());
        // The nearest velocity may still need a longer time than given, but no more than that.
        for _ in 0..2 {
            match outcome {
                Err(PlanError::OutOfRange {
                    field: Field::Duration,
                    nearest,
                    ..
                }) => {
                    kinds[1] += 1;
                    assert!(nearest > duration);
                    duration = nearest;
                }
                Err(PlanError::OutOfRange {
                    field: Field::LimitVelocity,
                    nearest,
                    ..
                }) => {
                    kinds[2] += 1;
                    assert!(nearest < limits.velocity);
                    limits.velocity = nearest;
                }
                _ => break,
            }
            outcome = Trapezoid::timed(0.0, way, duration, &limits);
        }
        match outcome {
            Ok(plan) => {
                judge(&plan, 0.0, &limits);
                assert!((plan.profile().duration() - duration).abs() <= 1e-12 * duration);
                let peak = plan.profile().peaks().velocity;
                assert!((peak - limits.velocity).abs() <= 1e-11 * limits.velocity);
            }
            Err(PlanError::InvalidInput {
                field: Field::Duration,
                ..
            }) => {
                assert!(limits.acceleration.is_infinite() && duration <= way / limits.velocity);
            }
            Err(other) => panic!("{other:?}: {limits:?} {way} {duration}"),
        }
    }
    assert!(kinds.iter().all(|count| *count > 100), "{kinds:?}");
}

#[test]
fn a_trapezoid_has_no_jerk_bound() {
    let limits = bounds(1.0, 1.0, 1.0);
    assert_eq!(
        Trapezoid::new(0.0, 1.0, &limits).unwrap_err(),
        PlanError::InvalidInput {
            field: Field::LimitJerk,
            value: 1.0
        }
    );
    let missing = Trapezoid::new(0.0, 1.0, &trapezoid(1.0, f64::INFINITY, 1.0)).unwrap_err();
    assert!(matches!(
        missing,
        PlanError::InvalidInput {
            field: Field::LimitAcceleration,
            ..
        }
    ));
}
