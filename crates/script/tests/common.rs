//! What many of the tests need: a script, its run, and where the scan tests are.

use standstill_script::model::Script;
use standstill_script::{Outcome, read, run};
use std::path::{Path, PathBuf};

/// A good script.
pub fn script(text: &str) -> Script {
    read(text, "test.scan.json", &[]).unwrap_or_else(|error| panic!("{error}"))
}

/// The run of a good script.
pub fn outcome(text: &str) -> Outcome {
    run(&script(text)).unwrap_or_else(|error| panic!("{error}"))
}

/// What speaks against the claims of a run.
pub fn failures(outcome: &Outcome) -> Vec<String> {
    let failures = outcome.verdicts.iter().flat_map(|verdict| &verdict.failures);
    failures.map(ToString::to_string).collect()
}

pub fn scan_tests() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scan-tests")
}
