//! `standstill soak planner`: random replans without end, each held against what is claimed of plans.
//!
//! Replans come in chains, chains in batches. A chain follows from the seed and its number alone, and what
//! batches saw is added up in their order, so the figures depend neither on how many threads there are nor
//! on where a run was interrupted.

mod cases;
mod follow;
mod judge;
mod random;
mod state;
mod tally;

use crate::exit::{Exit, Failure};
use crate::progress::Progress;
use cases::Chain;
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
    for line in &tally.lines {
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
    let workers = thread::available_parallelism().map_or(1, |count| count.get());
    let next = AtomicU64::new(first);
    let (send, receive) = mpsc::channel();
    thread::scope(|scope| {
        for _ in 0..workers {
            let (send, next) = (send.clone(), &next);
            scope.spawn(move || {
                loop {
                    let begin = next.fetch_add(BATCH, Ordering::Relaxed);
                    let end = chains.min(begin.saturating_add(BATCH));
                    // Nobody listens any more once something went wrong.
                    if begin >= chains || send.send((begin, end, batch(seed, begin..end))).is_err() {
                        return;
                    }
                }
            });
        }
        drop(send);
        let mut progress = Progress::new(true);
        let mut early = BTreeMap::new();
        let mut saved = Instant::now();
        for (begin, end, tally) in receive {
            early.insert(begin, (end, tally));
            while let Some((end, tally)) = early.remove(&state.chains) {
                state.chains = end;
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
        }
        Ok(())
    })
}

fn batch(seed: u64, chains: std::ops::Range<u64>) -> Tally {
    let mut tally = Tally::default();
    for number in chains {
        tally.add(chain(seed, number, LINKS));
    }
    tally
}

/// The first `links` replans of a chain.
fn chain(seed: u64, number: u64, links: u64) -> Tally {
    let mut tally = Tally::default();
    let mut chain = Chain::new(seed, number);
    for link in 0..links {
        let case = chain.next();
        let judged = case.plan().map_err(|error| error.to_string()).and_then(|plan| {
            let viable = plan.excess().is_none();
            let scan = chain.follow(&plan, viable);
            let measured = judge::judge(&case, &plan, scan)?;
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
