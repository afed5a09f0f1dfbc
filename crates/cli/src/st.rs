//! `standstill st`: the compiler of Structured Text, its messages and its modules.

use crate::apart;
use crate::args::StSources;
use crate::exit::{Exit, Failure, complain};
use crate::json::{Object, list, string};
use crate::{limit, outcome};
use standstill_script::suite::shown;
use standstill_st::{
    Diagnostic, Dialect, FAULT_SITE, FAULT_VALUE, LOOP_SITE, Options, Report, Severity, Source, Symbols,
    Value,
};
use standstill_trace::file::{replace, replace_beside};
use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};

/// Largest number of variables that a file of symbols lists.
const SYMBOLS_MOST: usize = 65_536;

/// The files of a project: their names and texts.
fn read(paths: &[PathBuf]) -> Result<Vec<(String, Vec<u8>)>, Failure> {
    let read = |path: &PathBuf| {
        let name = shown(path);
        limit::doing(format!("reading {name}"));
        let bytes = fs::read(path).map_err(|error| Failure::io(&name, &error))?;
        Ok((name, bytes))
    };
    paths.iter().map(read).collect()
}

/// The files in a few words.
fn named(files: &[(String, Vec<u8>)]) -> String {
    match files {
        [(name, _)] => name.clone(),
        [(first, _), others @ ..] => format!("{first} and {} more", others.len()),
        [] => "nothing".to_owned(),
    }
}

fn sources(files: &[(String, Vec<u8>)]) -> Vec<Source<'_>> {
    files.iter().map(|(name, bytes)| Source { name, bytes }).collect()
}

/// The names and numbers of another system, if one is named.
pub fn dialect(name: Option<&str>) -> Result<Dialect, Failure> {
    use standstill_export::Dialect as Known;
    let Some(name) = name else {
        let others = Known::known().filter_map(|name| Known::new(name).ok());
        return Ok(Dialect {
            others: others.map(|known| names_of(&known)).collect(),
            ..Dialect::default()
        });
    };
    let known = Known::new(name).map_err(|error| Failure::usage(&error.to_string()))?;
    Ok(names_of(&known))
}

fn names_of(known: &standstill_export::Dialect) -> Dialect {
    Dialect {
        name: known.name().to_owned(),
        types: known.types().to_vec(),
        elements: known.names().to_vec(),
        numbers: known.numbers().to_vec(),
        pins: known.pins().to_vec(),
        others: Vec::new(),
    }
}

/// Prints errors and warnings, with or without lints; a lint is a failure.
pub fn check(given: &StSources, json: bool, lint: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let files = read(&given.files)?;
    let options = Options {
        program: given.program.clone(),
        library: true,
        lint,
        dialect: dialect(given.dialect.as_deref())?,
        ..Options::default()
    };
    limit::doing(format!("checking {}", named(&files)));
    let report = standstill_st::check(&sources(&files), &options);
    let exit = if report.has_errors() {
        Exit::BadInput
    } else if lint && !report.diagnostics().is_empty() {
        Exit::Failed
    } else {
        Exit::Passed
    };
    if json {
        let told = report.diagnostics().iter().map(|it| diagnostic(&report, it));
        let object = outcome::begun(if lint { "st lint" } else { "st check" }, exit)
            .with("hidden", report.hidden().to_string())
            .with("diagnostics", list(told));
        writeln!(out, "{}", object.text())?;
    } else if !report.diagnostics().is_empty() {
        writeln!(out, "{report}")?;
    }
    Ok(exit)
}

fn diagnostic(report: &Report, it: &Diagnostic) -> String {
    let (from, to) = report.positions(it.span);
    let severity = match it.severity {
        Severity::Error => "error",
        Severity::Warning => "warning",
    };
    Object::new()
        .with("file", string(report.file_name(it.span)))
        .with("line", from.line.to_string())
        .with("column", from.column.to_string())
        .with("end_line", to.line.to_string())
        .with("end_column", to.column.to_string())
        .with("severity", string(severity))
        .with("code", string(it.code.name()))
        .with("message", string(&it.message))
        .with_some("help", it.help.as_deref().map(string))
        .text()
}

