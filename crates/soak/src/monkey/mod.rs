//! A monkey at the pins of real blocks over real axes: random programs, and every rule checked in every
//! scan.
//!
//! An episode is a machine drawn at random and the actions of a monkey on it for some scans. The actions
//! are recorded, so an episode that breaks a rule can be repeated, made smaller and written as a scan
//! script.

mod draw;
mod hands;
mod run;
mod scenario;
mod script;
mod shrink;

pub use run::{Failure, Seen, Who};
pub use scenario::{Action, AxisSetup, BlockSetup, FaultKind, Scenario, Step, TableSetup, kind_of};
pub use shrink::{shrink, shrink_by};

use crate::random::Random;
use hands::{Monkey, Replay};

/// The result of an episode.
#[derive(Clone, Debug)]
pub struct Episode {
    /// The observations.
    pub seen: Seen,
    /// The first broken rule, and the scenario that breaks it.
    pub failure: Option<(Failure, Scenario)>,
}

/// Runs random inputs for `scans` scans; everything depends only on `seed` and `number`.
pub fn play(seed: u64, number: u64, scans: u64) -> Episode {
    let (seen, failure, scenario) = record(seed, number, scans);
    Episode {
        seen,
        failure: failure.map(|failure| (failure, scenario)),
    }
}

/// The same as [`play`], with the record in every case.
pub fn record(seed: u64, number: u64, scans: u64) -> (Seen, Option<Failure>, Scenario) {
    let mut random = Random::new(seed, number);
    let mut scenario = draw::scenario(&mut random, scans);
    let mut monkey = Monkey::new(&mut random, scenario.cycle());
    let (seen, failure) = run::run(&scenario, &mut monkey);
    scenario.steps = monkey.minutes;
    (seen, failure, scenario)
}

/// Runs a scenario with its own steps.
pub fn replay(scenario: &Scenario) -> (Seen, Option<Failure>) {
    run::run(scenario, &mut Replay::new(scenario))
}
