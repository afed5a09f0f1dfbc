//! Reversals, limits that change on the way, and starts outside them.

use super::support::{self, ORDERS, Random, integrate};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::{Excess, Limits, OnlinePlan, Order, RampPlan, Setpoint};
use std::vec::Vec;

/// By how much `seen` is outside `limits`, with the sign of velocity a stop should keep in `heading`.
fn excess_seen(seen: &support::Seen, limits: &Limits, goal: f64, heading: f64) -> Excess {
    let fastest = seen.v_max.max(-seen.v_min);
    let against = if heading > 0.0 { -seen.v_min } else { seen.v_max };
    let reversal = if goal == 0.0 { against } else { 0.0 };
    Excess {
        velocity: (fastest - limits.velocity).max(reversal).max(0.0),
        acceleration: (seen.speeding - limits.acceleration)
            .max(seen.slowing - limits.deceleration)
            .max(0.0),
        jerk: (seen.jerk - limits.jerk).max(0.0),
    }
}

/// Any goal, and other limits at every link: each plan arrives, and its excess is the one that an integrator finds.
/// Returns the most pieces and root steps of a plan, and how many had an excess.
fn changing_chains(seed: u64, chains: usize) -> (usize, u32, u32) {
    let mut random = Random(seed);
    let (mut largest, mut steps, mut outside) = (0, 0, 0);
    for chain in 0..chains {
        let order = ORDERS[chain % 3];
        let limits = support::limits(&mut random, order);
        let cycle = random.log(1e-4, 1e-2) * limits.velocity / limits.acceleration;
        let mut before = limits;
        let mut start = Setpoint::at_rest(0.0);
        for link in 0..10 {
            let changed = chain % 2 == 1;
            let factor = || if changed { random.between(0.3, 1.0) } else { 1.0 };
            let now = support::each_times(&limits, factor);
            let goal = match random.below(4) {
                0 => 0.0,
                1 => now.velocity,
                _ => now.velocity * random.between(-1.0, 1.0),
            };
            let plan = RampPlan::new(&start, goal, &now, &before, cycle).unwrap();
            let seen = integrate(&start, &plan, order);
            let context = || {
                format!(
                    "chain {chain} link {link}: {start:?} -> {goal:?} {now:?} {before:?}\n{seen:?}\n{plan:?}"
                )
            };
            assert!(
                (seen.end.velocity - goal).abs() <= 1e-12 * limits.velocity,
                "{}",
                context()
            );
            largest = largest.max(plan.segments().count());
            steps = steps.max(plan.steps());
            let said = plan.excess().unwrap_or_default();
            outside += u32::from(plan.excess().is_some());
            let heading = start.velocity;
            let truth = excess_seen(&seen, &now, goal, heading);
            let near = |said: f64, truth: f64, bound: f64| (said - truth).abs() <= 2e-9 * bound.min(1e300);
            // At rest the heading is a matter of definition.
            if start.velocity.abs() > 1e-6 * now.velocity {
                assert!(
                    near(said.velocity, truth.velocity, limits.velocity),
                    "{said:?} {truth:?} {}",
                    context()
                );
            }
            let acceleration = limits.acceleration.max(limits.deceleration);
            assert!(
                near(said.acceleration, truth.acceleration, acceleration),
                "{said:?} {truth:?} {}",
                context()
            );
            if order >= Order::Four {
                assert!(
                    near(said.jerk, truth.jerk, limits.jerk),
                    "{said:?} {truth:?} {}",
                    context()
                );
            }
            if order >= Order::Three {
                let allowed = [now, before]
                    .iter()
                    .map(|l| l.acceleration.max(l.deceleration))
                    .fold(start.acceleration.abs(), f64::max);
                let peak = seen.speeding.max(seen.slowing);
                // Under constant limits the start is viable for acceleration, so nothing exceeds both.
                if !changed {
                    assert!(peak <= allowed * (1.0 + 1e-9), "{peak} {allowed} {}", context());
                }
            }
            before = now;
            start = plan.at(random.below(u64::from(plan.scans()) + 2));
        }
    }
    (largest, steps, outside)
}

