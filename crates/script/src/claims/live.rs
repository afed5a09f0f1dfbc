//! Claims during the run: which ones are already decided, and how.
//!
//! A claim is decided in the scan after which no other can change its verdict. Only
//! [`judge`](super::judge) gives the verdicts, at the end; this module predicts them.

use super::judge::raised;
use crate::model::{Claim, ClaimKind, Range, Script, Window};
use crate::run::Rows;

/// The state of a claim during the run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Standing {
    /// Later rows decide.
    Open,
    /// It is fulfilled since this scan.
    Held(u64),
    /// It has failed since this scan.
    Failed(u64),
}

/// The state of the claims of a script after some scans.
#[derive(Clone, Debug)]
pub(crate) struct Standings {
    /// Number of scans that were read.
    scans: u64,
    /// Per claim.
    all: Vec<Standing>,
    /// For each claim the number of times its conditions held, if it counts them.
    times: Vec<u32>,
    ended: bool,
}

impl Standings {
    pub(crate) fn new(script: &Script) -> Self {
        Self {
            scans: 0,
            all: vec![Standing::Open; script.claims.len()],
            times: vec![0; script.claims.len()],
            ended: false,
        }
    }

    /// Reads the rows that have arrived; `over` means that no more will arrive.
    pub(crate) fn look(&mut self, rows: &Rows<'_>, over: bool) -> &[Standing] {
        while self.scans < rows.count() {
            let scan = self.scans;
            let each = rows.script.claims.iter().zip(&mut self.all).zip(&mut self.times);
            for ((claim, standing), times) in each {
                if *standing == Standing::Open {
                    *standing = after(rows, claim, scan, times);
                }
            }
            self.scans = scan + 1;
        }
        if over && !self.ended {
            self.ended = true;
            let last = rows.count().saturating_sub(1);
            for (verdict, standing) in super::judge(rows).iter().zip(&mut self.all) {
                if *standing == Standing::Open {
                    *standing = if verdict.passed() {
                        Standing::Held(last)
                    } else {
                        Standing::Failed(last)
                    };
                }
            }
        }
        &self.all
    }
}

/// The state after `scan` of a claim that was open before.
fn after(rows: &Rows<'_>, claim: &Claim, scan: u64, times: &mut u32) -> Standing {
    // The first scan of its range may be still to come.
    if claim.window != Window::default() {
        return Standing::Open;
    }
    let Range { from, to } = claim.range;
    let is_inside = from <= scan && to.is_none_or(|to| scan <= to);
    // A range that ends before it begins is judged at the end.
    let ends = to == Some(scan) && from <= scan;
    // A claim that may fail in every scan of its range, and is fulfilled at the end of the range.
    let unless = |fails: bool| match (fails, ends) {
        (true, _) => Standing::Failed(scan),
        (false, true) => Standing::Held(scan),
        (false, false) => Standing::Open,
    };
    let is_asked = || is_inside && rows.hold(&claim.during, scan);
    match &claim.kind {
        ClaimKind::At(that) | ClaimKind::By(that) => match (is_inside && rows.hold(that, scan), ends) {
            (true, _) => Standing::Held(scan),
            (false, true) => Standing::Failed(scan),
            (false, false) => Standing::Open,
        },
        ClaimKind::Always(that) => unless(is_asked() && !rows.hold(that, scan)),
        ClaimKind::Never(that) => unless(is_asked() && rows.hold(that, scan)),
        ClaimKind::Once(that) => {
            *times += u32::from(is_inside && rows.hold(that, scan));
            match (*times, ends) {
                (2.., _) | (0, true) => Standing::Failed(scan),
                (1, true) => Standing::Held(scan),
                (0 | 1, false) => Standing::Open,
            }
        }
        ClaimKind::Exclusive(points) => unless(is_inside && raised(rows, points, scan).len() > 1),
        // The resolution of positions depends on the largest one, which may be still to come. A row of `follows` is
        // judged when the next one has arrived. The others are judged at the end.
        ClaimKind::WithinLimits { .. }
        | ClaimKind::Follows(_)
        | ClaimKind::Answered { .. }
        | ClaimKind::NeverFor { .. }
        | ClaimKind::Duration { .. }
        | ClaimKind::Count { .. } => Standing::Open,
    }
}
