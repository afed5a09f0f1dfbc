//! Traces in files, whose form follows from the name: `.csv`, `.jsonl`, and for reading `.exact`.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::csv::Dialect;
use crate::exact::{self, ExactError};
use crate::read::{Loaded, ReadError};
use crate::trace::Trace;
use crate::{csv, jsonl};

/// Why a trace file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Its name ends in something else.
    #[error("{}: a trace is a .csv, .jsonl or (for reading) .exact file", .path.display())]
    Form {
        /// The file.
        path: PathBuf,
    },
    /// The system refused.
    #[error("{}: {source}", .path.display())]
    Io {
        /// The file.
        path: PathBuf,
        /// What the system said.
        source: io::Error,
    },
    /// Its text is no trace, or not all of one.
    #[error("{}: {source}", .path.display())]
    Text {
        /// The file.
        path: PathBuf,
        /// What is wrong, and where.
        source: ReadError,
    },
    /// It is no exact trace, or a damaged one.
    #[error("{}: {source}", .path.display())]
    Exact {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ExactError,
    },
}

/// The forms of trace files.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Form {
    Csv,
    JsonLines,
    Exact,
}

fn form(path: &Path) -> Result<Form, FileError> {
    match path.extension().and_then(OsStr::to_str) {
        Some("csv") => Ok(Form::Csv),
        Some("jsonl") => Ok(Form::JsonLines),
        Some("exact") => Ok(Form::Exact),
        _ => Err(FileError::Form {
            path: path.to_owned(),
        }),
    }
}

/// Whether [`save`] knows how to write a file of this name: to be asked before a long run, not after it.
#[must_use]
pub fn can_save(path: &Path) -> bool {
    matches!(form(path), Ok(Form::Csv | Form::JsonLines))
}

/// Whether the name is that of a CSV file.
#[must_use]
pub fn is_csv(path: &Path) -> bool {
    matches!(form(path), Ok(Form::Csv))
}

/// Writes a trace; for CSV its header goes into [`csv::meta_path`]. A file that was there is replaced as
/// [`replace`] does it.
///
/// # Errors
/// A name that ends in neither `.csv` nor `.jsonl`, or what the system says.
pub fn save(trace: &Trace, path: &Path) -> Result<(), FileError> {
    save_as(trace, path, Dialect::default())
}

/// As [`save`], CSV in this dialect.
///
/// # Errors
/// As [`save`].
pub fn save_as(trace: &Trace, path: &Path, dialect: Dialect) -> Result<(), FileError> {
    match form(path)? {
        Form::JsonLines => replace(path, |mut out| jsonl::write(trace, &mut out)),
        Form::Csv => {
            replace(path, |mut out| csv::write_as(trace, dialect, &mut out))?;
            replace(&csv::meta_path(path), |out| {
                writeln!(out, "{}", trace.header_json())
            })
        }
        Form::Exact => Err(FileError::Form {
            path: path.to_owned(),
        }),
    }
}

/// Writes a file whole or not at all: `write` fills a file beside it, `NAME.partial`, which then takes its place. What
/// is no regular file (a pipe, a device) is written to as it is.
///
/// # Errors
/// What the system says; a file that was there is then as it was.
pub fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    let whole = || {
        if fs::metadata(path).is_ok_and(|found| !found.is_file()) {
            return fill(path, write);
        }
        // A link stays one: what it leads to is replaced.
        let target = fs::canonicalize(path).unwrap_or_else(|_| path.to_owned());
        let mut name = target.as_os_str().to_owned();
        name.push(".partial");
        let partial = PathBuf::from(name);
        let done = fill(&partial, write).and_then(|()| fs::rename(&partial, &target));
        if done.is_err() {
            // The first error is the one to tell.
            let _ = fs::remove_file(&partial);
        }
        done
    };
    whole().map_err(|source| FileError::Io {
        path: path.to_owned(),
        source,
    })
}

fn fill(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> io::Result<()> {
    let mut out = BufWriter::new(File::create(path)?);
    write(&mut out)?;
    out.flush()
}

/// Reads a trace, for CSV together with [`csv::meta_path`] if that file is there.
///
/// # Errors
/// A name that ends in none of the forms, what the system says, or a file that is no trace.
pub fn load(path: &Path) -> Result<Loaded, FileError> {
    let io_error = |path: &Path, source| FileError::Io {
        path: path.to_owned(),
        source,
    };
    let text_error = |path: &Path, source| FileError::Text {
        path: path.to_owned(),
        source,
    };
    let read_text = |path: &Path| fs::read_to_string(path).map_err(|source| io_error(path, source));
    match form(path)? {
        Form::JsonLines => jsonl::read(&read_text(path)?).map_err(|source| text_error(path, source)),
        Form::Csv => {
            let meta_path = csv::meta_path(path);
            let meta = match fs::read_to_string(&meta_path) {
                Ok(text) => Some(text),
                Err(error) if error.kind() == io::ErrorKind::NotFound => None,
                Err(error) => return Err(io_error(&meta_path, error)),
            };
            csv::read(&read_text(path)?, meta.as_deref()).map_err(|source| text_error(path, source))
        }
        Form::Exact => {
            let file = fs::read(path).map_err(|source| io_error(path, source))?;
            let trace = exact::decode(&file).map_err(|source| FileError::Exact {
                path: path.to_owned(),
                source,
            })?;
            let lacks = vec!["the header but for the cycle and the names of the axes".to_owned()];
            Ok(Loaded { trace, lacks })
        }
    }
}