#[test]
fn chains_with_changing_limits_arrive_and_tell_their_excess() {
    let (largest, steps, outside) = changing_chains(11, 1200);
    assert!(outside > 500, "the test must meet starts outside: {outside}");
    assert!(
        largest <= 16 && steps < MAX_STEPS,
        "{largest} pieces, {steps} steps"
    );
}

/// `cargo test --release -p standstill-planner --test all ramp_plans -- --ignored --nocapture`
#[test]
#[ignore = "some seconds in release"]
fn a_million_ramps_with_changing_limits() {
    let (largest, steps, outside) = changing_chains(12, 100_000);
    println!("{largest} pieces, {steps} steps, {outside} of a million outside");
}

/// The velocity when acceleration and jerk are zero as soon as can be, by the areas under their ramps.
fn settled(v: f64, a: f64, j: f64, limits: &Limits) -> f64 {
    let (jerk, snap) = (limits.jerk, limits.snap);
    let side = if a + j * j.abs() / (2.0 * snap) > 0.0 {
        -1.0
    } else {
        1.0
    };
    let peak = jerk.min((j * j / 2.0 - snap * side * a).max(0.0).sqrt());
    let hold = if peak > 0.0 {
        ((-side * a - (peak * peak - j * j / 2.0) / snap) / peak).max(0.0)
    } else {
        0.0
    };
    let spans = [
        ((peak - side * j).max(0.0) / snap, side * snap),
        (hold, 0.0),
        (peak / snap, -side * snap),
    ];
    let end = spans.iter().fold((v, a, j), |(v, a, j), (t, s)| {
        (
            v + t * (a + t * (j / 2.0 + t * s / 6.0)),
            a + t * (j + t * s / 2.0),
            j + t * s,
        )
    });
    end.0
}

/// A plain simulation in small steps of the fastest way to bring a rising velocity to its peak: as much
/// snap downwards as leaves jerk and acceleration able to keep their bounds. Returns the highest velocity.
///
/// With `lowest` it must not settle below that afterwards.
fn greedy_peak(start: &Setpoint, limits: &Limits, step: f64, lowest: Option<f64>) -> f64 {
    let (mut v, mut a, mut j) = (start.velocity, start.acceleration, start.jerk);
    while a > 0.0 {
        let allowed = |s: f64| {
            let v = v + step * (a + step * (j / 2.0 + step * s / 6.0));
            let (a, j) = (a + step * (j + step * s / 2.0), j + step * s);
            if lowest.is_some_and(|lowest| settled(v, a, j, limits) < lowest) {
                return false;
            }
            let arrest = if j < 0.0 {
                a - j * j / (2.0 * limits.snap)
            } else {
                a
            };
            j >= -limits.jerk && arrest >= -limits.deceleration
        };
        let s = [-limits.snap, 0.0, limits.snap]
            .into_iter()
            .find(|s| allowed(*s))
            .unwrap_or(limits.snap);
        v += step * (a + step * (j / 2.0 + step * s / 6.0));
        a += step * (j + step * s / 2.0);
        j += step * s;
    }
    v
}

/// How often the velocity of a plan changes its sign, seen in a thousand instants.
fn turns(plan: &RampPlan, small: f64) -> usize {
    let instants = |k: u32| plan.duration() * f64::from(k) / 1000.0;
    let velocities: Vec<f64> = (1..1000)
        .map(|k| velocity_at(plan, instants(k)))
        .filter(|velocity| velocity.abs() > small)
        .collect();
    velocities
        .windows(2)
        .filter(|pair| pair[0] * pair[1] < 0.0)
        .count()
}

fn velocity_at(plan: &RampPlan, mut time: f64) -> f64 {
    for piece in plan.segments() {
        if time <= piece.duration {
            return piece.velocity
                + time * (piece.acceleration + time * (piece.jerk / 2.0 + time * piece.snap / 6.0));
        }
        time -= piece.duration;
    }
    plan.end_velocity()
}

