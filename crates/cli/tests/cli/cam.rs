//! `cam`: laws against their published constants and through the runtime, tables against their axes.
//!
//! The output is judged by code that shares nothing with the writer: its own reader of CSV, its own
//! curves of degree 7 (by divided differences), and the laws as integrals of their acceleration.
#![expect(
    clippy::disallowed_methods,
    clippy::approx_constant,
    reason = "a judge that takes sines and constants from elsewhere than what it judges; its tolerances are far above rounding"
)]

use crate::support::{Ended, fed, read, scratch, standstill, typed, write};
use serde_json::Value;
use std::f64::consts::PI;
use std::path::Path;

/// A law: its name, its largest velocity, acceleration and jerk for a lift of 1 over 1 (VDI 2143), and its
/// acceleration as a function where needed; the other half is its mirror.
struct Law {
    name: &'static str,
    peaks: [f64; 3],
    acceleration: fn(f64) -> f64,
}

const LAWS: [Law; 5] = [
    Law {
        name: "modified-sine",
        peaks: [1.7596, 5.528, 69.47],
        acceleration: |x| {
            if x < 0.125 {
                (4.0 * PI * x).sin()
            } else {
                (PI / 3.0 + 4.0 * PI * x / 3.0).sin()
            }
        },
    },
    Law {
        name: "sinoid",
        peaks: [2.0, 6.2832, 39.478],
        acceleration: |x| (2.0 * PI * x).sin(),
    },
    Law {
        name: "poly345",
        peaks: [1.875, 5.7735, 60.0],
        acceleration: |x| x * (60.0 + x * (-180.0 + x * 120.0)),
    },
    Law {
        name: "poly4567",
        peaks: [2.1875, 7.5132, 52.5],
        acceleration: |x| x * x * (420.0 + x * (-1680.0 + x * (2100.0 - x * 840.0))),
    },
    Law {
        name: "trapezoid",
        peaks: [2.0, 4.888, 61.43],
        acceleration: |x| {
            if x < 0.125 {
                (4.0 * PI * x).sin()
            } else if x < 0.375 {
                1.0
            } else {
                -(4.0 * PI * x).sin()
            }
        },
    },
];

impl Law {
    /// The position at `x` for a lift that is not scaled to 1: the integral of (x - t) a(t), by Simpson's rule for
    /// each eighth.
    fn raw(&self, x: f64) -> f64 {
        const PARTS: u32 = 128;
        let mut sum = 0.0;
        for eighth in 0..4 {
            let from = 0.125 * f64::from(eighth);
            let to = (from + 0.125).min(x);
            if to <= from {
                break;
            }
            let h = (to - from) / f64::from(PARTS);
            for part in 0..=PARTS {
                // Inside the eighth, because the acceleration may jump at its ends.
                let t = (from + h * f64::from(part)).clamp(from, (from + 0.125).next_down());
                let weight = match part {
                    0 | PARTS => 1.0,
                    part if part % 2 == 1 => 4.0,
                    _ => 2.0,
                };
                sum += weight * h / 3.0 * (x - t) * (self.acceleration)(t);
            }
        }
        sum
    }

    fn position(&self, x: f64) -> f64 {
        if x > 0.5 {
            1.0 - self.position(1.0 - x)
        } else {
            0.5 * self.raw(x) / self.raw(0.5)
        }
    }
}

/// A row: five numbers and the law.
type Row = ([f64; 5], String);

fn rows(text: &str) -> Vec<Row> {
    let mut lines = text.lines().filter(|line| !line.starts_with('#'));
    assert_eq!(lines.next(), Some("Master,Slave,Slope,Curvature,Third,Law"));
    lines
        .map(|line| {
            let cells: Vec<&str> = line.split(',').collect();
            assert_eq!(cells.len(), 6, "{line}");
            (
                std::array::from_fn(|cell| cells[cell].parse().unwrap()),
                cells[5].to_owned(),
            )
        })
        .collect()
}

