//! The canonical layout of a script, which `standstill fmt` writes.

use crate::error::ScriptError;
use crate::read::json::{self, Json, Node};
use std::fmt::Write;

/// Longest line (characters) for an object or list on one line.
const WIDTH: usize = 110;

/// Spaces per level.
const INDENT: usize = 2;

/// Keys of the script whose members are always one per line.
const ONE_PER_LINE: [&str; 5] = ["axes", "tasks", "blocks", "steps", "expect"];

/// Lays out a script: two spaces per level; an object or list on one line if it fits in 110 columns; the
/// members of `axes`, `tasks`, `blocks`, `steps` and `expect` on lines of their own; numbers in the
/// shortest form that reads back to the same bits; LF, and a newline at the end. Keys keep their order.
/// Laying out a second time changes nothing, and the text reads as the same script.
///
/// Only the syntax is checked, so a script with an unknown pin can be laid out too.
///
/// # Errors
/// [`ScriptError`] if the text is no strict JSON.
pub fn format(text: &str, file_name: &str) -> Result<String, ScriptError> {
    let (_, root) = json::file(text, file_name)?;
    let mut out = String::new();
    match &root.json {
        Json::Map(members) if !members.is_empty() => {
            out.push('{');
            for (index, (key, value)) in members.iter().enumerate() {
                line(&mut out, 1, index);
                write_text(&mut out, &key.text);
                out.push_str(": ");
                let spread = ONE_PER_LINE.contains(&key.text.as_str());
                let rest = usize::from(index + 1 < members.len());
                write_node(&mut out, value, 1, spread, rest);
            }
            out.push_str("\n}");
        }
        _ => write_node(&mut out, &root, 0, false, 0),
    }
    out.push('\n');
    Ok(out)
}

/// Begins the line of member `index` at `level`.
fn line(out: &mut String, level: usize, index: usize) {
    out.push_str(if index == 0 { "\n" } else { ",\n" });
    out.extend(std::iter::repeat_n(' ', level * INDENT));
}

/// Writes `node` behind the text that the last line of `out` already has; its own members are at `level`
/// + 1. With `spread` they are on lines of their own even if they would fit. `rest` characters follow.
fn write_node(out: &mut String, node: &Node, level: usize, spread: bool, rest: usize) {
    let count = match &node.json {
        Json::Map(members) => members.len(),
        Json::List(items) => items.len(),
        _ => 0,
    };
    let start = out.len();
    if !spread || count == 0 {
        write_flat(out, node);
        let line_start = out[..start].rfind('\n').map_or(0, |newline| newline + 1);
        if count == 0 || out[line_start..].chars().count() + rest <= WIDTH {
            return;
        }
        out.truncate(start);
    }
    let rest_of = |index: usize| usize::from(index + 1 < count);
    match &node.json {
        Json::Map(members) => {
            out.push('{');
            for (index, (key, value)) in members.iter().enumerate() {
                line(out, level + 1, index);
                write_text(out, &key.text);
                out.push_str(": ");
                write_node(out, value, level + 1, false, rest_of(index));
            }
        }
        Json::List(items) => {
            out.push('[');
            for (index, item) in items.iter().enumerate() {
                line(out, level + 1, index);
                write_node(out, item, level + 1, false, rest_of(index));
            }
        }
        _ => {}
    }
    out.push('\n');
    out.extend(std::iter::repeat_n(' ', level * INDENT));
    out.push(if matches!(node.json, Json::Map(_)) {
        '}'
    } else {
        ']'
    });
}

/// Writes `node` on one line.
fn write_flat(out: &mut String, node: &Node) {
    match &node.json {
        Json::Null => out.push_str("null"),
        Json::Bool(value) => out.push_str(if *value { "true" } else { "false" }),
        Json::Number(value) => out.push_str(&number_text(*value)),
        Json::Text(text) => write_text(out, text),
        Json::List(items) => {
            out.push('[');
            for (index, item) in items.iter().enumerate() {
                out.push_str(if index == 0 { "" } else { ", " });
                write_flat(out, item);
            }
            out.push(']');
        }
        Json::Map(members) => {
            out.push('{');
            for (index, (key, value)) in members.iter().enumerate() {
                out.push_str(if index == 0 { "" } else { ", " });
                write_text(out, &key.text);
                out.push_str(": ");
                write_flat(out, value);
            }
            out.push('}');
        }
    }
}

/// The shortest digits that read back to the same bits; whole numbers without a point. -0.0 keeps its
/// sign, because a script may need just that bit. NaN and infinities are written as the words of the
/// format.
pub(crate) fn number_text(value: f64) -> String {
    if !value.is_finite() {
        return if value.is_nan() {
            "NaN"
        } else if value > 0.0 {
            "Infinity"
        } else {
            "-Infinity"
        }
        .to_owned();
    }
    let shortest = format!("{value:?}");
    match shortest.strip_suffix(".0") {
        Some(whole) if value != 0.0 || value.is_sign_positive() => whole.to_owned(),
        _ => shortest,
    }
}

fn write_text(out: &mut String, text: &str) {
    out.push('"');
    for c in text.chars() {
        match c {
            '"' => out.push_str("\\\""),
            '\\' => out.push_str("\\\\"),
            '\n' => out.push_str("\\n"),
            '\r' => out.push_str("\\r"),
            '\t' => out.push_str("\\t"),
            c if c < ' ' => {
                // Writing to a string cannot fail.
                let _ = write!(out, "\\u{:04x}", u32::from(c));
            }
            c => out.push(c),
        }
    }
    out.push('"');
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_short_and_read_back_to_the_same_bits() {
        for (value, text) in [
            (100.0, "100"),
            (0.0, "0"),
            (-0.0, "-0.0"),
            (0.1 + 0.2, "0.30000000000000004"),
            (1e16, "1e16"),
            (5e-324, "5e-324"),
            (-2.5, "-2.5"),
            (123456789012345.0, "123456789012345"),
        ] {
            assert_eq!(number_text(value), text);
            let Json::Number(read) = json::parse(text).unwrap().json else {
                panic!()
            };
            assert_eq!(read.to_bits(), value.to_bits());
        }
    }

    #[test]
    fn the_line_with_its_comma_fits_in_the_width() {
        for length in 0..130 {
            let text = format!("{{\"steps\": [[\"{}\"], [1]]}}", "x".repeat(length));
            let laid_out = format(&text, "").unwrap();
            let longest = laid_out
                .lines()
                .map(|line| line.chars().count())
                .max()
                .unwrap_or(0);
            // A string that is too long by itself is not broken.
            assert!(longest <= WIDTH || length + 9 > WIDTH, "{laid_out}");
            assert_eq!(laid_out.contains("    [\n"), length + 9 > WIDTH, "{laid_out}");
        }
    }
}
