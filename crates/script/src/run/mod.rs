//! The run of a script: bound once, then scan by scan through the executor into a trace.

mod bench;
mod cams;
pub(crate) mod cells;
mod drive;
mod formulas;
mod guests;
mod kept;
mod layout;
mod needed;
mod notes;
mod recorded;
mod rest;
mod row;
mod rows;
mod schedule;
mod session;
mod values;
mod variables;
mod witness;

pub use drive::Ordered;
pub(crate) use formulas::turned;
pub use guests::Counted;
pub use kept::Kept;
pub(crate) use needed::signals;
pub use recorded::{RecordingError, judge_recording};
pub(crate) use rows::{Derivatives, Rows};
use schedule::PENDING_MAX;
pub use session::{Ahead, Change, Session};
pub use variables::Shown;
pub use witness::Witness;

use crate::CELLS_MAX;
use crate::claims::{Failure, Verdict};
use crate::model::Script;
use crate::why::Reason;
use standstill_scan::{Executor, ProgramConfig, TaskConfig, Watchdog};
use standstill_trace::{Claim, ClaimFailure, ClaimVerdict, Trace};

/// Largest number of rows of a run that are kept for pictures.
pub const ROWS_MAX: u64 = 1_000_000;

/// Scans between two reports of progress.
const PROGRESS_EVERY: u64 = 1 << 14;

/// The result of a run.
#[derive(Clone, Debug)]
pub struct Outcome {
    /// One row for each scan; its header has the verdicts. If the rows of the run were dropped on the way, it has
    /// the last ones.
    pub trace: Trace,
    /// The script's claims in file order, judged.
    pub verdicts: Vec<Verdict>,
    /// The reasons why claims fail, the likeliest first; empty if all hold.
    pub why: Vec<Reason>,
    shifts: Vec<rows::Shift>,
    truths: formulas::Truths,
}

impl Outcome {
    /// Whether every claim is fulfilled.
    pub fn passed(&self) -> bool {
        self.verdicts.iter().all(Verdict::passed)
    }
}

/// The reason why a script could not be run to its end.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum RunError {
    /// The trace would not fit.
    #[error(
        "a trace of {scans} scans with {columns} columns is too large: {cells} cells at most; lower `scans`",
        cells = CELLS_MAX
    )]
    TooLarge {
        /// Requested rows.
        scans: u64,
        /// Columns of a row.
        columns: usize,
    },
    /// The configuration of an axis is not valid.
    #[error("axes.{axis}: {reason}")]
    Axis {
        /// Name of the axis.
        axis: String,
        /// The fault of it.
        reason: String,
    },
    /// A guest program cannot be started.
    #[error("programs.{program}: {reason}")]
    Program {
        /// Its name.
        program: String,
        /// The error.
        reason: String,
    },
    /// The configuration of the tasks is not valid.
    #[error("tasks: {0}")]
    Tasks(String),
    /// A pin was given a value it cannot hold.
    #[error("scan {scan}: {target} cannot hold {value}")]
    Value {
        /// The scan.
        scan: u64,
        /// The pin or task that the value was for.
        target: String,
        /// The value as text.
        value: String,
    },
    /// A step pushes an axis whose power is on; the ideal drive then holds its position.
    #[error(
        "steps[{step}], scan {scan}: {axis} is powered, so it cannot be displaced; switch its power off first"
    )]
    Displaced {
        /// Index of the step.
        step: usize,
        /// The scan.
        scan: u64,
        /// Name of the axis.
        axis: String,
    },
    /// More steps with `every` and `after` are pending than the run can store.
    #[error("scan {scan}: more than {PENDING_MAX} steps wait for their scan; lower their `after`")]
    Pending {
        /// The scan.
        scan: u64,
    },
    /// A defect of this program.
    #[error("internal: {0}")]
    Internal(String),
}

/// Runs a script to its end and judges its claims.
///
/// # Errors
/// [`RunError`]. A claim that fails is no error but a verdict.
pub fn run(script: &Script) -> Result<Outcome, RunError> {
    run_with(script, |_| {})
}

/// The same as [`run`]; reports the number of scans done from time to time.
///
/// # Errors
/// Those of [`run`].
pub fn run_with(script: &Script, mut progress: impl FnMut(u64)) -> Result<Outcome, RunError> {
    far_or_by_scan(|advance| run_by(script, &mut progress, advance))
}

