//! `standstill run` for a script with more scans than rows are kept. All output is written row by row, so memory
//! does not grow with the scans.

use crate::args::RunArguments;
use crate::exit::{Exit, Failure, complain};
use crate::json::Object;
use crate::limit;
use crate::outcome;
use crate::progress::Progress;
use crate::run::{failing_claims, title, verdict};
use standstill_script::model::Script;
use standstill_script::suite::SuiteError;
use standstill_script::{Ahead, CELLS_MAX, Outcome, ROWS_MAX, RunError, Session, warnings};
use standstill_trace::csv::Dialect;
use standstill_trace::digest::Whole;
use standstill_trace::file::{FileError, Streaming};
use standstill_trace::{EventLog, Extremes, Trace, Widths};
use std::io::Write;
use std::path::Path;

/// Rows that are held before they are written and dropped.
const ROWS_HELD: u64 = 4096;

/// The outputs that are written as rows arrive.
struct Telling<'a> {
    out: &'a mut dyn Write,
    /// The text for people; none with `--quiet`.
    events: Option<(EventLog, Widths)>,
    extremes: Extremes,
    digest: Whole,
    file: Option<Streaming>,
}

impl Telling<'_> {
    /// Writes the rows that have arrived since the last call.
    fn look(&mut self, trace: &Trace) -> Result<(), Ended> {
        if let Some((log, widths)) = &mut self.events {
            for event in log.take(trace) {
                let written = self.out.write_all(widths.line(&event).as_bytes());
                written.map_err(|error| Ended::Told(error.into()))?;
            }
            self.extremes.look(trace);
        }
        self.digest.look(trace);
        if let Some(file) = &mut self.file {
            file.look(trace).map_err(Ended::File)?;
        }
        Ok(())
    }
}

/// Runs a script and reports the result.
pub fn run(
    path: &Path,
    (name, script): (&str, &Script),
    arguments: &RunArguments,
    dialect: Dialect,
    told: &mut Vec<Object>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    draws_nothing(name, script, arguments)?;
    let wrong = |source| {
        let path = path.to_owned();
        Failure::from(SuiteError::Run { path, source })
    };
    let mut session = Session::long(script).map_err(wrong)?;
    let trace = session.trace();
    let file = arguments.trace.as_deref();
    let file = file.map(|file| Streaming::begin(trace, file, dialect));
    let shows = !arguments.quiet && !arguments.json;
    let mut telling = Telling {
        events: shows.then(|| (EventLog::default(), Widths::of_run(trace, script.scans))),
        extremes: Extremes::new(trace),
        digest: Whole::default(),
        file: file.transpose()?,
        out,
    };
    if shows {
        title(name, trace, telling.out)?;
        writeln!(telling.out, "\nevents")?;
    }
    let went = go(script, &mut session, &mut telling, name, !arguments.quiet);
    let Telling {
        out,
        extremes,
        digest,
        file,
        ..
    } = telling;
    if let Err(error) = went {
        let failure = match error {
            Ended::Run(error) => wrong(error),
            Ended::Told(failure) => failure,
            // The streaming file itself reports which rows are kept.
            Ended::File(error) => return Err(error.into()),
        };
        if let Some((partial, rows)) = file.as_ref().and_then(Streaming::kept) {
            out.flush()?;
            complain(&kept(partial, rows));
        }
        return Err(failure);
    }
    let outcome = session.finish();
    let (digest, warnings) = (digest.finish(), warnings(script, &outcome, script.golden));
    if shows {
        let scans = outcome.trace.scans();
        writeln!(
            out,
            "\nno drawing: {scans} scans are more than the {ROWS_MAX} whose rows are kept; --trace writes them\n"
        )?;
        writeln!(out, "{}", extremes.text())?;
        let failing = failing_claims(&outcome);
        if !failing.is_empty() {
            writeln!(out, "failing claims\n{failing}")?;
        }
    } else {
        write!(out, "{}", failing_claims(&outcome))?;
    }
    writeln!(out, "{name}: {}", verdict(&outcome, digest))?;
    if arguments.json {
        told.push(outcome::run(name, &outcome, digest, &warnings));
    }
    out.flush()?;
    if !outcome.passed() {
        complain(&format!(
            "{name}: why claims fail is only looked for where rows are kept: set `scans` to {} at most, beyond the first failing scan",
            kept_at_most(script, &outcome)
        ));
    }
    if !warnings.all.is_empty() {
        complain(warnings.to_string().trim_end());
    }
    if let Some(file) = file {
        file.finish(&outcome.trace)?;
    }
    Ok(Exit::of(outcome.passed()))
}

