//! The README is true: its script prints the output shown under it, its mistake is reported as shown, and its run
//! command runs.
//! command runs.

use std::path::{Path, PathBuf};
use std::process::{Command, Output};

fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
}

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

fn standstill(folder: &Path, arguments: &[&str]) -> Output {
    Command::new(env!("CARGO_BIN_EXE_standstill"))
        .current_dir(folder)
        .args(arguments)
        .output()
        .unwrap()
}

/// A fresh folder with the README's script in it, changed by `edit`.
fn folder_with_script(name: &str, edit: impl Fn(String) -> String) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    std::fs::create_dir_all(&folder).unwrap();
    std::fs::write(folder.join("there.scan.json"), edit(blocks("json").remove(0))).unwrap();
    folder
}

#[test]
fn the_script_prints_what_stands_under_it() {
    let folder = folder_with_script("readme", |script| script);
    let output = standstill(&folder, &["run", "there.scan.json"]);
    assert_eq!(output.status.code(), Some(0));
    let (found, shown) = (
        String::from_utf8(output.stdout).unwrap(),
        blocks("text").remove(0),
    );
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
    assert_eq!(output.status.code(), Some(0));
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
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join("readme_init");
    let _ = std::fs::remove_dir_all(&folder);
    std::fs::create_dir_all(&folder).unwrap();
    let console = blocks("console").remove(0);
    let line = console
        .lines()
        .find_map(|line| line.strip_prefix("$ standstill "))
        .unwrap();
    let arguments: Vec<_> = line.split(' ').collect();
    assert_eq!(standstill(&folder, &arguments).status.code(), Some(0));
    assert_eq!(
        standstill(&folder.join("cell"), &["test", "--strict"])
            .status
            .code(),
        Some(0)
    );
}

#[test]
fn the_mistake_is_reported_as_shown() {
    let folder = folder_with_script("readme_mistake", |script| {
        script.replacen("Execute", "Exceute", 1)
    });
    let output = standstill(&folder, &["run", "there.scan.json"]);
    assert_eq!(output.status.code(), Some(3));
    assert_eq!(
        String::from_utf8(output.stderr).unwrap().trim(),
        blocks("text")[1].trim()
    );
}

#[test]
fn the_run_command_runs() {
    let console = blocks("console").remove(0);
    let line = console.lines().find(|line| line.contains("-- run ")).unwrap();
    let (build, script) = line.split_once(" -- run ").unwrap();
    assert_eq!(build, "$ cargo run -r -p standstill-cli --no-default-features");
    let output = standstill(&root(), &["run", script]);
    assert_eq!(output.status.code(), Some(0));
}
