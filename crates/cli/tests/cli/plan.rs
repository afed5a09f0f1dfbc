//! Lines in, lines out.

use crate::support::{Ended, command, ended, fed, read, scratch, write};
use serde_json::Value;
use std::io::{BufRead, BufReader, Write};
use std::process::Stdio;

/// The answers to these lines.
fn answers(lines: &str) -> Vec<Value> {
    let ended = fed(&["plan"], lines.as_bytes());
    ended
        .out
        .lines()
        .map(|line| serde_json::from_str(line).expect("JSON"))
        .collect()
}

#[test]
fn lines_are_answered_letter_by_letter_as_before() {
    insta::assert_snapshot!(asked_and_answered(include_str!("plan.jsonl")));
}

#[test]
fn the_papers_methods_answer_letter_by_letter_as_before() {
    insta::assert_snapshot!(asked_and_answered(include_str!("papers.jsonl")));
}

/// Each line and its answer; at least one of them is refused.
fn asked_and_answered(lines: &str) -> String {
    let ended = fed(&["plan"], lines.as_bytes());
    let asked: Vec<_> = lines.lines().filter(|line| !line.trim().is_empty()).collect();
    let answered: Vec<_> = ended.out.lines().collect();
    assert_eq!(asked.len(), answered.len());
    let pairs = asked.iter().zip(answered);
    let text = pairs
        .map(|(asked, answered)| format!("> {asked}\n{answered}\n\n"))
        .collect();
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    text
}

#[test]
fn reference_moves_are_planned_as_computed_elsewhere() {
    let vectors = include_str!("../../../planner/tests/data/planner4-basic.json");
    let vectors: Value = serde_json::from_str(vectors).expect("JSON");
    let vectors = vectors["vectors"].as_array().expect("a list");
    for (method, expected) in [
        ("sequential", "seq"),
        ("grid", "opt"),
        ("overlapped", "ext_overlap"),
    ] {
        let line = |vector: &Value| {
            let given = &vector["in"];
            let target = given["target"].as_f64().map_or(given["dx"].clone(), Value::from);
            let target = if given["target"].is_null() && given["x0"] != 0.0 {
                Value::from(given["x0"].as_f64().unwrap() + given["dx"].as_f64().unwrap())
            } else {
                target
            };
            let limits = serde_json::json!({
                "velocity": given["v"], "acceleration": given["a"], "jerk": given["j"], "snap": given["s"],
            });
            serde_json::json!({
                "id": vector["id"], "Ts": given["ts"], "position": given["x0"], "target": target,
                "limits": limits, "method": method,
            })
            .to_string()
        };
        let lines: Vec<_> = vectors.iter().map(line).collect();
        let answers = answers(&lines.join("\n"));
        assert_eq!(answers.len(), vectors.len());
        for (answer, vector) in answers.iter().zip(vectors) {
            assert_eq!(answer["id"], vector["id"]);
            assert_eq!(answer["error"]["code"], vector["error"], "{answer}");
            let boxes = answer["boxes"].as_array().into_iter().flatten();
            let scans: u64 = boxes.filter_map(Value::as_u64).sum();
            if vector["error"].is_null() {
                assert_eq!(answer["scans"], scans, "{answer}");
                assert_eq!(answer["counts"].is_null(), method == "overlapped");
            }
            if let Some(count) = vector[expected]["N"].as_u64() {
                assert_eq!(answer["scans"], count, "{answer}");
            }
        }
    }
}

