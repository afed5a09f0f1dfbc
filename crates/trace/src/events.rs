//! What happened: one line per scan and subject in which something changed.
//!
//! Booleans, states, names and whole numbers make an event whenever they change. Reals and times may
//! change in every scan, so outputs of these kinds make none; inputs are told at rising edges of their
//! block, where they are taken, and when they change after having stood still.

use std::collections::BTreeMap;
use std::fmt::Write;

use crate::number::{cell_text, time_literal};
use crate::trace::{Cell, Column, Kind, Note, Role, Trace};

/// What the script's input variables are called together.
pub(crate) const VARIABLES: &str = "inputs";

/// What happened to one axis or instance in one scan.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Event {
    /// The scan.
    pub scan: usize,
    /// The axis or instance; `inputs` for the input variables.
    pub subject: String,
    /// One line, for example `+Done -Busy` or `Standstill -> DiscreteMotion`.
    pub text: String,
}

/// All events in the order of cause and effect: by scan, and in a scan the input variables, the
/// instances in call order, the axes in script order; notes follow the line of their subject.
#[must_use]
pub fn events(trace: &Trace) -> Vec<Event> {
    with_notes(trace, trace.notes())
}

/// The events that the rows alone tell: what a trace has that was read from a file.
pub(crate) fn row_events(trace: &Trace) -> Vec<Event> {
    with_notes(trace, &[])
}

fn with_notes(trace: &Trace, of_trace: &[Note]) -> Vec<Event> {
    let groups = groups(trace.columns());
    let mut notes: BTreeMap<usize, Vec<&Note>> = BTreeMap::new();
    for note in of_trace {
        notes.entry(note.scan).or_default().push(note);
    }
    let mut told = vec![None; trace.columns().len()];
    let mut events = Vec::new();
    for scan in 0..trace.scans() {
        let mut of_scan = notes.remove(&scan).unwrap_or_default();
        for group in &groups {
            let text = changes(trace, group, scan, &mut told);
            if !text.is_empty() {
                events.push(Event {
                    scan,
                    subject: group.subject.to_owned(),
                    text,
                });
            }
            of_scan.retain(|note| {
                let own = note.subject == group.subject;
                events.extend(own.then(|| note_event(note)));
                !own
            });
        }
        events.extend(of_scan.into_iter().map(note_event));
    }
    // Notes of scans that the trace does not hold: better late than lost.
    events.extend(notes.into_values().flatten().map(note_event));
    events
}

/// The events as aligned lines: scan, subject, what happened.
#[must_use]
pub fn events_text(trace: &Trace) -> String {
    lines(&events(trace))
}

/// The lines of some events, aligned with each other.
pub(crate) fn lines(events: &[Event]) -> String {
    let scan_width = events
        .iter()
        .map(|event| event.scan.to_string().len())
        .max()
        .unwrap_or(0)
        .max(5);
    let subject_width = events
        .iter()
        .map(|event| event.subject.chars().count())
        .max()
        .unwrap_or(0);
    events.iter().fold(String::new(), |mut text, event| {
        let Event {
            scan,
            subject,
            text: what,
        } = event;
        // Writing to a String cannot fail.
        let _ = writeln!(text, "{scan:>scan_width$}  {subject:<subject_width$}  {what}");
        text
    })
}

fn note_event(note: &Note) -> Event {
    Event {
        scan: note.scan,
        subject: note.subject.clone(),
        text: note.text.clone(),
    }
}

/// The columns of one subject.
struct Group<'a> {
    subject: &'a str,
    columns: Vec<(usize, &'a Column)>,
}

fn groups(columns: &[Column]) -> Vec<Group<'_>> {
    let mut groups: Vec<(u8, Group<'_>)> = Vec::new();
    for (at, column) in columns.iter().enumerate() {
        let (rank, subject) = match column.role {
            Role::Variable => (0, VARIABLES),
            Role::InOut | Role::Input | Role::Output => (1, column.subject()),
            Role::AxisState | Role::AxisValue => (2, column.subject()),
        };
        match groups
            .iter_mut()
            .find(|(r, group)| *r == rank && group.subject == subject)
        {
            Some((_, group)) => group.columns.push((at, column)),
            None => groups.push((
                rank,
                Group {
                    subject,
                    columns: vec![(at, column)],
                },
            )),
        }
    }
    groups.sort_by_key(|(rank, _)| *rank);
    groups.into_iter().map(|(_, group)| group).collect()
}

