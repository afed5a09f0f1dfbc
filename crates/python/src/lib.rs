//! The compiled half of the Python package `standstill`: the fast parts and the parts of the runtime. The
//! interface that a user sees, and its texts, are in the package's own files under `standstill/`.
//!
//! No `unsafe` of ours: PyO3's macros write the border, and the rows of a run go to NumPy without a copy.

mod answer;
mod errors;
mod judge;
mod line;
mod rows;
mod runtime;
mod scripts;

use pyo3::prelude::*;
use std::ffi::OsString;

/// Runs the command line with these arguments, without its name, and returns its exit status.
#[pyfunction]
fn main(py: Python<'_>, arguments: Vec<OsString>) -> u8 {
    let name = OsString::from("standstill");
    py.detach(|| standstill_cli::status_of(std::iter::once(name).chain(arguments)) as u8)
}

/// The module `standstill._native`.
#[pymodule(name = "_native")]
fn native(module: &Bound<'_, PyModule>) -> PyResult<()> {
    module.add("__version__", env!("CARGO_PKG_VERSION"))?;
    module.add_function(wrap_pyfunction!(main, module)?)?;
    module.add_function(wrap_pyfunction!(line::plan, module)?)?;
    module.add_function(wrap_pyfunction!(scripts::run, module)?)?;
    module.add_function(wrap_pyfunction!(judge::judge, module)?)?;
    module.add_class::<rows::Rows>()?;
    module.add_class::<runtime::Scans>()
}
