//! `standstill run`: one or more scripts, shown to a person.

use crate::apart;
use crate::args::RunArguments;
use crate::exit::{Exit, Failure, complain, go_on};
use crate::failing;
use crate::json::Object;
use crate::limit;
use crate::long;
use crate::outcome;
use crate::progress::Progress;
use crate::report::{self, Targets};
use standstill_picture::plot;
use standstill_report::Source;
use standstill_script::bare::{Bare, run_bare};
use standstill_script::model::Script;
use standstill_script::suite::{self, Allowed, Reasons, SuiteError};
use standstill_script::{Code, Outcome, ScriptError, keeps_rows, run_with, warnings};
use standstill_trace::csv::Dialect;
use standstill_trace::{Header, Trace, digest, events_text, extremes_text, file};
use std::io::{self, Write};
use std::path::{Path, PathBuf};

/// Width of drawings (characters). It does not follow the terminal: the output is the same everywhere.
const WIDTH: usize = 100;

/// Runs the scripts in the given order. A script that cannot be run does not prevent the others.
pub fn run(arguments: &RunArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    let dialect = checked(arguments)?;
    let texts = arguments.scripts.iter().filter(|path| is_text(path)).count();
    let options = [
        ("--axes", arguments.axes.is_some()),
        ("--program", arguments.program.is_some()),
        ("--cycle", arguments.cycle.is_some()),
        ("--scans", arguments.scans.is_some()),
    ];
    let option = options.iter().find(|(_, given)| *given);
    match (texts, option) {
        (0, None) => {}
        (0, Some((option, _))) => {
            let message =
                format!("{option} is for programs in Structured Text (.st): a script says it itself");
            return Err(Failure::usage(&message));
        }
        _ if texts < arguments.scripts.len() => {
            return Err(Failure::usage(
                "scripts and files of Structured Text do not run together: a script names its programs itself",
            ));
        }
        _ => {}
    }
    if !arguments.json {
        return all(arguments, dialect, &mut Vec::new(), out);
    }
    let mut told = Vec::new();
    let exit = all(arguments, dialect, &mut told, &mut io::sink())?;
    writeln!(out, "{}", outcome::whole("run", exit, &[], &told))?;
    Ok(exit)
}

/// Runs all scripts, prints them as text, and collects their JSON.
fn all(
    arguments: &RunArguments,
    dialect: Dialect,
    told: &mut Vec<Object>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    if arguments.scripts.iter().any(|path| is_text(path)) {
        return run_text(arguments, dialect, told, out);
    }
    let mut exit = Exit::Passed;
    for (index, script) in arguments.scripts.iter().enumerate() {
        if index > 0 && !arguments.quiet {
            writeln!(out)?;
        }
        let this = run_one(script, arguments, dialect, told, out);
        if let Err(Failure::Told(_, text)) = &this {
            told.push(outcome::broken(&suite::shown(script), text));
        }
        exit = exit.max(go_on(this, out)?);
    }
    Ok(exit)
}

/// Checks that clap cannot do: whether the arguments fit together. Returns the dialect of the trace.
fn checked(arguments: &RunArguments) -> Result<Dialect, Failure> {
    let RunArguments {
        scripts,
        trace,
        report,
        svg,
        vcd,
        ..
    } = arguments;
    let files = [
        ("--trace", trace),
        ("--report", report),
        ("--svg", svg),
        ("--vcd", vcd),
    ];
    let one = files.iter().find(|(_, file)| file.is_some() && scripts.len() > 1);
    if let Some((option, _)) = one {
        return Err(Failure::usage(&format!(
            "{option} takes one script: one file cannot hold several runs"
        )));
    }
    let writes = [
        apart::trace(trace.as_deref())?,
        apart::written("--report", report.as_deref()),
        apart::written("--svg", svg.as_deref()),
        apart::written("--vcd", vcd.as_deref()),
    ];
    let reads = scripts.iter().chain(&arguments.axes);
    apart::checked(&writes.concat(), reads.map(PathBuf::as_path))?;
    let asks = arguments.delimiter.is_some() || arguments.decimal_comma;
    if asks && trace.as_ref().is_some_and(|path| !file::is_csv(path)) {
        return Err(Failure::usage(
            "--delimiter and --decimal-comma are for a trace that is a .csv file",
        ));
    }
    let decimal_comma = arguments.decimal_comma;
    match arguments
        .delimiter
        .unwrap_or(if decimal_comma { ';' } else { ',' })
    {
        ',' if decimal_comma => Err(Failure::usage(
            "--decimal-comma needs another delimiter than the comma",
        )),
        delimiter => Ok(Dialect {
            delimiter,
            decimal_comma,
        }),
    }
}

fn is_text(path: &Path) -> bool {
    path.extension()
        .is_some_and(|ending| ending.eq_ignore_ascii_case("st"))
}

/// Runs a program in Structured Text without a script.
fn run_text(
    arguments: &RunArguments,
    dialect: Dialect,
    told: &mut Vec<Object>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    const SCANS: u64 = 1000;
    const CYCLE_NS: i64 = 1_000_000;
    for path in arguments.scripts.iter().chain(&arguments.axes) {
        std::fs::metadata(path).map_err(|error| Failure::io(&suite::shown(path), &error))?;
    }
    let name = arguments
        .scripts
        .last()
        .map_or_else(String::new, |path| suite::shown(path));
    let bare = Bare {
        sources: &arguments.scripts,
        axes: arguments.axes.as_deref(),
        program: arguments.program.as_deref(),
        cycle_ns: arguments.cycle.unwrap_or(CYCLE_NS),
        scans: arguments.scans.unwrap_or(SCANS),
    };
    let run = {
        let mut progress = Progress::new(!arguments.quiet);
        limit::doing(name.clone());
        run_bare(bare, &arguments.set, &arguments.outside.allowed(), |scans| {
            limit::doing(format!("{name}: {scans} scans"));
            progress.show(|| format!("{name}: {scans} scans"))
        })
    };
    let (script, outcome) = run.map_err(failure)?;
    tell(&name, (&script, &outcome), arguments, dialect, told, out)
}

