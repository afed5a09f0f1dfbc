//! The first difference of two traces.

use std::collections::BTreeSet;
use std::fmt;

use crate::column::Cell;
use crate::events::{Event, VARIABLES, lines, row_events, same};
use crate::exact::ordered;
use crate::number::{cell_text, time_literal};
use crate::trace::Trace;

/// Largest number of signals that the text of a difference names.
const SIGNALS_SHOWN: usize = 20;

/// If more representable numbers than this are between two values, the text shows the values instead.
const ULPS_TOLD: u64 = 1_000_000;

/// Events shown before the first difference, and after it on either side.
const EVENTS_SHOWN: usize = 4;

/// The largest difference of a real number from the expected one: `absolute` plus `relative` times the
/// magnitude of the expected one.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// In the unit of the signal; finite and not negative.
    pub absolute: f64,
    /// Of the expected value; finite and not negative.
    pub relative: f64,
}

impl Default for Tolerance {
    /// 1e-6 and 1e-9: no machine notices this if the unit is the millimetre or the degree. Reordered arithmetic
    /// differs by much less, another plan by more.
    fn default() -> Self {
        Self {
            absolute: 1e-6,
            relative: 1e-9,
        }
    }
}

impl Tolerance {
    /// The largest difference of a value from `expected`.
    #[must_use]
    pub fn allowed(self, expected: f64) -> f64 {
        self.absolute + self.relative * expected.abs()
    }

    /// Whether `found` passes for `expected`. Infinities and NaN pass only for themselves.
    #[must_use]
    pub fn passes(self, expected: f64, found: f64) -> bool {
        let apart = (expected - found).abs();
        let finite = expected.is_finite() && found.is_finite();
        (finite && apart <= self.allowed(expected))
            || expected == found
            || (expected.is_nan() && found.is_nan())
    }
}

/// How exactly a trace must agree with another one.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub enum Yardstick {
    /// To the bit, and with the same columns.
    #[default]
    Exact,
    /// Booleans, states, names and whole numbers must agree in every scan. So all events agree. Real numbers must
    /// agree within a tolerance. Columns that only the actual trace has, for example from a later version, do not
    /// count.
    Events(Tolerance),
}

/// How two traces differ.
#[derive(Clone, Debug, PartialEq)]
pub struct Difference {
    /// Rows of the expected and of the actual trace.
    pub scans: (usize, usize),
    /// Cycles (ns) of the expected and of the actual trace.
    pub cycles_ns: (u64, u64),
    /// Columns that only the expected trace has.
    pub only_expected: Vec<String>,
    /// Columns that only the actual trace has.
    pub only_actual: Vec<String>,
    /// The first scan in which a column of both differs; `None` if the common rows are equal.
    pub first: Option<ScanDifference>,
}

/// The first scan in which two traces differ.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanDifference {
    /// The scan.
    pub scan: usize,
    /// Its time (ns) by the cycle of the actual trace.
    pub time_ns: u64,
    /// The signals that differ in it, in the column order of the expected trace; never empty.
    pub signals: Vec<SignalDifference>,
    /// The last few events before it, which both traces have.
    pub before: Vec<Event>,
    /// The next few events of the expected trace, from this scan on.
    pub expected: Vec<Event>,
    /// The next few events of the actual trace, from this scan on.
    pub actual: Vec<Event>,
}

/// One signal that differs.
#[derive(Clone, Debug, PartialEq)]
pub struct SignalDifference {
    /// Name of the column.
    pub name: String,
    /// Its expected value.
    pub expected: String,
    /// The actual value.
    pub actual: String,
    /// The number of representable numbers between the two, if both are finite.
    pub ulps: Option<u64>,
    /// The permitted difference, if a tolerance was given and both are finite numbers.
    pub allowed: Option<f64>,
}

/// Compares two traces scan by scan, to the bit; `None` if they do not differ. Columns are matched by
/// name; headers other than the cycle, and notes, do not count.
#[must_use]
pub fn compare(expected: &Trace, actual: &Trace) -> Option<Difference> {
    compare_by(expected, actual, Yardstick::Exact)
}

