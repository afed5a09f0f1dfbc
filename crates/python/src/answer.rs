//! The answer to a line as a dict: the keys of the command line's answer, without a detour through text.

use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyDict, PyFloat, PyList, PyString};
use serde_json::Value;
use standstill_cli::plan::Planned;

/// A value of an answer; -0.0 is written as 0.0.
fn real(py: Python<'_>, value: f64) -> Bound<'_, PyFloat> {
    PyFloat::new(py, value + 0.0)
}

/// A dict of numbers.
fn numbers<'py, const N: usize>(
    py: Python<'py>,
    members: [(&Bound<'py, PyString>, f64); N],
) -> PyResult<Bound<'py, PyDict>> {
    let dict = PyDict::new(py);
    for (key, value) in members {
        dict.set_item(key, real(py, value))?;
    }
    Ok(dict)
}

/// The whole answer.
pub fn dict<'py>(
    py: Python<'py>,
    id: Option<Bound<'py, PyAny>>,
    method: &str,
    planned: &Planned,
) -> PyResult<Bound<'py, PyDict>> {
    let duration = intern!(py, "duration");
    let velocity = intern!(py, "velocity");
    let acceleration = intern!(py, "acceleration");
    let jerk = intern!(py, "jerk");
    let snap = intern!(py, "snap");

    let answer = PyDict::new(py);
    answer.set_item(intern!(py, "id"), id)?;
    answer.set_item(intern!(py, "method"), method)?;
    answer.set_item(duration, real(py, planned.duration))?;
    answer.set_item(intern!(py, "scans"), planned.scans)?;
    let mut segments = Vec::with_capacity(planned.segments.len());
    for segment in &planned.segments {
        segments.push(numbers(
            py,
            [
                (duration, segment.duration),
                (velocity, segment.velocity),
                (acceleration, segment.acceleration),
                (jerk, segment.jerk),
                (snap, segment.snap),
            ],
        )?);
    }
    answer.set_item(intern!(py, "segments"), PyList::new(py, segments)?)?;
    let peak = numbers(
        py,
        [
            (velocity, planned.peak.velocity),
            (acceleration, planned.peak.acceleration),
        ],
    )?;
    peak.set_item(jerk, planned.peak.jerk.map(|value| real(py, value)))?;
    peak.set_item(snap, planned.peak.snap.map(|value| real(py, value)))?;
    answer.set_item(intern!(py, "peak"), peak)?;
    if let Some(excess) = &planned.unavoidable {
        let members = [
            (velocity, excess.velocity),
            (acceleration, excess.acceleration),
            (jerk, excess.jerk),
        ];
        answer.set_item(intern!(py, "unavoidable"), numbers(py, members)?)?;
    }
    if let Some(boxes) = &planned.boxes {
        answer.set_item(intern!(py, "boxes"), boxes.as_slice())?;
    }
    if let Some(counts) = &planned.counts {
        let dict = PyDict::new(py);
        if let Some(count) = counts.nd {
            dict.set_item("nd", count)?;
        }
        if let Some(count) = counts.nj {
            dict.set_item("nj", count)?;
        }
        dict.set_item("na", counts.na)?;
        dict.set_item("nv", counts.nv)?;
        answer.set_item(intern!(py, "counts"), dict)?;
    }
    if let Some(case) = planned.case {
        answer.set_item(intern!(py, "case"), case)?;
    }
    if let Some(value) = planned.end_velocity {
        answer.set_item(intern!(py, "end_velocity"), real(py, value))?;
    }
    if let Some(rung) = planned.rung {
        answer.set_item(intern!(py, "rung"), rung)?;
    }
    let end = [
        (intern!(py, "position"), planned.end.position),
        (velocity, planned.end.velocity),
        (acceleration, planned.end.acceleration),
        (jerk, planned.end.jerk),
    ];
    answer.set_item(intern!(py, "end"), numbers(py, end)?)?;
    Ok(answer)
}

/// A value that the planner gives as JSON: a number or a text; None for a missing or any other value.
pub fn of_json<'py>(py: Python<'py>, json: Option<&str>) -> PyResult<Bound<'py, PyAny>> {
    let value = json.and_then(|json| serde_json::from_str(json).ok());
    Ok(match value {
        Some(Value::Number(number)) => real(py, number.as_f64().unwrap_or(f64::NAN)).into_any(),
        Some(Value::String(text)) => PyString::new(py, &text).into_any(),
        Some(Value::Bool(_) | Value::Array(_) | Value::Object(_) | Value::Null) | None => {
            py.None().into_bound(py)
        }
    })
}
