//! The copy of the repository with the sampled points, each behind a choice at run time.

use crate::points::Point;
use serde_json::Value;
use std::collections::BTreeSet;
use std::error::Error;
use std::fmt::Write as _;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::{env, fs};

/// The variable that chooses a point; 0 and no value choose none.
pub const CHOICE: &str = "STANDSTILL_MUTANT";

/// The variable that names a file for the numbers of the points that were reached.
pub const REACHED: &str = "STANDSTILL_MUTANTS_REACHED";

const HOOK: &str = r#"//! Which change of the sources is in force.
use std::env;
use std::fs::OpenOptions;
use std::io::Write;
use std::sync::LazyLock;
use std::sync::atomic::{AtomicBool, Ordering};

static CHOSEN: LazyLock<usize> = LazyLock::new(|| {
    env::var("STANDSTILL_MUTANT").map_or(0, |number| number.parse().expect("a number"))
});
static REACHED: LazyLock<Option<String>> = LazyLock::new(|| env::var("STANDSTILL_MUTANTS_REACHED").ok());
static NOTED: [AtomicBool; 100_000] = [const { AtomicBool::new(false) }; 100_000];

/// Whether it is this one.
#[inline]
pub fn on(number: usize) -> bool {
    if let Some(path) = &*REACHED && !NOTED[number].load(Ordering::Relaxed) {
        note(number, path);
    }
    *CHOSEN == number
}

#[cold]
fn note(number: usize, path: &str) {
    if !NOTED[number].swap(true, Ordering::Relaxed) {
        let file = OpenOptions::new().create(true).append(true).open(path);
        writeln!(file.expect("a file"), "{number}").expect("room");
    }
}
"#;

/// The crates whose sources are changed: folder, and the path from there to the hook.
pub const CRATES: [(&str, &str); 3] = [
    ("crates/axis", "../mutant-hook"),
    ("blocks", "../crates/mutant-hook"),
    ("crates/fb", "../mutant-hook"),
];

/// The packages whose tests run for points that the scripts do not detect, and programs of theirs that do not: the search
/// through all states takes too long for this, and the others test crates above.
const TESTED: [&str; 7] = ["axis", "fb", "blocks", "drives", "scan", "soak", "tests"];
const NOT_RUN: [&str; 3] = ["search", "script", "trace"];

pub struct Copy {
    pub root: PathBuf,
}

/// A test program and the folder it runs in.
#[derive(Debug)]
pub struct Test {
    pub program: PathBuf,
    pub folder: PathBuf,
}

impl Copy {
    /// A fresh copy of git's files at `from`, with `sampled` in it; number n is index n - 1. Unchanged
    /// files keep their time, so that Cargo builds only what changed.
    pub fn new(from: &Path, sampled: &[Point]) -> Result<Self, Box<dyn Error>> {
        let root = from.join("target/mutants/copy");
        let listed = Command::new("git")
            .args(["ls-files", "-z", "--cached", "--others", "--exclude-standard"])
            .current_dir(from)
            .output()?;
        let mut kept = BTreeSet::new();
        for name in String::from_utf8(listed.stdout)?.split_terminator('\0') {
            let source = from.join(name);
            if !source.is_file() {
                continue;
            }
            let mut bytes = fs::read(source)?;
            if sampled.iter().any(|point| point.file == name) {
                bytes = woven(name, &String::from_utf8(bytes)?, sampled).into_bytes();
            }
            if let Some((_, hook)) = CRATES
                .iter()
                .find(|(folder, _)| name == format!("{folder}/Cargo.toml"))
            {
                let hook = format!("[dependencies]\nstandstill-mutant-hook = {{ path = \"{hook}\" }}");
                bytes = String::from_utf8(bytes)?
                    .replace("[dependencies]", &hook)
                    .into_bytes();
            }
            write(&root.join(name), &bytes)?;
            kept.insert(root.join(name));
        }
        let hook = root.join("crates/mutant-hook");
        let manifest =
            "[package]\nname = \"standstill-mutant-hook\"\nversion = \"0.0.0\"\nedition = \"2024\"\n";
        for (name, text) in [("Cargo.toml", manifest), ("src/lib.rs", HOOK)] {
            write(&hook.join(name), text.as_bytes())?;
            kept.insert(hook.join(name));
        }
        remove_others(&root, &kept)?;
        Ok(Self { root })
    }

