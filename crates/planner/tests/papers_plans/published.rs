//! Every case of tests/data/planner3-published.json.

use crate::support::{bounds, case, case_bounds, cases, close, number, numbers, same_profile};
use serde_json::Value;
use standstill_planner::Limits;
use standstill_planner::papers::{SCurve, ShortPath, ShortPathPolicy, Timed, Trapezoid};

#[test]
fn s_curves_are_those_of_the_corrected_paper() {
    for case in cases("blejan") {
        let plan = SCurve::new(0.0, number(&case["input"]["s"]), &case_bounds(&case)).expect("a plan");
        let expected = &case["expected"];
        let labels = expected["case_any_of"].as_array().expect("a list");
        assert!(
            labels.iter().any(|label| label == plan.case().name()),
            "{}",
            case["id"]
        );
        let times = plan.times();
        close(&case, "t_j", times.jerk, number(&expected["t_j"]));
        close(&case, "t_a", times.acceleration, number(&expected["t_a"]));
        close(&case, "t_v", times.velocity, number(&expected["t_v"]));
        same_profile(&case, &expected["profile"], plan.profile(), [0.0; 3]);
    }
}

#[test]
fn timed_moves_are_those_of_the_corrected_paper() {
    for case in cases("garcia") {
        let input = &case["input"];
        let [theta, duration, gamma, phi] = ["theta", "T", "gamma", "phi"].map(|key| number(&input[key]));
        let plan = Timed::new(0.0, theta, duration, gamma, phi, &Limits::NONE).expect("a plan");
        let expected = &case["expected"];
        let peaks = plan.profile().peaks();
        close(&case, "v", peaks.velocity, number(&expected["v"]).abs());
        close(&case, "a", peaks.acceleration, number(&expected["a"]).abs());
        close(&case, "j", peaks.jerk, number(&expected["j"]).abs());
        close(&case, "T_jerk", plan.times().jerk, number(&expected["T_jerk"]));
        same_profile(&case, &expected["profile"], plan.profile(), [0.0; 3]);
    }
}

#[test]
fn the_trapezoid_is_that_of_the_paper() {
    let case = case("garcia-trapezoid");
    let input = &case["input"];
    let limits = Limits {
        velocity: number(&input["V"]),
        ..Limits::NONE
    };
    let plan = Trapezoid::timed(0.0, number(&input["theta"]), number(&input["T"]), &limits).expect("a plan");
    let segments: Vec<_> = plan.profile().segments().collect();
    let expected = &case["expected"];
    close(&case, "T_acc", segments[0].duration, number(&expected["T_acc"]));
    close(&case, "a", segments[0].acceleration, number(&expected["a"]));
    close(&case, "T", plan.profile().duration(), number(&input["T"]));
    close(&case, "v", plan.profile().peaks().velocity, number(&input["V"]));
}

fn short_path(input: &Value, from: &str, to: &str, policy: ShortPathPolicy) -> ShortPath {
    let [s, v_s, v_e, v_cf, a, j] = ["s", from, to, "v_cf", "A", "J"].map(|key| number(&input[key]));
    ShortPath::new(0.0, v_s, s, v_e, &bounds(v_cf, a, j), policy).expect("a plan")
}

fn same_short_path(case: &Value, expected: &Value, plan: &ShortPath, v_s: f64) {
    assert_eq!(expected["type"], plan.kind().name(), "{}", case["id"]);
    close(case, "V", plan.peak_velocity(), number(&expected["V"]));
    close(case, "v_e", plan.end_velocity(), number(&expected["v_e_reached"]));
    close(
        case,
        "T",
        plan.profile().duration(),
        number(&expected["total_time"]),
    );
    same_profile(case, &expected["profile"], plan.profile(), [0.0, v_s, 0.0]);
}

#[test]
fn short_paths_are_those_of_the_corrected_paper() {
    for case in cases("bui") {
        let (input, expected) = (&case["input"], &case["expected"]);
        let v_s = number(&input["v_s"]);
        let paper = short_path(input, "v_s", "v_e", ShortPathPolicy::Paper);
        same_short_path(&case, expected, &paper, v_s);
        let nearest = short_path(input, "v_s", "v_e", ShortPathPolicy::Nearest);
        match expected.get("policy_nearest") {
            Some(expected) => same_short_path(&case, expected, &nearest, v_s),
            None => assert_eq!(nearest, paper, "{}", case["id"]),
        }
        // Where the paper misprints a velocity, its numbers are those of the meant one; the misprinted one
        // gives others.
        if let Some(expected) = case.get("expected_for_printed_input") {
            let mut printed = input.clone();
            printed["v_s"] = case["published"]["v_s"].clone();
            printed["v_e"] = case["published"]["v_e"].clone();
            let plan = short_path(&printed, "v_s", "v_e", ShortPathPolicy::Paper);
            same_short_path(&case, expected, &plan, number(&printed["v_s"]));
        }
    }
}

/// The path lengths at which the paper's types meet: right there the peak is the stated velocity.
#[test]
fn short_path_types_meet_where_the_paper_says() {
    for case in cases("bui_path_length") {
        let input = &case["input"];
        let [v_s, v_e, a, j] = ["v_s", "v_e", "A", "J"].map(|key| number(&input[key]));
        let printed = numbers(&case["published"]["S"]);
        let lengths = numbers(&case["expected"]["S"]);
        for ((peak, length), printed) in numbers(&input["V"]).iter().zip(&lengths).zip(printed) {
            let limits = bounds(1.0, a, j);
            let plan =
                ShortPath::new(0.0, v_s, *length, v_e, &limits, ShortPathPolicy::Paper).expect("a plan");
            let base = v_s.max(v_e);
            // At the larger velocity itself the excess is a square root of what rounding left.
            let slack = if *peak > base { 1e-12 } else { 1e-9 };
            let off = (plan.peak_velocity() - peak).abs();
            assert!(off <= slack, "{}: {} {peak}", case["id"], plan.peak_velocity());
            assert!((length - printed).abs() <= number(&case["tolerance"]["published_abs"]));
        }
    }
}
