//! The golden text must tell what happened, stay short, and change where behaviour changes and only there.

mod common;

use standstill_trace::{Axis, Cell, Claim, ClaimVerdict, Header, Limits, Trace, golden};

#[test]
fn a_move_there_and_back_reads_well_and_stays_short() {
    let text = golden::text(&common::run(2000, None));
    println!("{text}");
    let lines = text.lines().count();
    assert!(lines <= 60, "{lines} lines");
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
    assert!(text.ends_with(&format!(
        "end  2000 scans  {:016x}\n",
        standstill_trace::digest::whole(&common::run(2000, None))
    )));
}

#[test]
fn one_bit_changes_one_block_digest_and_the_last_line() {
    let [a, b] = [None, Some(700)].map(|nudge| golden::text(&common::run(1000, nudge)));
    let changed: Vec<_> = a.lines().zip(b.lines()).filter(|(a, b)| a != b).collect();
    assert_eq!(changed.len(), 2, "{changed:?}");
    let differing = |(a, b): (&str, &str)| a.split(' ').zip(b.split(' ')).filter(|(a, b)| a != b).count();
    assert_eq!(differing(changed[0]), 1, "{changed:?}");
    assert!(changed[1].0.starts_with("end  1000 scans"));
}

#[test]
fn versions_hashes_and_verdicts_stay_out() {
    let mut header = common::header();
    let trace = common::run(10, None);
    header.runtime = "9.9.9".into();
    header.script_hash = "feedface".into();
    let mut other = Trace::new(header);
    for scan in 0..trace.scans() {
        other
            .push_row(&trace.row(scan).collect::<Vec<_>>())
            .expect("the row fits");
    }
    for note in trace.notes() {
        other.push_note(note.clone());
    }
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
