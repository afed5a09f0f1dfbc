//! Errors of the runtime as exceptions. Their classes are written in Python, in `standstill/_errors.py`.

use pyo3::exceptions::PyOSError;
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::PyDict;
use standstill_script::suite::{SuiteError, shown};
use standstill_script::{Diagnostic, ScriptError};
use standstill_trace::file::FileError;
use std::io;
use std::path::Path;

/// An exception of ours, of this class.
fn of_class<'py>(py: Python<'py>, class: &str, arguments: impl pyo3::call::PyCallArgs<'py>) -> PyErr {
    let made = py
        .import(intern!(py, "standstill._errors"))
        .and_then(|errors| errors.getattr(class)?.call1(arguments));
    made.map_or_else(|error| error, PyErr::from_value)
}

/// A run that could not continue.
pub fn run(py: Python<'_>, text: &str) -> PyErr {
    of_class(py, "RunError", (text,))
}

/// A line that was not planned: code, field, value, nearest, message.
pub fn plan<'py>(
    py: Python<'py>,
    told: (&str, Option<&str>, Bound<'py, PyAny>, Bound<'py, PyAny>, &str),
) -> PyErr {
    of_class(py, "PlanError", told)
}

/// A script that cannot be used.
pub fn script(py: Python<'_>, error: &ScriptError) -> PyErr {
    let own = error
        .diagnostics()
        .iter()
        .map(|found| diagnostic(py, error, found));
    let programs = error.reports().iter().flat_map(|report| {
        report.diagnostics().iter().map(|found| {
            let at = report.positions(found.span).0;
            let place = Some((
                report.file_name(found.span).to_owned(),
                at.line as usize,
                at.column as usize,
            ));
            let name = found.code.name();
            told(py, (name, &found.message, found.help.as_deref(), place))
        })
    });
    let diagnostics: PyResult<Vec<_>> = own.chain(programs).collect();
    match diagnostics {
        Ok(diagnostics) => of_class(py, "ScriptError", (error.render(), diagnostics)),
        Err(error) => error,
    }
}

fn diagnostic<'py>(py: Python<'py>, error: &ScriptError, found: &Diagnostic) -> PyResult<Bound<'py, PyDict>> {
    let place = found.span.map(|span| {
        let (line, column) = error.line_column(span);
        (error.file_of(span).to_owned(), line, column)
    });
    let place = place.or_else(|| Some((error.file_name().to_owned(), 0, 0)));
    told(
        py,
        (found.code.name(), &found.message, found.help.as_deref(), place),
    )
}

/// File, line and column.
type Place = (String, usize, usize);

/// One fault; the line is 0 for a fault without a place in the text.
fn told<'py>(
    py: Python<'py>,
    (code, message, help, place): (&str, &str, Option<&str>, Option<Place>),
) -> PyResult<Bound<'py, PyDict>> {
    let (file, line, column) = place.unwrap_or_default();
    let told = PyDict::new(py);
    told.set_item("code", code)?;
    told.set_item("message", message)?;
    told.set_item("file", file)?;
    told.set_item("line", (line > 0).then_some(line))?;
    told.set_item("column", (line > 0).then_some(column))?;
    told.set_item("help", help)?;
    Ok(told)
}

/// The reason why a script cannot be read or run.
pub fn suite(py: Python<'_>, error: &SuiteError) -> PyErr {
    match error {
        SuiteError::Script(wrong) => script(py, wrong),
        SuiteError::Io { path, source } => os(path, source),
        SuiteError::Run { .. } => run(py, &error.to_string()),
        SuiteError::Encoding { path, .. } => {
            let place = Some((shown(path), 0, 0));
            match told(py, ("encoding", &error.to_string(), None, place)) {
                Ok(found) => of_class(py, "ScriptError", (format!("error: {error}"), vec![found])),
                Err(error) => error,
            }
        }
        SuiteError::Golden(error) => PyOSError::new_err(error.to_string()),
    }
}

/// The system's error for a file: a `FileNotFoundError` or similar, which Python chooses by the number.
pub fn os(path: &Path, source: &io::Error) -> PyErr {
    match source.raw_os_error() {
        Some(number) => {
            let text = source.to_string();
            let text = text.split(" (os error").next().unwrap_or_default().to_owned();
            PyOSError::new_err((number, text, path.as_os_str().to_owned()))
        }
        None => PyOSError::new_err(format!("{}: {source}", shown(path))),
    }
}

/// A file that could not be written.
pub fn file(error: &FileError) -> PyErr {
    PyOSError::new_err(error.to_string())
}
