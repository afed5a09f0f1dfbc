//! The program `standstill`.
#![forbid(unsafe_code)]

use std::process::ExitCode;

fn main() -> ExitCode {
    standstill_cli::main()
}
