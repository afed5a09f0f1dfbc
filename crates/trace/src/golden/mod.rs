//! Goldens: the reviewed record of a run, and the judgement whether a run still agrees with it.
//!
//! A golden is two files side by side. `x.snap` is an insta snapshot of [`text`]. People review it, and
//! it judges every bit by the digests of its [subjects](mod@crate::subjects). `x.exact` is its companion
//! ([`crate::exact`]). It is not reviewed, and names the first scan and signal in which a run differs. It
//! has the columns that count; the others have their defaults. Goldens of version 1 are judged in
//! `version_1`.

mod near;
mod snap;
mod text;
mod version_1;

use std::borrow::Cow;
use std::fmt;
use std::fs;
use std::io;
use std::path::{Path, PathBuf};

use similar::TextDiff;

use crate::compare::{Closeness, Difference, Tolerance, Yardstick, closeness, compare, compare_by};
use crate::exact::{self, ExactError};
use crate::file::{FileError, read_regular, replace_beside, shown};
use crate::printable::printable;
use crate::subjects::{subjects, together};
use crate::trace::Trace;

pub use text::text;

/// Largest number of lines of a text difference that are shown.
const DIFF_LINES_SHOWN: usize = 60;

/// Largest number of lines of each text that are compared.
const DIFF_LINES_MOST: usize = 4000;

/// The result of comparing a run with its golden.
#[derive(Clone, Debug, PartialEq)]
pub enum Verdict {
    /// Every bit is as reviewed.
    Same,
    /// Every bit that a golden of version 1 knows is as reviewed. Accepting again converts it to the
    /// present version.
    Old,
    /// Events are as reviewed, and set-points within the requested tolerance.
    Close(Option<Closeness>),
    /// There is no golden yet.
    Missing,
    /// The text is as reviewed, but the companion does not belong to this run: missing, damaged or of
    /// another run. Accepting again writes it.
    Companion(String),
    /// The run differs.
    Different(Box<Mismatch>),
}

/// How a run differs from its golden; `Display` writes all of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Mismatch {
    /// The requested comparison.
    pub yardstick: Yardstick,
    /// The first scan and signals that differ; `None` if the rows are equal or the companion cannot be
    /// used.
    pub difference: Option<Difference>,
    /// The reason why the companion cannot be used; empty if it can.
    pub companion: String,
    /// The subjects whose digests differ, and those whose digests are equal; both empty for a golden of
    /// version 1.
    pub subjects: [Vec<String>; 2],
    /// The difference of the texts in unified form, golden first; only of their events if only these are
    /// compared.
    pub text: String,
}

/// The reason why a golden could not be judged or accepted.
#[derive(Debug, thiserror::Error)]
pub enum GoldenError {
    /// A file could not be read or written.
    #[error("{}: {source}", shown(.path))]
    Io {
        /// The file.
        path: PathBuf,
        /// The message of the system.
        source: io::Error,
    },
    /// The snapshot is not in insta's form.
    #[error("{}: no snapshot in insta's form (a header between two lines `---`, then the text)", shown(.path))]
    Form {
        /// The file.
        path: PathBuf,
    },
}

impl GoldenError {
    fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        move |source| Self::Io {
            path: path.to_owned(),
            source,
        }
    }
}

/// The companion of a snapshot: `x.exact` beside `x.snap`.
#[must_use]
pub fn exact_path(snap: &Path) -> PathBuf {
    snap.with_extension("exact")
}

/// Compares a run with the golden of this path (`x.snap`), to the bit. Writes nothing.
///
/// # Errors
/// An existing file that cannot be read, or a snapshot in another form.
pub fn judge(snap: &Path, trace: &Trace) -> Result<Verdict, GoldenError> {
    judge_by(snap, trace, Yardstick::Exact)
}

