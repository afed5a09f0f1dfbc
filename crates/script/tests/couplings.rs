//! The view of a script on coupled axes: the columns of slaves, and their signals in claims, steps and
//! wires.
//!
//! S follows M at 1/1 from scan 1 on. M moves at 200 u/s from scan 10 on; the limit of S is 100: it lags,
//! and catches up when M is at rest again. L follows S; A follows nothing and is at no `Slave` pin.

use super::common::{failures, outcome};
use standstill_script::{Outcome, read};
use standstill_trace::{Cell, Trace, cell_text};

fn text(keys: &str) -> String {
    format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 900, "inputs": {{"GO": false, "RUN": false, "off": false}},
            "axes": {{"M": {{"limits": {{"velocity": 200, "acceleration": 10000}}, "state": "Standstill"}},
                     "S": {{"limits": {{"velocity": 100, "acceleration": 10000}}, "state": "Standstill"}},
                     "A": {{"limits": {{"velocity": 100, "acceleration": 10000}}, "state": "Standstill"}},
                     "L": {{"limits": {{"velocity": 100, "acceleration": 10000}}, "state": "Standstill"}}}},
            "blocks": [{{"name": "gear", "type": "MC_GearIn", "pins": {{"Master": "M", "Slave": "S",
                          "Execute": {{"from": "GO"}}, "RatioNumerator": 1, "RatioDenominator": 1}}}},
                       {{"name": "last", "type": "MC_GearIn", "pins": {{"Master": "S", "slave": "L",
                          "Execute": {{"from": "GO"}}, "RatioNumerator": 1, "RatioDenominator": 2}}}},
                       {{"name": "drive", "type": "MC_MoveRelative", "pins": {{"Axis": "M", "Execute": {{"from": "RUN"}},
                          "Distance": 40, "Velocity": 200}}}},
                       {{"name": "halt", "type": "MC_Halt", "pins": {{"Axis": "S", "Execute": {{"from": "off"}}}}}},
                       {{"name": "far", "type": "MC_MoveRelative", "pins": {{"Axis": "A", "Execute": "=S.Deviation < -5.0",
                          "Distance": 1, "Velocity": 50}}}}],
            {keys}}}"#
    )
}

const STEPS: &str = r#""steps": [{"at": 1, "set": {"GO": true}}, {"at": 10, "set": {"RUN": true}}, {"at": 800, "set": {"off": true}}]"#;

fn judged(claims: &str) -> Outcome {
    outcome(&text(&format!("{STEPS}, \"expect\": [{claims}]")))
}

fn refused(claim: &str) -> String {
    let text = text(&format!("{STEPS}, \"expect\": [{claim}]"));
    read(&text, "test.scan.json", &[]).expect_err(claim).to_string()
}

#[test]
fn only_slaves_have_the_columns() {
    let trace = judged("").trace;
    let names: Vec<&str> = trace
        .columns()
        .iter()
        .map(|column| column.name.as_str())
        .collect();
    let of_slaves: Vec<&str> = names
        .iter()
        .copied()
        .filter(|name| {
            ["Master", "Deviation", "Phase"]
                .iter()
                .any(|signal| name.ends_with(signal))
        })
        .filter(|name| !name.starts_with("gear.") && !name.starts_with("last."))
        .collect();
    assert_eq!(
        of_slaves,
        [
            "S.Master",
            "S.Deviation",
            "S.Phase",
            "L.Master",
            "L.Deviation",
            "L.Phase"
        ]
    );
    let behind = names
        .iter()
        .position(|name| *name == "S.ActualPosition")
        .map(|at| at + 1);
    assert_eq!(trace.column("S.Master"), behind);
}

