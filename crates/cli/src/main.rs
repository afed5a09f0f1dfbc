//! The program `standstill`: arguments, exit statuses, printing. What it prints comes from the libraries.
//!
//! Standard output is the same on every machine; messages and progress go to standard error.
#![forbid(unsafe_code)]

mod args;
mod blocks;
mod exit;
mod json;
mod plan;
mod suggest;

use args::{Arguments, Command};
use clap::Parser;
use exit::{Exit, Failure};
use std::fs::File;
use std::io::{self, BufRead, BufReader, BufWriter, IsTerminal, Write};
use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    exit::guarded(program).into()
}

fn program() -> Exit {
    let arguments = match Arguments::try_parse() {
        Ok(arguments) => arguments,
        Err(error) => return arguments_exit(&error),
    };
    let mut out = BufWriter::new(io::stdout().lock());
    let result = dispatch(&arguments.command, &mut out);
    // What was printed stands before the message that follows from it.
    let flushed = out.flush().map_err(Failure::from);
    match result.and_then(|exit| flushed.map(|()| exit)) {
        Ok(exit) => exit,
        Err(failure) => failure.report(),
    }
}

/// Prints what clap has to say: help and version on standard output, mistakes on standard error.
fn arguments_exit(error: &clap::Error) -> Exit {
    match error.print() {
        Ok(()) if error.use_stderr() => Exit::Usage,
        Ok(()) => Exit::Passed,
        Err(error) => Failure::from(error).report(),
    }
}

fn dispatch(command: &Command, out: &mut dyn Write) -> Result<Exit, Failure> {
    match command {
        Command::Plan { file } => match file.as_deref() {
            Some(path) if path != Path::new("-") => {
                let name = args::shown(path);
                let open = File::open(path).map_err(|error| Failure::Io(format!("{name}: {error}")))?;
                plan::plan(&mut BufReader::new(open), &name, out)
            }
            _ => plan::plan(&mut standard_input(), "standard input", out),
        },
        Command::Blocks { json: true } => blocks::json(out),
        Command::Blocks { json: false } => blocks::table(out),
    }
}

/// Standard input; tells a person at a terminal that it is waited for.
fn standard_input() -> impl BufRead {
    if io::stdin().is_terminal() {
        exit::complain("reading from the terminal, one JSON object a line");
    }
    io::stdin().lock()
}
