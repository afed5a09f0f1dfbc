//! Goldens of version 1, which had one digest over all columns: they are judged by their own columns,
//! independent of later ones.

use crate::common;

use std::fs;
use std::path::{Path, PathBuf};

use standstill_trace::compare::{Tolerance, Yardstick};
use standstill_trace::golden::{Mismatch, Verdict, accept, exact_path, expected, judge, judge_by, text};
use standstill_trace::{Cell, Direction, Pin, Trace, digest, exact};

/// The golden of this run as version 1 wrote it, in a folder of its own.
fn old(name: &str, trace: &Trace) -> PathBuf {
    let snap = common::folder(name).join("x.snap");
    let whole = digest::whole(trace);
    let now = text(trace);
    let (above, _) = now.split_once("\ndigests\n").expect("version 2 lists digests");
    let head = "---\nsource: \"x.scan.json\"\nexpression: golden\n---\n";
    let blocks = "digest per 64 scans\n      0 8d810500 dbb7bcb6\n";
    let end = format!("end  {} scans  {whole:016x}\n", trace.scans());
    fs::write(&snap, format!("{head}{above}\n{blocks}\n{end}")).expect("writable");
    let mut file = b"standstill exact 1\n".to_vec();
    file.extend(whole.to_le_bytes());
    file.extend(&exact::encode(trace)[file.len()..]);
    fs::write(exact_path(&snap), file).expect("writable");
    snap
}

/// The run with one more pin of the instance `there`, in the middle of the row, and without the column `without`.
fn other_columns(trace: &Trace, value: Option<f64>, without: &str) -> Trace {
    let mut header = common::header();
    let pins = &mut header.instances[1].pins;
    pins.retain(|pin| format!("there.{}", pin.name) != without);
    if value.is_some() {
        let pin = Pin {
            default: Some("0.0".into()),
            ..common::pin("New", "LREAL", Direction::Input)
        };
        pins.insert(3, pin);
    }
    let mut other = Trace::new(header);
    let places: Vec<_> = other
        .columns()
        .iter()
        .map(|column| trace.column(&column.name))
        .collect();
    for scan in 0..trace.scans() {
        let own = |place: &Option<usize>| place.and_then(|at| trace.cell(scan, at));
        let new = Cell::Real(value.unwrap_or_default());
        other
            .push_cells(places.iter().map(|place| own(place).unwrap_or(new)))
            .expect("the row fits");
    }
    for note in trace.notes() {
        other.push_note(note.clone());
    }
    other
}

fn different(snap: &Path, trace: &Trace) -> Box<Mismatch> {
    match judge(snap, trace).expect("readable") {
        Verdict::Different(mismatch) => mismatch,
        verdict => panic!("{verdict:?}"),
    }
}

#[test]
fn an_old_golden_is_met_until_it_is_accepted_anew() {
    let trace = common::run(800, None);
    let snap = old("old_met", &trace);
    let file = fs::read(&snap).expect("written");
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Old);
    assert_eq!(
        fs::read(&snap).expect("still there"),
        file,
        "judging writes nothing"
    );
    let events = Yardstick::Events(Tolerance::default());
    assert_eq!(judge_by(&snap, &trace, events).expect("readable"), Verdict::Old);
    assert!(accept(&snap, &trace).expect("writable"));
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Same);
}

#[test]
fn columns_that_came_since_do_not_count_whatever_they_hold() {
    let trace = common::run(800, None);
    let snap = old("old_columns", &trace);
    for value in [0.0, 1.5] {
        let wide = other_columns(&trace, Some(value), "");
        assert_eq!(wide.columns().len(), trace.columns().len() + 1);
        assert_eq!(judge(&snap, &wide).expect("readable"), Verdict::Old, "{value}");
    }
}

#[test]
fn a_bit_of_a_column_it_knows_fails_and_is_named() {
    let trace = common::run(800, None);
    let snap = old("old_bit", &trace);
    let nudged = common::run(800, Some(400));
    for run in [&nudged, &other_columns(&nudged, Some(1.5), "")] {
        let told = different(&snap, run).to_string();
        assert!(
            told.starts_with("first difference in scan 400 (T#400ms), 1 signal\n  X.Position"),
            "{told}"
        );
    }
    let events = Yardstick::Events(Tolerance::default());
    let close = judge_by(&snap, &nudged, events).expect("readable");
    assert!(matches!(close, Verdict::Close(Some(_))), "{close:?}");
    let reviewed = expected(&snap, &nudged)
        .expect("readable")
        .expect("its companion");
    assert_eq!(digest::whole(&reviewed), digest::whole(&trace));
}

#[test]
fn a_column_that_is_gone_and_a_run_of_another_length_fail() {
    let trace = common::run(800, None);
    let snap = old("old_gone", &trace);
    let gone = different(&snap, &other_columns(&trace, None, "there.Jerk"));
    assert_eq!(gone.difference.expect("named").only_expected, ["there.Jerk"]);
    let longer = different(&snap, &common::run(801, None));
    assert_eq!(longer.difference.expect("named").scans, (800, 801));
}

#[test]
fn without_a_companion_all_columns_are_those_it_knows() {
    let trace = common::run(800, None);
    let snap = old("old_alone", &trace);
    fs::remove_file(exact_path(&snap)).expect("removable");
    assert_eq!(judge(&snap, &trace).expect("readable"), Verdict::Old);
    for run in [other_columns(&trace, Some(0.0), ""), common::run(800, Some(3))] {
        let told = different(&snap, &run).to_string();
        let begin = "the first differing scan cannot be named: there is no exact trace";
        assert!(told.starts_with(begin), "{told}");
    }
}
