//! The places of the names and the rows of a file.

use std::borrow::Cow;

use super::{HEADER_LINES, Layout, Place, Times, Wanted, number};
use crate::csv::{DELIMITERS, split};
use crate::read::ReadError;

/// The preference if two delimiters explain a file equally well, because commas may be decimal ones.
const TRIED: [char; 4] = ['\t', ';', '|', ','];

/// Largest number of names that a message lists.
const NAMES_LISTED: usize = 12;

/// The columns of a requested signal, from 0.
#[derive(Clone, Copy, Debug)]
pub struct Columns {
    pub value: usize,
    pub time: Option<usize>,
}

/// A file with its columns and rows.
pub struct Table<'t> {
    pub delimiter: char,
    /// One for each requested signal.
    pub columns: Vec<Columns>,
    /// The line of the first row, from 1.
    pub first_row: usize,
    lines: Vec<&'t str>,
}

/// A cell and its place.
#[derive(Clone, Debug)]
pub struct Cell<'t> {
    pub text: Cow<'t, str>,
    pub line: usize,
    pub column: Option<usize>,
}

impl Cell<'_> {
    pub fn error(&self, message: &str) -> ReadError {
        let shown: String = self.text.chars().take(40).collect();
        ReadError::at(self.line, self.column, format!("`{shown}`: {message}"))
    }
}

/// The cells of a line.
pub struct Row<'t> {
    line: usize,
    cells: Vec<Cell<'t>>,
}

impl<'t> Row<'t> {
    pub fn cell(&self, column: usize, what: &str) -> Result<Cell<'t>, ReadError> {
        self.cells.get(column).cloned().ok_or_else(|| {
            let message = format!(
                "the line ends behind {} cells, before that of {what}: the file is cut short",
                self.cells.len()
            );
            ReadError::at(self.line, None, message)
        })
    }
}

/// The cells of a line without blanks around them.
fn cells(line: &str, delimiter: char, number: usize) -> Result<Vec<Cell<'_>>, ReadError> {
    let fields = split(line, delimiter, number)?;
    Ok(fields
        .into_iter()
        .map(|field| Cell {
            text: match field.text {
                Cow::Borrowed(text) => Cow::Borrowed(text.trim()),
                Cow::Owned(text) => Cow::Owned(text.trim().to_owned()),
            },
            line: number,
            column: field.column,
        })
        .collect())
}

/// The line of names that was found.
struct Names<'t> {
    delimiter: char,
    /// Its number from 0; `None` if columns are requested only by number.
    line: Option<usize>,
    cells: Vec<Cell<'t>>,
}

impl<'t> Table<'t> {
    pub fn find(text: &'t str, layout: &Layout, wanted: &[Wanted]) -> Result<Self, ReadError> {
        let lines: Vec<&str> = text.lines().collect();
        let names = names(&lines, layout, wanted)?;
        let times = match &layout.times {
            Times::Column { place, .. } => Some(place),
            Times::Every(_) => None,
        };
        let columns = wanted
            .iter()
            .map(|wanted| {
                let value = names.value(wanted)?;
                let time = times.map(|place| names.time(place, value)).transpose()?;
                Ok(Columns { value, time })
            })
            .collect::<Result<Vec<_>, ReadError>>()?;
        let first_line = names.line.map_or(0, |line| line + 1);
        let begins = |line: &str| {
            let row = cells(line, names.delimiter, 0).unwrap_or_default();
            columns.iter().any(|columns| {
                let column = columns.time.unwrap_or(columns.value);
                row.len() > columns.value
                    && row.get(column).is_some_and(|cell| match columns.time {
                        Some(_) => number::is_number(&cell.text),
                        None => is_value(&cell.text),
                    })
            })
        };
        let rows = lines.iter().enumerate().skip(first_line);
        let first = rows.map(|(at, line)| (at, *line)).find(|(_, line)| begins(line));
        let Some((first, _)) = first else {
            let message = "no rows of numbers below the line of names";
            return Err(ReadError::at(
                names.line.map_or(1, |line| line + 1),
                None,
                message,
            ));
        };
        Ok(Self {
            delimiter: names.delimiter,
            columns,
            first_row: first + 1,
            lines,
        })
    }

    /// The rows, without blank lines and the mark `EOF` at the end of the file.
    pub fn rows(&self) -> impl Iterator<Item = Result<Row<'t>, ReadError>> + '_ {
        let blank = |line: &str| line.trim_matches([self.delimiter, ' ', '\r']).is_empty();
        let mut last = self.lines.len();
        while let Some(line) = self.lines.get(last.wrapping_sub(1))
            && (blank(line) || line.trim().trim_end_matches(self.delimiter) == "EOF")
        {
            last -= 1;
        }
        let first = self.first_row - 1;
        let lines = self.lines.iter().enumerate().take(last).skip(first);
        lines.filter(move |(_, line)| !blank(line)).map(|(at, line)| {
            let cells = cells(line, self.delimiter, at + 1)?;
            Ok(Row { line: at + 1, cells })
        })
    }
}