    fn cargo(&self, arguments: &[&str]) -> Command {
        let mut cargo = Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()));
        let target = self.root.with_file_name("build");
        cargo
            .args(arguments)
            .env("CARGO_TARGET_DIR", target)
            .current_dir(&self.root);
        cargo
    }

    /// Builds the program that runs scripts. On a compile error: the numbers of the points that do not
    /// compile.
    pub fn build(&self) -> Result<Result<PathBuf, BTreeSet<usize>>, Box<dyn Error>> {
        let arguments = [
            "build",
            "--release",
            "-p",
            "standstill-cli",
            "--message-format=json",
        ];
        let done = self
            .cargo(&arguments)
            .stderr(std::process::Stdio::inherit())
            .output()?;
        if done.status.success() {
            return Ok(Ok(self.root.with_file_name("build").join("release/standstill")));
        }
        let mut broken = BTreeSet::new();
        for message in messages(&done.stdout) {
            let message = &message["message"];
            if message["level"] != "error" {
                continue;
            }
            for span in message["spans"].as_array().into_iter().flatten() {
                let text = fs::read_to_string(self.root.join(span["file_name"].as_str().unwrap_or_default()));
                let (from, to) = (span["line_start"].as_u64(), span["line_end"].as_u64());
                if let (Ok(text), Some(from), Some(to)) = (text, from, to) {
                    broken.extend(numbers_at(&text, from as usize, to as usize));
                }
            }
            if broken.is_empty() {
                eprintln!("{}", message["rendered"].as_str().unwrap_or_default());
            }
        }
        if broken.is_empty() {
            return Err("the copy does not build".into());
        }
        Ok(Err(broken))
    }

    /// Builds the tests that are run.
    pub fn build_tests(&self) -> Result<Vec<Test>, Box<dyn Error>> {
        let mut arguments = vec!["test", "--no-run", "--message-format=json", "--lib", "--tests"];
        let packages = TESTED.map(|name| format!("standstill-{name}"));
        for package in &packages {
            arguments.extend(["-p", package]);
        }
        let done = self
            .cargo(&arguments)
            .stderr(std::process::Stdio::inherit())
            .output()?;
        if !done.status.success() {
            return Err("the tests of the copy do not build".into());
        }
        let tests = messages(&done.stdout).filter_map(|message| {
            let program = message["executable"].as_str()?.into();
            let folder = Path::new(message["manifest_path"].as_str()?).parent()?.into();
            let is_test = message["profile"]["test"].as_bool()?;
            let asked = is_test && !NOT_RUN.contains(&message["target"]["name"].as_str()?);
            asked.then_some(Test { program, folder })
        });
        Ok(tests.collect())
    }
}

/// `text` with every point of `file` behind its choice.
fn woven(file: &str, text: &str, sampled: &[Point]) -> String {
    let numbered = sampled.iter().enumerate().filter(|(_, point)| point.file == file);
    let mut numbered: Vec<_> = numbered.map(|(at, point)| (at + 1, point)).collect();
    // Outer ones first.
    numbered.sort_by_key(|(number, point)| (point.range.start, usize::MAX - point.range.end, *number));
    let mut out = String::new();
    let end = weave(&mut out, text, &mut numbered.as_slice(), 0, text.len());
    assert_eq!(end, text.len(), "points lie within each other or apart");
    out
}

/// Writes `text` from `from` to `to` with its points. The changed piece has no other choice, because only
/// one is ever made.
fn weave(out: &mut String, text: &str, points: &mut &[(usize, &Point)], from: usize, to: usize) -> usize {
    let mut at = from;
    while let Some(((number, point), rest)) = points.split_first()
        && point.range.end <= to
    {
        *points = rest;
        out.push_str(&text[at..point.range.start]);
        let is_block = point.statement || text[point.range.start..].starts_with('{');
        let (open, close) = if is_block { ('{', '}') } else { ('(', ')') };
        let mutated = &point.mutated;
        let _ = write!(
            out,
            "{open}if ::standstill_mutant_hook::on({number}) {{ {mutated} }} else {{ "
        );
        at = weave(out, text, points, point.range.start, point.range.end);
        let _ = write!(out, " }}{close}");
    }
    out.push_str(&text[at..to]);
    to
}

/// The choices in these lines (from 1), or the last one that begins before them.
fn numbers_at(text: &str, from: usize, to: usize) -> Vec<usize> {
    let numbers = |line: &str| {
        let after = line.split("_hook::on(").skip(1);
        after
            .filter_map(|text| text.split(')').next()?.parse().ok())
            .collect::<Vec<usize>>()
    };
    let lines: Vec<_> = text.lines().take(to).collect();
    let within: Vec<_> = lines
        .iter()
        .skip(from - 1)
        .flat_map(|line| numbers(line))
        .collect();
    if within.is_empty() {
        let before = lines.iter().rev().flat_map(|line| numbers(line).pop());
        return before.take(1).collect();
    }
    within
}

fn messages(output: &[u8]) -> impl Iterator<Item = Value> {
    output
        .split(|byte| *byte == b'\n')
        .filter_map(|line| serde_json::from_slice(line).ok())
}

fn write(path: &Path, bytes: &[u8]) -> std::io::Result<()> {
    if fs::read(path).is_ok_and(|found| found == bytes) {
        return Ok(());
    }
    fs::create_dir_all(path.parent().expect("a folder"))?;
    fs::write(path, bytes)
}

/// Removes the remains of an earlier copy.
fn remove_others(folder: &Path, kept: &BTreeSet<PathBuf>) -> std::io::Result<()> {
    for entry in fs::read_dir(folder)? {
        let path = entry?.path();
        if path.is_dir() {
            remove_others(&path, kept)?;
        } else if !kept.contains(&path) && !path.ends_with("Cargo.lock") {
            fs::remove_file(path)?;
        }
    }
    Ok(())
}
