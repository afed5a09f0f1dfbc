//! Traces in files, whose form follows from the name: `.csv`, `.jsonl`, and for reading `.exact`.

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

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

/// Writes a trace; for CSV its header goes into [`csv::meta_path`].
///
/// # Errors
/// A name that ends in neither `.csv` nor `.jsonl`, or what the system says.
pub fn save(trace: &Trace, path: &Path) -> Result<(), FileError> {
    let io_error = |path: &Path| {
        let path = path.to_owned();
        move |source| FileError::Io { path, source }
    };
    let form = form(path)?;
    if form == Form::Exact {
        return Err(FileError::Form {
            path: path.to_owned(),
        });
    }
    let mut out = BufWriter::new(File::create(path).map_err(io_error(path))?);
    if form == Form::JsonLines {
        jsonl::write(trace, &mut out).map_err(io_error(path))?;
    } else {
        csv::write(trace, &mut out).map_err(io_error(path))?;
        let meta = csv::meta_path(path);
        fs::write(&meta, format!("{}\n", trace.header().to_json())).map_err(io_error(&meta))?;
    }
    out.flush().map_err(io_error(path))
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
