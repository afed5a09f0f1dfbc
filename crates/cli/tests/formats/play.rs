//! Bytes as a file of any format that the program reads. Nothing may panic. The caller bounds work and memory.

use standstill_cli::plan::plan;
use standstill_picture::{plot, report};
use standstill_script::{format, read_map, read_sweep, read_with_programs};
use standstill_trace::golden::judge;
use standstill_trace::machine::compare;
use standstill_trace::story::story;
use standstill_trace::{Loaded, Trace, csv, events_text, exact, foreign, jsonl, vcd};
use std::fs;
use std::path::PathBuf;

/// The formats, each with the ending of its initial files in this repository.
pub const FORMATS: [(&str, &str); 9] = [
    ("script", ".scan.json"),
    ("machine", ".machine.json"),
    ("sweep", ".sweep.json"),
    ("map", ".map.json"),
    ("recording", ".csv"),
    ("jsonl", ".jsonl"),
    ("exact", ".exact"),
    ("golden", ".snap"),
    ("plan", ".plan.jsonl"),
];

/// Largest number of scans of a run that is made of a script. The limits of runs are not tested here.
const SCANS: u64 = 2000;

/// A script that includes the machine file.
const INCLUDES: &str = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 10, "include": "m.machine.json", "blocks": [],
    "axes": {"Own": {"limits": {"velocity": 1, "acceleration": 1}}}, "override": ["X", "go", "b"]}"#;

/// Reads the bytes as a file of the format of this number, and does with it what the program would.
pub fn play(format_number: u8, bytes: &[u8]) {
    let (format, _) = FORMATS[usize::from(format_number) % FORMATS.len()];
    let text = String::from_utf8_lossy(bytes);
    match format {
        "script" => script(&text, ""),
        "machine" => script(INCLUDES, &text),
        "sweep" => drop(read_sweep(&text, "a.sweep.json").map_err(|error| error.to_string())),
        "map" => map(&text),
        "recording" => recording(bytes, &text),
        "jsonl" => loaded(jsonl::read(&text).ok()),
        "exact" => loaded(exact::decode(bytes).ok().map(|trace| Loaded {
            trace,
            lacks: Vec::new(),
        })),
        "golden" => golden(bytes),
        _ => drop(plan(&mut &*bytes, "lines", &mut std::io::sink())),
    }
}

/// A script, and the machine file that it may include.
fn script(text: &str, machine: &str) {
    let _laid_out = format(text, "a.scan.json").map_err(|error| error.to_string());
    let mut load = |_: &str| Ok(machine.to_owned());
    let mut guest = |_: &str| Err("there is none".to_owned());
    match read_with_programs(text, "a.scan.json", &[], &mut load, &mut guest) {
        Err(error) => assert!(!error.to_string().is_empty()),
        Ok(script) if script.scans <= SCANS => {
            if let Ok(outcome) = standstill_script::run(&script) {
                let again = standstill_script::judge_recording(&script, outcome.trace.clone());
                assert!(
                    again.is_ok() || script.claims.is_empty(),
                    "its own trace has all columns"
                );
                loaded(Some(Loaded {
                    trace: outcome.trace,
                    lacks: Vec::new(),
                }));
            }
        }
        Ok(_) => {}
    }
}

/// The uses of traces.
fn loaded(loaded: Option<Loaded>) {
    let Some(Loaded { trace, .. }) = loaded else {
        return;
    };
    let text = events_text(&trace) + &plot(&trace, 100) + &standstill_trace::golden::text(&trace);
    let hidden = text
        .chars()
        .find(|character| character.is_control() && *character != '\n');
    assert_eq!(hidden, None);
    let _picture = report(&trace);
    let _ = vcd::write(&trace, &mut std::io::sink());
    assert!(story(&trace, &trace).is_none(), "it is equal to itself");
    if trace.columns().is_empty() {
        return;
    }
    let mut written = Vec::new();
    jsonl::write(&trace, &mut written).expect("memory takes all");
    let again = jsonl::read(&String::from_utf8(written).expect("JSON is text"));
    let again = again.expect("what was written can be read").trace;
    assert_eq!(again.scans(), trace.scans());
}

/// A trace for comparison with other files.
fn known() -> Trace {
    let text =
        "scan,time_ns,X.State,X.Position,go\n0,0,Standstill,0.0,FALSE\n1,1000000,DiscreteMotion,0.5,TRUE\n";
    csv::read(text, None).expect("a trace").trace
}

fn map(text: &str) {
    let trace = known();
    let Ok(map) = read_map(text, "a.map.json", &trace) else {
        return;
    };
    let recorded = "t;x;go\n0;0,0;0\n1;0,5;1\n2;0,5;1\n";
    if let Ok(recorded) = foreign::read(recorded, &map.layout, &map.wanted()) {
        let _ = compare(&recorded, &trace, &map).map(|comparison| comparison.to_string());
    }
}

/// A table: our own, or that of a scope.
fn recording(bytes: &[u8], text: &str) {
    let trace = known();
    let map = r#"{"standstill_compare": 1, "recording": {"time": {"column": "t", "unit": "ms"}}, "offset": "T#0s",
        "signals": {"X.Position": {"column": "x", "tolerance": 1}, "go": {"column": "go"}}}"#;
    let map = read_map(map, "a.map.json", &trace).expect("a map");
    if let Some(text) = foreign::decode(bytes)
        && let Ok(recorded) = foreign::read(&text, &map.layout, &map.wanted())
    {
        let _ = compare(&recorded, &trace, &map).map(|comparison| comparison.to_string());
    }
    // The header beside a table is behind a line of its own.
    let (rows, meta) = text.split_once("\n#meta\n").unwrap_or((text, ""));
    loaded(csv::read(rows, (!meta.is_empty()).then_some(meta)).ok());
}

fn golden(bytes: &[u8]) {
    let folder = folder();
    let snap = folder.join("a.snap");
    fs::write(&snap, bytes).expect("writable");
    if let Ok(verdict) = judge(&snap, &known())
        && let standstill_trace::golden::Verdict::Different(mismatch) = verdict
    {
        let text = mismatch.to_string();
        assert_eq!(
            text.chars().find(|letter| letter.is_control() && *letter != '\n'),
            None
        );
    }
}

fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("standstill-formats-{}", std::process::id()));
    fs::create_dir_all(&folder).expect("writable");
    folder
}
