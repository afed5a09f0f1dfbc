//! Runs of more scans than rows are kept of: the same text except for the drawing, constant memory, and a
//! trace file with whole rows after every kind of end.

#[cfg(target_os = "linux")]
use crate::support::limited;
use crate::support::{Ended, command, ended, read, scratch, standstill, unread, write};
use std::path::{Path, PathBuf};
use std::process::Stdio;

/// A timer that repeats for a long time; `ENDS` ends the run by itself.
const SCRIPT: &str = r#"{
  "standstill": 1, "title": "A long run", "cycle": "T#1ms", "scans": 1000000000, ENDS
  "axes": {"X": {"unit": "mm", "limits": {"velocity": 20, "acceleration": 100}, "state": "Standstill"}},
  "inputs": {"GO": false},
  "blocks": [
    {"name": "move", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Position": 1, "Velocity": 10}},
    {"name": "t", "type": "TON", "pins": {"IN": {"not": "t.Q"}, "PT": "T#4s"}}
  ],
  "steps": [{"at": 1, "set": {"GO": true}}],
  "expect": [{"never": {"move.Error": true}}, {"by": 400, "that": {"X.Position": 1}}, {"always": {"X.Velocity": {"le": 10.001}}}]
}
"#;

/// A folder with the script as `long.scan.json`, which ends after 10,000 scans, and as `endless.scan.json`.
fn with_scripts(name: &str) -> PathBuf {
    let folder = scratch(name);
    let ends = r#""stop_when": {"t.Q": true}, "after": 5999,"#;
    write(&folder, "long.scan.json", &SCRIPT.replace("ENDS", ends));
    write(&folder, "endless.scan.json", &SCRIPT.replace("ENDS", ""));
    let short = SCRIPT.replace("ENDS", ends).replace("1000000000", "20000");
    write(&folder, "short.scan.json", &short);
    folder
}

/// The paragraphs of a text, without the drawing or its replacement.
fn without_drawing(text: &str) -> String {
    let is_drawn = |part: &str| {
        let curve = ["X.Position (", "X.Velocity ("]
            .iter()
            .any(|name| part.starts_with(name));
        curve || part.contains("no drawing: ") || part.contains("scan 0 ")
    };
    let paragraphs = text.split("\n\n").filter(|part| !is_drawn(part));
    paragraphs.collect::<Vec<_>>().join("\n\n")
}

#[test]
fn a_long_run_tells_what_a_short_one_tells_but_draws_nothing() {
    let folder = with_scripts("long_text");
    let long = standstill(&folder, &["run", "long.scan.json", "--trace", "long.csv"]);
    let short = standstill(&folder, &["run", "short.scan.json", "--trace", "short.csv"]);
    assert_eq!((long.status, long.err.as_str()), (0, ""), "{}", long.out);
    long.prints("\nno drawing: 10000 scans are");
    // Columns are as wide as the script may need them.
    let same = |text: &str| {
        let words = |line: &str| line.split_whitespace().collect::<Vec<_>>().join(" ");
        let lines: Vec<_> = without_drawing(text).lines().map(words).collect();
        lines.join("\n").replace("short.scan", "long.scan")
    };
    assert_eq!(same(&long.out), same(&short.out));
    assert!(same(&long.out).contains("long.scan.json: passed, 3 of 3 claims, 10000 scans, digest "));
    assert_eq!(read(&folder, "long.csv"), read(&folder, "short.csv"));
    // Except for the parts that differ between scripts.
    let meta = |name: &str| {
        let mut meta: serde_json::Value = serde_json::from_str(&read(&folder, name)).expect("JSON");
        meta.as_object_mut().expect("an object").remove("script_hash");
        meta
    };
    assert_eq!(meta("long.csv.meta.json"), meta("short.csv.meta.json"));
    assert!(!folder.join("long.csv.partial").exists());
}

