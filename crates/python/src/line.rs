//! `plan`: the keys of one line, from Python.

use crate::{answer, errors};
use pyo3::intern;
use pyo3::prelude::*;
use pyo3::types::{PyBool, PyDict, PyFloat, PyInt, PyString};
use standstill_cli::plan::{Given, Member, Refusal, planned};

/// Python's values in a form that the planner's side can borrow.
enum Held<'py> {
    Number(f64),
    Json(String),
    Object(Vec<(Bound<'py, PyString>, Self)>),
}

impl<'py> Held<'py> {
    fn of(value: &Bound<'py, PyAny>) -> PyResult<Self> {
        if let Ok(number) = value.cast_exact::<PyFloat>() {
            return Ok(Self::Number(number.value()));
        }
        if let Ok(object) = value.cast::<PyDict>() {
            return Self::of_object(object);
        }
        // Most texts; one that is not Unicode takes the rare path.
        if let Ok(text) = value.cast_exact::<PyString>()
            && let Ok(text) = text.to_str()
            && let Ok(json) = serde_json::to_string(text)
        {
            return Ok(Self::Json(json));
        }
        // Numbers of NumPy that are not floats can be converted to one, too.
        let is_number = value.is_instance_of::<PyFloat>()
            || (value.is_instance_of::<PyInt>() && !value.is_instance_of::<PyBool>());
        if is_number && let Ok(number) = value.extract() {
            return Ok(Self::Number(number));
        }
        let plain = value.py().import(intern!(value.py(), "standstill._plain"))?;
        Ok(Self::Json(plain.call_method1("json_of", (value,))?.extract()?))
    }

    fn of_object(object: &Bound<'py, PyDict>) -> PyResult<Self> {
        let members = object.iter().map(|(key, value)| {
            // A key that is not text is no field.
            let key = match key.cast_into::<PyString>() {
                Ok(key) => key,
                Err(error) => error.into_inner().str()?,
            };
            Ok((key, Self::of(&value)?))
        });
        Ok(Self::Object(members.collect::<PyResult<_>>()?))
    }
}

/// The members of an object without objects in it.
fn flat<'a>(members: &'a [(Bound<'_, PyString>, Held<'_>)]) -> PyResult<Vec<Member<'a>>> {
    let members = members.iter().map(|(key, value)| {
        let given = match value {
            Held::Number(value) => Given::Number(*value),
            Held::Json(text) => Given::Json(text),
            // No number either way.
            Held::Object(_) => Given::Json("{}"),
        };
        Ok((key.to_str()?.into(), given))
    });
    members.collect()
}

/// plan(**line)
/// --
///
/// Plans one move: takes the keys of a line of `standstill plan`, and returns its answer.
#[pyfunction]
#[pyo3(signature = (**line))]
pub fn plan<'py>(py: Python<'py>, line: Option<&Bound<'py, PyDict>>) -> PyResult<Bound<'py, PyDict>> {
    let empty;
    let line = match line {
        Some(line) => line,
        None => {
            empty = PyDict::new(py);
            &empty
        }
    };
    let id = line.get_item(intern!(py, "id"))?;
    let Held::Object(held) = Held::of_object(line)? else {
        return Ok(PyDict::new(py));
    };
    let objects = held.iter().map(|(_, value)| match value {
        Held::Object(members) => flat(members),
        Held::Number(_) | Held::Json(_) => Ok(Vec::new()),
    });
    let objects: Vec<Vec<Member<'_>>> = objects.collect::<PyResult<_>>()?;
    let mut members = Vec::with_capacity(held.len());
    for ((key, value), object) in held.iter().zip(&objects) {
        let given = match value {
            Held::Number(value) => Given::Number(*value),
            Held::Json(text) => Given::Json(text),
            Held::Object(_) => Given::Object(object),
        };
        members.push((key.to_str()?.into(), given));
    }
    match planned(members) {
        Ok((method, planned)) => answer::dict(py, id, method, &planned),
        Err(refusal) => Err(refused(py, line, &refusal)),
    }
}

/// A refusal as an exception; the refused value is the given object, if there is one.
fn refused(py: Python<'_>, line: &Bound<'_, PyDict>, refusal: &Refusal) -> PyErr {
    let told = || {
        let value = match refusal.field().and_then(|field| given(line, field)) {
            Some(value) => value,
            None => answer::of_json(py, refusal.value_json())?,
        };
        let nearest = answer::of_json(py, refusal.nearest_json())?;
        let (code, field) = (refusal.code(), refusal.field());
        Ok(errors::plan(py, (code, field, value, nearest, refusal.message())))
    };
    told().unwrap_or_else(|error: PyErr| error)
}

/// The value of a field; `limits.jerk` is a field of `limits`.
fn given<'py>(line: &Bound<'py, PyDict>, field: &str) -> Option<Bound<'py, PyAny>> {
    match field.split_once('.') {
        None => line.get_item(field).ok().flatten(),
        Some((object, name)) => {
            let object = line.get_item(object).ok().flatten()?;
            object.cast::<PyDict>().ok()?.get_item(name).ok().flatten()
        }
    }
}