#[test]
fn published_cases_are_planned_as_computed_elsewhere() {
    let vectors = include_str!("../../../planner/tests/data/planner3-published.json");
    let vectors: Value = serde_json::from_str(vectors).expect("JSON");
    let mut seen = 0;
    for case in vectors["cases"].as_array().expect("a list") {
        let (input, expected) = (&case["input"], &case["expected"]);
        let limits = serde_json::json!({
            "velocity": input.get("V").or(input.get("v_cf")),
            "acceleration": input["A"],
            "jerk": input["J"],
        });
        let line = match case["algorithm"].as_str().expect("a name") {
            "blejan" | "zhang_static" => serde_json::json!({
                "target": input.get("s").or(input.get("d")), "limits": limits, "method": "s-curve",
            }),
            "garcia" => serde_json::json!({
                "target": input["theta"], "duration": input["T"], "gamma": input["gamma"],
                "phi": input["phi"], "method": "timed",
            }),
            "bui" => serde_json::json!({
                "target": input["s"], "velocity": input["v_s"], "end_velocity": input["v_e"],
                "policy": input["policy"], "limits": limits, "method": "short-path",
            }),
            "general" => serde_json::json!({
                "target": input["target"], "velocity": input["start"][1], "acceleration": input["start"][2],
                "end_velocity": input["v_f"], "limits": limits, "method": "online",
            }),
            "zhang_moving" => serde_json::json!({
                "targets": input["retarget"], "limits": limits, "method": "tracking",
            }),
            _ => continue,
        };
        seen += 1;
        let mut line = line;
        // Whole seconds, because the targets move on them.
        line["Ts"] = Value::from(1.0);
        let answer = &answers(&line.to_string())[0];
        let duration = expected
            .pointer("/profile/T")
            .or(expected.get("end_time"))
            .and_then(Value::as_f64)
            .expect("a duration");
        let ours = answer["duration"].as_f64().unwrap_or_else(|| panic!("{answer}"));
        assert!((ours - duration).abs() <= 1e-9 * duration, "{answer}");
        assert_eq!(
            answer["scans"],
            (duration * (1.0 - 1e-9)).ceil() as u64,
            "{answer}"
        );
        let parts = answer["segments"].as_array().expect("a list").iter();
        let sum: f64 = parts
            .map(|part| part["duration"].as_f64().expect("a number"))
            .sum();
        assert!((sum - duration).abs() <= 1e-9 * duration, "{answer}");
        let case_is = |name: &Value| *name == answer["case"];
        let any = expected["case_any_of"].as_array();
        let named = any.is_none_or(|names| names.iter().any(case_is));
        assert!(named && expected.get("type").is_none_or(case_is), "{answer}");
        if let Some(reached) = expected["v_e_reached"].as_f64() {
            let ours = answer["end_velocity"].as_f64().expect("a number");
            assert!((ours - reached).abs() <= 1e-10 * reached, "{answer}");
            assert_eq!(answer["end"]["velocity"], answer["end_velocity"]);
        }
    }
    assert_eq!(seen, 52);
}

#[test]
fn segments_lead_from_the_start_to_the_target() {
    let line =
        r#"{"Ts":0.001,"target":0.35,"limits":{"velocity":1.2,"acceleration":15,"jerk":400,"snap":21000}}"#;
    let answers = answers(line);
    let number = |value: &Value| value.as_f64().expect("a number");
    let mut state = [0.0; 4];
    for segment in answers[0]["segments"].as_array().expect("a list") {
        let [t, v, a, j, s] =
            ["duration", "velocity", "acceleration", "jerk", "snap"].map(|key| number(&segment[key]));
        for (at, stated) in state[1..].iter().zip([v, a, j]) {
            assert!((at - stated).abs() <= 1e-9 * (1.0 + stated.abs()), "{segment}");
        }
        state = [
            state[0] + t * (v + t / 2.0 * (a + t / 3.0 * (j + t / 4.0 * s))),
            v + t * (a + t / 2.0 * (j + t / 3.0 * s)),
            a + t * (j + t / 2.0 * s),
            j + t * s,
        ];
    }
    assert!(
        (state[0] - 0.35).abs() < 1e-12 && state[1..].iter().all(|rest| rest.abs() < 1e-9),
        "{state:?}"
    );
    assert_eq!(answers[0]["end"]["position"], 0.35);
}

