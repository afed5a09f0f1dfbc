//! Some rows and columns of a trace, read line by line, because a trace may be larger than the memory.

use super::bounded::LONGEST;
use serde_json::{Map, Value, json};
use std::fs::File;
use std::io::{BufRead as _, BufReader};
use std::path::Path;

/// The requested rows and columns.
#[derive(Debug)]
pub struct Wanted {
    /// The columns, such as `X.Position`.
    pub signals: Vec<String>,
    /// The first scan.
    pub from: u64,
    /// The last scan.
    pub to: Option<u64>,
    /// The step between scans.
    pub every: Option<u64>,
}

/// The rows of a trace in JSON Lines: `{"columns": [..], "rows": [[..], ..]}`.
///
/// # Errors
/// A signal that does not exist, more rows than fit into an answer, a file that cannot be read.
pub fn rows(trace: &Path, wanted: &Wanted) -> Result<Value, String> {
    let failed = |error: std::io::Error| format!("the trace: {error}");
    let every = wanted.every.unwrap_or(1).max(1);
    let mut rows = Vec::new();
    let mut length = 0;
    for line in BufReader::new(File::open(trace).map_err(failed)?).lines() {
        let line = line.map_err(failed)?;
        let row: Map<String, Value> =
            serde_json::from_str(&line).map_err(|error| format!("the trace: {error}"))?;
        // The header has no scan.
        let Some(scan) = row.get("scan").and_then(Value::as_u64) else {
            continue;
        };
        if wanted.to.is_some_and(|to| scan > to) {
            break;
        }
        if scan < wanted.from || !(scan - wanted.from).is_multiple_of(every) {
            continue;
        }
        let mut cells = vec![json!(scan)];
        for signal in &wanted.signals {
            cells.push(row.get(signal).ok_or_else(|| unknown(signal, &row))?.clone());
        }
        let cells = Value::Array(cells);
        length += cells.to_string().len() + 1;
        if length > LONGEST {
            return Err(format!(
                "the rows have more than {LONGEST} bytes: ask for fewer signals, or for fewer scans by `from`, `to` and `every`"
            ));
        }
        rows.push(cells);
    }
    let mut columns = vec!["scan"];
    columns.extend(wanted.signals.iter().map(String::as_str));
    Ok(json!({"columns": columns, "rows": rows}))
}

fn unknown(signal: &str, row: &Map<String, Value>) -> String {
    let names = row.keys().map(String::as_str);
    match crate::suggest::nearest(signal, names) {
        Some(name) => format!("there is no signal {signal}; did you mean `{name}`?"),
        None => {
            let names: Vec<&str> = row.keys().map(String::as_str).take(60).collect();
            format!("there is no signal {signal}; there are {}", names.join(", "))
        }
    }
}
