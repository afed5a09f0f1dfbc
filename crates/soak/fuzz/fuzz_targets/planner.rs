//! Chains of replans that libFuzzer makes: every plan is checked against the claims about plans.

#![no_main]

use libfuzzer_sys::fuzz_target;

fuzz_target!(|bytes: &[u8]| {
    if let Err(line) = standstill_soak::fuzz(bytes) {
        panic!("{line}");
    }
});
