//! The digested signals of feed and place, defined only here, and the builds of its hosts.

use standstill_trace::{Axis, Cell, Header, Input, Trace, digest};
use std::ffi::OsStr;
use std::io::Write as _;
use std::path::{Path, PathBuf};
use std::process::{Command, Output};
use std::{env, fs};

/// The digest of feed and place in every host.
pub const FEED_AND_PLACE: u64 = 0x0ea5_2292_313f_b652;

/// Scans of feed and place.
pub const SCANS: usize = 5700;

const STATES: [&str; 8] = [
    "Disabled",
    "Standstill",
    "Homing",
    "DiscreteMotion",
    "ContinuousMotion",
    "SynchronizedMotion",
    "Stopping",
    "ErrorStop",
];

/// The variables in the digest, in this order, with the types of `prog.st`.
pub const VARIABLES: [(&str, &str); 9] = [
    ("State", "INT"),
    ("Parts", "INT"),
    ("Aborts", "INT"),
    ("FeedBusy", "BOOL"),
    ("FeedDone", "BOOL"),
    ("FeedAborted", "BOOL"),
    ("PlaceBusy", "BOOL"),
    ("PlaceDone", "BOOL"),
    ("PlaceAborted", "BOOL"),
];

/// The columns in the digest of a run: all columns of both axes, then the variables. The digest is that of any
/// trace.
pub fn empty() -> Trace {
    let axis = |name: &str| Axis {
        name: name.to_owned(),
        ..Axis::default()
    };
    let inputs = VARIABLES.map(|(name, iec_type)| Input {
        name: name.to_owned(),
        iec_type: iec_type.to_owned(),
    });
    Trace::new(Header {
        cycle_ns: 1_000_000,
        axes: vec![axis("Feeder"), axis("Placer")],
        inputs: inputs.to_vec(),
        ..Header::default()
    })
}

/// The trace of a host that prints every scan, as `host.c` does.
pub fn of_lines(text: &str) -> Trace {
    let mut trace = empty();
    for line in text.lines() {
        let mut words = line.split(' ');
        let mut cells = Vec::new();
        for _ in 0..2 {
            let state: usize = words.next().unwrap().parse().unwrap();
            cells.push(Cell::Name(STATES[state]));
            for word in words.by_ref().take(6) {
                cells.push(Cell::Real(f64::from_bits(u64::from_str_radix(word, 16).unwrap())));
            }
        }
        for ((_, iec_type), word) in VARIABLES.iter().zip(words) {
            let number: i64 = word.parse().unwrap();
            cells.push(match *iec_type {
                "BOOL" => Cell::Bool(number != 0),
                _ => Cell::Integer(number),
            });
        }
        trace.push_row(&cells).unwrap();
    }
    trace
}

/// The trace of a scan script: the columns of its axes, and the variables that `variables` computes from a scan.
pub fn of_script(path: &Path, variables: impl Fn(&Trace, usize) -> Vec<Cell<'static>>) -> Trace {
    let (_, script) = standstill_script::suite::Texts::read(path, &Default::default()).unwrap();
    let outcome = standstill_script::run(&script).unwrap();
    for verdict in &outcome.verdicts {
        assert!(verdict.failures.is_empty(), "{}: {verdict:?}", path.display());
    }
    let run = &outcome.trace;
    let mut trace = empty();
    let axes: Vec<_> = trace.columns()[..14]
        .iter()
        .map(|column| run.column(&column.name).unwrap())
        .collect();
    for scan in 0..run.scans() {
        let mut cells: Vec<_> = axes.iter().map(|at| run.cell(scan, *at).unwrap()).collect();
        cells.extend(variables(run, scan));
        trace.push_row(&cells).unwrap();
    }
    trace
}

/// The variables of a guest, under the names in its script.
pub fn of_guest(path: &Path, name: impl Fn(&str) -> String) -> Trace {
    of_script(path, |run, scan| {
        let at = |(variable, _)| run.column(&format!("cell.{}", name(variable))).unwrap();
        let cells = VARIABLES.map(|variable| match run.cell(scan, at(variable)).unwrap() {
            Cell::Bool(value) => Cell::Bool(value),
            Cell::Integer(value) => Cell::Integer(value),
            other => panic!("{variable:?}: {other:?}"),
        });
        cells.to_vec()
    })
}

/// Compares a trace with the digest, and reports where it differs from another one that is known to be right.
pub fn hold(host: &str, trace: &Trace, right: Option<&Trace>) {
    assert_eq!(trace.scans(), SCANS, "{host}");
    for scan in 0..SCANS {
        let Some(right) = right else { break };
        let differing = right.columns().iter().zip(right.row(scan).zip(trace.row(scan)));
        for (column, (right, found)) in differing {
            assert_eq!(found, right, "{host}: {} in scan {scan}", column.name);
        }
    }
    let found = digest::whole(trace);
    assert_eq!(found, FEED_AND_PLACE, "{host}: {found:#018x}");
}

/// The folder with all forms of the program.
pub fn folder() -> PathBuf {
    Path::new(env!("CARGO_MANIFEST_DIR")).join("feed_and_place")
}

pub fn scratch(name: &str) -> PathBuf {
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR")).join(name);
    fs::create_dir_all(&folder).unwrap();
    folder
}

/// Reports that a test is skipped, and why. It bypasses the runner, which hides the output of tests that pass.
pub fn skip(why: &str) {
    let mut out = std::io::stderr();
    // If nothing can be written, nobody can read the message.
    let _told = writeln!(out, "SKIP: {why}");
}

/// Whether a tool can be run. Without it a test ends early, loudly, and not in CI.
pub fn has(tool: &str) -> bool {
    let found = Command::new(tool).arg("--version").output().is_ok();
    if !found {
        assert!(env::var_os("CI").is_none(), "CI must have {tool}");
        skip(&format!("there is no {tool}"));
    }
    found
}

pub fn run(program: impl AsRef<OsStr>, arguments: impl IntoIterator<Item = impl AsRef<OsStr>>) -> Output {
    let program = program.as_ref();
    let arguments: Vec<_> = arguments.into_iter().map(|it| it.as_ref().to_owned()).collect();
    let output = Command::new(program).args(&arguments).output();
    let output = output.unwrap_or_else(|error| panic!("{}: {error}", program.display()));
    assert!(
        output.status.success(),
        "{} {arguments:?}: {}\n{}{}",
        program.display(),
        output.status,
        String::from_utf8_lossy(&output.stdout),
        String::from_utf8_lossy(&output.stderr)
    );
    output
}

/// The static C library: cargo has built it for the tests, beside them.
pub fn library() -> PathBuf {
    let library = env::current_exe().unwrap().with_file_name("libstandstill_capi.a");
    assert!(library.is_file(), "there is no {}", library.display());
    library
}

/// Puts what `standstill export` writes for a target into a folder.
pub fn exported(target: standstill_export::Target, folder: &Path) {
    use standstill_export::{Dialect, Prefix, export};
    for file in export(target, &Prefix::default(), &Dialect::default()) {
        fs::write(folder.join(file.name), file.text).unwrap();
    }
}
