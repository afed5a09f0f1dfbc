//! The examples of the guides print what stands there.
//!
//! A `console` block is run, with the last `jsonl` block before it on standard input. A table whose first column is
//! `id` shows answers of `standstill plan` to the lines of that `jsonl` block, its other columns named after fields,
//! rounded to the digits shown. Files named `out.` something are written to, and read from, a folder of the test.

use serde_json::Value;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

fn placed(argument: &str) -> PathBuf {
    match argument.strip_prefix("out.") {
        Some(_) => Path::new(env!("CARGO_TARGET_TMPDIR")).join(argument),
        None => argument.into(),
    }
}

fn standstill(arguments: &str, input: &str) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_standstill"))
        .args(arguments.split(' ').map(placed))
        .current_dir(root())
        .env("INSTA_UPDATE", "no")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
    String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap()
}

/// Checks a page; the number of examples and the number of cells in its tables.
fn checked(page: &str) -> (usize, usize) {
    let text = std::fs::read_to_string(root().join("docs").join(page)).unwrap();
    let (mut input, mut shown, mut cells) = (String::new(), 0, 0);
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 0 {
            cells += checked_tables(page, part, &input);
        } else if let Some(lines) = part.strip_prefix("jsonl\n") {
            input = lines.to_owned();
        } else if let Some(console) = part.strip_prefix("console\n") {
            let (command, expected) = console.split_once('\n').unwrap();
            let arguments = command.strip_prefix("$ standstill ").unwrap();
            assert_eq!(standstill(arguments, &input), expected, "{page}: {command}");
            shown += 1;
        }
    }
    (shown, cells)
}

/// Checks the tables of plans between two fenced blocks; the number of their cells.
fn checked_tables(page: &str, text: &str, input: &str) -> usize {
    let (mut fields, mut answers, mut count) = (Vec::new(), Vec::new(), 0);
    for line in text.lines() {
        let row: Vec<_> = line.split('|').map(str::trim).collect();
        match row[..] {
            ["", "id", ..] => {
                fields = row.iter().map(|cell| cell.trim_matches('`').to_owned()).collect();
                answers = standstill("plan", input)
                    .lines()
                    .map(|line| serde_json::from_str::<Value>(line).unwrap())
                    .collect();
            }
            ["", id, ..] if !fields.is_empty() => {
                if id.starts_with('-') {
                    continue;
                }
                let answer = answers.iter().find(|answer| answer["id"] == id);
                let answer = answer.unwrap_or_else(|| panic!("{page}: no line of `plan` has the id {id}"));
                for (field, cell) in fields
                    .iter()
                    .zip(&row)
                    .skip(2)
                    .filter(|(field, _)| !field.is_empty())
                {
                    let value = field.split('.').fold(answer, |value, key| &value[key]);
                    assert!(
                        is_shown_as(value, cell),
                        "{page}: {field} of {id} is {value}, not {cell}"
                    );
                    count += 1;
                }
            }
            _ => fields.clear(),
        }
    }
    count
}

/// Whether a value rounds to these digits; `-` is nothing, anything but a number stands as it is.
fn is_shown_as(value: &Value, cell: &str) -> bool {
    match (value.as_f64(), cell.parse::<f64>()) {
        (Some(value), Ok(shown)) => {
            let digits = cell.split_once('.').map_or(0, |(_, digits)| digits.len());
            let half = (0..digits).fold(0.5, |half, _| half / 10.0);
            (value - shown).abs() <= half * 1.000_001
        }
        _ => {
            let text = value.to_string();
            (value.is_null() && cell == "-") || text == cell
        }
    }
}

#[test]
fn every_console_block_and_every_table_of_plans_is_true() {
    for (page, least_shown, least_cells) in [
        ("command-line.md", 4, 0),
        ("export.md", 1, 0),
        ("compare.md", 4, 0),
        ("reports.md", 3, 0),
        ("from-your-vendor.md", 1, 10),
        ("choosing-limits.md", 1, 30),
    ] {
        let (shown, cells) = checked(page);
        assert!(shown >= least_shown, "{page}: only {shown} examples found");
        assert!(cells >= least_cells, "{page}: only {cells} cells found");
    }
}
