//! `standstill soak planner`: random replans without end, each held against what is claimed of plans.
//!
//! Replans come in chains, chains in batches. A chain follows from the seed and its number alone, and what
//! batches saw is added up in their order, so the figures depend neither on how many threads there are nor
//! on where a run was interrupted.

mod state;
mod tally;

use crate::exit::{Exit, Failure};
use crate::progress::Progress;
use standstill_soak::{Chain, judge};
use state::State;
use std::collections::BTreeMap;
use std::io::Write;
use std::path::Path;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::mpsc;
use std::thread;
use std::time::{Duration, Instant};
use tally::Tally;

/// Replans of a chain.
const LINKS: u64 = 20;

/// Chains of a batch.
const BATCH: u64 = 250;

/// Time between two writings of the state.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// Runs `count` replans, prints failing ones as `plan` lines and then the figures.
pub fn planner(seed: u64, count: u64, resume: Option<&Path>, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut state = match resume {
        Some(path) => State::read(path, seed)?,
        None => State::new(seed),
    };
    let chains = count / LINKS;
    if state.chains > chains {
        return Err(Failure::usage(&format!(
            "--count {count}: the run to resume has {} replans already",
            state.chains * LINKS
        )));
    }
    run(&mut state, chains, resume)?;
    if let Some(path) = resume {
        state.write(path)?;
    }
    // The last chain may be cut short; a longer run goes through all of it, so the state does without.
    let mut tally = state.tally;
    tally.add(chain(seed, chains, count % LINKS));
    for line in tally.lines() {
        writeln!(out, "{line}")?;
    }
    let failed = tally.failed;
    write!(out, "{tally}")?;
    writeln!(out, "seed {seed}: {} replans, {failed} failed", tally.replans())?;
    Ok(Exit::of(failed == 0))
}

