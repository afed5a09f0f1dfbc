//! Events: one line per scan and subject in which something changed.
//!
//! Booleans, states, names and whole numbers make an event whenever they change. Reals and times may
//! change in every scan, so outputs of these kinds make none. Inputs of these kinds are shown at rising
//! edges of their block, where they are taken, and when they change after a scan without change. A pin
//! that the script does not name is shown only once its value differs from its default.

use std::collections::BTreeMap;

use crate::column::{Cell, Column, Kind, Role};
use crate::number::{cell_text, time_literal};
use crate::trace::{Note, Trace};

/// The common name of the script's input variables.
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

/// All events in the order of cause and effect: by scan; within a scan the input variables, the instances in call
/// order, the axes in script order. Notes follow the line of their subject.
#[must_use]
pub fn events(trace: &Trace) -> Vec<Event> {
    with_notes(trace, trace.notes())
}

/// The events of the rows alone, for a trace that was read from a file.
pub(crate) fn row_events(trace: &Trace) -> Vec<Event> {
    with_notes(trace, &[])
}

fn with_notes(trace: &Trace, of_trace: &[Note]) -> Vec<Event> {
    let mut notes: BTreeMap<usize, Vec<&Note>> = BTreeMap::new();
    for note in of_trace {
        notes.entry(note.scan).or_default().push(note);
    }
    let mut log = EventLog::default();
    let mut events = Vec::new();
    for scan in 0..trace.scans() {
        log.scan(trace, scan, notes.remove(&scan).unwrap_or_default(), &mut events);
    }
    // Notes of scans that the trace does not have come last, so that they are not lost.
    events.extend(notes.into_values().flatten().map(note_event));
    events
}

/// The events of one trace, which may grow.
#[derive(Clone, Debug, Default)]
pub struct EventLog {
    /// Number of scans and notes whose events were taken.
    scans: usize,
    notes: usize,
    /// For each column, the last value shown, as the trace stores it.
    told: Vec<Option<u64>>,
    /// The columns by subject, from the first row on.
    groups: Option<Vec<Group>>,
}

impl EventLog {
    /// The events of the rows and notes that the trace has received since the last call. At least two of the rows
    /// before must still be held. Cost: proportional to these rows times columns.
    pub fn take(&mut self, trace: &Trace) -> Vec<Event> {
        let mut events = Vec::new();
        let taken = self.notes.saturating_sub(trace.notes_forgotten());
        let mut notes = trace.notes().get(taken..).unwrap_or_default();
        while self.scans < trace.scans() {
            let scan = self.scans;
            // Notes come in scan order; a late one is shown with the next row.
            let (now, later) = notes.split_at(notes.partition_point(|note| note.scan <= scan));
            self.scan(trace, scan, now.iter().collect(), &mut events);
            (self.scans, self.notes, notes) = (scan + 1, self.notes + now.len(), later);
        }
        events
    }

    fn scan(&mut self, trace: &Trace, scan: usize, mut notes: Vec<&Note>, events: &mut Vec<Event>) {
        self.told.resize(trace.columns().len(), None);
        let groups = self.groups.get_or_insert_with(|| groups(trace.columns()));
        for group in groups {
            let text = changes(trace, group, scan, &mut self.told);
            if !text.is_empty() {
                events.push(Event {
                    scan,
                    subject: group.subject.clone(),
                    text,
                });
            }
            notes.retain(|note| {
                let own = note.subject == group.subject;
                events.extend(own.then(|| note_event(note)));
                !own
            });
        }
        events.extend(notes.into_iter().map(note_event));
    }
}

/// The events as aligned lines: scan, subject, what happened.
#[must_use]
pub fn events_text(trace: &Trace) -> String {
    lines(&events(trace))
}

/// The lines of some events, aligned with each other.
pub(crate) fn lines(events: &[Event]) -> String {
    let mut widths = Widths { scan: 5, subject: 0 };
    for Event { scan, subject, .. } in events {
        widths.scan = widths.scan.max(scan.to_string().len());
        widths.subject = widths.subject.max(subject.chars().count());
    }
    events.iter().map(|event| widths.line(event)).collect()
}

/// The widths of the columns of event lines.
#[derive(Clone, Copy, Debug)]
pub struct Widths {
    scan: usize,
    subject: usize,
}

impl Widths {
    /// For the events of a run of `scans` scans, before they are known.
    #[must_use]
    pub fn of_run(trace: &Trace, scans: u64) -> Self {
        let subjects = groups(trace.columns());
        let subjects = subjects.iter().map(|group| group.subject.chars().count());
        Self {
            scan: scans.saturating_sub(1).to_string().len().max(5),
            subject: subjects.max().unwrap_or(0),
        }
    }

    /// An event: scan, subject, what happened.
    #[must_use]
    pub fn line(&self, event: &Event) -> String {
        let Self {
            scan: scan_width,
            subject: subject_width,
        } = self;
        let Event { scan, subject, text } = event;
        format!("{scan:>scan_width$}  {subject:<subject_width$}  {text}\n")
    }
}

fn note_event(note: &Note) -> Event {
    Event {
        scan: note.scan,
        subject: note.subject.clone(),
        text: note.text.clone(),
    }
}

/// The columns of one subject.
#[derive(Clone, Debug)]
pub(crate) struct Group {
    pub(crate) subject: String,
    pub(crate) columns: Vec<usize>,
}

