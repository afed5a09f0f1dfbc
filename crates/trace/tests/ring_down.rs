//! The fit finds a vibration with its frequency and its damping. Without a vibration the result says so.

use standstill_testkit::{Random, whole_or};
use standstill_trace::ring_down::{NoRingDown, RingDown, identify};
use std::f64::consts::PI;

/// `swing * exp(-damping w t) cos(damped w t + 1)` and noise, from the formula.
fn made(count: usize, step: f64, frequency: f64, damping: f64, swing: f64) -> Vec<f64> {
    let natural = 2.0 * PI * frequency;
    let damped = natural * (1.0 - damping * damping).sqrt();
    let value = |time: f64| swing * libm::exp(-damping * natural * time) * libm::cos(damped * time + 1.0);
    (0..count).map(|place| value(place as f64 * step)).collect()
}

fn is_near(found: f64, made: f64, within: f64) -> bool {
    (found - made).abs() <= within
}

#[test]
fn frequency_and_damping_are_those_it_was_made_with() {
    let mut random = Random(1);
    for case in 0..whole_or(20, 4) {
        let step = random.log(1e-4, 1e-2);
        let count = 200 + random.below(6000) as usize;
        let periods = random.log(4.0, 0.2 * count as f64);
        let frequency = periods / (count as f64 * step);
        let damping = random.between(0.0, 0.5 / periods) + random.below(2) as f64 * random.between(0.0, 0.1);
        let swing = random.log(1e-9, 1e3);
        let samples = made(count, step, frequency, damping, swing);
        let found = identify(&samples, step).unwrap_or_else(|why| panic!("{case}: {why}"));
        let about = format!("case {case}: {frequency} Hz, {damping}, {count} samples: {found:?}");
        assert!(is_near(found.frequency, frequency, 1e-4 * frequency), "{about}");
        assert!(is_near(found.damping, damping, 1e-4), "{about}");
        assert!(is_near(found.swing, swing, 1e-3 * swing), "{about}");
        assert!(found.explained > 0.999, "{about}");
    }
}

#[test]
fn a_swing_that_is_over_soon_is_found_in_a_window_of_any_length() {
    let mut random = Random(4);
    for case in 0..whole_or(60, 8) {
        let damping = random.between(0.1, 0.44);
        let samples_each = random.log(6.0, 60.0);
        let periods = random.log(3.0, 300.0);
        let step = 1e-3;
        let frequency = 1.0 / (samples_each * step);
        let count = ((samples_each * periods) as usize).max(32);
        let found = identify(&made(count, step, frequency, damping, 1.0), step);
        let about = format!("case {case}: {frequency} Hz, {damping}, {count} samples: {found:?}");
        let found = found.unwrap_or_else(|_| panic!("{about}"));
        assert!(is_near(found.frequency, frequency, 1e-3 * frequency), "{about}");
        assert!(is_near(found.damping, damping, 1e-3), "{about}");
    }
}

#[test]
fn a_swing_that_decays_too_fast_is_not_taken_for_another() {
    for damping in [0.46, 0.5, 0.6] {
        let found = identify(&made(200, 2e-3, 10.0, damping, 1.0), 2e-3);
        assert!(
            matches!(found, Err(NoRingDown::Bound(at)) if is_near(at, 0.4472, 1e-4)),
            "{damping}: {found:?}"
        );
    }
    let found = identify(&made(1000, 1e-3, 10.0, -0.11, 1.0), 1e-3);
    assert!(
        matches!(found, Err(NoRingDown::Bound(at)) if is_near(at, -0.0995, 1e-4)),
        "{found:?}"
    );
}

