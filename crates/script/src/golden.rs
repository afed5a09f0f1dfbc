//! Goldens: whether a run is equal to the reviewed one, and who may accept a new one.
//!
//! The golden of `x.scan.json` is the insta snapshot `x.snap` beside it, with every exact bit in
//! `x.exact`. A golden is a record of a reviewed version, never a claim; a script whose claims fail gets
//! none.

use crate::run::Outcome;
use crate::why::Reason;
use standstill_trace::compare::{Closeness, Yardstick};
use standstill_trace::golden::{self, GoldenError, Verdict};
use standstill_trace::story::{Cause, story};
use standstill_trace::{Role, Trace};
use std::path::{Path, PathBuf};

/// The permitted changes of goldens.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// Writes nothing, as in continuous integration.
    Check,
    /// A golden that is missing or differs fails, and is proposed as `x.snap.new` for review, with
    /// cargo-insta or by hand. An exact trace that does not belong to its snapshot is written anew.
    Propose,
    /// Replaces goldens by the run, if all claims hold.
    Accept,
}

/// Goldens cannot be accepted if the environment has `CI`.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
#[error("goldens are not accepted under CI: accept where you can review them, and unset CI there")]
pub struct UnderCi;

impl Mode {
    /// The mode set by the environment: `CI` (unless empty, `0` or `false`) and `INSTA_UPDATE=no` write
    /// nothing, `INSTA_UPDATE=always` accepts, everything else proposes. `accept` is the user's own
    /// request.
    ///
    /// # Errors
    /// [`UnderCi`] if the user wishes to accept there.
    pub fn from_environment(accept: bool) -> Result<Self, UnderCi> {
        let variable = |name| std::env::var(name).unwrap_or_default();
        Self::of(&variable("CI"), &variable("INSTA_UPDATE"), accept)
    }

    fn of(ci: &str, insta_update: &str, accept: bool) -> Result<Self, UnderCi> {
        let under_ci = !matches!(ci, "" | "0" | "false");
        match (under_ci, accept, insta_update) {
            (true, true, _) => Err(UnderCi),
            (true, false, _) | (false, false, "no") => Ok(Self::Check),
            (false, true, _) | (false, false, "always") => Ok(Self::Accept),
            (false, false, _) => Ok(Self::Propose),
        }
    }
}

/// The result of comparing a run with its golden.
#[derive(Clone, Debug, PartialEq)]
pub enum Standing {
    /// Every bit is as reviewed.
    Same,
    /// Events are as reviewed, and set-points within the requested tolerance. It has their distance.
    Close(Option<Closeness>),
    /// Every bit that the golden knows is as reviewed, but it is of version 1. It has the remedy.
    Old(String),
    /// No golden is required: only the claims decide.
    Unasked,
    /// It was written in this run.
    Accepted,
    /// It differs from the reviewed run: the differences, and the possible actions.
    Failed(String),
}

/// The golden of a script: `x.snap` beside `x.scan.json`.
pub fn snap_path(script: &Path) -> PathBuf {
    // Two extensions are one too many for `with_extension`.
    script.with_extension("").with_extension("snap")
}

/// The run that the golden of a script records, for comparison with `run`; none without a golden, or if
/// its exact trace cannot be used.
///
/// # Errors
/// As [`judge`].
pub fn expected(script: &Path, run: &Trace) -> Result<Option<Trace>, GoldenError> {
    golden::expected(&snap_path(script), run)
}

