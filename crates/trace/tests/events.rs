//! Events must show each change and its time, in the order of cause and effect, and must not show
//! continuous changes.

use crate::common;

use standstill_trace::{
    Axis, Cell, Direction, Header, Input, Instance, Limits, Note, Trace, events_text, extremes, extremes_text,
};

/// One axis, one number variable, and a block with a pin of every sort.
fn header() -> Header {
    use Direction::{InOut, Input as In, Output};
    let pins = [
        ("Axis", "AXIS_REF", InOut),
        ("Execute", "BOOL", In),
        ("Position", "LREAL", In),
        ("Velocity", "LREAL", In),
        ("Time", "TIME", In),
        ("Mode", "MODE", In),
        ("Busy", "BOOL", Output),
        ("ErrorID", "WORD", Output),
        ("Count", "INT", Output),
        ("Elapsed", "TIME", Output),
        ("Actual", "LREAL", Output),
    ];
    let pins = pins.map(|(name, iec_type, direction)| common::pin(name, iec_type, direction));
    Header {
        cycle_ns: 1_000_000,
        axes: vec![Axis {
            name: "X".into(),
            ..Axis::default()
        }],
        inputs: vec![Input {
            name: "v".into(),
            iec_type: "LREAL".into(),
        }],
        instances: vec![Instance {
            name: "m".into(),
            block: "MC_Test".into(),
            pins: pins.to_vec(),
        }],
        ..Header::default()
    }
}

/// The part of a row that matters to a test; the rest changes with the scan.
#[derive(Clone, Copy)]
struct Row {
    state: &'static str,
    v: f64,
    execute: bool,
    position: f64,
    velocity: f64,
    time: i64,
    mode: &'static str,
    busy: bool,
    error_id: i64,
    count: i64,
}

const REST: Row = Row {
    state: "Standstill",
    v: 0.0,
    execute: false,
    position: 0.0,
    velocity: 0.0,
    time: 0,
    mode: "mcAborting",
    busy: false,
    error_id: 0,
    count: 0,
};

fn told(rows: &[Row]) -> String {
    let mut trace = Trace::new(header());
    for (scan, row) in rows.iter().enumerate() {
        push(&mut trace, scan, row);
    }
    events_text(&trace)
}

fn push(trace: &mut Trace, scan: usize, row: &Row) {
    let (b, r, i) = (Cell::Bool, Cell::Real, Cell::Integer);
    let along = scan as f64 * 0.1;
    let mut cells = vec![Cell::Name(row.state)];
    cells.extend([r(along); 6]);
    cells.extend([
        r(row.v),
        Cell::Name("X"),
        b(row.execute),
        r(row.position),
        r(row.velocity),
        i(row.time),
    ]);
    cells.extend([
        Cell::Name(row.mode),
        b(row.busy),
        i(row.error_id),
        i(row.count),
        i(scan as i64),
        r(along),
    ]);
    trace.push_row(&cells).expect("the row fits");
}

#[test]
fn values_that_run_along_make_no_events() {
    assert_eq!(told(&[REST; 50]), "    0  X  Standstill\n");
}

#[test]
fn an_edge_tells_its_inputs_once_and_then_what_changed() {
    let fire = Row {
        execute: true,
        busy: true,
        velocity: 50.0,
        time: 2_000_000,
        mode: "mcBuffered",
        ..REST
    };
    let again = Row {
        velocity: 60.0,
        ..fire
    };
    let text = told(&[
        REST,
        fire,
        REST,
        fire,
        Row {
            execute: false,
            ..fire
        },
        again,
    ]);
    let expected = "    0  X  Standstill
    1  m  +Execute +Busy Position=0.0 Velocity=50.0 Time=T#2ms Mode=mcBuffered
    2  m  -Execute -Busy Mode=mcAborting
    3  m  +Execute +Busy Mode=mcBuffered
    4  m  -Execute
    5  m  +Execute Velocity=60.0
";
    assert_eq!(text, expected);
}