#[test]
fn what_is_said_of_the_error_holds_in_noise() {
    let mut random = Random(2);
    let (mut frequencies, mut dampings) = (0, 0);
    let count = whole_or(40, 10);
    for _ in 0..count {
        let (frequency, damping) = (random.log(3.0, 60.0), random.between(0.0, 0.03));
        let mut samples = made(1000, 1e-3, frequency, damping, 1.0);
        for value in &mut samples {
            let noise: f64 = (0..12).map(|_| random.unit() - 0.5).sum();
            *value += 5.0 + 0.1 * noise;
        }
        let found = identify(&samples, 1e-3).unwrap();
        frequencies += u32::from(is_near(found.frequency, frequency, found.frequency_within));
        dampings += u32::from(is_near(found.damping, damping, found.damping_within));
        assert!(
            found.frequency_within < 0.01 * frequency.max(10.0),
            "{frequency}: {found:?}"
        );
    }
    // 95 % of 40 are 38; fewer than 34 occur once in a hundred.
    assert!(
        20 * frequencies.min(dampings) >= 17 * count,
        "{frequencies} and {dampings} of {count}"
    );
}

#[test]
fn a_drift_and_a_level_do_not_matter() {
    let mut samples = made(800, 1e-3, 12.0, 0.01, 1.0);
    for (place, value) in samples.iter_mut().enumerate() {
        *value += 1e4 + 0.02 * place as f64;
    }
    let found = identify(&samples, 1e-3).unwrap();
    assert!(
        is_near(found.frequency, 12.0, 1e-3) && is_near(found.damping, 0.01, 1e-4),
        "{found:?}"
    );
}

#[test]
fn a_fast_swing_that_is_over_soon_is_found_in_a_long_window() {
    let mut samples = made(100_000, 1e-3, 80.0, 0.02, 1.0);
    let drift = made(100_000, 1e-3, 0.003, 0.0, 0.05);
    samples
        .iter_mut()
        .zip(drift)
        .for_each(|(value, drift)| *value += drift);
    let found = identify(&samples, 1e-3).unwrap();
    assert!(
        is_near(found.frequency, 80.0, 0.01) && is_near(found.damping, 0.02, 1e-3),
        "{found:?}"
    );
}

#[test]
fn one_that_grows_has_a_negative_damping() {
    let found = identify(&made(1000, 1e-3, 10.0, -0.004, 1.0), 1e-3).unwrap();
    assert!(
        is_near(found.frequency, 10.0, 1e-4) && is_near(found.damping, -0.004, 1e-5),
        "{found:?}"
    );
}

#[test]
fn where_there_is_none_it_is_said() {
    let find = |samples: &[f64]| identify(samples, 1e-3);
    assert_eq!(find(&[1.0, 2.0]), Err(NoRingDown::Short(2)));
    assert_eq!(find(&[]), Err(NoRingDown::Short(0)));
    for same in [0.0, 5.0, -1e30, f64::MAX, 5e-324] {
        assert_eq!(find(&[same; 100]), Err(NoRingDown::Still), "{same}");
    }
    let mut broken = made(100, 1e-3, 50.0, 0.0, 1.0);
    broken[7] = f64::NAN;
    assert_eq!(find(&broken), Err(NoRingDown::Broken(7)));
    let settles: Vec<f64> = (0..1000)
        .map(|place| libm::exp(-0.01 * f64::from(place)))
        .collect();
    assert!(find(&settles).is_err(), "{:?}", find(&settles));
    let mut random = Random(3);
    let noise: Vec<f64> = (0..1000).map(|_| random.unit()).collect();
    assert!(
        matches!(find(&noise), Err(NoRingDown::Unexplained(_))),
        "{:?}",
        find(&noise)
    );
    let slow = made(1000, 1e-3, 1.6, 0.0, 1.0);
    assert!(
        matches!(find(&slow), Err(NoRingDown::Slow(_))),
        "{:?}",
        find(&slow)
    );
}

#[test]
fn sizes_that_are_nearly_none_or_nearly_all_do_not_break_it() {
    for swing in [1e-300, 1e-30, 1e30, 1e300] {
        let RingDown { frequency, .. } = identify(&made(600, 1e-3, 20.0, 0.01, swing), 1e-3).unwrap();
        assert!(is_near(frequency, 20.0, 0.01), "{swing}: {frequency}");
    }
}
