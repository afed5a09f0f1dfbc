//! Puts the parts of the page together.

use crate::{Mark, Source, facts};
use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::{Value, json};
use standstill_picture::escaped;
use standstill_trace::{Header, events, exact};
use std::fmt::Write;

const TEMPLATE: &str = include_str!("../page/page.html");

const STYLE: &str = concat!(
    include_str!("../vendor/uPlot.min.css"),
    "\n",
    include_str!("../page/page.css")
);

/// uPlot with its licence, then ours: from the bytes to the page.
const SCRIPT: &str = concat!(
    "/*\n",
    include_str!("../vendor/uPlot-LICENSE"),
    "*/\n",
    include_str!("../vendor/uPlot.iife.min.js"),
    "\n'use strict';\n",
    include_str!("../page/decode.js"),
    include_str!("../page/rows.js"),
    include_str!("../page/curves.js"),
    include_str!("../page/cams.js"),
    include_str!("../page/board.js"),
    include_str!("../page/page.js"),
    "\n",
    include_str!("../page/start.js"),
);

/// Source expressions of the content policy: this style and this script, and no other. A test prints them
/// when they are out of date.
const STYLE_HASH: &str = "'sha256-tNc5wiG7ONEIOpffWZcwSuan1id+GyjiQQkFnffJ8Rg='";
const SCRIPT_HASH: &str = "'sha256-dgKFpzBcwkBxEw2dNOEbVyAn4QpAzf90YZ0459cmWlI='";

/// The whole page.
pub fn page(sources: &[Source<'_>], marks: &[Mark]) -> String {
    // One line a scan, even if two marks name it; the page begins at the first.
    let mut scans: Vec<usize> = Vec::new();
    for scan in marks.iter().filter_map(|mark| mark.scan) {
        if !scans.contains(&scan) {
            scans.push(scan);
        }
    }
    let about = json!({"traces": sources.iter().map(about).collect::<Vec<_>>(), "marks": scans}).to_string();
    filled(|place| match place {
        "style_hash" => STYLE_HASH.to_owned(),
        "script_hash" => SCRIPT_HASH.to_owned(),
        "version" => env!("CARGO_PKG_VERSION").to_owned(),
        "title" => escaped(&facts::title(sources)),
        "facts" => facts::facts(sources),
        "sources" => facts::sources(sources),
        "marks" => facts::marks(marks),
        "failures" => facts::failures(sources),
        "footer" => facts::footer(sources),
        // In a script element only this character could end the text.
        "about" => about.replace('<', "\\u003c"),
        "rows" => sources.iter().map(rows).collect(),
        "style" => STYLE.to_owned(),
        "script" => SCRIPT.to_owned(),
        other => format!("{{{other}}}"),
    })
}

/// The template with its places filled. The inserted text is not expanded again.
fn filled(text_of: impl Fn(&str) -> String) -> String {
    let mut page = String::new();
    let mut rest = TEMPLATE;
    while let Some((before, after)) = rest.split_once('{') {
        page.push_str(before);
        let (place, after) = after.split_once('}').unwrap_or((after, ""));
        page.push_str(&text_of(place));
        rest = after;
    }
    page.push_str(rest);
    page
}

/// Everything of a trace but its rows: name, header, events.
pub fn about(source: &Source<'_>) -> Value {
    let header = source.trace.header();
    let events: Vec<Value> = events(source.trace)
        .into_iter()
        .map(|event| json!([event.scan, event.subject, event.text]))
        .collect();
    json!({"name": source.name, "header": told(header), "events": events})
}

/// The header without the parts that the rows show anyway.
fn told(header: &Header) -> Value {
    let instances = header.instances.iter();
    let instances: Vec<Value> = instances
        .map(|instance| json!({"name": instance.name, "type": instance.block}))
        .collect();
    json!({
        "cycle_ns": header.cycle_ns,
        "axes": header.axes,
        "instances": instances,
        "claims": header.claims,
        "cams": header.cams,
    })
}

/// The rows of a trace.
fn rows(source: &Source<'_>) -> String {
    let mut text = String::from("<script type=\"text/plain\" class=\"rows\">");
    // Writing to a String cannot fail.
    let _ = writeln!(text, "{}</script>", STANDARD.encode(exact::encode(source.trace)));
    text
}
