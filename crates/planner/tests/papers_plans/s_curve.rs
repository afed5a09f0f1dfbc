//! Rest to rest: limits, landing, least time, symmetry, scaling, and the second view.

use super::support::{
    Random, bounds, case, case_bounds, cube_root, integrated, keeps_its_word, number, numbers, random_bounds,
    rounds,
};
use crate::ramp_plans::support::scaled_limits;
use standstill_planner::papers::{SCurve, SCurveCase, Stepper};
use standstill_planner::{Field, Limits, PlanError};
use std::collections::BTreeSet;

fn plan(start: f64, target: f64, limits: &Limits) -> SCurve {
    SCurve::new(start, target, limits).expect("a plan")
}

#[test]
fn every_case_lands_and_keeps_its_limits() {
    let mut random = Random(0x5C01);
    let mut seen = BTreeSet::new();
    for _ in 0..rounds(4000) {
        let limits = random_bounds(&mut random);
        let start = random.sign() * random.log(1e-3, 1e3);
        let way = random.sign() * limits.velocity * random.log(1e-6, 1e3);
        let curve = plan(start, start + way, &limits);
        let what = format!("{start} {way} {limits:?}");
        keeps_its_word(curve.profile(), [start, 0.0, 0.0], &limits, &what);
        seen.insert(curve.case().name());
        // One of the bounds is active, or the move would be faster.
        let peaks = curve.profile().peaks();
        assert!((peaks.jerk - limits.jerk).abs() <= 1e-12 * limits.jerk, "{what}");
    }
    assert_eq!(seen, BTreeSet::from(["A", "B", "C1", "C2", "D1", "D2"]));
}

/// The bound (P5) of any symmetric profile, at the best shape found by a scan over both shares.
#[test]
fn no_other_shape_is_faster() {
    let mut random = Random(0x5C02);
    for _ in 0..60 {
        let limits = random_bounds(&mut random);
        let s = limits.velocity * random.log(1e-4, 1e2);
        let duration = plan(0.0, s, &limits).profile().duration();
        for g in 1..=50 {
            for f in 1..=50 {
                let (gamma, phi) = (f64::from(g) / 100.0, f64::from(f) / 100.0);
                let a = gamma * (1.0 - gamma) * (1.0 - phi);
                let needed = (s / ((1.0 - gamma) * limits.velocity))
                    .max((s / (a * limits.acceleration)).sqrt())
                    .max(cube_root(s / (a * gamma * phi * limits.jerk)));
                assert!(duration <= needed * (1.0 + 1e-12));
            }
        }
    }
}

#[test]
fn times_are_continuous_across_every_border() {
    let mut random = Random(0x5C03);
    for _ in 0..500 {
        let limits = random_bounds(&mut random);
        let (v, a, j) = (limits.velocity, limits.acceleration, limits.jerk);
        let s_a = 2.0 * a * a * a / (j * j);
        let s_v = if v * j < a * a {
            2.0 * v * (v / j).sqrt()
        } else {
            v * (v / a + a / j)
        };
        for s in [s_a, s_v] {
            let around = [1.0 - 1e-12, 1.0, 1.0 + 1e-12].map(|x| plan(0.0, s * x, &limits));
            let [below, at, above] = around.map(|curve| curve.profile().duration());
            assert!(
                (below - at).abs() + (above - at).abs() <= 1e-10 * at,
                "{limits:?} {s}"
            );
        }
        let at_v_a = |x: f64| plan(0.0, s_a, &bounds(a * a / j * x, a, j)).profile().duration();
        assert!((at_v_a(1.0 - 1e-12) - at_v_a(1.0 + 1e-12)).abs() <= 1e-10 * at_v_a(1.0));
    }
}

#[test]
fn mirrored_and_scaled_moves_are_mirrored_and_scaled() {
    let mut random = Random(0x5C04);
    for _ in 0..300 {
        let limits = random_bounds(&mut random);
        let s = limits.velocity * random.log(1e-3, 1e2);
        let one = *plan(0.0, s, &limits).profile();
        let other = *plan(0.0, -s, &limits).profile();
        let time = random.unit() * one.duration();
        assert_eq!(one.at(time).position, -other.at(time).position);
        assert_eq!(one.at(time).velocity, -other.at(time).velocity);
        assert_eq!(one.duration(), other.duration());
        let k = 1e6;
        let long = plan(0.0, s * k, &limits.times(k)).profile().duration();
        assert!((long - one.duration()).abs() <= 1e-13 * long);
        let slower = scaled_limits(&limits, (1.0, k));
        let slow = plan(0.0, s, &slower).profile().duration();
        assert!((slow / k - one.duration()).abs() <= 1e-13 * one.duration());
    }
}

#[test]
fn more_room_is_never_slower_and_a_longer_way_never_faster() {
    let mut random = Random(0x5C05);
    for _ in 0..1000 {
        let limits = random_bounds(&mut random);
        let s = limits.velocity * random.log(1e-4, 1e2);
        let time = |s: f64, limits: &Limits| plan(0.0, s, limits).profile().duration();
        let base = time(s, &limits);
        let more = 1.0 + random.unit();
        let slack = 1.0 - 1e-12;
        assert!(time(s * more, &limits) >= base * slack);
        let wider = bounds(limits.velocity * more, limits.acceleration, limits.jerk);
        assert!(time(s, &wider) * slack <= base);
        let wider = bounds(limits.velocity, limits.acceleration * more, limits.jerk);
        assert!(time(s, &wider) * slack <= base);
        let wider = bounds(limits.velocity, limits.acceleration, limits.jerk * more);
        assert!(time(s, &wider) * slack <= base);
    }
}

