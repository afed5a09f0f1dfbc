//! A sweep that is ready to run, and the results of its cases.

use crate::figure::Figure;
use standstill_script::model::Script;
use standstill_script::suite::{self, Allowed, SuiteError, Texts};
use standstill_script::sweep::Sweep;
use standstill_script::{
    Advance, Ahead, Failure, Kept, RunError, ScriptError, Session, Verdict, far_or_by_scan, read_sweep, run,
};
use standstill_trace::{Extremes, digest, shortest};
use std::path::{Path, PathBuf};

/// The columns of every axis: the magnitudes of [`extremes`] and their distance from the limits.
const QUANTITIES: [&str; 5] = ["velocity", "acceleration", "deceleration", "jerk", "snap"];

/// The signals of an axis from which they are taken.
const SIGNALS: [&str; 4] = ["Velocity", "Acceleration", "Jerk", "Snap"];

/// Columns before the parameters.
const FIRST: [&str; 1] = ["case"];

/// Columns behind them, before those of axes and measures.
const JUDGEMENT: [&str; 4] = ["verdict", "scans", "claims", "held"];

/// The column of digests, if there are any.
const DIGEST: &str = "digest";

/// The column behind all others.
const LAST: [&str; 1] = ["why"];

/// The reason why a sweep cannot be run.
#[derive(Debug, thiserror::Error)]
pub enum SweepError {
    /// The sweep file or the script is not valid, or could not be read.
    #[error(transparent)]
    Suite(#[from] SuiteError),
    /// A table does not belong to this sweep.
    #[error("{file}: {why}")]
    Table {
        /// The table.
        file: String,
        /// The fault, and the remedy.
        why: String,
    },
}

impl From<ScriptError> for SweepError {
    fn from(error: ScriptError) -> Self {
        Self::Suite(error.into())
    }
}

/// Cells of a case that are held before they are read and dropped: few enough for a processor's cache.
const CELLS_HELD: usize = 8192;

/// The common data of the cases of a thread.
#[derive(Clone)]
pub(crate) struct Bench {
    /// The script with the parameters of the last case.
    script: Script,
    /// The memory for the rows of the last case.
    kept: Option<Kept>,
}

/// The results of a case.
struct Ran {
    scans: u64,
    verdicts: Vec<Verdict>,
    extremes: Extremes,
    /// The figures of the measures, as written in the table.
    figures: Vec<String>,
    digest: Option<u64>,
}

impl Ran {
    fn failure(&self) -> Option<&Failure> {
        self.verdicts.iter().flat_map(|verdict| &verdict.failures).next()
    }
}

/// A sweep with its script, both read.
#[derive(Clone, Debug)]
pub struct Job {
    sweep: Sweep,
    texts: Texts,
    path: PathBuf,
    /// The script with its own parameters.
    script: Script,
    axes: Vec<String>,
    columns: Vec<String>,
    /// The columns that a case keeps: all if the table has a digest, otherwise only those that are read.
    kept: Kept,
    key: u64,
}

/// How a case ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Judged {
    /// Every claim is fulfilled.
    Passed,
    /// A claim failed.
    Failed,
    /// The script cannot be run with these values.
    Refused,
}

impl Judged {
    /// All of them.
    pub const ALL: [Self; 3] = [Self::Passed, Self::Failed, Self::Refused];

    /// The word in the table.
    pub const fn word(self) -> &'static str {
        match self {
            Self::Passed => "passed",
            Self::Failed => "failed",
            Self::Refused => "refused",
        }
    }
}

/// The row of a case.
#[derive(Clone, Debug)]
pub struct Row {
    /// Its number.
    pub case: u64,
    /// A field for every column.
    pub fields: Vec<String>,
    /// Its verdict.
    pub judged: Judged,
    /// Scans times axes of its run.
    pub axis_scans: u64,
}