/// Programs that were left out should have seen the event, which is behind the first written rows.
#[test]
fn a_run_that_is_broken_off_goes_on_scan_by_scan_where_it_had_told_of() {
    let folder = scratch("long_broken");
    let script = r#"{
      "standstill": 1, "title": "Out of numbers", "cycle": "T#1s", "scans": 1000000000,
      "stop_when": {"X.State": "ErrorStop"}, "after": 5000,
      "axes": {"X": {"unit": "m", "limits": {"velocity": 3e304, "acceleration": 3e304}, "state": "Standstill"}},
      "inputs": {"GO": false},
      "blocks": [
        {"name": "move", "type": "MC_MoveVelocity", "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Velocity": 3e304}}
      ],
      "steps": [{"at": 5, "set": {"GO": true}}],
      "expect": [{"never": {"X.Velocity": {"gt": 3e304}}}]
    }"#;
    write(&folder, "long.scan.json", script);
    write(&folder, "short.scan.json", &script.replace("1000000000", "20000"));
    let long = standstill(&folder, &["run", "long.scan.json", "--trace", "long.csv"]);
    let short = standstill(&folder, &["run", "short.scan.json", "--trace", "short.csv"]);
    assert_eq!((long.status, long.err.as_str()), (0, ""), "{}", long.out);
    assert_eq!(long.out.matches("SetpointBroken").count(), 1, "{}", long.out);
    let verdict = |ended: &Ended| {
        ended
            .out
            .trim_end()
            .rsplit(": passed, ")
            .next()
            .map(str::to_owned)
    };
    assert!(verdict(&long).is_some_and(|verdict| verdict.starts_with("1 of 1 claims, 10999 scans, digest ")));
    assert_eq!(verdict(&long), verdict(&short));
    assert_eq!(read(&folder, "long.csv"), read(&folder, "short.csv"));
}