/// The same as [`compare`], by a yardstick.
#[must_use]
pub fn compare_by(expected: &Trace, actual: &Trace, yardstick: Yardstick) -> Option<Difference> {
    let pairs = pairs(expected, actual);
    let only_actual = match yardstick {
        Yardstick::Exact => missing(actual, expected),
        Yardstick::Events(_) => Vec::new(),
    };
    let difference = Difference {
        scans: (expected.scans(), actual.scans()),
        cycles_ns: (expected.header().cycle_ns, actual.header().cycle_ns),
        only_expected: missing(expected, actual),
        only_actual,
        first: first_difference(expected, actual, &pairs, yardstick),
    };
    let equal = difference.first.is_none()
        && difference.scans.0 == difference.scans.1
        && difference.cycles_ns.0 == difference.cycles_ns.1
        && difference.only_expected.is_empty()
        && difference.only_actual.is_empty();
    (!equal).then_some(difference)
}

/// Columns that both traces have, by name.
pub(crate) fn pairs(expected: &Trace, actual: &Trace) -> Vec<(usize, usize)> {
    let columns = expected.columns().iter().enumerate();
    columns
        .filter_map(|(at, column)| Some((at, actual.column(&column.name)?)))
        .collect()
}

/// How close a trace is to one that it agrees with.
#[derive(Clone, Debug, PartialEq)]
pub struct Closeness {
    /// The number of values that are not equal to the bit.
    pub values: usize,
    /// The signal with the largest difference, relative to its tolerance.
    pub signal: String,
    /// The scan of that difference.
    pub scan: usize,
    /// The difference (unit of the signal).
    pub apart: f64,
}

impl fmt::Display for Closeness {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            values,
            signal,
            scan,
            apart,
        } = self;
        let plural = if *values == 1 { "" } else { "s" };
        write!(
            out,
            "{values} value{plural} within tolerance, the furthest {signal} in scan {scan} by {apart:.1e}"
        )
    }
}

/// The differences of the real numbers of a trace from the expected ones; `None` if there are none.
#[must_use]
pub fn closeness(expected: &Trace, actual: &Trace, tolerance: Tolerance) -> Option<Closeness> {
    let mut values = 0;
    let mut worst: Option<(f64, Closeness)> = None;
    for (at, other) in pairs(expected, actual) {
        for (scan, (a, b)) in expected.reals(at).zip(actual.reals(other)).enumerate() {
            if a.to_bits() == b.to_bits() {
                continue;
            }
            values += 1;
            let apart = (a - b).abs();
            let share = apart / tolerance.allowed(a);
            if worst.as_ref().is_none_or(|(most, _)| share > *most) {
                let signal = expected.columns().get(at)?.name.clone();
                let found = Closeness {
                    values,
                    signal,
                    scan,
                    apart,
                };
                worst = Some((share, found));
            }
        }
    }
    worst.map(|(_, found)| Closeness { values, ..found })
}

fn missing(from: &Trace, in_other: &Trace) -> Vec<String> {
    let names = from.columns().iter().map(|column| &column.name);
    names
        .filter(|name| in_other.column(name).is_none())
        .cloned()
        .collect()
}

fn first_difference(
    expected: &Trace,
    actual: &Trace,
    pairs: &[(usize, usize)],
    yardstick: Yardstick,
) -> Option<ScanDifference> {
    let common = expected.scans().min(actual.scans());
    let (scan, signals) = (0..common).find_map(|scan| {
        let signals: Vec<_> = pairs
            .iter()
            .filter_map(|&pair| differs(expected, actual, pair, scan, yardstick))
            .collect();
        (!signals.is_empty()).then_some((scan, signals))
    })?;
    let shared: BTreeSet<&str> = pairs
        .iter()
        .filter_map(|&(at, _)| Some(expected.columns().get(at)?.subject()))
        .collect();
    let from_here = |trace| {
        let events = row_events(trace).into_iter();
        // The events of a block that only one trace has would hide those of the others.
        let events =
            events.filter(|event| event.subject == VARIABLES || shared.contains(event.subject.as_str()));
        events
            .skip_while(|event| event.scan < scan)
            .take(EVENTS_SHOWN)
            .collect()
    };
    let mut before: Vec<Event> = row_events(actual)
        .into_iter()
        .take_while(|event| event.scan < scan)
        .collect();
    before.drain(..before.len().saturating_sub(EVENTS_SHOWN));
    Some(ScanDifference {
        scan,
        time_ns: actual.time_ns(scan),
        signals,
        before,
        expected: from_here(expected),
        actual: from_here(actual),
    })
}

