//! `standstill report`, and the files that `run` writes beside its text: a trace as a page, a picture, a
//! waveform.

use crate::apart;
use crate::exit::{Exit, Failure, complain};
use crate::limit;
use standstill_picture as picture;
use standstill_report::{Mark, ReportError, Source, html_marked};
use standstill_script::suite::shown;
use standstill_trace::file::{self, replace};
use standstill_trace::{Loaded, vcd};
use std::path::{Path, PathBuf};

/// The files to write, each if it is requested.
#[derive(Clone, Copy, Debug)]
pub struct Targets<'a> {
    /// The page.
    pub html: Option<&'a Path>,
    /// The picture.
    pub svg: Option<&'a Path>,
    /// The waveform.
    pub vcd: Option<&'a Path>,
}

/// Reads the traces and writes the requested files.
pub fn report(traces: &[PathBuf], targets: Targets<'_>) -> Result<Exit, Failure> {
    if let Targets {
        html: None,
        svg: None,
        vcd: None,
    } = targets
    {
        return Err(Failure::usage(
            "nothing to write: give -o FILE.html, --svg FILE or --vcd FILE",
        ));
    }
    if traces.len() > 1 && (targets.svg.is_some() || targets.vcd.is_some()) {
        return Err(Failure::usage(
            "--svg and --vcd take one trace; -o lays several over each other",
        ));
    }
    let writes = [
        apart::written("--output", targets.html),
        apart::written("--svg", targets.svg),
        apart::written("--vcd", targets.vcd),
    ];
    apart::checked(&writes.concat(), traces.iter().map(PathBuf::as_path))?;
    let loaded: Vec<(String, Loaded)> = traces.iter().map(|path| load(path)).collect::<Result<_, _>>()?;
    let sources: Vec<_> = loaded.iter().map(|(name, loaded)| source(name, loaded)).collect();
    write_all(&sources, &[], targets)?;
    Ok(Exit::Passed)
}

/// A trace with its name; the parts it lacks are also reported on standard error.
pub fn load(path: &Path) -> Result<(String, Loaded), Failure> {
    let name = shown(path);
    limit::doing(format!("reading {name}"));
    let loaded = file::load(path)?;
    if !loaded.lacks.is_empty() {
        complain(&format!("note: {name} lacks {}", loaded.lacks.join(", ")));
    }
    Ok((name, loaded))
}

fn source<'a>(name: &'a str, loaded: &'a Loaded) -> Source<'a> {
    Source {
        name,
        trace: &loaded.trace,
        lacks: &loaded.lacks,
    }
}

/// Writes the requested files; the page begins at the first mark.
pub fn write_all(sources: &[Source<'_>], marks: &[Mark], targets: Targets<'_>) -> Result<(), Failure> {
    if let Some(path) = targets.html {
        let page = html_marked(sources, marks).map_err(page_failure)?;
        replace(path, |out| out.write_all(page.as_bytes()))?;
    }
    if let ([source], Some(path)) = (sources, targets.svg) {
        let picture = picture::report(source.trace);
        replace(path, |out| out.write_all(picture.as_bytes()))?;
    }
    if let ([source], Some(path)) = (sources, targets.vcd) {
        replace(path, |mut out| vcd::write(source.trace, &mut out))?;
    }
    Ok(())
}

/// The message for traces without a page.
pub fn page_failure(error: ReportError) -> Failure {
    let exit = match error {
        ReportError::Count(_) => Exit::Usage,
        ReportError::Empty(_) | ReportError::Cycle { .. } => Exit::BadInput,
    };
    Failure::Told(exit, format!("error: {error}"))
}
