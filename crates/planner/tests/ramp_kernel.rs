//! The third-order kernel by itself: from any state, inside its bounds or not, it reaches the goal with little
//! work.

use standstill_planner::kernel::{
    Bounds, MAX_STEPS, Point, Profile, Sides, falling_root, second, third, zero,
};
use standstill_planner::math::cbrt;
use standstill_testkit::{Random, cases};

#[derive(Debug)]
struct Case {
    x: f64,
    v: f64,
    a: f64,
    target: f64,
    bounds: Bounds,
}

fn case(random: &mut Random, outside: f64) -> Case {
    let top = random.log(0.3, 30.0);
    let bounds = Bounds {
        v: Sides {
            minus: top * random.log(0.2, 5.0),
            plus: top,
        },
        a: if random.unit() < 0.1 {
            Sides::both(f64::INFINITY)
        } else {
            Sides {
                minus: random.log(0.1, 10.0),
                plus: random.log(0.1, 10.0),
            }
        },
    };
    let side = |sides: Sides, z: f64| {
        if z < 0.0 {
            z * sides.minus.min(10.0)
        } else {
            z * sides.plus.min(10.0)
        }
    };
    let (v, a) = (
        side(bounds.v, outside * random.between(-1.0, 1.0)),
        side(bounds.a, outside * random.between(-1.0, 1.0)),
    );
    Case {
        x: random.between(-1.0, 1.0),
        v,
        a,
        target: random.between(-1.0, 1.0) * random.log(1e-6, 1e3),
        bounds,
    }
}

fn solve(case: &Case) -> Profile {
    third(case.x, case.v, case.a, case.target, &case.bounds)
}

/// The end of a profile, and how far `v` and `a` are outside their bounds at worst, relative to them.
fn follow(case: &Case, profile: &Profile) -> ([f64; 3], f64, f64) {
    let (mut x, mut v, mut a) = (case.x, case.v, case.a);
    let (mut out_v, mut out_a) = (f64::NEG_INFINITY, f64::NEG_INFINITY);
    let mut peak_a = a.abs();
    let ratio = |value: f64, sides: Sides| (value / sides.plus).max(-value / sides.minus) - 1.0;
    for span in profile.spans.iter() {
        let (t, u) = (span.duration, span.input);
        assert!(t > 0.0 && t.is_finite() && u.abs() <= 1.0, "{profile:?}");
        // A rounding residue of zero counts as zero in a cruise, which may last long.
        if u == 0.0 && a.abs() <= 1e-13 * peak_a {
            a = 0.0;
        }
        peak_a = peak_a.max(a.abs()).max((a + t * u).abs());
        // `v` is extreme at the ends and where `a` is zero.
        let turn = if u != 0.0 { (-a / u).clamp(0.0, t) } else { 0.0 };
        out_v = out_v.max(ratio(v + turn * (a + turn * u / 2.0), case.bounds.v));
        x += t * v + t * t * a / 2.0 + t * t * t * u / 6.0;
        v += t * a + t * t * u / 2.0;
        a += t * u;
        out_v = out_v.max(ratio(v, case.bounds.v));
        out_a = out_a.max(ratio(a, case.bounds.a));
    }
    ([x, v, a], out_v, out_a)
}

#[test]
fn every_state_arrives() {
    let mut random = Random(51);
    let (mut worst, mut steps, mut spans) = (0.0f64, 0, 0);
    for index in 0..cases(60_000) {
        let outside = if index % 4 == 0 { 3.0 } else { 1.0 };
        let case = case(&mut random, outside);
        let profile = solve(&case);
        let ([x, v, a], out_v, out_a) = follow(&case, &profile);
        let t = profile.spans.duration();
        let way = case
            .x
            .abs()
            .max(case.target.abs())
            .max(t * case.v.abs().max(case.bounds.v.plus));
        let error = ((x - case.target) / way)
            .abs()
            .max(v.abs() / case.bounds.v.plus.max(case.v.abs()))
            .max(a.abs() / case.bounds.a.plus.min(10.0).max(case.a.abs()));
        assert!(
            error <= 1e-11,
            "{error:e} {x} {v} {a} {:?} {profile:?}",
            case.target
        );
        worst = worst.max(error);
        steps = steps.max(profile.steps);
        spans = spans.max(profile.spans.len());
        if outside == 1.0 {
            assert!(out_a <= 1e-9, "{out_a:e} {profile:?}");
            // Only a `v` that an arrest takes out of its bounds may leave them.
            let arrest = case.v + case.a * case.a.abs() / 2.0;
            if arrest <= case.bounds.v.plus && arrest >= -case.bounds.v.minus {
                assert!(out_v <= 1e-9, "{out_v:e} {profile:?}");
            }
        }
    }
    println!("worst end {worst:e}, steps {steps} of {MAX_STEPS}, spans {spans}");
    assert!(steps < MAX_STEPS / 2);
}

