//! `standstill soak`: an endless series of random cases, each checked against the claims.
//!
//! Cases are grouped in chains, and chains in batches. A chain depends only on the seed and its number,
//! and results of batches are added in their order. So the figures do not depend on the number of
//! threads, or on interruptions of a run.

mod blocks;
mod planner;
mod state;
mod tally;

pub use blocks::blocks;
pub use planner::planner;

use crate::cores;
use crate::exit::Failure;
use crate::limit;
use crate::progress::Progress;
use serde::Serialize;
use serde::de::DeserializeOwned;
use state::State;
use std::path::Path;
use std::time::{Duration, Instant};

/// Time between two writings of the state.
const SAVE_EVERY: Duration = Duration::from_secs(5);

/// A kind of case, and the sum of its results.
trait Trial: Default + Send + Serialize + DeserializeOwned {
    /// The name of cases, in the plural.
    const CASES: &str;

    /// Cases of a chain.
    const LINKS: u64;

    /// Chains of a batch.
    const BATCH: u64;

    /// The first `links` cases of a chain.
    fn chain(seed: u64, number: u64, links: u64) -> Self;

    /// Adds later results.
    fn add(&mut self, later: Self);

    /// Cases that failed.
    fn failed(&self) -> u64;
}

/// The results of `count` cases.
fn soak<T: Trial>(seed: u64, count: u64, resume: Option<&Path>) -> Result<T, Failure> {
    let mut state = match resume {
        Some(path) => State::<T>::read(path, seed)?,
        None => State::new(seed),
    };
    let chains = count / T::LINKS;
    if state.chains > chains {
        return Err(Failure::usage(&format!(
            "--count {count}: the run to resume has {} {} already",
            state.chains * T::LINKS,
            T::CASES
        )));
    }
    run(&mut state, chains, resume)?;
    if let Some(path) = resume {
        state.write(path)?;
    }
    // The last chain may be cut short. A longer run goes through all of it, so it is not part of the
    // state.
    let mut tally = state.tally;
    let rest = count % T::LINKS;
    if rest > 0 {
        tally.add(T::chain(seed, chains, rest));
    }
    Ok(tally)
}

/// Continues until this many chains are done, on all processors.
fn run<T: Trial>(state: &mut State<T>, chains: u64, file: Option<&Path>) -> Result<(), Failure> {
    let (seed, first) = (state.seed, state.chains);
    let mut progress = Progress::new(true);
    let mut saved = Instant::now();
    let doing = |done: u64| limit::doing(format!("{done} of {} {}", chains * T::LINKS, T::CASES));
    doing(first * T::LINKS);
    let batches = (chains - first).div_ceil(T::BATCH);
    let batch = |index: usize| batch::<T>(seed, first + index as u64 * T::BATCH, chains);
    let take = |_, tally: Option<T>| {
        let Some(tally) = tally else { return Ok(()) };
        state.chains = batch_end::<T>(state.chains, chains);
        state.tally.add(tally);
        let (done, failed) = (state.chains * T::LINKS, state.tally.failed());
        doing(done);
        progress.show(|| format!("{done} of {} {}, {failed} failed", chains * T::LINKS, T::CASES));
        if let Some(path) = file
            && saved.elapsed() >= SAVE_EVERY
        {
            state.write(path)?;
            saved = Instant::now();
        }
        Ok(())
    };
    let batches = usize::try_from(batches).unwrap_or(usize::MAX);
    cores::in_order(batches, cores::processors(), batch, take)
}

/// The end of the batch that begins with this chain.
fn batch_end<T: Trial>(begin: u64, chains: u64) -> u64 {
    chains.min(begin.saturating_add(T::BATCH))
}

/// The batch that begins with this chain.
fn batch<T: Trial>(seed: u64, begin: u64, chains: u64) -> T {
    let mut tally = T::default();
    for number in begin..batch_end::<T>(begin, chains) {
        tally.add(T::chain(seed, number, T::LINKS));
    }
    tally
}