/// The coefficients of the stretch between two rows, in powers of the distance from the first row.
fn stretch((from, law): &Row, (to, _): &Row) -> Vec<f64> {
    let (width, way) = (to[0] - from[0], to[1] - from[1]);
    let per = |power: i32| way / width.powi(power);
    match law.as_str() {
        "mcCamRest5" => vec![from[1], 0.0, 0.0, 10.0 * per(3), -15.0 * per(4), 6.0 * per(5)],
        "mcCamRest7" => vec![
            from[1],
            0.0,
            0.0,
            0.0,
            35.0 * per(4),
            -84.0 * per(5),
            70.0 * per(6),
            -20.0 * per(7),
        ],
        "mcCamPoly7" => {
            // Divided differences with each end four times.
            let derivative = |end: &[f64; 5], order: usize| end[1 + order] / [1.0, 1.0, 2.0, 6.0][order];
            let places: [f64; 8] = std::array::from_fn(|node| if node < 4 { 0.0 } else { width });
            let mut table: Vec<f64> = (0..8)
                .map(|node| if node < 4 { from[1] } else { to[1] })
                .collect();
            let mut newton = vec![table[0]];
            for order in 1..8 {
                table = (0..8 - order)
                    .map(|node| {
                        let way = places[node + order] - places[node];
                        if way == 0.0 {
                            derivative(if node < 4 { from } else { to }, order)
                        } else {
                            (table[node + 1] - table[node]) / way
                        }
                    })
                    .collect();
                newton.push(table[0]);
            }
            // Newton's form multiplied out.
            let mut powers = vec![0.0; 8];
            for order in (0..8).rev() {
                let shifted: Vec<f64> = (0..8)
                    .map(|power| {
                        let lower = if power > 0 { powers[power - 1] } else { 0.0 };
                        lower - places[order] * powers[power]
                    })
                    .collect();
                powers = shifted;
                powers[0] += newton[order];
            }
            powers
        }
        other => panic!("{other}"),
    }
}

fn derived(powers: &[f64]) -> Vec<f64> {
    (1..powers.len())
        .map(|power| power as f64 * powers[power])
        .collect()
}

fn value(powers: &[f64], x: f64) -> f64 {
    powers.iter().rev().fold(0.0, |sum, power| sum * x + power)
}

fn law(name: &str, more: &[&str]) -> Ended {
    let mut arguments = vec!["cam", "law", name];
    arguments.extend(more);
    standstill(Path::new("."), &arguments)
}

#[test]
fn every_law_has_its_positions_and_its_published_peaks() {
    for this in &LAWS {
        let name = this.name;
        for (lift, width, begin, from) in [(1.0, 1.0, 0.0, 0.0), (-40.0, 90.0, 270.0, 55.5)] {
            let [l, w, b, f] = [lift, width, begin, from].map(|number: f64| number.to_string());
            let ended = law(name, &["--lift", &l, "--width", &w, "--begin", &b, "--from", &f]);
            assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{name}");
            let rows = rows(&ended.out);
            let ends = (rows[0].0, rows[rows.len() - 1].0);
            assert_eq!([ends.0[0], ends.0[1]], [begin, from], "{name}");
            assert_eq!([ends.1[0], ends.1[1]], [begin + width, from + lift], "{name}");
            let (mut off, mut most) = (0.0_f64, [0.0_f64; 3]);
            for pair in rows.windows(2) {
                let powers = stretch(&pair[0], &pair[1]);
                let orders = [
                    derived(&powers),
                    derived(&derived(&powers)),
                    derived(&derived(&derived(&powers))),
                ];
                for step in 0..=400 {
                    let way = (pair[1].0[0] - pair[0].0[0]) * f64::from(step) / 400.0;
                    let x = (pair[0].0[0] - begin + way) / width;
                    off = off.max(((value(&powers, way) - from) / lift - this.position(x)).abs());
                    for (order, most) in most.iter_mut().enumerate() {
                        let norm = width.powi(order as i32 + 1) / lift;
                        *most = most.max((value(&orders[order], way) * norm).abs());
                    }
                }
            }
            assert!(off <= 1e-6, "{name}: {off:e} of the lift");
            for (found, published) in most.iter().zip(this.peaks) {
                let share = (found / published - 1.0).abs();
                assert!(share <= 1e-3, "{name}: {found} is {share:e} from {published}");
            }
        }
    }
}

