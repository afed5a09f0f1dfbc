//! What a random program does, its minutes repeat to the bit, and its scan script is one that runs.

use standstill_soak::monkey::{Failure, Scenario, Who, play, record, replay};
use standstill_soak::rules::Broken;

/// Runs the script of a scenario: whether its claims hold.
fn passes(scenario: &Scenario, failure: Option<&Failure>) -> bool {
    let text = scenario.script(failure);
    let script = standstill_script::read(&text, "random.scan.json", &[])
        .unwrap_or_else(|error| panic!("{error:?}\n{text}"));
    standstill_script::run(&script).expect("a run").passed()
}

#[test]
fn minutes_repeat_an_episode_and_are_a_script() {
    for number in 0..20 {
        let (seen, failure, scenario) = record(3, number, 600);
        assert_eq!(replay(&scenario), (seen, failure), "episode {number}");
        assert_eq!(failure, None);
        assert!(passes(&scenario, None));
    }
    assert_eq!(play(3, 5, 600).seen, play(3, 5, 600).seen);
    assert_ne!(play(3, 5, 600).seen.digest, play(4, 5, 600).seen.digest);
}

#[test]
fn the_script_of_a_failure_fails_where_it_happens() {
    let (_, _, scenario) = record(3, 0, 100);
    let states = standstill_axis::AxisState::ALL;
    // Whatever state the axis is in in the last scan, forbidding it must fail, and no other.
    let forbidding = |state| Failure {
        scan: 99,
        who: Who::Axis(0),
        broken: Broken {
            id: "S3",
            what: "the state changes along no arrow",
        },
        shown: None,
        state: Some(state),
    };
    let failing = states
        .iter()
        .filter(|state| !passes(&scenario, Some(&forbidding(**state))));
    assert_eq!(failing.count(), 1);
}
