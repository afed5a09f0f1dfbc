//! The examples of `docs/command-line.md` print what stands there.

use std::io::Write;
use std::path::Path;
use std::process::{Command, Stdio};

#[test]
fn every_console_block_prints_what_it_shows() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let text = std::fs::read_to_string(root.join("docs/command-line.md")).unwrap();
    let mut input = String::new();
    let mut shown = 0;
    for fenced in text.split("```").skip(1).step_by(2) {
        if let Some(lines) = fenced.strip_prefix("jsonl\n") {
            input = lines.to_owned();
        }
        let Some(console) = fenced.strip_prefix("console\n") else {
            continue;
        };
        let (command, expected) = console.split_once('\n').unwrap();
        let arguments = command.strip_prefix("$ standstill ").unwrap().split(' ');
        let mut child = Command::new(env!("CARGO_BIN_EXE_standstill"))
            .args(arguments)
            .current_dir(&root)
            .env("INSTA_UPDATE", "no")
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .spawn()
            .unwrap();
        child.stdin.take().unwrap().write_all(input.as_bytes()).unwrap();
        let output = child.wait_with_output().unwrap();
        assert_eq!(String::from_utf8(output.stdout).unwrap(), expected, "{command}");
        shown += 1;
    }
    assert!(shown >= 3, "only {shown} examples found");
}
