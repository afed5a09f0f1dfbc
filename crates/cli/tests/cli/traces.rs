//! Traces, written and compared.

use crate::support::{Ended, read, standstill, with_script, write};
use std::path::{Path, PathBuf};

/// A folder with the trace of the script in both forms, and that of a slower run.
fn traces(name: &str) -> PathBuf {
    let folder = with_script(name);
    for (file, set) in [("a.csv", "v=10"), ("a.jsonl", "v=10"), ("slow.csv", "v=2")] {
        let status = standstill(
            &folder,
            &["run", "-q", "move.scan.json", "--set", set, "--trace", file],
        )
        .status;
        assert_eq!(status, i32::from(file == "slow.csv"));
    }
    folder
}

fn explain(folder: &Path, expected: &str, found: &str) -> Ended {
    standstill(folder, &["explain", expected, found])
}

#[test]
fn a_trace_has_one_row_a_scan_and_its_header_beside_it() {
    let folder = traces("traces_written");
    let csv = read(&folder, "a.csv");
    assert!(csv.starts_with("scan,time_ns,X.State,X.Position,X.Velocity,"));
    assert_eq!(csv.lines().count(), 31);
    assert!(read(&folder, "a.csv.meta.json").starts_with("{\"standstill_trace\":1,"));
    assert_eq!(read(&folder, "a.jsonl").lines().count(), 31);
}

#[test]
fn both_forms_hold_the_same_bits() {
    let folder = traces("traces_equal");
    let ended = explain(&folder, "a.csv", "a.jsonl");
    assert_eq!(
        (ended.status, ended.out.as_str()),
        (0, "a.csv and a.jsonl are equal to the bit\n")
    );
}

#[test]
fn the_first_difference_is_explained() {
    let folder = traces("traces_differ");
    let ended = explain(&folder, "a.csv", "slow.csv");
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    ended.prints_first("expected: a.csv\nfound:    slow.csv\nfirst difference in scan ");
    ended.prints("move.Velocity");
}

#[test]
fn the_story_is_there_as_json() {
    let folder = traces("traces_json");
    let json = |found: &str, status: i32| {
        let ended = standstill(&folder, &["explain", "a.csv", found, "--json"]);
        assert_eq!((ended.status, ended.err.as_str()), (status, ""));
        ended.answer()
    };
    let same = json("a.jsonl", 0);
    assert_eq!(
        (&same["passed"], &same["found"], same.get("story")),
        (&true.into(), &"a.jsonl".into(), None)
    );
    let slow = json("slow.csv", 1);
    assert_eq!(
        (&slow["command"], &slow["passed"], &slow["status"]),
        (&"explain".into(), &false.into(), &1.into())
    );
    let story = &slow["story"];
    let first = &story["first"];
    assert_eq!(first["scan"], 0);
    let signals = first["signals"].as_array().unwrap();
    assert!(
        signals.iter().any(|signal| {
            (&signal["signal"], &signal["expected"], &signal["found"])
                == (&"move.Velocity".into(), &"10.0".into(), &"2.0".into())
        }),
        "{signals:?}"
    );
    assert!(
        story["causes"][0]
            .as_str()
            .unwrap()
            .starts_with("a changed parameter: move.Velocity")
    );
    let text = explain(&folder, "a.csv", "slow.csv").out;
    assert!(text.trim_end().ends_with(story["text"].as_str().unwrap()));
}

#[test]
fn other_lengths_and_cycles_are_told_as_such() {
    let folder = traces("traces_lengths");
    let text = read(&folder, "move.scan.json");
    for (file, from, to, cause) in [
        (
            "short.csv",
            "\"scans\": 30",
            "\"scans\": 25",
            "one run is longer: expected 30 scans, found 25",
        ),
        (
            "cycle.csv",
            "T#10ms",
            "T#20ms",
            "another cycle: expected T#10ms, found T#20ms",
        ),
    ] {
        write(&folder, "other.scan.json", &text.replace(from, to));
        standstill(&folder, &["run", "-q", "other.scan.json", "--trace", file]);
        let ended = explain(&folder, "a.csv", file);
        assert_eq!(ended.status, 1);
        ended.prints(&format!("likely cause\n  {cause}"));
    }
}

#[test]
fn what_a_trace_lacks_is_said() {
    let folder = traces("traces_lack");
    std::fs::remove_file(folder.join("a.csv.meta.json")).unwrap();
    let ended = explain(&folder, "a.csv", "a.jsonl");
    ended.complains_first("note: a.csv lacks ");
}

#[test]
fn a_file_that_is_no_trace_is_told_apart_from_one_that_is_not_there() {
    let folder = traces("traces_wrong");
    write(
        &folder,
        "wrong.csv",
        "scan,time_ns,X.Position\n0,0,zero\nnonsense\n",
    );
    std::fs::write(folder.join("bytes.csv"), b"scan,time_ns\n\xff,0\n").unwrap();
    let (csv, jsonl) = (read(&folder, "a.csv"), read(&folder, "a.jsonl"));
    write(&folder, "cut.csv", &csv[..csv.len() / 2]);
    write(&folder, "cut.jsonl", &jsonl[..jsonl.len() / 2]);
    write(&folder, "foreign.csv", "Name;Time [ms];Pos\nX;1;2\n");
    std::fs::write(folder.join("cut.exact"), b"standstill").unwrap();
    for (file, status, message) in [
        ("wrong.csv", 3, "wrong.csv: "),
        ("cut.csv", 3, "cut.csv: line "),
        ("cut.jsonl", 3, "cut.jsonl: line "),
        ("cut.exact", 3, "cut.exact: "),
        (
            "foreign.csv",
            3,
            "a trace begins with the columns `scan` and `time_ns`",
        ),
        ("bytes.csv", 3, "bytes.csv: "),
        ("absent.csv", 4, "absent.csv: "),
        (
            "move.scan.json",
            2,
            "a trace is a .csv, .jsonl or (for reading) .exact file",
        ),
    ] {
        let ended = explain(&folder, "a.csv", file);
        assert_eq!(
            (ended.status, ended.out.as_str()),
            (status, ""),
            "{file}: {}",
            ended.err
        );
        ended.complains(message);
    }
}