/// The subjects in the order in which their events of a scan are shown.
pub(crate) fn groups(columns: &[Column]) -> Vec<Group> {
    let mut groups: Vec<(u8, Group)> = Vec::new();
    let mut places: BTreeMap<(u8, &str), usize> = BTreeMap::new();
    for (at, column) in columns.iter().enumerate() {
        let (rank, subject) = match column.role {
            Role::Variable => (0, VARIABLES),
            Role::InOut | Role::Input | Role::Output => (1, column.subject()),
            Role::AxisState | Role::AxisValue => (2, column.subject()),
        };
        let place = *places.entry((rank, subject)).or_insert(groups.len());
        match groups.get_mut(place) {
            Some((_, group)) => group.columns.push(at),
            None => groups.push((
                rank,
                Group {
                    subject: subject.to_owned(),
                    columns: vec![at],
                },
            )),
        }
    }
    groups.sort_by_key(|(rank, _)| *rank);
    groups.into_iter().map(|(_, group)| group).collect()
}

/// The changes in a group in a scan: Booleans first, then values in column order. `told` has for each
/// column the last value shown.
fn changes(trace: &Trace, group: &Group, scan: usize, told: &mut [Option<u64>]) -> String {
    // Most subjects do nothing in most scans.
    if !trace.moves(scan, &group.columns) {
        return String::new();
    }
    let mut words = Vec::new();
    let mut takes_inputs = false;
    let columns = || {
        let places = group.columns.iter();
        places.filter_map(|&at| Some((at, trace.columns().get(at)?)))
    };
    for (at, column) in columns() {
        let before = scan
            .checked_sub(1)
            .and_then(|scan| trace.cell(scan, at))
            .or_else(|| column.unsaid())
            .unwrap_or(Cell::Bool(false));
        match trace.cell(scan, at) {
            Some(Cell::Bool(now)) if before != Cell::Bool(now) => {
                words.push(format!("{}{}", if now { '+' } else { '-' }, column.signal()));
                takes_inputs |= now && column.role == Role::Input;
            }
            _ => {}
        }
    }
    for (at, column) in columns().filter(|(_, column)| column.kind != Kind::Bool) {
        let Some(now) = trace.cell(scan, at) else { continue };
        let before = scan.checked_sub(1).and_then(|scan| trace.cell(scan, at));
        if column.role == Role::AxisState {
            words.extend(transition(before, now));
            continue;
        }
        let taken = takes_inputs && column.role == Role::Input;
        let known = told.get(at).copied().flatten();
        let known = known.map(|word| trace.decode(column.kind, word));
        if (taken && is_news(column, now, known)) || is_change(trace, at, column, scan) {
            words.push(assignment(column, now));
            if let Some(told) = told.get_mut(at) {
                *told = trace.word(scan, at);
            }
        }
    }
    words.join(" ")
}

fn transition(before: Option<Cell<'_>>, now: Cell<'_>) -> Option<String> {
    match before {
        None => Some(cell_text(now)),
        Some(before) if before != now => Some(format!("{} -> {}", cell_text(before), cell_text(now))),
        Some(_) => None,
    }
}

/// Whether an input that a block takes is shown. It is not if its value was shown before, or if it has
/// its default and never had another value. For an input that the script names, 0 takes the default of
/// the axis and is not shown either; pins that give a target are always shown.
fn is_news(column: &Column, now: Cell<'_>, told: Option<Cell<'_>>) -> bool {
    match told {
        Some(told) => !same(told, now),
        None if column.unsaid().is_some() => !is_default(column, now),
        None => !is_zero(now) || matches!(column.signal(), "Position" | "Distance"),
    }
}

/// Whether a value that is no BOOL and no state makes an event by itself.
fn is_change(trace: &Trace, at: usize, column: &Column, scan: usize) -> bool {
    let back = |scans| scan.checked_sub(scans).and_then(|scan| trace.cell(scan, at));
    let Some(now) = back(0) else { return false };
    let jitters = column.kind == Kind::Real || column.is_time;
    match (back(1), column.role) {
        // The note of the coupling shows it.
        (_, Role::AxisValue) if column.signal().starts_with("Master") => false,
        (Some(before), Role::Input | Role::Variable) if jitters => {
            let stood = back(2).is_none_or(|cell| same(cell, before));
            stood && !same(before, now)
        }
        (Some(before), _) => !jitters && before != now,
        // Variables and whole numbers start from zero or their default, names from any value. The other inputs of a
        // block are shown when the block uses them.
        (None, role) => {
            (!jitters || role == Role::Variable) && !is_default(column, now) && column.kind != Kind::Name
        }
    }
}

fn assignment(column: &Column, cell: Cell<'_>) -> String {
    let text = match cell {
        Cell::Integer(ns @ 0..) if column.is_time => time_literal(ns.cast_unsigned()),
        _ => cell_text(cell),
    };
    format!("{}={text}", column.signal())
}

/// Whether a value is its default and not shown; zero if there is no default.
fn is_default(column: &Column, cell: Cell<'_>) -> bool {
    match column.unsaid() {
        Some(default) => same(cell, default),
        None => is_zero(cell),
    }
}

fn is_zero(cell: Cell<'_>) -> bool {
    match cell {
        Cell::Real(value) => value == 0.0,
        Cell::Integer(value) => value == 0,
        Cell::Bool(_) | Cell::Name(_) => false,
    }
}

/// Equal to the bit: a NaN is equal to itself.
pub fn same(a: Cell<'_>, b: Cell<'_>) -> bool {
    match (a, b) {
        (Cell::Real(a), Cell::Real(b)) => a.to_bits() == b.to_bits(),
        _ => a == b,
    }
}