#[test]
fn the_nearest_limit_can_be_planned_and_a_lower_one_cannot() {
    for limit in ["velocity", "acceleration"] {
        let line = |value: f64| {
            let other = if limit == "velocity" { "jerk" } else { "velocity" };
            format!(
                r#"{{"Ts":0.001,"target":1e9,"limits":{{"{limit}":{value:?},"{other}":1e5}},"method":"grid"}}"#
            )
        };
        let refused = &answers(&line(1e-9))[0]["error"];
        assert_eq!(refused["code"], "too_long");
        assert_eq!(refused["field"], format!("limits.{limit}"));
        let nearest = refused["nearest"].as_f64().expect("a number");
        let below = f64::from_bits(nearest.to_bits() - 1);
        let answers = answers(&[line(nearest), line(below)].join("\n"));
        assert!(
            answers[0]["scans"].as_u64() <= Some(i32::MAX as u64),
            "{}",
            answers[0]
        );
        assert_eq!(answers[1]["error"]["code"], "too_long");
    }
}

#[test]
fn an_answer_comes_before_the_next_question() {
    let mut child = command(&["plan", "-"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .spawn()
        .unwrap();
    let mut ask = child.stdin.take().unwrap();
    let mut answers = BufReader::new(child.stdout.take().unwrap()).lines();
    for id in 0..3 {
        writeln!(
            ask,
            r#"{{"id":{id},"Ts":0.01,"target":1,"limits":{{"velocity":1,"acceleration":9}}}}"#
        )
        .unwrap();
        let answer = answers.next().unwrap().unwrap();
        assert!(
            answer.starts_with(&format!(r#"{{"id":{id},"method":"overlapped","duration":"#)),
            "{answer}"
        );
    }
    drop(ask);
    assert_eq!(child.wait().unwrap().code(), Some(0));
}

#[test]
fn files_may_have_a_byte_order_mark_and_windows_line_ends() {
    let folder = scratch("plan_file");
    let line = r#"{"id":"a","Ts":0.01,"target":1,"limits":{"velocity":1,"acceleration":9}}"#;
    write(&folder, "lines.jsonl", &format!("\u{feff}{line}\r\n\r\n{line}"));
    let ended = ended(command(&["plan", "lines.jsonl"]).current_dir(&folder));
    assert_eq!((ended.status, ended.out.lines().count()), (0, 2));
}

#[test]
fn a_line_that_is_no_text_is_refused_and_the_next_one_is_read() {
    let lines = b"\xff\n{\"Ts\":0.01,\"target\":1,\"limits\":{\"velocity\":1}}\n";
    let ended = fed(&["plan"], lines);
    let answers: Vec<_> = ended.out.lines().collect();
    assert!(answers[0].starts_with(r#"{"id":null,"error":{"code":"invalid_input","field":null,"#));
    assert!(answers[1].contains("\"scans\":"));
}

/// A new target in the middle of an unavoidable turn makes the turn longer. This excess is reported, too.
#[test]
fn tracking_tells_the_excess_of_every_plan() {
    let line = |targets: &str| {
        format!(
            r#"{{"Ts": 0.01, "velocity": -1.1551677055369458, "acceleration": -26.53497147984475, "targets": {targets}, "limits": {{"velocity": 5, "acceleration": 20, "deceleration": 100, "jerk": 400, "snap": 800}}, "method": "tracking"}}
"#
        )
    };
    let first = "[0, -1.9500978770341924]";
    let lines = line(&format!("[{first}]")) + &line(&format!("[{first}, [0.18, 2.986943640183675]]"));
    let excess = answers(&lines)
        .iter()
        .map(|answer| answer["unavoidable"]["velocity"].as_f64())
        .collect::<Vec<_>>();
    let [Some(one), Some(both)] = excess[..] else {
        panic!("{excess:?}");
    };
    assert!(both > one + 1e-3, "{one} {both}");
}

/// A line of order 3 with this id and sample time.
fn line(id: &str, cycle: &str) -> String {
    format!(
        r#"{{"id": "{id}", "Ts": {cycle}, "target": 0.02, "limits": {{"velocity": 1, "acceleration": 20, "jerk": 2000}}}}"#
    )
}

#[test]
fn plans_are_drawn_over_each_other() {
    let folder = scratch("plan_drawn");
    let path = |name: &str| folder.join(name).to_string_lossy().into_owned();
    let [svg, html, csv] = ["x.svg", "x.html", "x.csv"].map(path);
    let lines = [
        line("<b>one</b>", "0.001"),
        "no JSON".to_owned(),
        line("two", "0.001"),
    ]
    .join("\n");
    let drawn = fed(
        &["plan", "--svg", &svg, "--report", &html, "--samples", &csv],
        lines.as_bytes(),
    );
    // A refused line is answered as usual, and not drawn.
    assert_eq!(
        (drawn.status, drawn.out.lines().count(), drawn.err.as_str()),
        (1, 3, "")
    );
    assert_eq!(drawn.out, fed(&["plan"], lines.as_bytes()).out);
    let picture = read(&folder, "x.svg");
    assert!(
        picture.contains(">&lt;b&gt;one&lt;/b&gt;: overlapped, 75 scans, 0.0750 s<"),
        "{picture}"
    );
    assert!(
        picture.contains("class=\"p1\"") && !picture.contains("class=\"p2\""),
        "{picture}"
    );
    let page = read(&folder, "x.html");
    assert!(
        page.starts_with("<!doctype html>") && page.contains("two: overlapped, 75 scans"),
        "{page:.300}"
    );
    assert!(!page.contains("<b>one</b>"));
    // A seventh has no colour.
    let seven: Vec<_> = (0..7).map(|at| line(&at.to_string(), "0.001")).collect();
    let drawn = fed(&["plan", "--svg", &svg], seven.join("\n").as_bytes());
    assert_eq!((drawn.status, drawn.out.lines().count()), (0, 7));
    drawn.complains("note: of 7 plans the first 6 are drawn");
    // Nothing at all is a picture, too.
    assert_eq!(fed(&["plan", "--svg", &svg], b"").status, 0);
    assert!(read(&folder, "x.svg").ends_with("</svg>\n"));
}

#[test]
fn what_makes_no_page_of_plans_is_told() {
    let folder = scratch("plan_no_page");
    let html = folder.join("x.html").to_string_lossy().into_owned();
    let page = |lines: &[String]| fed(&["plan", "--report", &html], lines.join("\n").as_bytes());
    let told = |ended: Ended, status: i32, why: &str| {
        assert!(ended.status == status && ended.err.contains(why), "{ended:?}");
    };
    told(page(&[]), 2, "no line was planned");
    told(page(&["no JSON".to_owned()]), 2, "no line was planned");
    told(
        page(&[line("a", "0.0010000000005")]),
        2,
        "scans of whole nanoseconds",
    );
    told(page(&[line("a", "1e-10")]), 2, "scans of whole nanoseconds");
    told(page(&[line("a", "0.001"), line("b", "0.002")]), 3, "cycle");
    let long = r#"{"Ts": 0.001, "target": 1e6, "limits": {"velocity": 1, "acceleration": 1, "jerk": 1}}"#;
    told(
        page(&[long.to_owned()]),
        2,
        "more than the 1000000 of a page; `--svg` draws it",
    );
    assert!(!folder.join("x.html").exists(), "nothing was written");
    let svg = folder.join("x.svg").to_string_lossy().into_owned();
    assert_eq!(fed(&["plan", "--svg", &svg], long.as_bytes()).status, 0);
    let nowhere = folder.join("no/folder/x.svg").to_string_lossy().into_owned();
    told(
        fed(&["plan", "--svg", &nowhere], line("a", "0.001").as_bytes()),
        4,
        "x.svg",
    );
}
