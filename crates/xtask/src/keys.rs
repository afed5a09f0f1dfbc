//! The tables of keys of axes and drives in the page on scan scripts, from the tables that the reader and
//! the schema use.

use crate::{Generated, read, replace_part};
use standstill_axis::keys::{AXIS, Holds, Object};
use standstill_drives::keys::{CIA402, IDEAL, PLANT};
use std::fmt::Write;

/// The page; everything else in it is written by hand.
const PAGE: &str = "docs/scan-scripts.md";

/// Keys of an axis that are not part of its configuration.
const OTHERS: [(&str, &str, &str); 2] = [
    ("unit", "label of the axis's unit u", "empty"),
    ("drive", "the drive of the axis, see below", "ideal, no delay"),
];

/// The page with its tables made anew.
///
/// # Panics
/// If the page does not exist, or has no place for a table.
pub fn page() -> Generated {
    let mut text = read(PAGE);
    let others = OTHERS.map(|(name, doc, absent)| row(name, doc, Some(absent)));
    let travel: Vec<_> = IDEAL.keys.iter().map(|key| key.path).collect();
    for (name, rows) in [
        ("axis", others.concat() + &rows(&AXIS, &[])),
        ("ideal", rows(&IDEAL, &[])),
        ("cia402", rows(&CIA402, &travel)),
        ("plant", rows(&PLANT, &travel)),
    ] {
        let table = format!("\n| key | meaning | if absent |\n| --- | --- | --- |\n{rows}\n");
        replace_part(PAGE, &mut text, &format!("keys: {name}"), &table);
    }
    Generated {
        path: PAGE.to_owned(),
        text,
    }
}

/// A row for every key except those in `left_out`, and for keys in an object.
fn rows<T>(object: &Object<T>, left_out: &[&str]) -> String {
    let keys = object.keys.iter().filter(|key| !left_out.contains(&key.path));
    keys.map(|key| {
        let inner = match &key.holds {
            Holds::Object(inner) => rows(inner, &[]),
            Holds::List(places) => places.first().map_or_else(String::new, |inner| rows(inner, &[])),
            Holds::Bool { .. }
            | Holds::Word { .. }
            | Holds::Number { .. }
            | Holds::Whole { .. }
            | Holds::Scans { .. } => String::new(),
        };
        // In a list all places have the same keys.
        row(&key.path.replace(".0.", "[]."), key.doc, key.absent) + &inner
    })
    .collect()
}

fn row(name: &str, doc: &str, absent: Option<&str>) -> String {
    let mut row = String::new();
    let absent = absent.unwrap_or("needed");
    // A string takes whatever is written to it.
    let _ = writeln!(row, "| `{name}` | {} | {absent} |", linked(doc));
    row
}

/// A text whose names of pages are links.
fn linked(text: &str) -> String {
    let words = text.split(' ').map(|word| {
        let bare = word.trim_matches(|sign: char| !sign.is_ascii_alphanumeric());
        match bare.ends_with(".md") {
            true => word.replace(bare, &format!("[{bare}]({bare})")),
            false => word.to_owned(),
        }
    });
    words.collect::<Vec<_>>().join(" ")
}