/// A master that passes the cam at `v`, and a slave with limits of which only one is nearly reached.
fn script(limits: &str) -> String {
    let axis =
        |limits: &str, more: &str| format!("{{\"limits\": {limits}, \"state\": \"Standstill\"{more}}}");
    let master = axis(
        r#"{"velocity": 5000, "acceleration": 20000, "jerk": 1000000, "snap": 1e8}"#,
        r#", "position": -300"#,
    );
    format!(
        r#"{{
  "standstill": 1,
  "title": "A law at a constant velocity of its master",
  "cycle": "T#1ms",
  "scans": 6000,
  "parameters": {{"v": 1, "lags": 0}},
  "axes": {{"M": {master}, "S": {}}},
  "inputs": {{"GO": false}},
  "tables": {{"law": {{"type": "MC_CAM_POINT", "csv": "law.csv"}}}},
  "blocks": [
    {{"name": "select", "type": "MC_CamTableSelect", "pins": {{"Master": "M", "Slave": "S", "CamTable": {{"table": "law"}},
      "Execute": {{"from": "GO"}}, "MasterAbsolute": true, "SlaveAbsolute": true}}}},
    {{"name": "cam", "type": "MC_CamIn", "pins": {{"Master": "M", "Slave": "S", "Execute": {{"from": "select.Done"}},
      "CamTableID": {{"from": "select.CamTableID"}}}}}},
    {{"name": "run", "type": "MC_MoveVelocity", "pins": {{"Axis": "M", "Execute": {{"from": "cam.Active"}}, "Velocity": {{"param": "v"}}}}}}
  ],
  "steps": [{{"at": 1, "set": {{"GO": true}}}}],
  "stop_when": {{"M.Position": {{"ge": 300}}}},
  "golden": false,
  "expect": [
    {{"within_limits": "S"}},
    {{"never": {{"cam.Error": true}}}},
    {{"by": 5999, "that": {{"M.Position": {{"ge": 180}}, "run.InVelocity": true}}}},
    {{"always": {{"M.Acceleration": 0}}, "while": {{"M.Position": {{"gt": 0, "lt": 180}}}}}},
    {{"always": {{"cam.InSync": true, "cam.Deviation": 0}}, "while": {{"M.Position": {{"gt": 2, "lt": 178}}}}}}
  ]
}}
"#,
        axis(limits, "")
    )
}

/// At 0.999 of MaxMasterVelocity the slave is in sync all the time and keeps its limits. At 1.03 it is not in sync,
/// but still keeps its limits.
#[test]
fn just_below_the_highest_velocity_a_law_is_kept_and_above_it_the_slave_lags() {
    let place = scratch("cam_laws");
    for this in &LAWS {
        let ended = law(this.name, &["--lift", "100", "--width", "180"]);
        write(&place, "law.csv", &ended.out);
        for (by, mut limits) in [
            (
                "velocity",
                r#"{"velocity": 400, "acceleration": 50000, "jerk": 5e6}"#.to_owned(),
            ),
            (
                "acceleration",
                r#"{"velocity": 4000, "acceleration": 1500, "jerk": 5e6}"#.to_owned(),
            ),
            (
                "jerk",
                r#"{"velocity": 4000, "acceleration": 50000, "jerk": 30000}"#.to_owned(),
            ),
            (
                "snap",
                r#"{"velocity": 4000, "acceleration": 50000, "jerk": 5e6, "snap": 1e6}"#.to_owned(),
            ),
        ] {
            // The jerk of all others steps at their ends, which a slave with a snap limit can't follow.
            if by == "snap" && this.name != "poly4567" {
                continue;
            }
            if by != "snap" && this.name == "poly4567" {
                limits = limits.replace('}', ", \"snap\": 1e12}");
            }
            write(&place, "law.scan.json", &script(&limits));
            let ended = typed(&place, "cam check law.csv --axis law.scan.json#S --json");
            assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{} {by}", this.name);
            let found: Value = serde_json::from_str(&ended.out).unwrap();
            let highest = found["max_master_velocity"].as_f64().unwrap();
            let stretches = found["stretches"].as_array().unwrap();
            let slowest = stretches
                .iter()
                .min_by(|one, other| {
                    let speed = |it: &Value| it["max_master_velocity"].as_f64().unwrap();
                    speed(one).total_cmp(&speed(other))
                })
                .unwrap();
            assert_eq!(slowest["worst"]["by"], by, "{}", this.name);
            let run = |share: f64| {
                let v = format!("v={:?}", share * highest);
                standstill(&place, &["run", "--quiet", "law.scan.json", "--set", &v])
            };
            let below = run(0.999);
            assert_eq!(below.status, 0, "{} {by} {highest}: {}", this.name, below.out);
            let above = run(1.03);
            assert_eq!(above.status, 1, "{} {by} {highest}: {}", this.name, above.out);
            let failed: Vec<&str> = above
                .out
                .lines()
                .filter(|line| line.starts_with("  expect["))
                .collect();
            assert!(
                !failed.is_empty()
                    && failed
                        .iter()
                        .all(|line| line.contains("cam.InSync") || line.contains("cam.Deviation")),
                "{} {by}: {}",
                this.name,
                above.out
            );
        }
    }
}

