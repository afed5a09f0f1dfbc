//! Digests by subject: every bit that counts changes the digest of its subject and no other; columns at
//! their default, and the order of columns, change nothing: no digest, no event, no golden.

use crate::common;

use std::fs;

use standstill_testkit::Random;
use standstill_trace::golden::{Verdict, accept, exact_path, judge, text};
use standstill_trace::subjects::{Subject, subjects, together};
use standstill_trace::{Axis, Cell, Direction, Header, Input, Instance, Kind, Pin, Trace, cell_text};

/// A cell that owns its text.
#[derive(Clone, Debug, PartialEq)]
enum Own {
    Bool(bool),
    Real(f64),
    Integer(i64),
    Name(String),
}

impl Own {
    fn cell(&self) -> Cell<'_> {
        match self {
            Self::Bool(value) => Cell::Bool(*value),
            Self::Real(value) => Cell::Real(*value),
            Self::Integer(value) => Cell::Integer(*value),
            Self::Name(text) => Cell::Name(text),
        }
    }

    /// All values that are one bit away, as far as a trace distinguishes numbers; another name for a name.
    fn neighbours(&self) -> Vec<Self> {
        let shown = |value: f64| (value.is_nan(), value == 0.0, value.to_bits());
        let same = |a: f64, b: f64| {
            let (a, b) = (shown(a), shown(b));
            a.2 == b.2 || (a.0 && b.0) || (a.1 && b.1)
        };
        match self {
            Self::Bool(value) => vec![Self::Bool(!value)],
            Self::Real(value) => (0..64)
                .map(|bit| f64::from_bits(value.to_bits() ^ (1 << bit)))
                .filter(|other| !same(*value, *other))
                .map(Self::Real)
                .collect(),
            Self::Integer(value) => (0..64).map(|bit| Self::Integer(value ^ (1 << bit))).collect(),
            Self::Name(text) => vec![Self::Name(format!("{text}x")), Self::Name(String::new())],
        }
    }
}

fn value(random: &mut Random, kind: Kind) -> Own {
    let word = random.bits();
    match kind {
        Kind::Bool => Own::Bool(word & 1 == 1),
        Kind::Real => {
            let hard = [0.0, f64::NAN, f64::INFINITY, 5e-324, f64::MAX, 1.5];
            match usize::try_from(word % 12) {
                Ok(at) if at < hard.len() => Own::Real(hard[at]),
                _ => Own::Real(f64::from_bits(random.bits())),
            }
        }
        Kind::Integer => Own::Integer(match word % 3 {
            0 => 0,
            _ => random.bits().cast_signed(),
        }),
        Kind::Name => Own::Name(["mcAborting", "mcBuffered", "7", ""][(word % 4) as usize].into()),
    }
}

fn pin(name: &str, iec_type: &str, direction: Direction, default: Option<&str>) -> Pin {
    Pin {
        default: default.map(str::to_owned),
        ..common::pin(name, iec_type, direction)
    }
}

/// Two axes, inputs, two instances of one block. Its pins have every kind, with and without a default.
fn header() -> Header {
    use Direction::{InOut, Input as In, Output};
    let pins = vec![
        pin("Axis", "AXIS_REF", InOut, None),
        pin("Execute", "BOOL", In, None),
        pin("Positive", "BOOL", In, Some("TRUE")),
        pin("Velocity", "LREAL", In, None),
        pin("Override", "LREAL", In, Some("1.0")),
        pin("BufferMode", "MC_BUFFER_MODE", In, Some("mcAborting")),
        pin("Done", "BOOL", Output, Some("FALSE")),
        pin("ErrorID", "WORD", Output, Some("0")),
        pin("Elapsed", "TIME", Output, Some("0")),
        pin("Left", "LREAL", Output, Some("0.0")),
    ];
    let axis = |name: &str| Axis {
        name: name.into(),
        ..Axis::default()
    };
    let input = |name: &str, iec_type: &str| Input {
        name: name.into(),
        iec_type: iec_type.into(),
    };
    let instance = |name: &str| Instance {
        name: name.into(),
        block: "MC_Test".into(),
        pins: pins.clone(),
    };
    Header {
        cycle_ns: 1_000_000,
        axes: vec![axis("X"), axis("Y")],
        inputs: vec![input("GO", "BOOL"), input("v", "LREAL")],
        instances: vec![instance("a"), instance("b")],
        ..Header::default()
    }
}

/// The default of a column as a cell; `None` if it has none.
fn default(trace: &Trace, at: usize) -> Option<Own> {
    let column = &trace.columns()[at];
    let text = column.default.as_deref()?;
    Some(match column.kind {
        Kind::Bool => Own::Bool(text == "TRUE"),
        Kind::Real => Own::Real(text.parse().unwrap()),
        Kind::Integer => Own::Integer(text.parse().unwrap()),
        Kind::Name => Own::Name(text.into()),
    })
}

