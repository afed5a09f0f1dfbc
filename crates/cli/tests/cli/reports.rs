//! Traces as pages, pictures and waveforms, and the message if there is none.

#[cfg(unix)]
use crate::support::limited;
use crate::support::{Ended, SCRIPT, read, standstill, typed, with_script, write};
use std::fs;
use std::path::{Path, PathBuf};

/// A folder with the trace of the script, that of a slower run and that of a longer one.
fn traces(name: &str) -> PathBuf {
    let folder = with_script(name);
    write(
        &folder,
        "long.scan.json",
        &SCRIPT.replace("\"scans\": 30", "\"scans\": 50"),
    );
    let slow = SCRIPT
        .replace("T#10ms", "T#20ms")
        .replace("\"at\": 21", "\"at\": 25");
    write(&folder, "slow.scan.json", &slow);
    for (script, file) in [("move", "a.csv"), ("long", "long.jsonl"), ("slow", "slow.csv")] {
        let script = format!("{script}.scan.json");
        standstill(&folder, &["run", "-q", &script, "--trace", file]);
        assert!(folder.join(file).exists());
    }
    folder
}

/// The names in a folder that no test has written.
fn left(folder: &Path) -> Vec<String> {
    let names = fs::read_dir(folder)
        .unwrap()
        .map(|entry| entry.unwrap().file_name().into_string().unwrap());
    let ours = |name: &String| name.ends_with(".html") || name.contains("partial") || name.ends_with(".vcd");
    names.filter(ours).collect()
}

#[test]
fn a_run_writes_a_page_a_picture_and_a_waveform() {
    let folder = with_script("reports_run");
    let files = ["--report", "out.html", "--svg", "out.svg", "--vcd", "out.vcd"];
    let ended = standstill(&folder, &[&["run", "-q", "move.scan.json"][..], &files].concat());
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    assert_eq!(ended.out.lines().count(), 1, "files are written without a word");
    let page = read(&folder, "out.html");
    assert!(page.starts_with("<!doctype html>") && page.contains("<h1>One short move</h1>"));
    assert!(page.contains("2 of 2 claims hold"));
    assert!(read(&folder, "out.svg").contains("X.Acceleration (mm/s^2)"));
    assert!(read(&folder, "out.vcd").contains("$scope module move $end"));
}

#[test]
fn the_page_of_a_trace_tells_what_the_page_of_its_run_tells() {
    let folder = with_script("reports_same");
    let files = ["--report", "run.html", "--trace", "a.jsonl"];
    standstill(&folder, &[&["run", "-q", "move.scan.json"][..], &files].concat());
    assert_eq!(
        standstill(&folder, &["report", "a.jsonl", "-o", "trace.html"]).status,
        0
    );
    let run = read(&folder, "run.html").replace("move.scan.json", "a.jsonl");
    assert_eq!(
        run,
        read(&folder, "trace.html"),
        "events, notes and claims included"
    );
}

#[test]
fn a_failing_run_has_its_page_too() {
    let folder = with_script("reports_fail");
    let ended = typed(&folder, "run -q --set v=2 move.scan.json --report out.html");
    assert_eq!(ended.status, 1);
    assert!(
        read(&folder, "out.html")
            .contains("<ul class=\"failures\">\n<li>expect[0].that.move.Done: FALSE at scan 21")
    );
}

#[test]
fn a_page_of_2000_scans_is_small() {
    let folder = with_script("reports_size");
    let script = SCRIPT
        .replace("T#10ms", "T#1ms")
        .replace("\"scans\": 30", "\"scans\": 2000")
        .replace(
            "\"acceleration\": 100}",
            "\"acceleration\": 100, \"jerk\": 3000, \"snap\": 90000}",
        )
        .replace("\"Position\": 1", "\"Position\": 15");
    write(&folder, "move.scan.json", &script);
    standstill(&folder, &["run", "-q", "move.scan.json", "--report", "out.html"]);
    let size = read(&folder, "out.html").len();
    assert!(size < 250_000, "{size} bytes");
}