impl Job {
    /// Reads the sweep at `path` and its script, and runs the script with its own parameters to find its signals.
    /// The script must be below the folder of the sweep or in a folder that `allowed` permits, and so must its
    /// includes.
    ///
    /// # Errors
    /// [`SweepError::Suite`].
    pub fn load(path: &Path, allowed: &Allowed) -> Result<Self, SweepError> {
        let sweep = read_sweep(&suite::read_text(path)?, &suite::shown(path))?;
        suite::beside(path, &sweep.script, &allowed.folders, "sweep").map_err(|why| sweep.no_script(&why))?;
        let file = path.parent().unwrap_or(Path::new("")).join(&sweep.script);
        let (texts, script) = Texts::read(&file, allowed)?;
        let outcome = run(&script).map_err(|source| SuiteError::Run {
            path: file.clone(),
            source,
        })?;
        let axes: Vec<String> = script.axes.iter().map(|axis| axis.name.clone()).collect();
        let own = columns(&sweep, &axes, false);
        sweep.check(&script, &outcome.trace, &own)?;
        let mut key = digest::Fnv1a::new();
        key.write(env!("CARGO_PKG_VERSION").as_bytes());
        key.write(sweep.text().as_bytes());
        key.write(&script.hash.to_le_bytes());
        // This run shows all other faults.
        key.write(&digest::whole(&outcome.trace).to_le_bytes());
        let of_axes = axes
            .iter()
            .flat_map(|axis| SIGNALS.map(|signal| format!("{axis}.{signal}")));
        let measured = sweep.measures().iter().map(|measure| measure.signal.clone());
        let kept = match sweep.has_digest {
            true => Kept::all(&script),
            false => Kept::read(&script, &of_axes.chain(measured).collect::<Vec<_>>()),
        };
        Ok(Self {
            columns: columns(&sweep, &axes, true),
            kept,
            sweep,
            texts,
            path: file,
            script,
            axes,
            key: key.finish(),
        })
    }

    /// The number of cases.
    pub fn count(&self) -> u64 {
        self.sweep.count()
    }

    /// The names of the columns.
    pub fn columns(&self) -> &[String] {
        &self.columns
    }

    /// A number that differs for another sweep, script or version.
    pub fn key(&self) -> u64 {
        self.key
    }

    /// The data that a thread needs before its first case.
    pub(crate) fn bench(&self) -> Bench {
        Bench {
            script: self.script.clone(),
            kept: None,
        }
    }

    /// Runs a case. `bench` may be that of another case before.
    ///
    /// # Errors
    /// A defect of this program. A script that cannot be run with these values is no error; it gets a
    /// row.
    pub(crate) fn case(&self, bench: &mut Bench, case: u64) -> Result<Row, SweepError> {
        let parameters = self.sweep.case(case);
        let refused = |why: String| Row {
            case,
            fields: self.fields(case, &parameters, Judged::Refused, None, why),
            judged: Judged::Refused,
            axis_scans: 0,
        };
        if let Err(error) = self.texts.vary(&mut bench.script, &parameters) {
            return Ok(refused(first_of(&error)));
        }
        let ran = match far_or_by_scan(|advance| self.take(bench, advance)) {
            Ok(ran) => ran,
            Err(source @ RunError::Internal(_)) => {
                let path = self.path.clone();
                return Err(SuiteError::Run { path, source }.into());
            }
            Err(error) => return Ok(refused(error.to_string())),
        };
        let failure = ran.failure();
        let judged = match failure {
            None => Judged::Passed,
            Some(_) => Judged::Failed,
        };
        let why = failure.map(ToString::to_string).unwrap_or_default();
        Ok(Row {
            case,
            fields: self.fields(case, &parameters, judged, Some(&ran), why),
            judged,
            axis_scans: ran.scans * self.axes.len() as u64,
        })
    }

    /// Runs the script and takes the values for a table; rows are dropped on the way. None if `advance` cannot run this
    /// script.
    fn take(&self, bench: &mut Bench, advance: Advance) -> Result<Option<Ran>, RunError> {
        let kept = bench.kept.take().unwrap_or_else(|| self.kept.clone());
        let mut session = Session::keeping(&bench.script, kept)?;
        let mut digest = self.sweep.has_digest.then(digest::Whole::default);
        let mut extremes = Extremes::of_derivatives(session.trace());
        let measures = self.sweep.measures().iter();
        let mut figures: Vec<Figure> = measures
            .map(|measure| Figure::new(measure, session.trace()))
            .collect();
        let rows_held = (CELLS_HELD / session.trace().columns().len().max(1)).max(64) as u64;
        loop {
            let room = rows_held - session.scans() % rows_held;
            match advance(&mut session, room)? {
                Ahead::Broken => return Ok(None),
                Ahead::Scans(0) => break,
                Ahead::Scans(_) => {}
            }
            if session.scans() % rows_held == 0 || session.is_over() {
                let trace = session.trace();
                if let Some(digest) = &mut digest {
                    digest.look(trace);
                }
                extremes.look(trace);
                figures.iter_mut().for_each(|figure| figure.look(trace));
                session.forget();
            }
        }
        let ran = Ran {
            scans: session.scans(),
            verdicts: session.verdicts_untold(),
            extremes,
            figures: figures.iter().map(Figure::text).collect(),
            digest: digest.map(|digest| digest.finish()),
        };
        bench.kept = Some(session.into_kept());
        Ok(Some(ran))
    }

