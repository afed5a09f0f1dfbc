//! `identify`: the vibration of simulated loads and of recordings, compared with their peaks.
#![expect(
    clippy::disallowed_methods,
    reason = "a judge that takes logarithms and sines from elsewhere than what it judges; its tolerances are far above rounding"
)]

use crate::support::{read, scratch, standstill, write};
use serde_json::Value;
use std::f64::consts::PI;
use std::fmt::Write as _;
use std::path::Path;

/// A load on a spring with this damping is turned; then it vibrates.
fn script(damping: f64) -> String {
    let plant = format!(
        r#"{{"inertia": 0.02, "viscous": 0.01, "load": {{"inertia": 0.05, "stiffness": 200, "damping": {damping}}}}}"#
    );
    format!(
        r#"{{
  "standstill": 1, "cycle": "T#1ms", "scans": 2000,
  "axes": {{"X": {{"unit": "rad", "limits": {{"velocity": 2, "acceleration": 40, "jerk": 2000}},
    "drive": {{"plant": {plant}}}}}}},
  "inputs": {{"GO": false}},
  "blocks": [
    {{"name": "power", "type": "MC_Power", "pins": {{"Axis": "X", "Enable": true}}}},
    {{"name": "move", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": {{"from": "GO"}}, "Position": 0.5, "Velocity": 2}}}}
  ],
  "steps": [{{"at": 10, "set": {{"GO": true}}}}]
}}"#
    )
}

/// Runs it into `swing.csv`. Returns the distance of the motor from the target, once the set-point is at rest.
fn recorded(folder: &Path, damping: f64) -> Vec<f64> {
    write(folder, "swing.scan.json", &script(damping));
    let run = standstill(
        folder,
        &["run", "--quiet", "swing.scan.json", "--trace", "swing.csv"],
    );
    assert_eq!(run.status, 0, "{}", run.err);
    let text = read(folder, "swing.csv");
    let names: Vec<&str> = text.lines().next().unwrap().split(',').collect();
    let column = |name: &str| names.iter().position(|other| *other == name).unwrap();
    let (set, actual) = (column("X.Position"), column("X.ActualPosition"));
    let rows = text.lines().skip(1).map(|line| {
        let cells: Vec<&str> = line.split(',').collect();
        (
            cells[set].parse::<f64>().unwrap(),
            cells[actual].parse::<f64>().unwrap(),
        )
    });
    rows.filter(|(set, _)| *set == 0.5)
        .map(|(_, actual)| actual - 0.5)
        .collect()
}

/// Scans of a period and damping ratio, from the times and heights of the peaks.
fn of_peaks(samples: &[f64]) -> (f64, f64) {
    let is_peak = |three: &[f64]| three[1] > three[0] && three[1] >= three[2] && three[1] > 0.0;
    let peaks: Vec<(f64, f64)> = samples
        .windows(3)
        .enumerate()
        .filter(|(_, three)| is_peak(three))
        .map(|(place, three)| {
            // The top of the parabola through three samples.
            let (rise, bend) = (three[2] - three[0], three[2] - 2.0 * three[1] + three[0]);
            (
                place as f64 + 1.0 - rise / (2.0 * bend),
                three[1] - rise * rise / (8.0 * bend),
            )
        })
        .take(8)
        .collect();
    let (first, last) = (peaks[1], peaks[peaks.len() - 1]);
    let periods = (peaks.len() - 2) as f64;
    let decrement = (first.1 / last.1).ln() / periods;
    (
        (last.0 - first.0) / periods,
        decrement / (decrement * decrement + 4.0 * PI * PI).sqrt(),
    )
}

fn found(folder: &Path, arguments: &[&str]) -> Value {
    let ended = standstill(folder, &[&["identify", "--json"], arguments].concat());
    assert_eq!(ended.status, 0, "{}{}", ended.out, ended.err);
    ended.answer()["signals"][0].clone()
}

#[test]
fn a_simulated_load_swings_as_its_peaks_say() {
    let folder = scratch("identify_load");
    for damping in [0.05, 0.2, 0.4, 0.6] {
        let samples = recorded(&folder, damping);
        let (period, ratio) = of_peaks(&samples);
        let found = found(&folder, &["swing.csv"]);
        let (frequency, of_damping) = (
            found["frequency"].as_f64().unwrap(),
            found["damping"].as_f64().unwrap(),
        );
        assert_eq!(found["signal"], "X.ActualPosition - X.Position");
        // Peaks have the period with damping.
        let damped = frequency * (1.0 - of_damping * of_damping).sqrt();
        assert!(
            (damped * period / 1000.0 - 1.0).abs() < 0.02,
            "{damping}: {found}, {period} scans"
        );
        assert!(
            (of_damping - ratio).abs() < 0.1 * ratio.abs() + 0.001,
            "{damping}: {found}, {ratio}"
        );
        // The load alone, with the motor held, vibrates a little faster.
        let held = (200.0_f64 / 0.05).sqrt() / (2.0 * PI);
        assert!(
            frequency < held && frequency > 0.9 * held,
            "{damping}: {found}, {held}"
        );
    }
}

