//! The likely cause of the difference between two traces.
//!
//! It is found from the traces alone: from the differences of their headers, from the first differences and the
//! order of their computation, and from the relation of the events from there on. In a scan, an earlier cause is
//! listed before later ones.

use crate::column::{Column, Kind, Role};
use crate::compare::{Difference, ScanDifference, SignalDifference};
use crate::events::{Event, VARIABLES, row_events};
use crate::header::{Axis, Limits};
use crate::story::Extent;
use crate::trace::Trace;
use std::collections::{BTreeMap, BTreeSet};

/// A difference below this share of the largest value of a column is rounding.
const ROUNDING: f64 = 1e-9;

/// A possible cause of a difference.
#[derive(Clone, Debug, PartialEq)]
pub enum Cause {
    /// The runs have other cycles (ns): expected and found.
    Cycle(u64, u64),
    /// The common rows are equal; these are the numbers of rows.
    Length(usize, usize),
    /// The headers have other limits for an axis.
    Limits(String, Vec<Setting>),
    /// Blocks, axes or variables that only one of the runs has: expected and found.
    Subjects(Vec<String>, Vec<String>),
    /// The same blocks are called in another order.
    Order {
        /// The first block that is called at another position.
        expected: String,
        /// The block that is called there instead.
        found: String,
    },
    /// An input variable gets another value, or gets it in another scan.
    Variable {
        /// The first difference.
        signal: SignalDifference,
        /// The found run has the expected value this many scans later, if it has it at all.
        later: Option<i64>,
    },
    /// An input pin gets another value.
    Parameter(Vec<SignalDifference>),
    /// A fault or a refusal in only one of the runs.
    Fault {
        /// The fault or refusal.
        event: Event,
        /// Whether it is in the found run.
        in_found: bool,
    },
    /// The drive responds differently to the same set-points.
    Feedback(String),
    /// The same events in the same scans; numbers differ by rounding. The difference is given relative, and in ULPs
    /// at first.
    Rounding {
        /// Largest difference as a share of the largest value of its column.
        share: f64,
        /// ULPs between the first values that differ; the largest number of that scan.
        ulps: Option<u64>,
    },
    /// The same events in the same scans, but other set-points between them.
    Path,
    /// The same events, this many scans later (earlier if negative).
    Shift(i64),
    /// The same events in the same order, at changing distances: the first and the last, in scans.
    Drift(i64, i64),
    /// Other events: the first that is missing, and the first that is new.
    Events {
        /// Expected, and not found from there on.
        missing: Option<Event>,
        /// Found, and not expected from there on.
        new: Option<Event>,
    },
}

/// A setting with its expected and its found value; `None` is no limit.
#[derive(Clone, Debug, PartialEq)]
pub struct Setting {
    /// Its key in a script.
    pub name: &'static str,
    /// The expected value.
    pub expected: Option<f64>,
    /// The found value.
    pub found: Option<f64>,
}

/// All causes that the traces support, the likeliest first.
pub fn causes(
    expected: &Trace,
    found: &Trace,
    difference: &Difference,
    extent: Option<&Extent>,
) -> Vec<Cause> {
    let mut causes = Vec::new();
    let (before, after) = difference.cycles_ns;
    if before != after {
        causes.push(Cause::Cycle(before, after));
    }
    causes.extend(limits(expected, found));
    if !difference.only_expected.is_empty() || !difference.only_actual.is_empty() {
        let subjects = |names: &[String]| {
            let mut subjects: Vec<String> = names
                .iter()
                .map(|name| {
                    name.split_once('.')
                        .map_or(name.as_str(), |(subject, _)| subject)
                        .to_owned()
                })
                .collect();
            subjects.dedup();
            subjects
        };
        causes.push(Cause::Subjects(
            subjects(&difference.only_expected),
            subjects(&difference.only_actual),
        ));
    }
    let order = order(expected, found);
    let ordered = order.is_none();
    causes.extend(order);
    match (&difference.first, extent) {
        (Some(first), Some(extent)) => causes.push(of_rows(expected, found, first, extent, ordered)),
        _ if difference.scans.0 != difference.scans.1 => {
            causes.push(Cause::Length(difference.scans.0, difference.scans.1));
        }
        _ => {}
    }
    causes
}

