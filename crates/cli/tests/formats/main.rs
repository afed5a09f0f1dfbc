//! Every file format under random damage to files of this repository, with a bound on time and memory. It is
//! seeded, so a failure can be repeated. The fuzz target `formats` does the same with bytes that libFuzzer
//! searches.

mod play;

use play::{FORMATS, play};
use standstill_testkit::{Random, cases};
use std::fs;
use std::path::{Path, PathBuf};
use std::time::{Duration, Instant};

/// Damaged files of each format.
const CASES: u64 = 400;

/// No file here is longer than some kilobytes, so none may take longer than this on a busy machine.
const LONGEST: Duration = Duration::from_secs(10);

/// Peak of the whole test (kB): each case is in proportion to a small file.
const PEAK: u64 = 400_000;

/// Largest initial file (bytes).
const LARGEST: u64 = 8_000;

/// Files of the repository with this ending, sorted.
fn files(folder: &Path, ending: &str, found: &mut Vec<PathBuf>) {
    let mut entries: Vec<_> = fs::read_dir(folder)
        .expect("readable")
        .map(|entry| entry.expect("readable").path())
        .collect();
    entries.sort();
    for path in entries {
        let name = path.file_name().unwrap_or_default().to_string_lossy();
        if path.is_dir() && !["target", ".git", "node_modules"].contains(&name.as_ref()) {
            files(&path, ending, found);
        } else if name.ends_with(ending) && fs::metadata(&path).is_ok_and(|found| found.len() <= LARGEST) {
            found.push(path);
        }
    }
}

fn seeds(format: &str, ending: &str) -> Vec<Vec<u8>> {
    let root = Path::new(env!("CARGO_MANIFEST_DIR")).join("../..");
    let mut found = Vec::new();
    for folder in [
        "scan-tests",
        "docs",
        "crates/script/tests",
        "crates/trace/tests",
        "crates/cli/tests",
    ] {
        files(&root.join(folder), ending, &mut found);
    }
    let mut seeds: Vec<_> = found
        .iter()
        .map(|path| fs::read(path).expect("readable"))
        .collect();
    // Formats of which no file exists.
    let own: &[&str] = match format {
        "plan" => &[
            r#"{"id":1,"Ts":0.01,"target":1,"limits":{"velocity":1,"acceleration":2,"jerk":30,"snap":900}}"#,
            r#"{"Ts":0.001,"position":1,"velocity":0.5,"target":-3,"limits":{"velocity":1,"acceleration":2,"jerk":30},"method":"online"}"#,
            r#"{"Ts":0.01,"method":"tracking","targets":[[0,1],[0.5,2],[1,0]],"limits":{"velocity":9,"acceleration":9,"jerk":90}}"#,
            r#"{"Ts":0.01,"method":"timed","target":1,"duration":2,"gamma":0.3,"phi":0.2}"#,
            r#"{"Ts":0.01,"method":"short-path","target":1,"velocity":0.1,"end_velocity":0.2,"limits":{"velocity":1,"acceleration":2,"jerk":30}}"#,
        ],
        "jsonl" => &[
            "{\"standstill_trace\":1,\"cycle_ns\":1000000,\"axes\":[{\"name\":\"X\",\"unit\":\"mm\"}],\"inputs\":[{\"name\":\"go\",\"type\":\"BOOL\"}],\"instances\":[],\"notes\":[{\"scan\":0,\"subject\":\"X\",\"text\":\"plan\"}]}\n\
             {\"scan\":0,\"time_ns\":0,\"X.State\":\"Standstill\",\"X.Position\":0.0,\"X.Velocity\":0.0,\"X.Acceleration\":0.0,\"X.Jerk\":0.0,\"X.Snap\":0.0,\"X.ActualPosition\":0.0,\"go\":true}\n",
        ],
        "recording" => &[
            "t;x;go\n0;0,0;0\n1;0,5;1\n2;0,5;1\n",
            "scan,time_ns,X.State,X.Position,go\n0,0,Standstill,0.0,FALSE\n1,1000000,DiscreteMotion,0.5,TRUE\n#meta\n{\"standstill_trace\":1,\"cycle_ns\":1000000,\"axes\":[],\"inputs\":[],\"instances\":[]}",
        ],
        "map" => &[
            r#"{"standstill_compare": 1, "recording": {"time": {"column": "t", "unit": "ms"}, "decimal": ","},
            "offset": {"fit": "X.Position", "from": "T#-1s", "to": "T#1s"}, "signals": {"X.Position": {"column": "x", "tolerance": 1}, "go": {"column": "go"}}}"#,
        ],
        "machine" => &[
            r#"{"standstill": 1, "axes": {"X": {"limits": {"velocity": 5, "acceleration": 20}}}, "inputs": {"go": true},
            "tasks": {"main": {"interval": 1}}, "blocks": [{"name": "b", "type": "R_TRIG", "pins": {"CLK": {"from": "go"}}}]}"#,
        ],
        "sweep" => &[
            r#"{"standstill_sweep": 1, "script": "a.scan.json", "grid": {"v": {"from": 1, "to": 5, "count": 3}}, "measure": {"end": {"last": "X.Position"}}}"#,
        ],
        _ => &[],
    };
    seeds.extend(own.iter().map(|text| text.as_bytes().to_vec()));
    assert!(!seeds.is_empty(), "nothing to begin with for {format}");
    seeds
}

