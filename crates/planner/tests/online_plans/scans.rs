//! Scans against the least number that any sequence of snaps needs, by linear programming.

use serde_json::Value;
use standstill_planner::{GridPlan, Limits, Method, OnlinePlan, RampPlan, Rung, Setpoint};
use std::collections::BTreeMap;

/// Most scans above the least from outside lowered limits.
const MOST_FROM_OUTSIDE: i64 = 8;

/// A case of the least-scans files: see `tests/data/README.md`.
struct Case {
    euler: bool,
    cycle: f64,
    limits: Limits,
    /// The limits that the start kept; lower ones replaced them in flight.
    before: Limits,
    start: Setpoint,
    /// None if only the end velocity is asked for.
    target: Option<f64>,
    end_velocity: f64,
    least: u32,
}

fn cases(text: &str) -> Vec<Case> {
    let list: Vec<Value> = serde_json::from_str(text).expect("JSON");
    list.iter()
        .map(|case| {
            let number = |key: &str| case[key].as_f64().expect("a number");
            let limits = |of: &Value| {
                let bound = |key: &str| of[key].as_f64().expect("a bound");
                Limits {
                    velocity: bound("V"),
                    acceleration: bound("A"),
                    deceleration: bound("A"),
                    jerk: bound("J"),
                    snap: bound("S"),
                }
            };
            Case {
                euler: case["chain"] == "euler",
                cycle: number("Ts"),
                limits: limits(case),
                before: limits(case.get("before").unwrap_or(case)),
                start: Setpoint {
                    position: number("x0"),
                    velocity: number("v0"),
                    acceleration: number("a0"),
                    jerk: number("j0"),
                    snap: 0.0,
                },
                target: case["target"].as_f64(),
                end_velocity: case["ve"].as_f64().unwrap_or(0.0),
                least: case["n_star"].as_u64().expect("n_star") as u32,
            }
        })
        .collect()
}

impl Case {
    fn online(&self) -> OnlinePlan {
        OnlinePlan::passing(
            &self.start,
            self.target.expect("a target"),
            self.end_velocity,
            &self.limits,
            &self.before,
            self.cycle,
        )
        .expect("a plan")
    }
}

/// How many scans a plan takes more than the least.
fn above(scans: u32, case: &Case) -> i64 {
    i64::from(scans) - i64::from(case.least)
}

fn check(text: &str) {
    let mut surplus = BTreeMap::new();
    let mut failed = Vec::new();
    let mut overlapped_most = 0;
    for (index, case) in cases(text).iter().enumerate() {
        let plan = case.online();
        let more = above(plan.scans(), case);
        *surplus.entry((case.euler, more)).or_insert(0) += 1;
        if more > 1 || plan.rung() != Rung::PushThenStop || plan.excess().is_some() {
            failed.push((index, more, plan.rung(), plan.excess()));
        }
        if case.euler && case.least <= 160 {
            let grid = GridPlan::new(
                Method::Overlapped,
                case.start.position,
                case.target.expect("a target"),
                &case.limits,
                case.cycle,
            )
            .expect("a plan");
            overlapped_most = overlapped_most.max(above(grid.scans(), case));
        }
    }
    println!(
        "(from rest, more scans than the least): cases {surplus:?}; overlapped at most {overlapped_most} more"
    );
    assert!(failed.is_empty(), "{} {failed:?}", failed.len());
    assert!(overlapped_most <= 4);
}

#[test]
fn the_reference_cases_need_at_most_one_scan_more_than_the_least() {
    check(include_str!("../data/min-scans.json"));
}

#[test]
fn random_cases_need_at_most_one_scan_more_than_the_least() {
    check(include_str!("../data/least-scans-a.json"));
    check(include_str!("../data/least-scans-b.json"));
    check(include_str!("../data/least-scans-c.json"));
}

#[test]
fn passing_a_position_needs_at_most_one_scan_more_than_the_least() {
    check(include_str!("../data/least-scans-passing.json"));
}

#[test]
fn a_velocity_is_reached_with_no_more_scans_than_the_least() {
    check_ramps(include_str!("../data/least-scans-ramps.json"));
}

#[test]
fn rest_is_reached_with_no_more_scans_than_the_least() {
    check_ramps(include_str!("../data/least-scans-stops.json"));
}

fn check_ramps(text: &str) {
    let mut surplus = BTreeMap::new();
    let cases = cases(text);
    assert_eq!(cases.len(), 100);
    for case in &cases {
        let plan = RampPlan::new(
            &case.start,
            case.end_velocity,
            &case.limits,
            &case.limits,
            case.cycle,
        )
        .expect("a plan");
        assert_eq!(plan.excess(), None);
        *surplus.entry(above(plan.scans(), case)).or_insert(0) += 1;
    }
    println!("more scans than the least to a velocity: cases {surplus:?}");
    assert!(surplus.keys().all(|more| *more <= 0));
}

/// From outside the lowered limits, coming inside has priority, by rules that the programme does not have. The docs
/// say how the two differ.
#[test]
fn under_lowered_limits_a_plan_needs_few_scans_more_than_the_least() {
    let (mut inside, mut outside) = (BTreeMap::new(), BTreeMap::new());
    let cases = cases(include_str!("../data/least-scans-lowered.json"));
    assert_eq!(cases.len(), 100);
    for case in &cases {
        let plan = case.online();
        let surplus = match plan.excess() {
            None => &mut inside,
            Some(_) => &mut outside,
        };
        *surplus.entry(above(plan.scans(), case)).or_insert(0) += 1;
    }
    println!("more scans than the least under lowered limits: inside them {inside:?}, outside {outside:?}");
    assert!(inside.keys().all(|more| *more <= 1));
    assert!(outside.keys().all(|more| *more <= MOST_FROM_OUTSIDE));
}
