//! A run that Python advances scan by scan.

use crate::errors;
use crate::rows::Rows;
use crate::scripts::{self, Source};
use pyo3::exceptions::{PyKeyError, PyRuntimeError, PyTypeError, PyValueError};
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use self_cell::self_cell;
use standstill_axis::DriveRequest;
use standstill_script::model::{FaultKind, Point, Script};
use standstill_script::{RunError, Session};
use standstill_trace::{Cell, shortest};
use std::collections::BTreeMap;
use std::sync::{Mutex, MutexGuard, TryLockError};

/// A session that is not finished.
struct Open<'a>(Option<Session<'a>>);

self_cell!(
    /// A session with the script it reads.
    struct Running {
        owner: Script,
        #[not_covariant]
        dependent: Open,
    }
);

/// A run between its scans.
struct State {
    running: Running,
    /// Names of the columns, as keys of a scan's dict.
    keys: Vec<Py<PyString>>,
    /// Points that were requested, by the name used.
    points: BTreeMap<String, Point>,
}

/// The order of an axis to its drive: request to the power stage, position, velocity.
type Ordered = (&'static str, f64, f64);

/// A run scan by scan. One call at a time: a second one at the same time is refused.
#[pyclass(frozen, module = "standstill._native")]
pub struct Scans {
    source: Source,
    state: Mutex<State>,
}

impl Scans {
    fn state(&self) -> PyResult<MutexGuard<'_, State>> {
        match self.state.try_lock() {
            Ok(state) => Ok(state),
            Err(TryLockError::Poisoned(poisoned)) => Ok(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) => Err(PyRuntimeError::new_err(
                "another thread is in a call of this Runtime: one call at a time",
            )),
        }
    }

    fn failed(&self, py: Python<'_>, error: &RunError) -> PyErr {
        scripts::failed(py, &self.source, error)
    }
}

impl State {
    /// Calls `on` with the session; raises an exception once it is finished.
    fn with<T>(&mut self, on: impl FnOnce(&mut Session<'_>) -> T) -> PyResult<T> {
        let told = self.running.with_dependent_mut(|_, open| open.0.as_mut().map(on));
        told.ok_or_else(|| PyRuntimeError::new_err("this Runtime is finished: make a new one"))
    }

    /// The point of this name in scripts.
    fn point(&mut self, name: &str) -> PyResult<Point> {
        if let Some(point) = self.points.get(name) {
            return Ok(*point);
        }
        let found = self.with(|session| session.point(name).ok_or_else(|| session.settable()))?;
        let point = found.map_err(|known| {
            PyKeyError::new_err(format!(
                "{name}: there is no such input; there are {}",
                known.join(", ")
            ))
        })?;
        self.points.insert(name.to_owned(), point);
        Ok(point)
    }

    fn axis(&mut self, name: &str) -> PyResult<usize> {
        let axes = &self.running.borrow_owner().axes;
        let found = axes.iter().position(|axis| axis.name.eq_ignore_ascii_case(name));
        found.ok_or_else(|| {
            let known: Vec<&str> = axes.iter().map(|axis| axis.name.as_str()).collect();
            PyKeyError::new_err(format!(
                "{name}: there is no such axis; there are {}",
                known.join(", ")
            ))
        })
    }

    /// The value of every column in the last row.
    fn signals<'py>(&mut self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.with(|_| ())?;
        let Self { running, keys, .. } = self;
        let told = PyDict::new(py);
        running.with_dependent_mut(|_, open| {
            let Some(session) = &open.0 else { return Ok(()) };
            let trace = session.trace();
            let Some(last) = trace.scans().checked_sub(1) else {
                return Ok(());
            };
            for (column, key) in keys.iter().enumerate() {
                if let Some(cell) = trace.cell(last, column) {
                    told.set_item(key, value(py, cell))?;
                }
            }
            Ok::<(), PyErr>(())
        })?;
        Ok(told)
    }
}

fn value<'py>(py: Python<'py>, cell: Cell<'_>) -> Bound<'py, PyAny> {
    match cell {
        Cell::Bool(value) => PyBool::new(py, value).to_owned().into_any(),
        Cell::Real(value) => PyFloat::new(py, value).into_any(),
        // Infallible.
        Cell::Integer(value) => match value.into_pyobject(py) {
            Ok(value) => value.into_any(),
            Err(never) => match never {},
        },
        Cell::Name(text) => PyString::new(py, text).into_any(),
    }
}

/// A Python value in the form of a script.
fn text(name: &str, value: &Bound<'_, PyAny>) -> PyResult<String> {
    if let Ok(value) = value.cast::<PyBool>() {
        return Ok(if value.is_true() { "TRUE" } else { "FALSE" }.to_owned());
    }
    if let Ok(value) = value.cast::<PyString>() {
        return Ok(value.to_string());
    }
    if value.is_instance_of::<PyFloat>() {
        return Ok(shortest(value.extract()?));
    }
    if value.is_instance_of::<PyInt>() {
        return Ok(value.str()?.to_string());
    }
    Err(PyTypeError::new_err(format!(
        "{name}: a bool, a number or a text is wanted, not {}",
        value.get_type().name()?
    )))
}

