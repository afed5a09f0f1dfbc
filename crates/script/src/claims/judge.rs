//! Claims about single rows, judged as rows arrive. The memory of a judge does not grow with the rows.

use super::place::{Stretch, within_run};
use super::{Failure, Judge, describe};
use crate::model::{Condition, Point, Range, Signal};
use crate::run::Rows;
use standstill_trace::Cell;
use std::ops;

/// Largest number of scans that are named if a claim fails in several.
const SCANS_NAMED: usize = 5;

/// All conditions hold in `scan`; each that does not is a failure of its own.
pub(super) struct At<'a> {
    scan: u64,
    each: Vec<Demand<'a>>,
}

impl<'a> At<'a> {
    pub(super) fn new(scan: u64, that: &'a [Condition]) -> Self {
        let demand = |condition| Demand {
            nearest: Nearest::to(scan),
            ..Demand::new(condition)
        };
        Self {
            scan,
            each: that.iter().map(demand).collect(),
        }
    }
}

impl Judge for At<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        for demand in &mut self.each {
            if stretch.next.contains(&self.scan) && !rows.holds(demand.condition, self.scan) {
                demand.unmet = Some((self.scan, demand.values(rows, self.scan)));
            }
            // A claim that is fulfilled has nothing to report.
            if demand.unmet.is_some() || self.scan >= stretch.next.end {
                demand.seek(rows, &stretch.next);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, _: Range) -> Vec<Failure> {
        if self.scan >= rows.count() {
            return vec![beyond(rows, path, self.scan)];
        }
        let unmet = self.each.iter();
        unmet
            .filter_map(|demand| demand.failure(rows, path, "that", ""))
            .collect()
    }

    fn held(&self) -> Option<u64> {
        Some(self.scan)
    }
}

/// A condition that must hold, and the first scan in which it does not.
struct Demand<'a> {
    condition: &'a Condition,
    /// The scan, and the values there.
    unmet: Option<(u64, String)>,
    nearest: Nearest,
}

impl<'a> Demand<'a> {
    fn new(condition: &'a Condition) -> Self {
        Self {
            condition,
            unmet: None,
            nearest: Nearest::default(),
        }
    }

    fn values(&self, rows: &Rows<'_>, scan: u64) -> String {
        describe::values(rows, self.condition, scan)
    }

    fn seek(&mut self, rows: &Rows<'_>, next: &ops::Range<u64>) {
        let conditions = std::slice::from_ref(self.condition);
        self.nearest.look(rows, next, conditions);
    }

    /// `FALSE at scan 551, expected TRUE; it came at 553, 2 later`
    fn failure(&self, rows: &Rows<'_>, path: &str, key: &str, more: &str) -> Option<Failure> {
        let (scan, values) = self.unmet.as_ref()?;
        let nearest = self.nearest.text(*scan);
        Some(unmet(
            rows,
            (path, key),
            self.condition,
            (*scan, values),
            &format!("{nearest}{more}"),
        ))
    }
}

/// All conditions hold together in some scan of the range.
pub(super) struct By<'a> {
    that: &'a [Condition],
    held: Option<u64>,
    /// Those that do not hold at the deadline, and their values.
    unmet: Vec<(&'a Condition, String)>,
    nearest: Nearest,
}

impl<'a> By<'a> {
    pub(super) fn new(that: &'a [Condition]) -> Self {
        Self {
            that,
            held: None,
            unmet: Vec::new(),
            nearest: Nearest::default(),
        }
    }

    fn unmet(&self, rows: &Rows<'_>, scan: u64) -> Vec<(&'a Condition, String)> {
        let unmet = self.that.iter().filter(|condition| !rows.holds(condition, scan));
        unmet
            .map(|condition| (condition, describe::values(rows, condition, scan)))
            .collect()
    }
}

impl Judge for By<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        if self.held.is_some() {
            return;
        }
        let mut may_hold = rows.may_hold(self.that, stretch.inside.clone());
        self.held = may_hold.find(|&scan| rows.hold(self.that, scan));
        if self.held.is_some() {
            return;
        }
        self.nearest.to = stretch.deadline;
        if let Some(deadline) = stretch.deadline.filter(|scan| stretch.next.contains(scan)) {
            self.unmet = self.unmet(rows, deadline);
        }
        self.nearest.look(rows, &stretch.next, self.that);
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        let deadline = match within_run(rows, path, range) {
            Ok(scans) => *scans.end(),
            // A value before the end of the run is in time, for any length of the range.
            Err(_) if range.from < rows.count() && self.held.is_some() => return Vec::new(),
            Err(failure) => return vec![failure],
        };
        if self.held.is_some() {
            return Vec::new();
        }
        // Not all hold at the deadline, so at least one fails.
        let at_end = || self.unmet(rows, deadline);
        let failing = range.to.map_or_else(at_end, |_| self.unmet.clone());
        let nearest = self.nearest.text(deadline);
        let failing = failing.iter();
        failing
            .map(|(condition, values)| unmet(rows, (path, "that"), condition, (deadline, values), &nearest))
            .collect()
    }

    fn held(&self) -> Option<u64> {
        self.held
    }
}

