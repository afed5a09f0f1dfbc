//! Scans against the least number any sequence of snaps needs, by linear programming.

use serde_json::Value;
use standstill_planner::{GridPlan, Limits, Method, OnlinePlan, Rung, Setpoint};

/// A case of the least-scans files: see `tests/data/README.md`.
struct Case {
    euler: bool,
    cycle: f64,
    limits: Limits,
    start: Setpoint,
    target: f64,
    end_velocity: f64,
    least: u32,
}

fn cases(text: &str) -> Vec<Case> {
    let list: Vec<Value> = serde_json::from_str(text).expect("JSON");
    list.iter()
        .map(|case| {
            let number = |key: &str| case[key].as_f64().expect("a number");
            Case {
                euler: case["chain"] == "euler",
                cycle: number("Ts"),
                limits: Limits {
                    velocity: number("V"),
                    acceleration: number("A"),
                    deceleration: number("A"),
                    jerk: number("J"),
                    snap: number("S"),
                },
                start: Setpoint {
                    position: number("x0"),
                    velocity: number("v0"),
                    acceleration: number("a0"),
                    jerk: number("j0"),
                    snap: 0.0,
                },
                target: number("target"),
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
            self.target,
            self.end_velocity,
            &self.limits,
            &self.limits,
            self.cycle,
        )
        .expect("a plan")
    }
}

fn check(text: &str) {
    let mut surplus = std::collections::BTreeMap::new();
    let mut failed = Vec::new();
    let mut overlapped_most = 0;
    for (index, case) in cases(text).iter().enumerate() {
        let plan = case.online();
        let more = i64::from(plan.scans()) - i64::from(case.least);
        *surplus.entry((case.euler, more)).or_insert(0) += 1;
        if more > 1 || plan.rung() != Rung::PushThenStop || plan.excess().is_some() {
            failed.push((index, more, plan.rung(), plan.excess()));
        }
        if case.euler && case.least <= 160 {
            let grid = GridPlan::new(
                Method::Overlapped,
                case.start.position,
                case.target,
                &case.limits,
                case.cycle,
            )
            .expect("a plan");
            overlapped_most = overlapped_most.max(i64::from(grid.scans()) - i64::from(case.least));
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
}

#[test]
fn passing_a_position_needs_at_most_one_scan_more_than_the_least() {
    check(include_str!("../data/least-scans-passing.json"));
}
