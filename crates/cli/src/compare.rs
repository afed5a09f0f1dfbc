//! `standstill compare`: compares a trace with the recording of a machine.

use crate::exit::{Exit, Failure, complain};
use crate::limit;
use standstill_script::read_map;
use standstill_script::suite::shown;
use standstill_trace::{file, foreign, machine};
use std::fs;
use std::io::Write;
use std::path::Path;

/// Compares `trace` with `recording`, as `map` says.
pub fn compare(recording: &Path, trace: &Path, map: &Path, out: &mut dyn Write) -> Result<Exit, Failure> {
    let (recording_name, trace_name, map_name) = (shown(recording), shown(trace), shown(map));
    limit::doing(format!("holding {trace_name} against {recording_name}"));
    let text = fs::read_to_string(map).map_err(|error| Failure::io(&map_name, &error))?;
    let loaded = file::load(trace)?.trace;
    let map = read_map(&text, &map_name, &loaded)
        .map_err(|error| Failure::Told(Exit::BadInput, error.to_string()))?;
    let bytes = fs::read(recording).map_err(|error| Failure::io(&recording_name, &error))?;
    let bad = |message: String| Failure::Told(Exit::BadInput, format!("error: {recording_name}: {message}"));
    let text = foreign::decode(&bytes)
        .ok_or_else(|| bad("this is no text: export the recording as CSV".to_owned()))?;
    let recorded =
        foreign::read(&text, &map.layout, &map.wanted()).map_err(|error| bad(error.to_string()))?;
    if recorded.open_end {
        complain(&format!(
            "note: {recording_name}: the last line has no end; if the file was cut short, its last number may have \
             lost digits"
        ));
    }
    let comparison = machine::compare(&recorded, &loaded, &map).map_err(|error| {
        Failure::Told(
            Exit::BadInput,
            format!("error: {recording_name} and {trace_name}: {error}"),
        )
    })?;
    writeln!(out, "recording  {recording_name}, {recorded}")?;
    write!(out, "{comparison}")?;
    let holding = comparison.signals.iter().filter(|signal| signal.finding.holds());
    let (verdict, count) = (
        if comparison.holds() { "passed" } else { "FAILED" },
        holding.count(),
    );
    writeln!(out, "{verdict}, {count} of {} signals", comparison.signals.len())?;
    Ok(Exit::of(comparison.holds()))
}
