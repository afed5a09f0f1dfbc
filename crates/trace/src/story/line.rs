//! The place in the text of a program where two runs differ first.

use std::collections::BTreeMap;
use std::fmt;

use crate::compare::Difference;
use crate::header::Written;
use crate::number::cell_text;
use crate::trace::Trace;

/// Largest number of places that are shown.
const PLACES_MOST: usize = 3;

/// The variable of a program that differs first, and the statements that wrote it.
#[derive(Clone, Debug, PartialEq)]
pub struct Line {
    /// The scan.
    pub scan: usize,
    /// The variable: `cell.State`.
    pub signal: String,
    /// The expected value.
    pub expected: String,
    /// The found value.
    pub found: String,
    /// Statements that may have written it, at most three; those that write this value as a constant come
    /// first.
    pub places: Vec<String>,
    /// Whether they belong to the expected run, because in the other one the variable did not change.
    pub stayed: bool,
}

/// The statements by column.
fn written(trace: &Trace) -> BTreeMap<String, &[Written]> {
    let instances = trace.header().instances.iter();
    let pins = instances.flat_map(|instance| {
        let named = instance.pins.iter().filter(|pin| !pin.written.is_empty());
        named.map(|pin| (format!("{}.{}", instance.name, pin.name), pin.written.as_slice()))
    });
    pins.collect()
}

/// The first one in the text, among the variables that differ in the first scan that differs. None if anything else
/// differs in an earlier scan: the program is then not the cause.
pub(super) fn line(expected: &Trace, found: &Trace, difference: &Difference) -> Option<Line> {
    let first = difference.first.as_ref()?;
    let (before, after) = (written(expected), written(found));
    let lines = first.signals.iter().filter_map(|signal| {
        let own = after.get(&signal.name).or_else(|| before.get(&signal.name))?;
        let column = found.column(&signal.name)?;
        let then = first
            .scan
            .checked_sub(1)
            .and_then(|scan| found.cell(scan, column));
        let stayed = then.is_some_and(|cell| cell_text(cell) == signal.actual);
        let (list, value) = if stayed {
            (before.get(&signal.name).unwrap_or(own), &signal.expected)
        } else {
            (own, &signal.actual)
        };
        let exact = list.iter().filter(|it| it.value.as_ref() == Some(value));
        let others = list.iter().filter(|it| it.value.is_none());
        let places: Vec<_> = exact.chain(others).map(|it| it.at.clone()).collect();
        (!places.is_empty()).then(|| Line {
            scan: first.scan,
            signal: signal.name.clone(),
            expected: signal.expected.clone(),
            found: signal.actual.clone(),
            places: places.into_iter().take(PLACES_MOST).collect(),
            stayed,
        })
    });
    lines.min_by_key(|line| line.places.first().map(|place| in_order(place)))
}

/// A place in a form that sorts in text order.
fn in_order(place: &str) -> (String, u64, u64) {
    let mut parts = place.rsplitn(3, ':');
    let mut number = || parts.next().and_then(|part| part.parse().ok()).unwrap_or(0);
    let (column, line) = (number(), number());
    (parts.next().unwrap_or_default().to_owned(), line, column)
}

impl fmt::Display for Line {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scan,
            signal,
            expected,
            found,
            places,
            stayed,
        } = self;
        let places = places.join(" or ");
        if *stayed {
            write!(
                out,
                "{signal} in scan {scan}: it stays {found}; what was expected makes it {expected} at {places}"
            )
        } else {
            write!(
                out,
                "{signal} in scan {scan}: {found} instead of {expected}, written at {places}"
            )
        }
    }
}