#[test]
fn the_columns_tell_of_their_row_and_are_empty_without_a_master() {
    let outcome = judged("");
    let trace = &outcome.trace;
    let text = |name: &str, scan| cell_text(trace.cell(scan, trace.column(name).unwrap()).unwrap());
    let number = |name: &str, scan| match trace.cell(scan, trace.column(name).unwrap()) {
        Some(Cell::Real(value)) => value,
        other => panic!("{other:?}"),
    };
    for (scan, master) in [(0, ""), (1, "M"), (100, "M"), (799, "M"), (800, ""), (899, "")] {
        assert_eq!(text("S.Master", scan), master, "{scan}");
    }
    assert_eq!(text("L.Master", 899), "S");
    for scan in 0..trace.scans() {
        let off = number("S.Position", scan) - number("M.Position", scan);
        let shown = number("S.Deviation", scan);
        if text("S.Master", scan).is_empty() {
            assert_eq!(shown, 0.0, "{scan}");
        } else {
            assert!((shown - off).abs() < 1e-12, "{scan}: {shown} {off}");
        }
        assert_eq!(number("S.Phase", scan), 0.0, "{scan}");
    }
    // The block sees it one scan later.
    let lag = number("S.Deviation", 100);
    assert!(lag < -5.0, "{lag}");
    assert_eq!(number("gear.Deviation", 101), lag);
}

#[test]
fn claims_conditions_and_expressions_read_them() {
    let claims = r#"
        {"at": 1, "that": {"S.Master": "M", "L.Master": "s", "S.Phase": 0}},
        {"at": 0, "that": {"S.Master": ""}},
        {"at": 850, "that": {"S.Master": {"ne": "M"}, "S.Deviation": 0.0}},
        {"always": {"s.deviation": {"le": 1e-12, "ge": -25}}},
        {"always": "=S.Deviation <= 1.0E-12 AND L.Phase = 0.0"},
        {"by": 200, "that": {"far.Busy": true}},
        {"never": {"S.Deviation": {"lt": -5}}, "to": 100}"#;
    let failures = failures(&judged(claims));
    // At 100 u/s the distance is 5 u behind after some 60 ms; the last claim is there to show a value.
    assert_eq!(failures.len(), 1, "{failures:#?}");
    assert!(
        failures[0].starts_with("expect[6].never: S.Deviation -5."),
        "{failures:#?}"
    );
}

#[test]
fn others_are_told_what_they_lack() {
    for (claim, message) in [
        (
            r#"{"at": 1, "that": {"M.Deviation": 0}}"#,
            "`M` stands at no `Slave` pin, and has no `Deviation`",
        ),
        (
            r#"{"at": 1, "that": {"A.Master": ""}}"#,
            "`A` stands at no `Slave` pin, and has no `Master`",
        ),
        (
            r#"{"at": 1, "that": {"S.Master": "N"}}"#,
            "the script has no axis `N`",
        ),
        (
            r#"{"always": "=S.Master = M"}"#,
            "`S.Master` is the master of an axis, which expressions do not read",
        ),
        (
            r#"{"at": 1, "that": {"S.Deviatoin": 0}}"#,
            "did you mean `Deviation`?",
        ),
    ] {
        let error = refused(claim);
        assert!(error.contains(message), "{claim}\n{error}");
    }
}

/// The header has the position of a cam, so that a picture can draw the curve of its table. Here the master has
/// turns that are no multiple of the period, and the axis joins the cam at 30.
#[test]
fn the_header_tells_how_cams_lay() {
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 4000, "inputs": {"OFF": false},
        "axes": {"M": {"modulo": 100, "limits": {"velocity": 200, "acceleration": 10000}, "state": "Standstill"},
                 "S": {"limits": {"velocity": 500, "acceleration": 10000}, "state": "Standstill"}},
        "blocks": [{"name": "go", "type": "MC_MoveVelocity", "pins": {"Axis": "M", "Execute": {"from": "cam.InSync"}, "Velocity": 150}},
                   {"name": "table", "type": "MC_CamTableSelect", "pins": {"Master": "M", "Slave": "S", "Execute": true, "Periodic": true,
                     "CamTable": [{"Master": 0, "Slave": 0, "Law": "mcCamRest7"}, {"Master": 130, "Slave": 40}]}},
                   {"name": "cam", "type": "MC_CamIn", "pins": {"Master": "M", "Slave": "S", "Execute": {"from": "table.Done"},
                     "MasterOffset": -30, "SlaveScaling": 0.5, "CamTableID": {"from": "table.CamTableID"}}},
                   {"name": "halt", "type": "MC_Halt", "pins": {"Axis": "S", "Execute": {"from": "OFF"}}}],
        "steps": [{"at": 3000, "set": {"OFF": true}}], "expect": []}"#;
    let trace = outcome(text).trace;
    let [cam] = &trace.header().cams[..] else {
        panic!("one cam: {:?}", trace.header().cams);
    };
    assert_eq!((cam.slave, cam.master, cam.periodic), (1, 0, true));
    assert_eq!((cam.begin, cam.length), (-30.0, 130.0));
    assert_eq!(cam.scans[1], 2999, "MC_Halt takes the slave off it");
    assert_eq!((cam.points.len(), cam.points[128]), (129, 20.0));
    in_sync_on_the_curve(&trace, 100.0, 3000);
}