const MACHINE: &str = r#"{
  "standstill": 1,
  "axes": {
    "M": {"limits": {"velocity": 200, "acceleration": 1000}},
    "S": {"limits": {"velocity": 400, "acceleration": 5000, "jerk": 100000, "snap": 5000000},
          "software_limits": {"min": -1, "max": 120}},
    "J": {"limits": {"velocity": 400, "acceleration": 5000, "jerk": 100000}},
    "A": {"limits": {"velocity": 100, "acceleration": 5000}, "coupling": {"on_limit": "error"}}
  }
}
"#;

const UP_AND_BACK: &str = "Master,Slave,Law\n0,0,mcCamRest7\n180,100,mcCamRest7\n360,0,0\n";

fn checked(place: &Path, more: &[&str]) -> Ended {
    let mut arguments = vec!["cam", "check", "knife.csv"];
    arguments.extend(more);
    standstill(place, &arguments)
}

#[test]
fn a_good_cam_is_told_as_text_and_as_an_outcome() {
    let place = scratch("cam_good");
    write(&place, "cell.machine.json", MACHINE);
    write(&place, "knife.csv", UP_AND_BACK);
    let axes = [
        "--axis",
        "cell.machine.json#S",
        "--master",
        "cell.machine.json#m",
        "--periodic",
    ];
    let ended = checked(&place, &axes);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""), "{}", ended.out);
    insta::assert_snapshot!("cam_check", ended.out);
    let ended = checked(&place, &[&axes[..], &["--json"]].concat());
    let found = ended.answer();
    // Multi-axis example: 100 over 180 with these limits.
    let highest = found["max_master_velocity"].as_f64().unwrap();
    assert!((0.99 * 329.143..=329.143).contains(&highest), "{highest}");
    assert_eq!(found["master"]["fast_enough"], true);
    assert_eq!(found["software_limits"]["inside"], true);
    assert_eq!(found["stretches"][1]["worst"]["at"], 270.0);
    // The same from standard input.
    let file = place.join("cell.machine.json");
    let axis = format!("{}#S", file.display());
    let ended = fed(
        &["cam", "check", "-", "--axis", &axis, "--periodic"],
        UP_AND_BACK.as_bytes(),
    );
    assert_eq!(ended.status, 0, "{}", ended.err);
}

