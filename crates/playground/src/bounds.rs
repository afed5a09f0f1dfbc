//! The limits of the playground. Those of the command line are higher.

use standstill_script::model::Script;

/// Largest number of bytes of a script with the files that it names.
pub const BYTES_MAX: usize = 1 << 20;

/// Largest number of scans of a run; a quarter of an hour at 1 ms.
pub const SCANS_MAX: u64 = 1_000_000;

/// Largest number of cells of a run, that is scans times columns: 8 bytes each.
pub const CELLS_MAX: u64 = 20_000_000;

/// Largest number of block instances.
pub const BLOCKS_MAX: usize = 2_000;

/// Largest number of instructions that the calls of all programs may take in one scan.
pub const FUEL_MAX: u64 = 20_000_000;

/// Largest number of lines to plan at once.
pub const LINES_MAX: usize = 200;

/// Largest number of characters of a link's fragment that are read.
pub const LINK_MAX: usize = 1 << 17;

/// The remedy for a script that is too large.
const REMEDY: &str = "the command line takes more";

/// Refuses texts with too many bytes.
pub fn bytes(bytes: usize) -> Result<(), String> {
    within("bytes of text", bytes as u64, BYTES_MAX as u64)
}

/// Refuses a script that is too large to run.
pub fn script(script: &Script) -> Result<(), String> {
    within("scans", script.scans, SCANS_MAX)?;
    within("blocks", script.blocks.len() as u64, BLOCKS_MAX as u64)?;
    let calls = script.programs.iter().map(|program| {
        let calls = program.calls.len().max(1) as u64;
        program.guest.settings().fuel.saturating_mul(calls)
    });
    let fuel = calls.fold(0, u64::saturating_add);
    within("instructions of programs in a scan (`fuel`)", fuel, FUEL_MAX)
}

/// Refuses a trace with too many cells.
pub fn cells(scans: u64, columns: usize) -> Result<(), String> {
    within(
        "cells (scans times columns)",
        scans.saturating_mul(columns as u64),
        CELLS_MAX,
    )
}

/// Refuses too many lines to plan.
pub fn lines(lines: usize) -> Result<(), String> {
    within("lines", lines as u64, LINES_MAX as u64)
}

fn within(what: &str, found: u64, most: u64) -> Result<(), String> {
    if found <= most {
        return Ok(());
    }
    Err(format!(
        "{found} {what} are more than the {most} of the playground; {REMEDY}"
    ))
}
