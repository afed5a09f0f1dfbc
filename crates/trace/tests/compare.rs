//! A comparison must name the first scan and signal that differ, and the size of the difference, and
//! detect every kind of difference of two traces.

use crate::common;

use standstill_trace::compare::compare;
use standstill_trace::{Cell, Header, Input, Trace, csv};

#[test]
fn equal_traces_have_no_difference() {
    assert_eq!(compare(&common::run(300, None), &common::run(300, None)), None);
    let hard = common::hard_values();
    assert_eq!(compare(&hard, &hard.clone()), None, "a NaN equals itself");
}

#[test]
fn one_bit_is_found_named_and_counted() {
    let difference = compare(&common::run(800, None), &common::run(800, Some(321))).expect("one bit");
    let first = difference.first.as_ref().expect("in a scan");
    assert_eq!((first.scan, first.time_ns), (321, 321_000_000));
    // The feedback of the ideal drive follows one scan later, so only the set-point differs here.
    assert_eq!(first.signals.len(), 1);
    assert_eq!(first.signals[0].name, "X.Position");
    assert_eq!(first.signals[0].ulps, Some(1));
    let text = difference.to_string();
    println!("{text}");
    assert!(
        text.starts_with("first difference in scan 321 (T#321ms), 1 signal\n  X.Position  expected "),
        "{text}"
    );
    assert!(text.contains("(1 ULP)\nevents before\n"), "{text}");
    assert!(
        text.contains("events from there on, in both\n  505  wait"),
        "{text}"
    );
}

fn switch(levels: &[bool], cycle_ns: u64) -> Trace {
    let inputs = vec![Input {
        name: "GO".into(),
        iec_type: "BOOL".into(),
    }];
    let mut trace = Trace::new(Header {
        inputs,
        cycle_ns,
        ..Header::default()
    });
    for &level in levels {
        trace.push_row(&[Cell::Bool(level)]).expect("the row fits");
    }
    trace
}

#[test]
fn an_edge_one_scan_late_is_told_from_both_sides() {
    let expected = switch(&[false, true, true, false], 1000);
    let actual = switch(&[false, false, true, false], 1000);
    let text = compare(&expected, &actual).expect("an edge moved").to_string();
    let told = "first difference in scan 1 (T#1us), 1 signal
  GO  expected TRUE  found FALSE
expected from there on
    1  inputs  +GO
    3  inputs  -GO
found from there on
    2  inputs  +GO
    3  inputs  -GO
";
    assert_eq!(text, told);
}

#[test]
fn length_cycle_and_columns_count_too() {
    let base = switch(&[true, false], 1000);
    let longer = compare(&base, &switch(&[true, false, true], 1000)).expect("longer");
    assert_eq!(longer.first, None);
    assert!(
        longer.to_string().contains("scans: expected 2, found 3"),
        "{longer}"
    );
    let slower = compare(&base, &switch(&[true, false], 2000)).expect("slower");
    assert!(
        slower.to_string().contains("cycle: expected T#1us, found T#2us"),
        "{slower}"
    );
    let other = compare(&base, &common::run(2, None)).expect("other columns");
    assert_eq!(other.only_expected, Vec::<String>::new());
    assert!(other.only_actual.contains(&"X.State".to_owned()));
    assert!(
        other
            .to_string()
            .contains("columns only in what was found: X.State, X.Position"),
        "{other}"
    );
}

#[test]
fn a_trace_without_its_header_compares_with_one_that_has_it() {
    let trace = common::run(800, None);
    let mut out = Vec::new();
    csv::write(&trace, &mut out).expect("a vector takes all");
    let text = String::from_utf8(out).expect("UTF-8");
    let loaded = csv::read(&text, None).expect("our own rows");
    assert_eq!(compare(&trace, &loaded.trace), None);
    // Whole numbers without a point are taken for such: still the same numbers.
    let whole = csv::read("scan,time_ns,v\n0,0,2\n", None).expect("a small trace");
    let real = csv::read("scan,time_ns,v\n0,0,2.0\n", None).expect("a small trace");
    assert_eq!(compare(&whole.trace, &real.trace), None);
}
