//! Claims: the statements of a script's author about the run, judged on its trace.

mod describe;
mod exact;
mod follows;
mod judge;
mod limits;
mod live;
mod place;
pub(crate) mod relative;

pub use live::Standing;
pub(crate) use live::Standings;

use crate::model::{Claim, ClaimKind, Condition, Formula, Range, Script, Span};
use crate::run::Rows;
use place::{Place, Stretch};
use std::ops;

/// A claim, judged.
#[derive(Clone, Debug, PartialEq)]
pub struct Verdict {
    /// Path in the script, such as `expect[2]`.
    pub path: String,
    /// Its place in the script.
    pub span: Span,
    /// The claim in one line; empty after [`Session::verdicts_untold`](crate::Session::verdicts_untold).
    pub says: String,
    /// The first and the last scan of the run that it covers.
    pub scans: Option<[u64; 2]>,
    /// The scan in which a claim that needs only one was fulfilled.
    pub held: Option<u64>,
    /// The reasons against it; empty if it is fulfilled.
    pub failures: Vec<Failure>,
}

impl Verdict {
    /// Whether the claim is fulfilled.
    pub fn passed(&self) -> bool {
        self.failures.is_empty()
    }
}

/// One reason against a claim.
#[derive(Clone, Debug, PartialEq)]
pub struct Failure {
    /// Path of the claim or of the condition in it, such as `expect[2].that.second.Done`.
    pub path: String,
    /// The scan it refers to; `None` if it is about the run as a whole.
    pub scan: Option<u64>,
    /// The actual values, the expected ones, and the nearest scan in which the claim was fulfilled.
    pub text: String,
}

impl std::fmt::Display for Failure {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(out, "{}: {}", self.path, self.text)
    }
}

/// Judges every claim of a script on all rows of its run, in file order.
///
/// Cost: a claim reads each scan a constant number of times.
pub(crate) fn judge(rows: &Rows<'_>) -> Vec<Verdict> {
    let mut judges = Judges::new(rows.script);
    judges.look(rows);
    judges.verdicts(rows)
}

/// The judge of a kind of claim. It receives every row once, in order. Its memory does not grow with their number.
trait Judge {
    /// Reads the next rows. A few rows before them are still held, enough for every condition.
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch);

    /// The reasons against the claim, after the last row, which is still held; `range` are the scans that
    /// it covers.
    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure>;

    /// The scan in which a claim that needs only one was fulfilled.
    fn held(&self) -> Option<u64> {
        None
    }
}

/// The claims of a script, judged as the rows of its run arrive.
pub(crate) struct Judges<'a> {
    /// Number of scans that were read.
    scans: u64,
    /// In file order.
    claims: Vec<Judged<'a>>,
    /// For each expression, the first scan in which it had no value.
    faults: Vec<Faults<'a>>,
}

/// A claim, and its state after the rows so far.
struct Judged<'a> {
    claim: &'a Claim,
    place: Place,
    judge: Box<dyn Judge + Send + Sync + 'a>,
    /// The reason of the fault of the program that the claim is about.
    reason: Option<String>,
}

/// When an expression first had no value, and why.
struct Faults<'a> {
    formula: &'a Formula,
    /// The claim that contains it, by index.
    claim: Option<usize>,
    first: Option<(u64, String)>,
    /// In the scans that the claim covers.
    asked: Option<(u64, String)>,
}

impl<'a> Judges<'a> {
    pub(crate) fn new(script: &'a Script) -> Self {
        let claims = script.claims.iter().map(|claim| Judged {
            claim,
            place: Place::new(claim),
            judge: judge_of(claim),
            reason: None,
        });
        let faults = script.formulas.iter().map(|formula| {
            let (from, to) = (formula.span.start, formula.span.end);
            let around = |claim: &Claim| claim.span.start <= from && to <= claim.span.end;
            let claim = script.claims.iter().position(around);
            Faults {
                formula,
                claim: claim.filter(|_| formula.in_rows),
                first: None,
                asked: None,
            }
        });
        Self {
            scans: 0,
            claims: claims.collect(),
            faults: faults.collect(),
        }
    }

    /// Reads the new rows since the last call.
    pub(crate) fn look(&mut self, rows: &Rows<'_>) {
        let next = self.scans..rows.count();
        self.scans = next.end;
        for judged in &mut self.claims {
            judged.place.look(rows, judged.claim, &next);
            judged.judge.look(rows, &judged.place.stretch(next.clone()));
            if judged.reason.is_none() {
                judged.reason = fault_reason(rows, &judged.claim.path);
            }
        }
        for (index, known) in self.faults.iter_mut().enumerate() {
            let claim = known.claim.and_then(|claim| self.claims.get(claim));
            let asked = claim.map(|judged| judged.place.stretch(next.clone()).inside);
            known.look(rows, index, &next, asked);
        }
    }

    /// The verdicts, after the last row, with the claims in words.
    pub(crate) fn verdicts(&self, rows: &Rows<'_>) -> Vec<Verdict> {
        let mut verdicts = self.untold(rows);
        for (verdict, judged) in verdicts.iter_mut().zip(&self.claims) {
            verdict.says = describe::claim(rows, judged.claim);
        }
        verdicts
    }