/// Rows of `header`, in which about half the columns with defaults keep them.
fn rows(header: &Header, scans: usize, random: &mut Random) -> Vec<Vec<Own>> {
    let empty = Trace::new(header.clone());
    let keeps: Vec<bool> = empty.columns().iter().map(|_| random.bits() & 1 == 1).collect();
    let value = |at: usize, random: &mut Random| match default(&empty, at) {
        Some(default) if keeps[at] => default,
        _ => value(random, empty.columns()[at].kind),
    };
    (0..scans)
        .map(|_| (0..keeps.len()).map(|at| value(at, random)).collect())
        .collect()
}

fn made(header: Header, rows: &[Vec<Own>]) -> Trace {
    let mut trace = Trace::new(header);
    for row in rows {
        trace.push_cells(row.iter().map(Own::cell)).expect("the row fits");
    }
    trace
}

/// The subjects of the second list whose digest differs from that of the first.
fn moved(before: &[Subject], after: &[Subject]) -> Vec<String> {
    let other = after.iter().filter(|subject| !before.contains(subject));
    other.map(|subject| subject.name.clone()).collect()
}

#[test]
fn every_bit_changes_the_digest_of_exactly_its_subject() {
    let mut random = Random(1);
    let header = header();
    let mut tried = 0;
    for scans in [1, 2, 5] {
        let mut rows = rows(&header, scans, &mut random);
        let trace = made(header.clone(), &rows);
        let before = subjects(&trace);
        for scan in 0..scans {
            for (at, column) in trace.columns().iter().enumerate() {
                let subject = match column.subject() {
                    "" => "inputs",
                    subject => subject,
                };
                let own = rows[scan][at].clone();
                for other in own.neighbours() {
                    if other == own {
                        continue;
                    }
                    rows[scan][at] = other.clone();
                    let after = subjects(&made(header.clone(), &rows));
                    assert_eq!(
                        moved(&before, &after),
                        [subject],
                        "{} {own:?} {other:?}",
                        column.name
                    );
                    assert_ne!(together(&before), together(&after));
                    tried += 1;
                }
                rows[scan][at] = own;
            }
        }
    }
    assert!(tried > 4000, "{tried}");
}

/// A later version may add a pin at any place, of any kind and default: a script that does not use it is not
/// affected.
#[test]
fn a_column_at_its_default_changes_no_digest_no_event_and_no_golden() {
    let mut random = Random(2);
    let snap = common::folder("subjects").join("x.snap");
    let header = header();
    let rows = rows(&header, 40, &mut random);
    let trace = made(header.clone(), &rows);
    accept(&snap, &trace).expect("writable");
    let exact = fs::read(exact_path(&snap)).expect("accepted");
    let new = [
        ("BOOL", "FALSE", Own::Bool(false)),
        ("BOOL", "TRUE", Own::Bool(true)),
        ("LREAL", "0.0", Own::Real(0.0)),
        ("LREAL", "-2.5", Own::Real(-2.5)),
        ("LREAL", "NaN", Own::Real(f64::NAN)),
        ("UDINT", "7", Own::Integer(7)),
        ("TIME", "1000000", Own::Integer(1_000_000)),
        ("MODE", "mcUnset", Own::Name("mcUnset".into())),
        ("MODE", "4", Own::Name("4".into())),
    ];
    let first = trace.column("a.Axis").expect("it is there");
    for (iec_type, default, value) in new {
        for direction in [Direction::Input, Direction::Output] {
            for (instance, place) in [(0, 1), (0, 4), (1, 0), (1, 10)] {
                let mut wider = header.clone();
                let pins = &mut wider.instances[instance].pins;
                let before = first + instance * pins.len() + place;
                // A name that comes first, and one of a pin that gives a target.
                let name = if place == 4 { "Position" } else { "AAA" };
                pins.insert(place, pin(name, iec_type, direction, Some(default)));
                let mut wide = rows.clone();
                for row in &mut wide {
                    row.insert(before, value.clone());
                }
                let wide = made(wider, &wide);
                assert_eq!(subjects(&wide), subjects(&trace), "{iec_type} {default}");
                assert_eq!(text(&wide), text(&trace), "{iec_type} {default}");
                assert_eq!(judge(&snap, &wide).expect("readable"), Verdict::Same);
                assert!(!accept(&snap, &wide).expect("readable"), "nothing to write");
                let other = snap.with_file_name("y.snap");
                accept(&other, &wide).expect("writable");
                assert_eq!(fs::read(exact_path(&other)).expect("accepted"), exact);
                fs::remove_file(exact_path(&other)).expect("removable");
            }
        }
    }
}