/// Compares a run with the golden of its script by this yardstick, and changes the golden as `mode`
/// permits. A golden that agrees with the run is not changed.
///
/// # Errors
/// A file that cannot be read or written, or a snapshot in another form than insta's.
pub fn judge(
    script: &Path,
    outcome: &Outcome,
    mode: Mode,
    yardstick: Yardstick,
) -> Result<Standing, GoldenError> {
    let snap = snap_path(script);
    let trace = &outcome.trace;
    if let (Mode::Accept, Yardstick::Events(_)) = (mode, yardstick)
        && outcome.passed()
    {
        match golden::judge_by(&snap, trace, yardstick) {
            Ok(Verdict::Close(how)) => return Ok(Standing::Close(how)),
            // Accepting replaces a snapshot in another form.
            Ok(_) | Err(GoldenError::Form { .. }) => {}
            Err(error) => return Err(error),
        }
    }
    if mode == Mode::Accept {
        if !outcome.passed() {
            return Ok(Standing::Failed(
                "not accepted: claims fail; mend the script or the claims first".to_owned(),
            ));
        }
        let wrote = golden::accept(&snap, trace)?;
        golden::withdraw(&snap)?;
        return Ok(if wrote { Standing::Accepted } else { Standing::Same });
    }
    let proposing = mode == Mode::Propose;
    let what = match golden::judge_by(&snap, trace, yardstick)? {
        Verdict::Same => {
            if proposing {
                golden::withdraw(&snap)?;
            }
            return Ok(Standing::Same);
        }
        Verdict::Old => {
            if proposing {
                golden::withdraw(&snap)?;
            }
            let name = standstill_trace::file::shown(script);
            return Ok(Standing::Old(format!(
                "a golden of version 1, met; this renews it: standstill test --accept {name}"
            )));
        }
        Verdict::Close(how) => return Ok(Standing::Close(how)),
        Verdict::Companion(_) if proposing => {
            // The snapshot was accepted elsewhere, and its text holds the digest of every bit of this run.
            golden::accept(&snap, trace)?;
            golden::withdraw(&snap)?;
            return Ok(Standing::Accepted);
        }
        Verdict::Companion(why) => format!("{why}; run the test once outside CI to write it"),
        Verdict::Missing => "there is no golden yet".to_owned(),
        Verdict::Different(mismatch) => format!("the run differs from its golden\n{mismatch}"),
    };
    if !proposing || !outcome.passed() {
        return Ok(Standing::Failed(what));
    }
    let hint = match golden::propose(&snap, trace) {
        Ok(()) => "review the proposal (.snap.new), then accept it: `standstill test --accept` with the script's path, or \
             `cargo insta review`"
            .to_owned(),
        // The differences are worth more than the file, in a folder that may not be written to.
        Err(error) => format!("there is no proposal: {error}"),
    };
    Ok(Standing::Failed(format!("{}\n{hint}", what.trim_end())))
}

/// The likely cause of a difference from the golden of a script, if the golden's exact trace shows it.
/// Also whether a value was given differently, which explains all that follows.
///
/// # Errors
/// As [`judge`].
pub fn why(script: &Path, run: &Trace) -> Result<Option<(Reason, bool)>, GoldenError> {
    let Some(expected) = expected(script, run)? else {
        return Ok(None);
    };
    let story = story(&expected, run);
    let cause = story.and_then(|story| story.causes.into_iter().next());
    Ok(cause.map(|cause| {
        let is_given = matches!(
            cause,
            Cause::Limits(..)
                | Cause::Subjects(..)
                | Cause::Order { .. }
                | Cause::Variable { .. }
                | Cause::Parameter(_)
        );
        let reason = Reason {
            scan: first_output(&expected, run),
            text: format!("{cause}; look at: {}", cause.look_at()),
            claims: Vec::new(),
        };
        (reason, is_given)
    }))
}

/// The first scan in which an output or an axis differs, where the difference begins to show.
fn first_output(expected: &Trace, run: &Trace) -> Option<u64> {
    let shown = expected.columns().iter().enumerate().filter_map(|(at, column)| {
        let is_shown = !matches!(column.role, Role::Variable | Role::Input | Role::InOut);
        Some((at, run.column(&column.name).filter(|_| is_shown)?))
    });
    let shown: Vec<_> = shown.collect();
    let differs = |scan: usize| {
        let mut shown = shown.iter();
        shown.any(|(at, other)| expected.cell(scan, *at) != run.cell(scan, *other))
    };
    let scans = expected.scans().min(run.scans());
    (0..scans).find(|&scan| differs(scan)).map(|scan| scan as u64)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nothing_is_accepted_under_ci() {
        assert_eq!(Mode::of("true", "", true), Err(UnderCi));
        assert_eq!(Mode::of("1", "always", false), Ok(Mode::Check));
        assert_eq!(Mode::of("", "always", false), Ok(Mode::Accept));
        assert_eq!(Mode::of("", "no", false), Ok(Mode::Check));
        assert_eq!(Mode::of("", "no", true), Ok(Mode::Accept));
        assert_eq!(Mode::of("false", "auto", false), Ok(Mode::Propose));
        assert_eq!(Mode::of("0", "", true), Ok(Mode::Accept));
    }

    #[test]
    fn the_golden_stands_beside_its_script() {
        assert_eq!(
            snap_path(Path::new("a/b.c/second_move.scan.json")),
            Path::new("a/b.c/second_move.snap")
        );
    }
}
