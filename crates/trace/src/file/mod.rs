//! Traces in files. The form follows from the name: `.csv`, `.jsonl`, and for reading `.exact`.

mod streaming;

use std::ffi::OsStr;
use std::fs::{self, File};
use std::io::{self, BufWriter, Write};
use std::path::{Path, PathBuf};

use crate::csv::Dialect;
use crate::exact::{self, ExactError};
use crate::printable::printable;
use crate::read::{Loaded, ReadError};
use crate::trace::Trace;
use crate::{csv, jsonl};
pub use streaming::Streaming;
use tempfile::NamedTempFile;

/// Why a trace file could not be read or written.
#[derive(Debug, thiserror::Error)]
pub enum FileError {
    /// Its name has an unknown ending.
    #[error("{}: a trace is a .csv, .jsonl or (for reading) .exact file", shown(.path))]
    Form {
        /// The file.
        path: PathBuf,
    },
    /// The system reported an error.
    #[error("{}: {source}", shown(.path))]
    Io {
        /// The file.
        path: PathBuf,
        /// The message of the system.
        source: io::Error,
    },
    /// The system reported an error while a long run was written; the part written so far was kept.
    #[error("{}: {source}; the first {rows} rows are in {}", shown(.path), shown(.partial))]
    Partial {
        /// The file.
        path: PathBuf,
        /// The file with the rows.
        partial: PathBuf,
        /// Number of rows in it, all of them whole.
        rows: usize,
        /// The message of the system.
        source: io::Error,
    },
    /// Its text is no trace, or a part of one.
    #[error("{}: {source}", shown(.path))]
    Text {
        /// The file.
        path: PathBuf,
        /// The fault and its place.
        source: ReadError,
    },
    /// It is no exact trace, or a damaged one.
    #[error("{}: {source}", shown(.path))]
    Exact {
        /// The file.
        path: PathBuf,
        /// What is wrong.
        source: ExactError,
    },
}

impl FileError {
    /// An error of the system with its file.
    fn io(path: &Path) -> impl FnOnce(io::Error) -> Self {
        let path = path.to_owned();
        move |source| Self::Io { path, source }
    }

    /// A fault of a text with its file.
    fn text(path: &Path) -> impl FnOnce(ReadError) -> Self {
        let path = path.to_owned();
        move |source| Self::Text { path, source }
    }
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

/// The form of a file that is written.
fn saved_form(path: &Path) -> Result<Form, FileError> {
    match form(path)? {
        Form::Exact => Err(FileError::Form {
            path: path.to_owned(),
        }),
        form => Ok(form),
    }
}

/// Whether [`save`] can write a file of this name. Call it before a long run, not after it.
#[must_use]
pub fn can_save(path: &Path) -> bool {
    saved_form(path).is_ok()
}

/// Whether this is the name of a CSV file.
#[must_use]
pub fn is_csv(path: &Path) -> bool {
    matches!(form(path), Ok(Form::Csv))
}

/// Writes a trace; for CSV its header goes into [`csv::meta_path`]. An existing file is replaced as [`replace`]
/// does.
///
/// # Errors
/// A name that ends in neither `.csv` nor `.jsonl`, or an error of the system.
pub fn save(trace: &Trace, path: &Path) -> Result<(), FileError> {
    save_as(trace, path, Dialect::default())
}

/// The same as [`save`], with CSV in this dialect.
///
/// # Errors
/// Those of [`save`].
pub fn save_as(trace: &Trace, path: &Path, dialect: Dialect) -> Result<(), FileError> {
    Saving::begin(path)?.finish(trace, dialect)
}

/// The files of a trace, created before its run, so that an obstacle to writing them shows at once.
#[derive(Debug)]
pub struct Saving {
    rows: Draft,
    /// The file beside a table.
    header: Option<Draft>,
}

impl Saving {
    /// Begins the files that [`save`] writes.
    ///
    /// # Errors
    /// Those of [`save`].
    pub fn begin(path: &Path) -> Result<Self, FileError> {
        let is_table = saved_form(path)? == Form::Csv;
        let rows = Draft::begin(path)?;
        let header = is_table.then(|| Draft::beside(&csv::meta_path(path)));
        let header = header.transpose()?;
        Ok(Self { rows, header })
    }