fn differs(
    expected: &Trace,
    actual: &Trace,
    pair: (usize, usize),
    scan: usize,
    yardstick: Yardstick,
) -> Option<SignalDifference> {
    let a = expected.cell(scan, pair.0)?;
    let b = actual.cell(scan, pair.1)?;
    let tolerance = match yardstick {
        Yardstick::Exact => None,
        Yardstick::Events(tolerance) => Some(tolerance),
    };
    let passes = match (a, b, tolerance) {
        (Cell::Real(a), Cell::Real(b), Some(tolerance)) => tolerance.passes(a, b),
        _ => equal(a, b),
    };
    if passes {
        return None;
    }
    let ulps = match (a, b) {
        (Cell::Real(a), Cell::Real(b)) if a.is_finite() && b.is_finite() => {
            Some(ordered(a).abs_diff(ordered(b)))
        }
        _ => None,
    };
    let name = expected.columns().get(pair.0)?.name.clone();
    Some(SignalDifference {
        name,
        expected: cell_text(a),
        actual: cell_text(b),
        ulps,
        allowed: tolerance.and_then(|tolerance| match a {
            Cell::Real(a) if ulps.is_some() => Some(tolerance.allowed(a)),
            _ => None,
        }),
    })
}

/// A trace read without its header may store a column under another kind: then the meaning counts.
pub(crate) fn equal(a: Cell<'_>, b: Cell<'_>) -> bool {
    match (a, b) {
        (Cell::Integer(whole), Cell::Real(real)) | (Cell::Real(real), Cell::Integer(whole)) => {
            whole as f64 == real
        }
        _ if a.kind() == b.kind() => same(a, b),
        _ => cell_text(a) == cell_text(b),
    }
}

impl fmt::Display for Difference {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        match &self.first {
            Some(first) => write!(out, "{first}")?,
            None => writeln!(out, "no signal differs in the scans that both traces have")?,
        }
        if self.scans.0 != self.scans.1 {
            writeln!(out, "scans: expected {}, found {}", self.scans.0, self.scans.1)?;
        }
        if self.cycles_ns.0 != self.cycles_ns.1 {
            let [expected, actual] = [self.cycles_ns.0, self.cycles_ns.1].map(time_literal);
            writeln!(out, "cycle: expected {expected}, found {actual}")?;
        }
        for (columns, place) in [(&self.only_expected, "expected"), (&self.only_actual, "found")] {
            if !columns.is_empty() {
                writeln!(out, "columns only in what was {place}: {}", columns.join(", "))?;
            }
        }
        Ok(())
    }
}

impl fmt::Display for ScanDifference {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let signals = &self.signals;
        let plural = if signals.len() == 1 { "" } else { "s" };
        let time = time_literal(self.time_ns);
        writeln!(
            out,
            "first difference in scan {} ({time}), {} signal{plural}",
            self.scan,
            signals.len()
        )?;
        let shown = signals
            .get(..SIGNALS_SHOWN.min(signals.len()))
            .unwrap_or_default();
        let width = |text: fn(&SignalDifference) -> &String| {
            shown
                .iter()
                .map(|signal| text(signal).chars().count())
                .max()
                .unwrap_or(0)
        };
        let [name_width, expected_width] = [width(|signal| &signal.name), width(|signal| &signal.expected)];
        for SignalDifference {
            name,
            expected,
            actual,
            ulps,
            allowed,
        } in shown
        {
            write!(
                out,
                "  {name:<name_width$}  expected {expected:<expected_width$}  found {actual}"
            )?;
            match (ulps, allowed) {
                (_, Some(allowed)) => writeln!(out, "  (may be {allowed:.1e} apart)")?,
                (Some(ulps), None) if *ulps <= ULPS_TOLD => writeln!(out, "  ({ulps} ULP)")?,
                (_, None) => writeln!(out)?,
            }
        }
        if signals.len() > shown.len() {
            writeln!(out, "  and {} more", signals.len() - shown.len())?;
        }
        if !self.before.is_empty() {
            write!(out, "events before\n{}", lines(&self.before))?;
        }
        if self.expected == self.actual {
            if !self.actual.is_empty() {
                write!(out, "events from there on, in both\n{}", lines(&self.actual))?;
            }
            return Ok(());
        }
        for (title, events) in [("expected", &self.expected), ("found", &self.actual)] {
            let text = if events.is_empty() {
                "  none\n".to_owned()
            } else {
                lines(events)
            };
            write!(out, "{title} from there on\n{text}")?;
        }
        Ok(())
    }
}