#[test]
fn traces_of_different_lengths_lie_over_each_other() {
    let folder = traces("reports_lengths");
    let ended = standstill(&folder, &["report", "a.csv", "long.jsonl", "-o", "out.html"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let page = read(&folder, "out.html");
    assert!(page.contains("<b>A</b>a.csv: 30 scans, 0.3 s") && page.contains("different lengths"));
}

#[test]
fn what_cannot_be_reported_is_said_and_nothing_is_written() {
    let folder = traces("reports_wrong");
    let csv = read(&folder, "a.csv");
    write(&folder, "cut.csv", &csv[..csv.len() / 2]);
    write(&folder, "foreign.csv", "Name;Time [ms];Pos\nX;1;2\n");
    write(
        &folder,
        "empty.csv",
        &format!("{}\n", csv.lines().next().unwrap()),
    );
    write(&folder, "cut.jsonl", &read(&folder, "long.jsonl")[..900]);
    let cases: &[(&[&str], i32, &str)] = &[
        (&["cut.csv", "-o", "x.html"], 3, "cut.csv: line "),
        (&["cut.jsonl", "-o", "x.html"], 3, "cut.jsonl: line "),
        (
            &["foreign.csv", "-o", "x.html"],
            3,
            "a trace begins with the columns `scan` and `time_ns`",
        ),
        (
            &["empty.csv", "-o", "x.html"],
            3,
            "empty.csv: the trace has no rows",
        ),
        (
            &["a.csv", "slow.csv", "-o", "x.html"],
            3,
            "a.csv has scans of T#10ms, slow.csv of T#20ms: only traces of the same cycle",
        ),
        (&["absent.csv", "-o", "x.html"], 4, "absent.csv: "),
        (&["a.csv", "-o", "absent/x.html"], 4, "absent/x.html: "),
        (&["a.csv", "-o", "."], 4, ".: "),
        (
            &["move.scan.json", "-o", "x.html"],
            2,
            "a trace is a .csv, .jsonl or (for reading) .exact file",
        ),
        (
            &["a.csv"],
            2,
            "nothing to write: give -o FILE.html, --svg FILE or --vcd FILE",
        ),
        (
            &["a.csv", "long.jsonl", "--vcd", "x.vcd"],
            2,
            "--svg and --vcd take one trace",
        ),
        (&["a.csv"; 7], 2, "nothing to write"),
    ];
    for (arguments, status, message) in cases {
        let Ended {
            status: found,
            out,
            err,
        } = standstill(&folder, &[&["report"], *arguments].concat());
        assert_eq!((found, out.as_str()), (*status, ""), "{arguments:?}: {err}");
        assert!(err.contains(message), "{arguments:?}: {err}");
    }
    let many = standstill(
        &folder,
        &[&["report", "-o", "x.html"][..], &["a.csv"; 7]].concat(),
    );
    assert_eq!(many.status, 2);
    many.complains("7 traces: a report shows 1 to 6");
    assert_eq!(left(&folder), Vec::<String>::new());
}

#[test]
#[cfg(unix)]
fn a_target_that_cannot_be_written_leaves_the_old_file() {
    let folder = traces("reports_target");
    assert_eq!(
        standstill(&folder, &["report", "a.csv", "-o", "out.html"]).status,
        0
    );
    let before = read(&folder, "out.html");
    let files = || fs::read_dir(&folder).unwrap().count();
    let count = files();
    // No file may grow beyond half a kilobyte, as on a full disk.
    let report = ["report", "long.jsonl", "-o", "out.html"];
    let ended = limited("-f 1", &folder, &report);
    assert_eq!(ended.status, 4);
    ended.complains("out.html: ");
    assert_eq!(read(&folder, "out.html"), before);
    assert_eq!(files(), count, "nothing is left beside it");
}

#[test]
fn csv_takes_other_delimiters_and_decimal_commas() {
    let folder = traces("reports_csv");
    let german = [
        "run",
        "-q",
        "move.scan.json",
        "--trace",
        "german.csv",
        "--decimal-comma",
    ];
    assert_eq!(standstill(&folder, &german).status, 0);
    let text = read(&folder, "german.csv");
    assert!(text.starts_with("scan;time_ns;X.State;"));
    assert!(text.contains(";0,0;") && !text.contains("0.0"), "{text}");
    let tab = [
        "run",
        "-q",
        "move.scan.json",
        "--trace",
        "tab.csv",
        "--delimiter",
        "tab",
    ];
    assert_eq!(standstill(&folder, &tab).status, 0);
    assert!(read(&folder, "tab.csv").starts_with("scan\ttime_ns\t"));
    for file in ["german.csv", "tab.csv"] {
        assert_eq!(
            standstill(&folder, &["explain", "a.csv", file]).status,
            0,
            "they read back"
        );
    }
    for (arguments, message) in [
        (
            &["--trace", "x.csv", "--delimiter", ",", "--decimal-comma"][..],
            "--decimal-comma needs another delimiter",
        ),
        (
            &["--trace", "x.csv", "--delimiter", "x"],
            "write `,`, `;`, `|` or `tab`",
        ),
        (
            &["--trace", "x.jsonl", "--decimal-comma"],
            "are for a trace that is a .csv file",
        ),
        (&["--decimal-comma"], "--trace"),
    ] {
        let ended = standstill(
            &folder,
            &[&["run", "-q", "move.scan.json"][..], arguments].concat(),
        );
        assert_eq!(ended.status, 2, "{arguments:?}");
        ended.complains(message);
    }
}

#[test]
fn one_file_holds_one_run() {
    let folder = with_script("reports_several");
    for option in ["--report", "--svg", "--vcd", "--trace"] {
        let ended = standstill(
            &folder,
            &["run", "-q", "move.scan.json", "move.scan.json", option, "x.csv"],
        );
        assert_eq!(ended.status, 2);
        ended.complains(&format!("{option} takes one script"));
    }
}