/// Too fast to stay below the velocity limit, or too slow to stop without turning back: the excess is reported, and
/// no simulation stays closer to the limit. Of those that turn back once, none stays closer to zero.
#[test]
fn what_cannot_be_avoided_is_the_least_and_is_told() {
    let mut random = Random(41);
    let (mut exceeding, mut turning, mut gentle_is_worse) = (0, 0, 0);
    for case in 0..1200 {
        let velocity = random.log(0.1, 10.0);
        let acceleration = velocity * random.log(1.0, 10.0);
        let jerk = acceleration * random.log(30.0, 300.0);
        let limits = Limits {
            velocity,
            acceleration,
            deceleration: acceleration * random.log(0.3, 3.0),
            jerk,
            snap: jerk * random.log(30.0, 1000.0),
        };
        let room = |bound: f64, a: f64| (2.0 * limits.snap * (bound - a)).sqrt().min(limits.jerk);
        // In a stop the velocity falls, and zero is the limit.
        let stop = case % 2 == 1;
        let bound = if stop {
            limits.deceleration
        } else {
            limits.acceleration
        };
        let a = bound * random.between(0.05, 1.0);
        let j = if random.below(2) == 0 {
            -limits.jerk * random.unit()
        } else {
            room(bound, a) * random.between(-1.0, 0.9)
        };
        let rise = a * (a / limits.snap).sqrt().max(a / limits.jerk);
        let below = rise * random.between(0.0, 0.9);
        let (start, goal) = if stop {
            (
                Setpoint {
                    velocity: below.min(velocity),
                    acceleration: -a,
                    jerk: -j,
                    ..Setpoint::default()
                },
                0.0,
            )
        } else {
            (
                Setpoint {
                    velocity: (velocity - below).max(0.0),
                    acceleration: a,
                    jerk: j,
                    ..Setpoint::default()
                },
                velocity * random.unit(),
            )
        };
        let plan = RampPlan::new(&start, goal, &limits, &limits, 1e-3).unwrap();
        let seen = integrate(&start, &plan, Order::Four);
        let step = rise / a * 2e-4;
        let (least, ours) = if stop {
            // Mirrored: up is down, and the braking of the fall may use the lower of the two bounds.
            let lower = limits.acceleration.min(limits.deceleration);
            let over = Setpoint {
                velocity: -start.velocity,
                acceleration: a,
                jerk: j,
                ..start
            };
            (
                greedy_peak(
                    &over,
                    &Limits {
                        deceleration: lower,
                        ..limits
                    },
                    step,
                    Some(0.0),
                ),
                -seen.v_min,
            )
        } else {
            (
                greedy_peak(&start, &limits, step, None) - velocity,
                seen.v_max - velocity,
            )
        };
        let tolerance = 1e-3 * rise;
        let said = plan.excess().map_or(0.0, |excess| excess.velocity);
        assert!(
            (said - ours.max(0.0)).abs() <= 2e-9 * velocity,
            "{said} {ours} {plan:?}"
        );
        assert!(
            ours.max(0.0) <= least.max(0.0) + tolerance,
            "case {case}: {ours} {least} {start:?} {limits:?} {plan:?}"
        );
        if stop {
            // A motion that leaves the dip by itself turns again.
            let again = settled(start.velocity, start.acceleration, start.jerk, &limits) > 0.0;
            assert!(
                turns(&plan, 1e-9 * velocity) <= 1 + usize::from(again),
                "case {case}: {start:?} {limits:?} {plan:?}"
            );
        }
        if ours > tolerance {
            *(if stop { &mut turning } else { &mut exceeding }) += 1;
            gentle_is_worse += u32::from(j < 0.0 && a < j * j / (2.0 * limits.snap));
        }
    }
    println!(
        "exceeding {exceeding} turning {turning} of them with an arrest that swings back {gentle_is_worse}"
    );
    assert!(exceeding > 300 && turning > 300 && gentle_is_worse > 15);
}