#[pymethods]
impl Scans {
    #[new]
    fn new(py: Python<'_>, source: Source) -> PyResult<Self> {
        let script = scripts::read(py, &source)?;
        let running = Running::try_new(script, |script| {
            Session::new(script).map(|session| Open(Some(session)))
        });
        let mut running = running.map_err(|error| scripts::failed(py, &source, &error))?;
        let names: Vec<String> = running.with_dependent_mut(|_, open| {
            let columns = open.0.iter().flat_map(|session| session.trace().columns());
            columns.map(|column| column.name.clone()).collect()
        });
        let keys = names.iter().map(|name| PyString::intern(py, name).unbind());
        let state = State {
            keys: keys.collect(),
            points: BTreeMap::new(),
            running,
        };
        Ok(Self {
            source,
            state: Mutex::new(state),
        })
    }

    /// The next scan writes these inputs: all of them, or none if one cannot be written.
    fn write(&self, inputs: &Bound<'_, PyDict>) -> PyResult<()> {
        let state = &mut *self.state()?;
        let mut changes = Vec::with_capacity(inputs.len());
        for (name, value) in inputs {
            let name: String = name
                .extract()
                .map_err(|_| PyTypeError::new_err("inputs: the names are texts"))?;
            let text = text(&name, &value)?;
            changes.push((state.point(&name)?, text));
        }
        state
            .with(|session| session.change_all(&changes))?
            .map_err(PyValueError::new_err)
    }

    /// Does the next scan, and returns the value of every signal in it. None if the run was over before.
    fn scan<'py>(&self, py: Python<'py>) -> PyResult<Option<Bound<'py, PyDict>>> {
        let state = &mut *self.state()?;
        let advanced = state.with(|session| session.advance())?;
        if !advanced.map_err(|error| self.failed(py, &error))? {
            return Ok(None);
        }
        state.signals(py).map(Some)
    }

    /// The last order of an axis to its drive.
    fn ordered(&self, axis: &str) -> PyResult<Ordered> {
        let state = &mut *self.state()?;
        let axis = state.axis(axis)?;
        let ordered = state.with(|session| session.ordered(axis))?;
        let ordered = ordered.ok_or_else(|| PyKeyError::new_err("there is no such axis"))?;
        let request = match ordered.request {
            DriveRequest::Off => "off",
            DriveRequest::Enable => "enable",
            DriveRequest::QuickStop => "quick_stop",
            DriveRequest::FaultReset => "fault_reset",
        };
        Ok((request, ordered.position, ordered.velocity))
    }

    /// From the next scan on the drive of the axis is at this position.
    fn lead(&self, axis: &str, position: f64) -> PyResult<()> {
        let state = &mut *self.state()?;
        let index = state.axis(axis)?;
        state
            .with(|session| session.lead(index, position))?
            .map_err(|why| PyValueError::new_err(format!("{axis}: {why}")))
    }

    /// Makes an axis or its drive fail in the next scan; without a kind the cause is removed.
    fn fault(&self, axis: &str, kind: Option<&str>, code: u16) -> PyResult<()> {
        let state = &mut *self.state()?;
        let axis = state.axis(axis)?;
        let kind = kind.map(|kind| match kind {
            "drive" => Ok(FaultKind::Drive),
            "power" => Ok(FaultKind::Power),
            "communication" => Ok(FaultKind::Communication),
            "axis" => Ok(FaultKind::Axis),
            other => Err(PyValueError::new_err(format!(
                "{other}: there is no such fault; there are drive, power, communication, axis"
            ))),
        });
        let fault = kind.transpose()?.map(|kind| (kind, code));
        state.with(|session| session.fail(axis, fault))
    }

    /// Names that inputs of a scan may have.
    fn settable(&self) -> PyResult<Vec<String>> {
        self.state()?.with(|session| session.settable())
    }

    /// Scans done, and whether the run is over.
    fn progress(&self) -> PyResult<(u64, bool)> {
        self.state()?.with(|session| (session.scans(), session.is_over()))
    }

    /// The value of every signal in the last scan.
    fn signals<'py>(&self, py: Python<'py>) -> PyResult<Bound<'py, PyDict>> {
        self.state()?.signals(py)
    }

    /// The inputs so far as steps of the script: a text with the same run.
    fn as_script(&self, py: Python<'_>, text: &str) -> PyResult<String> {
        let changes = self.state()?.with(|session| session.changes().to_vec())?;
        let (path, ..) = &self.source;
        let name = standstill_script::suite::shown(path);
        standstill_script::with_changes(text, &name, &changes).map_err(|error| errors::script(py, &error))
    }

    /// A copy of the rows so far.
    fn rows(&self) -> PyResult<Rows> {
        let trace = self.state()?.with(|session| session.trace().clone())?;
        Ok(Rows::unjudged(trace))
    }

    /// Runs to the end and judges the claims on all rows.
    fn finish(&self, py: Python<'_>) -> PyResult<Rows> {
        let state = &mut *self.state()?;
        let ended = py.detach(|| state.with(scripts::to_the_end))?;
        ended.map_err(|ended| ended.exception(py, &self.source))?;
        let running = &mut state.running;
        let outcome = py.detach(|| running.with_dependent_mut(|_, open| open.0.take().map(Session::finish)));
        let outcome = outcome.ok_or_else(|| PyRuntimeError::new_err("this Runtime is finished"))?;
        Ok(scripts::told(py, state.running.borrow_owner(), outcome))
    }
}
