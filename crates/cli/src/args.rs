//! The arguments of the program.

use clap::{Parser, Subcommand};
use std::path::{Path, PathBuf};

/// A PLCopen motion runtime: run scan scripts, check their claims, plan moves.
#[derive(Debug, Parser)]
#[command(name = "standstill", version, arg_required_else_help = true, after_help = EXIT_STATUSES)]
pub struct Arguments {
    /// What to do.
    #[command(subcommand)]
    pub command: Command,
}

/// Shown below the help.
const EXIT_STATUSES: &str = "Exit status: 0 passed, 1 a claim, golden or plan failed, 2 bad usage, \
3 bad script or trace, 4 I/O, 70 internal fault";

/// The subcommands.
#[derive(Debug, Subcommand)]
pub enum Command {
    /// Plan moves: one JSON object a line in, one a line out
    Plan {
        /// The lines; standard input if absent or `-`
        file: Option<PathBuf>,
    },
    /// List the function blocks and their pins
    Blocks {
        /// As JSON
        #[arg(long)]
        json: bool,
    },
}

/// A path as it is printed: with `/` on every system.
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string();
    if cfg!(windows) {
        text.replace('\\', "/")
    } else {
        text
    }
}
