//! The kinds of claims.

use super::{Failure, describe};
use crate::model::{Condition, Point, Range, Signal};
use crate::run::Rows;
use standstill_trace::Cell;
use std::ops::RangeInclusive;

/// So many scans are named where a claim fails in several.
const SCANS_NAMED: usize = 5;

/// All conditions hold in `scan`; each that does not is a failure of its own.
pub(super) fn at(rows: &Rows<'_>, path: &str, scan: u64, that: &[Condition]) -> Vec<Failure> {
    if scan >= rows.count() {
        return vec![beyond(rows, path, scan)];
    }
    that.iter()
        .filter(|condition| !rows.holds(condition, scan))
        .map(|condition| {
            let nearest = nearest(rows, scan, |scan| rows.holds(condition, scan));
            unmet(rows, path, "that", condition, scan, &nearest)
        })
        .collect()
}

/// All conditions hold together in some scan of the range.
pub(super) fn by(rows: &Rows<'_>, path: &str, range: Range, that: &[Condition]) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        // What came before the end of the run came in time, however far the range goes.
        Ok(scans) => scans,
        Err(failure) if range.from < rows.count() => {
            let held = (range.from..rows.count()).any(|scan| rows.hold(that, scan));
            return if held { Vec::new() } else { vec![failure] };
        }
        Err(failure) => return vec![failure],
    };
    if scans.clone().any(|scan| rows.hold(that, scan)) {
        return Vec::new();
    }
    let deadline = *scans.end();
    let nearest = nearest(rows, deadline, |scan| rows.hold(that, scan));
    // Not all hold at the deadline, so at least one fails.
    that.iter()
        .filter(|condition| !rows.holds(condition, deadline))
        .map(|condition| unmet(rows, path, "that", condition, deadline, &nearest))
        .collect()
}

/// All conditions hold in every scan of the range in which `during` holds.
pub(super) fn always(
    rows: &Rows<'_>,
    path: &str,
    range: Range,
    during: &[Condition],
    that: &[Condition],
) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        Ok(scans) => scans,
        Err(failure) => return vec![failure],
    };
    that.iter()
        .filter_map(|condition| {
            let broken = || {
                scans.clone().filter(|&scan| {
                    rows.hold(during, scan)
                        && !rows.holds(condition, scan)
                        && !rows.too_early(&condition.signal, scan)
                })
            };
            let first = broken().next()?;
            let nearest = nearest(rows, first, |scan| rows.holds(condition, scan));
            let text = format!("{nearest}; broken {}", listed(broken()));
            Some(unmet(rows, path, "always", condition, first, &text))
        })
        .collect()
}

/// The conditions hold together in no scan of the range in which `during` holds.
pub(super) fn never(
    rows: &Rows<'_>,
    path: &str,
    range: Range,
    during: &[Condition],
    that: &[Condition],
) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        Ok(scans) => scans,
        Err(failure) => return vec![failure],
    };
    let held = || {
        scans
            .clone()
            .filter(|&scan| rows.hold(during, scan) && rows.hold(that, scan))
    };
    let Some(first) = held().next() else {
        return Vec::new();
    };
    let values: Vec<_> = that
        .iter()
        .map(|condition| format!("{} {}", condition.text, describe::values(rows, condition, first)))
        .collect();
    let text = format!(
        "{} at scan {first}, expected never; it held {}",
        values.join(", "),
        listed(held())
    );
    vec![failure(&format!("{path}.never"), Some(first), text)]
}

/// The conditions hold together in exactly one scan of the range.
pub(super) fn once(rows: &Rows<'_>, path: &str, range: Range, that: &[Condition]) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        Ok(scans) => scans,
        Err(failure) => return vec![failure],
    };
    let held = || scans.clone().filter(|&scan| rows.hold(that, scan));
    let path = format!("{path}.once");
    let mut found = held();
    match (found.next(), found.next()) {
        (Some(_), None) => Vec::new(),
        (None, _) => {
            let nearest = nearest(rows, *scans.end(), |scan| rows.hold(that, scan));
            let text = format!(
                "{} did not hold in scans {} to {}, expected exactly once; {nearest}",
                describe::conditions(rows, that),
                scans.start(),
                scans.end()
            );
            vec![failure(&path, None, text)]
        }
        (Some(_), Some(second)) => {
            let text = format!(
                "{} held {}, expected exactly once",
                describe::conditions(rows, that),
                listed(held())
            );
            vec![failure(&path, Some(second), text)]
        }
    }
}