/// Whether the cell could be a sample of a signal without words.
fn is_value(text: &str) -> bool {
    number::is_number(text) || text.eq_ignore_ascii_case("TRUE") || text.eq_ignore_ascii_case("FALSE")
}

/// Finds the delimiter and the line of names: the line with most of the requested names, of equal ones the lowest.
fn names<'t>(lines: &[&'t str], layout: &Layout, wanted: &[Wanted]) -> Result<Names<'t>, ReadError> {
    let time = match &layout.times {
        Times::Column { place, .. } => Some(place),
        Times::Every(_) => None,
    };
    let places = || wanted.iter().map(|wanted| &wanted.place).chain(time);
    let sought: Vec<&str> = places()
        .filter_map(|place| match place {
            Place::Name(name) => Some(name.as_str()),
            Place::Number(_) => None,
        })
        .collect();
    let least = places().filter_map(|place| match place {
        Place::Number(number) => Some(*number),
        Place::Name(_) => None,
    });
    let least = least.max().unwrap_or(0);
    let mut best: Option<(usize, Names<'t>)> = None;
    for delimiter in TRIED {
        debug_assert!(DELIMITERS.contains(&delimiter));
        if layout.delimiter.is_some_and(|said| said != delimiter) {
            continue;
        }
        for (at, line) in lines.iter().enumerate().take(HEADER_LINES) {
            // Free text above the names may have a lone quote.
            let cells = cells(line, delimiter, at + 1).unwrap_or_default();
            let found = if sought.is_empty() {
                usize::from(cells.len() >= least.max(2) && cells.iter().any(|cell| is_value(&cell.text)))
            } else {
                let held = |name: &&&str| cells.iter().any(|cell| cell.text == ***name);
                sought.iter().filter(held).count()
            };
            let line = (!sought.is_empty()).then_some(at);
            // Within one delimiter the lowest line counts; among the delimiters the first.
            let better = best.as_ref().is_none_or(|(most, names)| {
                found > *most
                    || (found == *most && found > 0 && names.delimiter == delimiter && line.is_some())
            });
            if better {
                best = Some((
                    found,
                    Names {
                        delimiter,
                        line,
                        cells,
                    },
                ));
            }
        }
    }
    match best {
        Some((found, names)) if found > 0 => Ok(names),
        _ if sought.is_empty() => Err(ReadError::at(
            1,
            None,
            "no rows of numbers: is it a recording at all?",
        )),
        _ => {
            let message = format!(
                "none of the first {HEADER_LINES} lines names a column that the map names ({}): is it the right \
                 file, and are the names those of its columns?",
                listed(sought.iter().copied())
            );
            Err(ReadError::at(1, None, message))
        }
    }
}

fn listed<'n>(names: impl Iterator<Item = &'n str>) -> String {
    let names: Vec<String> = names.map(|name| format!("`{name}`")).collect();
    let shown = names
        .get(..NAMES_LISTED)
        .map_or_else(|| names.join(", "), |few| few.join(", "));
    match names.len().checked_sub(NAMES_LISTED) {
        None | Some(0) => shown,
        Some(more) => format!("{shown} and {more} more"),
    }
}

impl Names<'_> {
    fn of<'s>(&'s self, name: &'s str) -> impl Iterator<Item = usize> + 's {
        let cells = self.cells.iter().enumerate();
        cells.filter(move |(_, cell)| cell.text == name).map(|(at, _)| at)
    }

    fn error(&self, message: String) -> ReadError {
        ReadError::at(self.line.map_or(1, |line| line + 1), None, message)
    }

    /// The column of a wanted signal.
    fn value(&self, wanted: &Wanted) -> Result<usize, ReadError> {
        let name = match &wanted.place {
            Place::Number(number) => return Ok(number.saturating_sub(1)),
            Place::Name(name) => name,
        };
        let mut found = self.of(name);
        match (found.next(), found.next()) {
            (Some(column), None) => Ok(column),
            (None, _) => Err(self.missing(name, &format!("for {}", wanted.signal))),
            (Some(one), Some(two)) => Err(self.error(format!(
                "columns {} and {} are both called `{name}`: give the number of the one for {}",
                one + 1,
                two + 1,
                wanted.signal
            ))),
        }
    }

    /// The column with the times of column `value`.
    fn time(&self, place: &Place, value: usize) -> Result<usize, ReadError> {
        let name = match place {
            Place::Number(number) => return Ok(number.saturating_sub(1)),
            Place::Name(name) => name,
        };
        let left = self.of(name).take_while(|column| *column < value).last();
        left.or_else(|| self.of(name).next())
            .ok_or_else(|| self.missing(name, "for the times"))
    }

    fn missing(&self, name: &str, whose: &str) -> ReadError {
        let named = self.cells.iter().map(|cell| cell.text.as_ref());
        let named = listed(named.filter(|text| !text.is_empty()));
        self.error(format!(
            "no column `{name}`, which the map names {whose}; this line names {named}"
        ))
    }
}