#[test]
fn a_streamed_trace_is_read_like_any_other() {
    let folder = with_scripts("long_jsonl");
    let run = standstill(&folder, &["run", "-q", "long.scan.json", "--trace", "a.jsonl"]);
    assert_eq!(run.status, 0, "{}", run.err);
    let text = read(&folder, "a.jsonl");
    let (first, last) = (text.lines().next(), text.lines().last());
    assert!(
        last.is_some_and(|line| line.contains(r#","notes":[{"scan":1,"subject":"#)),
        "{last:?}"
    );
    assert!(first.is_some_and(|line| !line.contains("verdict")), "{first:?}");
    assert!(
        last.is_some_and(
            |line| line.starts_with(r#"{"standstill_trace_end":1,"claims":[{"path":"expect[0]""#)
        ),
        "{last:?}"
    );
    standstill(&folder, &["run", "-q", "short.scan.json", "--trace", "b.jsonl"]);
    let same = standstill(&folder, &["explain", "a.jsonl", "b.jsonl"]);
    assert_eq!(same.status, 0, "{}{}", same.out, same.err);
    let page = standstill(&folder, &["report", "a.jsonl", "-o", "a.html"]);
    assert_eq!(page.status, 0, "{}", page.err);
}

/// Additional data of a trace are written beside it, not in the system's folder for temporary files.
#[test]
fn a_long_run_needs_no_folder_but_that_of_its_trace() {
    let folder = with_scripts("long_temporary");
    let mut run = command(&["run", "-q", "long.scan.json", "--trace", "x.csv"]);
    let run = ended(run.current_dir(&folder).env("TMPDIR", folder.join("nowhere")));
    assert_eq!((run.status, run.err.as_str()), (0, ""));
    assert_eq!(rows(&folder, "x.csv"), 10_000);
}

#[test]
fn failing_claims_are_told_as_ever_and_where_their_cause_is_to_be_looked_for() {
    let folder = with_scripts("long_fails");
    let text = read(&folder, "long.scan.json").replace("10.001", "9.001");
    write(&folder, "long.scan.json", &text);
    write(&folder, "short.scan.json", &text.replace("1000000000", "20000"));
    let long = standstill(&folder, &["run", "-q", "long.scan.json"]);
    let short = standstill(&folder, &["run", "-q", "short.scan.json"]);
    assert_eq!((long.status, short.status), (1, 1), "{}", long.err);
    let claim = |ended: &Ended| ended.out.lines().next().map(str::to_owned);
    assert_eq!(claim(&long), claim(&short));
    assert!(claim(&long).is_some_and(|line| line.contains("expect[2].always.X.Velocity: ")));
    long.complains("set `scans` to 1000000 at most");
}

#[test]
fn pages_and_pictures_of_a_long_run_are_refused_with_what_to_do() {
    let folder = with_scripts("long_refused");
    for option in ["--report", "--svg", "--vcd"] {
        let run = standstill(&folder, &["run", "long.scan.json", option, "a.out"]);
        assert_eq!((run.status, run.out.as_str()), (2, ""));
        let said = "needs all rows at once, and long.scan.json has 1000000000 scans";
        assert!(
            run.err.contains(said) && run.err.contains("lower `scans`"),
            "{}",
            run.err
        );
        assert!(!folder.join("a.out").exists());
    }
    let test = standstill(&folder, &["test", "long.scan.json"]);
    assert_eq!(test.status, 3);
    test.complains("`standstill run` keeps no rows");
}

/// The rows of a partial file, all of them whole.
fn rows(folder: &Path, name: &str) -> usize {
    let text = read(folder, name);
    assert!(text.ends_with('\n'), "the last row is whole");
    let columns = text.lines().next().map_or(0, |line| line.split(',').count());
    for (scan, line) in text.lines().skip(1).enumerate() {
        assert!(line.starts_with(&format!("{scan},")), "{line}");
        assert_eq!(line.split(',').count(), columns, "{line}");
    }
    text.lines().count() - 1
}

#[cfg(target_os = "linux")]
#[test]
fn a_disk_that_fills_leaves_whole_rows_and_says_where() {
    let folder = with_scripts("long_full");
    write(&folder, "x.csv", "what was there\n");
    // A file that may not grow fails as a full disk does, and needs no special system. The signal that comes with
    // it ends nothing.
    let endless = ["run", "-q", "endless.scan.json", "--trace", "x.csv"];
    let run = limited("-f 100", &folder, &endless);
    assert_eq!(run.status, 4, "{}", run.err);
    let rows = rows(&folder, "x.csv.partial");
    assert!(rows > 100, "{rows}");
    let said = format!("; the first {rows} rows are in x.csv.partial\n");
    assert!(
        run.err.starts_with("error: x.csv: ") && run.err.ends_with(&said),
        "{}",
        run.err
    );
    assert_eq!(read(&folder, "x.csv"), "what was there\n");
    // The next run takes its place.
    let run = standstill(&folder, &["run", "-q", "long.scan.json", "--trace", "x.csv"]);
    assert_eq!((run.status, folder.join("x.csv.partial").exists()), (0, false));
    assert_eq!(self::rows(&folder, "x.csv"), 10_000);
}

#[cfg(unix)]
#[test]
fn a_device_that_is_full_is_an_error_of_io_and_a_link_is_not_followed() {
    let folder = with_scripts("long_device");
    let link = |to: &str, name: &str| std::os::unix::fs::symlink(to, folder.join(name)).expect("a link");
    if Path::new("/dev/full").exists() {
        link("/dev/full", "full.csv");
        let run = standstill(&folder, &["run", "-q", "long.scan.json", "--trace", "full.csv"]);
        assert_eq!(run.status, 4);
        run.complains_first("error: full.csv: ");
        assert!(!folder.join("full.csv.partial").exists());
    }
    write(&folder, "other.txt", "not to be touched\n");
    link("other.txt", "a.csv.partial");
    let run = standstill(&folder, &["run", "-q", "long.scan.json", "--trace", "a.csv"]);
    assert_eq!(run.status, 4);
    run.complains("a.csv.partial: this is no file that could be replaced");
    link("other.txt", "b.csv");
    let run = standstill(&folder, &["run", "-q", "long.scan.json", "--trace", "b.csv"]);
    assert_eq!(run.status, 0, "{}", run.err);
    assert_eq!(read(&folder, "other.txt"), "not to be touched\n");
}

#[cfg(unix)]
#[test]
fn a_signal_leaves_whole_rows_and_a_kill_at_most_one_that_is_torn() {
    use rustix::process::{Pid, Signal, kill_process};
    use std::os::unix::process::ExitStatusExt;
    for (signal, is_told) in [(Signal::TERM, true), (Signal::INT, true), (Signal::KILL, false)] {
        let folder = with_scripts("long_signal");
        let mut run = command(&["run", "-q", "endless.scan.json", "--trace", "x.csv"]);
        run.current_dir(&folder)
            .stdout(Stdio::null())
            .stderr(Stdio::piped());
        let run = run.spawn().expect("it starts");
        let partial = folder.join("x.csv.partial");
        while std::fs::metadata(&partial).map_or(0, |found| found.len()) < 100_000 {
            std::thread::yield_now();
        }
        kill_process(Pid::from_child(&run), signal).expect("a signal");
        let output = run.wait_with_output().expect("it ends");
        assert_eq!(output.status.signal(), Some(signal.as_raw()));
        let said = String::from_utf8_lossy(&output.stderr);
        if is_told {
            let rows = rows(&folder, "x.csv.partial");
            let expected = format!("the run came to no end; its first {rows} rows are in x.csv.partial\n");
            assert_eq!(said, expected);
        } else {
            let text = read(&folder, "x.csv.partial");
            let whole = text.rfind('\n').map_or(0, |end| end + 1);
            write(&folder, "x.csv.partial", &text[..whole]);
            assert!(rows(&folder, "x.csv.partial") > 100);
        }
        assert!(!folder.join("x.csv").exists());
    }
}

#[test]
fn a_closed_pipe_changes_nothing_of_the_verdict() {
    let folder = with_scripts("long_pipe");
    let run = ["run", "long.scan.json", "--trace", "x.csv"];
    assert_eq!(unread(&folder, &run), (Some(0), String::new()));
    assert_eq!(rows(&folder, "x.csv"), 10_000);
}
