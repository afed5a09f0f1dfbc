//! Velocity and torque mode of a simulated node, the change between modes, and its touch probes, by process data alone.

use standstill_axis::{
    Drive, DriveCommand, DriveOrder, DrivePosition, DriveReport, DriveRequest, Edge, TorqueOrder,
};
use standstill_drives::cia402::{
    Cia402Drive, Inputs, MODE_CSP, MODE_CST, MODE_CSV, MotorLoad, Node, Outputs, ProbeFunction, ProbeStatus,
    Settings, SimulatedNode, TorqueScale,
};

/// Half a thousandth of the rated torque for 1 increment/scan^2; friction of 10 and of a hundredth a velocity.
const LOAD: MotorLoad = MotorLoad {
    inertia: 0.5,
    viscous: 0.01,
    coulomb: 10.0,
    most: 3000,
};

fn settings() -> Settings {
    Settings {
        enabled: true,
        load: Some(LOAD),
        deceleration: 10.0,
        ..Settings::default()
    }
}

fn scan(node: &mut SimulatedNode, outputs: Outputs) -> Inputs {
    let outputs = Outputs {
        controlword: 15,
        ..outputs
    };
    node.outputs(0, &outputs);
    node.inputs(0).expect("connected")
}

#[test]
fn in_velocity_mode_it_runs_at_its_target() {
    let mut node = SimulatedNode::new(settings());
    let outputs = Outputs {
        mode: MODE_CSV,
        target_velocity: -50_000,
        ..Outputs::default()
    };
    let positions: Vec<i32> = (0..4).map(|_| scan(&mut node, outputs).position).collect();
    // 50 increments in a scan of 1 ms. The first scan reaches the velocity.
    assert_eq!(positions, [-25, -75, -125, -175]);
    let inputs = scan(&mut node, outputs);
    assert_eq!((inputs.mode, inputs.velocity), (MODE_CSV, -50_000));
    assert_eq!(inputs.torque, -11, "friction at 50 increments a scan: 10 + 0.5");
}

#[test]
fn in_torque_mode_it_speeds_up_as_its_inertia_and_friction_say() {
    let mut node = SimulatedNode::new(settings());
    let torque = |target_torque: i16| Outputs {
        mode: MODE_CST,
        target_torque,
        ..Outputs::default()
    };
    for _ in 0..10 {
        // Less than the friction that holds it.
        assert_eq!(scan(&mut node, torque(9)).position, 0);
    }
    let mut velocity = 0.0;
    let mut position = 0.0;
    for _ in 0..200 {
        let inputs = scan(&mut node, torque(60));
        let next = (0.5 * velocity + 60.0 - 10.0) / 0.51;
        position += 0.5 * (velocity + next);
        velocity = next;
        assert!(
            (f64::from(inputs.position) - position).abs() <= 0.5,
            "{inputs:?}, {position}"
        );
        assert_eq!((inputs.mode, inputs.torque), (MODE_CST, 60));
    }
    assert!(velocity > 4000.0);
    // It does not hold more than 6072h.
    assert_eq!(scan(&mut node, torque(i16::MAX)).torque, 3000);
    // Without a load it does not know the mode, and stays in the one it has.
    let mut node = SimulatedNode::new(Settings {
        load: None,
        ..settings()
    });
    assert_eq!(scan(&mut node, torque(60)).mode, MODE_CSP);
}

/// A drive in torque mode at some velocity, then back. However long a node takes to change its mode, it keeps its
/// velocity, except for the friction in scans without torque.
///
/// Covers: CI-3, CI-7
#[test]
fn a_mode_that_is_acknowledged_late_makes_no_step() {
    for mode_change in 0..6_u32 {
        let mut drive = Cia402Drive::simulated_node(Settings {
            mode_change,
            ..settings()
        })
        .with_torque(TorqueScale {
            rated: 2.0,
            increments: -1000.0,
            // A quarter of the inertia in scans: 0.5 thousandths of 2 for 1 increment/scan^2.
            gain: 0.00025,
        });
        let mut steps = Vec::new();
        let mut held = Vec::new();
        let mut modes = Vec::new();
        let (mut before, mut own) = (0, 0);
        for scan in 0..200 {
            let feedback = drive.read(0);
            let mut report = DriveReport::default();
            drive.report(&mut report);
            let DrivePosition::Increments(actual) = feedback.position else {
                panic!("increments");
            };
            assert!(feedback.enabled, "a change of modes is no loss of operation");
            modes.push(drive.node_mut().inputs(0).expect("connected").mode);
            let torque = report.torque.expect("told");
            assert_eq!(torque.most, 6.0);
            if torque.actual != 0.0 {
                held.push((scan, torque.actual, torque.limited));
            }
            steps.push(actual - before);
            // Position mode at 20 increments a scan, then 0.1 of the torque, then position mode from the actual state.
            let under_torque = (50..120).contains(&scan);
            own = match scan {
                50..120 => actual,
                120 => actual + steps[120],
                121.. => own + steps[120],
                _ => own + 20,
            };
            before = actual;
            drive.order(&DriveOrder {
                torque: under_torque.then_some(TorqueOrder {
                    torque: -0.1,
                    velocity: (-1e3, 1e3),
                }),
                ..DriveOrder::default()
            });
            drive.write(
                0,
                &DriveCommand {
                    request: DriveRequest::Enable,
                    position: DrivePosition::Increments(own),
                    velocity: 0.0,
                    rename: None,
                },
            );
        }
        let late = mode_change as usize;
        assert_eq!(modes.iter().position(|mode| *mode == MODE_CST), Some(51 + late));
        let back = modes.iter().rposition(|mode| *mode == MODE_CST);
        assert_eq!(back, Some(120 + late));
        // The first torque acts two scans after the mode was acknowledged: -0.1 of the axis is 50 thousandths of the node.
        let first = held
            .iter()
            .find(|(scan, actual, _)| *scan > 50 && *actual == -0.1);
        assert_eq!(first, Some(&(52 + late, -0.1, false)));
        // On the change to torque mode it keeps its velocity, less the friction in the one scan without torque.
        for step in &steps[2..52 + late] {
            assert!((0..=20).contains(step), "{mode_change}: {step}");
        }
        // 50 thousandths less friction increase the speed by 0.5, which is less than 80 a scan. On the way back,
        // friction reduces the velocity by 19 in each scan until the mode is acknowledged. The scan after makes up
        // for the lost distance.
        let jumps = steps.windows(2).map(|pair| (pair[1] - pair[0]).abs());
        let allowed = 80 + 19 * i64::from((mode_change + 1) * mode_change);
        assert!(jumps.max().expect("many") <= allowed, "{mode_change}: {steps:?}");
    }
}