/// At most one of the points is TRUE in every scan of the range.
pub(super) fn exclusive(
    rows: &Rows<'_>,
    path: &str,
    range: Range,
    points: &[(String, Point)],
) -> Vec<Failure> {
    let scans = match within_run(rows, path, range) {
        Ok(scans) => scans,
        Err(failure) => return vec![failure],
    };
    let raised = |scan| raised(rows, points, scan);
    let broken = || scans.clone().filter(|&scan| raised(scan).len() > 1);
    let Some(first) = broken().next() else {
        return Vec::new();
    };
    let text = format!(
        "{} are TRUE together at scan {first}; at most one may be; broken {}",
        raised(first).join(" and "),
        listed(broken())
    );
    vec![failure(&format!("{path}.exclusive"), Some(first), text)]
}

/// The names of those points that are TRUE in a scan.
pub(super) fn raised<'p>(rows: &Rows<'_>, points: &'p [(String, Point)], scan: u64) -> Vec<&'p str> {
    let is_true = |point: &Point| rows.cell(&Signal::Point(*point), scan) == Some(Cell::Bool(true));
    points
        .iter()
        .filter(move |(_, point)| is_true(point))
        .map(|(name, _)| name.as_str())
        .collect()
}

/// The scans of a range, or the failure of a range that is not all within the run.
pub(super) fn within_run(rows: &Rows<'_>, path: &str, range: Range) -> Result<RangeInclusive<u64>, Failure> {
    let last = rows.count().saturating_sub(1);
    let to = range.to.unwrap_or(last);
    let furthest = range.from.max(to);
    if furthest >= rows.count() {
        Err(beyond(rows, path, furthest))
    } else if range.from > to {
        let text = format!("no scan lies from {} to {to}", range.from);
        Err(failure(path, None, text))
    } else {
        Ok(range.from..=to)
    }
}

fn beyond(rows: &Rows<'_>, path: &str, scan: u64) -> Failure {
    let end = match rows.count().checked_sub(1) {
        Some(last) => format!("the run ended with scan {last}"),
        None => "the run has no scans".to_owned(),
    };
    failure(path, None, format!("it speaks of scan {scan}, but {end}"))
}

/// `FALSE at scan 551, expected TRUE; it came at 553, 2 later`
fn unmet(rows: &Rows<'_>, path: &str, key: &str, condition: &Condition, scan: u64, nearest: &str) -> Failure {
    let text = format!(
        "{} at scan {scan}, expected {}; {nearest}",
        describe::values(rows, condition, scan),
        describe::test(rows, &condition.signal, &condition.test)
    );
    failure(&format!("{path}.{key}.{}", condition.text), Some(scan), text)
}

/// Where something holds nearest to `scan`; of two equally near scans the later one.
pub(super) fn nearest(rows: &Rows<'_>, scan: u64, holds: impl Fn(u64) -> bool) -> String {
    for away in 1..rows.count() {
        let later = scan + away;
        if later < rows.count() && holds(later) {
            return format!("it came at {later}, {away} later");
        }
        if let Some(earlier) = scan.checked_sub(away)
            && holds(earlier)
        {
            return format!("it was so at {earlier}, {away} earlier");
        }
    }
    "it was so in no scan".to_owned()
}

/// Scans in which a claim fails: how many, the first few and the last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Listed {
    count: u64,
    first: [u64; SCANS_NAMED],
    last: u64,
}

impl Listed {
    /// The next scan.
    pub(super) fn add(&mut self, scan: u64) {
        let place = usize::try_from(self.count).unwrap_or(usize::MAX);
        if let Some(place) = self.first.get_mut(place) {
            *place = scan;
        }
        self.count += 1;
        self.last = scan;
    }
}

/// `in 3 scans: 7, 8, 9`
impl std::fmt::Display for Listed {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { count, first, last } = self;
        let named = first.iter().zip(0..*count);
        let named: Vec<_> = named.map(|(scan, _)| scan.to_string()).collect();
        let named = named.join(", ");
        if *count == 1 {
            write!(out, "in scan {named}")
        } else if *count > SCANS_NAMED as u64 {
            write!(out, "in {count} scans: {named} .. {last}")
        } else {
            write!(out, "in {count} scans: {named}")
        }
    }
}

/// The scans in which something rose, in a few words.
pub(super) fn risen(scans: &[u64]) -> String {
    match scans {
        [] => "it never did".to_owned(),
        scans => format!("it did {}", listed(scans.iter().copied())),
    }
}

/// The scans in which a claim fails, in a few words.
fn listed(scans: impl Iterator<Item = u64>) -> Listed {
    let mut listed = Listed::default();
    scans.for_each(|scan| listed.add(scan));
    listed
}

pub(super) fn failure(path: &str, scan: Option<u64>, text: String) -> Failure {
    Failure {
        path: path.to_owned(),
        scan,
        text,
    }
}
