//! The simulated node by its control words alone.

use standstill_drives::cia402::{
    Command, Inputs, Node, Outputs, Reaction, Settings, SimulatedNode, State, Statusword, TRANSITIONS,
};

/// One scan with a control word, with the actual position as target. Returns the inputs after it.
fn scan(node: &mut SimulatedNode, controlword: u16) -> Inputs {
    let target = node.position() as i32;
    scan_to(node, controlword, target)
}

fn scan_to(node: &mut SimulatedNode, controlword: u16, target_position: i32) -> Inputs {
    node.outputs(
        0,
        &Outputs {
            controlword,
            mode: 8,
            target_position,
            ..Outputs::default()
        },
    );
    node.inputs(0).expect("connected")
}

/// A node that has come to `state`, moving by 100 increments a scan where it has torque.
fn node_in(state: State, settings: Settings) -> SimulatedNode {
    let mut node = SimulatedNode::new(settings);
    let words: &[u16] = match state {
        State::NotReadyToSwitchOn => &[],
        State::SwitchOnDisabled => &[0],
        State::ReadyToSwitchOn => &[0, 6],
        State::SwitchedOn => &[0, 6, 7],
        _ => &[0, 6, 7, 15],
    };
    for word in words {
        scan(&mut node, *word);
    }
    if words.len() == 4 {
        for step in 1..=5 {
            scan_to(&mut node, 15, 100 * step);
        }
    }
    match state {
        State::QuickStopActive => {
            scan(&mut node, 2);
        }
        State::FaultReactionActive => {
            node.fail(7);
            scan(&mut node, 15);
        }
        State::Fault => {
            node.fail(7);
            for _ in 0..200 {
                scan(&mut node, 15);
            }
        }
        _ => {}
    }
    assert_eq!(node.state(), state);
    node
}

fn settings() -> Settings {
    Settings {
        deceleration: 10.0,
        ..Settings::default()
    }
}

/// Every state with every command. The table of transitions has the next state, and nothing else changes it.
///
/// Covers: CI-9
#[test]
fn commands_take_the_arrows_of_the_table_and_no_other() {
    let stay = Settings {
        quick_stop: Reaction::RampAndStay,
        ..settings()
    };
    for state in State::ALL {
        for word in 0..=0xff_u16 {
            if word & Command::FAULT_RESET != 0 {
                continue;
            }
            let mut node = node_in(state, stay);
            scan(&mut node, word);
            let arrow = TRANSITIONS
                .iter()
                .find(|arrow| arrow.from == state && arrow.command == Some(Command::of(word)));
            let expected = match (state, arrow) {
                // The self-test ends in this scan. The word then acts on the next state.
                (State::NotReadyToSwitchOn, _) if Command::of(word) == Command::Shutdown => {
                    State::ReadyToSwitchOn
                }
                (State::NotReadyToSwitchOn, _) => State::SwitchOnDisabled,
                (_, Some(arrow)) => arrow.to,
                (_, None) => state,
            };
            assert_eq!(node.state(), expected, "{word:#x} in {state:?}");
        }
    }
}

/// Covers: CI-9
#[test]
fn all_seventeen_transitions_are_taken() {
    let mut taken = 0;
    let stay = Settings {
        quick_stop: Reaction::RampAndStay,
        ..settings()
    };
    // 1 to 4, 5, 6, 7, and 10 by 0000h.
    for word in [7, 6, 0] {
        let mut node = node_in(State::OperationEnabled, settings());
        scan(&mut node, word);
        scan(&mut node, 6);
        scan(&mut node, 0);
        taken |= node.taken();
    }
    let mut node = node_in(State::SwitchedOn, settings());
    scan(&mut node, 0);
    taken |= node.taken();
    // 11 and 16, 11 and 12 by itself.
    let mut node = node_in(State::QuickStopActive, stay);
    scan(&mut node, 15);
    taken |= node.taken();
    let mut node = node_in(State::QuickStopActive, settings());
    for _ in 0..20 {
        scan(&mut node, 2);
    }
    assert_eq!(node.state(), State::SwitchOnDisabled);
    taken |= node.taken();
    // 13, 14, 15.
    let mut node = node_in(State::Fault, settings());
    node.clear_cause();
    scan(&mut node, 0);
    scan(&mut node, Command::FAULT_RESET);
    taken |= node.taken();
    // Transition 0 is the start.
    assert_eq!(taken, 0b1_1111_1111_1111_1110);
}

/// Covers: CI-4
#[test]
fn a_fault_is_reset_by_an_edge_once_its_cause_is_gone() {
    let mut node = node_in(State::Fault, settings());
    assert_eq!(scan(&mut node, Command::FAULT_RESET).error_code, 7);
    assert_eq!(node.state(), State::Fault, "the cause is there");
    node.clear_cause();
    scan(&mut node, Command::FAULT_RESET);
    assert_eq!(node.state(), State::Fault, "held, not an edge");
    scan(&mut node, 0);
    assert_eq!(scan(&mut node, Command::FAULT_RESET).error_code, 0);
    assert_eq!(node.state(), State::SwitchOnDisabled);
}

#[test]
fn it_comes_to_rest_as_its_reaction_says() {
    for (reaction, way) in [
        (Reaction::Coast, 0),
        (Reaction::Ramp, 500),
        (Reaction::RampAndStay, 500),
    ] {
        let mut node = node_in(
            State::OperationEnabled,
            Settings {
                quick_stop: reaction,
                ..settings()
            },
        );
        let from = node.position();
        let mut positions = vec![from];
        for _ in 0..20 {
            scan(&mut node, 2);
            positions.push(node.position());
        }
        // 100^2/(2*10)
        assert_eq!(node.position() - from, way, "{reaction:?}");
        assert!(
            positions
                .windows(2)
                .all(|pair| (0..=100).contains(&(pair[1] - pair[0])))
        );
        let expected = match reaction {
            Reaction::RampAndStay => State::QuickStopActive,
            Reaction::Coast | Reaction::Ramp => State::SwitchOnDisabled,
        };
        assert_eq!(node.state(), expected);
    }
}

#[test]
fn without_voltage_it_is_not_switched_on_and_without_remote_it_does_not_listen() {
    let mut node = node_in(State::OperationEnabled, settings());
    node.cut_power();
    assert_eq!(node.state(), State::SwitchOnDisabled);
    for word in [6, 7, 15] {
        let status = Statusword(scan(&mut node, word).statusword);
        assert_eq!(
            (status.state(), status.voltage()),
            (State::SwitchOnDisabled, false)
        );
    }
    node.clear_cause();
    node.set_remote(false);
    scan(&mut node, 6);
    assert_eq!(node.state(), State::SwitchOnDisabled);
    node.set_remote(true);
    scan(&mut node, 6);
    assert_eq!(node.state(), State::ReadyToSwitchOn);
}

#[test]
fn switches_follow_the_position() {
    let mut node = SimulatedNode::new(Settings {
        enabled: true,
        ends: Some((-50, 450)),
        home: Some((100, 200)),
        ..settings()
    });
    let mut seen = Vec::new();
    for target in [-50, -49, 99, 100, 200, 201, 449, 450] {
        let inputs = scan_to(&mut node, 15, target);
        let limited = Statusword(inputs.statusword).internal_limit();
        seen.push((inputs.digital_inputs, limited));
    }
    assert_eq!(
        seen,
        [
            (1, true),
            (0, false),
            (0, false),
            (4, false),
            (4, false),
            (0, false),
            (0, false),
            (2, true)
        ]
    );
}