    /// Whether the row has a field for every column, and the parameters of this case.
    pub(crate) fn is_row_of(&self, case: u64, row: &csv::StringRecord) -> bool {
        let parameters = self.sweep.case(case);
        let mut fields = parameters.iter().zip(row.iter().skip(FIRST.len()));
        row.len() == self.columns.len() && fields.all(|((_, value), field)| shortest(*value) == field)
    }

    /// The verdict in a row.
    pub fn judged(&self, fields: &[String]) -> Option<Judged> {
        let word = fields.get(FIRST.len() + self.sweep.parameters().count())?;
        Judged::ALL.into_iter().find(|judged| judged.word() == word)
    }

    /// The fields of a row, in the order of [`columns`].
    fn fields(
        &self,
        case: u64,
        parameters: &[(String, f64)],
        judged: Judged,
        ran: Option<&Ran>,
        why: String,
    ) -> Vec<String> {
        let mut fields = Vec::with_capacity(self.columns.len());
        fields.push(case.to_string());
        fields.extend(parameters.iter().map(|(_, value)| shortest(*value)));
        fields.push(judged.word().to_owned());
        if let Some(ran) = ran {
            let held = ran.verdicts.iter().filter(|verdict| verdict.passed()).count();
            fields.push(ran.scans.to_string());
            fields.extend([ran.verdicts.len(), held].map(|count| count.to_string()));
            for (axis, quantity) in
                (0..self.axes.len()).flat_map(|axis| QUANTITIES.map(|quantity| (axis, quantity)))
            {
                let found = ran.extremes.of(axis, quantity);
                let peak = found.map(|(value, _)| shortest(value));
                let margin = found.and_then(|(value, limit)| Some(1.0 - value / limit?));
                fields.push(peak.unwrap_or_default());
                fields.push(margin.map(shortest).unwrap_or_default());
            }
            fields.extend(ran.figures.iter().cloned());
            fields.extend(ran.digest.map(|digest| format!("{digest:016x}")));
        }
        // A case that did not run has no values between its verdict and the reason.
        fields.resize(self.columns.len() - 1, String::new());
        fields.push(why.replace(['\n', '\r'], " "));
        fields
    }
}

/// The columns of a table; optionally without those that the sweep file names itself.
fn columns(sweep: &Sweep, axes: &[String], all: bool) -> Vec<String> {
    let owned = |names: &[&str]| names.iter().map(|name| (*name).to_owned()).collect::<Vec<_>>();
    let mut columns = owned(&FIRST);
    if all {
        columns.extend(sweep.parameters().map(str::to_owned));
    }
    columns.extend(owned(&JUDGEMENT));
    for (axis, quantity) in axes
        .iter()
        .flat_map(|axis| QUANTITIES.map(|quantity| (axis, quantity)))
    {
        columns.push(format!("{axis}.{quantity}"));
        columns.push(format!("{axis}.{quantity}_margin"));
    }
    if all {
        columns.extend(sweep.measures().iter().map(|measure| measure.name.clone()));
    }
    if sweep.has_digest {
        columns.push(DIGEST.to_owned());
    }
    columns.extend(owned(&LAST));
    columns
}

/// The first fault, in one line.
fn first_of(error: &ScriptError) -> String {
    let Some(diagnostic) = error.diagnostics().first() else {
        return String::new();
    };
    match diagnostic.span {
        None => diagnostic.message.clone(),
        Some(span) => {
            let (line, column) = error.line_column(span);
            format!("{}:{line}:{column}: {}", error.file_of(span), diagnostic.message)
        }
    }
}