/// All conditions hold in every scan of the range in which `during` holds.
pub(super) struct Always<'a> {
    during: &'a [Condition],
    each: Vec<(Demand<'a>, Listed)>,
}

impl<'a> Always<'a> {
    pub(super) fn new(during: &'a [Condition], that: &'a [Condition]) -> Self {
        let each = that.iter();
        let each = each.map(|condition| (Demand::new(condition), Listed::default()));
        Self {
            during,
            each: each.collect(),
        }
    }
}

impl Judge for Always<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        for (demand, broken) in &mut self.each {
            let signal = &demand.condition.signal;
            for scan in rows.may_fail(demand.condition, stretch.inside.clone()) {
                if rows.holds(demand.condition, scan)
                    || rows.too_early(signal, scan)
                    || !rows.hold(self.during, scan)
                {
                    continue;
                }
                if demand.unmet.is_none() {
                    demand.unmet = Some((scan, demand.values(rows, scan)));
                    demand.nearest.to = Some(scan);
                }
                broken.add(scan);
            }
            demand.seek(rows, &stretch.next);
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        if let Err(failure) = within_run(rows, path, range) {
            return vec![failure];
        }
        let each = self.each.iter();
        each.filter_map(|(demand, broken)| {
            demand.failure(rows, path, "always", &format!("; broken {broken}"))
        })
        .collect()
    }
}

/// The conditions hold together in no scan of the range in which `during` holds.
pub(super) struct Never<'a> {
    during: &'a [Condition],
    that: &'a [Condition],
    /// The first scan in which they do, and the values there.
    first: Option<(u64, String)>,
    held: Listed,
}

impl<'a> Never<'a> {
    pub(super) fn new(during: &'a [Condition], that: &'a [Condition]) -> Self {
        Self {
            during,
            that,
            first: None,
            held: Listed::default(),
        }
    }
}

impl Judge for Never<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        for scan in rows.may_hold(self.that, stretch.inside.clone()) {
            if !rows.hold(self.during, scan) || !rows.hold(self.that, scan) {
                continue;
            }
            self.first.get_or_insert_with(|| {
                let value = |condition: &Condition| {
                    format!("{} {}", condition.text, describe::values(rows, condition, scan))
                };
                (scan, Vec::from_iter(self.that.iter().map(value)).join(", "))
            });
            self.held.add(scan);
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        if let Err(failure) = within_run(rows, path, range) {
            return vec![failure];
        }
        let Some((first, values)) = &self.first else {
            return Vec::new();
        };
        let text = format!("{values} at scan {first}, expected never; it held {}", self.held);
        vec![failure(&format!("{path}.never"), Some(*first), text)]
    }
}

/// The conditions hold together in exactly one scan of the range.
pub(super) struct Once<'a> {
    that: &'a [Condition],
    held: Listed,
    nearest: Nearest,
}

impl<'a> Once<'a> {
    pub(super) fn new(that: &'a [Condition]) -> Self {
        Self {
            that,
            held: Listed::default(),
            nearest: Nearest::default(),
        }
    }
}

impl Judge for Once<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let may_hold = rows.may_hold(self.that, stretch.inside.clone());
        may_hold
            .filter(|scan| rows.hold(self.that, *scan))
            .for_each(|scan| self.held.add(scan));
        if self.held.first().is_none() {
            self.nearest.to = stretch.deadline;
            self.nearest.look(rows, &stretch.next, self.that);
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        let scans = match within_run(rows, path, range) {
            Ok(scans) => scans,
            Err(failure) => return vec![failure],
        };
        let path = format!("{path}.once");
        let what = describe::conditions(rows, self.that);
        match (self.held.first(), self.held.second()) {
            (Some(_), None) => Vec::new(),
            (None, _) => {
                let (start, end) = scans.into_inner();
                let nearest = self.nearest.text(end);
                let text = format!(
                    "{what} did not hold in scans {start} to {end}, expected exactly once; {nearest}"
                );
                vec![failure(&path, None, text)]
            }
            (Some(_), second) => {
                let text = format!("{what} held {}, expected exactly once", self.held);
                vec![failure(&path, second, text)]
            }
        }
    }

    fn held(&self) -> Option<u64> {
        self.held.first()
    }
}

/// At most one of the points is TRUE in every scan of the range.
pub(super) struct Exclusive<'a> {
    points: &'a [(String, Point)],
    /// The first scan with more, and their names.
    first: Option<(u64, String)>,
    broken: Listed,
}

impl<'a> Exclusive<'a> {
    pub(super) fn new(points: &'a [(String, Point)]) -> Self {
        Self {
            points,
            first: None,
            broken: Listed::default(),
        }
    }
}

