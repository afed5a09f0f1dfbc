//! A script as a test, for pytest.

use crate::errors;
use pyo3::prelude::*;
use standstill_script::golden::{Mode, Standing};
use standstill_script::suite::{self, Allowed};
use standstill_trace::compare::Yardstick;
use std::path::PathBuf;

/// Judges a script by its claims and its golden, as `standstill test` does, and writes nothing. Returns
/// whether it passed, the text of the command line, and its warnings. Files that it names must be in its
/// folder or below, or in one of these.
#[pyfunction]
pub fn judge(py: Python<'_>, path: PathBuf, folders: Vec<PathBuf>) -> PyResult<(bool, String, String)> {
    let judged = py.detach(|| {
        let allowed = Allowed {
            folders,
            ..Allowed::default()
        };
        suite::judge_file(&path, Mode::Check, Yardstick::Exact, &allowed, |_| {})
    });
    let report = judged.map_err(|error| errors::suite(py, &error))?;
    let note = match &report.golden {
        Standing::Old(note) if report.passed() => format!("{note}\n"),
        _ => String::new(),
    };
    let warnings = format!("{note}{}", report.warnings);
    Ok((report.passed(), report.to_string(), warnings))
}
