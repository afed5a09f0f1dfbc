//! Every reachable state of one axis under two motion blocks, MC_Stop and MC_Power.
//!
//! A breadth-first search tries, in every state, all inputs of the blocks and all events of the axis (faults,
//! loss of power, their causes gone, MC_Reset), at most two of them in one scan; with `STANDSTILL_SEARCH=all`
//! in the environment, any number of them. The
//! planner is a countdown behind its trait, so that the states are finitely many; blocks and axis are the
//! real ones. The rules checked after every scan have their ids beside them in `rules.rs`. A violation is
//! printed as a scan script that reproduces it.

mod countdown;
mod rules;
mod script;
mod system;

use std::collections::{BTreeSet, VecDeque};
use system::{Inputs, System};

/// How far a search went.
#[derive(Debug)]
struct Reached {
    states: usize,
    scans: usize,
    depth: usize,
    complete: bool,
}

/// Searches from an axis in Standstill until nothing new is found or `most_states` are.
fn search(first: &'static str, second: &'static str, changes: usize, most_states: usize) -> Reached {
    let start = System::new(first, second);
    let mut seen = BTreeSet::from([start.key()]);
    // How each state was reached: the place of the one before and the inputs of the scan.
    let mut trail: Vec<(usize, Inputs)> = vec![(usize::MAX, Inputs::default())];
    let mut queue = VecDeque::from([(start, 0_usize, 0_usize)]);
    let mut reached = Reached {
        states: 1,
        scans: 0,
        depth: 0,
        complete: true,
    };
    while let Some((system, place, depth)) = queue.pop_front() {
        reached.depth = reached.depth.max(depth);
        for inputs in system.choices(changes) {
            reached.scans += 1;
            let mut next = system.clone();
            if let Err(broken) = next.scan(&inputs) {
                let path = path_to(&trail, place, inputs);
                panic!("{broken}\n{}", script::print(first, second, &path));
            }
            if seen.len() >= most_states {
                reached.complete = false;
                continue;
            }
            if seen.insert(next.key()) {
                trail.push((place, inputs));
                queue.push_back((next, trail.len() - 1, depth + 1));
            }
        }
    }
    reached.states = seen.len();
    reached
}

fn path_to(trail: &[(usize, Inputs)], mut place: usize, last: Inputs) -> Vec<Inputs> {
    let mut path = vec![last];
    while let Some((before, inputs)) = trail.get(place)
        && *before != usize::MAX
    {
        path.push(*inputs);
        place = *before;
    }
    path.reverse();
    path
}

/// Things that change in one scan: two, or as many as there are with `STANDSTILL_SEARCH=all`.
fn changes_at_once() -> usize {
    if std::env::var("STANDSTILL_SEARCH").is_ok_and(|value| value == "all") {
        usize::MAX
    } else {
        2
    }
}

fn all_states(first: &'static str, second: &'static str) {
    let reached = search(first, second, changes_at_once(), 100_000);
    println!("{first} and {second}: {reached:?}");
    assert!(reached.complete && reached.depth >= 8, "{reached:?}");
}

#[test]
fn move_absolute_and_move_velocity() {
    all_states("MC_MoveAbsolute", "MC_MoveVelocity");
}

#[test]
fn two_absolute_moves() {
    all_states("MC_MoveAbsolute", "MC_MoveAbsolute");
}

#[test]
fn halt_and_move_velocity() {
    all_states("MC_Halt", "MC_MoveVelocity");
}

#[test]
fn home_and_move_absolute() {
    all_states("MC_Home", "MC_MoveAbsolute");
}

#[test]
fn superimposed_and_absolute_move() {
    all_states("MC_MoveSuperimposed", "MC_MoveAbsolute");
}

#[test]
fn velocity_and_superimposed_move() {
    all_states("MC_MoveVelocity", "MC_MoveSuperimposed");
}

#[test]
fn home_and_superimposed_move() {
    all_states("MC_Home", "MC_MoveSuperimposed");
}

#[test]
fn two_superimposed_moves() {
    all_states("MC_MoveSuperimposed", "MC_MoveSuperimposed");
}

#[test]
fn superimposed_move_and_its_halt() {
    all_states("MC_MoveSuperimposed", "MC_HaltSuperimposed");
}

#[test]
fn a_broken_rule_is_found_and_printed_as_a_script() {
    // The search is worth what it finds: with a rule that forbids Stopping it must give the shortest way there.
    let start = System::new("MC_MoveAbsolute", "MC_MoveVelocity");
    let stop = Inputs {
        stop: true,
        ..start.held()
    };
    let mut next = start.clone();
    next.scan(&stop).unwrap();
    assert_eq!(next.state(), standstill_axis::AxisState::Stopping);
    let text = script::print("MC_MoveAbsolute", "MC_MoveVelocity", &[stop]);
    assert!(
        text.contains("{\"at\": 1, \"set\": {\"stop.Execute\": true}}"),
        "{text}"
    );
}
