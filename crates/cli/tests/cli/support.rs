//! Starting the program, and places for it to write to.

use serde_json::Value;
use std::fs;
use std::io::{Write, pipe};
use std::path::{Path, PathBuf};
use std::process::{Command, Output, Stdio};
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

impl Ended {
    fn of(output: Output) -> Self {
        Self {
            status: output.status.code().expect("it ends by itself"),
            out: String::from_utf8(output.stdout).expect("UTF-8"),
            err: String::from_utf8(output.stderr).expect("UTF-8"),
        }
    }

    /// Checks that this is on standard output.
    #[track_caller]
    pub fn prints(&self, part: &str) {
        assert!(self.out.contains(part), "no {part:?} in\n{}", self.out);
    }

    /// Checks that standard output begins with this.
    #[track_caller]
    pub fn prints_first(&self, part: &str) {
        assert!(
            self.out.starts_with(part),
            "{part:?} does not begin\n{}",
            self.out
        );
    }

    /// Checks that standard output ends with this.
    #[track_caller]
    pub fn prints_last(&self, part: &str) {
        assert!(self.out.ends_with(part), "{part:?} does not end\n{}", self.out);
    }

    /// Checks that this is on standard error.
    #[track_caller]
    pub fn complains(&self, part: &str) {
        assert!(self.err.contains(part), "no {part:?} in\n{}", self.err);
    }

    /// Checks that standard error begins with this.
    #[track_caller]
    pub fn complains_first(&self, part: &str) {
        assert!(
            self.err.starts_with(part),
            "{part:?} does not begin\n{}",
            self.err
        );
    }

    /// The answer to `--json`, checked: one line, which fulfils the program's own schema.
    #[track_caller]
    pub fn answer(&self) -> Value {
        assert_eq!(self.out.lines().count(), 1, "{}", self.out);
        let answer = serde_json::from_str(&self.out).expect("JSON");
        let schema = ended(&mut command(&["schema", "json"])).out;
        if let Some(schema) = standstill_testkit::peers::Schema::new(&schema) {
            assert_eq!(schema.check(&self.out), Ok(()), "{answer}");
        }
        answer
    }
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
    Ended::of(command.output().expect("the program starts"))
}

/// Runs the program with these arguments in a folder.
pub fn standstill(folder: &Path, arguments: &[&str]) -> Ended {
    ended(command(arguments).current_dir(folder))
}

/// Runs the program in a folder with a line of arguments, as one types them.
pub fn typed(folder: &Path, arguments: &str) -> Ended {
    let arguments: Vec<&str> = arguments.split(' ').collect();
    standstill(folder, &arguments)
}

/// Runs the program with these arguments in a folder, with this limit of `ulimit`.
#[cfg(unix)]
pub fn limited(limit: &str, folder: &Path, arguments: &[&str]) -> Ended {
    let mut shell = Command::new("sh");
    shell.args(["-c", &format!("ulimit {limit}; exec \"$@\""), "sh"]);
    shell.arg(env!("CARGO_BIN_EXE_standstill")).args(arguments);
    shell.env_remove("CI").env_remove("INSTA_UPDATE");
    ended(shell.current_dir(folder))
}

/// The status and the messages of the program if its output has no reader.
pub fn unread(folder: &Path, arguments: &[&str]) -> (Option<i32>, String) {
    let (reader, writer) = pipe().expect("a pipe");
    drop(reader);
    let mut command = command(arguments);
    let piped = command.current_dir(folder).stdout(writer).stderr(Stdio::piped());
    let output = piped.output().expect("the program starts");
    (
        output.status.code(),
        String::from_utf8_lossy(&output.stderr).into_owned(),
    )
}

/// Runs the program with this standard input.
pub fn fed(arguments: &[&str], input: &[u8]) -> Ended {
    fed_to(&mut command(arguments), input)
}

/// The same for a command.
pub fn fed_to(command: &mut Command, input: &[u8]) -> Ended {
    let piped = command
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    thread::scope(|scope| {
        // In parallel with reading its output, or both sides could wait for each other.
        scope.spawn(move || stdin.write_all(input).expect("it reads all"));
        Ended::of(child.wait_with_output().expect("it ends"))
    })
}

/// An empty folder for the test of this name.
pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder to write to");
    folder
}

/// [`SCRIPT`] with a claim that fails: the move would have to take two scans less.
pub fn late() -> String {
    SCRIPT.replace("\"at\": 21", "\"at\": 19")
}

/// Makes a named pipe.
#[cfg(unix)]
pub fn fifo(path: &Path) {
    let made = Command::new("mkfifo").arg(path).status();
    assert!(made.expect("every Unix has it").success());
}

/// The root of the repository.
pub fn root() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("../..")
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
