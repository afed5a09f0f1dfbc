//! The functions in the form that JavaScript calls.

// The macro writes a border of C.
#![allow(unsafe_code, missing_docs)]

use wasm_bindgen::prelude::*;

#[wasm_bindgen]
extern "C" {
    /// A function of the page.
    pub type Progress;

    #[wasm_bindgen(method, structural, js_name = tell)]
    fn tell(this: &Progress, scans: f64, of: f64);
}

/// See [`crate::check`].
#[wasm_bindgen]
pub fn check(request: &str) -> String {
    crate::check(request)
}

/// The result of a run.
#[wasm_bindgen]
pub struct Ran(crate::Ran);

#[wasm_bindgen]
impl Ran {
    /// JSON, see [`crate::Ran`].
    pub fn about(&self) -> String {
        self.0.about.clone()
    }

    /// The numbers of the columns; they can be taken once.
    pub fn reals(&mut self) -> Vec<f64> {
        std::mem::take(&mut self.0.reals)
    }
}

/// See [`crate::run`]; a browser ends a run by ending its worker.
#[wasm_bindgen]
pub fn run(request: &str, progress: &Progress) -> Ran {
    Ran(crate::run(request, |scans, of| {
        progress.tell(scans as f64, of as f64);
        true
    }))
}

/// See [`crate::plan`].
#[wasm_bindgen]
pub fn plan(lines: &str) -> String {
    crate::plan(lines)
}

/// See [`crate::share`].
#[wasm_bindgen]
pub fn share(request: &str) -> String {
    crate::share(request)
}

/// See [`crate::save`].
#[wasm_bindgen]
pub fn save(request: &str, form: &str) -> String {
    crate::save(request, form)
}

/// See [`crate::hand`].
#[wasm_bindgen]
pub fn hand(request: &str) -> String {
    crate::hand(request)
}