/// How a run goes on, by at most so many scans: [`Session::advance_far`], or scan by scan.
pub type Advance = fn(&mut Session<'_>, u64) -> Result<Ahead, RunError>;

/// The result of a run that `run` continues by what it gets; it is called a second time, for a run scan by scan, if the
/// first one is [`Ahead::Broken`] and it returns none.
///
/// # Errors
/// Those of `run`.
pub fn far_or_by_scan<T>(mut run: impl FnMut(Advance) -> Result<Option<T>, RunError>) -> Result<T, RunError> {
    if let Some(outcome) = run(|session, most| session.advance_far(most))? {
        return Ok(outcome);
    }
    let outcome = run(|session, _| Ok(Ahead::Scans(session.advance()?.into())))?;
    outcome.ok_or_else(|| RunError::Internal("a run scan by scan did not go on".to_owned()))
}

/// A run that `advance` continues; none if that cannot run the script.
fn run_by(
    script: &Script,
    progress: &mut impl FnMut(u64),
    advance: Advance,
) -> Result<Option<Outcome>, RunError> {
    let mut session = Session::new(script)?;
    let mut told = 0;
    loop {
        match advance(&mut session, PROGRESS_EVERY)? {
            Ahead::Broken => return Ok(None),
            Ahead::Scans(0) => return Ok(Some(session.finish())),
            Ahead::Scans(_) => {}
        }
        let now = session.scans() / PROGRESS_EVERY;
        if now > told {
            told = now;
            progress(session.scans());
        }
    }
}

/// Whether the rows of a script's run fit into memory and can be read by a person: at most [`ROWS_MAX`]
/// of them with at most [`CELLS_MAX`] cells.
pub fn keeps_rows(script: &Script) -> bool {
    let columns = layout::header(script).columns().len() as u64;
    script.scans <= ROWS_MAX && script.scans.saturating_mul(columns) <= CELLS_MAX
}

/// Calls `look` with the rows of a script's own run.
pub(crate) fn rows_of(script: &Script, outcome: &Outcome, look: impl FnOnce(&Rows<'_>)) {
    look(&Rows {
        script,
        layout: &layout::Layout::new(script),
        trace: &outcome.trace,
        shifts: &outcome.shifts,
        truths: &outcome.truths,
    });
}

fn told(verdict: &Verdict) -> Claim {
    Claim {
        path: verdict.path.clone(),
        text: verdict.says.clone(),
        verdict: if verdict.passed() {
            ClaimVerdict::Passed
        } else {
            ClaimVerdict::Failed
        },
        scans: verdict.scans.map(|scans| scans.map(row)),
        held: verdict.held.map(row),
        failures: verdict.failures.iter().map(told_failure).collect(),
    }
}

fn told_failure(failure: &Failure) -> ClaimFailure {
    ClaimFailure {
        scan: failure.scan.map(row),
        text: failure.to_string(),
    }
}

/// A scan as the number of its row; a run has no more rows than memory.
fn row(scan: u64) -> usize {
    usize::try_from(scan).unwrap_or(usize::MAX)
}

/// One program for each task, in the order of the tasks: it calls the task's instances in file order. The last
/// program is for those without a task.
fn executor(script: &Script) -> Result<Executor, RunError> {
    let cycle_ns = script.cycle_ns.unsigned_abs();
    let tasks: Vec<_> = script
        .tasks
        .iter()
        .map(|task| {
            let interval_ns = task.interval.unwrap_or(0).saturating_mul(cycle_ns);
            TaskConfig {
                name: task.name.clone(),
                interval_ns,
                priority: task.priority,
                single: task.single.is_some(),
                // Nothing measures a script's programs, so the watchdog exists but never fires.
                watchdog: task.watchdog.map(|sensitivity| Watchdog {
                    limit_ns: interval_ns.max(cycle_ns),
                    sensitivity,
                }),
            }
        })
        .collect();
    let mut programs: Vec<_> = script
        .tasks
        .iter()
        .map(|task| ProgramConfig::with(&task.name, &task.name))
        .collect();
    let mut calls = script.programs.iter().flat_map(|program| &program.calls);
    if calls.any(|call| call.task.is_none()) {
        // No task has this name.
        programs.push(ProgramConfig::free("without a task"));
    }
    Executor::new(cycle_ns, &tasks, &programs).map_err(|error| RunError::Tasks(error.to_string()))
}
