//! Claims about events. Their semantics, with examples, are in `docs/claims.md`.

use super::judge::{Listed, Nearest, failure};
use super::place::{Place, Stretch};
use super::{Failure, Judge, describe};
use crate::model::{Bounds, Claim, ClaimKind, Condition, Range};
use crate::run::Rows;
use std::collections::VecDeque;
use std::ops::{self, RangeInclusive};

/// The failure of a claim whose window never begins: those fail that require an event.
pub(super) fn without_scans(rows: &Rows<'_>, claim: &Claim, place: &Place) -> Vec<Failure> {
    let wants = match &claim.kind {
        ClaimKind::By(..) | ClaimKind::Once(..) => true,
        ClaimKind::Count { bounds, .. } => !bounds.admit(0),
        _ => false,
    };
    if !wants {
        return Vec::new();
    }
    let text = match claim.window.from.as_ref().filter(|_| !place.has_begun()) {
        Some(from) => format!(
            "its window never begins: {} held in no scan",
            describe::conditions(rows, from)
        ),
        None => "its window has no scan".to_owned(),
    };
    vec![failure(&claim.path, None, text)]
}

/// The reason why a claim checks nothing in the run: its window never begins, or no condition in it
/// becomes true.
pub(crate) fn asks_nothing(rows: &Rows<'_>, claim: &Claim) -> Option<String> {
    let mut place = Place::new(claim);
    place.look(rows, claim, &(0..rows.count()));
    let Some(range) = place.range(claim) else {
        return Some("the claim asks for nothing: its window never begins".to_owned());
    };
    if let Some(to) = &claim.window.to
        && !(0..rows.count()).any(|scan| rows.hold(to, scan))
    {
        return Some("the `when` of its `to` held in no scan".to_owned());
    }
    let during = &claim.during;
    let nothing = |what: &[Condition]| {
        !scans_of(rows, range).any(|scan| rises(rows, what, scan) && rows.hold(during, scan))
    };
    match &claim.kind {
        ClaimKind::Answered { when, .. } => nothing(when),
        ClaimKind::Duration { ends: [begin, _], .. } => nothing(begin),
        ClaimKind::NeverFor { scans, .. } => {
            let longest = longest_run(scans_of(rows, range), |scan| rows.hold(during, scan));
            return (longest < *scans).then(|| {
                format!("the claim asks for nothing: it is judged in {longest} rows on end at most, fewer than `for`")
            });
        }
        _ => false,
    }
    .then(|| "the claim asks for nothing: what it waits for never rises".to_owned())
}

/// The most consecutive scans in which `holds`.
fn longest_run(scans: RangeInclusive<u64>, holds: impl Fn(u64) -> bool) -> u64 {
    let (mut longest, mut run) = (0, 0);
    for scan in scans {
        run = if holds(scan) { run + 1 } else { 0 };
        longest = longest.max(run);
    }
    longest
}

/// The scans of a range that the run has.
pub(crate) fn scans_of(rows: &Rows<'_>, range: Range) -> RangeInclusive<u64> {
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

/// Whether conditions may rise in one of these scans, which are the last ones so far.
fn may_rise(rows: &Rows<'_>, conditions: &[Condition], scans: &ops::Range<u64>) -> bool {
    let since = conditions
        .iter()
        .map(|condition| rows.same_since(condition))
        .max();
    // Something that rises has changed; row 0 has no row before it.
    scans.start == 0 || since.unwrap_or(0) >= scans.start
}

/// After each rising edge, or after the first, there is an answer in time.
pub(super) struct Answered<'a> {
    during: &'a [Condition],
    when: &'a [Condition],
    within: u64,
    that: &'a [Condition],
    only_first: bool,
    rose: bool,
    /// Rising edges whose answer may still come in time: those of the last `within` scans.
    waiting: VecDeque<u64>,
    /// The first rising edge without an answer, and the number of further ones.
    unanswered: Option<(u64, u64)>,
    nearest: Nearest,
}

