//! Claims: each kind is fulfilled, or fails with its path, the scan, the values and the nearest scan in which it is
//! fulfilled.
//!
//! The run under judgement has a BOOL `a`, TRUE in scans 3 to 5 and 8, and a number `v` that is 0, then 1.5
//! from scan 4 on; axis X moves 3 -> 5 in three scans from scan 1 on (3, 3.5, 4.5, 5, ..).

use super::common::{failures, outcome, script};
use standstill_script::{Outcome, judge_recording, run};
use standstill_trace::Trace;

fn judged(claims: &str) -> Outcome {
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 10, "inputs": {{"a": false, "b": false, "v": 0}},
            "axes": {{"X": {{"limits": {{"velocity": 1000, "acceleration": 1000000}}, "position": 3, "state": "Standstill"}},
                      "Y": {{"limits": {{"velocity": 1, "acceleration": 1}}, "position": 5}}}},
            "blocks": [{{"name": "m", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": true, "Position": 5, "Velocity": 1000}}}}],
            "steps": [{{"at": 3, "set": {{"a": true}}}}, {{"at": 4, "set": {{"v": 1.5}}}}, {{"at": 6, "set": {{"a": false}}}},
                      {{"at": 8, "set": {{"a": true, "b": true}}}}, {{"at": 9, "set": {{"a": false}}}}],
            "stop_when": {{"v": 99}}, "expect": [{claims}]}}"#
    );
    outcome(&text)
}

#[track_caller]
fn holds(claim: &str) {
    assert_eq!(failures(&judged(claim)), [""; 0], "{claim}");
}

#[track_caller]
fn fails(claim: &str, text: &str) {
    assert_eq!(failures(&judged(claim)).join("\n"), text, "{claim}");
}