/// The cam's positions count from the position of its master at the edge, and the cam begins two turns later. So
/// its position is two turns back.
#[test]
fn the_header_tells_how_a_cam_lies_that_was_laid_turns_before() {
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 4000,
        "axes": {"M": {"modulo": 50, "position": 40, "limits": {"velocity": 200, "acceleration": 10000}, "state": "Standstill"},
                 "S": {"limits": {"velocity": 500, "acceleration": 10000}, "state": "Standstill"}},
        "blocks": [{"name": "go", "type": "MC_MoveVelocity", "pins": {"Axis": "M", "Execute": {"from": "table.Done"}, "Velocity": 50}},
                   {"name": "table", "type": "MC_CamTableSelect", "pins": {"Master": "M", "Slave": "S", "Execute": true, "Periodic": true,
                     "CamTable": [{"Master": 0, "Slave": 0, "Law": "mcCamRest7"}, {"Master": 130, "Slave": 40}]}},
                   {"name": "cam", "type": "MC_CamIn", "pins": {"Master": "M", "Slave": "S", "Execute": {"from": "table.Done"},
                     "MasterSyncPosition": 120, "MasterStartDistance": 20, "CamTableID": {"from": "table.CamTableID"}}}],
        "steps": [], "expect": [{"never": {"cam.Error": true}}]}"#;
    let outcome = outcome(text);
    assert!(outcome.passed());
    let [cam] = &outcome.trace.header().cams[..] else {
        panic!("one cam: {:?}", outcome.trace.header().cams);
    };
    assert_eq!(cam.begin, 40.0 - 2.0 * 50.0);
    in_sync_on_the_curve(&outcome.trace, 50.0, 4000);
}

/// In sync the slave is on the curve of the only cam of the header, in every period up to the scan `end`. The
/// master has turns of the length `turn`.
fn in_sync_on_the_curve(trace: &Trace, turn: f64, end: usize) {
    let cam = &trace.header().cams[0];
    let rise = cam.points[128] - cam.points[0];
    let column = |name: &str| trace.column(name).expect(name);
    let in_sync = trace
        .cells(column("cam.InSync"))
        .map(|cell| cell == Cell::Bool(true));
    let places = trace
        .reals(column("M.Position"))
        .zip(trace.reals(column("S.Position")));
    let (mut turns, mut before) = (0.0, f64::NAN);
    let rows = places.zip(in_sync).enumerate();
    for (scan, ((master, slave), is_in_sync)) in rows.take(end).skip(cam.scans[0]) {
        if master < before - 0.5 * turn {
            turns += 1.0;
        }
        before = master;
        if !is_in_sync {
            continue;
        }
        let way: f64 = (master + turn * turns - cam.begin) / cam.length;
        let place = (way - way.floor()) * 128.0;
        let (low, high) = (place.floor() as usize, (place.floor() as usize + 1).min(128));
        let (one, other) = (cam.points[low], cam.points[high]);
        let on_curve = cam.from + rise * way.floor() + one + (other - one) * place.fract();
        assert!(
            (on_curve - slave).abs() < 0.01,
            "scan {scan}: {slave}, curve {on_curve}"
        );
    }
}
