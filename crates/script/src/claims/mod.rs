//! Claims: what a script's author says of the run, judged on its trace.

mod describe;
mod exact;
mod follows;
mod judge;
mod limits;
mod live;
pub(crate) mod relative;

pub use live::Standing;
pub(crate) use live::Standings;

use crate::model::{ClaimKind, Condition, Range, Span};
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
    let mut verdicts: Vec<Verdict> = rows
        .script
        .claims
        .iter()
        .map(|claim| {
            let kind = relative::placed(rows, claim);
            let mut failures = match &kind {
                Some(kind) => failures(rows, &claim.path, kind),
                None => relative::without_scans(rows, claim),
            };
            if let Some(reason) = fault_reason(rows, &claim.path) {
                failures
                    .iter_mut()
                    .for_each(|failure| failure.text.push_str(&reason));
            }
            let scans = kind.as_deref().and_then(|kind| scans(rows, kind));
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
        .collect();
    expression_faults(rows, &mut verdicts);
    verdicts
}

/// An expression without a value is a failure of the claim it stands in; of a step or a wire it is one by itself.
fn expression_faults(rows: &Rows<'_>, verdicts: &mut Vec<Verdict>) {
    for (index, formula) in rows.script.formulas.iter().enumerate() {
        let (from, to) = (formula.span.start, formula.span.end);
        let claim = verdicts
            .iter()
            .position(|verdict| verdict.span.start <= from && to <= verdict.span.end && formula.in_rows);
        let asked = |scan: u64| match claim.and_then(|place| verdicts.get(place)?.scans) {
            Some([first, last]) => (first..=last).contains(&scan),
            None => true,
        };
        let Some((scan, why)) = rows.truths.faults(index).find(|(scan, _)| asked(*scan)) else {
            continue;
        };
        let text = format!("{} has no value at scan {scan}: {why}", formula.text);
        let failure = |path: String| Failure {
            path,
            scan: Some(scan),
            text,
        };
        match claim.and_then(|place| verdicts.get_mut(place)) {
            Some(verdict) => {
                verdict.held = None;
                verdict.failures.push(failure(verdict.path.clone()));
            }
            None => {
                let path = if formula.in_rows { "steps" } else { "blocks" };
                verdicts.push(Verdict {
                    path: path.to_owned(),
                    span: formula.span,
                    says: format!("{} has a value", formula.text),
                    scans: rows.count().checked_sub(1).map(|last| [0, last]),
                    held: None,
                    failures: vec![failure(path.to_owned())],
                });
            }
        }
    }
}

/// Why a program faulted, which its claim that it does not has to tell.
fn fault_reason(rows: &Rows<'_>, path: &str) -> Option<String> {
    const FAULTS: &str = "faults: ";
    let program = path.strip_prefix("programs.")?;
    let mut notes = rows.trace.notes().iter();
    let note = notes.find(|note| note.subject == program && note.text.starts_with(FAULTS))?;
    Some(format!("; {}", note.text.strip_prefix(FAULTS)?))
}

/// What every claim says, in one line each.
pub(crate) fn say(rows: &Rows<'_>) -> Vec<String> {
    let claims = rows.script.claims.iter();
    claims.map(|claim| describe::claim(rows, &claim.kind)).collect()
}

/// Conditions in words.
pub(crate) fn conditions_text(rows: &Rows<'_>, conditions: &[Condition]) -> String {
    describe::conditions(rows, conditions)
}

/// Whether a claim that a slave follows has a row to judge.
pub(crate) fn judges_a_row(rows: &Rows<'_>, range: &Range, during: &[Condition]) -> bool {
    let last = range.to.unwrap_or(u64::MAX).min(rows.count().saturating_sub(1));
    follows::judged(rows, range.from..=last, during).next().is_some()
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
        | ClaimKind::WithinLimits { range, .. }
        | ClaimKind::Follows { range, .. }
        | ClaimKind::Answered { range, .. }
        | ClaimKind::NeverFor { range, .. }
        | ClaimKind::Duration { range, .. }
        | ClaimKind::Count { range, .. } => (range.from, range.to.unwrap_or(last).min(last)),
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
        | ClaimKind::Answered { .. }
        | ClaimKind::NeverFor { .. }
        | ClaimKind::Duration { .. }
        | ClaimKind::Count { .. }
        | ClaimKind::WithinLimits { .. }
        | ClaimKind::Follows { .. } => None,
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
        ClaimKind::Follows {
            range,
            during,
            follow,
        } => follows::failures(rows, path, *range, during, follow),
        ClaimKind::Answered { .. }
        | ClaimKind::NeverFor { .. }
        | ClaimKind::Duration { .. }
        | ClaimKind::Count { .. } => relative::failures(rows, path, kind),
    }
}