/// All bounds are just touched at once, or nearly: the switches are at the ends of their brackets.
#[test]
fn where_every_bound_is_just_touched_it_arrives() {
    let mut random = Random(57);
    let mut worst = 0.0f64;
    for _ in 0..cases(60_000) {
        let near = |random: &mut Random| match (3.0 * random.unit()) as u32 {
            0 => 1.0,
            1 => 1.0 + random.between(-1.0, 1.0) * random.log(1e-16, 1e-6),
            _ => 1.0 + 1e-9 * random.between(-1.0, 1.0),
        };
        // A jerk up and down again reaches `rate * rate`, and twice that the distance.
        let rate = random.log(0.1, 10.0);
        let top = rate * rate * near(&mut random);
        let distance = 2.0 * rate * rate * rate * near(&mut random);
        let case = Case {
            x: 0.5 * distance,
            v: 0.0,
            a: 0.0,
            target: -0.5 * distance,
            bounds: Bounds {
                v: Sides::both(top),
                a: Sides::both(rate),
            },
        };
        let profile = solve(&case);
        let ([x, v, a], out_v, out_a) = follow(&case, &profile);
        let error = ((x - case.target) / distance)
            .abs()
            .max(v.abs() / top)
            .max(a.abs() / rate);
        assert!(error <= 1e-12, "{error:e} {case:?} {profile:?}");
        assert!(out_v <= 1e-9 && out_a <= 1e-9, "{out_v:e} {out_a:e} {case:?}");
        worst = worst.max(error);
    }
    println!("worst end {worst:e}");
}

/// A push of any length to either side, followed by a profile, is never faster than the profile at once.
#[test]
fn no_detour_is_faster() {
    let mut random = Random(53);
    for _ in 0..cases(20_000) {
        let case = case(&mut random, 1.0);
        let direct = solve(&case).spans.duration();
        // Push for a random while, either way, and plan again from there.
        let side = if random.unit() < 0.5 {
            case.bounds.v.plus
        } else {
            -case.bounds.v.minus
        };
        let push = second(case.v, case.a, side, case.bounds.a);
        let mut detour = Case { ..case };
        let mut spent = 0.0;
        for span in push.iter() {
            let t = span.duration * if random.unit() < 0.5 { random.unit() } else { 1.0 };
            detour.x += t * detour.v + t * t * detour.a / 2.0 + t * t * t * span.input / 6.0;
            detour.v += t * detour.a + t * t * span.input / 2.0;
            detour.a += t * span.input;
            spent += t;
            if t < span.duration {
                break;
            }
        }
        let indirect = spent + solve(&detour).spans.duration();
        // The arrest must be inside; otherwise coming inside has priority and is not the fastest.
        let arrest = case.v + case.a * case.a.abs() / 2.0;
        if arrest <= case.bounds.v.plus && arrest >= -case.bounds.v.minus {
            assert!(
                direct <= indirect * (1.0 + 1e-6),
                "{direct} {indirect} {:?}",
                case.bounds
            );
        }
    }
}