#[test]
fn what_a_slave_cannot_follow_is_status_1_with_place_value_limit_and_remedy() {
    let place = scratch("cam_findings");
    write(&place, "cell.machine.json", MACHINE);
    for (rows, more, error, parts) in [
        (
            "# a corner\nMaster,Slave,Law\n0,0,3\n90,50,3\n180,0,3\n",
            &["--axis", "cell.machine.json#S", "--periodic"][..],
            Some(154),
            &[
                "knife.csv:4: row 2",
                "`Slope` jumps by 1.11",
                "snap limit",
                "needed 3",
                "mcCamThrough",
            ][..],
        ),
        (
            "Master,Slave,Law\n0,0,3\n90,50,3\n180,0,3\n",
            &["--axis", "cell.machine.json#J", "--periodic"],
            Some(154),
            &["knife.csv:3: row 2", "jerk limit", "needed 2"],
        ),
        (
            "Master,Slave,Law\n0,0,3\n90,50,3\n",
            &["--axis", "cell.machine.json#J"],
            Some(154),
            &["knife.csv:2: row 1", "--periodic"],
        ),
        (
            "Master,Slave,Law\n0,0,5\n90,50,5\n",
            &["--axis", "cell.machine.json#S"],
            Some(154),
            &["`Third` jumps by", "continuity 2, needed 3"],
        ),
        (
            "Master,Slave,Law\n0,0,4\n90,130,4\n",
            &["--axis", "cell.machine.json#S"],
            Some(117),
            &["130.0", "upper software limit 120.0 of S", "--relative"],
        ),
        (
            "Master,Slave,Law\n0,0,4\n90,130,4\n",
            &["--axis", "cell.machine.json#J", "--master", "cell.machine.json#M"],
            None,
            &["M may go 200.0", "J follows up to 126.5"],
        ),
        (
            "Master,Slave,Law\n0,0,4\n90,130,4\n",
            &["--axis", "cell.machine.json#A", "--master", "cell.machine.json#M"],
            Some(220),
            &["M may go 200.0", "raise the limits of A"],
        ),
    ] {
        write(&place, "knife.csv", rows);
        let ended = checked(&place, more);
        assert_eq!((ended.status, ended.err.as_str()), (1, ""), "{}", ended.out);
        ended.prints_last("failed\n");
        for part in parts {
            ended.prints(part);
        }
        let ended = checked(&place, &[more, &["--json"]].concat());
        let found = ended.answer();
        assert_eq!(ended.status, 1);
        assert_eq!(found["error_id"].as_u64(), error);
        assert_eq!(found["findings"][0]["error_id"].as_u64(), error);
        for key in ["value", "limit", "remedy"] {
            assert!(!found["findings"][0][key].is_null(), "{key}: {}", ended.out);
        }
    }
    // The same cam at the position of the slave, and for a slave without a jerk limit.
    write(&place, "knife.csv", "0,0\n90,130\n");
    assert_eq!(
        checked(&place, &["--axis", "cell.machine.json#S", "--relative"]).status,
        0
    );
}

/// Tables that are no cam, with the message and its remedy.
const BAD: [(&[u8], &str, &str); 5] = [
    (
        b"Master\n0\n1\n",
        "knife.csv:1:1: the column `Slave` is missing",
        "name it",
    ),
    (
        b"Master;Slave\n0;0\n90;1,5\n",
        "knife.csv:3:4: `1,5` is no number for `Slave` (LREAL)",
        "write a decimal point, 1.5 for 1,5",
    ),
    (
        b"Master,Slave\n0,0\n90,\xFC\n",
        "knife.csv:3:4: the byte 16#FC is no UTF-8",
        "save the file as UTF-8",
    ),
    (
        b"Master,Slave\n0,0\n90,1\n80,2\n",
        "knife.csv:4:1: `Master` (column 1) is 80.0 after 90.0 in the row before",
        "places of the master rise",
    ),
    (
        b"Master,Slave\n0,0\n",
        "knife.csv:2:1: 1 row is no cam",
        "give 2 rows at least",
    ),
];

#[test]
fn what_cannot_be_read_is_status_3_with_line_column_and_remedy() {
    let place = scratch("cam_bad");
    write(&place, "cell.machine.json", MACHINE);
    let long: String = (0..600).map(|row| format!("{row},0\n")).collect();
    let more: [(&[u8], &str, &str); 4] = [
        (
            b"Master,Slave\n0,0\n90,1,5\n",
            "knife.csv:3:1: 3 columns where there are 2",
            "if these are decimal commas",
        ),
        (
            b"Master,Slave\n0,0\n90,NaN\n",
            "knife.csv:3:4: `NaN` is no number for `Slave` (LREAL)",
            "write a finite number",
        ),
        (
            long.as_bytes(),
            "knife.csv:513:1: more than 512 rows, which are the most",
            "leave rows out",
        ),
        (
            b"Master,Slave,Law\n0,0,7\n1,1,0\n",
            "knife.csv:2: row 1: `Law` is 7, and laws have numbers from 0 to 5",
            "it is one of mcCamThrough",
        ),
    ];
    for (bytes, expected, remedy) in BAD.into_iter().chain(more) {
        std::fs::write(place.join("knife.csv"), bytes).unwrap();
        let ended = checked(&place, &["--axis", "cell.machine.json#S"]);
        assert_eq!((ended.status, ended.out.as_str()), (3, ""), "{}", ended.err);
        ended.complains(&format!("{expected}\nhelp: {remedy}"));
        let ended = standstill(&place, &["cam", "plot", "knife.csv", "--svg", "knife.svg"]);
        assert_eq!(ended.status, 3);
        assert!(!place.join("knife.svg").exists());
    }
    write(&place, "knife.csv", UP_AND_BACK);
    for (more, status, expected) in [
        (
            &["--axis", "cell.machine.json#Q"][..],
            3,
            "there is no axis `Q`\nhelp: the axes are M, S, J, A",
        ),
        (&["--axis", "cell.machine.json"], 2, "such as cell.machine.json#S"),
        (&["--axis", "none.machine.json#S"], 4, "none.machine.json"),
        (&[], 2, "--axis"),
    ] {
        let ended = checked(&place, more);
        assert_eq!(ended.status, status, "{}", ended.err);
        ended.complains(expected);
    }
    for (lift, width, expected) in [
        ("0", "1", "--lift is 0.0"),
        ("nan", "1", "--lift is NaN"),
        ("1", "-5", "--width is -5.0"),
        ("1", "1e-200", "write a larger width"),
    ] {
        let ended = law("sinoid", &["--lift", lift, "--width", width]);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{lift} {width}");
        ended.complains(expected);
    }
}

