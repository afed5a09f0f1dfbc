//! Bytes as the text of a program in Structured Text. `crates/st/tests/damage` does the same with random damage to programs of the
//! repository. Run with bounds: `-timeout=10 -rss_limit_mb=512`.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../../st/tests/damage/play.rs"]
mod play;

fn is_valid(module: &[u8]) {
    wasmparser::validate(module).expect("a valid module");
}

fuzz_target!(|bytes: &[u8]| play::play(bytes, is_valid));
