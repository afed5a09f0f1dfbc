//! Runs a program in Structured Text without a script, for a first test.

use crate::model::Script;
use crate::read::time::literal;
use crate::read::{Parsed, Terms, read_within};
use crate::run::{Outcome, run_with};
use crate::suite::{Allowed, SuiteError, included, program_file, shown};
use serde_json::json;
use std::path::{Path, PathBuf};

/// The program, and the length of its run.
#[derive(Clone, Copy, Debug)]
pub struct Bare<'a> {
    /// The files of the project; the last one names the program.
    pub sources: &'a [PathBuf],
    /// The machine file with its axes; none without one.
    pub axes: Option<&'a Path>,
    /// The PROGRAM, if there are several.
    pub program: Option<&'a str>,
    /// Length of a scan (ns), above 0.
    pub cycle_ns: i64,
    /// Number of scans.
    pub scans: u64,
}

/// Runs a program in Structured Text by itself: no steps, no claims.
///
/// # Errors
/// [`SuiteError`], except [`SuiteError::Golden`].
pub fn run_bare(
    bare: Bare<'_>,
    parameters: &[(String, f64)],
    allowed: &Allowed,
    progress: impl FnMut(u64),
) -> Result<(Script, Outcome), SuiteError> {
    let names: Vec<String> = bare.sources.iter().map(|path| shown(path)).collect();
    let path = bare.sources.last().cloned().unwrap_or_default();
    let mut program = json!({ "st": names });
    if let (Some(name), Some(members)) = (bare.program, program.as_object_mut()) {
        members.insert("program".to_owned(), json!(name));
    }
    let mut script = json!({
        "standstill": 1,
        "title": shown(&path),
        "cycle": literal(bare.cycle_ns),
        "scans": bare.scans,
        "axes": {},
        "blocks": [],
        "expect": [],
    });
    let machine = bare
        .axes
        .and_then(|path| path.file_name())
        .map(|name| name.to_string_lossy().into_owned());
    if let (Some(machine), Some(members)) = (&machine, script.as_object_mut()) {
        members.insert("include".to_owned(), json!(machine));
    }
    let name = "(the script for it)";
    let mut load = |inner: &str| match bare.axes {
        // The user has named the file. Files that it includes are checked as always.
        Some(path) if Some(inner) == machine.as_deref() => {
            crate::suite::read_text(path).map_err(|error| error.to_string())
        }
        Some(path) => included(path, inner, allowed),
        None => Err("there is no machine file".to_owned()),
    };
    let mut source = |inner: &str| {
        let place = names.iter().position(|name| name == inner);
        let path = place.and_then(|place| bare.sources.get(place));
        path.map_or_else(|| Err("it was not given".to_owned()), |path| program_file(path))
    };
    let stem = path.file_stem().and_then(|stem| stem.to_str());
    let parsed = Parsed::new(&format!("{script:#}\n"), name, &mut load)?;
    let key = parsed.free_name(stem.unwrap_or_default(), "cell");
    if let Some(members) = script.as_object_mut() {
        members.insert("programs".to_owned(), json!({ key: program }));
    }
    let text = format!("{script:#}\n");
    let terms = Terms {
        guest_memory: allowed.guest_memory,
        adds_main: true,
        ..Terms::default()
    };
    let script = read_within(&text, name, parameters, &mut load, &mut source, terms)?;
    let outcome = run_with(&script, progress).map_err(|source| SuiteError::Run { path, source })?;
    Ok((script, outcome))
}
