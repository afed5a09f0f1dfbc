//! Traces as a page: curves with their limits, states, a timing diagram of every pin, claims, events, and
//! a cursor that reads the exact values. A page shows one trace, or several over each other.
//!
//! The page is one file that loads nothing: its content policy allows only its own script and style, by their
//! hashes. Texts of a trace become texts of the page, never markup. Rows are stored as the exact companion of the
//! trace ([`standstill_trace::exact`]), so every bit is there; `page/decode.js` unpacks them.
//!
//! Curves are drawn by uPlot (`vendor/`, MIT licence). All other parts of the page are readable in `page/`, without
//! a build step. The crate reads no clock and no files: the same traces give the same bytes.

#![forbid(unsafe_code)]

mod facts;
mod page;

pub use page::about;

use standstill_trace::Trace;
use standstill_trace::time_literal;

/// Largest number of traces over each other: the number of colours.
pub const TRACES_MAX: usize = 6;

/// A trace with its name, and the parts that its file lacks.
#[derive(Clone, Copy, Debug)]
pub struct Source<'a> {
    /// Its name on the page, such as its file.
    pub name: &'a str,
    /// The trace.
    pub trace: &'a Trace,
    /// The missing parts, one phrase each ([`standstill_trace::Loaded::lacks`]).
    pub lacks: &'a [String],
}

/// A place of interest. Its line is drawn over all plots, and the cursor begins there.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Mark {
    /// The scan, if it is about one; past the end of a trace is fine.
    pub scan: Option<usize>,
    /// A few words.
    pub title: String,
    /// The full text, in lines.
    pub text: String,
}

/// The reason why these traces make no page.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ReportError {
    /// There is none, or there are too many.
    #[error("{0} traces: a report shows 1 to {TRACES_MAX}")]
    Count(usize),
    /// A trace without rows.
    #[error("{0}: the trace has no rows, there is nothing to show")]
    Empty(String),
    /// Scans of different length: scan n is not the same time in both.
    #[error(
        "{first} has scans of {}, {other} of {}: only traces of the same cycle can be laid over each other",
        time_literal(*first_ns),
        time_literal(*other_ns)
    )]
    Cycle {
        /// Name of the first trace.
        first: String,
        /// Its cycle (ns).
        first_ns: u64,
        /// Name of a trace with another one.
        other: String,
        /// That cycle (ns).
        other_ns: u64,
    },
}

/// The page of these traces. If they have different lengths the shorter ones end earlier, and the page
/// says so.
///
/// Cost: that of [`standstill_trace::exact::encode`] for each trace.
///
/// # Errors
/// No trace or too many, one without rows, or different cycles.
pub fn html(sources: &[Source<'_>]) -> Result<String, ReportError> {
    html_marked(sources, &[])
}

/// The same as [`html`], with places of interest.
///
/// # Errors
/// Those of [`html`].
pub fn html_marked(sources: &[Source<'_>], marks: &[Mark]) -> Result<String, ReportError> {
    check(sources)?;
    Ok(page::page(sources, marks))
}

/// The error that [`html`] would return, without its work.
///
/// # Errors
/// Those of [`html`].
pub fn check(sources: &[Source<'_>]) -> Result<(), ReportError> {
    let first = match sources {
        [first, ..] if sources.len() <= TRACES_MAX => first,
        _ => return Err(ReportError::Count(sources.len())),
    };
    if let Some(empty) = sources.iter().find(|source| source.trace.scans() == 0) {
        return Err(ReportError::Empty(empty.name.to_owned()));
    }
    let cycle = |source: &Source<'_>| source.trace.header().cycle_ns;
    match sources.iter().find(|source| cycle(source) != cycle(first)) {
        None => Ok(()),
        Some(other) => Err(ReportError::Cycle {
            first: first.name.to_owned(),
            first_ns: cycle(first),
            other: other.name.to_owned(),
            other_ns: cycle(other),
        }),
    }
}
