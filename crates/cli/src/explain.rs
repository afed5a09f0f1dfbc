//! `standstill explain`: the first difference of two traces.

use crate::exit::{Exit, Failure};
use crate::limit;
use crate::outcome;
use crate::report::load;
use standstill_trace::story::story;
use std::io::Write;
use std::path::Path;

/// Prints how `found` differs from `expected`, from the first scan and signals on, and the likely causes.
pub fn explain(expected: &Path, found: &Path, json: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let ((expected, one), (found, other)) = (load(expected)?, load(found)?);
    limit::doing(format!("holding {found} against {expected}"));
    let story = story(&one.trace, &other.trace);
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
