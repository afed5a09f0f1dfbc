//! Claims that speak of events. Their semantics, with examples, stand in `docs/claims.md`.

use super::judge::{failure, nearest};
use super::{Failure, describe};
use crate::model::{Bounds, Claim, ClaimKind, Condition, Range, Window};
use crate::run::Rows;
use std::borrow::Cow;
use std::ops::RangeInclusive;

/// The claim with the scans that its window gives it; `None` if the window never begins.
pub(super) fn placed<'c>(rows: &Rows<'_>, claim: &'c Claim) -> Option<Cow<'c, ClaimKind>> {
    if claim.window == Window::default() {
        return Some(Cow::Borrowed(&claim.kind));
    }
    let mut kind = claim.kind.clone();
    if let Some(range) = kind.range_mut() {
        *range = opened(rows, &claim.window, *range)?;
    }
    Some(Cow::Owned(kind))
}

/// The scans of a window by conditions; where none says so, as in `range`.
fn opened(rows: &Rows<'_>, window: &Window, range: Range) -> Option<Range> {
    let first =
        |conditions: &[Condition], from: u64| (from..rows.count()).find(|&scan| rows.hold(conditions, scan));
    let from = match &window.from {
        Some(conditions) => first(conditions, 0)?,
        None => range.from,
    };
    let to = match &window.to {
        Some(conditions) => first(conditions, from),
        None => range.to,
    };
    // An end that is a scan may lie before a begin that is a condition: then there is no scan between them.
    (to.is_none_or(|to| from <= to)).then_some(Range { from, to })
}

/// What speaks against a claim whose window never begins: those fail that ask for something to happen.
pub(super) fn without_scans(rows: &Rows<'_>, claim: &Claim) -> Vec<Failure> {
    let wants = match &claim.kind {
        ClaimKind::By(..) | ClaimKind::Once(..) => true,
        ClaimKind::Count { bounds, .. } => !bounds.admit(0),
        _ => false,
    };
    if !wants {
        return Vec::new();
    }
    let came = |from: &&Vec<Condition>| (0..rows.count()).any(|scan| rows.hold(from, scan));
    let text = match claim.window.from.as_ref().filter(|from| !came(from)) {
        Some(from) => format!(
            "its window never begins: {} held in no scan",
            describe::conditions(rows, from)
        ),
        None => "its window has no scan".to_owned(),
    };
    vec![failure(&claim.path, None, text)]
}

/// Why a claim asks for nothing in the run: its window never begins, or nothing rises in it.
pub(crate) fn asks_nothing(rows: &Rows<'_>, claim: &Claim) -> Option<String> {
    let Some(kind) = placed(rows, claim) else {
        return Some("the claim asks for nothing: its window never begins".to_owned());
    };
    if let Some(to) = &claim.window.to
        && !(0..rows.count()).any(|scan| rows.hold(to, scan))
    {
        return Some("the `when` of its `to` held in no scan".to_owned());
    }
    let nothing = |range: &Range, during: &[Condition], what: &[Condition]| {
        risings(rows, scans_of(rows, *range), during, what)
            .next()
            .is_none()
    };
    match kind.as_ref() {
        ClaimKind::Answered {
            range, during, when, ..
        } => nothing(range, during, when),
        ClaimKind::Duration {
            range,
            during,
            ends: [begin, _],
            ..
        } => nothing(range, during, begin),
        ClaimKind::NeverFor {
            range, during, scans, ..
        } => {
            let longest = longest_run(scans_of(rows, *range), |scan| rows.hold(during, scan));
            return (longest < *scans).then(|| {
                format!("the claim asks for nothing: it is judged in {longest} rows on end at most, fewer than `for`")
            });
        }
        _ => false,
    }
    .then(|| "the claim asks for nothing: what it waits for never rises".to_owned())
}

/// The most scans on end in which `holds`.
fn longest_run(scans: RangeInclusive<u64>, holds: impl Fn(u64) -> bool) -> u64 {
    let (mut longest, mut run) = (0, 0);
    for scan in scans {
        run = if holds(scan) { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    longest
}

/// The scans of a range that the run has.
fn scans_of(rows: &Rows<'_>, range: Range) -> RangeInclusive<u64> {
    let last = rows.count().saturating_sub(1);
    range.from..=range.to.map_or(last, |to| to.min(last))
}

/// Whether all conditions hold in a row and did not in the row before; row 0 has none before it.
fn rises(rows: &Rows<'_>, conditions: &[Condition], scan: u64) -> bool {
    rows.hold(conditions, scan)
        && scan
            .checked_sub(1)
            .is_none_or(|before| !rows.hold(conditions, before))
}

/// The risings of a range that count.
fn risings<'r>(
    rows: &'r Rows<'_>,
    mut scans: RangeInclusive<u64>,
    during: &'r [Condition],
    what: &'r [Condition],
) -> impl Iterator<Item = u64> + 'r {
    std::iter::from_fn(move || scans.find(|&scan| rises(rows, what, scan) && rows.hold(during, scan)))
}

