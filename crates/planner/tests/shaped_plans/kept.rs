//! What a shaped plan keeps: its limits, its target to the bit, the grid, a mirror image, a constant velocity.

use super::{Shaped, limits, mode};
use crate::grid_support::{Random, power, servo};
use standstill_planner::shaper::{DAMPING_MAX, LONGEST_PERIOD, SHORTEST_PERIOD};
use standstill_planner::{Field, Limits, PlanError, Setpoint, Shaper, ShaperKind, Shapers, VibrationMode};

/// One or two modes whose periods are at most `longest` scans.
fn shapers(random: &mut Random, cycle: f64, longest: f64) -> Shapers {
    let mut draw = || {
        let period = random.log(SHORTEST_PERIOD, longest);
        let damping = if random.below(3) == 0 {
            0.0
        } else {
            random.log(1e-3, 0.3)
        };
        let slower = (1.0 - damping * damping).sqrt();
        let shaper = ShaperKind::ALL[random.below(4) as usize];
        mode(1.0 / (period * cycle * slower), damping, shaper)
    };
    let modes = [draw(), draw()];
    let both = random.below(2) == 0;
    Shapers::new(&[modes[0], modes[1].filter(|_| both)], cycle).expect("shapers")
}

/// The largest magnitudes of the derivatives, and of the differences of positions of each order by the cycle.
fn largest(scans: u32, cycle: f64, at: impl Fn(u64) -> Setpoint) -> ([f64; 4], [f64; 4]) {
    let mut peaks = [0.0_f64; 4];
    let mut steps = [0.0_f64; 4];
    let mut last = [at(0).position, 0.0, 0.0, 0.0];
    for scan in 1..=u64::from(scans) + 4 {
        let here = at(scan);
        let now = [here.velocity, here.acceleration, here.jerk, here.snap];
        for (peak, value) in peaks.iter_mut().zip(now) {
            *peak = peak.max(value.abs());
        }
        let mut value = here.position;
        for (step, last) in steps.iter_mut().zip(&mut last) {
            let difference = (value - *last) / cycle;
            *last = value;
            *step = step.max(difference.abs());
            value = difference;
        }
    }
    (peaks, steps)
}

/// Covers: VB1, VB4
#[test]
fn limits_hold_the_target_is_exact_and_a_way_out_is_the_way_back_mirrored() {
    let mut random = Random(2404);
    for case in 0..standstill_testkit::cases(400) {
        let one = servo(&mut random);
        let plan = one.plan(standstill_planner::Method::Overlapped).expect("a plan");
        if plan.scans() > 4000 {
            continue;
        }
        let shapers = shapers(&mut random, one.cycle, 200.0);
        let at = |scan| shapers.at(scan, |scan| plan.at(scan));
        let scans = shapers.scans(plan.scans());
        assert_eq!(scans, plan.scans() + shapers.delay(), "case {case}");
        let before = at(u64::from(scans) - 1);
        assert!(
            !before.is_at_rest() || before.position != one.target || plan.scans() < 9,
            "case {case}"
        );
        for later in 0..3 {
            let there = at(u64::from(scans) + later);
            assert_eq!(
                (there.position, there.is_at_rest()),
                (one.target, true),
                "case {case}"
            );
        }
        let (peaks, steps) = largest(scans, one.cycle, at);
        let Limits {
            velocity,
            acceleration,
            jerk,
            snap,
            ..
        } = one.limits;
        let size = one.start.abs().max(one.target.abs());
        let bounds = [velocity, acceleration, jerk, snap];
        for (degree, ((peak, step), bound)) in (1..).zip(peaks.into_iter().zip(steps).zip(bounds)) {
            assert!(
                peak <= bound * (1.0 + 1e-9),
                "case {case}: {peak} is above {bound}"
            );
            // The resolution of positions.
            let resolved = 16.0 * 4.0 * size * f64::EPSILON / power(one.cycle, degree);
            assert!(
                step <= bound * (1.0 + 1e-9) + resolved,
                "case {case}: {step} is above {bound}"
            );
        }
        // Never back, never beyond.
        let mut last = one.start;
        for scan in 0..=u64::from(scans) {
            let here = at(scan).position;
            let forward = one.target > one.start;
            let slack = 4.0 * size * f64::EPSILON;
            let ahead = if forward { here - last } else { last - here };
            let left = if forward {
                one.target - here
            } else {
                here - one.target
            };
            assert!(
                ahead >= -slack && left >= 0.0,
                "case {case}, scan {scan}: {ahead} {left}"
            );
            last = here;
        }
    }
}