#[test]
fn at_looks_at_one_scan_and_names_the_nearest() {
    holds(r#"{"at": 3, "that": {"a": true, "X.State": "Standstill", "v": 0}}"#);
    fails(
        r#"{"at": 1, "that": {"a": true}}"#,
        "expect[0].that.a: FALSE at scan 1, expected TRUE; it came at 3, 2 later",
    );
    fails(
        r#"{"at": 7, "that": {"a": true, "v": 2}}"#,
        "expect[0].that.a: FALSE at scan 7, expected TRUE; it came at 8, 1 later\n\
         expect[0].that.v: 1.5 at scan 7, expected 2.0; it was so in no scan",
    );
    fails(
        r#"{"at": 9, "that": {"X.State": "DiscreteMotion"}}"#,
        "expect[0].that.X.State: Standstill at scan 9, expected DiscreteMotion; it was so at 2, 7 earlier",
    );
}

#[test]
fn by_wants_all_conditions_in_one_scan_of_its_range() {
    holds(r#"{"by": 4, "that": {"a": true, "v": 1.5}}"#);
    holds(r#"{"from": 8, "by": 8, "that": {"a": true}}"#);
    fails(
        r#"{"by": 3, "that": {"a": true, "v": 1.5}}"#,
        "expect[0].that.v: 0.0 at scan 3, expected 1.5; it came at 4, 1 later",
    );
    fails(
        r#"{"from": 6, "by": 7, "that": {"a": true}}"#,
        "expect[0].that.a: FALSE at scan 7, expected TRUE; it came at 8, 1 later",
    );
}

#[test]
fn always_and_never_look_at_every_scan_of_their_range() {
    holds(r#"{"from": 3, "to": 5, "always": {"a": true}}"#);
    holds(r#"{"from": 0, "to": 2, "never": {"a": true}}"#);
    holds(r#"{"always": {"v": 1.5}, "while": {"b": true}}"#);
    holds(r#"{"never": {"v": 0}, "while": {"b": true}}"#);
    fails(
        r#"{"from": 3, "always": {"a": true}}"#,
        "expect[0].always.a: FALSE at scan 6, expected TRUE; it was so at 5, 1 earlier; broken in 3 scans: 6, 7, 9",
    );
    fails(
        r#"{"never": {"a": true, "v": 1.5}}"#,
        "expect[0].never: a TRUE, v 1.5 at scan 4, expected never; it held in 3 scans: 4, 5, 8",
    );
    fails(
        r#"{"always": {"v": 0}}"#,
        "expect[0].always.v: 1.5 at scan 4, expected 0.0; it was so at 3, 1 earlier; broken in 6 scans: 4, 5, 6, 7, 8 .. 9",
    );
    fails(
        r#"{"never": {"a": true}, "while": {"b": true}}"#,
        "expect[0].never: a TRUE at scan 8, expected never; it held in scan 8",
    );
}

#[test]
fn once_is_exactly_one_scan() {
    holds(r#"{"once": {"a": true, "b": true}}"#);
    holds(r#"{"once": {"a": true}, "from": 6}"#);
    fails(
        r#"{"once": {"a": true}}"#,
        "expect[0].once: a TRUE held in 4 scans: 3, 4, 5, 8, expected exactly once",
    );
    fails(
        r#"{"once": {"a": true}, "to": 2}"#,
        "expect[0].once: a TRUE did not hold in scans 0 to 2, expected exactly once; it came at 3, 1 later",
    );
}

#[test]
fn exclusive_lets_one_be_true() {
    holds(r#"{"exclusive": ["m.Busy", "m.Done", "m.CommandAborted", "m.Error"]}"#);
    fails(
        r#"{"exclusive": ["a", "b", "m.Busy"]}"#,
        "expect[0].exclusive: a and b are TRUE together at scan 8; at most one may be; broken in scan 8",
    );
}

#[test]
fn comparisons() {
    for (test, value) in [
        (r#"{"near": 1.4, "within": 0.2}"#, true),
        (r#"{"near": 1.4, "within": 0.05}"#, false),
        (r#"{"le": 1.5}"#, true),
        (r#"{"le": 1.4}"#, false),
        (r#"{"ge": 1.5, "lt": 1.6}"#, true),
        (r#"{"ge": 1.4, "lt": 1.5}"#, false),
        (r#"{"gt": 1.5}"#, false),
        (r#"{"gt": 1.4}"#, true),
        (r#"{"ne": 1.5}"#, false),
        (r#"{"ne": 0}"#, true),
        (r#"{"abs_le": 1.5}"#, true),
        (r#"{"abs_le": 1.4}"#, false),
        (r#"1.5000000000000002"#, false),
        (r#""NaN""#, false),
    ] {
        let found = failures(&judged(&format!(r#"{{"at": 9, "that": {{"v": {test}}}}}"#)));
        assert_eq!(found.is_empty(), value, "{test}: {found:?}");
    }
    holds(r#"{"at": 9, "that": {"X.Position": {"same_as": "Y.Position"}, "X.Velocity": -0.0}}"#);
    fails(
        r#"{"at": 9, "that": {"X.Position": {"same_as": "v"}}}"#,
        "expect[0].that.X.Position: 5.0 (v 1.5) at scan 9, expected the same as v; it was so in no scan",
    );
    fails(
        r#"{"at": 9, "that": {"v": {"ge": 2, "lt": 3}}}"#,
        "expect[0].that.v: 1.5 at scan 9, expected >= 2.0 and < 3.0; it was so in no scan",
    );
}

/// Positions 3.5, 4.5, 5, 5 of a move from 3: differences 0.5, 1, 0.5, 0 over 1 ms.
#[test]
fn differences_begin_at_rest_where_the_axis_started() {
    holds(r#"{"at": 0, "that": {"X.Position.d1": 500, "X.Position.d2": 500000}}"#);
    holds(r#"{"at": 1, "that": {"X.Position.d1": 1000, "X.Position.d2": 500000}}"#);
    holds(r#"{"at": 2, "that": {"X.Position.d1": 500, "X.Position.d2": -500000}}"#);
    let third = r#"{"at": 1, "that": {"X.Position.d3": {"near": 0, "within": 1e-3}}}"#;
    holds(third);
    let fourth = r#"{"at": 2, "that": {"X.Position.d4": {"near": -1e12, "within": 1}}}"#;
    holds(fourth);
}

#[test]
fn within_limits_allows_what_positions_resolve_and_no_more() {
    holds(r#"{"within_limits": "X"}"#);
    holds(r#"{"within_limits": "X", "factor": 2}"#);
    fails(
        r#"{"within_limits": "X", "factor": 0.9}"#,
        "expect[0].within_limits.X.Position.d1: 1000.0 at scan 1, expected of magnitude <= 900.0; broken in scan 1",
    );
    holds(r#"{"within_limits": "X", "factor": 0.9, "from": 2}"#);
    // 2 ulp of the largest position, 5, over 1 ms are 1.8e-12 of 1000.
    fails(
        r#"{"within_limits": "X", "factor": 0.9999999}"#,
        "expect[0].within_limits.X.Position.d1: 1000.0 at scan 1, expected of magnitude <= 999.9999; broken in scan 1",
    );
}

#[test]
fn a_claim_beyond_the_end_of_the_run_fails() {
    let early = |claim: &str| {
        let text = format!(
            r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 100, "axes": {{}}, "blocks": [], "inputs": {{"a": false}},
                "steps": [{{"at": 4, "set": {{"a": true}}}}], "stop_when": {{"a": true}}, "after": 2, "expect": [{claim}]}}"#
        );
        failures(&outcome(&text)).join("\n")
    };
    let beyond = |scan| format!("expect[0]: it speaks of scan {scan}, but the run ended with scan 6");
    assert_eq!(early(r#"{"at": 7, "that": {"a": true}}"#), beyond(7));
    assert_eq!(early(r#"{"from": 2, "to": 9, "never": {"a": true}}"#), beyond(9));
    assert_eq!(early(r#"{"by": 9, "that": {"a": true}}"#), "");
    assert_eq!(early(r#"{"by": 9, "that": {"a": false}}"#), "");
}

#[test]
fn verdicts_stand_in_the_header_of_the_trace() {
    let outcome = judged(
        r#"{"at": 3, "that": {"a": true}}, {"from": 2, "to": 4, "never": {"a": true}, "while": {"v": {"le": 1}}}"#,
    );
    let claims: Vec<_> = outcome
        .trace
        .header()
        .claims
        .iter()
        .map(|claim| format!("{} {} {:?}", claim.path, claim.text, claim.verdict))
        .collect();
    assert_eq!(
        claims,
        [
            "expect[0] at 3: a TRUE Passed",
            "expect[1] never from 2 to 4 while v <= 1.0: a TRUE Failed"
        ]
    );
}

/// Seventy axes, more than the number of records in the ring. With `moves` each moves 1 mm from scan 2 on. The
/// position of each is increased by 1000 mm, at once or when it is at rest.
fn seventy_axes(moves: bool, mode: &str) -> String {
    let each = |text: &dyn Fn(usize) -> String| (0..70).map(text).collect::<Vec<_>>().join(", ");
    let axes = each(&|axis| {
        format!(
            r#""X{axis}": {{"limits": {{"velocity": 100, "acceleration": 1000}}, "state": "Standstill"}}"#
        )
    });
    let moved = |axis| {
        format!(
            r#"{{"name": "m{axis}", "type": "MC_MoveRelative", "pins": {{"Axis": "X{axis}", "Execute": {{"from": "GO"}}, "Distance": 1, "Velocity": 100}}}}, "#
        )
    };
    let blocks = each(&|axis| {
        let moved = if moves { moved(axis) } else { String::new() };
        format!(
            r#"{moved}{{"name": "s{axis}", "type": "MC_SetPosition", "pins": {{"Axis": "X{axis}", "Execute": {{"from": "GO"}}, "Position": 1000, "Relative": true, "ExecutionMode": "{mode}"}}}}"#
        )
    });
    let claims = each(&|axis| {
        format!(
            r#"{{"within_limits": "X{axis}"}}, {{"always": {{"X{axis}.Position.d1": {{"le": 101}}}}}}, {{"by": 90, "that": {{"s{axis}.Done": true}}}}"#
        )
    });
    format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 100, "inputs": {{"GO": false}}, "axes": {{{axes}}}, "blocks": [{blocks}],
            "steps": [{{"at": 2, "set": {{"GO": true}}}}], "expect": [{claims}]}}"#
    )
}

/// The run of seventy axes. Its claims are fulfilled, and are also judged on the trace alone.
fn run_of_seventy(moves: bool, mode: &str) -> Trace {
    let script = script(&seventy_axes(moves, mode));
    let outcome = run(&script).expect("it runs");
    assert_eq!(failures(&outcome), [""; 0]);
    let again = judge_recording(&script, outcome.trace.clone()).expect("it is of this script");
    assert_eq!(failures(&again), [""; 0]);
    outcome.trace
}

fn notes_with(trace: &Trace, text: &str) -> usize {
    trace
        .notes()
        .iter()
        .filter(|note| note.text.contains(text))
        .count()
}

#[test]
fn no_note_is_lost_however_many_axes_are_called_in_a_scan() {
    let trace = run_of_seventy(false, "mcImmediately");
    assert_eq!(notes_with(&trace, "coordinates"), 70);
    assert_eq!(notes_with(&trace, "are lost"), 0);
    // A plan and a shift for each: 140 records of calls in scan 2.
    let trace = run_of_seventy(true, "mcImmediately");
    assert_eq!(notes_with(&trace, "plan for"), 70);
    assert_eq!(notes_with(&trace, "coordinates"), 70);
    assert_eq!(notes_with(&trace, "are lost"), 0);
}

#[test]
fn coordinates_that_move_are_no_motion_where_records_are_lost() {
    // All shifts are in one motion step, at the end of the moves.
    let trace = run_of_seventy(true, "mcQueued");
    assert_eq!(notes_with(&trace, "plan for"), 70);
    assert_eq!(notes_with(&trace, "coordinates"), 70);
    assert_eq!(notes_with(&trace, "records of this scan are lost"), 1);
}
