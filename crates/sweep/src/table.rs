//! Tables of rows: CSV, sorted by case.

use crate::job::{Job, SweepError};
use standstill_script::suite::shown;
use std::collections::BTreeMap;
use std::fs;
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Rows by case, each with a field for every column.
pub type Rows = BTreeMap<u64, Vec<String>>;

/// Writes a table.
///
/// # Errors
/// An error of the system.
pub fn write(columns: &[String], rows: &Rows, out: &mut dyn Write) -> io::Result<()> {
    let mut table = csv::Writer::from_writer(out);
    table.write_record(columns)?;
    for row in rows.values() {
        table.write_record(row)?;
    }
    table.flush()
}

/// The rows of the tables of this sweep's shards: every case once.
///
/// # Errors
/// [`SweepError::Suite`] for a file that cannot be read; [`SweepError::Table`] for a table with other columns, for a
/// case that is missing, and for one that two tables have.
pub fn merge(job: &Job, files: &[PathBuf]) -> Result<Rows, SweepError> {
    let mut all = Rows::new();
    let mut owners: BTreeMap<u64, &Path> = BTreeMap::new();
    for file in files {
        for (case, row) in read(job, file)? {
            if let Some(first) = owners.insert(case, file) {
                let why = format!(
                    "case {case} stands in {}, too: give each shard once",
                    shown(first)
                );
                return Err(wrong(file, why));
            }
            all.insert(case, row);
        }
    }
    let Some(missing) = (0..job.count()).find(|case| !all.contains_key(case)) else {
        return Ok(all);
    };
    let why = format!(
        "case {missing} stands in none of them; {} of {} cases are there",
        all.len(),
        job.count()
    );
    Err(wrong(files.last().map_or(Path::new(""), PathBuf::as_path), why))
}

fn read(job: &Job, path: &Path) -> Result<Rows, SweepError> {
    let text = fs::read_to_string(path).map_err(|source| standstill_script::suite::SuiteError::Io {
        path: path.to_owned(),
        source,
    })?;
    let mut reader = csv::Reader::from_reader(text.as_bytes());
    let header = reader.headers().map_err(|error| wrong(path, error.to_string()))?;
    if !header.iter().eq(job.columns()) {
        return Err(wrong(path, "these are not the columns of this sweep".to_owned()));
    }
    let mut rows = Rows::new();
    for record in reader.into_records() {
        let record = record.map_err(|error| wrong(path, error.to_string()))?;
        let (case, row) = row(job, &record).map_err(|why| wrong(path, why))?;
        if rows.insert(case, row).is_some() {
            return Err(wrong(path, format!("case {case} stands here twice")));
        }
    }
    Ok(rows)
}

/// A row of a table, checked against the parameters of its case.
pub(crate) fn row(job: &Job, record: &csv::StringRecord) -> Result<(u64, Vec<String>), String> {
    let text = record.get(0).unwrap_or_default();
    let case = text.parse().ok().filter(|case| *case < job.count());
    let case = case.ok_or_else(|| format!("the sweep has no case `{text}`"))?;
    if !job.is_row_of(case, record) {
        return Err(format!(
            "case {case} had other parameters: this table is of another sweep"
        ));
    }
    let row: Vec<String> = record.iter().map(str::to_owned).collect();
    match job.judged(&row) {
        Some(_) => Ok((case, row)),
        None => Err(format!("case {case} has no verdict")),
    }
}

pub(crate) fn wrong(path: &Path, why: String) -> SweepError {
    SweepError::Table {
        file: shown(path),
        why,
    }
}
