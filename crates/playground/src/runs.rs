//! The run of a script.

use crate::bounds;
use crate::project::{Project, refused};
use serde_json::{Value, json};
use standstill_cli::verdict;
use standstill_report::{Source, about};
use standstill_script::{Outcome, Session, warnings};
use standstill_trace::{Cell, Column, Kind, Role, Trace, digest};

/// Scans between two reports of progress.
const PROGRESS_EVERY: u64 = 1_000;

/// The result of a run.
#[derive(Clone, Debug, Default)]
pub struct Ran {
    /// JSON. For a run: `verdict` (the last line of the command line's text), `passed`, `digest`,
    /// `scans`, `why`, `warnings`, `rows`, `trace` (name, header, events as in reports) and `columns`.
    /// Otherwise the answer of [`check`](crate::check).
    pub about: String,
    /// The numbers of all columns that have a `reals`, which is the index of their first one here; a
    /// number for each row.
    pub reals: Vec<f64>,
}

/// Runs a script to its end and judges its claims. `progress` is called from time to time with the number
/// of scans done, and returns whether to continue.
///
/// A column has `name`, `kind`, `role`, `is_time`, and either `reals` or `scans` and `values`: the scans
/// of its changes, and the new values. Integers are texts, because JSON's numbers are not exact for all
/// of them.
pub fn run(request: &str, mut progress: impl FnMut(u64, u64) -> bool) -> Ran {
    let ran = Project::read(request).and_then(|project| {
        let outcome = run_project(&project, &mut progress)?;
        Ok(told(project.name(), &outcome.0, outcome.1))
    });
    ran.unwrap_or_else(|wrong| Ran {
        about: wrong.to_string(),
        reals: Vec::new(),
    })
}

/// The outcome of a project's run, and its warnings.
pub fn run_project(
    project: &Project,
    progress: &mut dyn FnMut(u64, u64) -> bool,
) -> Result<(Outcome, Value), Value> {
    let script = project.script()?;
    let mut session = Session::new(&script).map_err(|error| refused(&error.to_string()))?;
    bounds::cells(script.scans, session.trace().columns().len()).map_err(|why| refused(&why))?;
    session.reserve();
    while session.advance().map_err(|error| refused(&error.to_string()))? {
        if session.scans() % PROGRESS_EVERY == 0 && !progress(session.scans(), script.scans) {
            return Err(refused(&format!("ended by hand after {} scans", session.scans())));
        }
    }
    let outcome = session.finish();
    let found = warnings(&script, &outcome, script.golden);
    let found: Vec<Value> = found
        .all
        .iter()
        .map(|warning| {
            let (file, line, column) = found.place(warning);
            json!({
                "kind": warning.kind.name(), "path": warning.path, "file": file, "from": [line, column],
                "message": warning.message, "help": warning.help,
            })
        })
        .collect();
    Ok((outcome, Value::from(found)))
}

fn told(name: &str, outcome: &Outcome, warnings: Value) -> Ran {
    let trace = &outcome.trace;
    let mut reals = Vec::new();
    let columns: Vec<Value> = trace
        .columns()
        .iter()
        .enumerate()
        .map(|(index, column)| told_column(trace, index, column, &mut reals))
        .collect();
    let source = Source {
        name,
        trace,
        lacks: &[],
    };
    let why: Vec<Value> = outcome
        .why
        .iter()
        .map(|reason| json!({"scan": reason.scan, "text": reason.text, "claims": reason.claims}))
        .collect();
    let digest = digest::whole(trace);
    let about = json!({
        "verdict": verdict(outcome, digest),
        "passed": outcome.passed(),
        "digest": format!("{digest:016x}"),
        "rows": trace.scans(),
        "why": why,
        "warnings": warnings,
        "trace": about(&source),
        "columns": columns,
    });
    Ran {
        about: about.to_string(),
        reals,
    }
}

fn told_column(trace: &Trace, index: usize, column: &Column, reals: &mut Vec<f64>) -> Value {
    let mut told = json!({
        "name": column.name,
        "kind": column.kind.name(),
        "role": role(column.role),
        "is_time": column.is_time,
    });
    if column.kind == Kind::Real {
        told["reals"] = json!(reals.len());
        reals.extend(trace.reals(index));
        return told;
    }
    let (mut scans, mut values) = (Vec::new(), Vec::new());
    let mut last = None;
    for (scan, cell) in trace.cells(index).enumerate() {
        if last != Some(cell) {
            scans.push(scan);
            values.push(value(cell));
            last = Some(cell);
        }
    }
    told["scans"] = json!(scans);
    told["values"] = Value::from(values);
    told
}

fn value(cell: Cell<'_>) -> Value {
    match cell {
        Cell::Bool(value) => json!(value),
        Cell::Real(value) => json!(value),
        Cell::Integer(value) => json!(value.to_string()),
        Cell::Name(text) => json!(text),
    }
}

const fn role(role: Role) -> &'static str {
    match role {
        Role::AxisState => "state",
        Role::AxisValue => "value",
        Role::Variable => "variable",
        Role::InOut => "in_out",
        Role::Input => "input",
        Role::Output => "output",
    }
}