/// The same as [`judge`], by a yardstick. A run that is equal to the bit is [`Verdict::Same`] by all of them.
///
/// # Errors
/// Those of [`judge`].
pub fn judge_by(snap: &Path, trace: &Trace, yardstick: Yardstick) -> Result<Verdict, GoldenError> {
    let Some(reviewed) = reviewed(snap)? else {
        return Ok(Verdict::Missing);
    };
    let companion = read_if_there(&exact_path(snap))?;
    if version_1::is_it(&reviewed) {
        return Ok(version_1::judge(
            &reviewed,
            companion.as_deref(),
            trace,
            yardstick,
        ));
    }
    let found = text(trace);
    if snap::same(&reviewed, &found) {
        return Ok(match companion.as_deref().map(exact::digest_of) {
            Some(Ok(stated)) if stated == together(&subjects(trace)) => Verdict::Same,
            Some(Ok(_)) => Verdict::Companion("the exact trace is of another run".to_owned()),
            Some(Err(error)) => Verdict::Companion(error.to_string()),
            None => Verdict::Companion("there is no exact trace".to_owned()),
        });
    }
    let expected = expected_trace(&reviewed, companion.as_deref(), trace);
    if let (Yardstick::Events(tolerance), Ok(expected)) = (yardstick, &expected)
        && near::same_events(&reviewed, &found, tolerance)
        && compare_by(expected, trace, yardstick).is_none()
    {
        return Ok(Verdict::Close(closeness(expected, trace, tolerance)));
    }
    let (difference, companion) = match expected {
        Ok(expected) => (compare_by(&expected, trace, yardstick), String::new()),
        Err(why) => (None, why),
    };
    let text = match yardstick {
        Yardstick::Exact => text_difference(&reviewed, &found),
        Yardstick::Events(tolerance) => events_difference(&reviewed, &found, tolerance),
    };
    Ok(Verdict::Different(Box::new(Mismatch {
        yardstick,
        difference,
        companion,
        subjects: text::moved(&reviewed, &found).map(|names| {
            names
                .into_iter()
                .map(|name| printable(name).into_owned())
                .collect()
        }),
        text,
    })))
}

/// The reviewed run of this path (`x.snap`) from its companion, for comparison with `run`. None if there is no
/// golden, no companion that belongs to it, or one that is far larger than the run.
///
/// # Errors
/// Those of [`judge`].
pub fn expected(snap: &Path, run: &Trace) -> Result<Option<Trace>, GoldenError> {
    let Some(reviewed) = reviewed(snap)? else {
        return Ok(None);
    };
    let companion = read_if_there(&exact_path(snap))?;
    Ok(expected_trace(&reviewed, companion.as_deref(), run).ok())
}

/// Makes this run the golden of this path: writes `x.snap` and `x.exact` unless they have this content already.
/// Returns whether it wrote. The caller decides whether a run may become one (its claims hold, this is no CI).
///
/// # Errors
/// A file that cannot be read or written.
pub fn accept(snap: &Path, trace: &Trace) -> Result<bool, GoldenError> {
    let found = text(trace);
    let held = match reviewed(snap) {
        Ok(text) => text,
        // Accepting replaces a snapshot in another form.
        Err(GoldenError::Form { .. }) => None,
        Err(error) => return Err(error),
    };
    let mut wrote = false;
    if !held.is_some_and(|held| snap::same(&held, &found)) {
        write(snap, snap::file(snap, &found).as_bytes())?;
        wrote = true;
    }
    let trace = &trace.only_counted();
    let path = exact_path(snap);
    let file = read_if_there(&path)?;
    let decoded = file
        .as_deref()
        .map(|file| exact::decode_within(file, most_cells(trace)));
    let holds = decoded.is_some_and(|held| held.is_ok_and(|held| compare(&held, trace).is_none()));
    if !holds || !file.is_some_and(|file| exact::is_current(&file)) {
        write(&path, &exact::encode(trace))?;
        wrote = true;
    }
    Ok(wrote)
}

/// The proposal beside a snapshot: `x.snap.new`, the name that cargo-insta expects.
#[must_use]
pub fn proposal_path(snap: &Path) -> PathBuf {
    snap.with_extension("snap.new")
}

/// Writes this run as a proposal for the golden of this path, for review.
///
/// # Errors
/// An error of the system.
pub fn propose(snap: &Path, trace: &Trace) -> Result<(), GoldenError> {
    let path = proposal_path(snap);
    write(&path, snap::file(snap, &text(trace)).as_bytes())
}

/// Removes the proposal beside a snapshot, if there is one.
///
/// # Errors
/// An error of the system.
pub fn withdraw(snap: &Path) -> Result<(), GoldenError> {
    let path = proposal_path(snap);
    match fs::remove_file(&path) {
        Err(error) if error.kind() != io::ErrorKind::NotFound => Err(GoldenError::io(&path)(error)),
        _ => Ok(()),
    }
}

/// Writes a file whole or not at all: half a golden would be invalid.
fn write(path: &Path, bytes: &[u8]) -> Result<(), GoldenError> {
    replace_beside(path, |out| out.write_all(bytes)).map_err(|error| match error {
        FileError::Io { path, source } => GoldenError::Io { path, source },
        other => GoldenError::io(path)(io::Error::other(other)),
    })
}

fn reviewed(snap: &Path) -> Result<Option<String>, GoldenError> {
    let Some(file) = read_if_there(snap)? else {
        return Ok(None);
    };
    let text = String::from_utf8(file)
        .ok()
        .and_then(|file| snap::contents(&file));
    text.map(Some).ok_or_else(|| GoldenError::Form {
        path: snap.to_owned(),
    })
}

