//! Claims: what a script's author says of the run, judged on its trace.

mod describe;
mod judge;
mod limits;
mod live;

pub use live::Standing;
pub(crate) use live::Standings;

use crate::model::{ClaimKind, Span};
use crate::run::Rows;

/// A claim, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Path in the script, such as `expect[2]`.
    pub path: String,
    /// Where it stands in the script.
    pub span: Span,
    /// What it says, in one line.
    pub says: String,
    /// The first and the last scan of the run it speaks of.
    pub scans: Option<[u64; 2]>,
    /// The scan in which a claim that needs only one came true.
    pub held: Option<u64>,
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

/// Judges every claim of a script on the rows of its run, in file order.
///
/// Cost: a claim looks at each scan a constant number of times.
pub(crate) fn judge(rows: &Rows<'_>) -> Vec<Verdict> {
    rows.script
        .claims
        .iter()
        .map(|claim| {
            let failures = failures(rows, &claim.path, &claim.kind);
            let scans = scans(rows, &claim.kind);
            Verdict {
                path: claim.path.clone(),
                span: claim.span,
                says: describe::claim(rows, &claim.kind),
                scans,
                held: scans
                    .filter(|_| failures.is_empty())
                    .and_then(|scans| held(rows, &claim.kind, scans)),
                failures,
            }
        })
        .collect()
}

/// What every claim says, in one line each.
pub(crate) fn say(rows: &Rows<'_>) -> Vec<String> {
    let claims = rows.script.claims.iter();
    claims.map(|claim| describe::claim(rows, &claim.kind)).collect()
}

/// The scans of the run that a claim speaks of.
fn scans(rows: &Rows<'_>, kind: &ClaimKind) -> Option<[u64; 2]> {
    let last = rows.count().checked_sub(1)?;
    let (from, to) = match kind {
        ClaimKind::At(scan, _) => (*scan, *scan),
        ClaimKind::By(range, _)
        | ClaimKind::Once(range, _)
        | ClaimKind::Exclusive(range, _)
        | ClaimKind::Always { range, .. }
        | ClaimKind::Never { range, .. }
        | ClaimKind::WithinLimits { range, .. } => (range.from, range.to.unwrap_or(last).min(last)),
    };
    (from <= to && to <= last).then_some([from, to])
}

/// The scan in which a claim that needs only one came true.
fn held(rows: &Rows<'_>, kind: &ClaimKind, [from, to]: [u64; 2]) -> Option<u64> {
    match kind {
        ClaimKind::At(_, that) | ClaimKind::By(_, that) | ClaimKind::Once(_, that) => {
            (from..=to).find(|&scan| rows.hold(that, scan))
        }
        ClaimKind::Exclusive(..)
        | ClaimKind::Always { .. }
        | ClaimKind::Never { .. }
        | ClaimKind::WithinLimits { .. } => None,
    }
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
