//! Links the book's pages to the playground beside it, and checks that: `cargo run -p standstill-xtask --example site target/site`.

use std::path::Path;
use std::process::ExitCode;

fn main() -> ExitCode {
    let Some(folder) = std::env::args().nth(1) else {
        eprintln!("error: the folder of the site must be given");
        return ExitCode::from(2);
    };
    let site = Path::new(&folder);
    let linked = standstill_xtask::site::link(site).and_then(|links| {
        let mut problems = standstill_xtask::site::problems(site)?;
        if links == 0 {
            problems.push("no page of the book links to the playground".to_owned());
        }
        Ok(problems)
    });
    match linked {
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
