//! The exit statuses of a command, and the failures that lead to them.

use crate::paint;
use crate::suggest::beside;
use standstill_script::suite::{SuiteError, shown};
use standstill_script::{Code, RunError};
use standstill_trace::file::FileError;
use standstill_trace::golden::GoldenError;
use standstill_trace::printable_lines;
use std::io::{self, ErrorKind, Write};
use std::panic::{self, UnwindSafe};
use std::path::Path;
use std::process::ExitCode;

/// The exit statuses of the program. They are part of its interface: scripts and CI jobs rely on them.
///
/// If several scripts are judged in one run the highest status counts.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
#[repr(u8)]
pub enum Exit {
    /// Everything was done, and all checks passed.
    Passed = 0,
    /// A claim, a golden or a plan failed, or two traces differ.
    Failed = 1,
    /// The arguments are invalid.
    Usage = 2,
    /// A script or a trace is invalid.
    BadInput = 3,
    /// A file could not be read or written.
    Io = 4,
    /// The program itself has a defect.
    Internal = 70,
}

impl From<Exit> for ExitCode {
    fn from(exit: Exit) -> Self {
        Self::from(exit as u8)
    }
}

impl Exit {
    /// [`Exit::Passed`] if so, else [`Exit::Failed`].
    pub const fn of(passed: bool) -> Self {
        if passed { Self::Passed } else { Self::Failed }
    }
}

/// The reason why a command could not do its work.
#[derive(Debug)]
pub enum Failure {
    /// It ends with this status, after this message.
    Told(Exit, String),
    /// Standard output could not be written.
    Output(io::Error),
}

impl Failure {
    /// Arguments that parse but make no sense together.
    pub fn usage(text: &str) -> Self {
        Self::Told(
            Exit::Usage,
            format!("error: {text}\n\nFor more information, try '--help'."),
        )
    }

    /// A command that this build does not have.
    #[cfg(not(all(
        feature = "live",
        feature = "serve",
        feature = "lsp",
        feature = "mcp",
        feature = "pages",
        feature = "soak",
        feature = "st",
        feature = "sweep",
        feature = "watch"
    )))]
    pub fn left_out(feature: &str) -> Self {
        let remedy = remedy(feature);
        Self::usage(&format!("this build of standstill has no `{feature}`: {remedy}"))
    }

    /// A file that could not be read or written. Text that is no UTF-8 is an invalid file, not a disk error.
    pub fn io(name: &str, error: &io::Error) -> Self {
        Self::Told(
            io_exit(error),
            format!("error: {name}: {error}{}", meant(Path::new(name), error)),
        )
    }

    /// Prints the failure on standard error; returns its status.
    pub fn report(&self) -> Exit {
        match self {
            Self::Told(exit, text) => {
                complain(text);
                *exit
            }
            // The reader has stopped, as in `standstill plan | head -1`.
            Self::Output(error) if error.kind() == ErrorKind::BrokenPipe => Exit::Passed,
            Self::Output(error) => {
                complain(&format!("error: standard output: {error}"));
                Exit::Io
            }
        }
    }
}

/// How to get a program with a feature that this one does not have.
fn remedy(feature: &str) -> String {
    format!(
        "build it with the feature `{feature}`, as `cargo build --release -p standstill-cli` without \
         `--no-default-features` does"
    )
}

/// The end of a message about a missing file or folder: the name that was probably meant.
fn meant(path: &Path, error: &io::Error) -> String {
    let found = (error.kind() == ErrorKind::NotFound)
        .then(|| beside(path))
        .flatten();
    found.map_or_else(String::new, |found| {
        format!("; did you mean `{}`?", shown(&found))
    })
}

fn io_exit(error: &io::Error) -> Exit {
    match error.kind() {
        ErrorKind::InvalidData => Exit::BadInput,
        _ => Exit::Io,
    }
}

impl From<io::Error> for Failure {
    /// Only standard output is written with a bare `?`; errors of files first get the file's name.
    fn from(error: io::Error) -> Self {
        Self::Output(error)
    }
}

impl From<SuiteError> for Failure {
    fn from(error: SuiteError) -> Self {
        let exit = match &error {
            SuiteError::Io { path, source } => return Self::io(&shown(path), source),
            SuiteError::Golden(GoldenError::Io { source, .. }) => io_exit(source),
            SuiteError::Run {
                source: RunError::Internal(_),
                ..
            } => Exit::Internal,
            SuiteError::Encoding { .. }
            | SuiteError::Run { .. }
            | SuiteError::Golden(GoldenError::Form { .. }) => Exit::BadInput,
            // Its text is already rendered.
            SuiteError::Script(script) => {
                let mut text = script.to_string();
                if script.diagnostics().iter().any(|it| it.code == Code::NotBuilt) {
                    text += &format!("\n\nhelp: {}", remedy("guest"));
                }
                return Self::Told(Exit::BadInput, text);
            }
        };
        Self::Told(exit, format!("error: {error}"))
    }
}

impl From<FileError> for Failure {
    fn from(error: FileError) -> Self {
        let exit = match &error {
            FileError::Form { .. } => Exit::Usage,
            FileError::Partial { .. } => Exit::Io,
            FileError::Io { path, source } => return Self::io(&shown(path), source),
            FileError::Text { .. } | FileError::Exact { .. } => Exit::BadInput,
        };
        Self::Told(exit, format!("error: {error}"))
    }
}

/// Lets a command over several files continue after a failure, which is reported and becomes a status.
pub fn go_on(result: Result<Exit, Failure>, out: &mut dyn Write) -> Result<Exit, Failure> {
    match result {
        Err(failure @ Failure::Told(..)) => {
            // Text printed before must come before the message.
            out.flush()?;
            Ok(failure.report())
        }
        other => other,
    }
}

/// Writes lines to standard error with all characters visible. Unlike `eprintln!` it does not panic if
/// the reader has gone.
pub fn complain(text: &str) {
    let mut text = printable_lines(text).into_owned();
    if paint::wanted(&io::stderr()) {
        text = paint::lines(&text);
    }
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
    }

    #[test]
    fn a_closed_pipe_is_no_failure_and_a_full_disk_is_one() {
        let output = |kind: ErrorKind| Failure::from(io::Error::from(kind)).report();
        assert_eq!(output(ErrorKind::BrokenPipe), Exit::Passed);
        assert_eq!(output(ErrorKind::StorageFull), Exit::Io);
    }

    #[test]
    fn a_defect_of_the_run_is_not_blamed_on_the_script() {
        let run = |source| {
            Failure::from(SuiteError::Run {
                path: "a.scan.json".into(),
                source,
            })
            .report()
        };
        assert_eq!(
            run(RunError::Internal("an invariant broke".to_owned())),
            Exit::Internal
        );
        assert_eq!(run(RunError::Tasks("no task".to_owned())), Exit::BadInput);
    }

    #[test]
    fn the_statuses_are_the_published_ones() {
        let all = [
            Exit::Passed,
            Exit::Failed,
            Exit::Usage,
            Exit::BadInput,
            Exit::Io,
            Exit::Internal,
        ];
        assert_eq!(all.map(|exit| exit as u8), [0, 1, 2, 3, 4, 70]);
    }
}
