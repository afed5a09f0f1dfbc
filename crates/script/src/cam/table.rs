//! The rows of a cam, from a CSV file or a script.

use crate::csv::{self, CAM_TABLE, CsvFault};
use crate::model::Script;
use crate::read::names::suggestion;
use crate::suite::SuiteError;
use standstill_axis::{CAM_ROWS, CamCause, CamCurve, CamFault, CamRow, IecEnum};
use std::fmt;

/// Numbers of a row: Master, Slave, Slope, Curvature, Third, Law.
const FIELDS: usize = 6;

/// The rows of a cam, and their places in the text.
#[derive(Clone, Debug)]
pub struct CamTable {
    /// Its name in messages.
    pub name: String,
    /// The rows.
    pub rows: Vec<CamRow>,
    /// The law of each.
    pub(super) laws: Vec<CamCurve>,
    /// The line of each in its file; empty for rows in a script.
    lines: Vec<usize>,
}

/// The reason why there is no cam.
#[derive(Debug)]
pub enum CamError {
    /// A script or a machine file can't be read.
    Suite(SuiteError),
    /// A fault of a table.
    Table {
        /// `knife.csv:3:5`, or another name of the place.
        place: String,
        /// The fault, without a full stop.
        message: String,
        /// The remedy.
        help: String,
    },
}

impl fmt::Display for CamError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Suite(error) => error.fmt(f),
            Self::Table { place, message, help } => write!(f, "{place}: {message}\nhelp: {help}"),
        }
    }
}

impl From<SuiteError> for CamError {
    fn from(error: SuiteError) -> Self {
        Self::Suite(error)
    }
}

/// The IEC name of a law.
pub(super) fn law_name(law: CamCurve) -> &'static str {
    let mut names = CamCurve::ELEMENTS.iter();
    let found = names.find(|(_, number)| *number == law as i32);
    found.map_or("", |(name, _)| *name)
}

impl CamTable {
    /// The rows of a CSV file of this name.
    ///
    /// # Errors
    /// [`CamError::Table`] with line and column.
    pub fn of_csv(name: &str, bytes: &[u8]) -> Result<Self, CamError> {
        let fault = |fault: CsvFault| {
            let place = match fault.line {
                0 => name.to_owned(),
                line => format!("{name}:{line}:{}", fault.column),
            };
            CamError::Table {
                place,
                message: fault.message,
                help: fault.help,
            }
        };
        let info = csv::table_info(CAM_TABLE).ok_or_else(|| CamError::Table {
            place: name.to_owned(),
            message: "this build has no cams".to_owned(),
            help: "build it with MC_CamTableSelect".to_owned(),
        })?;
        let (rows, lines) = csv::read_with_lines(bytes, &info).map_err(fault)?;
        Self::of_numbers(name, rows.iter().map(Vec::as_slice), lines)
    }

    /// The table under `tables` with this name, or the only one; `file` is the script's name.
    ///
    /// # Errors
    /// [`CamError::Table`] if there is none, or several, or a law is unknown.
    pub fn of_script(file: &str, script: &Script, name: Option<&str>) -> Result<Self, CamError> {
        let cams = || {
            let tables = script.named_tables.iter();
            tables.filter(|table| table.info.name == CAM_TABLE)
        };
        let names = || cams().map(|table| table.name.as_str());
        let refused = |message: String, help: String| CamError::Table {
            place: file.to_owned(),
            message,
            help,
        };
        let table = match (name, cams().count()) {
            (Some(name), _) => cams().find(|table| table.name == name).ok_or_else(|| {
                let help = suggestion(name, names());
                let help = help.unwrap_or_else(|| "the tables of cams stand under \"tables\"".to_owned());
                refused(format!("there is no table `{name}` of a cam"), help)
            })?,
            (None, 1) => cams()
                .next()
                .ok_or_else(|| refused(String::new(), String::new()))?,
            (None, 0) => {
                let message = "the script has no table of a cam".to_owned();
                return Err(refused(message, "declare it under \"tables\"".to_owned()));
            }
            (None, count) => {
                let names: Vec<&str> = names().collect();
                let message = format!("the script has {count} tables of cams: {}", names.join(", "));
                let help = format!(
                    "name one of them, such as {file}#{}",
                    names.first().unwrap_or(&"")
                );
                return Err(refused(message, help));
            }
        };
        let numbers = script.tables.iter().as_slice();
        let first = table.place.first as usize;
        let end = first + usize::from(table.place.records) * FIELDS;
        let rows = numbers.get(first..end).unwrap_or_default();
        Self::of_numbers(&format!("{file}#{}", table.name), rows.chunks(FIELDS), Vec::new())
    }

    fn of_numbers<'a>(
        name: &str,
        rows: impl Iterator<Item = &'a [f64]>,
        lines: Vec<usize>,
    ) -> Result<Self, CamError> {
        let mut table = Self {
            name: name.to_owned(),
            rows: Vec::new(),
            laws: Vec::new(),
            lines,
        };
        for (row, numbers) in (1..).zip(rows) {
            let number = |field: usize| numbers.get(field).copied().unwrap_or_default();
            let law = CamCurve::from_number(number(5) as i32).ok_or_else(|| {
                let names: Vec<&str> = CamCurve::ELEMENTS.iter().map(|(name, _)| *name).collect();
                CamError::Table {
                    place: table.place(row),
                    message: format!("`Law` is {}, and laws have numbers from 0 to 5", number(5)),
                    help: format!("it is one of {}, or its number", names.join(", ")),
                }
            })?;
            table.laws.push(law);
            table.rows.push(CamRow {
                master: number(0),
                slave: number(1),
                slope: number(2),
                curvature: number(3),
                third: number(4),
                shape: law.shape(),
            });
        }
        Ok(table)
    }

    /// The line of a row, from 1, of a table in a file of its own.
    #[must_use]
    pub fn line(&self, row: usize) -> Option<usize> {
        self.lines.get(row.checked_sub(1)?).copied()
    }

    /// The begin of messages about a row, from 1.
    pub(super) fn place(&self, row: usize) -> String {
        match self.line(row) {
            Some(line) => format!("{}:{line}: row {row}", self.name),
            None => format!("{}: row {row}", self.name),
        }
    }

    /// The reason why the runtime makes no cam of it.
    pub(super) fn fault(&self, fault: &CamFault) -> CamError {
        let (place, message, help) = match fault.cause {
            CamCause::Count => (
                self.name.clone(),
                format!("{} rows, and cams have 2 to {CAM_ROWS}", self.rows.len()),
                "leave rows out where the curve hardly bends; with 1 row there is no curve".to_owned(),
            ),
            CamCause::Order => (
                self.place(fault.row),
                format!(
                    "`Master` is {:?} after {:?} in the row before",
                    fault.value, fault.limit
                ),
                "places of the master rise from row to row".to_owned(),
            ),
            CamCause::NotFinite => (
                self.place(fault.row),
                format!(
                    "the way of the master from the row before is {:?}: no curve that short or long has finite derivatives",
                    fault.value
                ),
                "keep rows further apart, or numbers smaller".to_owned(),
            ),
        };
        CamError::Table { place, message, help }
    }
}
