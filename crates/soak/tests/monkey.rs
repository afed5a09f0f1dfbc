//! The record of a random program repeats its run to the bit, and its scan script runs.

use standstill_axis::{AxisConfig, Limits, StartState};
use standstill_blocks::REGISTRY;
use standstill_blocks::registry::find;
use standstill_drives::simulated::DriveSetup;
use standstill_fb::{Group, Value};
use standstill_soak::monkey::{
    Action, AxisSetup, BlockSetup, Failure, Scenario, Step, Who, kind_of, play, record, replay, shrink_by,
};
use standstill_soak::rules::{Broken, Kind};
use std::collections::BTreeSet;

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

/// A run that leaves programs out of scans in which they would do nothing new has the same rows.
#[test]
fn programs_that_rest_may_be_left_out() {
    use standstill_script::{Ahead, Session};
    for number in 0..40 {
        let text = record(5, number, 400).2.script(None);
        let script = standstill_script::read(&text, "random.scan.json", &[])
            .unwrap_or_else(|error| panic!("{error:?}\n{text}"));
        let mut by_scan = Session::new(&script).expect("a run");
        while by_scan.advance().expect("a scan") {}
        let mut far = Session::new(&script).expect("a run");
        loop {
            match far.advance_far(100).expect("a scan") {
                Ahead::Broken => panic!("episode {number} was left out too long"),
                Ahead::Scans(0) => break,
                Ahead::Scans(_) => {}
            }
        }
        let (by_scan, far) = (by_scan.finish(), far.finish());
        assert_eq!(far.trace.scans(), by_scan.trace.scans());
        for scan in 0..far.trace.scans() {
            // By their text: a NaN is no other than itself.
            let row =
                |of: &standstill_script::Outcome| format!("{:?}", of.trace.row(scan).collect::<Vec<_>>());
            assert_eq!(row(&far), row(&by_scan), "episode {number}, scan {scan}");
        }
        assert_eq!(far.trace.notes(), by_scan.trace.notes(), "episode {number}");
    }
}

/// A block of the standard or of ours that moves something is played, and the rules know what it is: a new one that nobody told
/// them of fails here.
#[test]
fn every_block_is_played_and_known_to_the_rules() {
    let drawn: BTreeSet<&str> = (0..400)
        .flat_map(|number| record(11, number, 1).2.blocks)
        .map(|setup| setup.block)
        .collect();
    for info in REGISTRY.iter().filter(|info| info.group != Group::Standard) {
        assert!(drawn.contains(info.name), "{} is never drawn", info.name);
        assert_ne!(kind_of(info), Kind::Other, "{}: what is it?", info.name);
    }
}

/// The ring of records holds 64, and in one scan the coordinates of 70 axes move.
#[test]
fn seventy_axes_are_judged_as_one() {
    let limits = Limits {
        velocity: 10.0,
        acceleration: 100.0,
        deceleration: 100.0,
        ..Limits::NONE
    };
    let config = AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(limits)
    };
    let info = find("MC_SetPosition").expect("a block of the registry");
    let pin = |name| info.pin(name).expect("one of its pins").0;
    let axes = 0..70;
    let scenario = Scenario {
        cycle_ns: 1_000_000,
        scans: 10,
        axes: axes
            .clone()
            .map(|_| AxisSetup {
                config,
                drive: DriveSetup::default(),
            })
            .collect(),
        blocks: axes
            .clone()
            .map(|axis| BlockSetup {
                block: info.name,
                axis,
                constants: vec![(pin("Position"), Value::Lreal(1e3))],
                tables: Vec::new(),
            })
            .collect(),
        steps: axes
            .map(|block| Step {
                scan: 5,
                action: Action::Set {
                    block,
                    pin: pin("Execute"),
                    value: Value::Bool(true),
                },
            })
            .collect(),
    };
    let (seen, failure) = replay(&scenario);
    assert_eq!((seen.scans, failure), (10, None));
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

/// A rule that is broken whenever an MC_MoveVelocity is told to move: what is left is that, told as a script.
#[test]
fn what_does_not_matter_is_left_out() {
    let told_to_move = |scenario: &Scenario| {
        let told = scenario.steps.iter().find(|step| match step.action {
            Action::Set { block, value, .. } => {
                scenario.blocks[block].block == "MC_MoveVelocity" && value == Value::Bool(true)
            }
            Action::Fault { .. } | Action::Clear { .. } => false,
        });
        let failure = told.map(|step| Failure {
            scan: step.scan,
            who: Who::Axis(0),
            broken: Broken {
                id: "S3",
                what: "the state changes along no arrow",
            },
            shown: None,
            state: None,
        });
        (scenario.scans, failure)
    };
    let mut shrunk = 0;
    for number in 0..80 {
        let (_, _, scenario) = record(3, number, 400);
        let (_, Some(failure)) = told_to_move(&scenario) else {
            continue;
        };
        let (steps, blocks) = (scenario.steps.len(), scenario.blocks.len());
        let (failure, least) = shrink_by(failure, scenario, told_to_move);
        assert!(
            steps > 1 || blocks > 1,
            "episode {number} had nothing to leave out"
        );
        assert_eq!(
            (least.axes.len(), least.blocks.len(), least.steps.len()),
            (1, 1, 1),
            "{number}"
        );
        assert_eq!(least.blocks[0].block, "MC_MoveVelocity");
        assert_eq!(
            (least.scans, told_to_move(&least).1),
            (failure.scan + 1, Some(failure))
        );
        assert!(passes(&least, None));
        shrunk += 1;
    }
    assert!(shrunk >= 10, "{shrunk}");
}
