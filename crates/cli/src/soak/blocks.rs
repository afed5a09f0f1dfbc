//! `standstill soak blocks`: random programs over random axes, with every rule checked in every scan.

use super::{Trial, soak};
use crate::exit::{Exit, Failure};
use serde::{Deserialize, Serialize};
use standstill_script::suite::shown;
use standstill_soak::monkey::{Seen, play, shrink};
use standstill_trace::file::replace_beside;
use std::fmt;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Failing episodes that are made smaller and kept as scripts. Further ones are only counted.
const KEPT: usize = 10;

/// The results of the episodes so far. The sum of two equals the result of all their episodes.
#[derive(Debug, Default, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Episodes {
    scans: u64,
    accepted: u64,
    /// Ended with Done, CommandAborted, Error.
    ended: [u64; 3],
    refused: u64,
    faults: u64,
    turned_back: u64,
    digest: u64,
    failed: u64,
    scripts: Vec<Script>,
}

/// A failing episode.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
struct Script {
    episode: u64,
    /// The rule it breaks.
    broken: String,
    text: String,
}

/// Runs `count` scans, writes failing episodes as scripts into `folder` and prints the figures.
pub fn blocks(
    seed: u64,
    count: u64,
    resume: Option<&Path>,
    folder: &Path,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let episodes: Episodes = soak(seed, count, resume)?;
    for script in &episodes.scripts {
        let path = folder.join(format!("{seed}-{}.scan.json", script.episode));
        fs::create_dir_all(folder).map_err(|error| Failure::io(&shown(folder), &error))?;
        replace_beside(&path, |out| out.write_all(script.text.as_bytes()))?;
        writeln!(out, "{}: {}", shown(&path), script.broken)?;
    }
    let failed = episodes.failed;
    write!(out, "{episodes}")?;
    writeln!(
        out,
        "seed {seed}: {} scans, {failed} episodes failed",
        episodes.scans
    )?;
    Ok(Exit::of(failed == 0))
}

impl Trial for Episodes {
    const CASES: &str = "scans";
    const LINKS: u64 = 2000;
    const BATCH: u64 = 20;

    fn chain(seed: u64, number: u64, links: u64) -> Self {
        let episode = play(seed, number, links);
        let Seen {
            scans,
            accepted,
            ended,
            refused,
            faults,
            turned_back,
            digest,
        } = episode.seen;
        let scripts = episode.failure.map(|(failure, program)| {
            let (failure, program) = shrink(failure, program);
            Script {
                episode: number,
                broken: format!("{} {}", failure.broken.id, failure.broken.what),
                text: program.claiming(&failure).text(),
            }
        });
        Self {
            scans,
            accepted,
            ended,
            refused,
            faults,
            turned_back,
            // A sum, so that the grouping of episodes does not matter; the number distinguishes equal
            // ones.
            digest: (digest ^ number).wrapping_mul(0x9e37_79b9_7f4a_7c15),
            failed: u64::from(scripts.is_some()),
            scripts: scripts.into_iter().collect(),
        }
    }

    fn add(&mut self, later: Self) {
        self.scans += later.scans;
        self.accepted += later.accepted;
        for (sum, later) in self.ended.iter_mut().zip(later.ended) {
            *sum += later;
        }
        self.refused += later.refused;
        self.faults += later.faults;
        self.turned_back += later.turned_back;
        self.digest = self.digest.wrapping_add(later.digest);
        self.failed += later.failed;
        self.scripts.extend(later.scripts);
        self.scripts.truncate(KEPT);
    }

    fn failed(&self) -> u64 {
        self.failed
    }
}

impl fmt::Display for Episodes {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [done, aborted, failed] = self.ended;
        writeln!(
            f,
            "commands        {} accepted, {} refused",
            self.accepted, self.refused
        )?;
        writeln!(
            f,
            "ended           {done} in Done, {aborted} in CommandAborted, {failed} in Error"
        )?;
        writeln!(f, "faults          {}", self.faults)?;
        writeln!(
            f,
            "turned back     {} stops in the middle of a reversal",
            self.turned_back
        )?;
        writeln!(f, "digest          {:016x}", self.digest)
    }
}
