//! `standstill sweep`: a script with many values of its parameters.

use crate::apart;
use crate::args::SweepArguments;
use crate::cores;
use crate::exit::{Exit, Failure, complain};
use crate::limit;
use crate::progress::Progress;
use standstill_script::suite::shown;
use standstill_sweep::{Job, Judged, Part, Row, Rows, SweepError, merge, run, write};
use standstill_trace::digest::fnv1a;
use standstill_trace::file::replace;
use std::fmt;
use std::io::Write;
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Runs the sweep, or merges its shards, and prints how many cases passed.
pub fn sweep(arguments: &SweepArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    limit::doing(shown(&arguments.sweep));
    let reads = std::iter::once(&arguments.sweep).chain(&arguments.merge);
    let writes = apart::written("--output", arguments.output.as_deref());
    apart::checked(&writes, reads.map(PathBuf::as_path))?;
    let job = Job::load(&arguments.sweep, &arguments.outside.allowed())?;
    let (rows, part) = if arguments.merge.is_empty() {
        computed(&job, arguments)?
    } else {
        (merge(&job, &arguments.merge)?, None)
    };
    let mut table = Vec::new();
    write(job.columns(), &rows, &mut table)?;
    let tally = Tally::of(&job, &rows);
    match arguments.output.as_deref() {
        None => out.write_all(&table)?,
        Some(path) => {
            replace(path, |file| file.write_all(&table))?;
            if let Some(part) = part {
                part.remove()?;
            }
            let digest = fnv1a(&table);
            writeln!(out, "{}: {tally}, digest {digest:016x}", shown(path))?;
        }
    }
    Ok(tally.exit())
}

/// The rows of the shard, the number of those that an interrupted run left, and its part of a table.
fn computed(job: &Job, arguments: &SweepArguments) -> Result<(Rows, Option<Part>), Failure> {
    let all: Vec<u64> = arguments.shard.cases(job.count()).collect();
    let mut rows = Rows::new();
    let output = arguments.output.as_deref();
    let mut part = output
        .map(|path| Part::open(job, arguments.shard, path))
        .transpose()?;
    if let Some(part) = &mut part {
        rows = std::mem::take(&mut part.rows);
    }
    let kept = rows.len();
    if kept > 0 {
        complain(&format!(
            "{kept} of {} cases are there from an interrupted run",
            all.len()
        ));
    }
    let mut open = all.clone();
    open.retain(|case| !rows.contains_key(case));
    let threads = arguments.threads.map_or_else(cores::processors, usize::from);
    let (begin, mut progress, mut axis_scans) = (Instant::now(), Progress::new(true), 0_u64);
    run(job, &open, threads, |row: Row| {
        axis_scans += row.axis_scans;
        if let Some(part) = &mut part {
            part.add(&row)?;
        }
        rows.insert(row.case, row.fields);
        let done = rows.len() - kept;
        limit::doing(format!(
            "{}: {} of {} cases",
            shown(&arguments.sweep),
            rows.len(),
            all.len()
        ));
        progress.show(|| standing(rows.len(), all.len(), done, begin.elapsed()));
        Ok::<_, Failure>(())
    })?;
    progress.clear();
    let seconds = begin.elapsed().as_secs_f64();
    // The rate of a few cases would have no meaning.
    if seconds > 1.0 {
        let rate = axis_scans as f64 / seconds;
        complain(&format!(
            "{axis_scans} axis-scans in {seconds:.1} s, {rate:.2e} a second"
        ));
    }
    Ok((rows, part))
}

/// The progress, the rate, and the expected end.
fn standing(done: usize, all: usize, now: usize, elapsed: Duration) -> String {
    let rate = now as f64 / elapsed.as_secs_f64().max(1e-9);
    let left = (all - done) as f64 / rate.max(1e-9);
    format!("{done} of {all} cases, {rate:.0} a second, {left:.0} s left")
}

/// Cases by verdict.
#[derive(Debug, Default)]
struct Tally {
    cases: usize,
    failed: usize,
    refused: usize,
}

impl Tally {
    fn of(job: &Job, rows: &Rows) -> Self {
        let count = |judged| {
            rows.values()
                .filter(|row| job.judged(row) == Some(judged))
                .count()
        };
        Self {
            cases: rows.len(),
            failed: count(Judged::Failed),
            refused: count(Judged::Refused),
        }
    }

    const fn exit(&self) -> Exit {
        match (self.refused, self.failed) {
            (0, 0) => Exit::Passed,
            (0, _) => Exit::Failed,
            _ => Exit::BadInput,
        }
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            cases,
            failed,
            refused,
        } = self;
        let passed = cases - failed - refused;
        write!(
            out,
            "{cases} cases, {passed} passed, {failed} failed, {refused} refused"
        )
    }
}

impl From<SweepError> for Failure {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Suite(error) => error.into(),
            SweepError::Table { .. } => Self::Told(Exit::BadInput, format!("error: {error}")),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_line_tells_rate_and_time_left_of_this_run_alone() {
        // 900 of the cases were there before; 50 took 5 s.
        let line = standing(950, 1000, 50, Duration::from_secs(5));
        assert_eq!(line, "950 of 1000 cases, 10 a second, 5 s left");
    }
}