fn read_if_there(path: &Path) -> Result<Option<Vec<u8>>, GoldenError> {
    match read_regular(path) {
        Ok(file) => Ok(Some(file)),
        Err(error) if error.kind() == io::ErrorKind::NotFound => Ok(None),
        Err(error) => Err(GoldenError::io(path)(error)),
    }
}

/// The largest number of cells of a companion that are read to find a difference: more than a reviewed
/// run of a changed script may have, and in proportion to this run.
fn most_cells(run: &Trace) -> usize {
    let cells = run.scans().saturating_mul(run.columns().len());
    cells.saturating_mul(4).max(1 << 20)
}

/// The reviewed run from its companion, if the snapshot's last line names that one, with the columns of
/// `run` that it leaves out.
fn expected_trace(reviewed: &str, companion: Option<&[u8]>, run: &Trace) -> Result<Trace, String> {
    kept_trace(reviewed, companion, most_cells(run)).map(|kept| kept.completed_as(run))
}

/// The same as [`expected_trace`], with the stored columns only.
fn kept_trace(reviewed: &str, companion: Option<&[u8]>, most: usize) -> Result<Trace, String> {
    let file = companion.ok_or("there is no exact trace")?;
    let stated = exact::digest_of(file).map_err(|error: ExactError| error.to_string())?;
    if !reviewed.trim_end().ends_with(&text::digest_text(stated)) {
        return Err("the exact trace is of another run than the snapshot".to_owned());
    }
    exact::decode_within(file, most).map_err(|error| error.to_string())
}

/// The difference of the events of two texts; empty if they are the same within the tolerance.
fn events_difference(reviewed: &str, found: &str, tolerance: Tolerance) -> String {
    if near::same_events(reviewed, found, tolerance) {
        return String::new();
    }
    text_difference(near::events(reviewed), near::events(found))
}

/// Both texts from their first difference, at most [`DIFF_LINES_MOST`] lines of each, because the work
/// grows with the square of the difference. Shorter texts stay whole.
fn window(old: &str, new: &str) -> [String; 2] {
    let whole = |text: &str| text.lines().nth(DIFF_LINES_MOST).is_none();
    if whole(old) && whole(new) {
        return [old, new].map(|text| format!("{text}\n"));
    }
    let equal = old.lines().zip(new.lines()).take_while(|(old, new)| old == new);
    let from = equal.count().saturating_sub(1);
    [old, new].map(|text| {
        let lines = text.lines().skip(from).take(DIFF_LINES_MOST);
        lines.flat_map(|line| [line, "\n"]).collect()
    })
}

fn text_difference(reviewed: &str, found: &str) -> String {
    let [old, new] = window(reviewed.trim_end(), found.trim_end());
    let all = TextDiff::from_lines(&old, &new)
        .unified_diff()
        .context_radius(1)
        .to_string();
    let mut lines = all.lines();
    let mut shown: String = lines
        .by_ref()
        .take(DIFF_LINES_SHOWN)
        .flat_map(|line| [printable(line), Cow::Borrowed("\n")])
        .collect();
    let hidden = lines.count();
    if hidden > 0 {
        shown.push_str(&format!("and {hidden} more lines\n"));
    }
    shown
}

impl fmt::Display for Mismatch {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match (&self.difference, self.companion.as_str()) {
            (Some(difference), _) => write!(out, "{difference}")?,
            (None, "") => {
                let equal = match self.yardstick {
                    Yardstick::Exact => "every bit of the rows is equal",
                    Yardstick::Events(_) => "the rows are equal within the tolerances",
                };
                writeln!(out, "{equal}; what is told beside them differs")?;
            }
            (None, why) if self.yardstick == Yardstick::Exact => {
                writeln!(out, "the first differing scan cannot be named: {why}")?;
            }
            (None, why) => writeln!(out, "set-points cannot be compared: {why}")?,
        }
        let [other, same] = &self.subjects;
        if !other.is_empty() && self.yardstick == Yardstick::Exact {
            write!(out, "digests that differ: {}", other.join(", "))?;
            match same.is_empty() {
                true => writeln!(out)?,
                false => writeln!(out, "; the same: {}", same.join(", "))?,
            }
        }
        match (self.yardstick, self.text.as_str()) {
            (_, "") => Ok(()),
            (Yardstick::Exact, text) => write!(out, "text: - golden, + this run\n{text}"),
            (Yardstick::Events(_), text) => write!(out, "events: - golden, + this run\n{text}"),
        }
    }
}
