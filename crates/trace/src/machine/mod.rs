//! Compares a trace with the recording of a machine, within tolerances.
//!
//! All signals share one offset between the scan times of the trace and the sample times of the
//! recording: the scan at time t is compared with the recording at t + offset. Numbers are joined by
//! straight lines between samples. Values that stay until they change (truth values, whole numbers,
//! words) are compared as lists of edges.
//!
//! The work is proportional to scans plus samples, except for the fit of the offset, which reads the
//! recording at most [`FIT_SCANS`] times [`FIT_ROWS`] times.

mod curve;
mod edges;
mod offset;
mod show;

pub use offset::{FIT_ROWS, FIT_SCANS, Found};

use crate::column::Kind;
use crate::foreign::{Channel, Layout, Place, Reading, Recording, Wanted};
use crate::trace::Trace;
use std::collections::BTreeMap;

/// How a recording is compared with a trace.
#[derive(Clone, Debug, PartialEq)]
pub struct Map {
    /// The form of the recording.
    pub layout: Layout,
    /// The offset between the times of the two.
    pub offset: Offset,
    /// The part of the trace (ns) that is compared and must be recorded; the common part if `None`.
    pub window: Option<(i64, i64)>,
    /// The signals; at least one.
    pub signals: Vec<Signal>,
}

/// A signal of the trace and its column in the recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Signal {
    /// Its name in the trace.
    pub name: String,
    /// Its column in the recording.
    pub place: Place,
    /// The permitted difference of its times (ns), 0 or more.
    pub time_tolerance: i64,
    /// What is compared.
    pub measure: Measure,
}

/// The comparison of a signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Measure {
    /// Numbers: recorded value times `factor`, plus `zero`, is the expected value of the trace.
    Curve {
        /// Units of the trace per unit of the recording, with the sign; not 0.
        factor: f64,
        /// The trace's value for 0 of the recording.
        zero: f64,
        /// The permitted difference, in units of the trace; 0 or more.
        tolerance: f64,
    },
    /// A truth value; the recording has the opposite if `invert`.
    Bool {
        /// Whether the recording has the opposite.
        invert: bool,
    },
    /// A whole number.
    Whole,
    /// A word, and the names of its words in the recording.
    Word(BTreeMap<String, String>),
}

impl Measure {
    /// Whether a column of this kind is compared as numbers, by [`Self::Curve`], or otherwise as edges.
    #[must_use]
    pub const fn is_curve(kind: Kind) -> bool {
        matches!(kind, Kind::Real)
    }
}

/// How the offset is found; recording time = trace time + offset.
#[derive(Clone, Debug, PartialEq)]
pub enum Offset {
    /// It is known (ns).
    Fixed(i64),
    /// The named edge is at the same moment in both.
    Edge {
        /// A signal of the map that is compared by its edges.
        signal: String,
        /// The value it changes to, as traces write it.
        to: String,
        /// The number of this change, from 1.
        number: usize,
    },
    /// The offset with the least mean square of the differences of a curve.
    Fit {
        /// A signal of the map that is a curve.
        signal: String,
        /// The least offset tried (ns).
        from: i64,
        /// The largest (ns), less than [`FIT_SCANS`] cycles above.
        to: i64,
    },
}

/// The reason why a recording and a trace cannot be compared.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("{0}")]
pub struct NotComparable(pub String);

/// The result of a comparison.
#[derive(Clone, Debug, PartialEq)]
pub struct Comparison {
    /// The offset and how it was found.
    pub offset: Found,
    /// The first and the last scan that were compared.
    pub scans: (usize, usize),
    /// Scans of the trace.
    pub scans_of_trace: usize,
    /// The cycle (ns).
    pub cycle_ns: u64,
    /// The length (ns) of the recording, and the lengths of its parts before and behind the compared one.
    pub recorded: (i64, i64, i64),
    /// One for each signal of the map.
    pub signals: Vec<Compared>,
}

/// The result for one signal.
#[derive(Clone, Debug, PartialEq)]
pub struct Compared {
    /// Its name in the trace.
    pub name: String,
    /// The permitted difference of its times (ns).
    pub time_tolerance: i64,
    /// The finding.
    pub finding: Finding,
}

