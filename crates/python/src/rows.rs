//! The rows of a run, lent to NumPy.

use crate::errors;
use numpy::{PyArray1, PyArrayMethods};
use pyo3::prelude::*;
use pyo3::sync::MutexExt;
use pyo3::types::PyDict;
use standstill_cli::verdict;
use standstill_picture::svg;
use standstill_script::{Outcome, Verdict, Warnings};
use standstill_trace::{Trace, digest, events, file};
use std::path::PathBuf;
use std::sync::{Mutex, MutexGuard};

/// The words of a trace, once they are lent.
struct Held {
    trace: Trace,
    lent: Option<Py<PyArray1<u64>>>,
}

/// A claim for Python: path, text, whether it is fulfilled, first and last scan, the scan in which it was
/// fulfilled, and the reasons against it, each a scan and a text.
type Claim = (
    String,
    String,
    bool,
    Option<[u64; 2]>,
    Option<u64>,
    Vec<(Option<u64>, String)>,
);

/// The rows of a run and its results.
#[pyclass(frozen, module = "standstill._native")]
pub struct Rows {
    held: Mutex<Held>,
    digest: String,
    verdict: Option<String>,
    claims: Vec<Claim>,
    why: Vec<String>,
    warnings: Vec<String>,
}

impl Rows {
    /// The rows of a run that ended early: its claims refer to scans that never happened.
    pub fn unjudged(trace: Trace) -> Self {
        let digest = digest::whole(&trace);
        Self::with_digest(trace, digest)
    }

    fn with_digest(trace: Trace, digest: u64) -> Self {
        Self {
            digest: format!("{digest:016x}"),
            held: Mutex::new(Held { trace, lent: None }),
            verdict: None,
            claims: Vec::new(),
            why: Vec::new(),
            warnings: Vec::new(),
        }
    }

    /// The rows of a run with its verdict.
    pub fn judged(outcome: Outcome, warnings: &Warnings) -> Self {
        let digest = digest::whole(&outcome.trace);
        let verdict = verdict(&outcome, digest);
        let claims = outcome.verdicts.iter().map(claim).collect();
        let why = outcome.why.iter().map(|reason| reason.text.clone()).collect();
        let warnings = warnings.all.iter().map(|warning| {
            let (file, line, column) = warnings.place(warning);
            format!(
                "{file}:{line}:{column}: {}: {}",
                warning.kind.name(),
                warning.message
            )
        });
        Self {
            verdict: Some(verdict),
            claims,
            why,
            warnings: warnings.collect(),
            ..Self::with_digest(outcome.trace, digest)
        }
    }

    /// The rows, once no other thread uses them; the GIL is released meanwhile.
    fn held(&self, py: Python<'_>) -> MutexGuard<'_, Held> {
        let held = self.held.lock_py_attached(py);
        held.unwrap_or_else(|poisoned| poisoned.into_inner())
    }

    /// Calls `look` with the whole trace; lent rows are copied for it.
    fn with_trace<T: Send>(&self, py: Python<'_>, look: impl FnOnce(&Trace) -> T + Send) -> PyResult<T> {
        let mut held = self.held(py);
        let lent = held.lent.as_ref().map(|lent| lent.clone_ref(py));
        let Some(lent) = lent else {
            let held = &mut *held;
            return Ok(py.detach(|| look(&held.trace)));
        };
        let words = lent.bind(py).try_readonly()?.as_slice()?.to_vec();
        let held = &mut *held;
        Ok(py.detach(|| {
            held.trace.put_words(&words);
            let seen = look(&held.trace);
            drop(held.trace.take_words());
            seen
        }))
    }
}

fn claim(verdict: &Verdict) -> Claim {
    let failures = verdict.failures.iter();
    let failures = failures.map(|failure| (failure.scan, failure.to_string()));
    (
        verdict.path.clone(),
        verdict.says.clone(),
        verdict.passed(),
        verdict.scans,
        verdict.held,
        failures.collect(),
    )
}

#[pymethods]
impl Rows {
    /// The digest of every bit, as the command line prints it.
    #[getter]
    fn digest(&self) -> &str {
        &self.digest
    }

    /// The last line of `standstill run`; none for a run that ended early.
    #[getter]
    fn verdict(&self) -> Option<&str> {
        self.verdict.as_deref()
    }

    /// The claims in file order.
    #[getter]
    fn claims(&self) -> Vec<Claim> {
        self.claims.clone()
    }

    /// The reasons why claims fail, the likeliest first.
    #[getter]
    fn why(&self) -> Vec<String> {
        self.why.clone()
    }

    /// Items that test nothing, and values that were changed on the way.
    #[getter]
    fn warnings(&self) -> Vec<String> {
        self.warnings.clone()
    }

    /// Names and kinds of the columns, in the order of files.
    fn columns(&self, py: Python<'_>) -> Vec<(String, &'static str)> {
        let held = self.held(py);
        let columns = held.trace.columns().iter();
        columns
            .map(|column| (column.name.clone(), column.kind.name()))
            .collect()
    }

    /// Names that occur in rows; the word of a name is its index in this list.
    fn names(&self, py: Python<'_>) -> Vec<String> {
        self.held(py).trace.names().to_vec()
    }

    /// All rows, one after the other, a word for each cell, in the memory of the recording.
    fn words<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyArray1<u64>>> {
        let mut held = self.held(py);
        if let Some(lent) = &held.lent {
            return Ok(lent.bind(py).clone());
        }
        let words = PyArray1::from_vec(py, held.trace.take_words());
        let read_only = PyDict::new(py);
        read_only.set_item("write", false)?;
        words.call_method("setflags", (), Some(&read_only))?;
        held.lent = Some(words.clone().unbind());
        Ok(words)
    }

    /// The events: scan, subject, text.
    fn events(&self, py: Python<'_>) -> PyResult<Vec<(usize, String, String)>> {
        self.with_trace(py, |trace| {
            let events = events(trace).into_iter();
            events
                .map(|event| (event.scan, event.subject, event.text))
                .collect()
        })
    }

    /// Title, cycle in nanoseconds, and axes with their units.
    fn about(&self, py: Python<'_>) -> (String, u64, Vec<(String, String)>) {
        let held = self.held(py);
        let header = held.trace.header();
        let axes = header.axes.iter();
        let axes = axes.map(|axis| (axis.name.clone(), axis.unit.clone()));
        (header.title.clone(), header.cycle_ns, axes.collect())
    }

    /// The picture of these signals of every axis, and of every Boolean that changes.
    fn svg(&self, py: Python<'_>, signals: Vec<String>) -> PyResult<String> {
        self.with_trace(py, |trace| {
            let signals: Vec<&str> = signals.iter().map(String::as_str).collect();
            svg(trace, &signals)
        })
    }

    /// Writes a .csv or .jsonl file as `standstill run --trace` does.
    fn save(&self, py: Python<'_>, path: PathBuf) -> PyResult<()> {
        self.with_trace(py, |trace| file::save(trace, &path))?
            .map_err(|error| errors::file(&error))
    }
}
