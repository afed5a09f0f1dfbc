//! The record of a random program repeats its run to the bit, and its scan script runs.

mod programs;
mod wired;

use standstill_axis::{AxisConfig, Limits, Scaling, StartState};
use standstill_blocks::REGISTRY;
use standstill_blocks::registry::find;
use standstill_drives::mechanism::Plant;
use standstill_drives::simulated::{DriveSetup, PlantSetup};
use standstill_fb::{Group, Value};
use standstill_planner::VibrationMode;
use standstill_soak::monkey::{
    Action, AxisSetup, BlockSetup, Failure, Scenario, Step, TableSetup, Who, kind_of, play, record, replay,
    shrink_by,
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
    for number in 0..standstill_testkit::whole_or(20, 5) {
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
    for number in 0..standstill_testkit::whole_or(40, 8) {
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
    let mut scenario = record(3, 0, 10).2;
    scenario.axes[0].config.limits.velocity = f64::NAN;
    let (seen, failure) = replay(&scenario);
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

/// The index of a pin.
fn pin(block: &str, name: &str) -> usize {
    let info = find(block).expect("a block of the registry");
    info.pin(name).expect("one of its pins").0
}

/// An instance on axis 0 with these inputs.
fn instance(block: &'static str, inputs: &[(&str, Value)]) -> BlockSetup {
    BlockSetup {
        block,
        axis: 0,
        constants: inputs
            .iter()
            .map(|(name, value)| (pin(block, name), *value))
            .collect(),
        tables: Vec::new(),
    }
}

/// A motor that follows its set-point a scan late is faster than the axis may be when a torque takes over, and so
/// is the set-point. A stop from there would end outside the software limits if the speed grew as much once more,
/// so the axis stops.
#[test]
fn a_torque_takes_over_from_a_motor_that_is_too_fast() {
    let config = AxisConfig {
        start: StartState::Standstill,
        scaling: Scaling::new(1000, 360, false, 0.0).ok(),
        software_limits: Some((-10.0, f64::INFINITY)),
        ..AxisConfig::new(Limits {
            velocity: 30.0,
            acceleration: 700.0,
            deceleration: 200.0,
            ..Limits::NONE
        })
    };
    let mut drive = PlantSetup {
        plant: Plant {
            inertia: 1.8,
            viscous: 10.0,
            ..PlantSetup::NONE.plant
        },
        ..PlantSetup::NONE
    };
    drive.gains.position = 20.0;
    let on = ("Execute", Value::Bool(true));
    let scenario = Scenario {
        cycle_ns: 10_000_000,
        scans: 40,
        axes: vec![AxisSetup {
            config,
            drive: DriveSetup::Plant(drive.with_gains(0.01)),
        }],
        blocks: vec![
            instance("MC_MoveVelocity", &[on, ("Velocity", Value::Lreal(-20.0))]),
            instance("MC_TorqueControl", &[on, ("BufferMode", Value::Enum(1))]),
        ],
        steps: Vec::new(),
    };
    let (seen, failure) = replay(&scenario);
    assert_eq!((seen.scans, failure), (40, None));
    // The excess of its speed is recorded.
    assert_eq!(seen.turned_back, 1);
}

/// A completed profile stays completed while a superimposed motion is in the shaper. Its instance may be triggered
/// again and refused, and no block has to follow its motion.
#[test]
fn a_completed_profile_stays_so_on_a_shaped_axis() {
    let config = AxisConfig {
        start: StartState::Standstill,
        vibration: [Some(VibrationMode::new(7.4)), None],
        ..AxisConfig::new(Limits {
            velocity: 2.0,
            acceleration: 28.0,
            deceleration: 28.0,
            ..Limits::NONE
        })
    };
    let on = Value::Bool(true);
    let mut profile = instance(
        "MC_AccelerationProfile",
        &[("Execute", on), ("BufferMode", Value::Enum(1))],
    );
    profile.tables.push(TableSetup {
        pin: pin(profile.block, "TimeAcceleration"),
        records: vec![vec![1.3e9, -0.29, 0.0]],
    });
    let set = |scan, block, pin, value| Step {
        scan,
        action: Action::Set { block, pin, value },
    };
    let (added, execute) = (
        pin("MC_MoveSuperimposed", "Execute"),
        pin(profile.block, "Execute"),
    );
    let mode = pin(profile.block, "BufferMode");
    let scenario = Scenario {
        cycle_ns: 10_000_000,
        scans: 200,
        axes: vec![AxisSetup {
            config,
            drive: DriveSetup::default(),
        }],
        blocks: vec![
            instance(
                "MC_MoveSuperimposed",
                &[
                    ("Distance", Value::Lreal(-5.0)),
                    ("VelocityDiff", Value::Lreal(0.2)),
                ],
            ),
            profile,
        ],
        steps: vec![
            set(113, 1, execute, Value::Bool(false)),
            set(160, 0, added, on),
            set(161, 1, execute, on),
            set(162, 1, execute, Value::Bool(false)),
            set(163, 1, mode, Value::Enum(99)),
            set(163, 1, execute, on),
        ],
    };
    let (seen, failure) = replay(&scenario);
    assert_eq!((seen.scans, failure), (200, None));
    assert_eq!((seen.ended[0], seen.refused), (1, 1));
}

#[test]
fn the_script_of_a_failure_fails_where_it_happens() {
    let (_, _, scenario) = record(3, 0, 100);
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
        .filter(|state| !passes(&scenario, Some(&forbidding(**state))));
    assert_eq!(failing.count(), 1);
}

/// A rule that is broken whenever an MC_MoveVelocity is triggered: the rest is exactly that, as a script.
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
