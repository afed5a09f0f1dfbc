//! Every case of tests/data/planner3-published.json.

use crate::support::{case, case_bounds, cases, close, number, same_profile};
use standstill_planner::Limits;
use standstill_planner::papers::{SCurve, Timed, Trapezoid};

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
