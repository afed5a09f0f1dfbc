//! The examples of the guides print the text that is shown there.
//!
//! A `console` block is run, with the last `jsonl` block before it on standard input. A table whose first column is
//! `id` shows answers of `standstill plan` to the lines of that `jsonl` block. Its other columns are named after
//! fields, and its values are rounded to the digits shown. A picture `pictures/plan-NAME.svg` is that of these
//! lines, as `plan --svg` draws it. The picture of a cam is that of `cam plot`. With `STANDSTILL_WRITE_DOCS=1` the
//! test writes the pictures. Files named `out.` something are written to, and read from, a folder of the test.

use crate::support::{root, scratch};
use serde_json::Value;
use std::io::{ErrorKind, Write};
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};

fn placed(argument: &str) -> PathBuf {
    match argument.strip_prefix("out.") {
        Some(_) => Path::new(env!("CARGO_TARGET_TMPDIR")).join(argument),
        None => argument.into(),
    }
}

fn standstill(arguments: &str, input: &str, folder: &Path) -> String {
    let mut child = Command::new(env!("CARGO_BIN_EXE_standstill"))
        .args(arguments.split(' ').map(placed))
        .current_dir(folder)
        .env("INSTA_UPDATE", "no")
        // Readers type these commands at home, where goldens may be accepted.
        .env_remove("CI")
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let fed = child.stdin.take().unwrap().write_all(input.as_bytes());
    // A command that takes no input may end before the input is written.
    if let Err(error) = fed {
        assert_eq!(error.kind(), ErrorKind::BrokenPipe, "{arguments}");
    }
    let out = String::from_utf8(child.wait_with_output().unwrap().stdout).unwrap();
    // The place of a file is no part of the example.
    out.replace(&format!("{}/", env!("CARGO_TARGET_TMPDIR")), "")
}

/// Checks a page; returns the number of examples, of cells in its tables, and of pictures of plans.
fn checked(page: &str) -> (usize, usize, usize) {
    let text = std::fs::read_to_string(root().join("docs").join(page)).unwrap();
    let (mut input, mut shown, mut cells, mut pictures) = (String::new(), 0, 0, 0);
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 0 {
            // A table without lines to plan has another subject.
            if !input.is_empty() {
                cells += checked_tables(page, part, &input);
                pictures += checked_pictures(page, part, &input);
            }
        } else if let Some(lines) = part.strip_prefix("jsonl\n") {
            input = lines.to_owned();
        } else if let Some(console) = part.strip_prefix("console\n") {
            // Other commands, such as those for contributors, are only shown.
            if console.starts_with("$ standstill ") {
                checked_console(page, console, &input, &root());
                shown += 1;
            }
        }
    }
    (shown, cells, pictures)
}

/// Draws the pictures of plans that are shown between two fenced blocks; returns their number.
fn checked_pictures(page: &str, text: &str, input: &str) -> usize {
    let names = text.split("(pictures/plan-").skip(1);
    let names = names
        .filter_map(|rest| rest.split_once(".svg)"))
        .map(|(name, _)| name);
    names
        .map(|name| {
            let drawn = format!("out.plan-{name}.svg");
            standstill(&format!("plan --svg {drawn}"), input, &root());
            is_kept(&drawn, &format!("plan-{name}.svg"), page);
        })
        .count()
}

/// Checks that a picture of a page is the one that was drawn into a file of the test.
fn is_kept(drawn: &str, picture: &str, page: &str) {
    let drawn = std::fs::read_to_string(placed(drawn)).unwrap();
    let path = root().join("docs/pictures").join(picture);
    if std::env::var_os("STANDSTILL_WRITE_DOCS").is_some_and(|value| value == "1") {
        std::fs::write(&path, &drawn).unwrap();
    }
    let kept = std::fs::read_to_string(&path).unwrap_or_default();
    assert!(
        kept == drawn,
        "{page}: the picture {picture} is not what is drawn: \
         STANDSTILL_WRITE_DOCS=1 cargo test -p standstill-cli --test cli docs draws it"
    );
}

/// Runs a console block: its first line is the command, the rest its output; `...` represents any lines.
fn checked_console(page: &str, console: &str, input: &str, folder: &Path) {
    let (command, expected) = console.split_once('\n').unwrap();
    let arguments = command.strip_prefix("$ standstill ").unwrap();
    let found = standstill(arguments, input, folder);
    let parts: Vec<_> = expected.split("...\n").collect();
    let [first, .., last] = parts[..] else {
        assert_eq!(found, expected, "{page}: {command}");
        return;
    };
    assert!(
        found.starts_with(first) && found.ends_with(last),
        "{page}: {command}\nprints\n{found}"
    );
    let mut at = first.len();
    for part in &parts[1..] {
        let next = found[at..].find(part).map(|next| at + next + part.len());
        at = next.unwrap_or_else(|| panic!("{page}: {command} does not print\n{part}\nbut\n{found}"));
    }
}

