//! `standstill explain`: where two traces part.

use crate::exit::{Exit, Failure, complain};
use standstill_script::suite::shown;
use standstill_trace::compare::compare;
use standstill_trace::{Trace, file};
use std::io::Write;
use std::path::Path;

/// Shows the first scan and signals in which `found` differs from `expected`.
pub fn explain(expected: &Path, found: &Path, out: &mut dyn Write) -> Result<Exit, Failure> {
    let difference = compare(&load(expected)?, &load(found)?);
    let (expected, found) = (shown(expected), shown(found));
    match difference {
        None => {
            writeln!(out, "{expected} and {found} are equal to the bit")?;
            Ok(Exit::Passed)
        }
        Some(difference) => {
            write!(out, "expected: {expected}\nfound:    {found}\n{difference}")?;
            Ok(Exit::Failed)
        }
    }
}

fn load(path: &Path) -> Result<Trace, Failure> {
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
