//! CSV and JSON Lines must keep every bit when written and read, and give a clear error for a foreign or
//! incomplete file.

use crate::common;

use standstill_trace::{Cell, Header, Trace, cell_text, csv, digest, jsonl};

fn csv_text(trace: &Trace) -> String {
    let mut out = Vec::new();
    csv::write(trace, &mut out).expect("a vector takes all");
    String::from_utf8(out).expect("UTF-8")
}

fn jsonl_text(trace: &Trace) -> String {
    let mut out = Vec::new();
    jsonl::write(trace, &mut out).expect("a vector takes all");
    String::from_utf8(out).expect("UTF-8")
}

fn assert_same(a: &Trace, b: &Trace) {
    assert_eq!(a.columns(), b.columns());
    assert_eq!(a.header(), b.header());
    assert_eq!(a.scans(), b.scans());
    assert_eq!(digest::whole(a), digest::whole(b));
}

#[test]
fn csv_comes_back_to_the_bit() {
    for trace in [common::run(200, None), common::hard_values()] {
        let loaded = csv::read(&csv_text(&trace), Some(&trace.header_json())).expect("our own file");
        assert_same(&loaded.trace, &trace);
        assert_eq!(loaded.trace.notes(), trace.notes());
        assert!(loaded.lacks.is_empty(), "{:?}", loaded.lacks);
    }
}

#[test]
fn csv_of_other_dialects_comes_back_to_the_bit() {
    for (delimiter, decimal_comma) in [(';', true), (';', false), ('\t', true), ('|', true)] {
        for trace in [common::run(200, None), common::hard_values()] {
            let dialect = csv::Dialect {
                delimiter,
                decimal_comma,
            };
            let mut out = Vec::new();
            csv::write_as(&trace, dialect, &mut out).expect("a vector takes all");
            let text = String::from_utf8(out).expect("UTF-8");
            assert!(text.starts_with(&format!("scan{delimiter}time_ns{delimiter}")));
            let reals = text.lines().skip(1).any(|line| line.contains("0.1"));
            assert!(!(decimal_comma && reals), "{text}");
            let loaded = csv::read(&text, Some(&trace.header().to_json())).expect("our own file");
            assert_same(&loaded.trace, &trace);
            let alone = csv::read(&text, None).expect("rows alone");
            let (found, expected) = (alone.trace.cells(1), trace.cells(1));
            assert!(found.map(cell_text).eq(expected.map(cell_text)), "{dialect:?}");
        }
    }
}

#[test]
fn json_lines_come_back_to_the_bit() {
    for trace in [common::run(200, None), common::hard_values()] {
        let loaded = jsonl::read(&jsonl_text(&trace)).expect("our own file");
        assert_same(&loaded.trace, &trace);
        assert_eq!(loaded.trace.notes(), trace.notes());
        assert!(loaded.lacks.is_empty(), "{:?}", loaded.lacks);
    }
}

#[test]
fn csv_looks_as_the_format_says() {
    let text = csv_text(&common::run(7, None));
    let lines: Vec<_> = text.lines().collect();
    let start = "scan,time_ns,X.State,X.Position,X.Velocity,X.Acceleration,X.Jerk,X.Snap,X.ActualPosition,GO,power.Axis";
    assert!(lines[0].starts_with(start), "{}", lines[0]);
    assert!(
        lines[1].starts_with("0,0,Standstill,0.0,0.0,0.0,0.0,0.0,0.0,FALSE,X,TRUE,TRUE,FALSE,0,"),
        "{}",
        lines[1]
    );
    assert!(
        lines[6].starts_with("5,5000000,DiscreteMotion,1.6666666666666"),
        "{}",
        lines[6]
    );
}

