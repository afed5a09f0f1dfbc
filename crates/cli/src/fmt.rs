//! `standstill fmt`: scripts in their canonical layout.

use crate::exit::{Exit, Failure, go_on};
use crate::limit;
use standstill_script::suite::{self, SuiteError};
use standstill_trace::file::replace_beside;
use std::fs;
use std::io::{self, Read, Write};
use std::path::{Path, PathBuf};

/// Lays out the scripts at the paths in place and names those that changed. With `check` nothing is written,
/// and a script that would change fails.
pub fn files(paths: &[PathBuf], check: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    for path in paths {
        for script in suite::find_texts(path)? {
            let this = lay_out(&script, check, out);
            exit = exit.max(go_on(this, out)?);
        }
    }
    Ok(exit)
}

/// Lays out a script from standard input to standard output. With `check` only the status reports whether the
/// layout would change.
pub fn filter(check: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    limit::doing("reading standard input");
    let mut text = String::new();
    let read = io::stdin().lock().read_to_string(&mut text);
    read.map_err(|error| Failure::io("standard input", &error))?;
    let canonical = canonical(&text, "standard input")?;
    if check {
        return Ok(Exit::of(text == canonical));
    }
    write!(out, "{canonical}")?;
    Ok(Exit::Passed)
}

fn lay_out(path: &Path, check: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let name = suite::shown(path);
    limit::doing(name.as_str());
    let text = suite::read_text(path)?;
    let canonical = canonical(&text, &name)?;
    if text == canonical {
        return Ok(Exit::Passed);
    }
    if !check {
        let found = fs::symlink_metadata(path).map_err(|error| Failure::io(&name, &error))?;
        if found.is_symlink() {
            let why =
                format!("error: {name}: a link, through which nothing is written; lay out what it leads to");
            return Err(Failure::Told(Exit::Io, why));
        }
        replace_beside(path, |out| out.write_all(canonical.as_bytes()))?;
    }
    writeln!(out, "{name}")?;
    Ok(Exit::of(!check))
}

fn canonical(text: &str, name: &str) -> Result<String, Failure> {
    Ok(standstill_script::format(text, name).map_err(SuiteError::from)?)
}
