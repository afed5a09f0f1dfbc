//! Recordings of machines: CSV as exported by scopes, PLC traces and loggers.
//!
//! Such files have header blocks of any length, their own names, decimal points or commas, and times in
//! their own unit. The caller names the columns it needs, so the reader knows no manufacturer's form. The
//! line of names is the one with most of these names, and the rows begin where the time below it is a
//! number.
//!
//! The work is proportional to the length of the text, except for the search of the names in its first
//! [`HEADER_LINES`] lines.

mod number;
mod table;
mod text;

pub use text::decode;

use number::Marks;
use std::collections::BTreeMap;
use std::fmt;
use table::Table;

use crate::read::ReadError;

/// Lines that are searched for the line of names.
pub const HEADER_LINES: usize = 1000;

/// A column of the file.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// The one of this name.
    Name(String),
    /// The one of this number, from 1.
    Number(usize),
}

/// The unit of a column of times.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Unit {
    /// Seconds.
    Seconds,
    /// Milliseconds.
    Milliseconds,
    /// Microseconds.
    Microseconds,
    /// Nanoseconds.
    Nanoseconds,
    /// Ticks of 100 ns, as Windows counts.
    Ticks,
}

/// The times of the samples.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Times {
    /// In a column. If several have its name, each signal uses the nearest one to its left.
    Column {
        /// The column.
        place: Place,
        /// The unit of its numbers.
        unit: Unit,
    },
    /// Not in the file: the distance of two rows (ns), above 0.
    Every(i64),
}

/// The form of a recording.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Layout {
    /// The separator of cells; found from the file if `None`.
    pub delimiter: Option<char>,
    /// The decimal mark, `.` or `,`; found from the file if `None`.
    pub decimal: Option<char>,
    /// The times.
    pub times: Times,
}

/// How the cells of a column are read.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Reading {
    /// Numbers, joined by straight lines.
    Curve,
    /// Truth values (`TRUE`, `FALSE` in any case, 1, 0), which stay until the next sample.
    Bool,
    /// Whole numbers, which stay until the next sample.
    Whole,
    /// Words, which stay until the next sample; those listed here are replaced.
    Word(BTreeMap<String, String>),
}

/// A requested column.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Wanted {
    /// The signal that needs it; used in messages.
    pub signal: String,
    /// Which column.
    pub place: Place,
    /// How to read it.
    pub reading: Reading,
}

/// The samples of one signal; times (ns) count from the earliest sample of the recording.
#[derive(Clone, Debug, PartialEq)]
pub enum Channel {
    /// Samples, their times rising.
    Curve(Vec<(i64, f64)>),
    /// Values that stay until they change.
    Steps(Steps),
}

/// Values that stay until they change.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Steps {
    /// The first value and every change, each with its time (ns).
    pub changes: Vec<(i64, String)>,
    /// The time (ns) of the last sample.
    pub last_ns: i64,
}

impl Channel {
    /// The times (ns) of the first and the last sample; `None` if there is none.
    #[must_use]
    pub fn span(&self) -> Option<(i64, i64)> {
        match self {
            Self::Curve(samples) => Some((samples.first()?.0, samples.last()?.0)),
            Self::Steps(steps) => Some((steps.changes.first()?.0, steps.last_ns)),
        }
    }

    fn shift(&mut self, by: i64) {
        match self {
            Self::Curve(samples) => samples.iter_mut().for_each(|(ns, _)| *ns -= by),
            Self::Steps(steps) => {
                steps.changes.iter_mut().for_each(|(ns, _)| *ns -= by);
                steps.last_ns -= by;
            }
        }
    }
}

/// A recording.
#[derive(Clone, Debug, PartialEq)]
pub struct Recording {
    /// One channel for each requested column, in that order.
    pub channels: Vec<Channel>,
    /// Rows that were read.
    pub rows: usize,
    /// The separator of cells.
    pub delimiter: char,
    /// The decimal mark; `None` if no number has decimals.
    pub decimal: Option<char>,
    /// The last line has no line end, so it may have been cut.
    pub open_end: bool,
}

impl fmt::Display for Recording {
    fn fmt(&self, out: &mut fmt::Formatter<'_>) -> fmt::Result {
        let delimiter = match self.delimiter {
            '\t' => "tabs".to_owned(),
            other => format!("`{other}`"),
        };
        write!(out, "{} rows, cells between {delimiter}", self.rows)?;
        match self.decimal {
            Some(mark) => write!(out, ", decimals behind `{mark}`"),
            None => Ok(()),
        }
    }
}

/// Reads the wanted columns.
///
/// # Errors
/// Columns that are missing or not unique, rows that are cut short, cells that cannot be read as requested, times
/// that do not rise; with line and column.
pub fn read(text: &str, layout: &Layout, wanted: &[Wanted]) -> Result<Recording, ReadError> {
    let table = Table::find(text, layout, wanted)?;
    let mut marks = Marks::new(layout.decimal, table.delimiter);
    let mut channels: Vec<Channel> = wanted
        .iter()
        .map(|wanted| match wanted.reading {
            Reading::Curve => Channel::Curve(Vec::new()),
            _ => Channel::Steps(Steps::default()),
        })
        .collect();
    let mut rows = 0;
    for row in table.rows() {
        let row = row?;
        for ((wanted, column), channel) in wanted.iter().zip(&table.columns).zip(&mut channels) {
            let cell = row.cell(column.value, &wanted.signal)?;
            let ns = match (&layout.times, column.time) {
                (Times::Column { unit, .. }, Some(time)) => {
                    let time = row.cell(time, "the time")?;
                    // Slower channels have empty cells between their samples.
                    if time.text.is_empty() || cell.text.is_empty() {
                        continue;
                    }
                    marks.time(&time, *unit)?
                }
                (Times::Every(step), _) => {
                    let index = i64::try_from(rows).ok();
                    let ns = index.and_then(|index| index.checked_mul(*step));
                    let ns = ns.filter(|ns| *ns < number::TIME_MAX);
                    let ns = ns
                        .ok_or_else(|| cell.error("more than 73 years lie between this row and the first"))?;
                    if cell.text.is_empty() {
                        continue;
                    }
                    ns
                }
                (Times::Column { .. }, None) => continue,
            };
            if channel.span().is_some_and(|(_, last)| last >= ns) {
                let message = format!(
                    "the time of {} does not rise: it is that of the sample before, or an earlier one",
                    wanted.signal
                );
                return Err(ReadError::at(cell.line, None, message));
            }
            match (channel, &wanted.reading) {
                (Channel::Curve(samples), _) => samples.push((ns, marks.number(&cell)?)),
                (Channel::Steps(steps), reading) => {
                    let value = marks.step(&cell, reading)?;
                    if steps.changes.last().is_none_or(|(_, last)| *last != value) {
                        steps.changes.push((ns, value));
                    }
                    steps.last_ns = ns;
                }
            }
        }
        rows += 1;
    }
    for (wanted, channel) in wanted.iter().zip(&channels) {
        if channel.span().is_none() {
            let message = format!("no row has a sample of {}", wanted.signal);
            return Err(ReadError::at(table.first_row, None, message));
        }
    }
    let start = channels
        .iter()
        .filter_map(|channel| Some(channel.span()?.0))
        .min();
    channels
        .iter_mut()
        .for_each(|channel| channel.shift(start.unwrap_or(0)));
    Ok(Recording {
        channels,
        rows,
        delimiter: table.delimiter,
        decimal: marks.found(),
        open_end: !text.ends_with('\n'),
    })
}