#[test]
fn a_column_that_leaves_its_default_once_is_seen_and_named() {
    let snap = common::folder("subjects_seen").join("x.snap");
    let header = header();
    let kept = |trace: &Trace| -> Vec<Own> {
        let columns = 0..trace.columns().len();
        let value = |at| {
            default(trace, at).unwrap_or_else(|| value(&mut Random(at as u64), trace.columns()[at].kind))
        };
        columns.map(value).collect()
    };
    let row = kept(&Trace::new(header.clone()));
    let mut rows = vec![row; 30];
    let trace = made(header.clone(), &rows);
    accept(&snap, &trace).expect("writable");
    for (at, column) in trace.columns().iter().enumerate() {
        let Some(other) = default(&trace, at).and_then(|own| own.neighbours().pop()) else {
            continue;
        };
        let own = std::mem::replace(&mut rows[12][at], other.clone());
        let verdict = judge(&snap, &made(header.clone(), &rows)).expect("readable");
        let Verdict::Different(mismatch) = verdict else {
            panic!("{}: {verdict:?}", column.name)
        };
        let told = mismatch.to_string();
        let first = mismatch.difference.expect("the companion is there");
        assert_eq!((first.only_expected, first.only_actual), (Vec::new(), Vec::new()));
        let first = first.first.expect("a row differs");
        let [signal] = first.signals.as_slice() else {
            panic!("{told}")
        };
        assert_eq!((first.scan, &signal.name), (12, &column.name));
        let values = [own.cell(), other.cell()].map(cell_text);
        assert_eq!([&signal.expected, &signal.actual], [&values[0], &values[1]]);
        assert!(
            told.contains(&format!("\ndigests that differ: {}; ", column.subject())),
            "{told}"
        );
        rows[12][at] = own;
    }
}

/// A pin that the script names counts even where it has its default. A golden from before the naming knows its
/// value.
#[test]
fn a_pin_that_is_named_counts_and_is_held_against_its_default() {
    let snap = common::folder("subjects_named").join("x.snap");
    let header = header();
    let empty = Trace::new(header.clone());
    let at = empty.column("a.BufferMode").expect("it is there");
    let value = |at| default(&empty, at).unwrap_or_else(|| value(&mut Random(7), empty.columns()[at].kind));
    let mut rows = vec![(0..empty.columns().len()).map(value).collect::<Vec<_>>(); 9];
    let unnamed = made(header.clone(), &rows);
    accept(&snap, &unnamed).expect("writable");
    let mut naming = header;
    naming.instances[0].pins[5].named = true;
    let named = made(naming.clone(), &rows);
    assert_eq!(moved(&subjects(&unnamed), &subjects(&named)), ["a"]);
    let verdict = judge(&snap, &named).expect("readable");
    assert!(
        matches!(&verdict, Verdict::Different(it) if it.difference.is_none()),
        "{verdict:?}"
    );
    for row in &mut rows {
        row[at] = Own::Name("mcBuffered".into());
    }
    let Verdict::Different(mismatch) = judge(&snap, &made(naming, &rows)).expect("readable") else {
        panic!("another value")
    };
    let told = mismatch.to_string();
    let begin = "first difference in scan 0 (T#0s), 1 signal\n  a.BufferMode  expected mcAborting  found mcBuffered\n";
    assert!(told.starts_with(begin), "{told}");
}

/// The order of pins, instances and axes is no behaviour of a subject.
#[test]
fn the_order_of_pins_instances_and_axes_changes_no_digest() {
    let mut random = Random(3);
    let header = header();
    let rows = rows(&header, 20, &mut random);
    let trace = made(header.clone(), &rows);
    let mut turned = header;
    turned.axes.reverse();
    turned.inputs.reverse();
    turned.instances.reverse();
    for instance in &mut turned.instances {
        instance.pins.reverse();
    }
    let columns = Trace::new(turned.clone());
    let places: Vec<usize> = columns
        .columns()
        .iter()
        .map(|column| trace.column(&column.name).expect("the same columns"))
        .collect();
    let rows: Vec<Vec<Own>> = rows
        .iter()
        .map(|row| places.iter().map(|at| row[*at].clone()).collect())
        .collect();
    let turned = made(turned, &rows);
    assert_eq!(together(&subjects(&turned)), together(&subjects(&trace)));
    let sorted = |trace: &Trace| {
        let mut subjects = subjects(trace);
        subjects.sort_by(|a, b| a.name.cmp(&b.name));
        subjects
    };
    assert_eq!(sorted(&turned), sorted(&trace));
}

/// Goldens depend on these numbers: a change of one changes every golden.
#[test]
fn the_digests_are_what_they_were() {
    let mut random = Random(4);
    let header = header();
    let rows = rows(&header, 20, &mut random);
    let found: Vec<_> = subjects(&made(header, &rows))
        .iter()
        .map(|subject| format!("{} {:016x}", subject.name, subject.digest))
        .collect();
    let expected = [
        "inputs be1d41557cfb060e",
        "a 6d2ca7b885f8e72b",
        "b eee76aa9c7c8b970",
        "X 8723db563a32b0d4",
        "Y a3ca14cd579aa77a",
    ];
    assert_eq!(found, expected);
}