fn limits(expected: &Trace, found: &Trace) -> Vec<Cause> {
    let mut causes = Vec::new();
    let axes = found.header().axes.iter();
    let axes: BTreeMap<&str, &Axis> = axes.map(|axis| (axis.name.as_str(), axis)).collect();
    for axis in &expected.header().axes {
        let Some(other) = axes.get(axis.name.as_str()) else {
            continue;
        };
        // A trace without its header has no limits to compare.
        let known = |axis: &Axis| axis.limits != Limits::default();
        let settings = settings(&axis.limits, &other.limits);
        if known(axis) && known(other) && !settings.is_empty() {
            causes.push(Cause::Limits(axis.name.clone(), settings));
        }
    }
    causes
}

fn settings(expected: &Limits, found: &Limits) -> Vec<Setting> {
    let all = [
        ("software_limits.min", expected.position_min, found.position_min),
        ("software_limits.max", expected.position_max, found.position_max),
        ("limits.velocity", expected.velocity, found.velocity),
        ("limits.acceleration", expected.acceleration, found.acceleration),
        ("limits.deceleration", expected.deceleration, found.deceleration),
        ("limits.jerk", expected.jerk, found.jerk),
        ("limits.snap", expected.snap, found.snap),
    ];
    all.into_iter()
        .filter(|(_, expected, found)| expected != found)
        .map(|(name, expected, found)| Setting {
            name,
            expected,
            found,
        })
        .collect()
}

/// The instances of both, in call order, if the order differs.
fn order(expected: &Trace, found: &Trace) -> Option<Cause> {
    let instances = |of: &Trace, other: &Trace| {
        let columns = of.columns().iter();
        let pins = columns.filter(|column| matches!(column.role, Role::InOut | Role::Input | Role::Output));
        let shared = pins.filter(|column| other.column(&column.name).is_some());
        let mut names: Vec<String> = shared.map(|column| column.subject().to_owned()).collect();
        names.dedup();
        names
    };
    let (expected, found) = (instances(expected, found), instances(found, expected));
    let (expected, found) = expected.into_iter().zip(found).find(|(a, b)| a != b)?;
    Some(Cause::Order { expected, found })
}

/// The causes that the rows support, from the first scan that differs on; `ordered` says that both call
/// blocks in the same order.
fn of_rows(expected: &Trace, found: &Trace, first: &ScanDifference, extent: &Extent, ordered: bool) -> Cause {
    let of = |signal: &SignalDifference| {
        let column = expected.column(&signal.name);
        column.and_then(|column| expected.columns().get(column))
    };
    let has_role =
        |signal: &&SignalDifference, role: Role| of(signal).is_some_and(|column| column.role == role);
    if let Some(signal) = first
        .signals
        .iter()
        .find(|signal| has_role(signal, Role::Variable))
    {
        return Cause::Variable {
            signal: signal.clone(),
            later: later(expected, found, &signal.name, first.scan),
        };
    }
    // Columns of pins are in the order of their computation. If both runs compute in the same order, and an input
    // differs before any output, it received another value.
    let pins = first
        .signals
        .iter()
        .filter(|signal| of(signal).is_some_and(is_pin));
    let given: Vec<SignalDifference> = pins
        .take_while(|signal| has_role(signal, Role::Input) || has_role(signal, Role::InOut))
        .cloned()
        .collect();
    if ordered && !given.is_empty() {
        return Cause::Parameter(given);
    }
    let shared = |events: Vec<Event>, other: &Trace| -> Vec<Event> {
        let subjects: BTreeSet<&str> = other.columns().iter().map(Column::subject).collect();
        let known = |event: &Event| event.subject == VARIABLES || subjects.contains(event.subject.as_str());
        events
            .into_iter()
            .filter(|event| event.scan >= first.scan && known(event))
            .collect()
    };
    let (before, after) = (
        shared(row_events(expected), found),
        shared(row_events(found), expected),
    );
    if let Some(fault) = fault(&before, &after, first.scan) {
        return fault;
    }
    if let Some(feedback) = first
        .signals
        .iter()
        .find(|signal| of(signal).is_some_and(is_actual))
        && first
            .signals
            .iter()
            .all(|signal| of(signal).is_some_and(|column| is_actual(column) || reads(column)))
    {
        return Cause::Feedback(feedback.name.clone());
    }
    if before == after {
        let share = extent.furthest.as_ref().map_or(0.0, |furthest| furthest.share);
        if share <= ROUNDING {
            let ulps = first.signals.iter().filter_map(|signal| signal.ulps).max();
            return Cause::Rounding { share, ulps };
        }
        return Cause::Path;
    }
    shifted(&before, &after, (expected.scans(), found.scans())).unwrap_or_else(|| Cause::Events {
        missing: only(&before, &after),
        new: only(&after, &before),
    })
}

