//! How a command ends: the exit statuses, and the failures that lead to them.

use std::io::{self, Write};
use std::panic::{self, UnwindSafe};
use std::process::ExitCode;

/// The exit statuses of the program. They are interface: scripts and CI jobs rely on them.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
#[repr(u8)]
pub enum Exit {
    /// Everything asked for was done and holds.
    Passed = 0,
    /// A claim, a golden or a plan failed, or two traces differ.
    Failed = 1,
    /// The arguments make no sense.
    Usage = 2,
    /// A script or a trace is wrong.
    BadInput = 3,
    /// A file could not be read or written.
    Io = 4,
    /// The program itself is wrong.
    Internal = 70,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

/// Why a command stopped before its end. The texts are whole messages, several lines if need be.
#[derive(Debug)]
pub enum Failure {
    /// Arguments that parse but make no sense together.
    Usage(String),
    /// A script, trace or configuration that is wrong.
    BadInput(String),
    /// A file that could not be read or written.
    Io(String),
    /// Standard output could not be written.
    Output(io::Error),
}

impl From<io::Error> for Failure {
    /// Only standard output is written with a bare `?`; errors of files are given their path first.
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl Failure {
    /// Reports the failure on standard error; returns the status that goes with it.
    pub fn report(&self) -> Exit {
        match self {
            Self::Usage(text) => {
                complain(&format!("error: {text}\n\nFor more information, try '--help'."));
                Exit::Usage
            }
            Self::BadInput(text) => {
                complain(text);
                Exit::BadInput
            }
            Self::Io(text) => {
                complain(&format!("error: {text}"));
                Exit::Io
            }
            // The reader has seen enough, as in `standstill plan | head -1`.
            Self::Output(error) if error.kind() == io::ErrorKind::BrokenPipe => Exit::Passed,
            Self::Output(error) => {
                complain(&format!("error: standard output: {error}"));
                Exit::Io
            }
        }
    }
}

/// Writes a line to standard error. Unlike `eprintln!` it does not panic when nobody can read it.
pub fn complain(text: &str) {
    let _ = writeln!(io::stderr(), "{text}");
}

/// Runs the program; a panic becomes [`Exit::Internal`].
pub fn guarded(program: impl FnOnce() -> Exit + UnwindSafe) -> Exit {
    panic::catch_unwind(program).unwrap_or_else(|_| {
        complain(
            "error: this is a fault of standstill itself; please report it with the command and its input",
        );
        Exit::Internal
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_panic_ends_with_the_status_of_an_internal_fault() {
        assert_eq!(guarded(|| panic!("an invariant broke")), Exit::Internal);
        assert_eq!(guarded(|| Exit::Failed), Exit::Failed);
        assert_eq!(Exit::Internal as u8, 70);
    }

    #[test]
    fn a_closed_pipe_is_no_failure_and_a_full_disk_is_one() {
        let output = |kind: io::ErrorKind| Failure::from(io::Error::from(kind)).report();
        assert_eq!(output(io::ErrorKind::BrokenPipe), Exit::Passed);
        assert_eq!(output(io::ErrorKind::StorageFull), Exit::Io);
    }
}
