//! Every method on every case, and set-points as a table.

use crate::support::{command, ended, fed, read, scratch, standstill, write};

/// Rows of a CSV file without quotation marks, below its header.
fn rows(text: &str) -> Vec<Vec<&str>> {
    text.lines().skip(1).map(|row| row.split(',').collect()).collect()
}

#[test]
fn every_method_has_a_row_for_every_case() {
    let cases = concat!(
        r#"{"id": "rest", "Ts": 0.001, "target": 0.02, "n_star": 77, "#,
        r#""limits": {"velocity": 1, "acceleration": 20, "jerk": 2000}}"#,
        "\n\n",
        r#"{"Ts": 0.001, "target": 0.02, "velocity": 0.5, "limits": {"velocity": 1, "acceleration": 20}}"#,
        "\n",
    );
    let ended = fed(&["compare-planners", "-"], cases.as_bytes());
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    let rows = rows(&ended.out);
    assert!(rows.iter().all(|row| row.len() == 11), "{}", ended.out);
    let of = |case: &str, method: &str| {
        let mut found = rows.iter().filter(|row| row[..2] == [case, method]);
        let row = found.next().expect("a row");
        assert!(found.next().is_none());
        row[2..].to_vec()
    };
    let planned = of("rest", "s-curve");
    assert_eq!(planned[0], "75");
    // Four jerk pulses of 2000 u/s^3 and 10 ms each.
    let share: f64 = planned[1].parse::<f64>().unwrap();
    let rms: f64 = planned[6].parse().unwrap();
    assert!((rms - 2000.0 * (0.04 / share).sqrt()).abs() < 1e-9, "{planned:?}");
    assert_eq!(planned[7..], ["-2", ""]);
    assert_eq!(
        of("rest", "timed"),
        ["", "", "", "", "", "", "", "", "invalid_input"]
    );
    assert_eq!(of("line 3", "grid")[8], "invalid_input");
    let online = of("line 3", "online");
    // Of order 2, without n_star.
    assert_eq!(online[4..], ["", "", "", "", ""]);
}

#[test]
fn a_case_that_cannot_be_read_or_planned_fails_and_the_next_one_is_compared() {
    let folder = scratch("compare");
    let cases = concat!(
        "[1, 2]\n",
        r#"{"id": "unlimited", "Ts": 0.001, "target": 1}"#,
        "\n",
        r#"{"id": "half a scan", "Ts": 0.001, "target": 1, "limits": {"velocity": 1}, "n_star": 0.5}"#,
        "\n",
    );
    write(&folder, "cases.jsonl", cases);
    let ended = standstill(&folder, &["compare-planners", "cases.jsonl"]);
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    let rows = rows(&ended.out);
    assert_eq!(rows[0].join(","), "line 1,,,,,,,,,,invalid_input");
    assert!(
        rows[1..rows.len() - 1]
            .iter()
            .all(|row| row[0] == "unlimited" && row[10] == "invalid_input")
    );
    assert_eq!(
        rows[rows.len() - 1].join(","),
        "half a scan,,,,,,,,,,invalid_input"
    );
    let missing = standstill(&folder, &["compare-planners", "no.jsonl"]);
    assert_eq!(missing.status, 4);
}

#[test]
fn samples_go_from_the_start_to_the_end_of_each_plan() {
    let folder = scratch("samples");
    let limits = r#""limits": {"velocity": 1, "acceleration": 20, "jerk": 2000, "snap": 1e6}"#;
    let three = r#""limits": {"velocity": 1, "acceleration": 20, "jerk": 2000}"#;
    let lines = [
        format!(r#"{{"id": "grid", "Ts": 0.001, "target": 0.02, {limits}}}"#),
        format!(r#"{{"id": "refused", "target": 0.02, {limits}}}"#),
        format!(r#"{{"id": "moving", "Ts": 0.001, "target": 0.3, "velocity": 0.5, {limits}}}"#),
        format!(r#"{{"id": "ramp", "Ts": 0.001, "method": "ramp", "end_velocity": -1, {limits}}}"#),
        format!(r#"{{"id": "s", "Ts": 0.001, "target": 0.02, "method": "s-curve", {three}}}"#),
        format!(
            r#"{{"id": "on", "Ts": 0.001, "method": "tracking", "targets": [[0, 1], [0.1, 0.5]], {limits}}}"#
        ),
    ];
    write(&folder, "lines.jsonl", &lines.join("\n"));
    let mut planning = command(&["plan", "lines.jsonl", "--samples", "samples.csv"]);
    let planned = ended(planning.current_dir(&folder));
    assert_eq!((planned.status, planned.err.as_str()), (1, ""));
    let samples = read(&folder, "samples.csv");
    let mut text = samples.lines();
    assert!(text.next().is_some_and(|line| line.starts_with("# row n: ")));
    assert_eq!(
        text.next(),
        Some("id,scan,position,velocity,acceleration,jerk,snap")
    );
    let rows: Vec<Vec<&str>> = text.map(|row| row.split(',').collect()).collect();
    for answer in planned.out.lines() {
        let answer: serde_json::Value = serde_json::from_str(answer).unwrap();
        let own: Vec<_> = rows.iter().filter(|row| row[0] == answer["id"]).collect();
        let Some(scans) = answer["scans"].as_u64() else {
            assert!(own.is_empty());
            continue;
        };
        for (scan, row) in own.iter().enumerate() {
            assert_eq!(row[1], scan.to_string());
        }
        assert_eq!(own.len() as u64, scans + 1, "{}", answer["id"]);
        let number = |row: &[&str], column: usize| row[column].parse::<f64>().unwrap();
        let last = own[own.len() - 1];
        assert_eq!(number(last, 3), answer["end"]["velocity"].as_f64().unwrap());
        if answer["id"] != "ramp" {
            assert_eq!(number(last, 2), answer["end"]["position"].as_f64().unwrap());
        }
        // No step is longer than the largest velocity allows. So nothing jumps, not even between plans.
        for pair in own.windows(2) {
            let step = number(pair[1], 2) - number(pair[0], 2);
            assert!(step.abs() <= 0.001 * (1.0 + 1e-9), "{pair:?}");
        }
    }
}

#[test]
fn samples_that_cannot_be_written_are_an_error_of_io() {
    let folder = scratch("samples_nowhere");
    let mut planning = command(&["plan", "-", "--samples", "no/such/folder.csv"]);
    let planned = ended(planning.current_dir(&folder));
    assert_eq!(planned.status, 4);
    planned.complains_first("error: no/such/folder.csv: ");
}
