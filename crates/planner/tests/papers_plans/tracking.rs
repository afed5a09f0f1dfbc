//! Targets that move: nothing jumps, limits are kept, and the end is exactly the last target.

use super::support::{Random, bounds, rounds};
use standstill_planner::papers::{Tracking, peaks};
use standstill_planner::{Limits, Order, Setpoint};

const CYCLE: f64 = 1e-3;

fn limits_of(random: &mut Random, order: Order) -> Limits {
    let velocity = random.log(0.1, 10.0);
    let acceleration = velocity * random.log(1.0, 30.0);
    let jerk = acceleration * random.log(1.0, 100.0);
    let snap = jerk * random.log(3.0, 300.0);
    let limits = bounds(velocity, acceleration, jerk);
    match order {
        Order::Two => Limits {
            jerk: f64::INFINITY,
            ..limits
        },
        Order::Three => limits,
        Order::Four => Limits { snap, ..limits },
    }
}

/// A random chase: the set-points of every scan, the tracker at the end, and its last target.
fn chase(random: &mut Random, limits: &Limits) -> (Vec<Setpoint>, Tracking, f64) {
    let mut target = random.sign() * random.unit();
    let start = Setpoint::at_rest(random.unit());
    let mut tracking = Tracking::new(&start, target, limits, CYCLE).expect("a plan");
    let mut seen = vec![tracking.now()];
    for _ in 0..8 {
        for _ in 0..(random.unit() * 150.0) as u32 {
            seen.push(tracking.advance(1));
        }
        target += random.sign() * limits.velocity * random.log(1e-4, 0.5);
        let before = tracking.now();
        assert!(tracking.retarget(target).expect("a plan"));
        assert_eq!(tracking.now().position, before.position);
        assert_eq!(tracking.now().velocity, before.velocity);
        if limits.order() >= Order::Three {
            assert_eq!(tracking.now().acceleration, before.acceleration);
        }
        if limits.order() == Order::Four {
            assert_eq!(tracking.now().jerk, before.jerk);
        }
    }
    while !tracking.is_there() {
        seen.push(tracking.advance(1));
    }
    (seen, tracking, target)
}

/// What is published keeps every limit as a backward difference, and ends at rest on the last target.
#[test]
fn a_chase_keeps_its_limits_and_ends_on_the_last_target() {
    let mut random = Random(0x7AC1);
    for order in [Order::Two, Order::Three, Order::Four] {
        for _ in 0..rounds(60) {
            let limits = limits_of(&mut random, order);
            let (seen, tracking, target) = chase(&mut random, &limits);
            assert_eq!(tracking.now(), Setpoint::at_rest(target), "{limits:?}");
            assert_eq!(tracking.plan().excess(), None, "{limits:?}");
            let mut row: Vec<f64> = vec![seen[0].position; 4];
            row.extend(seen.iter().map(|state| state.position));
            row.extend([target; 4]);
            let bounds = [
                limits.velocity,
                limits.acceleration.max(limits.deceleration),
                limits.jerk,
                limits.snap,
            ];
            // A position has 53 bits; each difference doubles the rounding error.
            let mut noise = 4.0 * f64::EPSILON * row.iter().fold(0.0, |m: f64, p| m.max(p.abs()));
            for bound in bounds.iter().take(order.degree()) {
                row = row.windows(2).map(|pair| (pair[1] - pair[0]) / CYCLE).collect();
                noise *= 2.0 / CYCLE;
                let worst = row.iter().fold(0.0, |m: f64, x| m.max(x.abs()));
                assert!(
                    worst <= bound * (1.0 + 1e-9) + noise,
                    "{order:?} {worst} {limits:?}"
                );
            }
        }
    }
}

#[test]
fn the_same_target_again_changes_nothing() {
    let limits = bounds(1.0, 5.0, 50.0);
    let start = Setpoint::at_rest(0.0);
    let mut tracking = Tracking::new(&start, 1.0, &limits, CYCLE).expect("a plan");
    tracking.advance(300);
    let plan = *tracking.plan();
    assert!(!tracking.retarget(1.0).expect("no plan"));
    assert_eq!(*tracking.plan(), plan);
}

/// A target that cannot be used leaves the old one in force.
#[test]
fn a_refused_target_leaves_the_plan() {
    let limits = bounds(1.0, 5.0, 50.0);
    let start = Setpoint::at_rest(0.0);
    let mut tracking = Tracking::new(&start, 1.0, &limits, CYCLE).expect("a plan");
    tracking.advance(300);
    let (plan, now) = (*tracking.plan(), tracking.now());
    assert!(tracking.retarget(f64::NAN).is_err());
    assert_eq!((*tracking.plan(), tracking.now()), (plan, now));
}

/// The executed segments lead to the set-points, wherever they are cut, and their peaks are the same.
#[test]
fn executed_segments_lead_to_the_present() {
    let mut random = Random(0x7AC2);
    for order in [Order::Three, Order::Four] {
        for _ in 0..100 {
            let limits = limits_of(&mut random, order);
            let start = Setpoint::at_rest(0.0);
            let target = limits.velocity * random.log(1e-3, 1.0);
            let mut tracking = Tracking::new(&start, target, &limits, CYCLE).expect("a plan");
            tracking.advance((random.unit() * 1.2 * f64::from(tracking.plan().scans())) as u32 + 1);
            let (mut p, mut time) = (0.0, 0.0);
            for segment in tracking.executed() {
                let (t, v, a, j, s) = (
                    segment.duration,
                    segment.velocity,
                    segment.acceleration,
                    segment.jerk,
                    segment.snap,
                );
                p += t * (v + t / 2.0 * (a + t / 3.0 * (j + t / 4.0 * s)));
                time += t;
            }
            let now = tracking.now();
            assert!((p - now.position).abs() <= 1e-9 * target, "{p} {now:?}");
            tracking.advance(tracking.plan().scans());
            let waited: f64 = tracking.executed().map(|segment| segment.duration).sum();
            assert!(waited > time);
            let all = peaks(order, tracking.executed());
            let plan = tracking.plan().peaks();
            assert!((all.velocity - plan.velocity).abs() <= 1e-9 * plan.velocity);
            assert!((all.acceleration - plan.acceleration).abs() <= 1e-9 * plan.acceleration);
            assert!((all.jerk - plan.jerk).abs() <= 1e-9 * plan.jerk);
            assert_eq!(all.snap.is_infinite(), order == Order::Three);
        }
    }
}