impl<'a> Answered<'a> {
    pub(super) fn new(
        (during, when): (&'a [Condition], &'a [Condition]),
        within: u64,
        that: &'a [Condition],
        only_first: bool,
    ) -> Self {
        Self {
            during,
            when,
            within,
            that,
            only_first,
            rose: false,
            waiting: VecDeque::new(),
            unanswered: None,
            nearest: Nearest::default(),
        }
    }

    fn end(&self, rose: u64) -> u64 {
        rose.saturating_add(self.within)
    }

    fn give_up(&mut self, rose: u64) {
        match &mut self.unanswered {
            Some((_, more)) => *more += 1,
            None => {
                self.unanswered = Some((rose, 0));
                self.nearest.to = Some(self.end(rose));
            }
        }
    }
}

impl Judge for Answered<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let waits = !self.waiting.is_empty() || may_rise(rows, self.when, &stretch.next);
        for scan in stretch.next.clone().filter(|_| waits) {
            while let Some(rose) = self
                .waiting
                .front()
                .copied()
                .filter(|rose| self.end(*rose) < scan)
            {
                self.waiting.pop_front();
                self.give_up(rose);
            }
            let counts = stretch.inside.contains(&scan) && !(self.only_first && self.rose);
            if counts && rises(rows, self.when, scan) && rows.hold(self.during, scan) {
                self.rose = true;
                self.waiting.push_back(scan);
            }
            if !self.waiting.is_empty() && rows.hold(self.that, scan) {
                self.waiting.clear();
            }
        }
        self.nearest.look(rows, &stretch.next, self.that);
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, _: Range) -> Vec<Failure> {
        // A rising edge that still waits has no answer before the end of the run.
        let waiting = self.waiting.len() as u64;
        let (rose, more) = match (self.unanswered, self.waiting.front()) {
            (Some((rose, more)), _) => (rose, more + waiting),
            (None, Some(&rose)) => (rose, waiting - 1),
            (None, None) => return Vec::new(),
        };
        let (end, last) = (self.end(rose), rows.count().saturating_sub(1));
        let when = describe::conditions(rows, self.when);
        let wanted = describe::conditions(rows, self.that);
        let mut text = format!("{when} rose in scan {rose}, and {wanted} did not come by scan {end}");
        if end > last {
            text.push_str(&format!("; the run ended with scan {last}, before that"));
        } else {
            text.push_str(&format!("; {}", self.nearest.text(end)));
        }
        if more > 0 {
            text.push_str(&format!("; {more} more without an answer"));
        }
        vec![failure(&format!("{path}.that"), Some(end.min(last)), text)]
    }
}

/// The conditions do not hold in this many consecutive rows.
pub(super) struct NeverFor<'a> {
    during: &'a [Condition],
    that: &'a [Condition],
    most: u64,
    on_end: u64,
    /// First and last scan of the first run of rows that is too long.
    too_long: Option<[u64; 2]>,
}

impl<'a> NeverFor<'a> {
    pub(super) fn new(during: &'a [Condition], that: &'a [Condition], most: u64) -> Self {
        Self {
            during,
            that,
            most,
            on_end: 0,
            too_long: None,
        }
    }
}

impl Judge for NeverFor<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        if !stretch.inside.is_empty() && rows.may_hold(self.that, stretch.inside.clone()).is_empty() {
            self.on_end = 0;
            return;
        }
        for scan in stretch.inside.clone() {
            if self.too_long.is_some() {
                return;
            }
            let holds = rows.hold(self.during, scan) && rows.hold(self.that, scan);
            self.on_end = if holds { self.on_end + 1 } else { 0 };
            if self.on_end >= self.most {
                self.too_long = Some([scan + 1 - self.on_end, scan]);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, _: Range) -> Vec<Failure> {
        let Some([first, scan]) = self.too_long else {
            return Vec::new();
        };
        let text = format!(
            "{} held in scans {first} to {scan}, expected never for {} scans on end",
            describe::conditions(rows, self.that),
            self.most
        );
        vec![failure(&format!("{path}.never"), Some(scan), text)]
    }
}

