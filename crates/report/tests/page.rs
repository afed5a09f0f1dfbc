//! The page is one file that loads nothing, escapes all texts, and has every bit of its traces.

use base64::Engine;
use base64::engine::general_purpose::STANDARD;
use serde_json::Value;
use sha2::{Digest, Sha256};
use standstill_report::{Mark, ReportError, Source, TRACES_MAX, check, html, html_marked};
use standstill_trace::{
    Axis, CAMS_MAX, Cam, Cell, Claim, ClaimFailure, ClaimVerdict, Header, Input, Note, Trace, digest, exact,
};

/// Text that would be markup, the end of a script or a reference if it were not escaped.
const NASTY: &str = "<img src=x onerror=\"alert(1)\"></title></script><!-- &amp; '{script}' \u{2028}";

fn trace(text: &str, cycle_ns: u64, scans: usize) -> Trace {
    let mut trace = Trace::new(Header {
        title: text.into(),
        script_hash: text.into(),
        covers: vec![text.into()],
        cycle_ns,
        axes: vec![Axis {
            name: "X".into(),
            unit: text.into(),
            ..Axis::default()
        }],
        inputs: vec![Input {
            name: "mode".into(),
            iec_type: "COLOUR".into(),
        }],
        claims: vec![Claim {
            path: "expect[0]".into(),
            text: text.into(),
            verdict: ClaimVerdict::Failed,
            scans: Some([0, 2]),
            held: None,
            failures: vec![ClaimFailure {
                scan: Some(1),
                text: text.into(),
            }],
        }],
        ..Header::default()
    });
    for scan in 0..scans {
        let place = scan as f64 / 3.0;
        let mut row = vec![Cell::Name("Standstill")];
        row.extend([place, 1.0, 0.0, 0.0, f64::NAN, place].map(Cell::Real));
        row.push(Cell::Name("red"));
        trace.push_row(&row).expect("a row of the header");
    }
    trace.push_note(Note {
        scan: 1,
        subject: "X".into(),
        text: text.into(),
    });
    trace
}

fn source<'a>(name: &'a str, trace: &'a Trace) -> Source<'a> {
    Source {
        name,
        trace,
        lacks: &[],
    }
}

/// The texts of the elements that begin with `open`.
fn scripts<'a>(page: &'a str, open: &str) -> Vec<&'a str> {
    page.split(open)
        .skip(1)
        .map(|rest| rest.split("</script>").next().unwrap())
        .collect()
}

#[test]
fn texts_stay_texts() {
    let (plain, nasty) = (trace("plain", 1_000_000, 5), trace(NASTY, 1_000_000, 5));
    let expected = html(&[source("plain", &plain)]).unwrap();
    let page = html(&[source(NASTY, &nasty)]).unwrap();
    for mark in [
        "<script",
        "</script>",
        "<img",
        "<!--",
        "<title>",
        "</title>",
        "{script}",
    ] {
        let inside = |page: &str| page.matches(mark).count();
        // The name of a place is no markup, so it may stand in a text.
        let named = if mark == "{script}" { inside(&page) } else { 0 };
        assert_eq!(inside(&page), inside(&expected) + named, "{mark}");
    }
    assert!(page.contains("<h1>&lt;img src=x onerror=&quot;alert(1)&quot;&gt;&lt;/title&gt;"));
    let about: Value = serde_json::from_str(scripts(&page, "id=\"about\">")[0]).unwrap();
    let told = &about["traces"][0];
    assert_eq!(told["name"], NASTY);
    // A text of a trace is one line, so a line separator is shown in escaped form.
    let shown = NASTY.replace('\u{2028}', "\\u{2028}");
    assert_eq!(told["header"]["claims"][0]["failures"][0]["text"], shown);
    assert!(
        told["events"]
            .as_array()
            .unwrap()
            .iter()
            .any(|event| event[2] == shown)
    );
}

#[test]
fn the_policy_allows_the_one_script_and_the_one_style() {
    let trace = trace("plain", 1_000_000, 5);
    let page = html(&[source("a", &trace)]).unwrap();
    let hash = |text: &str| format!("'sha256-{}'", STANDARD.encode(Sha256::digest(text.as_bytes())));
    let policy = page.split("Content-Security-Policy\" content=\"").nth(1).unwrap();
    let policy = policy.split('"').next().unwrap();
    let script = scripts(&page, "<script>");
    let style = page
        .split("<style>")
        .nth(1)
        .unwrap()
        .split("</style>")
        .next()
        .unwrap();
    let expected = format!(
        "default-src 'none'; style-src {}; script-src {}; img-src data:",
        hash(style),
        hash(script[0])
    );
    assert_eq!((policy, script.len()), (expected.as_str(), 1));
    for outside in [" src=", " href=", "@import", "url(", "<link", "<iframe"] {
        assert!(!page.contains(outside), "{outside}");
    }
    assert!(page.contains("The MIT License (MIT)") && page.contains("Copyright (c) 2022 Leon Sorokin"));
}

