//! `standstill export`.

use crate::args::ExportTarget;
use crate::exit::{Exit, Failure};
use standstill_export::{Dialect, Prefix, Target};
use standstill_script::suite::shown;
use std::io::Write;
use std::path::Path;

/// Writes the files for `target` into `folder`, and prints their names.
pub fn export(
    target: ExportTarget,
    folder: &Path,
    prefix: &str,
    dialect: Option<&str>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let target = match target {
        ExportTarget::C => Target::C,
        ExportTarget::StMatiec => Target::StMatiec,
        ExportTarget::StStrucpp => Target::StStrucpp,
        ExportTarget::StRusty => Target::StRusty,
        ExportTarget::Wasm => Target::Wasm,
        ExportTarget::PlcopenXml => Target::PlcopenXml,
    };
    let prefix = Prefix::new(prefix).map_err(|error| Failure::usage(&error.to_string()))?;
    let dialect = dialect
        .map_or_else(|| Ok(Dialect::default()), Dialect::new)
        .map_err(|error| Failure::usage(&error.to_string()))?;
    let files = standstill_export::export(target, &prefix, &dialect);
    standstill_export::write(folder, &files).map_err(|error| {
        // The path first, as `standstill` prints paths.
        let text = error
            .to_string()
            .replace(&error.path.display().to_string(), &shown(&error.path));
        Failure::Told(Exit::Io, format!("error: {text}"))
    })?;
    for file in &files {
        writeln!(out, "{}", file.name)?;
    }
    Ok(Exit::Passed)
}