/// The findings of a signal.
#[derive(Clone, Debug, PartialEq)]
pub enum Finding {
    /// A curve.
    Curve {
        /// The permitted difference.
        tolerance: f64,
        /// The scan with the largest deviation.
        worst: Deviation,
        /// The first scan outside the tolerance.
        first: Option<Deviation>,
        /// Scans outside the tolerance.
        outside: usize,
    },
    /// Edges.
    Edges {
        /// Number of edges with a counterpart.
        matched: usize,
        /// The largest distance (ns) of two edges that belong together.
        farthest: i64,
        /// Edges without a counterpart, in order of time, and a wrong value at the start.
        wrong: Vec<EdgeFault>,
    },
}

/// The difference between a curve and the recording in a scan.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Deviation {
    /// The scan.
    pub scan: usize,
    /// The value of the trace.
    pub found: f64,
    /// The nearest recorded value within the tolerance of time, in units of the trace.
    pub recorded: f64,
}

impl Deviation {
    /// The distance, 0 or more.
    #[must_use]
    pub fn size(&self) -> f64 {
        (self.found - self.recorded).abs()
    }
}

/// An edge without a counterpart.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct EdgeFault {
    /// Its time, in times of the trace (ns).
    pub at_ns: i64,
    /// The value from then on.
    pub to: String,
    /// The side that has the edge.
    pub of: Side,
}

/// The side that has an edge.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// It was recorded, and the trace has none.
    Recorded,
    /// The trace has it, and none was recorded.
    Trace,
    /// No edge: the trace starts with this value, and another was recorded.
    Start,
}

impl Finding {
    /// Whether the signal keeps its tolerances.
    #[must_use]
    pub fn holds(&self) -> bool {
        match self {
            Self::Curve { outside, .. } => *outside == 0,
            Self::Edges { wrong, .. } => wrong.is_empty(),
        }
    }
}

impl Comparison {
    /// Whether every signal keeps its tolerances.
    #[must_use]
    pub fn holds(&self) -> bool {
        self.signals.iter().all(|signal| signal.finding.holds())
    }
}

impl Map {
    /// The columns to read of the recording, in the order of the signals.
    #[must_use]
    pub fn wanted(&self) -> Vec<Wanted> {
        let wanted = |signal: &Signal| Wanted {
            signal: signal.name.clone(),
            place: signal.place.clone(),
            reading: match &signal.measure {
                Measure::Curve { .. } => Reading::Curve,
                Measure::Bool { .. } => Reading::Bool,
                Measure::Whole => Reading::Whole,
                Measure::Word(words) => Reading::Word(words.clone()),
            },
        };
        self.signals.iter().map(wanted).collect()
    }
}

/// A signal with the data of both sides.
struct Pair<'p> {
    signal: &'p Signal,
    /// Its column in the trace.
    column: usize,
    channel: Channel,
}