/// Checks the tables of plans between two fenced blocks; returns the number of their cells.
fn checked_tables(page: &str, text: &str, input: &str) -> usize {
    let (mut fields, mut answers, mut count) = (Vec::new(), Vec::new(), 0);
    for line in text.lines() {
        let row: Vec<_> = line.split('|').map(str::trim).collect();
        match row[..] {
            ["", "id", ..] => {
                fields = row.iter().map(|cell| cell.trim_matches('`').to_owned()).collect();
                answers = standstill("plan", input, &root())
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

/// Whether a value rounds to these digits; `-` is nothing, and anything but a number is compared unchanged.
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

/// The Markdown files below a folder of `docs`, by their paths there.
fn pages(folder: &str) -> Vec<String> {
    let mut pages = Vec::new();
    for entry in std::fs::read_dir(root().join("docs").join(folder)).unwrap() {
        let entry = entry.unwrap();
        let page = format!("{folder}{}", entry.file_name().to_string_lossy());
        if entry.path().is_dir() {
            pages.extend(self::pages(&format!("{page}/")));
        } else if page.ends_with(".md") {
            pages.push(page);
        }
    }
    pages.sort();
    pages
}

#[test]
fn every_console_block_and_every_table_of_plans_is_true() {
    // The least numbers that must be found, so that a change of form does not leave a page unread.
    let least = [
        ("cams.md", 7, 0),
        ("choosing-limits.md", 1, 30),
        ("command-line.md", 13, 0),
        ("compare.md", 4, 0),
        ("coupling.md", 7, 0),
        ("export.md", 1, 0),
        ("from-your-vendor.md", 1, 10),
        ("gallery/README.md", 1, 0),
        ("gallery/press.md", 1, 0),
        ("how-to/ci.md", 2, 0),
        ("mutants.md", 1, 0),
        ("planner-lines.md", 1, 0),
        ("reports.md", 3, 0),
        ("sweeps.md", 1, 0),
        ("traces.md", 1, 0),
    ];
    let pages = pages("");
    // The tutorial has a folder of its own.
    for page in pages.iter().filter(|page| *page != "tutorial.md") {
        // Readers have the program; only contributors build it for a command.
        let text = std::fs::read_to_string(root().join("docs").join(page)).unwrap();
        assert!(
            page == "contributing.md" || !text.contains("cargo run --release -- "),
            "{page}: begin the command with `standstill`, so that this test runs it"
        );
        let (shown, cells, pictures) = checked(page);
        let with_picture = [
            "papers",
            "planner",
            "planner-lines",
            "planner-online",
            "planner-ramps",
            "vibration",
        ];
        let with_picture = with_picture.iter().any(|name| *page == format!("{name}.md"));
        assert_eq!(pictures, usize::from(with_picture), "pictures of plans on {page}");
        let expected = least.iter().find(|(name, ..)| name == page);
        let (_, least_shown, least_cells) = expected.unwrap_or(&("", 0, 0));
        assert!(shown >= *least_shown, "{page}: only {shown} examples found");
        assert!(cells >= *least_cells, "{page}: only {cells} cells found");
    }
    assert!(
        least
            .iter()
            .all(|(name, ..)| pages.iter().any(|page| page == name))
    );
}

#[test]
fn the_picture_of_a_cam_is_drawn_by_the_commands_beside_it() {
    for arguments in [
        "cam law modified-sine --lift 100 --width 180 -o out.modified-sine.csv",
        "cam plot out.modified-sine.csv --svg out.cam.svg",
    ] {
        standstill(arguments, "", &root());
    }
    is_kept("out.cam.svg", "cam-modified-sine.svg", "cams.md");
}

/// A JSON block whose text before it names a file is saved as that file. An indented block replaces the item with
/// its `name` in the previous file.
#[test]
fn the_tutorial_does_what_it_says() {
    let page = "tutorial.md";
    let text = std::fs::read_to_string(root().join("docs").join(page)).unwrap();
    let folder = scratch("tutorial");
    let (mut before, mut file, mut shown) = ("", String::new(), 0);
    for (index, part) in text.split("```").enumerate() {
        if index % 2 == 0 {
            before = part;
        } else if let Some(script) = part.strip_prefix("json\n") {
            let names = before.split('`').skip(1).step_by(2);
            let names: Vec<_> = names.filter(|name| name.ends_with(".scan.json")).collect();
            let script = match script.strip_prefix("    {\n") {
                Some(block) => with_block(&std::fs::read_to_string(folder.join(&file)).unwrap(), block),
                None => {
                    file = names.last().unwrap().to_string();
                    let tested = root().join("scan-tests/tutorial").join(&file);
                    assert_eq!(script, std::fs::read_to_string(tested).unwrap(), "{page}: {file}");
                    script.to_owned()
                }
            };
            std::fs::write(folder.join(&file), script).unwrap();
        } else if let Some(console) = part.strip_prefix("console\n") {
            checked_console(page, console, "", &folder);
            shown += 1;
        }
    }
    assert_eq!(shown, 5, "examples of {page}");
    assert!(folder.join("pages/abort.html").exists());
}

/// A script with the block of this name replaced.
fn with_block(script: &str, block: &str) -> String {
    let name = block.lines().next().unwrap();
    let (before, rest) = script.split_once(&format!("    {{\n{name}\n")).unwrap();
    let after = rest.split_once("\n    }").unwrap().1;
    format!("{before}    {{\n{}{after}", block.trim_end())
}

/// Runs the commands of the example workflow on a folder with the name used there.
#[test]
fn the_commands_of_the_example_workflow_work() {
    let workflow = std::fs::read_to_string(root().join("docs/how-to/standstill.yml")).unwrap();
    let folder = scratch("workflow");
    std::fs::create_dir_all(folder.join("machine")).unwrap();
    for entry in std::fs::read_dir(root().join("scan-tests/tutorial")).unwrap() {
        let path = entry.unwrap().path();
        std::fs::copy(&path, folder.join("machine").join(path.file_name().unwrap())).unwrap();
    }
    let mut count = 0;
    for arguments in workflow
        .lines()
        .filter_map(|line| line.trim().strip_prefix("run: standstill "))
    {
        let output = Command::new(env!("CARGO_BIN_EXE_standstill"))
            .args(arguments.split(' '))
            .current_dir(&folder)
            .env("CI", "true")
            .output()
            .unwrap();
        assert!(output.status.success(), "standstill {arguments}\n{output:?}");
        count += 1;
    }
    assert_eq!(count, 2);
    assert!(folder.join("motion.xml").exists());
}