#[test]
fn extreme_lengths_land_and_no_length_takes_no_time() {
    let limits = bounds(0.25, 3e-3, 1e-4);
    for s in [1e-12, 1e-9, 1e9] {
        let curve = plan(0.0, s, &limits);
        keeps_its_word(curve.profile(), [0.0; 3], &limits, "extreme");
    }
    let nothing = plan(3.0, 3.0, &limits);
    assert_eq!(nothing.profile().duration(), 0.0);
    assert_eq!(nothing.profile().scans(0.001), Some(0));
    assert_eq!(nothing.profile().segments().count(), 0);
    assert_eq!(nothing.profile().at(1.0).position, 3.0);
}

/// The stepping of the paper, split at each switch, is the closed form, whatever the steps are.
#[test]
fn stepping_is_the_same_move() {
    let mut random = Random(0x5C06);
    for _ in 0..200 {
        let limits = random_bounds(&mut random);
        let s = random.sign() * limits.velocity * random.log(1e-3, 10.0);
        let curve = plan(1.0, 1.0 + s, &limits);
        let profile = curve.profile();
        let mut stepper = Stepper::new(profile);
        let mut time = 0.0;
        while time < profile.duration() {
            let dt = profile.duration() * 0.3 * random.unit();
            time += dt;
            let (stepped, direct) = (stepper.step(dt), profile.at(time));
            let off = (stepped.position - direct.position).abs();
            assert!(off <= 1e-12 * (1.0 + s.abs()), "{off}");
            let off = (stepped.velocity - direct.velocity).abs();
            assert!(off <= 1e-12 * limits.velocity, "{off}");
        }
        assert_eq!(stepper.step(0.0).position, 1.0 + s);
    }
}

/// The paper steps with the jerk of the instant and never splits a step. With a switch off the grid, this ends
/// beside the target and not at rest. The paper took that for rounding of its 32-bit numbers.
#[test]
fn stepping_without_splits_misses_the_target_as_the_paper_did() {
    let case = case("blejan-5-D2");
    let curve = plan(0.0, 50.0, &case_bounds(&case));
    let profile = curve.profile();
    let jerk_at = |time: f64| profile.at(time + 1e-9).jerk;
    let steps = (0..=337).map(|k| {
        let now = f64::from(k);
        (
            1.0,
            if now < profile.duration() {
                jerk_at(now)
            } else {
                0.0
            },
        )
    });
    let [p, v, _] = integrated([0.0; 3], steps.take(337));
    assert!((p - 50.381).abs() < 5e-4 && (v - 0.002).abs() < 5e-5, "{p} {v}");
    let mut stepper = Stepper::new(profile);
    let last = (0..337).map(|_| stepper.step(1.0)).last().expect("steps");
    assert_eq!((last.position, last.velocity), (50.0, 0.0));
}

/// The vectors the paper fed to its simulation, in exact arithmetic.
#[test]
fn the_printed_jerk_vectors_end_where_exact_arithmetic_says() {
    for id in ["blejan-5-D1", "blejan-5-D2", "blejan-5-A-boundary", "blejan-5-C2"] {
        let case = case(id);
        let jerk = number(&case["input"]["J"]);
        let lengths = numbers(&case["published"]["jerk_vector_segment_ms"]);
        let signs = [1.0, 0.0, -1.0, 0.0, -1.0, 0.0, 1.0].map(|sign| sign * jerk);
        let [p, v, a] = integrated([0.0; 3], lengths.into_iter().zip(signs));
        let expected = number(&case["expected"]["jerk_vector_final_position"]);
        assert!(
            (p - expected).abs() < 1e-9 && v.abs() < 1e-12 && a.abs() < 1e-15,
            "{id}: {p}"
        );
        let printed = number(&case["published"]["final_position"]);
        let reproduced = (p - printed).abs() <= number(&case["tolerance"]["published_abs"]);
        assert_eq!(case["published"]["reproduced"], reproduced, "{id}");
    }
}

#[test]
fn what_cannot_be_planned_is_refused() {
    let good = bounds(1.0, 2.0, 3.0);
    let refused = |start: f64, target: f64, limits: Limits| SCurve::new(start, target, &limits).unwrap_err();
    let field = |error: PlanError| match error {
        PlanError::InvalidInput { field, .. } => field,
        other => panic!("{other:?}"),
    };
    for bad in [f64::NAN, 0.0, -1.0, f64::INFINITY] {
        for (limits, named) in [
            (bounds(bad, 2.0, 3.0), Field::LimitVelocity),
            (bounds(1.0, bad, 3.0), Field::LimitAcceleration),
            (bounds(1.0, 2.0, bad), Field::LimitJerk),
        ] {
            assert_eq!(field(refused(0.0, 1.0, limits)), named);
        }
    }
    assert_eq!(
        field(refused(0.0, 1.0, Limits { snap: 9.0, ..good })),
        Field::LimitSnap
    );
    assert_eq!(field(refused(f64::NAN, 1.0, good)), Field::Position);
    assert_eq!(field(refused(0.0, f64::NAN, good)), Field::Target);
    assert_eq!(field(refused(-1e308, 1.7e308, good)), Field::Target);
    // More scans than can be counted, whatever the cycle.
    let too_long = PlanError::TooLong {
        field: Field::Target,
        value: 1e308,
    };
    assert_eq!(refused(0.0, 1e308, bounds(1e-300, 1e-300, 1e-300)), too_long);
    let short = plan(0.0, 1e-3, &bounds(2.0, 2.0, 3.0));
    assert_eq!(short.case(), SCurveCase::B);
}
