//! `standstill watch`: a script in a terminal, run and stepped by keys.

use crate::args::WatchArguments;
use crate::exit::{Exit, Failure};
#[cfg(any(unix, windows))]
use crate::failing::with_ending;
#[cfg(any(unix, windows))]
use standstill_script::suite::{self, shown};
use std::io::Write;

/// The replacement on systems without a terminal.
#[cfg(not(any(unix, windows)))]
pub fn watch(_: &WatchArguments, _: &mut dyn Write) -> Result<Exit, Failure> {
    Err(Failure::usage(
        "watch needs a terminal, and this build of standstill has none: `standstill run` shows the run as text",
    ))
}

/// Watches the script until a key or a signal ends it, then prints the result so far.
#[cfg(any(unix, windows))]
pub fn watch(arguments: &WatchArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
    use standstill_script::suite::SuiteError;
    use standstill_watch::App;
    use std::io::{self, IsTerminal};

    let WatchArguments {
        script: path,
        set,
        outside,
    } = arguments;
    let name = shown(path);
    let (script, text) = suite::read_counted(path, set, &outside.allowed()).map_err(crate::run::failure)?;
    let save = Box::new(|changes: &[_]| save(path, &text, !set.is_empty(), changes));
    let mut app = App::new(&script, &name, save).map_err(|source| SuiteError::Run {
        path: path.clone(),
        source,
    })?;
    for (stream, is_terminal) in [
        ("input", io::stdin().is_terminal()),
        ("output", io::stdout().is_terminal()),
    ] {
        if !is_terminal {
            return Err(Failure::usage(&format!(
                "watch needs a terminal, and standard {stream} is none: `standstill run` shows the run as text"
            )));
        }
    }
    crate::limit::doing(name.as_str());
    crate::limit::before_end(standstill_watch::give_back);
    let color = std::env::var_os("NO_COLOR").is_none_or(|value| value.is_empty());
    let ended =
        standstill_watch::watch(&mut app, color).map_err(|error| Failure::io("the terminal", &error))?;
    ended
        .pass_on()
        .map_err(|error| Failure::io("the signal", &error))?;
    let (held, failed, open) = app.tally();
    let scans = app.scans();
    if let Some(why) = app.broken() {
        return Err(Failure::Told(Exit::BadInput, format!("error: {name}: {why}")));
    }
    writeln!(
        out,
        "{name}: {scans} of {} scans, {held} claims hold, {failed} fail, {open} open",
        script.scans
    )?;
    Ok(Exit::of(failed == 0))
}

/// Writes the changed run as a script beside the watched one, under an unused name; returns the message.
#[cfg(any(unix, windows))]
fn save(
    path: &std::path::Path,
    text: &str,
    parameters: bool,
    changes: &[standstill_script::Change],
) -> Result<String, String> {
    if parameters {
        return Err("--set is in force; write its values into the script first".to_owned());
    }
    let script =
        standstill_script::with_changes(text, &shown(path), changes).map_err(|error| error.to_string())?;
    // Two extensions are one too many for `with_extension`.
    let stem = path.with_extension("").with_extension("");
    let mut number = 1;
    let target = loop {
        let end = if number == 1 {
            String::new()
        } else {
            format!("-{number}")
        };
        let target = with_ending(&stem, &format!("watched{end}{}", suite::EXTENSION));
        // A link to a missing file is also a name in use.
        if std::fs::symlink_metadata(&target).is_err() {
            break target;
        }
        number += 1;
    };
    standstill_trace::file::replace_beside(&target, |out| out.write_all(script.as_bytes()))
        .map_err(|error| error.to_string())?;
    Ok(format!("written: {}", shown(&target)))
}