/// Goes on until so many chains are done, on all processors.
fn run(state: &mut State, chains: u64, file: Option<&Path>) -> Result<(), Failure> {
    let (seed, first) = (state.seed, state.chains);
    let mut progress = Progress::new(true);
    let mut early = BTreeMap::new();
    let mut saved = Instant::now();
    let mut take = |begin: u64, tally: Tally| {
        early.insert(begin, tally);
        while let Some(tally) = early.remove(&state.chains) {
            state.chains = batch_end(state.chains, chains);
            state.tally.add(tally);
        }
        let (done, failed) = (state.chains * LINKS, state.tally.failed);
        progress.show(|| format!("{done} of {} replans, {failed} failed", chains * LINKS));
        if let Some(path) = file
            && saved.elapsed() >= SAVE_EVERY
        {
            state.write(path)?;
            saved = Instant::now();
        }
        Ok(())
    };
    let workers = thread::available_parallelism().map_or(1, |count| count.get());
    // Not every system has threads.
    if workers == 1 {
        let mut begin = first;
        while begin < chains {
            take(begin, batch(seed, begin, chains))?;
            begin = batch_end(begin, chains);
        }
        return Ok(());
    }
    let next = AtomicU64::new(first);
    let (send, receive) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..workers {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                loop {
                    let begin = next.fetch_add(BATCH, Ordering::Relaxed);
                    // Nobody listens any more once something went wrong.
                    if begin >= chains || send.send((begin, batch(seed, begin, chains))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        receive
            .into_iter()
            .try_for_each(|(begin, tally)| take(begin, tally))
    })
}

/// Where the batch that begins with this chain ends.
fn batch_end(begin: u64, chains: u64) -> u64 {
    chains.min(begin.saturating_add(BATCH))
}

/// The batch that begins with this chain.
fn batch(seed: u64, begin: u64, chains: u64) -> Tally {
    let mut tally = Tally::default();
    for number in begin..batch_end(begin, chains) {
        tally.add(chain(seed, number, LINKS));
    }
    tally
}

/// The first `links` replans of a chain.
fn chain(seed: u64, number: u64, links: u64) -> Tally {
    let mut tally = Tally::default();
    let mut chain = Chain::new(seed, number);
    for link in 0..links {
        let case = chain.next_case();
        let judged = case.plan().map_err(|error| error.to_string()).and_then(|plan| {
            let scan = chain.leave(&plan);
            let measured = judge(&case, &plan, scan)?;
            chain.follow(&plan, scan, measured.keeps);
            Ok((plan, measured))
        });
        match judged {
            Ok((plan, measured)) => tally.passed(&case, &plan, &measured),
            Err(what) => {
                tally.failed(&case, &format!("chain {number}, replan {link}: {what}"));
                chain.rest();
            }
        }
    }
    tally
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;
    use standstill_planner::Limits;
    use standstill_soak::{Case, Goal, Plan};

    /// The replans of some chains with their plans, and the scans at which they are left.
    fn replans(chains: u64) -> Vec<(Case, Plan, u64)> {
        let mut replans = Vec::new();
        for number in 0..chains {
            let mut chain = Chain::new(7, number);
            for _ in 0..LINKS {
                let case = chain.next_case();
                let plan = case.plan().expect("a plan");
                let scan = chain.leave(&plan);
                chain.follow(&plan, scan, false);
                replans.push((case, plan, scan));
            }
        }
        replans
    }

    #[test]
    fn every_replan_is_a_line_that_plans_the_same() {
        for (case, plan, _) in replans(30) {
            let line = case.line("x");
            let mut answer = Vec::new();
            let exit = plan::plan(&mut line.as_bytes(), "a line", None, &mut answer).expect("an answer");
            let answer: serde_json::Value = serde_json::from_slice(&answer).expect("JSON");
            assert_eq!(exit, Exit::Passed, "{line} {answer}");
            assert_eq!(answer["scans"], plan.scans(), "{line}");
            assert_eq!(answer["duration"], plan.duration(), "{line}");
            assert_eq!(
                answer["segments"].as_array().map(Vec::len),
                Some(plan.segments().len())
            );
        }
    }

    #[test]
    fn plans_that_break_a_claim_are_noticed() {
        let mut noticed = [0; 3];
        for (case, plan, scan) in replans(30) {
            if plan.excess().is_some() || plan.segments().is_empty() {
                continue;
            }
            let all = |factor: f64| Limits {
                velocity: case.limits.velocity * factor,
                acceleration: case.limits.acceleration * factor,
                deceleration: case.limits.deceleration * factor,
                jerk: case.limits.jerk * factor,
                snap: case.limits.snap * factor,
            };
            let slower = Case {
                limits: all(1.0 - 1e-6),
                before: all(1.0 - 1e-6),
                ..case
            };
            noticed[0] += u32::from(judge(&slower, &plan, scan).is_err());
            let way = case.limits.velocity * plan.duration();
            let elsewhere = match case.goal {
                Goal::Grid(target) => Goal::Grid(target + 1e-6 * way),
                Goal::Position(target) => Goal::Position(target + 1e-6 * way),
                Goal::Passing(target, velocity) => Goal::Passing(target + 1e-6 * way, velocity),
                Goal::Velocity(velocity) => Goal::Velocity(velocity + 1e-6 * case.limits.velocity),
            };
            let missed = Case {
                goal: elsewhere,
                ..case
            };
            noticed[1] += u32::from(judge(&missed, &plan, scan).is_err());
            let mut jumping = case;
            jumping.start.velocity += 1e-6 * case.limits.velocity;
            noticed[2] += u32::from(judge(&jumping, &plan, scan).is_err());
        }
        // Most plans touch some limit; all have one goal and one start.
        assert!(noticed[0] > 300 && noticed[1] > 400, "{noticed:?}");
        assert_eq!(noticed[1], noticed[2]);
    }

    #[test]
    fn failing_replans_become_lines() {
        let (case, ..) = replans(1).remove(0);
        let mut tally = Tally::default();
        for _ in 0..200 {
            tally.failed(&case, "chain 0, replan 0: it broke");
        }
        let mut sum = Tally::default();
        sum.add(tally);
        assert_eq!((sum.failed, sum.lines().count()), (200, 20));
        assert!(
            sum.lines()
                .all(|line| line.starts_with(r#"{"id":"chain 0, replan 0: it broke","method":""#))
        );
    }
}