/// Pieces that mean something in one format or another.
const PIECES: [&[u8]; 16] = [
    b"\"",
    b"{",
    b"}",
    b"[",
    b",",
    b"\n",
    b"null",
    b"1e308",
    b"-0.0",
    b"9007199254740993",
    b"\"NaN\"",
    b"\\u001b",
    b"\\n",
    b"\xff",
    b"\x00",
    b"99999999999999999999",
];

/// A file with some damage: bytes changed, pieces inserted, removed or repeated, or the halves of two files.
fn damaged(random: &mut Random, seeds: &[Vec<u8>]) -> Vec<u8> {
    let mut bytes = seeds[random.place(seeds.len())].clone();
    for _ in 0..=random.place(4) {
        let at = random.place(bytes.len() + 1);
        let end = (at + random.place(40)).min(bytes.len());
        match random.place(6) {
            0 if at < bytes.len() => bytes[at] ^= 1 << random.place(8),
            1 => drop(bytes.splice(at..at, PIECES[random.place(PIECES.len())].iter().copied())),
            2 => drop(bytes.drain(at..end)),
            3 => {
                let piece = bytes[at..end].repeat(1 + random.place(20));
                bytes.splice(at..at, piece);
            }
            4 => {
                let other = &seeds[random.place(seeds.len())];
                bytes.truncate(at);
                bytes.extend(&other[random.place(other.len() + 1)..]);
            }
            _ => bytes.truncate(at),
        }
    }
    bytes
}

/// The peak memory of this process (kB), if the system reports it.
fn peak() -> u64 {
    let status = fs::read_to_string("/proc/self/status").unwrap_or_default();
    let line = status.lines().find_map(|line| line.strip_prefix("VmHWM:"));
    line.and_then(|line| line.trim().strip_suffix(" kB")?.parse().ok())
        .unwrap_or(0)
}

#[test]
fn no_file_takes_more_than_its_share() {
    let count = cases(CASES) as usize;
    for (number, (format, ending)) in (0..).zip(FORMATS) {
        let seeds = seeds(format, ending);
        let mut random = Random(0x5eed + u64::from(number));
        for case in 0..count {
            // The undamaged ones first.
            let bytes = match seeds.get(case) {
                Some(seed) if case < count / 4 => seed.clone(),
                _ => damaged(&mut random, &seeds),
            };
            let begin = Instant::now();
            play(number, &bytes);
            let took = begin.elapsed();
            assert!(
                took < LONGEST,
                "{format}, case {case}: {took:?} for {:?}",
                String::from_utf8_lossy(&bytes)
            );
        }
        assert!(peak() < PEAK, "{} kB after {format}", peak());
    }
}