#[test]
fn a_table_of_a_script_is_named_where_there_are_several() {
    let place = scratch("cam_of_script");
    let table = |lift: f64| {
        format!(
            "{{\"type\": \"MC_CAM_POINT\", \"rows\": [{{\"Master\": 0, \"Law\": \"mcCamRest7\"}}, {{\"Master\": 90, \"Slave\": {lift:?}}}]}}"
        )
    };
    let script = |tables: &str| {
        format!(
            "{{\"standstill\": 1, \"cycle\": \"T#1ms\", \"scans\": 1, \"axes\": {{\"S\": {{\"limits\": {{\"velocity\": 1, \"acceleration\": 1}}}}}}, \"tables\": {{{tables}}}, \"blocks\": []}}"
        )
    };
    let both = format!("\"up\": {}, \"down\": {}", table(5.0), table(-5.0));
    write(&place, "two.scan.json", &script(&both));
    let check = |file: &str| standstill(&place, &["cam", "check", file, "--axis", "two.scan.json#S"]);
    let ended = check("two.scan.json#down");
    assert_eq!(ended.status, 0, "{}", ended.err);
    ended.prints_first("two.scan.json#down on S\n");
    ended.prints("-5 to 0");
    for (file, expected) in [
        (
            "two.scan.json",
            "2 tables of cams: down, up\nhelp: name one of them, such as two.scan.json#down",
        ),
        (
            "two.scan.json#dwn",
            "there is no table `dwn` of a cam\nhelp: did you mean",
        ),
    ] {
        let ended = check(file);
        assert_eq!(ended.status, 3);
        ended.complains(expected);
    }
    let falling = table(5.0).replace("90", "-90");
    write(&place, "two.scan.json", &script(&format!("\"up\": {falling}")));
    let ended = check("two.scan.json");
    assert_eq!(ended.status, 3);
    ended.complains("two.scan.json#up: row 2: `Master` is -90.0 after 0.0 in the row before\nhelp:");
}

/// Covers: G80
#[test]
fn a_bad_file_of_a_script_is_told_with_its_own_line_and_column_and_nothing_runs() {
    let place = scratch("cam_file_of_script");
    let script = "{\"standstill\": 1, \"cycle\": \"T#1ms\", \"scans\": 1, \"axes\": {\"S\": {\"limits\": {\"velocity\": 1, \"acceleration\": 1}}},\n\
        \"tables\": {\"knife\": {\"type\": \"MC_CAM_POINT\", \"csv\": \"knife.csv\"}}, \"blocks\": []}\n";
    write(&place, "knife.scan.json", script);
    let hostile: (&[u8], &str, &str) = (
        b"Master,Slave\n0,0\n90,\x1b[31m\n",
        "knife.csv:3:4: `\\u{1b}[31m` is no number for `Slave` (LREAL)",
        "write a finite number",
    );
    for (bytes, expected, remedy) in BAD.into_iter().chain([hostile]) {
        std::fs::write(place.join("knife.csv"), bytes).unwrap();
        let ended = standstill(&place, &["run", "knife.scan.json", "--trace", "out.csv"]);
        assert_eq!((ended.status, ended.out.as_str()), (3, ""), "{}", ended.err);
        ended.complains(expected);
        ended.complains("knife.scan.json:2:");
        ended.complains(remedy);
        assert!(!ended.err.contains('\x1b'), "{}", ended.err);
        assert!(!place.join("out.csv").exists());
    }
}