/// A bracket of a few neighbouring numbers, and functions that are hard to interpolate: the root search ends by
/// itself.
#[test]
fn a_root_needs_no_cap() {
    let up = |x: f64, ulps: u64| f64::from_bits(x.to_bits() + ulps);
    for ulps in 1..40 {
        for at in 1..=ulps {
            let (root, steps) =
                falling_root(3.0, up(3.0, ulps), |x| if x < up(3.0, at) { 1.0 } else { -1.0 });
            assert_eq!(root, up(3.0, at));
            assert!(steps <= 12, "{ulps} {at} {steps}");
        }
    }
    let power_of = |x: f64, power: u32| (0..power).fold(1.0, |product, _| product * x);
    let mut most = 0;
    for exponent in 0..300 {
        let at = 1.0 / power_of(f64::from(exponent + 1), 5);
        for power in [1, 3, 9] {
            let (root, steps) = falling_root(0.0, 1.0, |x| power_of(at - x, power));
            assert!(root >= at && root - at <= 1e-14, "{at} {power} {root}");
            most = most.max(steps);
        }
    }
    println!("{most} steps of {MAX_STEPS}");
    assert!(most <= 94);
}

/// Functions that jump over zero, so that no step comes near it, and steep ones; also with misleading slopes.
#[test]
fn a_zero_needs_no_cap() {
    let mut random = Random(59);
    let mut most = 0;
    let slopes = [
        f64::NAN,
        0.0,
        -1.0,
        f64::INFINITY,
        f64::MIN_POSITIVE,
        1e300,
        1e-3,
        1.0,
    ];
    for case in 0..cases(20_000) as usize {
        let root = match case % 3 {
            0 => 0.0,
            1 => random.between(-1.0, 1.0) * random.log(1e-300, 1.0),
            _ => random.between(-1.0, 1.0),
        };
        let (up, down) = (random.log(1e-12, 1.0), random.log(1e-12, 1.0));
        let function = |at: f64| Point {
            at,
            value: match case % 2 {
                0 if at < root => -down,
                0 => up,
                _ => cbrt((at - root).abs()).copysign(at - root),
            },
            noise: 0.0,
            slope: slopes[(case + (at.to_bits() % 3) as usize * (case / 8 % 2)) % slopes.len()],
        };
        let (point, steps) = zero(
            function(-1.0 - random.unit()),
            function(1.0 + random.unit()),
            function,
        );
        // At a jump any point is as good as another.
        assert!(
            case % 2 == 0 || (point.at - root).abs() <= 1e-15,
            "{root} {point:?}"
        );
        most = most.max(steps);
    }
    println!("{most} steps of {MAX_STEPS}");
    assert!(most <= 114, "{most}");
}

/// Powers, flat or with a slope where they begin, and roots from near one end of the bracket to near the other.
#[test]
fn a_zero_with_slopes_takes_few_steps() {
    let mut random = Random(61);
    let (mut most, mut sum) = (0, 0);
    let count = standstill_testkit::whole_or(20_000, 400_u32);
    for case in 0..count {
        let power = 1 + case % 5;
        let linear = if case % 3 == 0 {
            0.0
        } else {
            random.log(1e-3, 10.0)
        };
        let root = if case % 2 == 0 {
            random.log(1e-4, 1.0)
        } else {
            random.unit()
        };
        let side = random.sign();
        let times = |at: f64, power: u32| (0..power).fold(1.0, |product, _| product * at);
        let rise = |at: f64| at * linear + times(at, power);
        let function = |at: f64| Point {
            at,
            value: side * (rise(at) - rise(root)),
            noise: 4.0 * f64::EPSILON * (rise(at) + rise(root)),
            slope: side * (linear + f64::from(power) * times(at, power - 1)),
        };
        let (point, steps) = zero(function(0.0), function(1.0), function);
        assert!(
            (point.at - root).abs() <= 1e-14 * root,
            "{case}: {root} {point:?}"
        );
        most = most.max(steps);
        sum += steps;
    }
    println!("{most} steps at most, {sum} in {count}");
    assert!(most <= 6 && sum <= 3 * count, "{most} {sum}");
}

/// `cargo test --release -p standstill-planner --features std --test all ramp_kernel -- --ignored --nocapture`
#[test]
#[ignore = "some seconds in release"]
fn five_million_profiles_take_few_root_steps() {
    let mut random = Random(57);
    let steps = (0..5_000_000).map(|_| solve(&case(&mut random, 1.0)).steps);
    let worst = steps.max().unwrap_or(0);
    println!("most root steps in 5 million: {worst} of {MAX_STEPS}");
    assert!(worst < MAX_STEPS / 2);
}
