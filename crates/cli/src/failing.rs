//! Pages of failing tests: the golden, the run over it, and a mark at the first difference.

use crate::exit::{Exit, Failure};
use crate::report::page_failure;
use standstill_report::{Mark, Source, check, html_marked};
use standstill_script::golden::Standing;
use standstill_script::suite::{Report, SuiteError, shown};
use standstill_script::{Reason, golden};
use standstill_trace::compare::{Difference, Yardstick, compare_by};
use standstill_trace::file::replace_beside;
use standstill_trace::{Trace, time_literal};
use std::collections::BTreeSet;
use std::fs;
use std::path::{Component, Path, PathBuf};

/// The folder the pages go to.
#[derive(Debug)]
pub struct Pages<'a> {
    root: &'a Path,
    written: BTreeSet<PathBuf>,
}

impl<'a> Pages<'a> {
    /// Makes the folder. Call it before the tests, not after them.
    pub fn new(root: &'a Path) -> Result<Self, Failure> {
        make(root)?;
        Ok(Self {
            root,
            written: BTreeSet::new(),
        })
    }

    /// Writes the page of a script that failed by this yardstick; its path.
    pub fn write(
        &mut self,
        script: &Path,
        report: &Report,
        yardstick: Option<Yardstick>,
    ) -> Result<String, Failure> {
        let path = self.place(script);
        let folder = path.parent().unwrap_or(self.root);
        make(folder)?;
        self.stay_below(folder)?;
        let page = page(script, report, yardstick)?;
        replace_beside(&path, |out| out.write_all(page.as_bytes()))?;
        Ok(shown(&path))
    }

    /// No link on the path may lead out of the named folder.
    fn stay_below(&self, folder: &Path) -> Result<(), Failure> {
        let real = |path: &Path| fs::canonicalize(path).map_err(|error| Failure::io(&shown(path), &error));
        if real(folder)?.starts_with(real(self.root)?) {
            return Ok(());
        }
        let text = format!(
            "error: {}: a link leads out of the folder of --report",
            shown(folder)
        );
        Err(Failure::Told(Exit::Io, text))
    }

    /// The place of a script's page: below the folder, as the script is below its own.
    fn place(&mut self, script: &Path) -> PathBuf {
        let parts = script.components();
        let inner: PathBuf = parts
            .filter(|part| matches!(part, Component::Normal(_)))
            .collect();
        // Two extensions are one too many for `with_extension`.
        let stem = self.root.join(inner).with_extension("").with_extension("");
        let mut path = with_ending(&stem, "html");
        // `a/x` and `../a/x` are two scripts.
        let mut number = 2;
        while !self.written.insert(path.clone()) {
            path = with_ending(&stem, &format!("{number}.html"));
            number += 1;
        }
        path
    }
}

/// A path with a dot and an ending behind it.
pub fn with_ending(stem: &Path, ending: &str) -> PathBuf {
    let mut path = stem.as_os_str().to_owned();
    path.push(".");
    path.push(ending);
    path.into()
}

fn make(folder: &Path) -> Result<(), Failure> {
    fs::create_dir_all(folder).map_err(|error| Failure::io(&shown(folder), &error))
}

fn page(script: &Path, report: &Report, yardstick: Option<Yardstick>) -> Result<String, Failure> {
    let run = &report.outcome.trace;
    let mut golden = golden::expected(script, run).map_err(SuiteError::from)?;
    if let Some(expected) = &mut golden {
        expected.describe_as(run.header());
    }
    // A run without differences is not shown twice.
    let difference = golden
        .as_ref()
        .zip(yardstick.filter(|_| report.golden != Standing::Unasked))
        .and_then(|(expected, yardstick)| compare_by(expected, run, yardstick));
    let name = shown(script);
    let names = [format!("expected: golden of {name}"), format!("found: {name}")];
    let lacks = ["the notes of its run".to_owned()];
    let found = source(&names[1], run, &[]);
    // The page begins at the first.
    let marks: Vec<Mark> = why_mark(&report.why)
        .into_iter()
        .chain(difference.as_ref().map(mark))
        .collect();
    let both = match (&golden, &difference) {
        (Some(expected), Some(_)) => vec![source(&names[0], expected, &lacks), found],
        _ => vec![found],
    };
    // Runs of different cycle have no common scans; the mark shows the cycles.
    let sources = if check(&both).is_ok() { both } else { vec![found] };
    html_marked(&sources, &marks).map_err(page_failure)
}

fn source<'a>(name: &'a str, trace: &'a Trace, lacks: &'a [String]) -> Source<'a> {
    Source { name, trace, lacks }
}

/// Why a run fails, at the scan of the likeliest reason.
pub fn why_mark(why: &[Reason]) -> Option<Mark> {
    let first = why.first()?;
    let scan = first.scan.and_then(|scan| usize::try_from(scan).ok());
    Some(Mark {
        scan,
        title: scan.map_or_else(|| "why".to_owned(), |scan| format!("why: scan {scan}")),
        text: why.iter().map(|reason| format!("{}\n", reason.text)).collect(),
    })
}

/// The first difference; past the end of the shorter trace if only their lengths differ.
fn mark(difference: &Difference) -> Mark {
    let (expected, found) = difference.scans;
    let scan = match &difference.first {
        Some(first) => Some(first.scan),
        None => (expected != found).then(|| expected.min(found)),
    };
    let title = match (&difference.first, scan) {
        (Some(first), _) => format!(
            "first difference in scan {} ({})",
            first.scan,
            time_literal(first.time_ns)
        ),
        (None, Some(scan)) => format!("one run ends before scan {scan}"),
        (None, None) => "what is recorded of the run differs".to_owned(),
    };
    Mark {
        scan,
        title,
        text: difference.to_string(),
    }
}