/// Tells the first of `count` scans from a given one on in which `holds`. Asked for scans that do not go back, it looks at
/// each scan once, however often it is asked.
fn next_scan(count: u64, holds: impl Fn(u64) -> bool) -> impl FnMut(u64) -> Option<u64> {
    let mut next = 0;
    move |from| {
        next = (next.max(from)..count).find(|&scan| holds(scan)).unwrap_or(count);
        (next < count).then_some(next)
    }
}

/// What speaks against a claim that is placed.
pub(super) fn failures(rows: &Rows<'_>, path: &str, kind: &ClaimKind) -> Vec<Failure> {
    match kind {
        ClaimKind::Answered {
            range,
            during,
            when,
            within,
            that,
            first,
        } => {
            let all = risings(rows, scans_of(rows, *range), during, when);
            let most = if *first { 1 } else { usize::MAX };
            let mut answer = next_scan(rows.count(), |scan| rows.hold(that, scan));
            let mut unanswered = all
                .take(most)
                .filter(|rose| answer(*rose).is_none_or(|scan| scan > rose.saturating_add(*within)));
            let Some(rose) = unanswered.next() else {
                return Vec::new();
            };
            let more = unanswered.count();
            vec![unanswered_text(rows, path, when, that, (rose, *within), more)]
        }
        ClaimKind::NeverFor {
            range,
            during,
            that,
            scans,
        } => never_for(rows, path, scans_of(rows, *range), (during, that), *scans),
        ClaimKind::Duration {
            range,
            during,
            ends,
            bounds,
            each,
        } => {
            let [begin, _] = ends;
            let all = risings(rows, scans_of(rows, *range), during, begin);
            let most = if *each { usize::MAX } else { 1 };
            let mut end = next_scan(rows.count(), |scan| rises(rows, &ends[1], scan));
            let mut wrong = all
                .take(most)
                .filter_map(|rose| wrong_duration(rows, path, ends, *bounds, (rose, end(rose))));
            wrong.next().into_iter().collect()
        }
        ClaimKind::Count {
            range,
            during,
            that,
            bounds,
        } => {
            let found: Vec<u64> = risings(rows, scans_of(rows, *range), during, that).collect();
            if bounds.admit(found.len() as u64) {
                return Vec::new();
            }
            let text = format!(
                "{} rose {} times, expected {}; {}",
                describe::conditions(rows, that),
                found.len(),
                describe::bounded(*bounds),
                super::judge::risen(&found)
            );
            let scan = found.last().copied();
            vec![failure(&format!("{path}.count"), scan, text)]
        }
        _ => Vec::new(),
    }
}

fn unanswered_text(
    rows: &Rows<'_>,
    path: &str,
    when: &[Condition],
    that: &[Condition],
    (rose, within): (u64, u64),
    more: usize,
) -> Failure {
    let (end, last) = (rose.saturating_add(within), rows.count().saturating_sub(1));
    let (when, wanted) = (describe::conditions(rows, when), describe::conditions(rows, that));
    let mut text = format!("{when} rose in scan {rose}, and {wanted} did not come by scan {end}");
    if end > last {
        text.push_str(&format!("; the run ended with scan {last}, before that"));
    } else {
        text.push_str(&format!("; {}", nearest(rows, end, |scan| rows.hold(that, scan))));
    }
    if more > 0 {
        text.push_str(&format!("; {more} more without an answer"));
    }
    failure(&format!("{path}.that"), Some(end.min(last)), text)
}

/// The first run of rows on end that is too long.
fn never_for(
    rows: &Rows<'_>,
    path: &str,
    scans: RangeInclusive<u64>,
    (during, that): (&[Condition], &[Condition]),
    most: u64,
) -> Vec<Failure> {
    let mut on_end = 0;
    for scan in scans {
        let holds = rows.hold(during, scan) && rows.hold(that, scan);
        on_end = if holds { on_end + 1 } else { 0 };
        if on_end >= most {
            let text = format!(
                "{} held in scans {} to {scan}, expected never for {most} scans on end",
                describe::conditions(rows, that),
                scan + 1 - on_end
            );
            return vec![failure(&format!("{path}.never"), Some(scan), text)];
        }
    }
    Vec::new()
}

fn wrong_duration(
    rows: &Rows<'_>,
    path: &str,
    [begin, end]: &[Vec<Condition>; 2],
    bounds: Bounds,
    (rose, came): (u64, Option<u64>),
) -> Option<Failure> {
    if came.is_some_and(|came| bounds.admit(came - rose)) {
        return None;
    }
    let path = format!("{path}.duration");
    let (began, ended) = (describe::conditions(rows, begin), describe::conditions(rows, end));
    let Some(came) = came else {
        let text = format!("{began} rose in scan {rose}, and {ended} never rose from there on");
        return Some(failure(&path, Some(rows.count().saturating_sub(1)), text));
    };
    let scans = came - rose;
    let text = format!(
        "from {began} in scan {rose} to {ended} in scan {came} are {scans} scans, expected {}",
        describe::bounded(bounds)
    );
    Some(failure(&path, Some(came), text))
}
