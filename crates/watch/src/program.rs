//! A program in Structured Text during a run: the lines executed in the last scan, and its variables.

use standstill_script::model::Script;
use standstill_script::{Counted, Session, Shown};
use std::collections::{BTreeMap, BTreeSet};

/// The part that the arrows move.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) enum Side {
    Source,
    Variables,
}

/// A program in view.
#[derive(Clone, Debug)]
pub(crate) struct View {
    /// Its index in the script.
    pub program: usize,
    pub side: Side,
    /// The first visible line of the source and the first visible variable.
    pub top: [usize; 2],
    /// Execution counts of statements.
    counts: BTreeMap<(String, u32, u32), u64>,
    /// Lines that were executed in the last scan: file and line.
    pub ran: BTreeSet<(String, u32)>,
    pub variables: Vec<Shown>,
    /// Indices in `variables` that changed in the last scan.
    pub changed: BTreeSet<usize>,
}

/// The next program in Structured Text behind `after`, or the first one.
pub(crate) fn next(script: &Script, after: Option<usize>) -> Option<usize> {
    let first = after.map_or(0, |after| after + 1);
    let programs = script.programs.iter().enumerate().skip(first);
    programs
        .filter(|(_, program)| program.text.is_some())
        .map(|(index, _)| index)
        .next()
}

impl View {
    pub(crate) fn new(program: usize, session: &Session<'_>) -> Self {
        let mut view = Self {
            program,
            side: Side::Source,
            top: [0, 0],
            counts: BTreeMap::new(),
            ran: BTreeSet::new(),
            variables: Vec::new(),
            changed: BTreeSet::new(),
        };
        view.look(session);
        // Executions before it came into view are not known.
        view.ran.clear();
        view.changed.clear();
        view
    }

    /// Takes the state after a scan.
    pub(crate) fn look(&mut self, session: &Session<'_>) {
        let statements = session.counted().into_iter().filter(|it| it.branch == 0);
        let counts = statements.map(|it: Counted| ((it.file, it.line, it.column), it.count));
        let counts: BTreeMap<_, _> = counts.collect();
        let ran = counts
            .iter()
            .filter(|(key, count)| **count > self.counts.get(key).copied().unwrap_or(0));
        self.ran = ran.map(|((file, line, _), _)| (file.clone(), *line)).collect();
        self.counts = counts;
        let variables = session.variables(self.program);
        let pairs = variables.iter().zip(&self.variables).enumerate();
        let changed = pairs.filter(|(_, (now, before))| now.value != before.value);
        self.changed = changed.map(|(index, _)| index).collect();
        self.variables = variables;
    }

    /// Scrolls one side.
    pub(crate) fn scroll(&mut self, by: i32, lines: usize) {
        let (side, most) = match self.side {
            Side::Source => (0, lines),
            Side::Variables => (1, self.variables.len()),
        };
        if let Some(top) = self.top.get_mut(side) {
            let moved = top.saturating_add_signed(by as isize);
            *top = moved.min(most.saturating_sub(1));
        }
    }

    /// Moves a line of the source to the middle of the visible ones.
    pub(crate) fn go_to(&mut self, line: usize, height: usize) {
        self.top[0] = line.saturating_sub(height / 2);
    }
}

/// A line of a program's text.
#[derive(Clone, Copy, Debug)]
pub(crate) enum Row<'s> {
    /// The name of a file, before its lines.
    File(&'s str),
    /// The file, the number from 1, and the text.
    Line(&'s str, u32, &'s str),
}

/// The text of a program, its files one behind the other.
pub(crate) fn rows(script: &Script, program: usize) -> Vec<Row<'_>> {
    let text = script.programs.get(program).and_then(|it| it.text.as_ref());
    let folder = text.map_or("", |text| text.folder.as_str());
    let files = text.iter().flat_map(|text| &text.sources);
    let rows = files.flat_map(|(name, text)| {
        let lines = text
            .lines()
            .zip(1..)
            .map(|(line, number)| Row::Line(name, number, line));
        std::iter::once(Row::File(name.strip_prefix(folder).unwrap_or(name))).chain(lines)
    });
    rows.collect()
}

/// The place of a program's fault, from its note `faults: cell.st:20:10: ..`: an index into [`rows`].
pub(crate) fn fault_row(script: &Script, program: usize, note: &str) -> Option<usize> {
    let place = note.strip_prefix("faults: ")?;
    let rows = rows(script, program);
    let folder = script.programs.get(program)?.text.as_ref()?.folder.as_str();
    let at = |row: &Row<'_>| match row {
        Row::File(_) => false,
        Row::Line(file, line, _) => {
            let file = file.strip_prefix(folder).unwrap_or(file);
            place.starts_with(&format!("{file}:{line}:"))
        }
    };
    rows.iter().position(at)
}