#[test]
fn the_text_says_with_how_much_error() {
    let folder = scratch("identify_text");
    recorded(&folder, 0.4);
    let ended = standstill(&folder, &["identify", "swing.csv"]);
    let lines: Vec<&str> = ended.out.lines().collect();
    assert!(
        lines[0].starts_with("X.ActualPosition - X.Position, 0."),
        "{}",
        ended.out
    );
    assert!(
        lines[1].starts_with("  frequency  9.8")
            && lines[1].ends_with(" Hz")
            && lines[1].contains(" +- 0.00")
    );
    assert!(lines[2].starts_with("  damping    0.0"), "{}", ended.out);
    assert!(
        lines[3].starts_with("  swing      1.") && lines[4].starts_with("  explained  99."),
        "{}",
        ended.out
    );
    // A vibration that the loops feed is reported as such.
    recorded(&folder, 0.0);
    let ended = standstill(&folder, &["identify", "swing.csv"]);
    ended.prints("it grows, the loops feed it");
}

/// A scope with decimal commas, milliseconds, and samples that are not quite even.
#[test]
fn a_recording_of_a_machine_is_read_as_it_was_exported() {
    let folder = scratch("identify_recording");
    let mut text = "Scope;export\n\nt/ms;encoder\n".to_owned();
    for place in 0..700_u32 {
        let time = f64::from(place) * 2.0 + 0.1 * (f64::from(place) * 1.7).sin();
        let value = 3.0
            + 0.02 * (-0.03 * 2.0 * PI * 7.5 * time / 1000.0).exp() * (2.0 * PI * 7.5 * time / 1000.0).cos();
        let _ = writeln!(text, "{}", format!("{time:.3};{value:.7}").replace('.', ","));
    }
    write(&folder, "scope.csv", &text);
    let taken = [
        "scope.csv",
        "--time",
        "t/ms",
        "--unit",
        "ms",
        "--signal",
        "encoder",
    ];
    let found = found(&folder, &taken);
    assert!(
        (found["frequency"].as_f64().unwrap() - 7.5).abs() < 0.01,
        "{found}"
    );
    assert!(
        (found["damping"].as_f64().unwrap() - 0.03).abs() < 0.001,
        "{found}"
    );
}

#[test]
fn what_is_wrong_is_said_with_its_remedy() {
    let folder = scratch("identify_wrong");
    recorded(&folder, 0.4);
    write(&folder, "note.txt", "nothing");
    for (arguments, status, told) in [
        (
            &["swing.csv", "--signal", "X.Positon"][..],
            2,
            "did you mean `X.Position`?",
        ),
        (
            &["swing.csv", "--signal", "move.Done"],
            2,
            "the trace has no numbers of this name",
        ),
        (
            &["swing.csv", "--from", "2s", "--to", "1s"],
            2,
            "--to is not after --from",
        ),
        (
            &["swing.csv", "--from", "5"],
            2,
            "write a time above 0 with its unit",
        ),
        (&["swing.csv", "--time", "t"], 2, "--signal <NAME>"),
        (&["swing.csv", "--time", "t", "--signal", "X.Position"], 3, "t"),
        (
            &[
                "swing.csv",
                "--time",
                "time_ns",
                "--unit",
                "ns",
                "--signal",
                "X.Position",
                "--from",
                "9s",
            ],
            3,
            "no sample lies between",
        ),
        (&["note.txt"], 2, "a trace is a .csv"),
        (&["nothing.csv"], 4, "nothing.csv: "),
    ] {
        let ended = standstill(&folder, &[&["identify"], arguments].concat());
        assert_eq!(
            (ended.status, ended.out.as_str()),
            (status, ""),
            "{arguments:?}: {}",
            ended.err
        );
        ended.complains(told);
    }
    // No vibration is a result, with status 1.
    for (arguments, told) in [
        (&["--signal", "move.Position"][..], "nothing moves"),
        (&["--from", "1990ms"], "it takes 16: take a longer window"),
        (&["--signal", "X.Position"], "no swing: "),
    ] {
        let ended = standstill(&folder, &[&["identify", "swing.csv"], arguments].concat());
        assert_eq!(ended.status, 1, "{arguments:?}: {}", ended.err);
        ended.prints(told);
    }
}