/// Compares a trace with a recording that was read for [`Map::wanted`].
///
/// # Errors
/// A trace without cycle or rows, a signal it does not have, an offset that cannot be found, nothing in common.
pub fn compare(recording: &Recording, trace: &Trace, map: &Map) -> Result<Comparison, NotComparable> {
    let pairs = pairs(recording, trace, map)?;
    let cycle = cycle(trace)?;
    let spans = || pairs.iter().filter_map(|pair| pair.channel.span());
    let (Some(start), Some(end)) = (
        spans().map(|(start, _)| start).max(),
        spans().map(|(_, end)| end).min(),
    ) else {
        return Err(NotComparable("the map names no signal".to_owned()));
    };
    let offset = offset::find(&pairs, trace, map, cycle)?;
    let last = i64::try_from(trace.scans() - 1).unwrap_or(i64::MAX);
    let trace_end = last.saturating_mul(cycle);
    // The common part, in times of the trace.
    let both = (
        start.saturating_sub(offset.ns).max(0),
        end.saturating_sub(offset.ns).min(trace_end),
    );
    let (from, to) = map.window.unwrap_or(both);
    if map.window.is_some() && (from < both.0 || to > both.1) {
        return Err(NotComparable(format!(
            "the map's window {} to {} is not all there: trace and recording have {} in common (with offset {})",
            show::time(from),
            show::time(to),
            show::range(both),
            show::time(offset.ns)
        )));
    }
    let (first, last) = (
        from.saturating_add(cycle - 1).div_euclid(cycle),
        to.div_euclid(cycle),
    );
    let (Ok(first), Ok(last)) = (usize::try_from(first), usize::try_from(last)) else {
        return Err(nothing(&offset, (start, end), trace_end));
    };
    if first > last {
        return Err(nothing(&offset, (start, end), trace_end));
    }
    let signals = pairs
        .iter()
        .map(|pair| Compared {
            name: pair.signal.name.clone(),
            time_tolerance: pair.signal.time_tolerance,
            finding: match (&pair.channel, &pair.signal.measure) {
                (Channel::Curve(samples), Measure::Curve { tolerance, .. }) => curve::compare(
                    samples,
                    trace.reals(pair.column).enumerate().take(last + 1).skip(first),
                    curve::Tolerances {
                        value: *tolerance,
                        time: pair.signal.time_tolerance,
                    },
                    |scan| scan_ns(scan, cycle).saturating_add(offset.ns),
                ),
                _ => {
                    let recorded = edges::recorded(pair, -offset.ns);
                    let found = edges::of_trace(trace, pair.column, cycle);
                    edges::compare(&recorded, &found, (from, to), pair.signal.time_tolerance)
                }
            },
        })
        .collect();
    let recorded_start = spans().map(|(start, _)| start).min().unwrap_or(start);
    let recorded_end = spans().map(|(_, end)| end).max().unwrap_or(end);
    Ok(Comparison {
        scans: (first, last),
        scans_of_trace: trace.scans(),
        cycle_ns: trace.header().cycle_ns,
        recorded: (
            recorded_end - recorded_start,
            (from.saturating_add(offset.ns) - recorded_start).max(0),
            (recorded_end - to.saturating_add(offset.ns)).max(0),
        ),
        offset,
        signals,
    })
}

fn nothing(offset: &Found, recorded: (i64, i64), trace_end: i64) -> NotComparable {
    NotComparable(format!(
        "nothing to compare: the trace lasts {}, the recording {} of it with offset {}",
        show::range((0, trace_end)),
        show::range((
            recorded.0.saturating_sub(offset.ns),
            recorded.1.saturating_sub(offset.ns)
        )),
        show::time(offset.ns)
    ))
}

fn cycle(trace: &Trace) -> Result<i64, NotComparable> {
    let cycle = i64::try_from(trace.header().cycle_ns).unwrap_or(0);
    let scans = i64::try_from(trace.scans()).unwrap_or(i64::MAX);
    if cycle == 0 || scans == 0 || scans.checked_mul(cycle).is_none() {
        return Err(NotComparable(
            "the trace has no rows or no cycle time: write it with `standstill run --trace`".to_owned(),
        ));
    }
    Ok(cycle)
}

fn scan_ns(scan: usize, cycle: i64) -> i64 {
    i64::try_from(scan).unwrap_or(i64::MAX).saturating_mul(cycle)
}

fn pairs<'p>(recording: &Recording, trace: &Trace, map: &'p Map) -> Result<Vec<Pair<'p>>, NotComparable> {
    map.signals
        .iter()
        .zip(&recording.channels)
        .map(|(signal, channel)| {
            let column = trace
                .column(&signal.name)
                .ok_or_else(|| NotComparable(format!("the trace has no signal `{}`", signal.name)))?;
            let mut channel = channel.clone();
            match (&mut channel, &signal.measure) {
                (Channel::Curve(samples), Measure::Curve { factor, zero, .. }) => {
                    for (_, value) in samples {
                        *value = *value * factor + zero;
                    }
                }
                (Channel::Steps(steps), Measure::Bool { invert: true }) => {
                    for (_, value) in &mut steps.changes {
                        *value = if value == "TRUE" { "FALSE" } else { "TRUE" }.to_owned();
                    }
                }
                _ => {}
            }
            Ok(Pair {
                signal,
                column,
                channel,
            })
        })
        .collect()
}
