//! The end of the program after an error of its environment.

use crate::support::{command, ended, standstill, unread, with_script, write};
use std::io::Write;
use std::process::Stdio;

#[test]
fn a_closed_pipe_ends_quietly() {
    let folder = with_script("ends_pipe");
    // The status is that of the result: a claim fails at another velocity, and there is no golden yet.
    for (arguments, status) in [
        (&["run", "move.scan.json"][..], 0),
        (&["run", "-q", "--set", "v=2", "move.scan.json"], 1),
        (&["test", "move.scan.json"], 1),
        (&["blocks", "--json"], 0),
        (&["blocks"], 0),
        (&["schema"], 0),
        (&["--help"], 0),
    ] {
        assert_eq!(
            unread(&folder, arguments),
            (Some(status), String::new()),
            "{arguments:?}"
        );
    }
    write(&folder, "lines.jsonl", "{\"Ts\":0.01}\n");
    for (arguments, status) in [
        (&["plan", "lines.jsonl"][..], 1),
        (&["run", "move.scan.json", "absent.scan.json"], 4),
        (&["rum"], 2),
    ] {
        assert_eq!(unread(&folder, arguments).0, Some(status), "{arguments:?}");
    }
}

#[test]
#[cfg(unix)]
fn a_file_that_is_a_closed_pipe_ends_quietly() {
    let folder = with_script("ends_named_pipe");
    write(
        &folder,
        "line.jsonl",
        r#"{"Ts":0.01,"target":1,"limits":{"velocity":1}}"#,
    );
    for (arguments, status) in [
        (&["run", "-q", "move.scan.json", "--svg", "/dev/stdout"][..], 0),
        (
            &[
                "run",
                "-q",
                "--set",
                "v=2",
                "move.scan.json",
                "--report",
                "/dev/stdout",
            ],
            1,
        ),
        (&["plan", "line.jsonl", "--samples", "/dev/stdout"], 0),
    ] {
        assert_eq!(
            unread(&folder, arguments),
            (Some(status), String::new()),
            "{arguments:?}"
        );
    }
}

#[test]
fn a_pipe_that_closes_in_between_ends_quietly() {
    let mut child = command(&["plan"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::piped())
        .spawn()
        .expect("the program starts");
    let mut stdin = child.stdin.take().expect("a pipe");
    drop(child.stdout.take());
    // It may stop reading before everything is written.
    while writeln!(stdin, r#"{{"Ts":0.01,"target":1,"limits":{{"velocity":1}}}}"#).is_ok() {}
    let output = child.wait_with_output().expect("it ends");
    assert_eq!(
        (output.status.code(), output.stderr.as_slice()),
        (Some(0), &b""[..])
    );
}

#[test]
#[cfg(target_os = "linux")]
fn a_full_disk_is_an_error_of_io() {
    let full = std::fs::File::options()
        .write(true)
        .open("/dev/full")
        .expect("Linux has it");
    let output = command(&["blocks"])
        .stdout(full)
        .stderr(Stdio::piped())
        .output()
        .expect("it starts");
    assert_eq!(output.status.code(), Some(4));
    assert!(String::from_utf8_lossy(&output.stderr).starts_with("error: standard output: "));
}

#[test]
fn bad_usage_is_told_before_anything_runs() {
    let folder = with_script("ends_usage");
    for (arguments, message) in [
        (&[][..], "Usage: standstill [OPTIONS] <COMMAND>"),
        (&["rum"], "a similar subcommand exists: 'run'"),
        (&["run"], "required arguments were not provided"),
        (
            &["run", "--trase", "a.csv", "x"],
            "a similar argument exists: '--trace'",
        ),
        (
            &["run", "--trace", "a.txt", "move.scan.json"],
            "--trace a.txt: a trace is a .csv or a .jsonl file",
        ),
        (
            &["run", "--trace", "a.csv", "move.scan.json", "move.scan.json"],
            "--trace takes one script",
        ),
        (&["explain", "a.csv"], "required arguments were not provided"),
    ] {
        let ended = standstill(&folder, arguments);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{arguments:?}");
        ended.complains(message);
    }
    assert!(!folder.join("a.csv").exists());
}

#[test]
fn files_that_are_not_there_are_errors_of_io() {
    let folder = with_script("ends_io");
    for (arguments, name) in [
        (&["run", "absent.scan.json"][..], "absent.scan.json"),
        (&["test", "absent"], "absent"),
        (&["fmt", "absent"], "absent"),
        (&["plan", "absent.jsonl"], "absent.jsonl"),
        (
            &["run", "-q", "--trace", "absent/a.csv", "move.scan.json"],
            "absent/a.csv",
        ),
    ] {
        let ended = standstill(&folder, arguments);
        assert_eq!(ended.status, 4, "{arguments:?}");
        ended.complains_first(&format!("error: {name}: "));
    }
}

#[test]
fn no_colours_reach_a_file_or_a_pipe() {
    let folder = with_script("ends_colours");
    for arguments in [&["rum"][..], &["--help"], &["run", "absent"]] {
        let ended = ended(command(arguments).current_dir(&folder).env("NO_COLOR", "1"));
        assert!(
            !ended.out.contains('\x1b') && !ended.err.contains('\x1b'),
            "{arguments:?}"
        );
    }
}
