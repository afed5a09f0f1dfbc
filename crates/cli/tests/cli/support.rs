//! Starting the program, and places for it to write to.

use std::fs;
use std::io::Write;
use std::path::{Path, PathBuf};
use std::process::{Command, Stdio};
use std::thread;

/// A script that takes longer than any time limit of a test.
pub const LONG: &str = r#"{"standstill":1,"cycle":"T#1us","scans":10000000,"axes":{"X":{"limits":{"velocity":1,"acceleration":1}}},
    "blocks":[],"expect":[{"always":{"X.Position":0}}]}"#;

/// A move of 20 scans with a parameter; every claim holds.
pub const SCRIPT: &str = r#"{
  "standstill": 1,
  "title": "One short move",
  "cycle": "T#10ms",
  "scans": 30,
  "parameters": {"v": 10},
  "axes": {
    "X": {"unit": "mm", "limits": {"velocity": 20, "acceleration": 100}, "state": "Standstill"}
  },
  "inputs": {"GO": false},
  "blocks": [
    {
      "name": "move",
      "type": "MC_MoveAbsolute",
      "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": 1, "Velocity": {"param": "v"}}
    }
  ],
  "steps": [
    {"at": 1, "set": {"GO": true}}
  ],
  "expect": [
    {"at": 21, "that": {"move.Done": true, "X.Position": 1}},
    {"never": {"move.Error": true}}
  ]
}
"#;

/// How a run of the program ended, and what it printed.
#[derive(Debug)]
pub struct Ended {
    pub status: i32,
    pub out: String,
    pub err: String,
}

/// The program with these arguments, in an environment of its own.
pub fn command(arguments: &[&str]) -> Command {
    let mut command = Command::new(env!("CARGO_BIN_EXE_standstill"));
    command.args(arguments).stdin(Stdio::null());
    for name in ["CI", "INSTA_UPDATE", "NO_COLOR", "CLICOLOR_FORCE"] {
        command.env_remove(name);
    }
    command
}

/// Runs a command to its end.
pub fn ended(command: &mut Command) -> Ended {
    let output = command.output().expect("the program starts");
    Ended {
        status: output.status.code().expect("it ends by itself"),
        out: String::from_utf8(output.stdout).expect("UTF-8"),
        err: String::from_utf8(output.stderr).expect("UTF-8"),
    }
}

/// Runs the program with these arguments in a folder.
pub fn standstill(folder: &Path, arguments: &[&str]) -> Ended {
    ended(command(arguments).current_dir(folder))
}

/// Runs the program with this standard input.
pub fn fed(arguments: &[&str], input: &[u8]) -> Ended {
    let mut command = command(arguments);
    let piped = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    thread::scope(|scope| {
        // In parallel with reading its output, or both sides could wait for each other.
        scope.spawn(move || stdin.write_all(input).expect("it reads all"));
        let output = child.wait_with_output().expect("it ends");
        Ended {
            status: output.status.code().expect("it ends by itself"),
            out: String::from_utf8(output.stdout).expect("UTF-8"),
            err: String::from_utf8(output.stderr).expect("UTF-8"),
        }
    })
}

/// An empty folder for the test of this name.
pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder to write to");
    folder
}

/// An empty folder with [`SCRIPT`] in it as `move.scan.json`.
pub fn with_script(name: &str) -> PathBuf {
    let folder = scratch(name);
    write(&folder, "move.scan.json", SCRIPT);
    folder
}

/// Writes a file of the folder.
pub fn write(folder: &Path, name: &str, text: &str) {
    fs::write(folder.join(name), text).expect("a file that can be written");
}

/// Reads a file of the folder.
pub fn read(folder: &Path, name: &str) -> String {
    fs::read_to_string(folder.join(name)).expect("a file that was written")
}

/// Checks that the output of a command with `--json` fulfils the program's own schema.
#[track_caller]
pub fn is_an_outcome(outcome: &serde_json::Value) {
    let schema = ended(&mut command(&["schema", "json"])).out;
    let schema = serde_json::from_str(&schema).expect("JSON");
    let mut schemas = boon::Schemas::new();
    let mut compiler = boon::Compiler::new();
    compiler.add_resource("outcome.json", schema).expect("a schema");
    let index = compiler.compile("outcome.json", &mut schemas).expect("a schema");
    assert!(schemas.validate(outcome, index).is_ok(), "{outcome}");
}
