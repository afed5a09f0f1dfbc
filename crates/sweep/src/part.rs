//! The remainder of an interrupted run: its rows, in the order in which they were computed.

use crate::job::{Job, Row, SweepError};
use crate::shard::Shard;
use crate::table::{Rows, row, wrong};
use standstill_script::suite::SuiteError;
use std::fs::{self, File, OpenOptions};
use std::io::{self, ErrorKind, Write};
use std::path::{Path, PathBuf};

/// A table that is being filled. Its file, `NAME.part`, begins with a line that names its table. Every
/// row is written whole, so that an interruption costs the last one at most.
#[derive(Debug)]
pub struct Part {
    path: PathBuf,
    file: File,
    /// The rows that an interrupted run left.
    pub rows: Rows,
}

impl Part {
    /// Opens the part of the table at `table`, or begins one.
    ///
    /// # Errors
    /// [`SweepError::Suite`] for errors of the system; [`SweepError::Table`] for a part of another sweep,
    /// script, shard or version.
    pub fn open(job: &Job, shard: Shard, table: &Path) -> Result<Self, SweepError> {
        let mut path = table.as_os_str().to_owned();
        path.push(".part");
        let path = PathBuf::from(path);
        let failed = |source| io_error(&path, source);
        let first = format!("standstill-sweep,{:016x},{shard}\n", job.key());
        let text = match fs::read_to_string(&path) {
            Err(error) if error.kind() == ErrorKind::NotFound => String::new(),
            other => other.map_err(failed)?,
        };
        // A row cut off by an interruption is ignored.
        let whole = &text[..text.rfind('\n').map_or(0, |end| end + 1)];
        let mut rows = Rows::new();
        if !whole.is_empty() {
            let Some(body) = whole.strip_prefix(&first) else {
                let why =
                    "it was begun with another sweep, script, shard or version: delete it to begin anew";
                return Err(wrong(&path, why.to_owned()));
            };
            let mut reader = csv::ReaderBuilder::new()
                .has_headers(false)
                .from_reader(body.as_bytes());
            for record in reader.records() {
                let record =
                    record.map_err(|error| wrong(&path, format!("{error}: delete it to begin anew")))?;
                let (case, row) = row(job, &record).map_err(|why| wrong(&path, why))?;
                rows.insert(case, row);
            }
        }
        if fs::symlink_metadata(&path).is_ok_and(|found| found.is_symlink()) {
            let why = io::Error::other("a link, through which nothing is written: delete it");
            return Err(failed(why));
        }
        let mut file = OpenOptions::new()
            .create(true)
            .append(true)
            .open(&path)
            .map_err(failed)?;
        file.set_len(whole.len() as u64).map_err(failed)?;
        if whole.is_empty() {
            file.write_all(first.as_bytes()).map_err(failed)?;
        }
        Ok(Self { path, file, rows })
    }

    /// Adds a row.
    ///
    /// # Errors
    /// [`SweepError::Suite`] with the error of the system.
    pub fn add(&mut self, row: &Row) -> Result<(), SweepError> {
        self.append(&row.fields)
            .map_err(|source| io_error(&self.path, source))
    }

    /// Writes the row in one piece.
    fn append(&mut self, fields: &[String]) -> io::Result<()> {
        let mut line = csv::Writer::from_writer(Vec::new());
        line.write_record(fields)?;
        let line = line.into_inner().map_err(csv::IntoInnerError::into_error)?;
        self.file.write_all(&line)
    }

    /// Removes the file, because its table is complete.
    ///
    /// # Errors
    /// [`SweepError::Suite`] with the message of the system.
    pub fn remove(self) -> Result<(), SweepError> {
        drop(self.file);
        fs::remove_file(&self.path).map_err(|source| io_error(&self.path, source))
    }
}

fn io_error(path: &Path, source: io::Error) -> SweepError {
    let path = path.to_owned();
    SuiteError::Io { path, source }.into()
}