fn is_pin(column: &Column) -> bool {
    matches!(column.role, Role::InOut | Role::Input | Role::Output)
}

/// Whether it is a value reported by a drive.
fn is_actual(column: &Column) -> bool {
    column.role == Role::AxisValue
        && (column.signal().starts_with("Actual") || column.signal() == "FollowingError")
}

/// Whether it is a number at an output, which may follow the feedback.
fn reads(column: &Column) -> bool {
    column.role == Role::Output && column.kind == Kind::Real
}

/// The number of scans after which `found` first has the value that `expected` has in `scan`; negative if earlier.
fn later(expected: &Trace, found: &Trace, name: &str, scan: usize) -> Option<i64> {
    let (at, other) = (expected.column(name)?, found.column(name)?);
    let distance = |from: usize, to: usize| i64::try_from(to.checked_sub(from)?).ok();
    let (wanted, got) = (expected.cell(scan, at)?, found.cell(scan, other)?);
    let before = scan.checked_sub(1).and_then(|scan| expected.cell(scan, at));
    if before == Some(got) {
        // No event has happened yet where one was expected.
        let come = found.cells(other).skip(scan).position(|cell| cell == wanted)?;
        return distance(scan, scan + come);
    }
    let come = expected.cells(at).skip(scan).position(|cell| cell == got)?;
    distance(scan, scan + come).map(|scans| -scans)
}

/// A fault or refusal in the first scan that differs, if only one of the runs has it.
fn fault(before: &[Event], after: &[Event], scan: usize) -> Option<Cause> {
    let tells = |event: &&Event| {
        let mut words = event.text.split_whitespace();
        event.scan == scan && words.any(|word| matches!(word, "ErrorStop" | "+Error"))
    };
    // An axis has more information about it than a block that failed because of it.
    let find = |events: &[Event], other: &[Event]| {
        let others = other.iter().filter(tells);
        let other: BTreeSet<_> = others.map(|event| (&event.subject, &event.text)).collect();
        let mut own: Vec<&Event> = events
            .iter()
            .filter(tells)
            .filter(|event| !other.contains(&(&event.subject, &event.text)))
            .collect();
        own.sort_by_key(|event| !event.text.contains("ErrorStop"));
        own.first().map(|event| (*event).clone())
    };
    let (event, in_found) = match (find(after, before), find(before, after)) {
        (Some(event), _) => (event, true),
        (None, Some(event)) => (event, false),
        (None, None) => return None,
    };
    Some(Cause::Fault { event, in_found })
}

/// The same events at other scans; events beyond the end of a run are not missed.
fn shifted(before: &[Event], after: &[Event], scans: (usize, usize)) -> Option<Cause> {
    let away = |a: &Event, b: &Event| Some(i64::try_from(b.scan).ok()? - i64::try_from(a.scan).ok()?);
    let first = away(before.first()?, after.first()?)?;
    let same = before
        .iter()
        .zip(after)
        .all(|(a, b)| (&a.subject, &a.text) == (&b.subject, &b.text));
    let distances: Vec<i64> = before.iter().zip(after).filter_map(|(a, b)| away(a, b)).collect();
    let last = *distances.last()?;
    let common = distances.len();
    let beyond = |event: &Event, by: i64, end: usize| {
        let scan = i64::try_from(event.scan).unwrap_or(i64::MAX).saturating_add(by);
        scan >= i64::try_from(end).unwrap_or(i64::MAX)
    };
    let fell_off = before
        .iter()
        .skip(common)
        .all(|event| beyond(event, last, scans.1))
        && after
            .iter()
            .skip(common)
            .all(|event| beyond(event, -last, scans.0));
    if !same || !fell_off {
        return None;
    }
    if distances.iter().all(|distance| *distance == first) {
        return (first != 0).then_some(Cause::Shift(first));
    }
    let first = distances.into_iter().find(|distance| *distance != 0)?;
    Some(Cause::Drift(first, last))
}

/// The first event that the other run does not have from there on, in any scan.
fn only(events: &[Event], other: &[Event]) -> Option<Event> {
    let other = other.iter().map(|event| (&event.subject, &event.text));
    let other: BTreeSet<_> = other.collect();
    let known = |event: &Event| other.contains(&(&event.subject, &event.text));
    events.iter().find(|event| !known(event)).cloned()
}