/// What changed in a group in a scan. `told` holds per column the input value that was told last.
fn changes<'t>(trace: &'t Trace, group: &Group<'_>, scan: usize, told: &mut [Option<Cell<'t>>]) -> String {
    let mut edges = Vec::new();
    let mut values = Vec::new();
    let mut starts = false;
    for &(at, column) in &group.columns {
        let now = trace.cell(scan, at);
        let before = scan.checked_sub(1).and_then(|scan| trace.cell(scan, at));
        match (column.kind, now, before) {
            (Kind::Bool, Some(Cell::Bool(now)), before) => {
                let before = before == Some(Cell::Bool(true));
                if now != before {
                    edges.push(format!("{}{}", if now { '+' } else { '-' }, column.signal()));
                    starts |= now && column.role == Role::Input;
                }
            }
            (Kind::Name, Some(now), before) if column.role == Role::AxisState => match before {
                None => values.push(cell_text(now)),
                Some(before) if before != now => {
                    values.push(format!("{} -> {}", cell_text(before), cell_text(now)));
                }
                Some(_) => {}
            },
            (_, Some(now), before) if is_change(trace, column, at, scan, now, before) => {
                values.push(assignment(column, now));
                if let Some(told) = told.get_mut(at) {
                    *told = Some(now);
                }
            }
            _ => {}
        }
    }
    if starts {
        values.extend(
            group
                .columns
                .iter()
                .filter_map(|&(at, column)| untold(trace, column, at, scan, told)),
        );
    }
    edges.extend(values);
    edges.join(" ")
}

/// Whether a value that is no BOOL and no state makes an event by itself.
fn is_change(
    trace: &Trace,
    column: &Column,
    at: usize,
    scan: usize,
    now: Cell<'_>,
    before: Option<Cell<'_>>,
) -> bool {
    let jitters = column.kind == Kind::Real || column.is_time;
    if jitters {
        let stood = |before| scan < 2 || trace.cell(scan - 2, at).is_some_and(|cell| same(cell, before));
        return matches!(column.role, Role::Input | Role::Variable)
            && before.is_some_and(|before| !same(before, now) && stood(before));
    }
    match before {
        Some(before) => before != now,
        // Scan 0 starts from zero; names start from whatever they are.
        None => !matches!(now, Cell::Integer(0) | Cell::Name(_)),
    }
}

/// The text of an input at a rising edge, unless it was told before or is zero and never was anything else.
fn untold<'t>(
    trace: &'t Trace,
    column: &Column,
    at: usize,
    scan: usize,
    told: &mut [Option<Cell<'t>>],
) -> Option<String> {
    if column.role != Role::Input || column.kind == Kind::Bool {
        return None;
    }
    let now = trace.cell(scan, at)?;
    let told = told.get_mut(at)?;
    let known = match *told {
        Some(told) => same(told, now),
        // 0 takes the default, but for the pins that say where to go.
        None => is_zero(now) && !matches!(column.signal(), "Position" | "Distance"),
    };
    *told = Some(now);
    (!known).then(|| assignment(column, now))
}

fn assignment(column: &Column, cell: Cell<'_>) -> String {
    let text = match cell {
        Cell::Integer(ns @ 0..) if column.is_time => time_literal(ns.cast_unsigned()),
        _ => cell_text(cell),
    };
    format!("{}={text}", column.signal())
}

fn is_zero(cell: Cell<'_>) -> bool {
    match cell {
        Cell::Real(value) => value == 0.0,
        Cell::Integer(value) => value == 0,
        Cell::Bool(_) | Cell::Name(_) => false,
    }
}

/// Equal to the bit: a NaN is the same as itself.
pub(crate) fn same(a: Cell<'_>, b: Cell<'_>) -> bool {
    match (a, b) {
        (Cell::Real(a), Cell::Real(b)) => a.to_bits() == b.to_bits(),
        _ => a == b,
    }
}