#[test]
fn json_lines_look_as_the_format_says() {
    let text = jsonl_text(&common::hard_values());
    let lines: Vec<_> = text.lines().collect();
    assert!(
        lines[0].starts_with(r#"{"standstill_trace":1,"runtime":"#),
        "{}",
        lines[0]
    );
    assert_eq!(
        lines[1],
        r#"{"scan":0,"time_ns":0,"b":true,"r":"NaN","i":-9223372036854775808,"n":"red"}"#
    );
    assert_eq!(
        lines[4],
        r#"{"scan":3,"time_ns":750000,"b":true,"r":0.0,"i":-1,"n":"7"}"#
    );
}

#[test]
fn a_trace_without_its_header_is_read_and_says_what_it_lacks() {
    let trace = common::run(1000, None);
    let rows: String = jsonl_text(&trace).split_inclusive('\n').skip(1).collect();
    for loaded in [csv::read(&csv_text(&trace), None), jsonl::read(&rows)] {
        let loaded = loaded.expect("rows without a header");
        assert!(
            loaded.lacks.iter().any(|lack| lack.contains("units, limits")),
            "{:?}",
            loaded.lacks
        );
        assert_eq!(loaded.trace.header().cycle_ns, 1_000_000);
        assert_eq!(loaded.trace.header().axes.len(), 1);
        // Only kinds of columns that have whole numbers alone may differ; their values are the same.
        assert_eq!(loaded.trace.columns().len(), trace.columns().len());
        assert_eq!(digest::whole(&loaded.trace), digest::whole(&trace));
    }
}

#[test]
fn columns_are_found_by_name_and_later_ones_are_kept() {
    let mut header = common::header();
    header.instances.clear();
    header.inputs.clear();
    let text = "scan,time_ns,X.Position,X.ActualVelocity\n0,0,1.5,2\n1,1000000,2.5,3\n";
    let loaded = csv::read(text, Some(&header.to_json())).expect("a trace of another version");
    assert!(
        loaded.lacks.contains(&"the column `X.State`".to_owned()),
        "{:?}",
        loaded.lacks
    );
    let column = loaded.trace.column("X.ActualVelocity").expect("kept");
    assert_eq!(loaded.trace.cell(1, column), Some(Cell::Integer(3)));
}

#[test]
fn a_windows_file_is_a_file() {
    let trace = common::run(20, None);
    let text = format!("\u{feff}{}", csv_text(&trace).replace('\n', "\r\n"));
    let loaded = csv::read(&text, Some(&trace.header().to_json())).expect("CRLF and a byte order mark");
    assert_same(&loaded.trace, &trace);
}

#[test]
fn bad_csv_is_refused_where_it_is_bad() {
    let header = common::header().to_json();
    let good = "scan,time_ns,GO,X.Position\n0,0,TRUE,1.0\n";
    assert!(csv::read(good, Some(&header)).is_ok());
    for (text, expected) in [
        ("", "line 1, column 1: no line of column names"),
        (
            "time;value\n1;2\n",
            "line 1, column 1: a trace begins with the columns `scan` and `time_ns`",
        ),
        ("scan,time_ns,a,a\n", "line 1: the column `a` stands twice"),
        (
            "scan,time_ns,a\n0,0\n",
            "line 2: 2 cells where line 1 names 3 columns",
        ),
        (
            "scan,time_ns,GO\n0,0,TRUE\n1,1000000,TRU",
            "line 3: the last line has no end: the file is cut short",
        ),
        (
            "scan,time_ns,GO\n0,0,1\n",
            "line 2, column 5: `GO` should be TRUE or FALSE, found `1`",
        ),
        (
            "scan,time_ns,X.Position\n0,0,1e999\n",
            "line 2, column 5: `X.Position` should be a number, found `1e999`",
        ),
        (
            "scan,time_ns,GO\n5,0,TRUE\n",
            "line 2, column 1: `scan` should be 0, found `5`",
        ),
        (
            "scan,time_ns,GO\n0,0,TRUE\n1,7,TRUE\n",
            "line 3, column 3: `time_ns` should be 1000000, found `7`",
        ),
        (
            "scan,time_ns,\"a\n0,0,1\n",
            "line 1, column 14: a quote that does not end",
        ),
        (
            "scan,time_ns,\"a\"b\n0,0,1\n",
            "line 1, column 14: text after the end of a quoted cell",
        ),
    ] {
        let error = csv::read(text, Some(&header)).expect_err(text);
        assert_eq!(error.to_string(), expected);
    }
}

#[test]
fn every_cut_of_a_csv_file_is_noticed() {
    let text = csv_text(&common::run(3, None));
    let ends: Vec<usize> = text.match_indices('\n').map(|(at, _)| at + 1).collect();
    for cut in (0..text.len()).filter(|cut| !ends.contains(cut)) {
        assert!(csv::read(&text[..cut], None).is_err(), "cut at {cut}");
    }
}

#[test]
fn bad_json_lines_are_refused_where_they_are_bad() {
    for (text, expected) in [
        ("", "line 1, column 1: an empty file"),
        (
            "[1, 2]\n",
            "line 1, column 1: invalid type: sequence, expected a JSON object",
        ),
        (
            "{\"scan\":0,\"time_ns\":0,\"a\":1}\n{\"scan\":1,\"time_ns\"",
            "line 2: the text ends in the middle",
        ),
        (
            "{\"scan\":0,\"time_ns\":0,\"a\":1}\n{\"scan\":1,\"time_ns\":5}\n",
            "line 2: missing key `a`",
        ),
        (
            "{\"scan\":0,\"time_ns\":0}\n\n{\"scan\":1,\"time_ns\":5,\"z\":1}\n",
            "line 3: unknown key `z`",
        ),
        (
            "{\"scan\":0 \"time_ns\":0}\n",
            "line 1, column 11: expected `,` or `}`",
        ),
        (
            "{\"standstill_trace\":2}\n",
            "line 1: trace format 2; this version reads 1",
        ),
        (
            "{\"standstill_trace\":1}\n",
            "line 1, column 22: missing field `cycle_ns`",
        ),
        (
            "{\"time\":0}\n",
            "line 1, column 1: a trace begins with the columns `scan` and `time_ns`",
        ),
    ] {
        let error = jsonl::read(text).expect_err(text).to_string();
        assert!(error.starts_with(expected), "{error}\nexpected {expected}");
    }
}

#[test]
fn a_header_with_keys_of_a_later_version_is_read() {
    let header = common::header();
    let later = header.to_json().replacen("{", "{\"moon\":\"full\",", 1);
    assert_eq!(Header::from_json(&later), Ok(header));
    assert!(Header::from_json("{}").is_err());
}
