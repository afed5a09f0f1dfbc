//! The README is true: its script prints the output shown under it, its mistake is reported as shown, and its run
//! command runs.

use crate::support::{root, scratch, standstill, write};
use std::path::PathBuf;

fn readme() -> String {
    std::fs::read_to_string(root().join("README.md")).unwrap()
}

/// The text of the fenced blocks of `language`, in order.
fn blocks(language: &str) -> Vec<String> {
    let text = readme();
    let fence = format!("```{language}\n");
    text.split(&fence)
        .skip(1)
        .map(|rest| rest.split("```").next().unwrap().to_string())
        .collect()
}

/// A fresh folder with the README's script in it, changed by `edit`.
fn folder_with_script(name: &str, edit: impl Fn(String) -> String) -> PathBuf {
    let folder = scratch(name);
    write(&folder, "there.scan.json", &edit(blocks("json").remove(0)));
    folder
}

#[test]
fn the_script_prints_what_stands_under_it() {
    let folder = folder_with_script("readme", |script| script);
    let output = standstill(&folder, &["run", "there.scan.json"]);
    assert_eq!(output.status, 0);
    let (found, shown) = (output.out, blocks("text").remove(0));
    // `...` stands for any lines.
    let mut parts = shown.split("...\n");
    let mut rest = found.strip_prefix(parts.next().unwrap()).expect("it begins so");
    for part in parts {
        rest = rest
            .split_once(part)
            .unwrap_or_else(|| panic!("{found} has no\n{part}"))
            .1;
    }
    assert_eq!(rest, "", "it ends so");
}

#[test]
fn the_script_is_laid_out_by_fmt_and_fits_a_page() {
    let folder = folder_with_script("readme_fmt", |script| script);
    let output = standstill(&folder, &["fmt", "--check", "there.scan.json"]);
    assert_eq!(output.status, 0);
    // The part of a line that a page of GitHub shows without scrolling.
    for block in [blocks("json"), blocks("text"), blocks("console")].concat() {
        for line in block.lines() {
            assert!(line.chars().count() <= 98, "{line}");
        }
    }
}

#[test]
fn the_comparison_is_that_of_its_page() {
    let page = std::fs::read_to_string(root().join("docs/comparison.md")).unwrap();
    let text = readme();
    let (_, table) = text.split_once("| question |").unwrap();
    let rows: Vec<_> = table
        .lines()
        .skip(2)
        .take_while(|line| line.starts_with('|'))
        .collect();
    assert_eq!(rows.len(), 5);
    for row in rows {
        let row = row.replace("](docs/", "](");
        assert!(
            page.lines().any(|line| line == row),
            "docs/comparison.md has no\n{row}"
        );
    }
}

#[test]
fn the_first_test_of_ones_own_passes() {
    let folder = scratch("readme_init");
    let console = blocks("console").remove(0);
    let line = console
        .lines()
        .find_map(|line| line.strip_prefix("$ standstill "))
        .unwrap();
    let arguments: Vec<_> = line.split(' ').collect();
    assert_eq!(standstill(&folder, &arguments).status, 0);
    let tested = standstill(&folder.join("cell"), &["test", "--strict"]);
    assert_eq!(tested.status, 0);
}

#[test]
fn the_mistake_is_reported_as_shown() {
    let folder = folder_with_script("readme_mistake", |script| {
        script.replacen("Execute", "Exceute", 1)
    });
    let output = standstill(&folder, &["run", "there.scan.json"]);
    assert_eq!(output.status, 3);
    assert_eq!(output.err.trim(), blocks("text")[1].trim());
}

#[test]
fn the_run_commands_run() {
    let console = blocks("console").concat();
    let lines = console.lines().filter_map(|line| line.split_once(" -- run "));
    let (builds, scripts): (Vec<_>, Vec<_>) = lines.unzip();
    assert_eq!(
        builds,
        [
            "$ cargo run -r -p standstill-cli --no-default-features",
            "$ cargo run --release"
        ]
    );
    for script in scripts {
        let output = standstill(&root(), &["run", script]);
        assert_eq!(output.status, 0, "{script}");
    }
}
