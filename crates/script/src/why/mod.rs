//! The reasons why claims fail: a walk from a failing claim back through wires, blocks, axes and steps to the place
//! where the process stopped.
//!
//! It reads the rows and notes of the run, after it, so a run whose claims hold pays nothing. No golden
//! is needed. The first reason is the likeliest. If a run stops for one reason, the others are its
//! context.

mod axis;
mod block;
mod feed;
mod look;
mod order;
mod standard;
mod words;

use crate::claims::Verdict;
use crate::model::{Claim, ClaimKind, Condition, Follow, Point, Signal};
use crate::run::Rows;
use look::Look;
use std::collections::BTreeSet;

/// Largest number of reported reasons.
const TOLD_MOST: usize = 6;

/// Largest number of blocks, axes and wires that the walk from one claim visits.
const VISITS_MOST: usize = 2_000;

/// Largest number of inputs in one chain of blocks back from a claim.
const DEPTH_MOST: usize = 250;

/// Largest number of failing claims from which a walk starts.
const CLAIMS_MOST: usize = 20;

/// Largest number of cells and notes that all walks of a run read: this number, and [`PASSES_MOST`] for each row.
const LOOKS_MOST: u64 = 50_000_000;

/// See [`LOOKS_MOST`].
const PASSES_MOST: u64 = 40;

/// A possible reason for a failing test.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Reason {
    /// The first scan in which it shows.
    pub scan: Option<u64>,
    /// The event, how it leads to the claim, and what to do about it, in one line.
    pub text: String,
    /// Paths of the failing claims it was found from.
    pub claims: Vec<String>,
}

/// How much a finding explains; the first rank explains most.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Rank {
    /// A wire is read one scan late, and the claim is missed by the same time.
    Order,
    /// The process stopped here.
    Stopped,
    /// A value was changed on the way.
    Changed,
    /// It continues, but too slowly.
    Slow,
    /// The signal follows this one.
    Follows,
    /// The expectation of the script's author.
    Expected,
}

/// Where a walk ended.
#[derive(Clone, Debug)]
struct Finding {
    rank: Rank,
    scan: Option<u64>,
    /// The path from the claim's signal to here, a phrase for each step.
    way: Vec<String>,
    text: String,
}

impl Finding {
    fn new(rank: Rank, scan: Option<u64>, text: String) -> Self {
        Self {
            rank,
            scan,
            way: Vec::new(),
            text,
        }
    }

    /// With one more step in front.
    fn after(mut self, step: &str) -> Self {
        self.way.insert(0, step.to_owned());
        self
    }

    /// The path, shortened in the middle, and its end.
    fn line(&self) -> String {
        let mut parts: Vec<&str> = self.way.iter().map(String::as_str).collect();
        if parts.len() > 4 {
            parts.splice(2..parts.len() - 2, [".."]);
        }
        parts.push(&self.text);
        parts.join("; ")
    }
}

/// The requirement of a claim on a row.
#[derive(Clone, Copy)]
enum Asked<'c> {
    /// This condition must hold, and does not.
    Holds(&'c Condition),
    /// This condition must not hold, and does.
    HoldsNot(&'c Condition),
    /// This point must not be TRUE, and is.
    Low(Point),
    /// The axis must stay inside its limits.
    Within(usize),
}

/// The walk from one claim.
struct Walk<'a> {
    look: Look<'a>,
    visited: BTreeSet<(u8, usize, usize)>,
    /// The inputs on the path from the claim to here.
    path: Vec<Point>,
}

impl<'a> Walk<'a> {
    fn new(look: Look<'a>) -> Self {
        Self {
            look,
            visited: BTreeSet::new(),
            path: Vec::new(),
        }
    }

    /// Whether this place is new, and more places are permitted.
    fn enter(&mut self, kind: u8, place: usize, inner: usize) -> bool {
        self.visited.len() < VISITS_MOST
            && self.path.len() < DEPTH_MOST
            && !self.look.is_spent()
            && self.visited.insert((kind, place, inner))
    }

    /// The findings of `behind`, which is one step further than `input`.
    fn deeper(&mut self, input: Point, behind: impl FnOnce(&mut Self) -> Vec<Finding>) -> Vec<Finding> {
        self.path.push(input);
        let found = behind(self);
        self.path.pop();
        found
    }

    fn asked(&mut self, asked: Asked<'_>, since: u64, scan: u64) -> Vec<Finding> {
        match asked {
            Asked::Holds(condition) => {
                let late = self.late(condition, scan);
                let mut found = self.condition(condition, since, scan);
                found.extend(late);
                found
            }
            Asked::HoldsNot(condition) => self.standing(&condition.signal, scan),
            Asked::Low(point) => self.standing(&Signal::Point(point), scan),
            Asked::Within(axis) => self.axis(axis, scan),
        }
    }

    /// The reason why a condition does not hold by `scan`, although it was required since `since`.
    fn condition(&mut self, condition: &Condition, since: u64, scan: u64) -> Vec<Finding> {
        match condition.signal {
            Signal::Point(Point::Pin(instance, pin)) if look::wants_false(condition) => {
                self.standing(&Signal::Point(Point::Pin(instance, pin)), scan)
            }
            Signal::Point(Point::Pin(instance, pin)) if !self.look.is_bool(instance, pin) => {
                self.number(instance, scan)
            }
            Signal::Point(point) => self.point(point, since, scan),
            Signal::Formula(formula) => self.formula(formula, true, since, scan),
            Signal::State(axis)
            | Signal::Master(axis, _)
            | Signal::Axis(axis, _)
            | Signal::Difference(axis, _) => self.axis(axis, scan),
        }
    }