    /// Writes the files; a table in this dialect.
    ///
    /// # Errors
    /// An error of the system.
    pub fn finish(self, trace: &Trace, dialect: Dialect) -> Result<(), FileError> {
        let Self { rows, header } = self;
        let Some(header) = header else {
            return rows.finish(|mut out| jsonl::write(trace, &mut out));
        };
        rows.finish(|mut out| csv::write_as(trace, dialect, &mut out))?;
        header.finish(|out| writeln!(out, "{}", trace.header_json()))
    }
}

/// Writes a file that a person named, whole or not at all: `write` fills a new file beside it, which then replaces
/// it. A link is replaced, not followed. A file that is not regular (a pipe, a device) is written directly.
///
/// # Errors
/// An error of the system; an existing file is then unchanged.
pub fn replace(path: &Path, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
    Draft::begin(path)?.finish(write)
}

/// The same as [`replace`], for a file that nobody named, such as the golden beside a script. Only this name in its
/// folder changes, of any previous kind. A folder or a device there is an error.
///
/// # Errors
/// Those of [`replace`].
pub fn replace_beside(
    path: &Path,
    write: impl FnOnce(&mut dyn Write) -> io::Result<()>,
) -> Result<(), FileError> {
    Draft::beside(path)?.finish(write)
}

/// A file that will be replaced. It is created before there is anything to write, so that an obstacle shows at the
/// begin of a long run and not at its end. If it is dropped, the existing file is unchanged.
#[derive(Debug)]
pub struct Draft {
    path: PathBuf,
    target: Target,
}

#[derive(Debug)]
enum Target {
    /// A new file that replaces the existing one.
    New(NamedTempFile),
    /// A pipe or a device, written directly.
    Open(File),
}

impl Draft {
    /// Begins a [`replace`].
    ///
    /// # Errors
    /// An error of the system.
    pub fn begin(path: &Path) -> Result<Self, FileError> {
        if !is_special(path) {
            return Self::beside(path);
        }
        let open = File::options().write(true).open(path);
        Self::of(path, open.map(Target::Open))
    }

    fn beside(path: &Path) -> Result<Self, FileError> {
        Self::of(path, begun(path).map(Target::New))
    }

    fn of(path: &Path, target: io::Result<Target>) -> Result<Self, FileError> {
        Ok(Self {
            target: target.map_err(FileError::io(path))?,
            path: path.to_owned(),
        })
    }

    /// Writes the file and puts it into its place.
    ///
    /// # Errors
    /// Those of [`replace`].
    pub fn finish(mut self, write: impl FnOnce(&mut dyn Write) -> io::Result<()>) -> Result<(), FileError> {
        let mut out = BufWriter::new(&mut self);
        let written = write(&mut out).and_then(|()| out.flush());
        // After an error, the rest of the buffer is dropped.
        drop(out.into_parts());
        written.map_err(FileError::io(&self.path))?;
        self.keep()
    }

    /// Puts the written file into its place.
    ///
    /// # Errors
    /// An error of the system; an existing file is then unchanged.
    pub fn keep(self) -> Result<(), FileError> {
        let Self { path, target } = self;
        match target {
            Target::Open(_) => Ok(()),
            Target::New(draft) => match draft.persist(&path) {
                Ok(_) => Ok(()),
                Err(error) => Err(FileError::io(&path)(error.error)),
            },
        }
    }

    fn file(&self) -> &File {
        match &self.target {
            Target::Open(file) => file,
            Target::New(draft) => draft.as_file(),
        }
    }
}

/// For data that is written in parts; [`Draft::keep`] ends it.
impl Write for Draft {
    fn write(&mut self, bytes: &[u8]) -> io::Result<usize> {
        match self.file().write(bytes) {
            // The reader of a pipe has gone: as on standard output, the rest is dropped.
            Err(error) if error.kind() == io::ErrorKind::BrokenPipe => Ok(bytes.len()),
            other => other,
        }
    }

