//! Completes and checks the book that mdBook built: `cargo run -p standstill-xtask --example book target/book`.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("error: the folder of the book must be given");
        return ExitCode::from(2);
    };
    let checked = Path::new(&folder)
        .canonicalize()
        .and_then(|folder| standstill_xtask::book::complete(&folder));
    match checked {
        Ok(problems) if problems.is_empty() => ExitCode::SUCCESS,
        Ok(problems) => {
            eprintln!("{}", problems.join("\n"));
            ExitCode::FAILURE
        }
        Err(error) => {
            eprintln!("error: {folder}: {error}");
            ExitCode::from(4)
        }
    }
}