    /// The verdicts, after the last row, without the claims in words.
    pub(crate) fn untold(&self, rows: &Rows<'_>) -> Vec<Verdict> {
        let mut verdicts: Vec<Verdict> = self.claims.iter().map(|judged| judged.verdict(rows)).collect();
        for faults in &self.faults {
            faults.tell(rows, &mut verdicts);
        }
        verdicts
    }
}

impl Judged<'_> {
    fn verdict(&self, rows: &Rows<'_>) -> Verdict {
        let (claim, range) = (self.claim, self.place.range(self.claim));
        let mut failures = match range {
            Some(range) => self.judge.failures(rows, &claim.path, range),
            None => relative::without_scans(rows, claim, &self.place),
        };
        for failure in failures.iter_mut() {
            failure.text.extend(self.reason.as_deref());
        }
        let scans = range.and_then(|range| place::of_run(range, rows.count()));
        Verdict {
            path: claim.path.clone(),
            span: claim.span,
            says: String::new(),
            scans,
            held: scans
                .filter(|_| failures.is_empty())
                .and_then(|_| self.judge.held()),
            failures,
        }
    }
}

impl Faults<'_> {
    fn look(
        &mut self,
        rows: &Rows<'_>,
        index: usize,
        next: &ops::Range<u64>,
        asked: Option<ops::Range<u64>>,
    ) {
        if self.first.is_some() && (self.asked.is_some() || asked.is_none()) {
            return;
        }
        let of = |scans: &ops::Range<u64>| {
            let mut faults = rows.truths.faults(index);
            let fault = faults.find(|(scan, _)| scans.contains(scan))?;
            Some((fault.0, fault.1.to_owned()))
        };
        self.first = self.first.take().or_else(|| of(next));
        self.asked = self.asked.take().or_else(|| of(&asked?));
    }

    /// An expression without a value is a failure of its claim. In a step or a wire it is a failure by itself.
    fn tell(&self, rows: &Rows<'_>, verdicts: &mut Vec<Verdict>) {
        let formula = self.formula;
        let verdict = self.claim.and_then(|claim| verdicts.get_mut(claim));
        let has_scans = verdict.as_ref().is_some_and(|verdict| verdict.scans.is_some());
        let Some((scan, why)) = (if has_scans { &self.asked } else { &self.first }) else {
            return;
        };
        let text = format!("{} has no value at scan {scan}: {why}", formula.text);
        if let Some(verdict) = verdict {
            verdict.held = None;
            let failure = judge::failure(&verdict.path, Some(*scan), text);
            verdict.failures.push(failure);
            return;
        }
        let path = if formula.in_rows { "steps" } else { "blocks" };
        verdicts.push(Verdict {
            path: path.to_owned(),
            span: formula.span,
            says: format!("{} has a value", formula.text),
            scans: rows.count().checked_sub(1).map(|last| [0, last]),
            held: None,
            failures: vec![judge::failure(path, Some(*scan), text)],
        });
    }
}

/// The reason of a program's fault, which the claim that it has none reports.
fn fault_reason(rows: &Rows<'_>, path: &str) -> Option<String> {
    const FAULTS: &str = "faults: ";
    let program = path.strip_prefix("programs.")?;
    let mut notes = rows.trace.notes().iter();
    let note = notes.find(|note| note.subject == program && note.text.starts_with(FAULTS))?;
    Some(format!("; {}", note.text.strip_prefix(FAULTS)?))
}

/// Every claim in one line of text.
pub(crate) fn say(rows: &Rows<'_>) -> Vec<String> {
    let claims = rows.script.claims.iter();
    claims.map(|claim| describe::claim(rows, claim)).collect()
}

/// Conditions in words.
pub(crate) fn conditions_text(rows: &Rows<'_>, conditions: &[Condition]) -> String {
    describe::conditions(rows, conditions)
}

/// Whether a claim that a slave follows has a row to judge.
pub(crate) fn judges_a_row(rows: &Rows<'_>, claim: &Claim) -> bool {
    let scans = relative::scans_of(rows, claim.range);
    follows::judged(rows, scans, &claim.during).next().is_some()
}

fn judge_of(claim: &Claim) -> Box<dyn Judge + Send + Sync + '_> {
    let during = &claim.during;
    match &claim.kind {
        ClaimKind::At(that) => Box::new(judge::At::new(claim.range.from, that)),
        ClaimKind::By(that) => Box::new(judge::By::new(that)),
        ClaimKind::Always(that) => Box::new(judge::Always::new(during, that)),
        ClaimKind::Never(that) => Box::new(judge::Never::new(during, that)),
        ClaimKind::Once(that) => Box::new(judge::Once::new(that)),
        ClaimKind::Exclusive(points) => Box::new(judge::Exclusive::new(points)),
        ClaimKind::WithinLimits { axis, factor } => Box::new(limits::WithinLimits::new(*axis, *factor)),
        ClaimKind::Follows(follow) => Box::new(follows::Follows::new(during, follow)),
        ClaimKind::Answered {
            when,
            within,
            that,
            first,
        } => Box::new(relative::Answered::new((during, when), *within, that, *first)),
        ClaimKind::NeverFor { that, scans } => Box::new(relative::NeverFor::new(during, that, *scans)),
        ClaimKind::Duration { ends, bounds, each } => {
            Box::new(relative::Duration::new(during, ends, *bounds, *each))
        }
        ClaimKind::Count { that, bounds } => Box::new(relative::Count::new(during, that, *bounds)),
    }
}