    fn flush(&mut self) -> io::Result<()> {
        self.file().flush()
    }
}

/// Whether there is a pipe or a device at `path`, also through a link: `/dev/stdout` is one. It is written
/// directly.
#[must_use]
pub fn is_special(path: &Path) -> bool {
    fs::metadata(path).is_ok_and(|found| !found.is_file() && !found.is_dir())
}

/// The folder that `path` is in: `.` for a bare name.
#[must_use]
pub fn folder_of(path: &Path) -> &Path {
    match path.parent() {
        Some(folder) if folder != Path::new("") => folder,
        _ => Path::new("."),
    }
}

/// An empty file beside `path` with the permissions of the existing one, or those of any new file.
fn begun(path: &Path) -> io::Result<NamedTempFile> {
    let there = fs::symlink_metadata(path).ok();
    if there
        .as_ref()
        .is_some_and(|there| !there.is_file() && !there.is_symlink())
    {
        return Err(io::Error::other("this is no file that could be replaced"));
    }
    let mut builder = tempfile::Builder::new();
    builder.prefix(".standstill-").suffix(".partial");
    #[cfg(unix)]
    {
        use std::os::unix::fs::PermissionsExt;
        // The system removes the permissions in its mask.
        builder.permissions(fs::Permissions::from_mode(0o666));
    }
    let draft = builder.tempfile_in(folder_of(path)).map_err(without_path)?;
    #[cfg(unix)]
    if let Some(there) = there.filter(fs::Metadata::is_file) {
        draft.as_file().set_permissions(there.permissions())?;
    }
    Ok(draft)
}

/// The error of the system without the name of the new file, which the user does not know.
fn without_path(error: io::Error) -> io::Error {
    let text = error.to_string();
    let said = text.split(" at path ").next().unwrap_or(&text).to_owned();
    io::Error::new(error.kind(), said)
}

fn text(bytes: Vec<u8>) -> io::Result<String> {
    String::from_utf8(bytes).map_err(|error| {
        let valid = error.utf8_error().valid_up_to();
        let message = format!("not UTF-8 after {valid} bytes; save it as UTF-8");
        io::Error::new(io::ErrorKind::InvalidData, message)
    })
}

/// A path as it is printed: one line, with `/` on every system.
#[must_use]
pub fn shown(path: &Path) -> String {
    let text = path.display().to_string().replace(std::path::MAIN_SEPARATOR, "/");
    printable(&text).into_owned()
}

/// The bytes of a file that nobody named. Only a regular file is read: a pipe would block, and a device may have no
/// end.
///
/// # Errors
/// An error of the system.
pub fn read_regular(path: &Path) -> io::Result<Vec<u8>> {
    if !fs::metadata(path)?.is_file() {
        return Err(io::Error::new(
            io::ErrorKind::InvalidInput,
            "this is no regular file",
        ));
    }
    fs::read(path)
}

/// Reads a trace, for CSV together with [`csv::meta_path`] if that file is there.
///
/// # Errors
/// A name without a known form, an error of the system, or a file that is no trace.
pub fn load(path: &Path) -> Result<Loaded, FileError> {
    let read_text = |path: &Path| fs::read(path).and_then(text).map_err(FileError::io(path));
    match form(path)? {
        Form::JsonLines => jsonl::read(&read_text(path)?).map_err(FileError::text(path)),
        Form::Csv => {
            let meta_path = csv::meta_path(path);
            let meta = match read_regular(&meta_path).and_then(text) {
                Ok(text) => Some(text),
                Err(error) if error.kind() == io::ErrorKind::NotFound => None,
                Err(error) => return Err(FileError::io(&meta_path)(error)),
            };
            csv::read(&read_text(path)?, meta.as_deref()).map_err(FileError::text(path))
        }
        Form::Exact => {
            let file = fs::read(path).map_err(FileError::io(path))?;
            let trace = exact::decode(&file).map_err(|source| FileError::Exact {
                path: path.to_owned(),
                source,
            })?;
            let lacks = vec!["the header but for the cycle and the names of the axes".to_owned()];
            Ok(Loaded { trace, lacks })
        }
    }
}
