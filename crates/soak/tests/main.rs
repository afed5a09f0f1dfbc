//! A random program repeats its run to the bit, as a scan script does.

mod programs;
mod scripts;
mod wired;

use serde_json::{Value, json};
use standstill_blocks::REGISTRY;
use standstill_fb::Group;
use standstill_script::model::Script;
use standstill_soak::monkey::{Failure, Program, Who, judge, kind_of, play, record, replay, shrink_by};
use standstill_soak::rules::{Broken, Kind};
use std::collections::BTreeSet;

fn read(text: &str) -> Script {
    standstill_script::read(text, "random.scan.json", &[]).unwrap_or_else(|error| panic!("{error}\n{text}"))
}

/// Runs a program as a script: whether its claims hold.
fn passes(program: &Program) -> bool {
    standstill_script::run(&read(&program.text()))
        .expect("a run")
        .passed()
}

#[test]
fn minutes_repeat_an_episode_and_are_a_script() {
    for number in 0..standstill_testkit::whole_or(20, 5) {
        let (seen, failure, program) = record(3, number, 600);
        assert_eq!(replay(&program), (seen, failure), "episode {number}");
        assert_eq!(failure, None);
        assert!(passes(&program));
    }
    assert_eq!(play(3, 5, 600).seen, play(3, 5, 600).seen);
    assert_ne!(play(3, 5, 600).seen.digest, play(4, 5, 600).seen.digest);
}

/// A run that leaves programs out of scans in which they would do nothing new has the same rows.
#[test]
fn programs_that_rest_may_be_left_out() {
    use standstill_script::{Ahead, Session};
    for number in 0..standstill_testkit::whole_or(40, 8) {
        let script = read(&record(5, number, 400).2.text());
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
            // Compared as text: a NaN is then equal to itself.
            let row =
                |of: &standstill_script::Outcome| format!("{:?}", of.trace.row(scan).collect::<Vec<_>>());
            assert_eq!(row(&far), row(&by_scan), "episode {number}, scan {scan}");
        }
        assert_eq!(far.trace.notes(), by_scan.trace.notes(), "episode {number}");
    }
}

/// A program that cannot begin tests nothing.
#[test]
fn a_refused_program_is_a_failure() {
    let mut program = record(3, 0, 10).2;
    program.axes["X"]["velocity"] = json!("NaN");
    let (seen, failure) = replay(&program);
    assert_eq!(
        (seen.scans, failure.map(|failure| failure.broken.id)),
        (0, Some("refused"))
    );
}

/// Every block of the standard or of ours that moves something is played, and the rules know its kind. A new block
/// that they do not know fails here.
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

/// The ring of records holds 64, and the coordinates of 70 axes are shifted in one scan.
#[test]
fn seventy_axes_are_judged_as_one() {
    let axes = || (0..70).map(|axis| format!("A{axis:02}"));
    let limits = json!({"state": "Standstill", "limits": {"velocity": 10.0, "acceleration": 100.0}});
    let block = |axis: String| json!({"name": format!("Set{axis}"), "type": "MC_SetPosition", "pins": {"Axis": axis, "Position": 1e3}});
    let step = |axis| json!({"at": 5, "set": {(format!("Set{axis}.Execute")): true}});
    let script = json!({
        "standstill": 1,
        "cycle": "T#1ms",
        "scans": 10,
        "axes": axes().map(|axis| (axis, limits.clone())).collect::<serde_json::Map<_, _>>(),
        "blocks": axes().map(block).collect::<Value>(),
        "steps": axes().map(step).collect::<Value>(),
    });
    let (seen, failure) = judge(&read(&script.to_string()));
    assert_eq!((seen.scans, failure), (10, None));
}

