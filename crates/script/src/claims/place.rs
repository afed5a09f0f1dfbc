//! The scans that a claim covers, found as rows arrive.

use super::judge::beyond;
use super::{Failure, judge};
use crate::model::{Claim, Range};
use crate::run::Rows;
use std::ops::{self, RangeInclusive};

/// The scans that a claim covers, as far as the rows define them.
#[derive(Clone, Copy, Debug)]
pub(super) struct Place {
    /// The first one; `None` before the condition that begins it has held.
    from: Option<u64>,
    /// The last one; `None` is the end of the run, or until the condition that ends it has held.
    to: Option<u64>,
}

impl Place {
    pub(super) fn new(claim: &Claim) -> Self {
        Self {
            from: claim.window.from.is_none().then_some(claim.range.from),
            to: claim.range.to.filter(|_| claim.window.to.is_none()),
        }
    }

    /// Searches begin and end in the next rows.
    pub(super) fn look(&mut self, rows: &Rows<'_>, claim: &Claim, next: &ops::Range<u64>) {
        if let (None, Some(begin)) = (self.from, &claim.window.from) {
            let mut may_hold = rows.may_hold(begin, next.clone());
            self.from = may_hold.find(|&scan| rows.hold(begin, scan));
        }
        if let (Some(from), None, Some(end)) = (self.from, self.to, &claim.window.to) {
            let mut may_hold = rows.may_hold(end, next.start.max(from)..next.end);
            self.to = may_hold.find(|&scan| rows.hold(end, scan));
        }
    }

    /// The new rows, and which of them are among the claim's scans.
    pub(super) fn stretch(&self, next: ops::Range<u64>) -> Stretch {
        let end = self.to.map_or(next.end, |to| next.end.min(to.saturating_add(1)));
        let inside = match self.from {
            Some(from) => next.start.max(from)..end,
            None => next.start..next.start,
        };
        Stretch {
            next,
            inside,
            from: self.from,
            deadline: self.to,
        }
    }

    /// The scans it covers in a finished run. `None` if it never begins, or if it begins by a condition
    /// after its end.
    pub(super) fn range(&self, claim: &Claim) -> Option<Range> {
        let Self { from, to } = *self;
        let from = from?;
        let by_scans = claim.window.from.is_none() && claim.window.to.is_none();
        (by_scans || to.is_none_or(|to| from <= to)).then_some(Range { from, to })
    }

    /// Whether the condition that begins it has held.
    pub(super) fn has_begun(&self) -> bool {
        self.from.is_some()
    }
}

/// Rows that come one after the other.
#[derive(Clone, Debug)]
pub(super) struct Stretch {
    /// The new scans.
    pub(super) next: ops::Range<u64>,
    /// Those of them that the claim covers.
    pub(super) inside: ops::Range<u64>,
    /// The first scan that the claim covers, once it is known.
    pub(super) from: Option<u64>,
    /// The last scan that the claim covers, if it is not the end of the run, as far as it is known.
    pub(super) deadline: Option<u64>,
}

/// The scans of the run that a claim covers.
pub(super) fn of_run(range: Range, count: u64) -> Option<[u64; 2]> {
    let last = count.checked_sub(1)?;
    let to = range.to.unwrap_or(last).min(last);
    (range.from <= to).then_some([range.from, to])
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
        Err(judge::failure(path, None, text))
    } else {
        Ok(range.from..=to)
    }
}
