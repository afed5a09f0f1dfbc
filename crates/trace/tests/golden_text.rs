//! The golden text must show the events, stay short, and change exactly if the behaviour changes.

use crate::common;

use standstill_trace::{Axis, Cell, Claim, ClaimVerdict, Header, Limits, Trace, golden, subjects};

#[test]
fn a_move_there_and_back_reads_well_and_stays_short() {
    let text = golden::text(&common::run(2000, None));
    println!("{text}");
    let lines = text.lines().count();
    assert!(lines <= 64, "{lines} lines");
    assert!(
        text.lines().all(|line| line.trim_end() == line),
        "no blanks at the ends of lines"
    );
    for line in [
        "title   There, and back again",
        "axis    X  mm  order 4  v=200.0  a=1000.0  d=1000.0  j=20000.0  s=500000.0",
        "block   there  MC_MoveAbsolute(X)",
        "    5  there   +Execute +Busy +Active Position=41.7792 Velocity=200.0 BufferMode=mcAborting",
        "  709  X       DiscreteMotion -> Standstill",
        "    709        41.779200         0.000000         0.000000         0.000000",
        "  velocity                 81.600000  at 196     40.80 % of 200.0",
    ] {
        assert!(text.lines().any(|other| other == line), "missing: {line}");
    }
    let subjects = subjects::subjects(&common::run(2000, None));
    assert!(text.ends_with(&format!(
        "end  2000 scans  {:016x}\n",
        subjects::together(&subjects)
    )));
    let names: Vec<_> = subjects.iter().map(|subject| subject.name.as_str()).collect();
    assert_eq!(names, ["inputs", "power", "there", "back", "read", "wait", "X"]);
    for subject in &subjects {
        let line = format!("  {:<6}  {:016x}", subject.name, subject.digest);
        assert!(text.lines().any(|other| other == line), "missing: {line}");
    }
}

#[test]
fn one_bit_changes_the_digests_of_what_has_it_and_the_last_line() {
    // `read` shows the position, too.
    let [a, b] = [None, Some(700)].map(|nudge| golden::text(&common::run(1000, nudge)));
    let changed: Vec<_> = a.lines().zip(b.lines()).filter(|(a, b)| a != b).collect();
    let [read, axis, end] = changed.as_slice() else {
        panic!("{changed:?}")
    };
    let differing = |(a, b): (&str, &str)| a.split(' ').zip(b.split(' ')).filter(|(a, b)| a != b).count();
    for (line, begin) in [
        (read, "  read    "),
        (axis, "  X       "),
        (end, "end  1000 scans  "),
    ] {
        assert_eq!(differing(*line), 1, "{line:?}");
        assert!(line.0.starts_with(begin), "{line:?}");
    }
}

#[test]
fn versions_hashes_and_verdicts_stay_out() {
    let mut header = common::header();
    let trace = common::run(10, None);
    header.runtime = "9.9.9".into();
    header.script_hash = "feedface".into();
    let mut other = common::under(header, &trace);
    other.set_claims(vec![Claim {
        path: "p".into(),
        text: "t".into(),
        verdict: ClaimVerdict::Failed,
        scans: Some([0, 3]),
        held: None,
        failures: Vec::new(),
    }]);
    assert_eq!(golden::text(&trace), golden::text(&other));
}

#[test]
fn every_axis_has_its_table_and_rest_is_left_out() {
    let axis = |name: &str| Axis {
        name: name.into(),
        order: 3,
        limits: Limits::default(),
        ..Axis::default()
    };
    let mut trace = Trace::new(Header {
        axes: vec![axis("X"), axis("Y")],
        cycle_ns: 500_000,
        ..Header::default()
    });
    for scan in 0..1000 {
        let r = Cell::Real;
        let rest = [
            Cell::Name("Standstill"),
            r(1.0),
            r(0.0),
            r(0.0),
            r(0.0),
            r(0.0),
            r(1.0),
        ];
        let turns = [
            Cell::Name("ContinuousMotion"),
            r(f64::from(scan)),
            r(2.0),
            r(0.0),
            r(0.0),
            r(0.0),
            r(0.0),
        ];
        trace.push_row(&[rest, turns].concat()).expect("the row fits");
    }
    let text = golden::text(&trace);
    println!("{text}");
    let table = |axis: &str| {
        let lines = text
            .lines()
            .skip_while(move |line| *line != format!("set-points of {axis}"));
        lines.skip(2).take_while(|line| !line.is_empty()).count()
    };
    assert_eq!(table("X"), 1, "at rest from first to last");
    assert_eq!(table("Y"), 11, "every 100 scans and the last");
    assert!(text.contains("cycle   T#500us\naxis    X  order 3\n"), "{text}");
}
