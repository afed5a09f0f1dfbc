//! Bounds so high that they limit nothing: the bounds that a plan uses (docs/planner.md, eq. 39). The plan reaches
//! its target, keeps the other bounds and does not jump. Every difference is taken from published positions alone.

use standstill_planner::{
    Limits, MoveProfile, OnlinePlan, Plan, Planner, RampPlan, Setpoint, Standard, StandardPlan,
};

const CYCLE: f64 = 0.001;

/// What programs write for "no limit".
const NO_LIMIT: [f64; 5] = [1e18, 1e20, 1e30, 1e300, f64::MAX];

fn servo() -> Limits {
    Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2000.0,
        snap: 40_000.0,
    }
}

/// Sets of limits in which `high` is the value of one or more limits above the velocity, at each order.
fn sets(high: f64) -> Vec<Limits> {
    let mut sets = Vec::new();
    for order in 2..=4 {
        for mask in 1_u32..16 {
            let given = |bit: u32, value: f64| if mask & bit != 0 { high } else { value };
            let at = |least: u32, value: f64| if order >= least { value } else { f64::INFINITY };
            sets.push(Limits {
                velocity: 50.0,
                acceleration: given(1, 200.0),
                deceleration: given(2, 200.0),
                jerk: at(3, given(4, 2000.0)),
                snap: at(4, given(8, 40_000.0)),
            });
        }
    }
    sets
}

/// Holds the differences of published positions against `limits`.
fn keeps(limits: &Limits, positions: &[f64], what: &str) {
    let higher = limits.acceleration.max(limits.deceleration);
    let mut values = positions.to_vec();
    let mut resolved = positions
        .iter()
        .fold(0.0_f64, |most, value| most.max(value.abs()))
        * 1e-14;
    for bound in [limits.velocity, higher, limits.jerk, limits.snap] {
        values = values
            .windows(2)
            .map(|pair| (pair[1] - pair[0]) / CYCLE)
            .collect();
        resolved = 2.0 * resolved / CYCLE;
        for value in &values {
            assert!(
                value.abs() <= bound * (1.0 + 1e-9) + resolved,
                "{what} {limits:?}: {value:e} above {bound:e}"
            );
        }
    }
}

fn positions(plan: &StandardPlan) -> Vec<f64> {
    (0..u64::from(plan.scans()) + 4)
        .map(|scan| plan.at(scan).position)
        .collect()
}

#[test]
fn moves_and_ramps_do_not_jump_whatever_is_not_limited() {
    let planner = Standard::new(CYCLE);
    for limits in NO_LIMIT.into_iter().flat_map(sets) {
        for profile in MoveProfile::ALL {
            let rest = Setpoint::at_rest(3.0);
            let plan = planner
                .move_to(profile, &rest, 25.0, &limits, &limits)
                .expect("a plan");
            assert_eq!(plan.at(u64::from(plan.scans())).position, 25.0);
            keeps(&limits, &positions(&plan), profile.name());
        }
        let ramp = planner
            .ramp_to(&Setpoint::at_rest(0.0), 20.0, &limits, &limits)
            .expect("a plan");
        assert_eq!(ramp.at(u64::from(ramp.scans())).velocity, 20.0);
        keeps(&limits, &positions(&ramp), "ramp");
        // A take-over in the middle, and a stop from there.
        let start = ramp.at(u64::from(ramp.scans() / 2));
        let back = planner
            .move_to(MoveProfile::Online, &start, -5.0, &limits, &limits)
            .expect("a plan");
        keeps(&limits, &positions(&back), "take-over");
        let stop = planner.ramp_to(&start, 0.0, &limits, &limits).expect("a plan");
        keeps(&limits, &positions(&stop), "stop");
    }
}

/// A bound that limits nothing acts alike, however high it is, and the plan has the same order.
#[test]
fn every_bound_that_limits_nothing_acts_alike() {
    for (one, other) in sets(1e20).iter().zip(sets(f64::MAX)) {
        assert_eq!(one.acting(CYCLE), other.acting(CYCLE));
        assert_eq!(one.order(), one.acting(CYCLE).order());
    }
    assert_eq!(servo().acting(CYCLE), servo());
    assert_eq!(Limits::NONE.acting(CYCLE), Limits::NONE);
}

/// Eq. 39, worked out by hand: acceleration from rest to 50 in a 1024th of a scan, jerk to 200, snap to 2000.
#[test]
fn a_bound_acts_as_what_is_reached_in_a_1024th_of_a_scan() {
    let high = |bound: fn(&mut Limits) -> &mut f64| {
        let mut limits = servo();
        *bound(&mut limits) = 1e30;
        *bound(&mut limits.acting(CYCLE))
    };
    let near =
        |value: f64, expected: f64| assert!((value / expected - 1.0).abs() < 1e-12, "{value:e} {expected:e}");
    near(high(|limits| &mut limits.snap), 2000.0 * 1024.0 / CYCLE);
    // The snap of 40000 alone keeps the jerk below 4 sqrt(40000 * 200).
    near(
        high(|limits| &mut limits.jerk),
        4.0 * (40_000.0_f64 * 200.0).sqrt(),
    );
    // The jerk of 2000 alone keeps the acceleration below 4 sqrt(2000 * 50).
    near(
        high(|limits| &mut limits.acceleration),
        4.0 * (2000.0_f64 * 50.0).sqrt(),
    );
    near(
        high(|limits| &mut limits.velocity),
        200.0 * 2_147_483_648.0 * CYCLE,
    );
}

/// Pieces keep their durations, however late in a plan they are.
#[test]
fn the_last_piece_of_a_long_ramp_is_as_long_as_the_first() {
    let limits = Limits {
        acceleration: 0.02,
        deceleration: 0.02,
        jerk: 1e20,
        snap: f64::INFINITY,
        ..servo()
    };
    let ramp = RampPlan::new(&Setpoint::at_rest(0.0), 40.0, &limits, &limits, CYCLE).expect("a plan");
    let durations: Vec<f64> = ramp.segments().map(|segment| segment.duration).collect();
    assert_eq!(durations.len(), 3);
    assert_eq!(durations[0], durations[2]);
    let plan = OnlinePlan::new(&Setpoint::at_rest(0.0), 1e6, &limits, &limits, CYCLE).expect("a plan");
    assert_eq!(plan.at(u64::from(plan.scans())).position, 1e6);
}