/// Lays out the files in place and names those that changed. With `check` nothing is written, and a file
/// that would change fails. A file that cannot be read as Structured Text is not changed.
pub fn lay_out(paths: &[PathBuf], check: bool, out: &mut dyn Write) -> Result<Exit, Failure> {
    let mut exit = Exit::Passed;
    for ((name, bytes), path) in read(paths)?.iter().zip(paths) {
        limit::doing(format!("laying out {name}"));
        let canonical = standstill_st::format(name, bytes)
            .map_err(|report| Failure::Told(Exit::BadInput, report.render()))?;
        if canonical.as_bytes() == bytes {
            continue;
        }
        if !check {
            replace_beside(path, |out| out.write_all(canonical.as_bytes()))?;
        }
        writeln!(out, "{name}")?;
        exit = exit.max(Exit::of(!check));
    }
    Ok(exit)
}

/// Compiles to a module, and writes its symbols beside it.
pub fn build(
    given: &StSources,
    output: &Path,
    axes: &[String],
    out: &mut dyn Write,
) -> Result<Exit, Failure> {
    let table = output.with_extension("symbols.json");
    let writes = [
        apart::written("--output", Some(output)),
        apart::written("the file of symbols", Some(&table)),
    ];
    apart::checked(&writes.concat(), given.files.iter().map(PathBuf::as_path))?;
    let files = read(&given.files)?;
    let options = Options {
        program: given.program.clone(),
        axes: axes.to_vec(),
        dialect: dialect(given.dialect.as_deref())?,
        ..Options::default()
    };
    limit::doing(format!("compiling {}", named(&files)));
    let compiled = standstill_st::compile(&sources(&files), &options)
        .map_err(|report| Failure::Told(Exit::BadInput, report.render()))?;
    if !compiled.report.diagnostics().is_empty() {
        complain(&compiled.report.render());
    }
    replace(&table, |file| writeln!(file, "{}", symbols(&compiled.symbols)))?;
    replace(output, |file| file.write_all(&compiled.wasm))?;
    writeln!(out, "{}\n{}", shown(output), shown(&table))?;
    Ok(Exit::Passed)
}

fn symbols(symbols: &Symbols) -> String {
    let variables = symbols.leaves(SYMBOLS_MOST).into_iter().map(|symbol| {
        let elements = match symbol.value {
            Value::Plain | Value::Range(..) => None,
            Value::Element(elements) => {
                let pair = |(name, number): (String, i128)| {
                    Object::new()
                        .with("name", string(&name))
                        .with("number", number.to_string())
                        .text()
                };
                Some(list(elements.into_iter().map(pair)))
            }
        };
        Object::new()
            .with("path", string(&symbol.path))
            .with("type", string(symbol.ty.name()))
            .with("address", symbol.address.to_string())
            .with("section", string(section(symbol.section)))
            .with("retain", symbol.retain.to_string())
            .with_some("at", symbol.at.as_deref().map(string))
            .with_some("elements", elements)
            .text()
    });
    let places = symbols.places().iter().map(|place| {
        Object::new()
            .with("file", string(&place.file))
            .with("line", place.position.line.to_string())
            .with("column", place.position.column.to_string())
            .with("kind", string(place.kind.text()))
            .text()
    });
    let named = symbols.tasks().iter().filter(|task| !task.name.is_empty());
    let tasks = named.map(|task| {
        Object::new()
            .with("name", string(&task.name))
            .with_some("interval_ns", task.interval_ns.map(|ns| ns.to_string()))
            .with("priority", task.priority.to_string())
            .text()
    });
    Object::new()
        .with("standstill_json", "1")
        .with("fault_site", FAULT_SITE.to_string())
        .with("fault_value", FAULT_VALUE.to_string())
        .with("loop_site", LOOP_SITE.to_string())
        .with("tasks", list(tasks))
        .with("variables", list(variables))
        .with("places", list(places))
        .text()
}

const fn section(section: standstill_st::Section) -> &'static str {
    use standstill_st::Section;
    match section {
        Section::Global => "global",
        Section::Input => "input",
        Section::Output => "output",
        Section::Internal => "internal",
    }
}
