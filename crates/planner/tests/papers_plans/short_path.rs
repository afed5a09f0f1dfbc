//! Between two velocities: limits, landing, reversal in time, the policies, and least time.

use super::support::{Random, bounds, keeps_its_word, random_bounds, rounds};
use standstill_planner::kernel::MAX_STEPS;
use standstill_planner::papers::{SCurve, ShortPath, ShortPathPolicy, ShortPathType};
use standstill_planner::{Field, Limits, PlanError};
use std::collections::BTreeMap;

use ShortPathPolicy::{Nearest, Paper};

/// Distance and two velocities under limits.
struct Case {
    way: f64,
    from: f64,
    to: f64,
    limits: Limits,
}

impl Case {
    fn random(random: &mut Random) -> Self {
        let mut limits = random_bounds(random);
        if random.unit() < 0.3 {
            limits.deceleration = limits.acceleration * random.log(0.2, 5.0);
        }
        let mut speed = || match (random.unit() * 8.0) as u32 {
            0 => 0.0,
            1 => limits.velocity,
            _ => limits.velocity * random.unit(),
        };
        let (from, to) = (speed(), speed());
        let way = limits.velocity * random.log(1e-5, 1e2);
        Self {
            way,
            from,
            to,
            limits,
        }
    }

    fn plan(&self, policy: ShortPathPolicy) -> Result<ShortPath, PlanError> {
        ShortPath::new(0.0, self.from, self.way, self.to, &self.limits, policy)
    }
}

#[test]
fn every_type_lands_and_keeps_its_limits() {
    let mut random = Random(0xB001);
    let mut seen = BTreeMap::new();
    let mut most = 0;
    for _ in 0..rounds(6000) {
        let case = Case::random(&mut random);
        let Case {
            way,
            from,
            to,
            limits,
        } = case;
        for policy in [Paper, Nearest] {
            let what = format!("{way} {from} {to} {limits:?} {policy:?}");
            match case.plan(policy) {
                Ok(plan) => {
                    keeps_its_word(plan.profile(), [0.0, from, 0.0], &limits, &what);
                    assert_eq!(plan.profile().end().position, way);
                    let kept = plan.end_velocity() == to;
                    assert!(kept || plan.kind() == ShortPathType::T8B, "{what}");
                    *seen.entry(plan.kind().name()).or_insert(0) += 1;
                    most = most.max(plan.steps());
                    let cruises = matches!(plan.kind().name(), "1" | "2" | "3" | "4");
                    let peak = plan.peak_velocity();
                    assert!(!cruises || peak == limits.velocity, "{what}");
                }
                Err(PlanError::Unreachable { field, nearest, .. }) => {
                    assert!(
                        field == Field::EndVelocity && policy == Nearest && to == 0.0,
                        "{what}"
                    );
                    let slower = Case { to: nearest, ..case };
                    assert!(slower.plan(Nearest).expect("the nearest").end_velocity() > 0.0);
                    *seen.entry("refused").or_insert(0) += 1;
                }
                Err(other) => panic!("{other:?}: {what}"),
            }
        }
    }
    assert_eq!(seen.len(), 10, "{seen:?}");
    assert!(seen.values().all(|count| *count > 20), "{seen:?}");
    println!("most steps of a root: {most}");
    assert!(most <= MAX_STEPS, "{most}");
}

/// Swapped velocities are the same move backwards: the same time and peak, the segments in reverse.
#[test]
fn swapped_velocities_are_the_move_backwards() {
    let mut random = Random(0xB002);
    let mut seen = 0;
    for _ in 0..2000 {
        let case = Case::random(&mut random);
        let swapped = Case {
            from: case.to,
            to: case.from,
            limits: Limits {
                acceleration: case.limits.deceleration,
                deceleration: case.limits.acceleration,
                ..case.limits
            },
            ..case
        };
        let (Ok(there), Ok(back)) = (case.plan(Nearest), swapped.plan(Nearest)) else {
            continue;
        };
        if there.kind() == ShortPathType::T8B {
            continue;
        }
        seen += 1;
        let duration = there.profile().duration();
        assert!((duration - back.profile().duration()).abs() <= 1e-12 * duration);
        assert!((there.peak_velocity() - back.peak_velocity()).abs() <= 1e-12 * there.peak_velocity());
        let pair = match there.kind() {
            ShortPathType::T2 => ShortPathType::T3,
            ShortPathType::T3 => ShortPathType::T2,
            ShortPathType::T6 => ShortPathType::T7,
            ShortPathType::T7 => ShortPathType::T6,
            same => same,
        };
        assert_eq!(back.kind(), pair);
        for k in 0..=10 {
            let time = duration * f64::from(k) / 10.0;
            let (a, b) = (there.profile().at(time), back.profile().at(duration - time));
            assert!((a.position + b.position - case.way).abs() <= 1e-11 * case.way);
        }
    }
    assert!(seen > 500);
}

