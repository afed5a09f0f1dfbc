//! `standstill test`: scripts as tests, held against their claims and goldens.

use crate::exit::{Exit, Failure, go_on};
use crate::progress::Progress;
use standstill_script::golden::{Mode, Standing};
use standstill_script::suite::{self, Report};
use std::fmt;
use std::io::Write;
use std::path::PathBuf;

/// Judges all scripts at the paths, in sorted order, and reports goldens that have no script any more.
pub fn test(paths: &[PathBuf], accept: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mode = Mode::from_environment(accept).map_err(|error| Failure::usage(&error.to_string()))?;
    let mut tally = Tally::default();
    for path in paths {
        let scripts = suite::find(path)?;
        if scripts.is_empty() {
            let message = format!(
                "{}: there is no {} file in it",
                suite::shown(path),
                suite::EXTENSION
            );
            return Err(Failure::usage(&message));
        }
        let mut progress = Progress::new(true);
        for (index, script) in scripts.iter().enumerate() {
            let name = suite::shown(script);
            let place = format!("{} of {}: {name}", index + 1, scripts.len());
            progress.show(|| place.clone());
            let told = |scans| progress.show(|| format!("{place}, {scans} scans"));
            let judged = suite::judge_file(script, mode, told);
            progress.clear();
            match judged {
                Ok(report) => tally.judged(&name, &report, out)?,
                Err(error) => tally.broken(&name, error.into(), out)?,
            }
        }
        if path.is_dir() {
            tally.orphans(&suite::orphans(path)?, out)?;
        }
    }
    writeln!(out, "{tally}")?;
    Ok(tally.exit())
}

/// What came of the scripts so far.
#[derive(Debug, Default)]
struct Tally {
    passed: usize,
    accepted: usize,
    failed: usize,
    /// How those ended that could not be judged.
    broken: Vec<Exit>,
    orphans: usize,
}

impl Tally {
    fn judged(&mut self, name: &str, report: &Report, out: &mut dyn Write) -> Result<(), Failure> {
        let (count, word) = match (&report.golden, report.passed()) {
            (_, false) | (Standing::Failed(_), _) => (&mut self.failed, "FAILED"),
            (Standing::Accepted, true) => (&mut self.accepted, "accepted"),
            (Standing::Same, true) => (&mut self.passed, "ok"),
        };
        *count += 1;
        writeln!(out, "{word:<8}  {name}")?;
        for line in report.to_string().lines() {
            writeln!(out, "    {line}")?;
        }
        Ok(())
    }

    fn broken(&mut self, name: &str, failure: Failure, out: &mut dyn Write) -> Result<(), Failure> {
        writeln!(out, "BROKEN    {name}")?;
        self.broken.push(go_on(Err(failure), out)?);
        Ok(())
    }

    fn orphans(&mut self, orphans: &[PathBuf], out: &mut dyn Write) -> Result<(), Failure> {
        self.orphans += orphans.len();
        for orphan in orphans {
            writeln!(
                out,
                "ORPHAN    {}\n    its script is not there any more",
                suite::shown(orphan)
            )?;
        }
        Ok(())
    }

    fn exit(&self) -> Exit {
        let judged = Exit::of(self.failed == 0 && self.orphans == 0);
        self.broken.iter().copied().fold(judged, Exit::max)
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            passed,
            accepted,
            failed,
            broken,
            orphans,
        } = self;
        let scripts = passed + accepted + failed + broken.len();
        let counts = [
            (*passed, "passed"),
            (*accepted, "accepted"),
            (*failed, "failed"),
            (broken.len(), "broken"),
            (*orphans, "orphaned"),
        ];
        let counts = counts.iter().filter(|(count, _)| *count > 0);
        let counts: Vec<_> = counts.map(|(count, what)| format!("{count} {what}")).collect();
        let plural = if scripts == 1 { "" } else { "s" };
        write!(f, "{scripts} script{plural}: {}", counts.join(", "))
    }
}
