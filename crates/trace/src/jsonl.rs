//! Traces as JSON Lines: the header object, then one flat object a scan.

use std::borrow::Cow;
use std::collections::BTreeMap;
use std::fmt;
use std::io::{self, Write};

use serde::de::{Deserialize, Deserializer, MapAccess, Visitor};

use crate::column::Cell;
use crate::header::{Cam, Claim, Header, VERSION_KEY};
use crate::number::{cell_text, shortest};
use crate::read::{Field, Line, Loaded, ReadError, assemble};
use crate::trace::{Note, Trace};

/// The key that marks the object behind the rows of a trace that was written during its run: its verdicts
/// and notes.
pub(crate) const END_KEY: &str = "standstill_trace_end";

/// The object behind the rows.
#[derive(serde::Deserialize)]
struct End {
    #[serde(default)]
    claims: Vec<Claim>,
    #[serde(default)]
    cams: Vec<Cam>,
    #[serde(default)]
    notes: Vec<Note>,
}

impl End {
    /// The end of a text, and the text before it; an empty end if there is none.
    fn split(text: &str) -> Result<(&str, Option<Self>), ReadError> {
        let whole = text.trim_end();
        let begin = whole.rfind('\n').map_or(0, |end| end + 1);
        let (rows, last) = whole.split_at(begin);
        if !last.starts_with(&format!("{{\"{END_KEY}\":")) {
            return Ok((text, None));
        }
        let number = rows.lines().count() + 1;
        let end = serde_json::from_str(last).map_err(|error| ReadError::json(&error, number))?;
        Ok((rows, Some(end)))
    }
}

/// Writes header and rows.
///
/// # Errors
/// Those of `out`.
pub fn write(trace: &Trace, out: &mut impl Write) -> io::Result<()> {
    writeln!(out, "{}", trace.header_json())?;
    write_rows(trace, trace.first(), out)
}

/// The rows from a scan on.
pub(crate) fn write_rows(trace: &Trace, from: usize, out: &mut impl Write) -> io::Result<()> {
    let keys: Vec<String> = trace
        .columns()
        .iter()
        .map(|column| json_string(&column.name))
        .collect();
    for scan in from..trace.scans() {
        write!(out, "{{\"scan\":{scan},\"time_ns\":{}", trace.time_ns(scan))?;
        for (key, cell) in keys.iter().zip(trace.row(scan)) {
            write!(out, ",{key}:{}", json_cell(cell))?;
        }
        out.write_all(b"}\n")?;
    }
    Ok(())
}

fn json_cell(cell: Cell<'_>) -> String {
    match cell {
        Cell::Bool(value) => value.to_string(),
        Cell::Real(value) if value.is_finite() => shortest(value),
        Cell::Real(_) | Cell::Name(_) => json_string(&cell_text(cell)),
        Cell::Integer(value) => value.to_string(),
    }
}

fn json_string(text: &str) -> String {
    serde_json::Value::from(text).to_string()
}