impl Judge for Exclusive<'_> {
    fn look(&mut self, rows: &Rows<'_>, stretch: &Stretch) {
        let same_since = self.points.iter().map(|(_, point)| rows.point_same_since(*point));
        let mut inside = stretch.inside.clone();
        if same_since.max().unwrap_or(0) <= inside.start && raised(rows, self.points, inside.start).len() <= 1
        {
            inside.end = inside.start;
        }
        for scan in inside {
            let raised = raised(rows, self.points, scan);
            if raised.len() > 1 {
                self.first.get_or_insert_with(|| (scan, raised.join(" and ")));
                self.broken.add(scan);
            }
        }
    }

    fn failures(&self, rows: &Rows<'_>, path: &str, range: Range) -> Vec<Failure> {
        if let Err(failure) = within_run(rows, path, range) {
            return vec![failure];
        }
        let Some((first, names)) = &self.first else {
            return Vec::new();
        };
        let text = format!(
            "{names} are TRUE together at scan {first}; at most one may be; broken {}",
            self.broken
        );
        vec![failure(&format!("{path}.exclusive"), Some(*first), text)]
    }
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

pub(super) fn beyond(rows: &Rows<'_>, path: &str, scan: u64) -> Failure {
    let end = match rows.count().checked_sub(1) {
        Some(last) => format!("the run ended with scan {last}"),
        None => "the run has no scans".to_owned(),
    };
    failure(path, None, format!("it speaks of scan {scan}, but {end}"))
}

fn unmet(
    rows: &Rows<'_>,
    (path, key): (&str, &str),
    condition: &Condition,
    (scan, values): (u64, &str),
    nearest: &str,
) -> Failure {
    let text = format!(
        "{values} at scan {scan}, expected {}; {nearest}",
        describe::test(rows, &condition.signal, &condition.test)
    );
    failure(&format!("{path}.{key}.{}", condition.text), Some(scan), text)
}

/// The scan nearest to a given one in which something holds, among the rows so far.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Nearest {
    /// The given scan; `None` while it is still to come.
    pub(super) to: Option<u64>,
    /// The last one before it.
    earlier: Option<u64>,
    /// The first one after it.
    later: Option<u64>,
}

impl Nearest {
    pub(super) fn to(scan: u64) -> Self {
        Self {
            to: Some(scan),
            ..Self::default()
        }
    }

    /// Reads the next rows. Cost: the rows between the scan and the nearest ones.
    pub(super) fn look(&mut self, rows: &Rows<'_>, next: &ops::Range<u64>, conditions: &[Condition]) {
        let next = rows.may_hold(conditions, next.clone());
        let holds = |scan: u64| rows.hold(conditions, scan);
        let to = self.to.unwrap_or(u64::MAX);
        let mut before = next.start..next.end.min(to);
        self.earlier = before.rfind(|&scan| holds(scan)).or(self.earlier);
        if self.later.is_none() {
            let mut after = next.start.max(to.saturating_add(1))..next.end;
            self.later = after.find(|&scan| holds(scan));
        }
    }

    /// Of two equally near scans the later one.
    pub(super) fn text(&self, scan: u64) -> String {
        let later = self.later.map(|later| (later, later - scan));
        let earlier = self.earlier.map(|earlier| (earlier, scan - earlier));
        match (earlier, later) {
            (Some((earlier, away)), None) => format!("it was so at {earlier}, {away} earlier"),
            (Some((earlier, back)), Some((_, on))) if back < on => {
                format!("it was so at {earlier}, {back} earlier")
            }
            (_, Some((later, away))) => format!("it came at {later}, {away} later"),
            (None, None) => "it was so in no scan".to_owned(),
        }
    }
}

/// Scans in which a claim fails: how many, the first few and the last.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Listed {
    count: u64,
    named: [u64; SCANS_NAMED],
    last: u64,
}

impl Listed {
    /// The next scan.
    pub(super) fn add(&mut self, scan: u64) {
        let place = usize::try_from(self.count).unwrap_or(usize::MAX);
        if let Some(place) = self.named.get_mut(place) {
            *place = scan;
        }
        self.count += 1;
        self.last = scan;
    }

    /// Those of both, which have none in common.
    pub(super) fn with(&self, other: &Self) -> Self {
        let mut named: Vec<u64> = self.named().chain(other.named()).collect();
        named.sort_unstable();
        let mut both = Self::default();
        named.into_iter().for_each(|scan| both.add(scan));
        both.count = self.count + other.count;
        both.last = self.last.max(other.last);
        both
    }

    pub(super) fn count(&self) -> u64 {
        self.count
    }

    pub(super) fn first(&self) -> Option<u64> {
        self.named().next()
    }

    fn second(&self) -> Option<u64> {
        self.named().nth(1)
    }

    pub(super) fn last(&self) -> Option<u64> {
        (self.count > 0).then_some(self.last)
    }

    fn named(&self) -> impl Iterator<Item = u64> {
        self.named.into_iter().zip(0..self.count).map(|(scan, _)| scan)
    }
}

/// `in 3 scans: 7, 8, 9`
impl std::fmt::Display for Listed {
    fn fmt(&self, out: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        let Self { count, last, .. } = self;
        let named: Vec<_> = self.named().map(|scan| scan.to_string()).collect();
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

pub(super) fn failure(path: &str, scan: Option<u64>, text: String) -> Failure {
    Failure {
        path: path.to_owned(),
        scan,
        text,
    }
}
