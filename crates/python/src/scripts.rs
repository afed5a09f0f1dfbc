//! Scripts from Python: read from a file or a text, and run to their end.

use crate::errors;
use crate::rows::Rows;
use pyo3::prelude::*;
use standstill_script::model::Script;
use standstill_script::suite::{self, Allowed};
use standstill_script::{GUEST_MEMORY, Outcome, RunError, Session, warnings};
use std::path::PathBuf;
use std::time::{Duration, Instant};

/// Scans between two checks of the clock.
const LOOK_EVERY: u64 = 64;

/// Time between two checks for a request to end the run.
const SIGNALS_EVERY: Duration = Duration::from_millis(50);

/// The source of a script, and its permissions. Python gives these as one tuple: path, text, parameters,
/// folders beside the script's own, memory of its guests.
pub type Source = (
    PathBuf,
    Option<String>,
    Vec<(String, f64)>,
    Vec<PathBuf>,
    Option<u64>,
);

/// Reads a script: the text as if it were at the path, or the file.
pub fn read(py: Python<'_>, (path, text, set, folders, memory): &Source) -> PyResult<Script> {
    let allowed = Allowed {
        folders: folders.clone(),
        guest_memory: memory.unwrap_or(GUEST_MEMORY),
        ..Allowed::default()
    };
    match text {
        Some(text) => {
            suite::read_given(text, path, set, &allowed).map_err(|error| errors::script(py, &error))
        }
        None => {
            let read = py.detach(|| suite::read_file(path, set, &allowed));
            read.map(|(script, _)| script)
                .map_err(|error| errors::suite(py, &error))
        }
    }
}

/// Runs a script to its end and judges its claims. Ctrl-C ends the run early: the exception then has its rows so
/// far.
#[pyfunction]
pub fn run(py: Python<'_>, source: Source) -> PyResult<(Rows, Option<PyErr>)> {
    let script = read(py, &source)?;
    let mut session = Session::new(&script).map_err(|error| failed(py, &source, &error))?;
    let ended = py.detach(|| to_the_end(&mut session));
    let error = match ended {
        Ok(()) => {
            let outcome = py.detach(|| session.finish());
            return Ok((told(py, &script, outcome), None));
        }
        Err(ended) => ended.exception(py, &source),
    };
    Ok((Rows::unjudged(session.into_trace()), Some(error)))
}

/// A run with its verdict.
pub fn told(py: Python<'_>, script: &Script, outcome: Outcome) -> Rows {
    py.detach(|| {
        // The golden is not used, but the script has one.
        let warnings = warnings(script, &outcome, script.golden);
        Rows::judged(outcome, &warnings)
    })
}

/// A run that cannot continue, with the name of its script.
pub fn failed(py: Python<'_>, (path, ..): &Source, error: &RunError) -> PyErr {
    errors::run(py, &format!("{}: {error}", suite::shown(path)))
}

/// The reason why a run ended early.
pub enum Ended {
    /// It could not continue.
    Run(RunError),
    /// The exception that a signal handler of Python raised, such as for Ctrl-C.
    Signal(PyErr),
}

impl Ended {
    /// The same as an exception.
    pub fn exception(self, py: Python<'_>, source: &Source) -> PyErr {
        match self {
            Self::Run(error) => failed(py, source, &error),
            Self::Signal(error) => error,
        }
    }
}

/// Runs to the end, without Python except for checks for signals.
pub fn to_the_end(session: &mut Session<'_>) -> Result<(), Ended> {
    let mut looked = Instant::now();
    while session.advance().map_err(Ended::Run)? {
        if session.scans() % LOOK_EVERY == 0 && looked.elapsed() >= SIGNALS_EVERY {
            looked = Instant::now();
            Python::attach(|py| py.check_signals()).map_err(Ended::Signal)?;
        }
    }
    Ok(())
}