/// The time from each rising edge of one condition, or from the first, to the next one of another.
pub(super) struct Duration<'a> {
    during: &'a [Condition],
    ends: &'a [Vec<Condition>; 2],
    bounds: Bounds,
    each: bool,
    rose: bool,
    /// Rising edges that wait for the end: the first one, and those of the last `ge` scans.
    waiting: VecDeque<u64>,
    /// The first rising edge whose time is wrong, and its end.
    wrong: Option<[u64; 2]>,
}

impl<'a> Duration<'a> {
    pub(super) fn new(
        during: &'a [Condition],
        ends: &'a [Vec<Condition>; 2],
        bounds: Bounds,
        each: bool,
    ) -> Self {
        Self {
            during,
            ends,
            bounds,
            each,
            rose: false,
            waiting: VecDeque::new(),
            wrong: None,
        }
    }

    /// Drops the edges behind the first one that can no longer be too short. If one of them is too long, the first
    /// one is, too.
    fn forget(&mut self, scan: u64) {
        let least = self.bounds.ge.unwrap_or(0);
        while self
            .waiting
            .get(1)
            .is_some_and(|rose| rose.saturating_add(least) <= scan)
        {
            self.waiting.remove(1);
        }
    }
}

impl Judge for Duration<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let [begin, end] = self.ends;
        if !may_rise(rows, begin, &stretch.next) && !may_rise(rows, end, &stretch.next) {
            return;
        }
        for scan in stretch.next.clone() {
            if self.wrong.is_some() {
                return;
            }
            let counts = stretch.inside.contains(&scan) && (self.each || !self.rose);
            if counts && rises(rows, begin, scan) && rows.hold(self.during, scan) {
                self.rose = true;
                self.waiting.push_back(scan);
                self.forget(scan);
            }
            if !self.waiting.is_empty() && rises(rows, end, scan) {
                let wrong = self
                    .waiting
                    .drain(..)
                    .find(|rose| !self.bounds.admit(scan - rose));
                self.wrong = wrong.map(|rose| [rose, scan]);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, _: Range) -> Vec<Failure> {
        let path = format!("{path}.duration");
        let [began, ended] = self.ends.each_ref().map(|end| describe::conditions(rows, end));
        if let Some([rose, came]) = self.wrong {
            let text = format!(
                "from {began} in scan {rose} to {ended} in scan {came} are {} scans, expected {}",
                came - rose,
                describe::bounded(self.bounds)
            );
            return vec![failure(&path, Some(came), text)];
        }
        let Some(rose) = self.waiting.front() else {
            return Vec::new();
        };
        let text = format!("{began} rose in scan {rose}, and {ended} never rose from there on");
        vec![failure(&path, Some(rows.count().saturating_sub(1)), text)]
    }
}

/// It becomes true this many times.
pub(super) struct Count<'a> {
    during: &'a [Condition],
    that: &'a [Condition],
    bounds: Bounds,
    found: Listed,
}

impl<'a> Count<'a> {
    pub(super) fn new(during: &'a [Condition], that: &'a [Condition], bounds: Bounds) -> Self {
        Self {
            during,
            that,
            bounds,
            found: Listed::default(),
        }
    }
}

impl Judge for Count<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        if !may_rise(rows, self.that, &stretch.inside) {
            return;
        }
        for scan in stretch.inside.clone() {
            if rises(rows, self.that, scan) && rows.hold(self.during, scan) {
                self.found.add(scan);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, _: Range) -> Vec<Failure> {
        if self.bounds.admit(self.found.count()) {
            return Vec::new();
        }
        let risen = match self.found.count() {
            0 => "it never did".to_owned(),
            _ => format!("it did {}", self.found),
        };
        let text = format!(
            "{} rose {} times, expected {}; {risen}",
            describe::conditions(rows, self.that),
            self.found.count(),
            describe::bounded(self.bounds),
        );
        vec![failure(&format!("{path}.count"), self.found.last(), text)]
    }
}