fn run_one(
    script: &Path,
    arguments: &RunArguments,
    dialect: Dialect,
    told: &mut Vec<Object>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let (path, name) = (script, suite::shown(script));
    limit::doing(name.clone());
    let allowed = Allowed {
        long: true,
        ..arguments.outside.allowed()
    };
    let (script, _) = suite::read_file(path, &arguments.set, &allowed).map_err(failure)?;
    if !keeps_rows(&script) {
        return long::run(path, (&name, &script), arguments, dialect, told, out);
    }
    let run = {
        let mut progress = Progress::new(!arguments.quiet);
        run_with(&script, |scans| {
            limit::doing(format!("{name}: {scans} scans"));
            progress.show(|| format!("{name}: {scans} scans"))
        })
    };
    let outcome = run.map_err(|source| {
        failure(SuiteError::Run {
            path: path.to_owned(),
            source,
        })
    })?;
    tell(&name, (&script, &outcome), arguments, dialect, told, out)
}

/// Prints the result of a run, and writes its files.
fn tell(
    name: &str,
    (script, outcome): (&Script, &Outcome),
    arguments: &RunArguments,
    dialect: Dialect,
    told: &mut Vec<Object>,
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    // The golden is not used here, but the script has one.
    let warnings = warnings(script, outcome, script.golden);
    let digest = digest::whole(&outcome.trace);
    if arguments.json {
        told.push(outcome::run(name, outcome, digest, &warnings));
    }
    if arguments.quiet {
        write!(out, "{}", failing_claims(outcome))?;
    } else {
        show(name, outcome, out)?;
    }
    writeln!(out, "{name}: {}", verdict(outcome, digest))?;
    if !warnings.all.is_empty() {
        out.flush()?;
        complain(warnings.to_string().trim_end());
    }
    if let Some(path) = &arguments.trace {
        file::save_as(&outcome.trace, path, dialect)?;
    }
    let source = Source {
        name,
        trace: &outcome.trace,
        lacks: &[],
    };
    let targets = Targets {
        html: arguments.report.as_deref(),
        svg: arguments.svg.as_deref(),
        vcd: arguments.vcd.as_deref(),
    };
    let mark = failing::why_mark(&outcome.why);
    report::write_all(&[source], &Vec::from_iter(mark), targets)?;
    Ok(Exit::of(outcome.passed()))
}

/// A name after `--set` that is no parameter of the script is a mistake of the command line, not of the
/// script.
pub fn failure(error: SuiteError) -> Failure {
    let is_argument = |script: &ScriptError| {
        let mut diagnostics = script.diagnostics().iter();
        diagnostics.all(|diagnostic| diagnostic.code == Code::UnknownParameter && diagnostic.span.is_none())
    };
    match error {
        SuiteError::Script(script) if is_argument(&script) => Failure::Told(Exit::Usage, script.to_string()),
        other => other.into(),
    }
}

/// Header, events, drawing, extremes, failing claims.
fn show(name: &str, outcome: &Outcome, out: &mut dyn Write) -> Result<(), Failure> {
    let trace = &outcome.trace;
    title(name, trace, out)?;
    writeln!(out, "\nevents\n{}", events_text(trace))?;
    writeln!(out, "{}", plot(trace, WIDTH))?;
    writeln!(out, "{}", extremes_text(trace))?;
    let failing = failing_claims(outcome);
    if !failing.is_empty() {
        writeln!(out, "failing claims\n{failing}")?;
    }
    Ok(())
}

/// The title of the run, and its axes.
pub fn title(name: &str, trace: &Trace, out: &mut dyn Write) -> Result<(), Failure> {
    let Header { title, axes, .. } = trace.header();
    writeln!(out, "{}", if title.is_empty() { name } else { title })?;
    for axis in axes {
        let unit = if axis.unit.is_empty() {
            String::new()
        } else {
            format!(" ({})", axis.unit)
        };
        writeln!(out, "axis {}{unit}: order {}", axis.name, axis.order)?;
    }
    Ok(())
}

/// The claims that fail, and the reasons, indented.
pub fn failing_claims(outcome: &Outcome) -> String {
    let failures = outcome.verdicts.iter().flat_map(|verdict| &verdict.failures);
    let failures: String = failures.map(|failure| format!("{failure}\n")).collect();
    let text = format!("{failures}{}", Reasons(&outcome.why));
    text.lines().map(|line| format!("  {line}\n")).collect()
}

/// The last line: the number of claims that hold, the length of the run, and one digest over every bit,
/// which reads each of them.
pub fn verdict(outcome: &Outcome, digest: u64) -> String {
    let (trace, verdicts) = (&outcome.trace, &outcome.verdicts);
    let held = verdicts.iter().filter(|verdict| verdict.passed()).count();
    let word = if outcome.passed() { "passed" } else { "FAILED" };
    format!(
        "{word}, {held} of {} claims, {} scans, digest {digest:016x}",
        verdicts.len(),
        trace.scans()
    )
}
