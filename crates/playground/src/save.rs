//! A run as a file to keep.

use crate::project::{Project, refused};
use crate::runs::run_project;
use serde_json::{Value, json};
use standstill_picture as picture;
use standstill_report::{Source, html};
use standstill_trace::{Trace, csv, vcd};

/// Runs the script and returns the file that the command line would write: `form` is `csv`, `vcd`, `svg`
/// or `report`. The answer is `{"text": ".."}`, or that of [`check`](crate::check).
#[must_use]
pub fn save(request: &str, form: &str) -> String {
    let saved = Project::read(request).and_then(|project| {
        let (outcome, _) = run_project(&project, &mut |_, _| true)?;
        file(project.name(), &outcome.trace, form)
    });
    match saved {
        Ok(text) => json!({"text": text}),
        Err(wrong) => wrong,
    }
    .to_string()
}

fn file(name: &str, trace: &Trace, form: &str) -> Result<String, Value> {
    let mut bytes = Vec::new();
    let written = match form {
        "csv" => csv::write(trace, &mut bytes),
        "vcd" => vcd::write(trace, &mut bytes),
        "svg" => return Ok(picture::report(trace)),
        "report" => {
            let source = Source {
                name,
                trace,
                lacks: &[],
            };
            return html(&[source]).map_err(|error| refused(&error.to_string()));
        }
        other => return Err(refused(&format!("no form {other}: csv, vcd, svg or report"))),
    };
    written.map_err(|error| refused(&error.to_string()))?;
    String::from_utf8(bytes).map_err(|error| refused(&error.to_string()))
}
