//! `standstill explain`: the first difference of two traces.

use crate::exit::{Exit, Failure, complain};
use crate::limit;
use crate::outcome;
use standstill_script::suite::shown;
use standstill_trace::story::story;
use standstill_trace::{Trace, file};
use std::io::Write;
use std::path::Path;

/// Prints how `found` differs from `expected`, from the first scan and signals on, and the likely causes.
pub fn explain(expected: &Path, found: &Path, json: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let (one, other) = (load(expected)?, load(found)?);
    let (expected, found) = (shown(expected), shown(found));
    limit::doing(format!("holding {found} against {expected}"));
    let story = story(&one, &other);
    if json {
        let exit = Exit::of(story.is_none());
        writeln!(
            out,
            "{}",
            outcome::explained(exit, (&expected, &found), story.as_ref())
        )?;
        return Ok(exit);
    }
    match story {
        None => {
            writeln!(out, "{expected} and {found} are equal to the bit")?;
            Ok(Exit::Passed)
        }
        Some(story) => {
            write!(out, "expected: {expected}\nfound:    {found}\n{story}")?;
            Ok(Exit::Failed)
        }
    }
}

/// A trace; the parts it lacks are reported on standard error.
pub fn load(path: &Path) -> Result<Trace, Failure> {
    limit::doing(format!("reading {}", shown(path)));
    let loaded = file::load(path)?;
    if !loaded.lacks.is_empty() {
        complain(&format!(
            "note: {} lacks {}",
            shown(path),
            loaded.lacks.join(", ")
        ));
    }
    Ok(loaded.trace)
}