fn probing(function: u16, target_position: i32) -> Outputs {
    Outputs {
        mode: MODE_CSP,
        target_position,
        probe_function: function,
        ..Outputs::default()
    }
}

#[test]
fn a_probe_latches_both_edges_once_or_continuously() {
    const BOTH: u16 = ProbeFunction::ENABLE | ProbeFunction::RISING | ProbeFunction::FALLING;
    for (function, rising, falling) in [
        // The first pulse of each kind, or the last.
        (BOTH, 110, 160),
        (BOTH | ProbeFunction::CONTINUOUS, 225, 275),
        (ProbeFunction::ENABLE | ProbeFunction::RISING, 110, 0),
        (ProbeFunction::ENABLE | ProbeFunction::FALLING, 0, 160),
    ] {
        for probe in 0..2 {
            let word = function << (8 * probe);
            let mut node = SimulatedNode::new(settings());
            let told = |inputs: &Inputs| inputs.probe_status >> (8 * probe);
            assert_eq!(told(&scan(&mut node, probing(word, 0))), ProbeStatus::ENABLED);
            scan(&mut node, probing(word, 100));
            node.set_probe(probe, 0.1, true);
            node.set_probe(probe, 0.6, false);
            scan(&mut node, probing(word, 200));
            node.set_probe(probe, 0.75, false);
            node.set_probe(probe, 0.25, true);
            let inputs = scan(&mut node, probing(word, 300));
            assert_eq!(inputs.probe_positions[probe], [rising, falling], "{function:#x}");
            let stored = |bit: u16, position: i32| if position == 0 { 0 } else { bit };
            let expected = ProbeStatus::ENABLED
                | stored(ProbeStatus::RISING, rising)
                | stored(ProbeStatus::FALLING, falling);
            assert_eq!(told(&inputs), expected);
            assert_eq!(inputs.probe_positions[1 - probe], [0, 0]);
            // A disabled probe forgets its stored positions. A source that the node does not have arms nothing.
            assert_eq!(told(&scan(&mut node, probing(0, 400))), 0);
            let other = (function | 1 << 2) << (8 * probe);
            assert_eq!(told(&scan(&mut node, probing(other, 500))), 0);
        }
    }
}

/// Covers: V23
#[test]
fn the_adapter_disables_a_probe_before_it_arms_it_for_the_other_edge() {
    let mut drive = Cia402Drive::simulated_node(settings());
    let mut seen = Vec::new();
    for scan in 0..9 {
        drive.node_mut().set_probe(1, 0.5, scan % 2 == 0);
        drive.read(0);
        let mut report = DriveReport::default();
        drive.report(&mut report);
        let probe = report.probes[1];
        seen.push((probe.armed, probe.latched.is_some()));
        let edge = if scan < 4 { Edge::Rising } else { Edge::Falling };
        drive.order(&DriveOrder {
            probes: [None, Some(edge)],
            ..DriveOrder::default()
        });
        drive.write(
            0,
            &DriveCommand {
                request: DriveRequest::Enable,
                position: DrivePosition::Increments(0),
                velocity: 0.0,
                rename: None,
            },
        );
    }
    let expected = [
        (false, false),
        // Armed for the rising edge, which comes in even scans.
        (true, false),
        (true, true),
        (true, true),
        (true, true),
        // Disabled, then armed for the falling one, which comes in odd scans.
        (false, false),
        (true, false),
        (true, true),
        (true, true),
    ];
    assert_eq!(seen, expected);
}