/// New limits in the middle of a ramp under the old ones: until the state is inside, the larger of the two hold
/// throughout, and no more.
#[test]
fn under_lowered_limits_the_larger_ones_hold() {
    let mut random = Random(43);
    let (mut outside, mut reversed) = (0, 0);
    for case in 0..4000 {
        let order = ORDERS[1 + case % 2];
        let old = support::limits(&mut random, order);
        let cycle = 0.002 * old.velocity / old.acceleration;
        let plan = |start: &Setpoint, goal, now: &Limits, before: &Limits| {
            RampPlan::new(start, goal, now, before, cycle).unwrap()
        };
        let from = Setpoint {
            velocity: old.velocity * random.unit(),
            ..Setpoint::default()
        };
        let first = plan(&from, old.velocity * random.unit(), &old, &old);
        let start = first.at(random.below(u64::from(first.scans()) + 1));
        let factor = || {
            if random.below(2) == 0 {
                1.0
            } else {
                random.between(0.2, 1.5)
            }
        };
        let new = support::each_times(&old, factor);
        let goal = new.velocity * random.unit();
        let then = plan(&start, goal, &new, &old);
        outside += u32::from(then.excess().is_some());
        let seen = integrate(&start, &then, order);
        let context = || format!("case {case} {start:?} -> {goal} {new:?} {old:?}\n{seen:?}\n{then:?}");
        let within = |value: f64, a: f64, b: f64| value <= a.max(b) * (1.0 + 1e-9);
        // A lower jerk may be too low to stop before the velocity turns back; then there is nothing to check.
        if seen.v_min < -1e-9 * old.velocity {
            reversed += 1;
            continue;
        }
        assert!(
            within(seen.speeding, new.acceleration, old.acceleration),
            "{}",
            context()
        );
        assert!(
            within(seen.slowing, new.deceleration, old.deceleration),
            "{}",
            context()
        );
        assert!(within(seen.v_max, new.velocity, old.velocity), "{}", context());
        if new.jerk.is_finite() {
            assert!(within(seen.jerk, new.jerk, old.jerk), "{}", context());
        }
        if order == Order::Four {
            assert!(within(seen.snap, new.snap, old.snap), "{}", context());
        }
    }
    println!("outside {outside} reversed {reversed}");
    assert!(outside > 1000 && reversed < 200);
}

#[test]
fn getting_inside_comes_first_and_is_fast() {
    let unbounded = f64::INFINITY;
    let old = Limits {
        velocity: 10.0,
        acceleration: 10.0,
        deceleration: 8.0,
        jerk: 100.0,
        snap: unbounded,
    };
    let first = |start: &Setpoint, goal, new: &Limits, old: &Limits| {
        let plan = RampPlan::new(start, goal, new, old, 1e-3).unwrap();
        let segments: Vec<_> = plan.segments().collect();
        (segments, plan.excess().unwrap())
    };
    let near = |a: f64, b: f64| assert!((a - b).abs() <= 1e-12 * b.abs().max(1.0), "{a} {b}");

    // Order 3: the deceleration is lowered from 8 to 5 and the jerk from 100 to 50: 0.03 s at the old jerk.
    let braking = Setpoint {
        velocity: 6.0,
        acceleration: -8.0,
        ..Setpoint::default()
    };
    let new = Limits {
        deceleration: 5.0,
        jerk: 50.0,
        ..old
    };
    let (segments, excess) = first(&braking, 0.0, &new, &old);
    near(segments[0].duration, 0.03);
    near(segments[0].jerk, 100.0);
    near(segments[1].acceleration, -5.0);
    near(segments[1].jerk, 0.0);
    near(segments[2].jerk, 50.0);
    near(excess.acceleration, 3.0);
    near(excess.jerk, 50.0);
    assert_eq!(excess.velocity, 0.0);

    // Order 4: only the jerk is outside, and comes down at the old snap.
    let old = Limits { snap: 2000.0, ..old };
    let new = Limits {
        jerk: 60.0,
        snap: 1000.0,
        ..old
    };
    let rising = Setpoint {
        velocity: 1.0,
        acceleration: 1.0,
        jerk: 100.0,
        ..Setpoint::default()
    };
    let (segments, excess) = first(&rising, 9.0, &new, &old);
    near(segments[0].duration, 0.02);
    near(segments[0].snap, -2000.0);
    near(segments[1].jerk, 60.0);
    near(excess.jerk, 40.0);

    // Order 4: the acceleration is outside; it crosses its bound with the largest jerk the new limits allow
    // inside, after one turn of the snap: w = sqrt(S dy + r^2/2).
    let new = Limits {
        deceleration: 5.0,
        jerk: 40.0,
        snap: 1500.0,
        ..old
    };
    let (segments, excess) = first(&braking, 0.0, &new, &old);
    let peak = (2000.0f64 * 3.0 + 40.0 * 40.0 / 2.0).sqrt();
    near(segments[0].duration, peak / 2000.0);
    near(segments[1].duration, (peak - 40.0) / 2000.0);
    near(segments[2].acceleration, -5.0);
    near(segments[2].jerk, 40.0);
    near(excess.acceleration, 3.0);
    near(excess.jerk, peak - 40.0);

    // Orders 2 and 3: the velocity is outside; the old deceleration holds until it is inside.
    let old = Limits {
        velocity: 10.0,
        acceleration: 10.0,
        deceleration: 8.0,
        jerk: unbounded,
        snap: unbounded,
    };
    let new = Limits {
        velocity: 6.0,
        deceleration: 4.0,
        ..old
    };
    let cruising = Setpoint {
        velocity: 10.0,
        ..Setpoint::default()
    };
    let (segments, excess) = first(&cruising, 2.0, &new, &old);
    near(segments[0].duration, 0.5);
    near(segments[0].acceleration, -8.0);
    near(segments[1].duration, 1.0);
    near(segments[1].acceleration, -4.0);
    near(excess.velocity, 4.0);
    near(excess.acceleration, 4.0);

    let (old, new) = (Limits { jerk: 100.0, ..old }, Limits { jerk: 100.0, ..new });
    let (segments, _) = first(&cruising, 2.0, &new, &old);
    near(segments[1].acceleration, -8.0);
    near(segments[2].jerk, 100.0);
    // Inside in velocity and in acceleration at the same instant.
    near(segments[3].acceleration, -4.0);
    near(segments[3].velocity, 6.0);

    // The goal is the lowered limit itself: the ramp does not go below it to be inside sooner.
    for snap in [unbounded, 2000.0] {
        let (old, new) = (Limits { snap, ..old }, Limits { snap, ..new });
        let plan = RampPlan::new(&cruising, 6.0, &new, &old, 1e-3).unwrap();
        assert!(
            plan.segments()
                .all(|segment| segment.velocity >= 6.0 - 1e-9 && segment.acceleration <= 1e-9)
        );
        let slower = RampPlan::new(&cruising, 6.0, &new, &new, 1e-3).unwrap();
        assert!(plan.duration() < slower.duration());
    }
}

