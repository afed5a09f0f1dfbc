//! Every reachable state of one axis under any two motion blocks, MC_Stop and MC_Power.
//!
//! A breadth-first search tries, in every state, all inputs of the blocks and all events of the axis: faults, loss
//! of power, the end of their causes, MC_Reset.
//!
//! By default one of them changes in a scan, with four buffer modes, and each block is paired with the next one, the last
//! one with itself. With `STANDSTILL_SEARCH=pairs` in the environment, as in `.ci/run`, two change in a scan, and each
//! block is paired with every other. With `all` any number of them change, with every mode.
//!
//! The planner is a countdown behind its trait, so the number of states is finite; blocks and axis are the real
//! ones. The rules checked after every scan have their ids beside them in `rules.rs`. A violation is printed as a
//! scan script that reproduces it.

mod countdown;
mod rules;
mod script;
mod system;

use standstill_blocks::REGISTRY;
use standstill_soak::rules::Kind;
use std::collections::{BTreeSet, VecDeque};
use system::{Inputs, System};

/// The extent of a search.
#[derive(Debug)]
struct Reached {
    states: usize,
    scans: usize,
    depth: usize,
    complete: bool,
}

/// Searches from an axis in Standstill until nothing new is found or `most_states` are.
fn search(first: &'static str, second: &'static str, changes: usize, most_states: usize) -> Reached {
    let start = System::new(first, second, modes());
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

/// Whether this extent is requested.
fn asked_for(much: &str) -> bool {
    std::env::var("STANDSTILL_SEARCH").is_ok_and(|value| value == much)
}

/// Number of things that change in one scan: one, two, or all.
fn changes_at_once() -> usize {
    if asked_for("all") {
        usize::MAX
    } else if asked_for("pairs") {
        2
    } else {
        1
    }
}

/// Buffer modes besides mcAborting: waiting, and blending with the lower and the higher velocity; or all modes.
fn modes() -> &'static [u8] {
    if asked_for("all") {
        &[1, 2, 3, 4, 5]
    } else {
        &[1, 2, 5]
    }
}

/// Blocks of the registry that give commands, except MC_Stop, which is part of every pair.
fn kinds() -> Vec<&'static str> {
    REGISTRY
        .iter()
        .filter(|info| {
            let kind = Kind::of(info);
            matches!(kind, Kind::Motion | Kind::Jog) || kind.is_superimposed()
        })
        .map(|info| info.name)
        .collect()
}

/// The blocks that are tried with one, of itself and those after it: the next one, or all.
fn seconds<'k>(kinds: &'k [&'static str]) -> &'k [&'static str] {
    if changes_at_once() == 1 {
        kinds.get(1..2).unwrap_or(kinds)
    } else {
        kinds
    }
}

/// Every reachable state of every pair whose first block is `first`, except pairs that the search of the other
/// block covers.
fn all_states_with(first: &'static str) {
    let kinds = kinds();
    let place = kinds
        .iter()
        .position(|kind| *kind == first)
        .expect("a kind of command");
    for second in seconds(&kinds[place..]) {
        let reached = search(first, second, changes_at_once(), 200_000);
        println!("{first} and {second}: {reached:?}");
        assert!(
            reached.complete && reached.depth >= 8,
            "{first} and {second}: {reached:?}"
        );
    }
}

macro_rules! searches {
    ($($name:ident $kind:literal)*) => {
        $(
            #[test]
            fn $name() {
                all_states_with($kind);
            }
        )*

        /// All searches, to check that none is missing.
        const SEARCHED: &[&str] = &[$($kind),*];
    };
}

searches! {
    home_and_all_others "MC_Home"
    halt_and_all_after_it "MC_Halt"
    move_absolute_and_all_after_it "MC_MoveAbsolute"
    move_relative_and_all_after_it "MC_MoveRelative"
    move_additive_and_all_after_it "MC_MoveAdditive"
    move_velocity_and_all_after_it "MC_MoveVelocity"
    move_continuous_absolute_and_all_after_it "MC_MoveContinuousAbsolute"
    move_continuous_relative_and_all_after_it "MC_MoveContinuousRelative"
    move_superimposed_and_all_after_it "MC_MoveSuperimposed"
    halt_superimposed_and_all_after_it "MC_HaltSuperimposed"
    two_jogs "MC_Jog"
}

#[test]
fn every_command_of_the_registry_is_searched() {
    assert_eq!(kinds(), SEARCHED);
}

#[test]
fn a_broken_rule_is_found_and_printed_as_a_script() {
    // The search must find errors: with a rule that forbids Stopping it must give the shortest path there.
    let start = System::new("MC_MoveAbsolute", "MC_MoveVelocity", modes());
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
