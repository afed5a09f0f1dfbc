//! Bytes as a hostile WebAssembly guest: any block with any addresses, sizes, counts and pins, texts and records
//! anywhere, variables at any address. `crates/guest/tests/memory.rs` does the same with random bytes.
#![no_main]

use libfuzzer_sys::fuzz_target;

#[path = "../../../guest/tests/hostile/mod.rs"]
mod hostile;

fuzz_target!(|bytes: &[u8]| {
    let _played = hostile::play(bytes);
});
