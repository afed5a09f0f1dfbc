//! The common part of the readers of both forms: from texts of cells to a trace.

use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet};

use crate::column::{Cell, Column, Kind, Role};
use crate::header::{Axis, Header, axis_column};
use crate::number;
use crate::printable::printable;
use crate::trace::{Note, Trace};

/// A trace that was read, and what its files lack.
#[derive(Clone, Debug)]
pub struct Loaded {
    /// The trace; unknown parts of its header are empty.
    pub trace: Trace,
    /// The missing parts, one phrase each; empty if there are none.
    pub lacks: Vec<String>,
}

/// The reason why a trace could not be read. Lines and columns count from 1, columns in characters.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("line {line}{}: {message}", .column.map(|column| format!(", column {column}")).unwrap_or_default())]
pub struct ReadError {
    /// The line.
    pub line: usize,
    /// The column, if one can be named.
    pub column: Option<usize>,
    /// What is wrong.
    pub message: String,
}

impl ReadError {
    pub(crate) fn at(line: usize, column: Option<usize>, message: impl Into<String>) -> Self {
        Self {
            line,
            column,
            // It quotes pieces of the file.
            message: printable(&message.into()).into_owned(),
        }
    }

    /// An error of serde_json, which counts lines from the start of its text: that is `first_line`.
    pub(crate) fn json(error: &serde_json::Error, first_line: usize) -> Self {
        let line = first_line + error.line().saturating_sub(1);
        if error.is_eof() {
            return Self::at(
                line,
                None,
                "the text ends in the middle of an object: the file is cut short",
            );
        }
        let text = error.to_string();
        // serde_json appends its own position, which is wrong for a line inside a file.
        let message = text.split(" at line ").next().unwrap_or(&text).to_owned();
        Self::at(line, Some(error.column().max(1)), message)
    }
}

/// The text of a cell and its place (column from 1, if known).
pub struct Field<'t> {
    pub text: Cow<'t, str>,
    pub column: Option<usize>,
}

/// The cells of one line, `scan` and `time_ns` first.
pub struct Line<'t> {
    pub number: usize,
    pub fields: Vec<Field<'t>>,
}

/// Makes a trace of lines. `names` are all columns of the file. `lines` is run twice: first to find the
/// kinds of columns without a header, then to read.
pub fn assemble<'t, I>(
    names: &[String],
    header: Option<(Header, Vec<Note>)>,
    lines: impl Fn() -> I,
) -> Result<Loaded, ReadError>
where
    I: Iterator<Item = Result<Line<'t>, ReadError>>,
{
    check_names(names)?;
    let signals = names.get(2..).unwrap_or_default();
    let (kinds, cycle_ns) = survey(signals.len(), lines())?;
    let mut lacks = Vec::new();
    let (mut header, notes) = header.unwrap_or_else(|| {
        lacks.push(
            "the header: runtime version, title, units, limits and scaling of axes, types and directions of \
             pins, claims"
                .to_owned(),
        );
        let header = Header {
            cycle_ns: cycle_ns.unwrap_or(0),
            axes: find_axes(signals),
            ..Header::default()
        };
        (header, Vec::new())
    });
    if header.cycle_ns == 0 {
        lacks.push("the cycle time".to_owned());
        header.cycle_ns = cycle_ns.unwrap_or(0);
    }

    let mut known: BTreeMap<String, Column> = header
        .columns()
        .into_iter()
        .map(|column| (column.name.clone(), column))
        .collect();
    let axes: BTreeSet<String> = header.axes.iter().map(|axis| axis.name.clone()).collect();
    let columns = signals
        .iter()
        .zip(kinds)
        .map(|(name, kind)| {
            known
                .remove(name)
                .unwrap_or_else(|| unknown_column(name, kind, &axes))
        })
        .collect();
    lacks.extend(known.keys().map(|name| format!("the column `{name}`")));

    let mut trace = Trace::with_columns(header, columns);
    for note in notes {
        trace.push_note(note);
    }
    for line in lines() {
        push_line(&mut trace, &line?)?;
    }
    Ok(Loaded { trace, lacks })
}

fn check_names(names: &[String]) -> Result<(), ReadError> {
    if names.first().map(String::as_str) != Some("scan")
        || names.get(1).map(String::as_str) != Some("time_ns")
    {
        return Err(ReadError::at(
            1,
            Some(1),
            "a trace begins with the columns `scan` and `time_ns`",
        ));
    }
    let mut seen = BTreeSet::new();
    match names.iter().find(|name| !seen.insert(name.as_str())) {
        Some(twice) => Err(ReadError::at(
            1,
            None,
            format!("the column `{twice}` stands twice"),
        )),
        None => Ok(()),
    }
}