#[test]
fn backwards_in_space_is_mirrored() {
    let mut random = Random(0xB003);
    for _ in 0..500 {
        let case = Case::random(&mut random);
        let mirrored = ShortPath::new(0.0, -case.from, -case.way, -case.to, &case.limits, Paper);
        let (one, other) = (case.plan(Paper).expect("a plan"), mirrored.expect("a plan"));
        assert_eq!(one.kind(), other.kind());
        assert_eq!(one.end_velocity(), -other.end_velocity());
        let time = one.profile().duration() * random.unit();
        assert_eq!(
            one.profile().at(time).position,
            -other.profile().at(time).position
        );
    }
}

/// From rest to rest it is the least-time profile of the other paper.
#[test]
fn from_rest_to_rest_it_is_the_s_curve() {
    let mut random = Random(0xB004);
    for _ in 0..1000 {
        let limits = random_bounds(&mut random);
        let way = limits.velocity * random.log(1e-5, 1e2);
        let path = ShortPath::new(0.0, 0.0, way, 0.0, &limits, Nearest).expect("a plan");
        let curve = SCurve::new(0.0, way, &limits).expect("a plan");
        let duration = curve.profile().duration();
        assert!((path.profile().duration() - duration).abs() <= 1e-12 * duration);
        for k in 0..=10 {
            let time = duration * f64::from(k) / 10.0;
            let (a, b) = (path.profile().at(time), curve.profile().at(time));
            assert!((a.position - b.position).abs() <= 1e-11 * way);
        }
    }
}

/// The closed form of type 5, which the root has to meet.
#[test]
fn type_5_meets_its_closed_form() {
    let mut random = Random(0xB005);
    let mut seen = 0;
    let count = standstill_testkit::whole_or(20_000, 2_000);
    for _ in 0..count {
        let mut case = Case::random(&mut random);
        case.limits.deceleration = case.limits.acceleration;
        let Ok(plan) = case.plan(Paper) else { continue };
        if plan.kind() != ShortPathType::T5 {
            continue;
        }
        seen += 1;
        let (a, j) = (case.limits.acceleration, case.limits.jerk);
        let Case { way, from, to, .. } = case;
        let square = a * a * (from + to) - j * (from * from + to * to) - 2.0 * a * j * way;
        let peak = ((a * a * a * a - 2.0 * j * square).sqrt() - a * a) / (2.0 * j);
        assert!((plan.peak_velocity() - peak).abs() <= 1e-11 * peak);
    }
    assert!(seen > count / 200, "{seen}");
}

/// Neither the duration nor the peak jumps where the types meet.
#[test]
fn nothing_jumps_where_the_feed_rate_is_just_reached() {
    let mut random = Random(0xB006);
    for _ in 0..500 {
        let case = Case::random(&mut random);
        // An end velocity at the feed rate is out of reach at once, and the plan is then for another move.
        let highest = 0.99 * case.limits.velocity;
        let long = Case {
            way: 1e6,
            from: case.from.min(highest),
            to: case.to.min(highest),
            ..case
        };
        let Ok(plan) = long.plan(Nearest) else { continue };
        let cruise = plan
            .profile()
            .segments()
            .find(|s| s.acceleration == 0.0 && s.jerk == 0.0);
        let just = 1e6 - cruise.expect("a cruise").duration * long.limits.velocity;
        if just < 1e-4 {
            continue;
        }
        let around = [1.0 - 1e-9, 1.0 + 1e-9].map(|x| {
            let case = Case {
                way: just * x,
                ..long
            };
            case.plan(Paper).expect("a plan").profile().duration()
        });
        assert!((around[0] - around[1]).abs() <= 1e-6 * around[0], "{around:?}");
    }
}

