//! Bytes as the text of a program in Structured Text. `crates/st/tests/damage` does the same with random damage to programs of the
//! repository. Run with bounds: `-timeout=10 -rss_limit_mb=512`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../../st/tests/damage/play.rs"]
mod play;

fuzz_target!(|bytes: &[u8]| play::play(bytes));