/// Covers: G71
#[test]
fn a_slave_that_takes_corners_is_told_where_it_rests() {
    let place = scratch("cam_corners");
    let machine = |continuity: &str| {
        format!(
            "{{\"standstill\": 1, \"axes\": {{\"S\": {{\"limits\": {{\"velocity\": 400, \"acceleration\": 5000, \"jerk\": 100000}}{continuity}}},\n\
             \"T\": {{\"limits\": {{\"velocity\": 400, \"acceleration\": 5000}}}}}}}}\n"
        )
    };
    write(
        &place,
        "knife.csv",
        "Master,Slave,Law\n0,0,3\n90,50,3\n180,100,3\n270,0,4\n360,0,4\n",
    );
    let check = |continuity: &str, more: &[&str]| {
        write(&place, "cell.machine.json", &machine(continuity));
        let asked = ["cam", "check", "knife.csv", "--axis"];
        standstill(&place, &[&asked[..], more].concat())
    };
    let takes = ", \"coupling\": {\"cam_continuity\": 0}";
    // At row 2 the straight lines continue as one.
    let ended = check(takes, &["cell.machine.json#S", "--periodic"]);
    assert_eq!(ended.status, 0, "{}", ended.err);
    ended.prints("  continuity         0, S needs 0\n");
    ended.prints("  rests at           rows 1, 3, 4\n");
    let ended = check(takes, &["cell.machine.json#S", "--periodic", "--json"]);
    let found = ended.answer();
    assert_eq!(found["stops_at"], serde_json::json!([1, 3, 4]));
    assert_eq!(found["continuity"]["needed"], 0);
    for (continuity, more, part) in [
        ("", "cell.machine.json#S", "S has a jerk limit"),
        (
            ", \"coupling\": {\"cam_continuity\": 1}",
            "cell.machine.json#S",
            "S has a cam_continuity",
        ),
        (
            "",
            "cell.machine.json#T",
            "corners would take T an endless acceleration",
        ),
    ] {
        let ended = check(continuity, &[more, "--periodic"]);
        assert_eq!(ended.status, 1, "{}", ended.out);
        assert!(
            ended.out.contains("error 154 CamNotSmooth") && ended.out.contains(part),
            "{}",
            ended.out
        );
        assert!(!ended.out.contains("rests at"), "{}", ended.out);
    }
    // Without a jerk limit a slope at the ends is permitted.
    write(&place, "knife.csv", "Master,Slave,Law\n0,0,3\n90,50,3\n");
    let ended = check("", &["cell.machine.json#T"]);
    assert_eq!(ended.status, 0, "{}", ended.out);
    ended.prints("  continuity         3, T needs 1\n  MaxMasterVelocity");
    ended.prints("  rests at           rows 1, 2\n");
}

#[test]
fn a_picture_has_a_panel_for_each_derivative() {
    let place = scratch("cam_plot");
    write(&place, "knife.csv", UP_AND_BACK);
    let ended = typed(&place, "cam plot knife.csv --svg knife.svg --periodic");
    assert_eq!(
        (ended.status, ended.out.as_str(), ended.err.as_str()),
        (0, "", "")
    );
    let picture = read(&place, "knife.svg");
    let document = roxmltree::Document::parse(&picture).unwrap();
    let texts: Vec<&str> = document.descendants().filter_map(|node| node.text()).collect();
    for title in ["Slave", "Slope", "Curvature", "Third", "Fourth", "master (u)"] {
        assert!(texts.contains(&title), "{title}");
    }
    assert_eq!(picture.matches("class=\"mark\"").count(), 3);
    let ended = standstill(&place, &["cam", "plot", "knife.csv", "--svg", "no/knife.svg"]);
    assert_eq!(ended.status, 4);
}
