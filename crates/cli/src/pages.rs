//! `standstill completions` and `standstill man`: files for shells and `man`, from the definition of the
//! arguments.

use crate::args::Arguments;
use crate::exit::{Exit, Failure};
use clap::CommandFactory as _;
use clap_complete::Shell;
use standstill_script::suite::shown;
use std::fs;
use std::io::Write;
use std::path::Path;

/// Prints the completions for a shell.
pub fn completions(shell: Shell, out: &mut dyn Write) -> Result<Exit, Failure> {
    // It panics if it cannot write, but memory can always be written.
    let mut script = Vec::new();
    clap_complete::generate(shell, &mut Arguments::command(), "standstill", &mut script);
    out.write_all(&script)?;
    Ok(Exit::Passed)
}

/// Writes a page for the program and one for each of its commands into a folder.
pub fn man(folder: &Path, out: &mut dyn Write) -> Result<Exit, Failure> {
    let io = |error| Failure::Told(Exit::Io, format!("error: {}: {error}", shown(folder)));
    fs::create_dir_all(folder).map_err(io)?;
    clap_mangen::generate_to(Arguments::command(), folder).map_err(io)?;
    writeln!(out, "manual pages are in {}", shown(folder))?;
    Ok(Exit::Passed)
}
