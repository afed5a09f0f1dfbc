//! The README is true: its script prints what stands under it, its mistake is reported as shown, and its run
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
    assert_eq!(String::from_utf8(output.stdout).unwrap(), blocks("text")[0]);
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
    let script = line.strip_prefix("$ cargo run --release -- run ").unwrap();
    let output = standstill(&root(), &["run", script]);
    assert_eq!(output.status.code(), Some(0));
}
