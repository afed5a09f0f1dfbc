//! Traces as comma-separated values: a line of column names, then one line a scan.
//!
//! Written by hand rather than with a library: names and numbers need no quotes, so what is left is a
//! split at commas that can tell the character position of a bad cell.

use std::borrow::Cow;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

use crate::header::Header;
use crate::number::cell_text;
use crate::read::{Field, Line, Loaded, ReadError, assemble};
use crate::trace::Trace;

/// Writes the rows. The header belongs into the file of [`meta_path`], as [`Header::to_json`] gives it.
///
/// # Errors
/// Those of `out`.
pub fn write(trace: &Trace, out: &mut impl Write) -> io::Result<()> {
    out.write_all(b"scan,time_ns")?;
    for column in trace.columns() {
        write!(out, ",{}", quoted(&column.name))?;
    }
    out.write_all(b"\n")?;
    for scan in 0..trace.scans() {
        write!(out, "{scan},{}", trace.time_ns(scan))?;
        for cell in trace.row(scan) {
            write!(out, ",{}", quoted(&cell_text(cell)))?;
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

/// Reads a trace, with the text of its meta file if there is one. A byte order mark and CRLF are taken.
/// Without a header the kinds of columns are told from their texts.
///
/// # Errors
/// Text that is no trace, is cut short, or does not agree with the header; with the line, and the column
/// where one can be named. Errors in the meta file are told apart by their message.
pub fn read(text: &str, meta: Option<&str>) -> Result<Loaded, ReadError> {
    let header = meta
        .map(Header::from_json)
        .transpose()
        .map_err(|error| ReadError {
            message: format!("in the meta file: {}", error.message),
            ..error
        })?;
    let text = text.strip_prefix('\u{feff}').unwrap_or(text);
    let Some((first, rows)) = text.split_once('\n') else {
        return Err(ReadError::at(1, Some(1), "no line of column names"));
    };
    let names: Vec<String> = split(first, 1)?
        .into_iter()
        .map(|field| field.text.into_owned())
        .collect();
    if !rows.is_empty() && !rows.ends_with('\n') {
        // The last number may have lost digits, and no other check would see it.
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
            let fields = split(line, number)?;
            if fields.len() == width {
                Ok(Line { number, fields })
            } else {
                let message = format!("{} cells where line 1 names {width} columns", fields.len());
                Err(ReadError::at(number, None, message))
            }
        })
    })
}

/// A cell that holds a comma or a quote stands in quotes, its quotes doubled. No cell holds a line break.
fn quoted(text: &str) -> Cow<'_, str> {
    if text.contains([',', '"']) {
        Cow::Owned(format!("\"{}\"", text.replace('"', "\"\"")))
    } else {
        Cow::Borrowed(text)
    }
}

/// The cells of one line.
fn split(line: &str, number: usize) -> Result<Vec<Field<'_>>, ReadError> {
    let line = line.strip_suffix('\r').unwrap_or(line);
    let mut fields = Vec::new();
    let mut rest = line;
    let mut position = 1;
    loop {
        let column = Some(position);
        let (text, after) = match rest.strip_prefix('"') {
            None => {
                let end = rest.find(',').unwrap_or(rest.len());
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
            .strip_prefix(',')
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
