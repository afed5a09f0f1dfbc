//! Goldens, as far as the fault guide needs them.

use crate::{files_below, read, root, slashed};
use serde_json::Value;
use std::collections::BTreeMap;

/// A line of a golden's events.
#[derive(Debug)]
pub struct Event {
    pub scan: usize,
    /// An instance or an axis.
    pub subject: String,
    pub text: String,
}

impl Event {
    /// Whether it shows this error, at a pin or as a record.
    pub fn shows(&self, number: u16) -> bool {
        let is_it = |text: &str| text.parse() == Ok(number);
        let mut words = self.text.split(' ');
        let mut record = words.clone();
        (record.next() == Some("fault") && record.next().is_some_and(is_it))
            || words.any(|word| {
                let pin = word.strip_prefix("Axis").unwrap_or(word);
                pin.strip_prefix("ErrorID=").is_some_and(is_it)
            })
    }
}

/// The title of a script and the events of its run.
#[derive(Debug)]
pub struct Golden {
    pub title: String,
    pub events: Vec<Event>,
}

/// Every golden by its script, relative to `scan-tests/` and without extension.
pub fn goldens() -> BTreeMap<String, Golden> {
    let mut found = BTreeMap::new();
    for path in files_below(&root().join("scan-tests")).expect("a folder of the repository") {
        let path = slashed(&path);
        let name = path.strip_prefix("scan-tests/");
        if let Some(name) = name.and_then(|name| name.strip_suffix(".snap")) {
            found.insert(name.to_owned(), golden(&read(&path)));
        }
    }
    found
}

/// The instances of a script with the names of their blocks; those of included files and of programs are left out.
pub fn blocks(script: &str) -> BTreeMap<String, String> {
    let text = read(&format!("scan-tests/{script}.scan.json"));
    let script: Value = serde_json::from_str(&text).unwrap_or_default();
    let blocks = script["blocks"].as_array().into_iter().flatten();
    blocks
        .filter_map(|block| {
            let (name, of_type) = (block["name"].as_str()?, block["type"].as_str()?);
            let info = standstill_blocks::registry::find(of_type)?;
            Some((name.into(), info.name.into()))
        })
        .collect()
}

/// Events are below a line `events`, up to an empty line: scan, subject, text.
fn golden(text: &str) -> Golden {
    let title = text.lines().find_map(|line| line.strip_prefix("title "));
    let events = text.lines().skip_while(|line| *line != "events").skip(1);
    Golden {
        title: title.unwrap_or_default().trim().into(),
        events: events
            .take_while(|line| !line.is_empty())
            .filter_map(event)
            .collect(),
    }
}

fn event(line: &str) -> Option<Event> {
    let (scan, rest) = line.trim_start().split_once("  ")?;
    let (subject, text) = rest.split_once("  ")?;
    Some(Event {
        scan: scan.parse().ok()?,
        subject: subject.into(),
        text: text.trim_start().into(),
    })
}
