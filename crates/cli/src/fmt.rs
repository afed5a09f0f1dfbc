//! `standstill fmt`: scripts in their canonical layout.

use crate::exit::{Exit, Failure};
use standstill_script::suite::{self, SuiteError};
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Lays out the scripts at the paths in place and names those that changed. With `check` nothing is written,
/// and a script that would change fails.
pub fn files(paths: &[PathBuf], check: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut changed = 0;
    for path in paths {
        for script in suite::find(path)? {
            if lay_out(&script, check)? {
                writeln!(out, "{}", suite::shown(&script))?;
                changed += 1;
            }
        }
    }
    Ok(Exit::of(!check || changed == 0))
}

/// Lays out a script from standard input to standard output.
pub fn filter(out: &mut dyn Write) -> Result<Exit, Failure> {
    const NAME: &str = "standard input";
    let mut text = String::new();
    io::stdin()
        .lock()
        .read_to_string(&mut text)
        .map_err(|error| Failure::io(NAME, &error))?;
    let text = standstill_script::format(&text, NAME).map_err(SuiteError::from)?;
    write!(out, "{text}")?;
    Ok(Exit::Passed)
}

/// Whether the layout of a script differs from the canonical one.
fn lay_out(path: &Path, check: bool) -> Result<bool, Failure> {
    let name = suite::shown(path);
    let text = fs::read_to_string(path).map_err(|error| Failure::io(&name, &error))?;
    let canonical = standstill_script::format(&text, &name).map_err(SuiteError::from)?;
    let differs = text != canonical;
    if differs && !check {
        fs::write(path, canonical).map_err(|error| Failure::io(&name, &error))?;
    }
    Ok(differs)
}