/// Lower rates do not lead out of the old velocity limit where a stop under the old rates would not: plans to a
/// velocity and to a position, from any state.
#[test]
fn lowered_limits_keep_the_old_velocity() {
    const CYCLE: f64 = 0.001;
    let mut random = Random(29);
    let mut lowered = 0;
    let count = standstill_testkit::cases(20_000) as usize;
    for case in 0..count {
        let before = support::limits(&mut random, ORDERS[case % 3]);
        let limits = support::each_times(&before, || random.one_of(&[1.0, 1.0, 0.5, 0.2, 0.05]));
        let lower = before.acceleration.min(before.deceleration);
        let start = Setpoint {
            velocity: before.velocity * random.between(-1.0, 1.0),
            acceleration: lower * random.between(-1.0, 1.0),
            jerk: if before.jerk.is_finite() {
                before.jerk * random.between(-1.0, 1.0)
            } else {
                0.0
            },
            ..Setpoint::at_rest(0.0)
        };
        let most = before.velocity * (1.0 + 1e-9);
        let stop = RampPlan::new(&start, 0.0, &before, &before, CYCLE).unwrap();
        if stop.peaks().velocity > most || limits == before {
            continue;
        }
        lowered += 1;
        let goal = limits.velocity * random.between(-1.0, 1.0);
        let ramp = RampPlan::keeping_velocity(&start, goal, &limits, &before, CYCLE).unwrap();
        let target = before.velocity * before.velocity / lower * random.between(-3.0, 3.0);
        let online = OnlinePlan::keeping_velocity(&start, target, 0.0, &limits, &before, CYCLE).unwrap();
        for peak in [ramp.peaks().velocity, online.peaks().velocity] {
            assert!(
                peak <= most,
                "case {case}: {peak} {start:?} {limits:?} {before:?} {goal} {target}"
            );
        }
    }
    assert!(lowered > count * 3 / 4, "{lowered}");
}
