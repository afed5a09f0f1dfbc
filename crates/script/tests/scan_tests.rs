//! Every script under `scan-tests` is one test, called by its path there without extension.
//!
//! A new script needs no registration. `docs/scan-scripts.md` explains failing tests and the acceptance
//! of goldens; `standstill test` judges by the same code.

use libtest_mimic::{Arguments, Failed, Trial};
use standstill_script::golden::Mode;
use standstill_script::suite::{self, Allowed};
use standstill_trace::compare::Yardstick;
use std::path::{Path, PathBuf};
use std::process::ExitCode;

fn main() -> ExitCode {
    match trials() {
        Ok(trials) => libtest_mimic::run(&Arguments::from_args(), trials).exit_code(),
        Err(error) => {
            eprintln!("{error}");
            ExitCode::FAILURE
        }
    }
}

fn trials() -> Result<Vec<Trial>, Box<dyn std::error::Error>> {
    let folder = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scan-tests")
        .canonicalize()?;
    let mode = Mode::from_environment(false)?;
    let scripts = suite::find(&folder)?;
    let mut trials: Vec<_> = scripts
        .into_iter()
        .map(|script| Trial::test(suite::name(&folder, &script), move || judge(&script, mode)))
        .collect();
    trials.push(Trial::test("no_orphans", move || no_orphans(&folder)));
    Ok(trials)
}

fn judge(script: &Path, mode: Mode) -> Result<(), Failed> {
    let report = suite::judge_file(script, mode, Yardstick::Exact, &Allowed::default(), |_| {})?;
    if report.passed() && !report.warnings.count() {
        Ok(())
    } else {
        Err(format!("{report}{}", report.warnings).into())
    }
}

fn no_orphans(folder: &Path) -> Result<(), Failed> {
    let orphans: Vec<PathBuf> = suite::orphans(folder)?;
    if orphans.is_empty() {
        return Ok(());
    }
    let names: Vec<_> = orphans.iter().map(|file| suite::shown(file)).collect();
    Err(format!("no script stands beside these; delete them: {}", names.join(", ")).into())
}
