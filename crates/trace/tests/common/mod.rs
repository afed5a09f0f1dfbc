//! A run made by hand: one axis, four blocks, a jerk-limited move of 15 segments and one back.
//!
//! The positions are those of a snap-limited profile, summed up from polynomial segments, so files and
//! predictors get realistic numbers.

use std::fs;
use std::path::{Path, PathBuf};

use standstill_trace::{
    Axis, Cam, Cell, Claim, ClaimVerdict, Direction, Header, Input, Instance, Limits, Note, Pin, Trace,
};

/// Position, velocity, acceleration, jerk, snap.
pub type State = [f64; 5];

/// An empty folder for one test.
pub fn folder(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    let _ = fs::remove_dir_all(&folder);
    fs::create_dir_all(&folder).expect("a folder for the test");
    folder
}

const CYCLE: f64 = 0.001;

/// A pin without a default.
pub fn pin(name: &str, iec_type: &str, direction: Direction) -> Pin {
    Pin {
        name: name.into(),
        iec_type: iec_type.into(),
        direction,
        default: None,
        named: false,
        written: Vec::new(),
    }
}

fn move_pins() -> Vec<Pin> {
    use Direction::{InOut, Input, Output};
    let mut pins = vec![pin("Axis", "AXIS_REF", InOut), pin("Execute", "BOOL", Input)];
    for name in ["Position", "Velocity", "Acceleration", "Deceleration", "Jerk"] {
        pins.push(pin(name, "LREAL", Input));
    }
    pins.push(pin("BufferMode", "MC_BUFFER_MODE", Input));
    for name in ["Done", "Busy", "Active", "CommandAborted", "Error"] {
        pins.push(pin(name, "BOOL", Output));
    }
    pins.push(pin("ErrorID", "WORD", Output));
    pins
}

/// The header of the run.
pub fn header() -> Header {
    use Direction::{InOut, Input as In, Output};
    let power = vec![
        pin("Axis", "AXIS_REF", InOut),
        pin("Enable", "BOOL", In),
        pin("Status", "BOOL", Output),
        pin("Error", "BOOL", Output),
        pin("ErrorID", "WORD", Output),
    ];
    let read = vec![
        pin("Axis", "AXIS_REF", InOut),
        pin("Enable", "BOOL", In),
        pin("Valid", "BOOL", Output),
        pin("Position", "LREAL", Output),
    ];
    let timer = vec![
        pin("IN", "BOOL", In),
        pin("PT", "TIME", In),
        pin("Q", "BOOL", Output),
        pin("ET", "TIME", Output),
    ];
    Header {
        runtime: "0.1.0".into(),
        title: "There, and back again".into(),
        covers: vec!["R1".into(), "T2".into()],
        script_hash: "00c0ffee".into(),
        cycle_ns: 1_000_000,
        axes: vec![Axis {
            name: "X".into(),
            unit: "mm".into(),
            order: 4,
            limits: Limits {
                velocity: Some(200.0),
                acceleration: Some(1000.0),
                deceleration: Some(1000.0),
                jerk: Some(20_000.0),
                snap: Some(500_000.0),
                ..Limits::default()
            },
            ..Axis::default()
        }],
        inputs: vec![Input {
            name: "GO".into(),
            iec_type: "BOOL".into(),
        }],
        instances: vec![
            Instance {
                name: "power".into(),
                block: "MC_Power".into(),
                pins: power,
            },
            Instance {
                name: "there".into(),
                block: "MC_MoveAbsolute".into(),
                pins: move_pins(),
            },
            Instance {
                name: "back".into(),
                block: "MC_MoveAbsolute".into(),
                pins: move_pins(),
            },
            Instance {
                name: "read".into(),
                block: "MC_ReadActualPosition".into(),
                pins: read,
            },
            Instance {
                name: "wait".into(),
                block: "TON".into(),
                pins: timer,
            },
        ],
        claims: vec![Claim {
            path: "expect[0]".into(),
            text: "there.Done by 990".into(),
            verdict: ClaimVerdict::Passed,
            scans: Some([0, 990]),
            held: Some(741),
            failures: Vec::new(),
        }],
        cams: vec![Cam {
            scans: [3, 990],
            begin: 0.1,
            length: 360.0,
            points: vec![0.0, 0.3, 1.0],
            ..Cam::default()
        }],
    }
}

/// A move over a symmetric profile with segments of n4, n3, n2, n1 scans and this snap (u/s^4).
fn profile(start: f64, snap: f64, n4: usize, n3: usize, n2: usize, n1: usize) -> Vec<State> {
    let ramp = [
        (snap, n4),
        (0.0, n3),
        (-snap, n4),
        (0.0, n2),
        (-snap, n4),
        (0.0, n3),
        (snap, n4),
    ];
    let brake = ramp.map(|(snap, scans)| (-snap, scans));
    let segments = ramp.into_iter().chain([(0.0, n1)]).chain(brake);
    let [mut p, mut v, mut a, mut j] = [start, 0.0, 0.0, 0.0];
    let mut states = Vec::new();
    for (s, scans) in segments {
        let at = |t: f64| -> State {
            [
                p + t * (v + t * (a / 2.0 + t * (j / 6.0 + t * s / 24.0))),
                v + t * (a + t * (j / 2.0 + t * s / 6.0)),
                a + t * (j + t * s / 2.0),
                j + t * s,
                s,
            ]
        };
        states.extend((1..=scans).map(|scan| at(scan as f64 * CYCLE)));
        [p, v, a, j, _] = at(scans as f64 * CYCLE);
    }
    let last = states.len() - 1;
    let target = (states[last][0] * 1e6).round() / 1e6;
    states[last] = [target, 0.0, 0.0, 0.0, 0.0];
    states
}

