//! A script with the changes that were made while its run was watched.

use crate::error::ScriptError;
use crate::format::format;
use crate::read::json::{self, Json};
use crate::run::Change;
use std::fmt::Write;

/// The text of a script with these changes as steps behind its own, in the canonical layout. Its run
/// repeats the one in which they were made.
///
/// # Errors
/// [`ScriptError`] if the text is no strict JSON.
pub fn with_changes(text: &str, file_name: &str, changes: &[Change]) -> Result<String, ScriptError> {
    let (plain, root) = json::file(text, file_name)?;
    let mut steps = String::new();
    // Changes of one scan are one step.
    for (index, same) in changes.chunk_by(|a, b| a.scan == b.scan).enumerate() {
        let comma = if index == 0 { "" } else { ", " };
        let scan = same.first().map_or(0, |change| change.scan);
        // Writing to a String cannot fail.
        let _ = write!(steps, "{comma}{{\"at\": {scan}, \"set\": {{");
        for (index, change) in same.iter().enumerate() {
            // If there are several values for one point, the last counts, because a key may occur only
            // once.
            let later = same.get(index + 1..).unwrap_or_default();
            if later.iter().any(|later| later.point == change.point) {
                continue;
            }
            let comma = if steps.ends_with('{') { "" } else { ", " };
            let _ = write!(steps, "{comma}\"{}\": {}", change.name, change.json);
        }
        steps.push_str("}}");
    }
    let (place, insert) = match root.member("steps") {
        Some(node) => {
            let empty = matches!(&node.json, Json::List(items) if items.is_empty());
            (
                node.span.end - 1,
                if empty { steps } else { format!(", {steps}") },
            )
        }
        None => (root.span.end - 1, format!(", \"steps\": [{steps}]")),
    };
    let (before, after) = plain.split_at(place);
    format(&format!("{before}{insert}{after}"), file_name)
}