#[test]
fn a_mirror_image_has_the_mirrored_bits() {
    let mut random = Random(2405);
    for _ in 0..standstill_testkit::cases(100) {
        let cycle = 1e-3;
        let limits = limits(2 + random.below(3) as u32, 1.0, random.log(1.0, 20.0), 0.02);
        let shapers = shapers(&mut random, cycle, 300.0);
        let way = random.log(1e-3, 1.0);
        let (out, back) = (
            Shaped::new(way, &limits, shapers, cycle),
            Shaped::new(-way, &limits, shapers, cycle),
        );
        for scan in 0..=u64::from(out.scans()) {
            assert_eq!(out.at(scan), back.at(scan).times(-1.0));
        }
    }
}

#[test]
fn a_constant_velocity_comes_out_with_the_same_bits() {
    let shaper = Shaper::new(&VibrationMode::new(7.3), 1e-3).expect("a shaper");
    let at = |scan: f64| Setpoint {
        velocity: 0.1,
        ..Setpoint::at_rest(0.1 * scan * 1e-3)
    };
    let mean = at(1000.0).plus(&shaper.lag(&at(1000.0), |delay| at(1000.0 - f64::from(delay))));
    assert_eq!(
        Setpoint {
            position: 0.0,
            ..mean
        },
        Setpoint {
            position: 0.0,
            ..at(0.0)
        }
    );
    assert!(mean.position < at(1000.0).position);
}

#[test]
fn the_weights_are_those_of_a_mean() {
    let mut random = Random(2406);
    for _ in 0..2000 {
        let cycle = random.log(1e-5, 1.0);
        let damping = random.log(1e-6, DAMPING_MAX);
        let slower = (1.0 - damping * damping).sqrt();
        let period = random.log(SHORTEST_PERIOD, LONGEST_PERIOD);
        let shaper = ShaperKind::ALL[random.below(4) as usize];
        let mode = VibrationMode {
            frequency: 1.0 / (period * cycle * slower),
            damping,
            shaper,
        };
        let shaper = Shaper::new(&mode, cycle).expect("a shaper");
        let late: Vec<_> = shaper.taps().collect();
        assert!(late.iter().all(|tap| tap.weight > 0.0), "{mode:?}: {late:?}");
        assert!(
            late.is_sorted_by(|one, next| one.delay < next.delay),
            "{mode:?}: {late:?}"
        );
        assert_eq!(late.last().map(|tap| tap.delay), Some(shaper.delay()), "{mode:?}");
        assert!(f64::from(shaper.delay()) < period + 1.001, "{mode:?}");
        let all: f64 = late.iter().map(|tap| tap.weight).sum();
        assert!(all < 1.0, "{mode:?}: {all}");
    }
}

/// Covers: VB12
#[test]
fn a_mode_that_cannot_be_used_is_refused_with_the_nearest_that_can() {
    let refused = |frequency: f64, damping: f64, cycle: f64| {
        let mode = VibrationMode {
            frequency,
            damping,
            shaper: ShaperKind::Zv,
        };
        Shaper::new(&mode, cycle).expect_err("refused")
    };
    let invalid = |field, value| PlanError::InvalidInput { field, value };
    for value in [0.0, -1.0, f64::INFINITY, f64::NEG_INFINITY] {
        assert_eq!(refused(value, 0.0, 1e-3), invalid(Field::Frequency, value));
        assert_eq!(refused(10.0, 0.0, value), invalid(Field::Cycle, value));
    }
    assert!(matches!(
        refused(f64::NAN, 0.0, 1e-3),
        PlanError::InvalidInput {
            field: Field::Frequency,
            ..
        }
    ));
    assert!(matches!(
        refused(10.0, f64::NAN, 1e-3),
        PlanError::InvalidInput {
            field: Field::Damping,
            ..
        }
    ));
    let out = |field, value, nearest| PlanError::OutOfRange {
        field,
        value,
        nearest,
    };
    assert_eq!(refused(10.0, 0.95, 1e-3), out(Field::Damping, 0.95, 0.9));
    assert_eq!(refused(10.0, -0.1, 1e-3), out(Field::Damping, -0.1, 0.0));
    assert_eq!(refused(300.0, 0.0, 1e-3), out(Field::Frequency, 300.0, 250.0));
    assert_eq!(refused(0.1, 0.0, 1e-3), out(Field::Frequency, 0.1, 1.0 / 4.096));
    for value in [f64::MIN_POSITIVE, 5e-324, 1e30, f64::MAX] {
        let PlanError::OutOfRange { nearest, .. } = refused(value, 0.0, 1e-3) else {
            panic!("{value}");
        };
        // The named value is accepted.
        assert!(Shaper::new(&VibrationMode::new(nearest), 1e-3).is_ok());
    }
}
