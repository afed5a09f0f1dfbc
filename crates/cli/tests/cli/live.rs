//! `live`: the same run, paced by the wall clock, and its ends.

use crate::support::{standstill, typed, with_script};

#[cfg(not(target_os = "linux"))]
#[test]
fn without_linux_it_says_so() {
    let folder = with_script("live_elsewhere");
    let ended = standstill(&folder, &["live", "move.scan.json", "--period", "10ms"]);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""));
    ended.complains("live is unsupported on this system");
}

#[cfg(target_os = "linux")]
mod linux {
    use super::*;
    use crate::support::{command, read, write};
    use rustix::process::{Pid, Signal, kill_process};
    use std::process::Stdio;
    use std::thread;
    use std::time::{Duration, Instant};

    /// The axis only accelerates within 0.1 s, and then runs for a minute.
    const ENDLESS: &str = r#"{
  "standstill": 1, "cycle": "T#1ms", "scans": 60000,
  "axes": {"X": {"limits": {"velocity": 20, "acceleration": 100}, "state": "Standstill"}},
  "inputs": {"GO": true},
  "blocks": [{"name": "move", "type": "MC_MoveVelocity",
    "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Velocity": 10}}],
  "expect": [{"at": 59000, "that": {"X.State": "ContinuousMotion"}}]
}"#;

    #[test]
    fn its_trace_is_that_of_run_to_the_byte() {
        let folder = with_script("live_same");
        let script = ENDLESS.replace("60000", "500").replace("59000", "490");
        write(&folder, "paced.scan.json", &script);
        let run = standstill(&folder, &["run", "-q", "paced.scan.json", "--trace", "run.csv"]);
        let start = Instant::now();
        let live = typed(
            &folder,
            "live paced.scan.json --period 1ms --trace live.csv --timing timing.json",
        );
        assert!(start.elapsed() >= Duration::from_millis(500));
        assert_eq!((run.status, live.status), (0, 0), "{}", live.err);
        assert_eq!(run.out, live.out);
        for end in ["", ".meta.json"] {
            assert_eq!(
                read(&folder, &format!("run.csv{end}")),
                read(&folder, &format!("live.csv{end}"))
            );
        }
        let timing: serde_json::Value = serde_json::from_str(&read(&folder, "timing.json")).expect("JSON");
        assert_eq!(timing["format"], "standstill-timing");
        assert_eq!(
            (&timing["version"], &timing["ended"]),
            (&1.into(), &"script".into())
        );
        assert_eq!(timing["period_ns"], 1_000_000);
        for measure in ["wake_latency_ns", "scan_time_ns"] {
            assert_eq!(timing[measure]["count"], 500, "{measure}");
            let buckets = timing[measure]["buckets"].as_array().expect("buckets");
            let all: u64 = buckets.iter().filter_map(|bucket| bucket["count"].as_u64()).sum();
            assert_eq!(all, 500, "{measure}");
        }
        assert!(timing["scan_time_ns"]["max"].as_u64() > Some(0));
        assert!(timing["system"]["scheduling"]["policy"].is_string());
    }

    #[test]
    fn a_claim_that_fails_is_told_as_by_run() {
        let folder = with_script("live_failing");
        let set = ["move.scan.json", "--set", "v=1"];
        let run = standstill(&folder, &[&["run", "-q"], &set[..]].concat());
        let live = standstill(&folder, &[&["live", "--period", "10ms"], &set[..]].concat());
        assert_eq!((run.status, live.status), (1, 1));
        assert_eq!(run.out, live.out);
    }

    #[test]
    fn another_period_than_the_cycle_is_refused_with_both() {
        let folder = with_script("live_period");
        let ended = standstill(&folder, &["live", "move.scan.json", "--period", "1ms"]);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""));
        for part in [
            "--period 1000000 ns",
            "is 10000000 ns",
            "write `--period 10000000ns`",
        ] {
            ended.complains(part);
        }
        for wrong in ["0ms", "fast", "-1ms"] {
            let ended = standstill(&folder, &["live", "move.scan.json", &format!("--period={wrong}")]);
            assert_eq!(ended.status, 2);
            ended.complains("such as 1ms or 250us");
        }
        let ended = typed(&folder, "live move.scan.json --period 10ms --trace x.txt");
        assert_eq!(ended.status, 2, "{}", ended.err);
        assert_eq!(
            standstill(&folder, &["live", "absent.scan.json", "--period", "10ms"]).status,
            4
        );
    }

    #[test]
    fn signals_in_motion_ramp_down_before_the_end() {
        let folder = with_script("live_signal");
        write(&folder, "endless.scan.json", ENDLESS);
        for (signal, name) in [
            (Signal::TERM, "SIGTERM"),
            (Signal::INT, "SIGINT"),
            (Signal::HUP, "SIGHUP"),
        ] {
            let child = command(&[
                "live",
                "endless.scan.json",
                "--period",
                "1ms",
                "--trace",
                "live.jsonl",
            ])
            .current_dir(&folder)
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .spawn()
            .expect("the program starts");
            thread::sleep(Duration::from_millis(800));
            kill_process(Pid::from_child(&child), signal).expect("it runs");
            let output = child.wait_with_output().expect("it ends");
            let out = String::from_utf8(output.stdout).expect("UTF-8");
            assert_eq!(output.status.code(), Some(0), "{out}");
            assert!(out.contains(&format!("stopped by {name} after scan ")), "{out}");
            assert!(out.contains("all axes are off"), "{out}");
            let trace = standstill_trace::file::load(&folder.join("live.jsonl"))
                .expect("a trace")
                .trace;
            assert!(trace.scans() < 60_000);
            let velocity: Vec<_> = trace
                .reals(trace.column("X.Velocity").expect("a column"))
                .collect();
            let top = velocity.iter().copied().fold(0.0, f64::max);
            assert!(top > 1.0, "it moved: {top}");
            assert_eq!(velocity.last(), Some(&0.0));
            // 100 mm/s^2 are 0.1 mm/s in a scan.
            assert!(
                velocity
                    .windows(2)
                    .all(|pair| (pair[1] - pair[0]).abs() < 0.1 + 1e-9)
            );
            let state = trace.row(trace.scans() - 1).next();
            assert_eq!(state, Some(standstill_trace::Cell::Name("Disabled")));
            let note = trace.notes().iter().find(|note| note.subject == "run");
            assert!(note.is_some_and(|note| note.text.contains(name)), "{note:?}");
        }
    }
}
