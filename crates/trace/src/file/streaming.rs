//! A trace that is written during its run.

use super::{Draft, FileError, Form, folder_of, is_special, replace_beside, saved_form};
use crate::csv::{self, Dialect};
use crate::jsonl::{self, END_KEY};
use crate::trace::Trace;
use std::fs::{self, File};
use std::io::{self, BufRead, BufReader, BufWriter, ErrorKind, Seek, Write};
use std::path::{Path, PathBuf};

/// The files of a trace that are written row by row during the run, so that the trace may forget its rows. They go
/// to `X.partial`, which replaces `X` at the end. A pipe or a device is written directly. If the run ends early,
/// the partial file has whole rows, except for the last one after a kill.
///
/// JSON Lines end with an object for data that the header, written before the first scan, cannot have:
/// verdicts, cams, notes.
#[derive(Debug)]
pub struct Streaming {
    path: PathBuf,
    /// CSV; otherwise JSON Lines.
    is_table: bool,
    dialect: Dialect,
    out: File,
    /// `X.partial`; none if `X` is a pipe or a device.
    partial: Option<PathBuf>,
    notes: Notes,
    /// Number of rows written whole.
    rows: usize,
}

impl Streaming {
    /// Begins the files of a trace that has no rows yet; a table in this dialect.
    ///
    /// # Errors
    /// A name that ends in neither `.csv` nor `.jsonl`, or the message of the system.
    pub fn begin(trace: &Trace, path: &Path, dialect: Dialect) -> Result<Self, FileError> {
        let is_table = saved_form(path)? == Form::Csv;
        let special = is_special(path);
        // Beside the trace, where there is room for it; a device has none beside it.
        let folder = match special {
            true => std::env::temp_dir(),
            false => folder_of(path).to_owned(),
        };
        let notes = Notes::begin(&folder).map_err(FileError::io(&folder))?;
        let (out, partial) = match special {
            true => (
                File::options()
                    .write(true)
                    .open(path)
                    .map_err(FileError::io(path))?,
                None,
            ),
            false => {
                let partial = beside(path, ".partial");
                (begun(path, &partial)?, Some(partial))
            }
        };
        if is_table {
            // An obstacle to writing shows now.
            drop(Draft::beside(&csv::meta_path(path))?);
        }
        let mut streaming = Self {
            path: path.to_owned(),
            is_table,
            dialect,
            out,
            partial,
            notes,
            rows: 0,
        };
        let mut first = Vec::new();
        let written = match is_table {
            true => csv::write_names(trace, dialect, &mut first),
            false => writeln!(first, "{}", trace.header_json()),
        };
        let written = written.and_then(|()| streaming.write(&first).map_err(|(error, _)| error));
        written.map_err(|error| streaming.failed(error))?;
        Ok(streaming)
    }

    /// The file with the written rows, and their number; none if they went to a pipe or a device.
    #[must_use]
    pub fn kept(&self) -> Option<(&Path, usize)> {
        Some((self.partial.as_deref()?, self.rows))
    }

    /// Writes the rows that the trace has received since the last call.
    ///
    /// # Errors
    /// The error of the system, and the file with the rows written so far.
    pub fn look(&mut self, trace: &Trace) -> Result<(), FileError> {
        self.take(trace).map_err(|error| self.failed(error))
    }

    fn take(&mut self, trace: &Trace) -> io::Result<()> {
        let mut lines = Vec::new();
        match self.is_table {
            true => csv::write_rows(trace, self.rows, self.dialect, &mut lines)?,
            false => jsonl::write_rows(trace, self.rows, &mut lines)?,
        }
        self.write(&lines).map_err(|(error, whole)| {
            self.rows += whole;
            error
        })?;
        self.rows = trace.scans();
        self.notes.take(trace)
    }

    /// Writes whole lines. After an error, the incomplete line is removed, and the whole ones are counted.
    fn write(&mut self, lines: &[u8]) -> Result<(), (io::Error, usize)> {
        let mut rest = lines;
        while !rest.is_empty() {
            let error = match self.out.write(rest) {
                Ok(0) => ErrorKind::WriteZero.into(),
                Ok(count) => {
                    rest = rest.get(count..).unwrap_or_default();
                    continue;
                }
                Err(error) if error.kind() == ErrorKind::Interrupted => continue,
                Err(error) => error,
            };
            let written = lines.get(..lines.len() - rest.len()).unwrap_or_default();
            let end = written.iter().rposition(|byte| *byte == b'\n');
            self.take_back(written.len() - end.map_or(0, |end| end + 1));
            return Err((error, written.iter().filter(|byte| **byte == b'\n').count()));
        }
        Ok(())
    }

    /// Removes the last bytes of the partial file.
    fn take_back(&self, bytes: usize) {
        let length = self.out.metadata().map(|found| found.len());
        if let (Some(_), Ok(length)) = (&self.partial, length) {
            // If they cannot be removed, a torn row remains, as after a kill.
            let _ = self.out.set_len(length.saturating_sub(bytes as u64));
        }
    }

