//! Where two traces part.

use std::collections::BTreeSet;
use std::fmt;

use crate::column::Cell;
use crate::events::{Event, VARIABLES, lines, row_events, same};
use crate::exact::ordered;
use crate::number::{cell_text, time_literal};
use crate::trace::Trace;

/// Signals that the text of a difference names at most.
const SIGNALS_SHOWN: usize = 20;

/// Events shown before the first difference, and after it on either side.
const EVENTS_SHOWN: usize = 4;

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
    /// The first scan in which a column of both differs; `None` if the rows that both have are equal.
    pub first: Option<ScanDifference>,
}

/// The first scan in which two traces differ.
#[derive(Clone, Debug, PartialEq)]
pub struct ScanDifference {
    /// The scan.
    pub scan: usize,
    /// Its time (ns) by the cycle of the actual trace.
    pub time_ns: u64,
    /// What differs in it, in the column order of the expected trace; never empty.
    pub signals: Vec<SignalDifference>,
    /// The last few events before it, which both traces have.
    pub before: Vec<Event>,
    /// The next few events of the expected trace, from this scan on.
    pub expected: Vec<Event>,
    /// The next few events of the actual trace, from this scan on.
    pub actual: Vec<Event>,
}

/// One signal that differs.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct SignalDifference {
    /// Name of the column.
    pub name: String,
    /// Its expected value.
    pub expected: String,
    /// What was found.
    pub actual: String,
    /// How many representable numbers lie between the two, for finite numbers.
    pub ulps: Option<u64>,
}

/// Compares two traces scan by scan, to the bit; `None` if they do not differ. Columns are matched by
/// name; headers other than the cycle, and notes, do not count.
#[must_use]
pub fn compare(expected: &Trace, actual: &Trace) -> Option<Difference> {
    let pairs: Vec<(usize, usize)> = expected
        .columns()
        .iter()
        .enumerate()
        .filter_map(|(at, column)| Some((at, actual.column(&column.name)?)))
        .collect();
    let difference = Difference {
        scans: (expected.scans(), actual.scans()),
        cycles_ns: (expected.header().cycle_ns, actual.header().cycle_ns),
        only_expected: missing(expected, actual),
        only_actual: missing(actual, expected),
        first: first_difference(expected, actual, &pairs),
    };
    let equal = difference.first.is_none()
        && difference.scans.0 == difference.scans.1
        && difference.cycles_ns.0 == difference.cycles_ns.1
        && difference.only_expected.is_empty()
        && difference.only_actual.is_empty();
    (!equal).then_some(difference)
}

fn missing(from: &Trace, in_other: &Trace) -> Vec<String> {
    let names = from.columns().iter().map(|column| &column.name);
    names
        .filter(|name| in_other.column(name).is_none())
        .cloned()
        .collect()
}

fn first_difference(expected: &Trace, actual: &Trace, pairs: &[(usize, usize)]) -> Option<ScanDifference> {
    let common = expected.scans().min(actual.scans());
    let (scan, signals) = (0..common).find_map(|scan| {
        let signals: Vec<_> = pairs
            .iter()
            .filter_map(|&pair| differs(expected, actual, pair, scan))
            .collect();
        (!signals.is_empty()).then_some((scan, signals))
    })?;
    let shared: BTreeSet<&str> = pairs
        .iter()
        .filter_map(|&(at, _)| Some(expected.columns().get(at)?.subject()))
        .collect();
    let from_here = |trace| {
        let events = row_events(trace).into_iter();
        // A block that only one trace has would hide what became of the others.
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

fn differs(expected: &Trace, actual: &Trace, pair: (usize, usize), scan: usize) -> Option<SignalDifference> {
    let a = expected.cell(scan, pair.0)?;
    let b = actual.cell(scan, pair.1)?;
    if equal(a, b) {
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
    })
}

/// A trace read without its header may hold a column under another kind: then the meaning counts.
fn equal(a: Cell<'_>, b: Cell<'_>) -> bool {
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
        } in shown
        {
            write!(
                out,
                "  {name:<name_width$}  expected {expected:<expected_width$}  found {actual}"
            )?;
            match ulps {
                Some(ulps) => writeln!(out, "  ({ulps} ULP)")?,
                None => writeln!(out)?,
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