/// A motor that follows its set-point a scan late is faster than the axis may be when a torque takes over, and so
/// is the set-point. A stop from there would end outside the software limits if the speed grew as much once more,
/// so the axis stops.
#[test]
fn a_torque_takes_over_from_a_motor_that_is_too_fast() {
    let script = json!({
        "standstill": 1,
        "cycle": "T#10ms",
        "scans": 40,
        "axes": {"X": {
            "state": "Standstill",
            "limits": {"velocity": 30.0, "acceleration": 700.0, "deceleration": 200.0},
            "scaling": {"increments": 1000, "units": 360},
            "software_limits": {"min": -10.0},
            "drive": {"plant": {"inertia": 1.8, "viscous": 10.0, "gains": {"position": 20.0}}},
        }},
        "blocks": [
            {"name": "Move", "type": "MC_MoveVelocity", "pins": {"Axis": "X", "Execute": true, "Velocity": -20.0}},
            {"name": "Torque", "type": "MC_TorqueControl", "pins": {
                "Axis": "X", "Execute": true, "BufferMode": "mcBuffered",
            }},
        ],
    });
    let (seen, failure) = judge(&read(&script.to_string()));
    assert_eq!((seen.scans, failure), (40, None));
    // The excess of its speed is recorded.
    assert_eq!(seen.turned_back, 1);
}

/// A completed profile stays completed while a superimposed motion is in the shaper. Its instance may be triggered
/// again and refused, and no block has to follow its motion.
#[test]
fn a_completed_profile_stays_so_on_a_shaped_axis() {
    let script = json!({
        "standstill": 1,
        "cycle": "T#10ms",
        "scans": 200,
        "axes": {"X": {
            "state": "Standstill",
            "limits": {"velocity": 2.0, "acceleration": 28.0},
            "vibration": [{"frequency": 7.4}],
        }},
        "blocks": [
            {"name": "Added", "type": "MC_MoveSuperimposed", "pins": {
                "Axis": "X", "Distance": -5.0, "VelocityDiff": 0.2,
            }},
            {"name": "Profile", "type": "MC_AccelerationProfile", "pins": {
                "Axis": "X", "Execute": true, "BufferMode": "mcBuffered",
                "TimeAcceleration": [{"DeltaTime": "T#1300ms", "Acceleration": -0.29}],
            }},
        ],
        "steps": [
            {"at": 113, "set": {"Profile.Execute": false}},
            {"at": 160, "set": {"Added.Execute": true}},
            {"at": 161, "set": {"Profile.Execute": true}},
            {"at": 162, "set": {"Profile.Execute": false}},
            {"at": 163, "set": {"Profile.BufferMode": 99, "Profile.Execute": true}},
        ],
    });
    let (seen, failure) = judge(&read(&script.to_string()));
    assert_eq!((seen.scans, failure), (200, None));
    assert_eq!((seen.ended[0], seen.refused), (1, 1));
}

#[test]
fn the_script_of_a_failure_fails_where_it_happens() {
    let program = record(3, 0, 100).2;
    let states = standstill_axis::AxisState::ALL;
    // Forbidding the state of the axis in the last scan must fail, for any state, and no other.
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
        .filter(|state| !passes(&program.clone().claiming(&forbidding(**state))));
    assert_eq!(failing.count(), 1);
}

/// A rule that is broken whenever an MC_MoveVelocity is triggered: the rest is exactly that, as a script.
#[test]
fn what_does_not_matter_is_left_out() {
    let told_to_move = |program: &Program, _: &Script| {
        let starts = |step: &&Value| {
            let mut moves = program
                .blocks
                .iter()
                .filter(|block| block.block == "MC_MoveVelocity");
            moves.any(|block| step["set"][format!("{}.Execute", block.name)] == json!(true))
        };
        let told = program.steps.iter().find(starts);
        let failure = told.map(|step| Failure {
            scan: step["at"].as_u64().expect("a scan"),
            who: Who::Axis(0),
            broken: Broken {
                id: "S3",
                what: "the state changes along no arrow",
            },
            shown: None,
            state: None,
        });
        (program.scans, failure)
    };
    let mut shrunk = 0;
    for number in 0..80 {
        let program = record(3, number, 400).2;
        let (_, Some(failure)) = told_to_move(&program, &program.read().expect("a script")) else {
            continue;
        };
        let (steps, blocks) = (program.steps.len(), program.blocks.len());
        let (failure, least) = shrink_by(failure, program, told_to_move);
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
            (
                least.scans,
                told_to_move(&least, &least.read().expect("a script")).1
            ),
            (failure.scan + 1, Some(failure))
        );
        assert!(passes(&least));
        shrunk += 1;
    }
    assert!(shrunk >= 10, "{shrunk}");
}