    /// Writes the data behind the rows, for a trace whose claims are judged, and puts the files into their places.
    ///
    /// # Errors
    /// Those of [`Streaming::look`].
    pub fn finish(mut self, trace: &Trace) -> Result<(), FileError> {
        let mut end = || {
            self.take(trace)?;
            if !self.is_table {
                self.end(trace)?;
            }
            self.put()
        };
        end().map_err(|error| self.failed(error))?;
        if !self.is_table {
            return Ok(());
        }
        replace_beside(&csv::meta_path(&self.path), |mut out| {
            let header = trace.header().to_json();
            write!(out, "{}", header.strip_suffix('}').unwrap_or(&header))?;
            self.notes.write(&mut out)?;
            out.write_all(b"}\n")
        })
    }

    /// The last object of JSON Lines.
    fn end(&mut self, trace: &Trace) -> io::Result<()> {
        let claims = serde_json::to_string(&trace.header().claims)?;
        let cams = serde_json::to_string(&trace.header().cams)?;
        let begun = self.out.metadata()?.len();
        let mut write = || {
            let mut out = BufWriter::new(&self.out);
            write!(out, "{{\"{END_KEY}\":1,\"claims\":{claims},\"cams\":{cams}")?;
            self.notes.write(&mut out)?;
            out.write_all(b"}\n")?;
            out.flush()
        };
        write().inspect_err(|_| {
            if let (Some(_), Ok(found)) = (&self.partial, self.out.metadata()) {
                let written = found.len().saturating_sub(begun);
                self.take_back(usize::try_from(written).unwrap_or(usize::MAX));
            }
        })
    }

    /// Puts the partial file into its place, unless another run has removed it.
    fn put(&self) -> io::Result<()> {
        let Some(partial) = &self.partial else {
            return Ok(());
        };
        #[cfg(unix)]
        {
            use std::os::unix::fs::MetadataExt;
            let identity = |found: fs::Metadata| (found.dev(), found.ino());
            let there = fs::symlink_metadata(partial).map(identity);
            if there.ok() != self.out.metadata().map(identity).ok() {
                return Err(io::Error::other("another run has begun to write it"));
            }
        }
        fs::rename(partial, &self.path)
    }

    fn failed(&self, source: io::Error) -> FileError {
        let path = self.path.clone();
        match self.partial.clone() {
            Some(partial) => FileError::Partial {
                path,
                partial,
                rows: self.rows,
                source,
            },
            None => FileError::Io { path, source },
        }
    }
}

fn beside(path: &Path, ending: &str) -> PathBuf {
    let mut name = path.as_os_str().to_owned();
    name.push(ending);
    PathBuf::from(name)
}

/// An empty file that will take the place of `path`, with the permissions of the existing one. A
/// remainder of an earlier run is replaced, and a link is not followed.
fn begun(path: &Path, partial: &Path) -> Result<File, FileError> {
    // An obstacle to replacing the file shows now.
    drop(Draft::beside(path)?);
    match fs::symlink_metadata(partial) {
        Ok(there) if !there.is_file() => {
            let error = io::Error::other("this is no file that could be replaced");
            return Err(FileError::io(partial)(error));
        }
        Ok(_) => fs::remove_file(partial).map_err(FileError::io(partial))?,
        Err(_) => {}
    }
    let file = File::create_new(partial).map_err(FileError::io(partial))?;
    if let Ok(there) = fs::symlink_metadata(path)
        && there.is_file()
    {
        file.set_permissions(there.permissions())
            .map_err(FileError::io(partial))?;
    }
    Ok(file)
}

/// The notes of a run, on disk, because they may exceed the memory. One JSON object a line.
#[derive(Debug)]
struct Notes {
    lines: BufWriter<File>,
    count: usize,
}

impl Notes {
    fn begin(folder: &Path) -> io::Result<Self> {
        Ok(Self {
            lines: BufWriter::new(tempfile::tempfile_in(folder)?),
            count: 0,
        })
    }

    /// Takes the notes that the trace has received since the last call.
    fn take(&mut self, trace: &Trace) -> io::Result<()> {
        let new = self.count.saturating_sub(trace.notes_forgotten());
        for note in trace.notes().get(new..).unwrap_or_default() {
            serde_json::to_writer(&mut self.lines, note)?;
            self.lines.write_all(b"\n")?;
            self.count += 1;
        }
        Ok(())
    }

    /// Writes them as a further member of an object; nothing if there are none.
    fn write(&mut self, out: &mut dyn Write) -> io::Result<()> {
        if self.count == 0 {
            return Ok(());
        }
        self.lines.flush()?;
        let mut file = self.lines.get_ref();
        file.rewind()?;
        let mut before = ",\"notes\":[";
        for line in BufReader::new(file).lines() {
            write!(out, "{before}{}", line?)?;
            before = ",";
        }
        out.write_all(b"]")
    }
}