#[test]
fn every_bit_of_the_rows_is_there() {
    let traces = [trace("one", 1_000_000, 50), trace("other", 1_000_000, 30)];
    let page = html(&[source("a.csv", &traces[0]), source("b.csv", &traces[1])]).unwrap();
    let rows = scripts(&page, "class=\"rows\">");
    assert_eq!(rows.len(), 2);
    for (rows, trace) in rows.iter().zip(&traces) {
        let decoded = exact::decode(&STANDARD.decode(rows.trim()).unwrap()).unwrap();
        assert_eq!(digest::whole(&decoded), digest::whole(trace));
    }
    assert!(page.contains("different lengths"));
    assert!(page.contains("<b>B</b>b.csv: 30 scans, 0.03 s"));
}

#[test]
fn the_same_traces_give_the_same_page() {
    let trace = trace("plain", 250_000, 50);
    let page = || html(&[source("a", &trace)]);
    assert_eq!(page(), page());
}

#[test]
fn what_cannot_be_shown_is_refused() {
    let (good, slow, empty) = (
        trace("a", 1_000_000, 5),
        trace("a", 2_000_000, 5),
        trace("a", 1_000_000, 0),
    );
    assert_eq!(check(&[]), Err(ReportError::Count(0)));
    let many = [source("a", &good); TRACES_MAX + 1];
    assert_eq!(check(&many), Err(ReportError::Count(TRACES_MAX + 1)));
    assert_eq!(check(&many[1..]), Ok(()));
    assert_eq!(
        check(&[source("e.csv", &empty)]),
        Err(ReportError::Empty("e.csv".into()))
    );
    let message = check(&[source("a.csv", &good), source("b.csv", &slow)])
        .unwrap_err()
        .to_string();
    assert_eq!(
        message,
        "a.csv has scans of T#1ms, b.csv of T#2ms: only traces of the same cycle can be laid over each other"
    );
}

#[test]
fn what_a_file_lacks_is_said_on_the_page() {
    let trace = trace("a", 1_000_000, 5);
    let lacks = ["the header".to_owned()];
    let source = Source {
        name: "a.csv",
        trace: &trace,
        lacks: &lacks,
    };
    assert!(html(&[source]).unwrap().contains("a.csv lacks the header."));
}

#[test]
fn marks_are_texts_and_places_to_go_to() {
    let trace = trace("plain", 1_000_000, 5);
    let mark = |scan| Mark {
        scan,
        title: NASTY.into(),
        text: NASTY.into(),
    };
    let page = html_marked(&[source("a", &trace)], &[mark(Some(3)), mark(None)]).unwrap();
    assert!(!page.contains("<img src=x"), "no markup from texts");
    assert_eq!(page.matches("data-scan=\"3\"").count(), 1);
    let about = scripts(&page, "<script type=\"application/json\" id=\"about\">");
    let about: Value = serde_json::from_str(about[0]).unwrap();
    assert_eq!(about["marks"], serde_json::json!([3]));
    // Two marks of one scan are two texts and one line; the page begins at the first mark.
    let marks = [mark(Some(4)), mark(Some(1)), mark(Some(4))];
    let page = html_marked(&[source("a", &trace)], &marks).unwrap();
    assert_eq!(page.matches("data-scan=\"4\"").count(), 2);
    let about = scripts(&page, "<script type=\"application/json\" id=\"about\">");
    let about: Value = serde_json::from_str(about[0]).unwrap();
    assert_eq!(about["marks"], serde_json::json!([4, 1]));
}

#[test]
fn the_page_has_the_curve_of_a_cam_where_there_is_one() {
    let mut trace = trace("plain", 1_000_000, 5);
    let cams = |trace: &Trace| {
        let page = html(&[source("a", trace)]).unwrap();
        let about: Value = serde_json::from_str(scripts(&page, "id=\"about\">")[0]).unwrap();
        about["traces"][0]["header"]["cams"].clone()
    };
    assert_eq!(cams(&trace), serde_json::json!([]));
    let cam = Cam {
        scans: [1, 1],
        begin: 0.1,
        length: 360.0,
        periodic: true,
        points: vec![0.0, 0.1, 0.0],
        ..Cam::default()
    };
    let place = trace.push_cam(cam.clone()).expect("room");
    trace.cam_lay_until(place, 4);
    assert_eq!(
        cams(&trace),
        serde_json::json!([{"slave": 0, "master": 0, "scans": [1, 4], "begin": 0.1, "length": 360.0, "periodic": true,
            "from": 0.0, "points": [0.0, 0.1, 0.0]}])
    );
    for _ in 1..CAMS_MAX {
        assert!(trace.push_cam(cam.clone()).is_some());
    }
    assert_eq!(trace.push_cam(cam), None, "a header has an end");
}