/// The reason why a run ended early.
enum Ended {
    Run(RunError),
    Told(Failure),
    /// The trace could not be written.
    File(FileError),
}

fn go<'s>(
    script: &'s Script,
    session: &mut Session<'s>,
    telling: &mut Telling<'_>,
    name: &str,
    watched: bool,
) -> Result<(), Ended> {
    let stop = telling.file.is_some().then(Stop::new).transpose();
    let stop = stop.map_err(|error| Ended::Told(Failure::io("signals", &error)))?;
    let mut progress = Progress::new(watched);
    let (mut by_scan, mut told) = (false, 0);
    loop {
        let goes_on = if by_scan {
            session.advance()
        } else {
            match session.advance_far(ROWS_HELD - session.scans() % ROWS_HELD) {
                Ok(Ahead::Broken) => {
                    // Up to the rows that were written it is the same run.
                    *session = Session::long(script).map_err(Ended::Run)?;
                    by_scan = true;
                    continue;
                }
                ahead => ahead.map(|ahead| ahead != Ahead::Scans(0)),
            }
        };
        let goes_on = goes_on.map_err(Ended::Run);
        if !matches!(goes_on, Ok(true)) || session.scans() % ROWS_HELD == 0 {
            let scans = session.scans();
            limit::doing(format!("{name}: {scans} scans"));
            // A line of progress and text for people may share a terminal.
            if telling.events.is_some() {
                progress.clear();
            }
            if session.scans() > told {
                telling.look(session.trace())?;
                told = session.scans();
            }
            session.forget();
            progress.show(|| format!("{name}: {scans} of {} scans", script.scans));
            if let (Some(stop), Some(file)) = (&stop, &telling.file) {
                stop.heed(file, telling.out);
            }
        }
        if !goes_on? {
            return Ok(());
        }
    }
}

/// The signals that request an end.
struct Stop {
    #[cfg(all(unix, feature = "signals"))]
    signal: std::sync::Arc<std::sync::atomic::AtomicUsize>,
}

impl Stop {
    #[cfg(all(unix, feature = "signals"))]
    fn new() -> std::io::Result<Self> {
        use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
        let signal = std::sync::Arc::default();
        for number in [SIGHUP, SIGINT, SIGTERM] {
            let stored = usize::try_from(number).unwrap_or_default();
            signal_hook::flag::register_usize(number, std::sync::Arc::clone(&signal), stored)?;
        }
        Ok(Self { signal })
    }

    #[cfg(not(all(unix, feature = "signals")))]
    fn new() -> std::io::Result<Self> {
        Ok(Self {})
    }

    /// If a signal has come: reports the written part of the file, and ends as the signal would have.
    #[cfg(all(unix, feature = "signals"))]
    fn heed(&self, file: &Streaming, out: &mut dyn Write) {
        let signal = self.signal.load(std::sync::atomic::Ordering::Relaxed);
        if signal == 0 {
            return;
        }
        // The process ends in any case.
        let _ = out.flush();
        if let Some((partial, rows)) = file.kept() {
            complain(&kept(partial, rows));
        }
        let signal = i32::try_from(signal).unwrap_or(signal_hook::consts::SIGTERM);
        let _ = signal_hook::low_level::emulate_default_handler(signal);
    }

    #[cfg(not(all(unix, feature = "signals")))]
    fn heed(&self, _: &Streaming, _: &mut dyn Write) {}
}

fn kept(partial: &Path, rows: usize) -> String {
    let partial = standstill_script::suite::shown(partial);
    format!("the run came to no end; its first {rows} rows are in {partial}")
}

/// The largest number of scans of this script whose rows are kept.
fn kept_at_most(script: &Script, outcome: &Outcome) -> u64 {
    let columns = outcome.trace.columns().len().max(1) as u64;
    ROWS_MAX.min(CELLS_MAX / columns).min(script.scans)
}

/// Pages, pictures and waveforms need rows that are kept.
fn draws_nothing(name: &str, script: &Script, arguments: &RunArguments) -> Result<(), Failure> {
    let files = [
        ("--report", &arguments.report),
        ("--svg", &arguments.svg),
        ("--vcd", &arguments.vcd),
    ];
    let Some((option, _)) = files.iter().find(|(_, file)| file.is_some()) else {
        return Ok(());
    };
    Err(Failure::usage(&format!(
        "{option} needs all rows at once, and {name} has {} scans: at most {ROWS_MAX} with {CELLS_MAX} cells are kept; lower \
         `scans`, or write them with --trace",
        script.scans
    )))
}