    /// The reason for the value of a signal that should be different.
    pub(super) fn standing(&mut self, signal: &Signal, scan: u64) -> Vec<Finding> {
        match *signal {
            Signal::Point(Point::Pin(instance, pin)) => self.stands(instance, pin, scan),
            Signal::Point(point) => self.written(point, scan).into_iter().collect(),
            Signal::Formula(formula) => self.formula(formula, false, scan, scan),
            Signal::State(axis)
            | Signal::Master(axis, _)
            | Signal::Axis(axis, _)
            | Signal::Difference(axis, _) => self.axis(axis, scan),
        }
    }
}

/// The reasons why the failing claims fail, the likeliest first; empty if all hold.
///
/// Cost: for each block and axis that leads to a failing claim, a constant number of passes over the
/// rows. In all at most [`LOOKS_MOST`] reads, [`PASSES_MOST`] for each row, and one pass. When these are
/// used up the walk ends.
pub(crate) fn why(rows: &Rows<'_>, verdicts: &[Verdict]) -> Vec<Reason> {
    if verdicts.iter().all(Verdict::passed) || rows.count() == 0 {
        return Vec::new();
    }
    let look = Look::new(rows, verdicts);
    let mut found: Vec<(Finding, &str)> = Vec::new();
    let failing = rows.script.claims.iter().zip(verdicts);
    let failing = failing.filter(|(_, verdict)| !verdict.passed()).take(CLAIMS_MOST);
    let mut latest = 0;
    for (claim, verdict) in failing {
        // The first claims have most information.
        if look.is_spent() {
            break;
        }
        for (asked, since, scan) in targets(rows, claim, verdict) {
            latest = latest.max(scan);
            let findings = Walk::new(look.clone()).asked(asked, since, scan);
            found.extend(findings.into_iter().map(|finding| (finding, claim.path.as_str())));
        }
    }
    // In file order if they explain as much and show in the same scan.
    found.sort_by_key(|(finding, _)| {
        // Slow motions and the signals that follow others are listed in the order found.
        let class = match finding.rank {
            Rank::Follows => Rank::Slow,
            rank => rank,
        };
        (class, finding.scan.unwrap_or(u64::MAX), finding.rank)
    });
    let mut reasons: Vec<Reason> = Vec::new();
    let mut ends: Vec<String> = Vec::new();
    for (finding, claim) in found {
        // The motion of an axis by a block is listed once.
        let key = match (finding.rank, finding.text.split_once(") ")) {
            (Rank::Follows | Rank::Slow, Some((who, _))) => who.to_owned(),
            _ => finding.text.clone(),
        };
        match ends.iter().position(|end| *end == key) {
            Some(place) => {
                if let Some(reason) = reasons.get_mut(place)
                    && !reason.claims.iter().any(|known| known == claim)
                {
                    reason.claims.push(claim.to_owned());
                }
            }
            None => {
                reasons.push(Reason {
                    scan: finding.scan,
                    text: finding.line(),
                    claims: vec![claim.to_owned()],
                });
                ends.push(key);
            }
        }
    }
    reasons.truncate(TOLD_MOST);
    for (scan, text) in look.told_by(latest) {
        if reasons.len() >= TOLD_MOST {
            break;
        }
        if !reasons.iter().any(|reason| reason.text.contains(&text)) {
            reasons.push(Reason {
                scan: Some(scan),
                text,
                claims: Vec::new(),
            });
        }
    }
    reasons
}

/// The requirement of a failing claim, since when, and the scan in which it was missed.
fn targets<'c>(rows: &Rows<'_>, claim: &'c Claim, verdict: &Verdict) -> Vec<(Asked<'c>, u64, u64)> {
    let last = rows.count().saturating_sub(1);
    let shown = verdict.failures.iter().filter_map(|failure| failure.scan).min();
    let unmet = |that: &'c [Condition], since: u64, scan: u64| -> Vec<_> {
        let unmet = that.iter().filter(|condition| !rows.holds(condition, scan));
        unmet
            .map(|condition| (Asked::Holds(condition), since, scan))
            .collect()
    };
    let met = |that: &'c [Condition], scan: u64| -> Vec<_> {
        let each = that.iter();
        each.map(|condition| (Asked::HoldsNot(condition), 0, scan))
            .collect()
    };
    let from = claim.range.from;
    let end = claim.range.to.unwrap_or(last).min(last);
    match &claim.kind {
        ClaimKind::At(that) => unmet(that, 0, end),
        ClaimKind::By(that) => unmet(that, from, end),
        ClaimKind::Always(that) => unmet(that, 0, shown.unwrap_or(last)),
        ClaimKind::Never(that) => met(that, shown.unwrap_or(last)),
        ClaimKind::Once(that) => match shown {
            Some(second) => met(that, second),
            None => unmet(that, from, end),
        },
        ClaimKind::Exclusive(points) => {
            let scan = shown.unwrap_or(last);
            let points = points.iter().map(|(_, point)| (Asked::Low(*point), 0, scan));
            points.collect()
        }
        ClaimKind::Answered { within, that, .. } => {
            let end = shown.unwrap_or(last).min(last);
            unmet(that, end.saturating_sub(*within), end)
        }
        ClaimKind::NeverFor { that, .. } => met(that, shown.unwrap_or(last)),
        ClaimKind::Duration {
            ends: [_, end_of], ..
        } => unmet(end_of, 0, shown.unwrap_or(last).min(last)),
        ClaimKind::Count { that, .. } => unmet(that, 0, shown.unwrap_or(last).min(last)),
        ClaimKind::WithinLimits { axis: of, .. } | ClaimKind::Follows(Follow { slave: of, .. }) => {
            vec![(Asked::Within(*of), 0, shown.unwrap_or(last))]
        }
    }
}
