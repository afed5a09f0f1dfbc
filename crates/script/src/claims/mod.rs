//! Claims: what a script's author says of the run, judged on its trace.

mod describe;
mod judge;
mod limits;

use crate::model::{ClaimKind, Script, Span};
use crate::run::{Layout, Rows, Shift};
use standstill_trace::Trace;

/// A claim, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Path in the script, such as `expect[2]`.
    pub path: String,
    /// Where it stands in the script.
    pub span: Span,
    /// What it says, in one line.
    pub says: String,
    /// What spoke against it; empty if it held.
    pub failures: Vec<Failure>,
}

impl Verdict {
    /// Whether the claim held.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }
}

/// One thing that speaks against a claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Path of the claim or of the condition in it, such as `expect[2].that.second.Done`.
    pub path: String,
    /// The scan it shows in; `None` if it is about the run as a whole.
    pub scan: Option<u64>,
    /// The values that were there, what was expected, and the nearest scan in which it held.
    pub text: String,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}: {}", self.path, self.text)
    }
}

/// Judges every claim of a script on the trace of its run, in file order.
///
/// Cost: a claim looks at each scan a constant number of times.
pub(crate) fn judge(script: &Script, trace: &Trace, shifts: &[Shift]) -> Vec<Verdict> {
    let layout = Layout::new(script);
    let rows = Rows {
        script,
        layout: &layout,
        trace,
        shifts,
    };
    script
        .claims
        .iter()
        .map(|claim| Verdict {
            path: claim.path.clone(),
            span: claim.span,
            says: describe::claim(&rows, &claim.kind),
            failures: failures(&rows, &claim.path, &claim.kind),
        })
        .collect()
}

fn failures(rows: &Rows<'_>, path: &str, kind: &ClaimKind) -> Vec<Failure> {
    match kind {
        ClaimKind::At(scan, that) => judge::at(rows, path, *scan, that),
        ClaimKind::By(range, that) => judge::by(rows, path, *range, that),
        ClaimKind::Always { range, during, that } => judge::always(rows, path, *range, during, that),
        ClaimKind::Never { range, during, that } => judge::never(rows, path, *range, during, that),
        ClaimKind::Once(range, that) => judge::once(rows, path, *range, that),
        ClaimKind::Exclusive(range, points) => judge::exclusive(rows, path, *range, points),
        ClaimKind::WithinLimits { range, axis, factor } => limits::within(rows, path, *range, *axis, *factor),
    }
}