/// The run: `scans` scans, Execute of the first move in scan 5, of the second one scan after the first is
/// done, each at its place in the standard's timing. With `nudge` the position of one scan is off by one
/// bit.
pub fn run(scans: usize, nudge: Option<usize>) -> Trace {
    let there = profile(0.0, 400_000.0, 40, 10, 12, 320);
    let target = there[there.len() - 1][0];
    let back = profile(target, -400_000.0, 40, 10, 12, 320);
    let start = 5;
    let done = start + there.len();
    let back_start = done + 1;
    let back_done = back_start + back.len();
    let mut trace = Trace::new(header());
    let mut reported = 0.0;
    for scan in 0..scans {
        let state = if scan < start {
            [0.0; 5]
        } else if scan < done {
            there[scan - start]
        } else if scan < back_start {
            [target, 0.0, 0.0, 0.0, 0.0]
        } else if scan < back_done {
            back[scan - back_start]
        } else {
            [back[back.len() - 1][0], 0.0, 0.0, 0.0, 0.0]
        };
        let [mut p, v, a, j, s] = state;
        if nudge == Some(scan) {
            p = f64::from_bits(p.to_bits() + 1);
        }
        let first = scan >= start && scan < done;
        let second = scan >= back_start && scan < back_done;
        let axis_state = if first || second {
            "DiscreteMotion"
        } else {
            "Standstill"
        };
        let b = Cell::Bool;
        let r = Cell::Real;
        let mut row = vec![Cell::Name(axis_state), r(p), r(v), r(a), r(j), r(s), r(reported)];
        row.push(b(scan >= start));
        row.extend([Cell::Name("X"), b(true), b(true), b(false), Cell::Integer(0)]);
        for (execute, active, done, position) in [
            (scan >= start, first, scan >= done, target),
            (scan >= back_start, second, scan >= back_done, 0.0),
        ] {
            row.extend([
                Cell::Name("X"),
                b(execute),
                r(position),
                r(200.0),
                r(0.0),
                r(0.0),
                r(0.0),
            ]);
            row.push(Cell::Name("mcAborting"));
            row.extend([
                b(done),
                b(active),
                b(active),
                b(false),
                b(false),
                Cell::Integer(0),
            ]);
        }
        row.extend([Cell::Name("X"), b(true), b(true), r(reported)]);
        let elapsed = (scan as i64 - start as i64).clamp(0, 500) * 1_000_000;
        row.extend([
            b(scan >= start),
            Cell::Integer(500_000_000),
            b(elapsed == 500_000_000),
            Cell::Integer(elapsed),
        ]);
        trace.push_row(&row).expect("the row fits the header");
        reported = p;
    }
    for (scan, text) in [
        (start, "plan overlapped, n4=40 n3=10 n2=12 n1=320"),
        (back_start, "plan overlapped, back"),
    ] {
        trace.push_note(Note {
            scan,
            subject: "X".into(),
            text: text.into(),
        });
    }
    trace
}

/// The rows and notes of a run under another header.
pub fn under(header: Header, run: &Trace) -> Trace {
    let mut trace = Trace::new(header);
    for scan in 0..run.scans() {
        trace.push_cells(run.row(scan)).expect("the row fits");
    }
    run.notes().iter().for_each(|note| trace.push_note(note.clone()));
    trace
}

/// One column of each kind, with values that are hard to carry.
pub fn hard_values() -> Trace {
    let input = |name: &str, iec_type: &str| Input {
        name: name.into(),
        iec_type: iec_type.into(),
    };
    let mut trace = Trace::new(Header {
        cycle_ns: 250_000,
        inputs: vec![
            input("b", "BOOL"),
            input("r", "LREAL"),
            input("i", "LINT"),
            input("n", "COLOUR"),
        ],
        ..Header::default()
    });
    let mut reals = vec![
        f64::NAN,
        f64::INFINITY,
        f64::NEG_INFINITY,
        -0.0,
        5e-324,
        -2.2e-308,
        f64::MAX,
        f64::MIN,
        0.1 + 0.2,
        1e21,
        1e-7,
    ];
    // Any bit pattern may turn up, denormals and NaNs too.
    let mut random = standstill_testkit::Random(1);
    reals.extend((0..2000).map(|_| f64::from_bits(random.bits())));
    let names = ["red", "with, comma", "with \"quotes\"", "7", "TRUE", "grün"];
    for (at, &real) in reals.iter().enumerate() {
        let integer = [i64::MIN, i64::MAX, 0, -1][at % 4];
        let row = [
            Cell::Bool(at % 3 == 0),
            Cell::Real(real),
            Cell::Integer(integer),
            Cell::Name(names[at % 6]),
        ];
        trace.push_row(&row).expect("the row fits");
    }
    trace
}
