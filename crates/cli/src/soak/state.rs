//! The progress of a run, as a file.

use super::Trial;
use crate::exit::{Exit, Failure};
use serde::{Deserialize, Serialize};
use standstill_script::suite::shown;
use standstill_trace::file::replace;
use std::fs;
use std::io::ErrorKind;
use std::path::Path;

/// Version of the file's form.
const FORM: u32 = 1;

/// The data needed to continue.
#[derive(Debug, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct State<T> {
    standstill_soak: u32,
    /// Version of the program, because another one may plan differently.
    version: String,
    /// The seed of all chains.
    pub seed: u64,
    /// Chains done.
    pub chains: u64,
    /// Their results.
    pub tally: T,
}

impl<T: Trial> State<T> {
    /// Nothing done yet.
    pub fn new(seed: u64) -> Self {
        Self {
            standstill_soak: FORM,
            version: env!("CARGO_PKG_VERSION").to_owned(),
            seed,
            chains: 0,
            tally: T::default(),
        }
    }

    /// Reads the file; if there is none, nothing is done yet.
    pub fn read(path: &Path, seed: u64) -> Result<Self, Failure> {
        let name = shown(path);
        let text = match fs::read_to_string(path) {
            Ok(text) => text,
            Err(error) if error.kind() == ErrorKind::NotFound => return Ok(Self::new(seed)),
            Err(error) => return Err(Failure::io(&name, &error)),
        };
        let state: Self = serde_json::from_str(&text).map_err(|error| {
            let text = format!("error: {name}: no state of a soak: {error}");
            Failure::Told(Exit::BadInput, text)
        })?;
        let fresh = Self::new(seed);
        if (state.standstill_soak, &state.version) != (FORM, &fresh.version) {
            let text = format!("error: {name}: written by another version; begin anew");
            return Err(Failure::Told(Exit::BadInput, text));
        }
        if state.seed != seed {
            return Err(Failure::usage(&format!(
                "--seed {seed}: the run to resume has seed {}",
                state.seed
            )));
        }
        Ok(state)
    }

    /// Writes the file. An interruption leaves the old one or the new one, never a part.
    pub fn write(&self, path: &Path) -> Result<(), Failure> {
        let text = serde_json::to_string(self).map_err(|error| Failure::io(&shown(path), &error.into()))?;
        Ok(replace(path, |out| writeln!(out, "{text}"))?)
    }
}
