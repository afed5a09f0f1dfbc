//! Bytes as a file: scripts, machine files, sweeps, maps, tables and JSON Lines (traces, dumps of recorders,
//! recordings of machines), exact traces, goldens, lines of plans. The first byte selects the format.
//! `crates/cli/tests/formats` does the same with random damage to files of the repository. Run with bounds:
//! `-timeout=10 -rss_limit_mb=512 -malloc_limit_mb=256`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../../cli/tests/formats/play.rs"]
mod play;

fuzz_target!(|bytes: &[u8]| {
    if let Some((format, bytes)) = bytes.split_first() {
        play::play(*format, bytes);
    }
});
