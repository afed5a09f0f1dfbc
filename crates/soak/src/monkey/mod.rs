//! A monkey at the pins of real blocks over real axes: random programs, and every rule checked in every
//! scan.
//!
//! A random program is a scan script: a machine drawn at random, and as steps what a monkey did to it. A run is that
//! of scripts, so a program that breaks a rule can be repeated and made smaller.

mod actor;
mod draw;
mod program;
mod run;
mod shrink;

pub use program::{Block, Program, kind_of};
pub use run::{Failure, Seen, Who};
pub use shrink::{shrink, shrink_by};

use crate::random::Random;
use actor::Monkey;
use standstill_script::model::{Action, Script};

/// The result of an episode.
#[derive(Clone, Debug)]
pub struct Episode {
    /// The observations.
    pub seen: Seen,
    /// The first broken rule, and the program that breaks it.
    pub failure: Option<(Failure, Program)>,
}

/// Runs random inputs for `scans` scans; everything depends only on `seed` and `number`.
pub fn play(seed: u64, number: u64, scans: u64) -> Episode {
    let (seen, failure, program) = record(seed, number, scans);
    Episode {
        seen,
        failure: failure.map(|failure| (failure, program)),
    }
}

/// The same as [`play`], with the program in every case.
pub fn record(seed: u64, number: u64, scans: u64) -> (Seen, Option<Failure>, Program) {
    let mut random = Random::new(seed, number);
    let mut program = draw::program(&mut random, scans);
    let Ok(script) = program.read() else {
        return (Seen::default(), Some(Failure::refused(0)), program);
    };
    let mut monkey = Monkey::new(&mut random, &script);
    let (mut seen, failure) = run::run(&script, |session| monkey.act(session));
    program.steps = monkey.minutes;
    seen.faults = program
        .steps
        .iter()
        .filter(|step| step.get("fault").is_some())
        .count() as u64;
    (seen, failure, program)
}

/// Runs a program with its own steps.
pub fn replay(program: &Program) -> (Seen, Option<Failure>) {
    program.read().map_or_else(
        |_| (Seen::default(), Some(Failure::refused(0))),
        |script| judge(&script),
    )
}

/// Runs a script and checks the rules in every scan.
pub fn judge(script: &Script) -> (Seen, Option<Failure>) {
    let (mut seen, failure) = run::run(script, |_| {});
    let actions = script.steps.iter().flat_map(|step| &step.actions);
    seen.faults = actions
        .filter(|action| matches!(action, Action::Fault { .. }))
        .count() as u64;
    (seen, failure)
}
