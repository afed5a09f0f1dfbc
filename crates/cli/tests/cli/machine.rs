//! `standstill compare`: recordings in the forms of common tools against a trace, and all errors.

use crate::support::{Ended, standstill, with_script, write};
use std::fs;
use std::path::{Path, PathBuf};

/// A map for `logger.csv`; tests replace parts of it.
const LOGGER: &str = r#"{
  "standstill_compare": 1,
  "recording": {"time": {"column": "time", "unit": "s"}},
  "offset": "T#0s",
  "time_tolerance": "T#20ms",
  "signals": {
    "X.Position": {"column": "pos, mm", "tolerance": 0.0001},
    "move.Done": {"column": "done"},
    "move.ErrorID": {"column": "err"}
  }
}
"#;

/// A folder with the trace of the script and the recordings.
fn folder(name: &str) -> PathBuf {
    let folder = with_script(name);
    let ended = standstill(&folder, &["run", "-q", "move.scan.json", "--trace", "t.csv"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    let data = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests/data/compare");
    for file in ["logger.csv", "plc_trace.csv"] {
        fs::copy(data.join(file), folder.join(file)).unwrap();
    }
    folder
}

fn compare(folder: &Path, recording: &str, map: &str) -> Ended {
    write(folder, "map.json", map);
    standstill(folder, &["compare", recording, "t.csv", "--map", "map.json"])
}

/// The logger's map with one piece replaced.
fn logger_with(from: &str, to: &str) -> String {
    assert!(LOGGER.contains(from), "{from}");
    LOGGER.replacen(from, to, 1)
}

#[test]
fn a_plain_log_agrees_with_its_own_run() {
    let folder = folder("machine_logger");
    let ended = compare(&folder, "logger.csv", LOGGER);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    insta::assert_snapshot!(ended.out, @r"
    recording  logger.csv, 15 rows, cells between `,`, decimals behind `.`
    offset     T#0s, as the map says
    compared   scans 0 to 28 of 0 to 29, T#0s to T#280ms
      holds  X.Position    off by 0.0 at most, in scan 0; tolerance 0.0001 within T#20ms
      holds  move.Done     1 edge agrees, T#10ms apart at most; tolerance T#20ms
      holds  move.ErrorID  0 edges agree; tolerance T#20ms
    passed, 3 of 3 signals
    ");
}

#[test]
fn a_plc_trace_with_times_of_its_own_is_aligned_by_an_edge() {
    let folder = folder("machine_plc");
    let map = r#"{
      "standstill_compare": 1,
      "recording": {"time": {"column": "Timestamp [µs]", "unit": "us"}},
      "offset": {"edge": "move.Done", "to": true},
      "time_tolerance": "T#10ms",
      "signals": {
        "X.Position": {"column": "PLC_PRG.axis.fActPos", "factor": 0.1, "tolerance": 0.0001},
        "move.Done": {"column": "PLC_PRG.mc.Done"},
        "X.State": {"column": "PLC_PRG.axis.eState", "values": {"3": "Standstill", "4": "DiscreteMotion"}}
      }
    }"#;
    let ended = compare(&folder, "plc_trace.csv", map);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    insta::assert_snapshot!(ended.out, @r"
    recording  plc_trace.csv, 42 rows, cells between `;`, decimals behind `,`
    offset     T#21ms, edge 1 of move.Done to TRUE
    compared   scans 0 to 26 of 0 to 29, T#0s to T#260ms
               of the recording's T#287ms not compared: T#21ms before, T#0s behind
      holds  X.Position  off by 0.0 at most, in scan 0; tolerance 0.0001 within T#10ms
      holds  move.Done   1 edge agrees, T#0s apart at most; tolerance T#10ms
      holds  X.State     2 edges agree, T#4ms apart at most; tolerance T#10ms
    passed, 3 of 3 signals
    ");
}

#[test]
fn every_tolerance_is_held() {
    let folder = folder("machine_tolerances");
    for (from, to) in [
        // The log has 4 digits, and samples of 20 ms.
        (
            "\"tolerance\": 0.0001",
            "\"tolerance\": 0.0001, \"time_tolerance\": \"T#0s\"",
        ),
        (
            "\"column\": \"done\"",
            "\"column\": \"done\", \"time_tolerance\": \"T#9ms\"",
        ),
        ("\"column\": \"done\"", "\"column\": \"done\", \"invert\": true"),
        ("\"column\": \"err\"", "\"column\": \"done\""),
        ("\"tolerance\": 0.0001", "\"tolerance\": 0.0001, \"sign\": -1"),
        ("\"tolerance\": 0.0001", "\"tolerance\": 0.0001, \"factor\": 1.01"),
        ("\"tolerance\": 0.0001", "\"tolerance\": 0.0001, \"zero\": 0.001"),
        ("\"T#0s\"", "\"T#40ms\""),
    ] {
        let ended = compare(&folder, "logger.csv", &logger_with(from, to));
        assert_eq!((ended.status, ended.err.as_str()), (1, ""), "{to}: {}", ended.out);
        assert!(ended.out.contains("FAILS"), "{to}: {}", ended.out);
        assert!(ended.out.contains("\nFAILED, "), "{to}: {}", ended.out);
    }
}

#[test]
fn a_bad_map_is_shown_where_it_is_bad() {
    let folder = folder("machine_bad_map");
    for (from, to, place, message) in [
        (
            "\"X.Position\"",
            "\"X.Positoin\"",
            "7:5",
            "did you mean `X.Position`?",
        ),
        (
            "\"tolerance\": 0.0001",
            "\"tolerance\": -1",
            "7:54",
            "must be 0 or more",
        ),
        (", \"tolerance\": 0.0001", "", "7:19", "needs the key `tolerance`"),
        ("\"column\": \"pos, mm\", ", "", "7:19", "needs the key `column`"),
        ("\"pos, mm\"", "\"\"", "7:30", "names no column"),
        ("\"pos, mm\"", "0", "7:30", "whole number from 1"),
        ("0.0001", "0, \"factor\": 0", "7:67", "`factor` is 0"),
        ("0.0001", "0, \"sign\": 2", "7:65", "must be 1 or -1"),
        (
            "\"done\"",
            "\"done\", \"tolerance\": 1",
            "8:37",
            "unknown key `tolerance`",
        ),
        ("\"T#0s\"", "0", "4:13", "a TIME literal or an object"),
        (
            "\"T#0s\"",
            "{\"edge\": \"X.Position\", \"to\": true}",
            "4:22",
            "has no edges",
        ),
        (
            "\"T#0s\"",
            "{\"edge\": \"move.Busy\", \"to\": true}",
            "4:22",
            "`signals` has no `move.Busy`",
        ),
        (
            "\"T#0s\"",
            "{\"fit\": \"X.Position\", \"from\": \"T#-1h\", \"to\": \"T#1h\"}",
            "4:13",
            "more than 4000 scans",
        ),
        ("\"s\"", "\"min\"", "3:52", "`unit` cannot be `min`"),
        (
            "\"standstill_compare\": 1",
            "\"standstill_compare\": 2",
            "2:25",
            "version 2",
        ),
        ("\"T#20ms\"", "\"T#-1ms\"", "5:21", "is negative"),
    ] {
        let ended = compare(&folder, "logger.csv", &logger_with(from, to));
        assert_eq!((ended.status, ended.out.as_str()), (3, ""), "{to}: {}", ended.err);
        assert!(
            ended.err.contains(&format!("map.json:{place}")),
            "{to}: {}",
            ended.err
        );
        ended.complains(message);
    }
    let (start, _) = LOGGER.split_once("\"signals\"").unwrap();
    let ended = compare(&folder, "logger.csv", &format!("{start}\"signals\": {{}}}}"));
    assert_eq!(ended.status, 3);
    ended.complains("the map names no column");
}

#[test]
fn a_bad_recording_is_named_with_line_and_column() {
    let folder = folder("machine_bad_recording");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    let cut = good.rsplit_once(",1,0").unwrap().0;
    for (text, message) in [
        (
            cut.to_owned(),
            "bad.csv: line 17: the line ends behind 2 cells, before that of move.Done: the file is cut short",
        ),
        (
            good.replace("done", "ready"),
            "bad.csv: line 1: no column `done`, which the map names for move.Done; this line names `time`, `pos, mm`, `ready`, `err`",
        ),
        (
            good.replace("err", "done"),
            "bad.csv: line 1: columns 3 and 4 are both called `done`: give the number of the one for move.Done",
        ),
        (
            good.replace("0.06,", "0.04,"),
            "bad.csv: line 6: the time of X.Position does not rise",
        ),
        (
            good.replace("0.06,", "0;06,"),
            "bad.csv: line 6, column 1: `0;06`: no time",
        ),
        (
            good.replace("1.0000,1,0", "1.0000,2,0"),
            "`2`: neither TRUE nor FALSE, neither 1 nor 0",
        ),
        (
            good.replace(",0\n", ",0.5\n"),
            "bad.csv: line 3, column 15: `0.5`: no whole number",
        ),
        (
            "time,\"pos, mm\",done,err\n".to_owned(),
            "bad.csv: line 1: no rows of numbers below the line of names",
        ),
        (String::new(), "names a column that the map names"),
        ("<html>\n<body>\n".to_owned(), "is it the right file"),
        (
            "PK\u{3}\0\0".to_owned(),
            "this is no text: export the recording as CSV",
        ),
    ] {
        write(&folder, "bad.csv", &text);
        let ended = compare(&folder, "bad.csv", LOGGER);
        assert_eq!(
            (ended.status, ended.out.as_str()),
            (3, ""),
            "{message}: {}",
            ended.err
        );
        ended.complains(message);
    }
    let ended = compare(&folder, "absent.csv", LOGGER);
    assert_eq!((ended.status, ended.out.as_str()), (4, ""));
    ended.complains("absent.csv: ");
    let ended = compare(&folder, "t.csv.meta.json", LOGGER);
    assert_eq!(ended.status, 3, "{}", ended.err);
}

#[test]
fn decimal_marks_must_agree() {
    let folder = folder("machine_decimals");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    let body = good
        .replace("\"pos, mm\"", "pos")
        .replace(',', ";")
        .replace('.', ",");
    let map = LOGGER.replace("pos, mm", "pos");
    write(&folder, "comma.csv", &body);
    assert_eq!(compare(&folder, "comma.csv", &map).status, 0);
    write(&folder, "mixed.csv", &body.replace("0,1800", "0.1800"));
    let ended = compare(&folder, "mixed.csv", &map);
    assert_eq!(ended.status, 3);
    let message = "mixed.csv: line 6, column 6: `0.1800`: `.` where decimals stand behind `,`, as line 3 has";
    ended.complains(message);
    let ended = compare(
        &folder,
        "comma.csv",
        &map.replace("\"recording\": {", "\"recording\": {\"decimal\": \".\", "),
    );
    assert_eq!(ended.status, 3);
}

#[test]
fn lengths_may_differ_but_the_window_must_be_there() {
    let folder = folder("machine_lengths");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    let short: Vec<_> = good.lines().take(10).collect();
    write(&folder, "short.csv", &(short.join("\n") + "\n"));
    let ended = compare(&folder, "short.csv", LOGGER);
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
    ended.prints("compared   scans 0 to 14 of 0 to 29");
    let windowed = logger_with(
        "\"signals\"",
        "\"window\": {\"from\": \"T#0s\", \"to\": \"T#200ms\"}, \"signals\"",
    );
    assert_eq!(compare(&folder, "logger.csv", &windowed).status, 0);
    let ended = compare(&folder, "short.csv", &windowed);
    assert_eq!(ended.status, 3);
    ended.complains("window T#0s to T#200ms is not all there");
    let apart = compare(&folder, "logger.csv", &logger_with("\"T#0s\"", "\"T#1h\""));
    assert_eq!(apart.status, 3);
    apart.complains("nothing to compare");
}

#[test]
fn a_last_line_without_an_end_is_noted() {
    let folder = folder("machine_open_end");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    write(&folder, "open.csv", good.trim_end());
    let ended = compare(&folder, "open.csv", LOGGER);
    assert_eq!(ended.status, 0);
    ended.complains_first("note: open.csv: the last line has no end");
}

#[test]
fn an_offset_is_fitted_and_printed() {
    let folder = folder("machine_fit");
    let fit = "{\"fit\": \"X.Position\", \"from\": \"T#-50ms\", \"to\": \"T#50ms\"}";
    let ended = compare(&folder, "logger.csv", &logger_with("\"T#0s\"", fit));
    assert_eq!(ended.status, 0, "{}", ended.out);
    ended.prints("\noffset     T#");
    ended.prints(", fitted on X.Position, ");
}

#[test]
fn rows_without_times_are_a_sample_apart() {
    let folder = folder("machine_every");
    let map = logger_with(
        "{\"column\": \"time\", \"unit\": \"s\"}",
        "{\"every\": \"T#20ms\"}",
    );
    assert_eq!(compare(&folder, "logger.csv", &map).status, 0);
    let numbers = map
        .replace("\"pos, mm\"", "2")
        .replace("\"done\"", "3")
        .replace("\"err\"", "4");
    assert_eq!(compare(&folder, "logger.csv", &numbers).status, 0);
    let wrong = map.replace("{\"every\": \"T#20ms\"}", "{\"every\": \"T#10ms\"}");
    assert_eq!(compare(&folder, "logger.csv", &wrong).status, 1);
}

#[test]
fn encodings_and_line_ends_of_other_systems_are_read() {
    let folder = folder("machine_encodings");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    let utf16 = |text: &str| text.encode_utf16().flat_map(u16::to_le_bytes).collect::<Vec<_>>();
    for bytes in [
        good.replace('\n', "\r\n").into_bytes(),
        [b"\xef\xbb\xbf", good.as_bytes()].concat(),
        [vec![0xff, 0xfe], utf16(&good)].concat(),
        good.replace("s,mm,,", "s,mm,,\n\n").into_bytes(),
        format!("Logger 3.1, \"front\ndate,2024-05-28\n\n{good}\nEOF\n\n").into_bytes(),
    ] {
        fs::write(folder.join("other.csv"), bytes).unwrap();
        let ended = compare(&folder, "other.csv", LOGGER);
        assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    }
}

#[test]
fn times_may_count_from_1601() {
    let folder = folder("machine_ticks");
    let good = fs::read_to_string(folder.join("logger.csv")).unwrap();
    let (head, rows) = good.split_at(good.find("0.00,").unwrap());
    let ticks = rows.lines().enumerate().map(|(row, line)| {
        let (_, cells) = line.split_once(',').unwrap();
        format!("{},{cells}\n", 133_612_345_678_900_000_u64 + 200_000 * row as u64)
    });
    write(
        &folder,
        "ticks.csv",
        &(head.to_owned() + &ticks.collect::<String>()),
    );
    let ended = compare(&folder, "ticks.csv", &logger_with("\"s\"", "\"100ns\""));
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    let far = head.to_owned() + "0,0,0,0\n1e12,0,0,0\n";
    write(&folder, "far.csv", &far);
    let ended = compare(&folder, "far.csv", LOGGER);
    assert_eq!(ended.status, 3);
    ended.complains("more than 73 years");
    for offset in ["T#100000d", "T#-100000d"] {
        let ended = compare(&folder, "logger.csv", &logger_with("T#0s", offset));
        assert_eq!(ended.status, 3, "{}", ended.err);
        ended.complains("nothing to compare");
    }
}
