//! Traces as comma-separated values (or in another [`Dialect`]): a line of column names, then one line a scan.
//!
//! Written by hand and without a library. Names and numbers need no quotes, so only a split at delimiters remains.
//! It can report the character position of a bad cell.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::column::Cell;
use crate::header::Header;
use crate::number::{self, cell_text};
use crate::read::{Field, Line, Loaded, ReadError, assemble};
use crate::trace::Trace;

/// The separator of cells and the form of numbers. The format itself uses commas and decimal points. Other programs
/// need other forms.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Dialect {
    /// The separator of cells, one of [`DELIMITERS`].
    pub delimiter: char,
    /// Numbers have a decimal comma.
    pub decimal_comma: bool,
}

/// The permitted separators of cells.
pub const DELIMITERS: [char; 4] = [',', ';', '\t', '|'];

impl Default for Dialect {
    fn default() -> Self {
        Self {
            delimiter: ',',
            decimal_comma: false,
        }
    }
}

/// Writes the rows. The header belongs in the file of [`meta_path`], in the form of
/// [`Trace::header_json`].
///
/// # Errors
/// Those of `out`.
pub fn write(trace: &Trace, out: &mut impl Write) -> io::Result<()> {
    write_as(trace, Dialect::default(), out)
}

/// The same as [`write()`], in another dialect. [`read`] accepts every dialect of [`DELIMITERS`] except a decimal
/// comma between commas.
///
/// # Errors
/// Those of `out`.
pub fn write_as(trace: &Trace, dialect: Dialect, out: &mut impl Write) -> io::Result<()> {
    write_names(trace, dialect, out)?;
    write_rows(trace, trace.first(), dialect, out)
}

/// The line of column names.
pub(crate) fn write_names(trace: &Trace, dialect: Dialect, out: &mut impl Write) -> io::Result<()> {
    let delimiter = dialect.delimiter;
    write!(out, "scan{delimiter}time_ns")?;
    for column in trace.columns() {
        write!(out, "{delimiter}{}", quoted(&column.name, delimiter))?;
    }
    out.write_all(b"\n")
}

/// The rows from a scan on.
pub(crate) fn write_rows(
    trace: &Trace,
    from: usize,
    dialect: Dialect,
    out: &mut impl Write,
) -> io::Result<()> {
    let delimiter = dialect.delimiter;
    for scan in from..trace.scans() {
        write!(out, "{scan}{delimiter}{}", trace.time_ns(scan))?;
        for cell in trace.row(scan) {
            let mut text = cell_text(cell);
            if dialect.decimal_comma && matches!(cell, Cell::Real(_)) {
                text = text.replace('.', ",");
            }
            write!(out, "{delimiter}{}", quoted(&text, delimiter))?;
        }
        out.write_all(b"\n")?;
    }
    Ok(())
}

/// The file beside a CSV trace that carries its header: `X.csv` has `X.csv.meta.json`.
#[must_use]
pub fn meta_path(csv: &Path) -> PathBuf {
    let mut name = csv.as_os_str().to_owned();
    name.push(".meta.json");
    PathBuf::from(name)
}

/// Reads a trace, with the text of its meta file if there is one. A byte order mark, CRLF and other
/// delimiters are accepted. If the delimiter is not the comma, numbers may have decimal commas. Without a
/// header the kinds of columns are found from their texts.
///
/// # Errors
/// Text that is no trace, is cut short, or does not agree with the header. The error has the line, and
/// the column if one can be named. Errors in the meta file have messages of their own.
pub fn read(text: &str, meta: Option<&str>) -> Result<Loaded, ReadError> {
    let header = meta
        .map(Header::with_notes)
        .transpose()
        .map_err(|error| ReadError {
            message: format!("in the meta file: {}", error.message),
            ..error
        })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Some((first, rows)) = text.split_once('\n') else {
        return Err(ReadError::at(1, Some(1), "no line of column names"));
    };
    let delimiter = first.strip_prefix("scan").and_then(|rest| rest.chars().next());
    let delimiter = delimiter
        .filter(|found| DELIMITERS.contains(found))
        .unwrap_or(',');
    let names: Vec<String> = split(first, delimiter, 1)?
        .into_iter()
        .map(|field| field.text.into_owned())
        .collect();
    if !rows.is_empty() && !rows.ends_with('\n') {
        // The last number may have lost digits, and no other check would notice.
        let last = text.lines().count();
        return Err(ReadError::at(
            last,
            None,
            "the last line has no end: the file is cut short",
        ));
    }
    let width = names.len();
    assemble(&names, header, || {
        rows.lines().enumerate().map(move |(at, line)| {
            let number = at + 2;
            let mut fields = split(line, delimiter, number)?;
            if delimiter != ',' {
                fields.iter_mut().for_each(take_decimal_comma);
            }
            if fields.len() == width {
                Ok(Line { number, fields })
            } else {
                let message = format!("{} cells where line 1 names {width} columns", fields.len());
                Err(ReadError::at(number, None, message))
            }
        })
    })
}

/// Changes the decimal comma of a number to a point; any other text is not changed.
fn take_decimal_comma(field: &mut Field<'_>) {
    let is_number = |text: &str| number::parse(text).is_some();
    if field.text.contains(',') && !field.text.contains('.') {
        let text = field.text.replacen(',', ".", 1);
        if is_number(&text) {
            field.text = Cow::Owned(text);
        }
    }
}

/// A cell with a delimiter or a quote is put in quotes, and its quotes are doubled. No cell has a line
/// break.
fn quoted(text: &str, delimiter: char) -> Cow<'_, str> {
    if text.contains([delimiter, '"']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

/// The cells of one line.
pub(crate) fn split(line: &str, delimiter: char, number: usize) -> Result<Vec<Field<'_>>, ReadError> {
    let line = line.strip_suffix('\r').unwrap_or(line);
    let mut fields = Vec::new();
    let mut rest = line;
    let mut position = 1;
    loop {
        let column = Some(position);
        let (text, after) = match rest.strip_prefix('"') {
            None => {
                let end = rest.find(delimiter).unwrap_or(rest.len());
                let (text, after) = rest.split_at(end);
                (Cow::Borrowed(text), after)
            }
            Some(inner) => {
                unquote(inner).ok_or_else(|| ReadError::at(number, column, "a quote that does not end"))?
            }
        };
        fields.push(Field { text, column });
        if after.is_empty() {
            return Ok(fields);
        }
        let cell = rest.get(..rest.len() - after.len()).unwrap_or_default();
        position += cell.chars().count() + 1;
        rest = after
            .strip_prefix(delimiter)
            .ok_or_else(|| ReadError::at(number, column, "text after the end of a quoted cell"))?;
    }
}

/// The text up to the closing quote and what follows it; `None` if there is no closing quote.
fn unquote(inner: &str) -> Option<(Cow<'_, str>, &str)> {
    let mut text = String::new();
    let mut rest = inner;
    loop {
        let (part, after) = rest.split_once('"')?;
        text.push_str(part);
        match after.strip_prefix('"') {
            Some(more) => {
                text.push('"');
                rest = more;
            }
            None => return Some((Cow::Owned(text), after)),
        }
    }
}