/// Reads a trace. Blank lines are skipped. The header may be missing: the kinds of columns are then found from
/// their values.
///
/// # Errors
/// Lines that are not JSON objects, rows whose keys differ from those of the first row, a file that is
/// cut short, or values that do not agree with the header. The error has the line, and the column if one
/// can be named.
pub fn read(text: &str) -> Result<Loaded, ReadError> {
    let (text, end) = End::split(text.strip_prefix('\u{feff}').unwrap_or(text))?;
    let mut lines = text.lines().enumerate().map(|(at, line)| (at + 1, line));
    let is_header = |row: &Row| row.0.first().is_some_and(|(key, _)| key == VERSION_KEY);
    let Some((number, first)) = lines.by_ref().find(|(_, line)| !line.trim().is_empty()) else {
        return Err(ReadError::at(1, Some(1), "an empty file"));
    };
    let first_row = Row::parse(first, number)?;
    let (header, first_row) = if is_header(&first_row) {
        let header = Header::with_notes(first).map_err(|error| ReadError {
            line: number,
            ..error
        })?;
        let row = lines.find(|(_, line)| !line.trim().is_empty());
        (
            Some(header),
            row.map(|(number, line)| Row::parse(line, number)).transpose()?,
        )
    } else {
        (None, Some(first_row))
    };
    let names: Vec<String> = match (&first_row, &header) {
        (Some(row), _) => row.0.iter().map(|(key, _)| key.clone()).collect(),
        (None, Some((header, _))) => clock_names()
            .chain(header.columns().into_iter().map(|column| column.name))
            .collect(),
        (None, None) => Vec::new(),
    };
    let skip = if header.is_some() { number } else { number - 1 };
    let header = header.map(|(mut header, mut notes)| {
        if let Some(end) = end {
            header.claims = end.claims;
            header.cams = end.cams;
            notes = end.notes;
        }
        (header, notes)
    });
    assemble(&names, header, || {
        text.lines()
            .enumerate()
            .skip(skip)
            .filter(|(_, line)| !line.trim().is_empty())
            .map(|(at, line)| Row::parse(line, at + 1)?.into_line(at + 1, &names))
    })
}

fn clock_names() -> impl Iterator<Item = String> {
    ["scan", "time_ns"].into_iter().map(str::to_owned)
}

/// The members of one object in their order, each value as the text of a CSV cell.
struct Row(Vec<(String, String)>);

impl Row {
    fn parse(line: &str, number: usize) -> Result<Self, ReadError> {
        serde_json::from_str(line).map_err(|error| ReadError::json(&error, number))
    }

    /// The values in the order of `names`.
    fn into_line(self, number: usize, names: &[String]) -> Result<Line<'static>, ReadError> {
        let wrong = |what: &str, key: &str| ReadError::at(number, None, format!("{what} key `{key}`"));
        let in_order =
            self.0.len() == names.len() && self.0.iter().zip(names).all(|((key, _), name)| key == name);
        let texts: Vec<String> = if in_order {
            self.0.into_iter().map(|(_, text)| text).collect()
        } else {
            let mut by_key = BTreeMap::new();
            for (key, text) in self.0 {
                if by_key.contains_key(&key) {
                    return Err(wrong("repeated", &key));
                }
                by_key.insert(key, text);
            }
            let texts = names
                .iter()
                .map(|name| by_key.remove(name).ok_or_else(|| wrong("missing", name)))
                .collect::<Result<_, _>>()?;
            if let Some(key) = by_key.keys().next() {
                return Err(wrong("unknown", key));
            }
            texts
        };
        let fields = texts
            .into_iter()
            .map(|text| Field {
                text: Cow::Owned(text),
                column: None,
            })
            .collect();
        Ok(Line { number, fields })
    }
}

impl<'de> Deserialize<'de> for Row {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_map(RowVisitor)
    }
}

/// Keeps the order of the members, which is the order of columns: a map of serde_json would sort them.
struct RowVisitor;

impl<'de> Visitor<'de> for RowVisitor {
    type Value = Row;

    fn expecting(&self, formatter: &mut fmt::Formatter<'_>) -> fmt::Result {
        formatter.write_str("a JSON object")
    }

    fn visit_map<A: MapAccess<'de>>(self, mut map: A) -> Result<Row, A::Error> {
        let mut members = Vec::new();
        while let Some((key, value)) = map.next_entry::<String, serde_json::Value>()? {
            members.push((key, value_text(&value)));
        }
        Ok(Row(members))
    }
}

fn value_text(value: &serde_json::Value) -> String {
    match value {
        serde_json::Value::Bool(true) => "TRUE".to_owned(),
        serde_json::Value::Bool(false) => "FALSE".to_owned(),
        serde_json::Value::String(text) => text.clone(),
        serde_json::Value::Number(number) if number.is_f64() => {
            number.as_f64().map(shortest).unwrap_or_default()
        }
        // A row has no null, lists or objects. Their text is no number and no truth value, so the
        // column's kind refuses it, or it is a name.
        other => other.to_string(),
    }
}