#[test]
fn states_errors_counts_and_variables_are_told() {
    let text = told(&[
        Row { v: 5.0, ..REST },
        Row {
            v: 5.0,
            state: "ErrorStop",
            error_id: 4660,
            count: 1,
            ..REST
        },
        Row {
            v: 6.0,
            count: 2,
            ..REST
        },
    ]);
    let expected = "    0  inputs  v=5.0
    0  X       Standstill
    1  m       ErrorID=4660 Count=1
    1  X       Standstill -> ErrorStop
    2  inputs  v=6.0
    2  m       ErrorID=0 Count=2
    2  X       ErrorStop -> Standstill
";
    assert_eq!(text, expected);
}

#[test]
fn an_input_that_runs_is_told_when_it_starts_to() {
    let rows: Vec<Row> = (0..20)
        .map(|scan| Row {
            v: f64::from((scan - 10).max(0)),
            ..REST
        })
        .collect();
    assert_eq!(told(&rows), "    0  X       Standstill\n   11  inputs  v=1.0\n");
}

#[test]
fn notes_stand_with_their_subject_and_none_is_lost() {
    let mut trace = Trace::new(header());
    for scan in 0..3 {
        push(
            &mut trace,
            scan,
            &Row {
                execute: scan > 0,
                ..REST
            },
        );
    }
    for (scan, subject) in [(7, "late"), (1, "X"), (1, "m"), (1, "elsewhere"), (2, "X")] {
        trace.push_note(Note {
            scan,
            subject: subject.into(),
            text: format!("note for {subject}"),
        });
    }
    let expected = "    0  X          Standstill
    1  m          +Execute Position=0.0 Mode=mcAborting
    1  m          note for m
    1  X          note for X
    1  elsewhere  note for elsewhere
    2  X          note for X
    7  late       note for late
";
    assert_eq!(events_text(&trace), expected);
}

/// A trace of one axis with these velocities and accelerations.
fn moving(values: &[(f64, f64)], limits: Limits) -> Trace {
    let axes = vec![Axis {
        name: "X".into(),
        unit: "deg".into(),
        limits,
        ..Axis::default()
    }];
    let mut trace = Trace::new(Header {
        axes,
        ..Header::default()
    });
    for &(v, a) in values {
        let r = Cell::Real;
        trace
            .push_row(&[Cell::Name("Moving"), r(v), r(v), r(a), r(0.0), r(0.0), r(0.0)])
            .expect("the row fits");
    }
    trace
}

#[test]
fn extremes_are_magnitudes_with_their_first_scan() {
    let limits = Limits {
        velocity: Some(8.0),
        position_max: Some(10.0),
        ..Limits::default()
    };
    let trace = moving(&[(0.0, 1.0), (-4.0, -3.0), (4.0, 2.0)], limits);
    let expected = "extremes of X (deg)
  least position           -4.000000  at 1
  greatest position         4.000000  at 2       limit 10.0
  velocity                  4.000000  at 1       50.00 % of 8.0
  acceleration              3.000000  at 1       no limit
  jerk                      0.000000  at 0       no limit
  snap                      0.000000  at 0       no limit
";
    assert_eq!(extremes_text(&trace), expected);
}

#[test]
fn deceleration_is_told_apart_where_its_limit_differs() {
    let limits = Limits {
        acceleration: Some(4.0),
        deceleration: Some(8.0),
        ..Limits::default()
    };
    let trace = moving(&[(0.0, 2.0), (1.0, -6.0), (-1.0, 5.0), (-1.0, -1.0)], limits);
    let of = |quantity| {
        let all = extremes(&trace);
        all.into_iter()
            .find(|extreme| extreme.quantity == quantity)
            .map(|extreme| (extreme.value, extreme.scan))
    };
    assert_eq!(of("acceleration"), Some((2.0, 0)));
    assert_eq!(of("deceleration"), Some((6.0, 1)));
}

#[test]
fn a_nan_is_an_extreme() {
    let trace = moving(&[(1.0, 0.0), (f64::NAN, 0.0), (9.0, 0.0)], Limits::default());
    let text = extremes_text(&trace);
    assert!(
        text.contains("velocity                       NaN  at 1"),
        "{text}"
    );
}