/// Whether an end velocity can be reached does not depend on how near it is to the start velocity.
#[test]
fn a_lower_end_velocity_may_need_less_way() {
    let limits = bounds(0.08, 20.0, 100.0);
    let plan = |end: f64| ShortPath::new(0.0, 0.06, 0.00155, end, &limits, Nearest).expect("a plan");
    assert_eq!(plan(0.005).kind(), ShortPathType::T8A);
    assert_eq!(plan(0.02).kind(), ShortPathType::T8B);
}

#[test]
fn no_way_to_go_keeps_the_velocity_or_is_refused() {
    let limits = bounds(1.0, 2.0, 3.0);
    let kept = ShortPath::new(5.0, 0.5, 5.0, 0.5, &limits, Nearest).expect("a plan");
    assert_eq!(kept.profile().duration(), 0.0);
    assert_eq!((kept.profile().end().position, kept.end_velocity()), (5.0, 0.5));
    for (from, to) in [(0.5, 0.3), (0.3, 0.5), (-0.5, -0.3)] {
        let plan = ShortPath::new(5.0, from, 5.0, to, &limits, Nearest).expect("a plan");
        assert_eq!((plan.end_velocity(), plan.profile().duration()), (from, 0.0));
    }
    let refused = ShortPath::new(5.0, 0.5, 5.0, 0.0, &limits, Nearest).unwrap_err();
    let expected = PlanError::Unreachable {
        field: Field::EndVelocity,
        value: 0.0,
        nearest: 0.5,
    };
    assert_eq!(refused, expected);
}

/// The exact stopping distance is enough, also when it was rounded.
#[test]
fn the_stopping_distance_is_enough_to_stop() {
    let mut random = Random(0xB007);
    for _ in 0..500 {
        let limits = random_bounds(&mut random);
        let speed = limits.velocity * (1.0 - random.unit());
        let (a, j) = (limits.acceleration, limits.jerk);
        let time = if speed >= a * a / j {
            speed / a + a / j
        } else {
            2.0 * (speed / j).sqrt()
        };
        let way = 0.5 * speed * time;
        let stop = |way: f64| ShortPath::new(0.0, speed, way, 0.0, &limits, Nearest);
        let plan = stop(way * (1.0 - 1e-14)).expect("a stop");
        assert!((plan.profile().duration() - time).abs() <= 1e-6 * time);
        assert!(matches!(
            stop(way * (1.0 - 1e-9)),
            Err(PlanError::Unreachable { .. })
        ));
    }
}

#[test]
fn velocities_above_the_feed_rate_or_pointing_away_are_refused() {
    let limits = bounds(1.0, 2.0, 3.0);
    let refused = |from, to, way| ShortPath::new(0.0, from, way, to, &limits, Paper).unwrap_err();
    let out = |field, value, nearest| PlanError::OutOfRange {
        field,
        value,
        nearest,
    };
    assert_eq!(refused(1.5, 0.0, 9.0), out(Field::Velocity, 1.5, 1.0));
    assert_eq!(refused(0.0, 1.5, 9.0), out(Field::EndVelocity, 1.5, 1.0));
    assert_eq!(refused(-0.5, 0.0, 9.0), out(Field::Velocity, -0.5, 0.0));
    assert_eq!(refused(0.5, -0.5, 9.0), out(Field::EndVelocity, -0.5, 0.0));
    assert_eq!(refused(-0.5, -1.5, -9.0), out(Field::EndVelocity, -1.5, -1.0));
    assert_eq!(refused(0.5, -0.5, -9.0), out(Field::Velocity, 0.5, 0.0));
    let nan = ShortPath::new(0.0, f64::NAN, 1.0, 0.0, &limits, Paper).unwrap_err();
    assert!(matches!(
        nan,
        PlanError::InvalidInput {
            field: Field::Velocity,
            ..
        }
    ));
}