/// The narrowest kind for all texts of each column, and the time of scan 1.
fn survey<'t>(
    width: usize,
    lines: impl Iterator<Item = Result<Line<'t>, ReadError>>,
) -> Result<(Vec<Kind>, Option<u64>), ReadError> {
    let mut kinds = vec![None; width];
    let mut cycle_ns = None;
    for (scan, line) in lines.enumerate() {
        let line = line?;
        if scan == 1 {
            cycle_ns = line.fields.get(1).and_then(|field| field.text.parse().ok());
        }
        for (kind, field) in kinds.iter_mut().zip(line.fields.iter().skip(2)) {
            *kind = Some(wider(*kind, kind_of_text(&field.text)));
        }
    }
    Ok((
        kinds.into_iter().map(|kind| kind.unwrap_or(Kind::Name)).collect(),
        cycle_ns,
    ))
}

fn kind_of_text(text: &str) -> Kind {
    if matches!(text, "TRUE" | "FALSE") {
        Kind::Bool
    } else if text.parse::<i64>().is_ok() {
        Kind::Integer
    } else if number::parse(text).is_some() {
        Kind::Real
    } else {
        Kind::Name
    }
}

/// Whole numbers are numbers; any other mixture is read as names.
fn wider(so_far: Option<Kind>, kind: Kind) -> Kind {
    match (so_far, kind) {
        (None, _) => kind,
        (Some(old), new) if old == new => old,
        (Some(Kind::Real), Kind::Integer) | (Some(Kind::Integer), Kind::Real) => Kind::Real,
        (Some(_), _) => Kind::Name,
    }
}

/// Subjects with a state and a position are axes.
fn find_axes(signals: &[String]) -> Vec<Axis> {
    let with_position: BTreeSet<&str> = signals
        .iter()
        .filter_map(|name| name.strip_suffix(".Position"))
        .collect();
    signals
        .iter()
        .filter_map(|name| name.strip_suffix(".State"))
        .filter(|axis| with_position.contains(axis))
        .map(|axis| Axis {
            name: axis.to_owned(),
            ..Axis::default()
        })
        .collect()
}

fn unknown_column(name: &str, kind: Kind, axes: &BTreeSet<String>) -> Column {
    let role = match name.split_once('.') {
        None => Role::Variable,
        Some((subject, "State")) if axes.contains(subject) => return axis_column(subject, "State"),
        Some((subject, _)) if axes.contains(subject) => Role::AxisValue,
        Some(_) => Role::Output,
    };
    Column {
        name: name.to_owned(),
        kind,
        role,
        is_time: false,
        default: None,
        named: false,
    }
}

fn push_line(trace: &mut Trace, line: &Line<'_>) -> Result<(), ReadError> {
    let scan = trace.scans();
    check_clock(line, 0, "scan", scan as u64)?;
    check_clock(line, 1, "time_ns", trace.time_ns(scan))?;
    let cells = trace
        .columns()
        .iter()
        .zip(line.fields.iter().skip(2))
        .map(|(column, field)| {
            Cell::read(column.kind, &field.text).ok_or_else(|| {
                let wanted = match column.kind {
                    Kind::Bool => "TRUE or FALSE",
                    Kind::Real => "a number",
                    Kind::Integer => "a whole number",
                    Kind::Name => "a name",
                };
                let message = format!("`{}` should be {wanted}, found `{}`", column.name, field.text);
                ReadError::at(line.number, field.column, message)
            })
        })
        .collect::<Result<Vec<_>, _>>()?;
    trace
        .push_row(&cells)
        .map_err(|error| ReadError::at(line.number, None, error.to_string()))
}

/// Rows are consecutive from scan 0, so the two clock columns must have the values that would be written.
fn check_clock(line: &Line<'_>, at: usize, name: &str, expected: u64) -> Result<(), ReadError> {
    match line.fields.get(at) {
        Some(field) if field.text.parse() == Ok(expected) => Ok(()),
        Some(field) => {
            let message = format!("`{name}` should be {expected}, found `{}`", field.text);
            Err(ReadError::at(line.number, field.column, message))
        }
        None => Err(ReadError::at(line.number, None, format!("`{name}` is missing"))),
    }
}
