//! The run of a script: steps at the latch, wires, tasks, drives and faults, row by row.
//!
//! Scripts here are as small as possible for their rule; motion has its tests in `scan-tests`.

use super::common;
use standstill_script::{Outcome, RunError, read_with_programs, run};
use standstill_trace::Cell;

/// A script of `scans` scans of 1 ms with a powered axis X and these additional keys.
fn script(scans: u64, keys: &str) -> String {
    format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": {scans},
            "axes": {{"X": {{"limits": {{"velocity": 50, "acceleration": 200}}, "state": "Standstill"}}}}, {keys}}}"#
    )
}

/// A column of a run as text, one word for each scan.
fn column(outcome: &Outcome, name: &str) -> Vec<String> {
    let column = outcome
        .trace
        .column(name)
        .unwrap_or_else(|| panic!("no column {name}"));
    outcome
        .trace
        .cells(column)
        .map(|cell| match cell {
            Cell::Bool(value) => u8::from(value).to_string(),
            Cell::Real(value) => value.to_string(),
            Cell::Integer(value) => value.to_string(),
            Cell::Name(name) => name.to_owned(),
        })
        .collect()
}

fn words(outcome: &Outcome, name: &str) -> String {
    column(outcome, name).join(" ")
}

#[test]
fn steps_apply_at_the_latch_of_their_scan_in_file_order() {
    let outcome = common::outcome(&script(
        5,
        r#""inputs": {"a": false, "v": 1}, "blocks": [{"name": "r", "type": "R_TRIG", "pins": {"CLK": {"from": "a"}}}],
           "steps": [{"at": 2, "set": {"v": 5}}, {"at": 2, "set": {"a": true, "v": 6}}, {"at": "T#4ms", "set": {"a": false}}]"#,
    ));
    assert_eq!(words(&outcome, "a"), "0 0 1 1 0");
    assert_eq!(words(&outcome, "v"), "1 1 6 6 6");
    // The block called in the scan of the step already sees it.
    assert_eq!(words(&outcome, "r.Q"), "0 0 1 0 0");
}

#[test]
fn a_step_with_when_applies_once_so_many_scans_after_the_next_latch() {
    let steps = |rest: &str| {
        let outcome = common::outcome(&script(
            12,
            &format!(
                r#""inputs": {{"a": false, "v": 0}}, "blocks": [],
                   "steps": [{{"at": 2, "set": {{"a": true}}}}, {{"at": 5, "set": {{"a": false, "v": 0}}}},
                             {{"at": 8, "set": {{"a": true}}}}, {{"when": {{"a": true}}, "set": {{"v": 1}}{rest}}}]"#
            ),
        ));
        words(&outcome, "v")
    };
    assert_eq!(steps(""), "0 0 0 1 1 0 0 0 0 0 0 0");
    assert_eq!(steps(r#", "after": 1"#), "0 0 0 0 1 0 0 0 0 0 0 0");
    assert_eq!(steps(r#", "every": true"#), "0 0 0 1 1 0 0 0 0 1 1 1");
}

#[test]
fn a_step_may_set_a_pin_that_is_not_wired() {
    let outcome = common::outcome(&script(
        4,
        r#""blocks": [{"name": "r", "type": "R_TRIG", "pins": {"CLK": false}}], "steps": [{"at": 1, "set": {"r.CLK": true}}]"#,
    ));
    assert_eq!(words(&outcome, "r.Q"), "0 1 0 0");
}

#[test]
fn stop_when_ends_the_run_so_many_rows_later() {
    let ends = |rest: &str| {
        let keys = format!(
            r#""inputs": {{"a": false}}, "blocks": [], "steps": [{{"at": 3, "set": {{"a": true}}}}], "stop_when": {{"a": true}}{rest}"#
        );
        common::outcome(&script(20, &keys)).trace.scans()
    };
    assert_eq!(ends(""), 4);
    assert_eq!(ends(r#", "after": 2"#), 6);
}

#[test]
fn a_wire_reads_earlier_blocks_of_this_scan_and_later_ones_of_the_last() {
    let outcome = common::outcome(&script(
        5,
        r#""inputs": {"a": false}, "steps": [{"at": 2, "set": {"a": true}}],
           "blocks": [{"name": "before", "type": "R_TRIG", "pins": {"CLK": {"from": "r.Q"}}},
                      {"name": "r", "type": "R_TRIG", "pins": {"CLK": {"from": "a"}}},
                      {"name": "after", "type": "R_TRIG", "pins": {"CLK": {"from": "r.Q"}}}]"#,
    ));
    assert_eq!(words(&outcome, "r.Q"), "0 0 1 0 0");
    assert_eq!(words(&outcome, "after.CLK"), "0 0 1 0 0");
    assert_eq!(words(&outcome, "before.CLK"), "0 0 0 1 0");
}

#[test]
fn logic_wires_follow_their_truth_tables() {
    let outcome = common::outcome(&script(
        4,
        r#""inputs": {"a": false, "b": false},
           "steps": [{"at": 1, "set": {"a": true}}, {"at": 2, "set": {"a": false, "b": true}}, {"at": 3, "set": {"a": true}}],
           "blocks": [{"name": "inverse", "type": "R_TRIG", "pins": {"CLK": {"not": "a"}}},
                      {"name": "any", "type": "R_TRIG", "pins": {"CLK": {"any": ["a", "b"]}}},
                      {"name": "all", "type": "R_TRIG", "pins": {"CLK": {"all": ["a", "b"]}}}]"#,
    ));
    assert_eq!(words(&outcome, "inverse.CLK"), "1 0 1 0");
    assert_eq!(words(&outcome, "any.CLK"), "0 1 1 1");
    assert_eq!(words(&outcome, "all.CLK"), "0 0 0 1");
}

#[test]
fn a_slow_task_leaves_its_pins_as_they_were() {
    let outcome = common::outcome(&script(
        6,
        r#""inputs": {"a": false, "go": false}, "steps": [{"at": 1, "set": {"a": true}}, {"at": 4, "set": {"go": true}}],
           "tasks": {"main": {"interval": "T#1ms"}, "slow": {"interval": 3, "priority": 1}, "once": {"single": {"from": "go"}}},
           "blocks": [{"name": "fast", "type": "R_TRIG", "pins": {"CLK": {"from": "a"}}},
                      {"name": "slow", "type": "R_TRIG", "task": "slow", "pins": {"CLK": {"from": "a"}}},
                      {"name": "edge", "type": "R_TRIG", "task": "once", "pins": {"CLK": {"from": "a"}}}]"#,
    ));
    assert_eq!(words(&outcome, "fast.Q"), "0 1 0 0 0 0");
    assert_eq!(words(&outcome, "slow.CLK"), "0 0 0 1 1 1");
    assert_eq!(words(&outcome, "slow.Q"), "0 0 0 1 1 1");
    assert_eq!(words(&outcome, "edge.Q"), "0 0 0 0 1 1");
}

/// A move of 3 scans with this drive, and its trace.
fn short_move(drive: &str) -> Outcome {
    common::outcome(&format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 12, "inputs": {{"go": false}}, "steps": [{{"at": 1, "set": {{"go": true}}}}],
            "axes": {{"X": {{"limits": {{"velocity": 1000, "acceleration": 1000000}}, "position": 3, "state": "Standstill", "drive": {{"ideal": {drive}}}}}}},
            "blocks": [{{"name": "m", "type": "MC_MoveAbsolute", "pins": {{"Axis": "X", "Execute": {{"from": "go"}}, "Position": 5, "Velocity": 1000}}}}]}}"#
    ))
}

#[test]
fn a_move_of_n_scans_is_done_n_scans_after_its_edge() {
    let outcome = short_move("{}");
    assert_eq!(words(&outcome, "X.Position"), "3 3.5 4.5 5 5 5 5 5 5 5 5 5");
    assert_eq!(words(&outcome, "m.Done"), "0 0 0 0 1 1 1 1 1 1 1 1");
    let states = column(&outcome, "X.State");
    assert_eq!(
        states[..5],
        [
            "Standstill",
            "DiscreteMotion",
            "DiscreteMotion",
            "DiscreteMotion",
            "Standstill"
        ]
    );
    let note = &outcome.trace.notes()[0];
    assert_eq!((note.scan, note.subject.as_str()), (1, "X"));
    assert_eq!(
        note.text,
        "plan for m to position 5.0 in 3 scans; from 3.0, boxes 1 2, acceleration 1000000.0"
    );
}

#[test]
fn the_actual_position_is_the_set_position_of_delay_plus_one_scans_ago() {
    for delay in [0, 1, 3] {
        let outcome = short_move(&format!(r#"{{"delay": {delay}}}"#));
        let set = column(&outcome, "X.Position");
        let expected: Vec<_> = (0..set.len())
            .map(|scan| scan.checked_sub(delay + 1).map_or("3", |row| set[row].as_str()))
            .collect();
        assert_eq!(column(&outcome, "X.ActualPosition"), expected, "delay {delay}");
    }
}

/// The states of an axis under these steps, without repetitions, each with its first scan.
fn states(keys: &str) -> String {
    let outcome = common::outcome(&script(40, keys));
    let mut shown = Vec::new();
    let mut last = String::new();
    for (scan, state) in column(&outcome, "X.State").into_iter().enumerate() {
        if state != last {
            shown.push(format!("{scan} {state}"));
            last = state;
        }
    }
    shown.join(", ")
}

#[test]
fn a_fault_shows_in_the_row_of_its_scan_and_needs_clear_and_reset() {
    for kind in ["drive", "power", "communication", "axis"] {
        let found = states(&format!(
            r#""inputs": {{"reset": false}},
               "blocks": [{{"name": "p", "type": "MC_Power", "pins": {{"Axis": "X", "Enable": true}}}},
                          {{"name": "r", "type": "MC_Reset", "pins": {{"Axis": "X", "Execute": {{"from": "reset"}}}}}}],
               "steps": [{{"at": 5, "fault": {{"axis": "X", "kind": "{kind}", "code": 7}}}},
                         {{"at": 10, "set": {{"reset": true}}}}, {{"at": 12, "set": {{"reset": false}}}},
                         {{"at": 20, "clear": {{"axis": "X"}}}}, {{"at": 25, "set": {{"reset": true}}}}],
               "expect": [{{"at": 10, "that": {{"r.Error": true}}}}, {{"by": 35, "that": {{"r.Done": true}}}}]"#
        ));
        let events: Vec<_> = found.split(", ").collect();
        assert_eq!(events[..2], ["0 Standstill", "5 ErrorStop"], "{kind}: {found}");
        let end = events[2].split(' ').next().and_then(|scan| scan.parse().ok());
        assert!(
            end.is_some_and(|scan: u32| (25..30).contains(&scan)),
            "{kind}: {found}"
        );
    }
}

#[test]
fn only_an_axis_without_power_can_be_displaced() {
    let displaced = |state: &str| {
        run(&common::script(&format!(
            r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 5, "blocks": [],
                "axes": {{"X": {{"limits": {{"velocity": 1, "acceleration": 1}}, "state": "{state}"}}}},
                "steps": [{{"at": 2, "drive": {{"axis": "X", "displace": 10}}}}]}}"#
        )))
    };
    let outcome = displaced("Disabled").unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(words(&outcome, "X.ActualPosition"), "0 0 10 10 10");
    assert_eq!(words(&outcome, "X.Position"), "0 0 10 10 10");
    let error = displaced("Standstill").map(|_| ()).unwrap_err();
    assert_eq!(
        error,
        RunError::Displaced {
            step: 0,
            scan: 2,
            axis: "X".into()
        }
    );
}

#[test]
fn an_undefined_enum_number_is_traced_as_its_number_and_refused_with_a_note() {
    let outcome = common::outcome(&script(
        3,
        r#""blocks": [{"name": "m", "type": "MC_MoveAbsolute",
                       "pins": {"Axis": "X", "Execute": true, "Position": 1, "Velocity": 1, "BufferMode": 77}}],
           "expect": [{"at": 0, "that": {"m.BufferMode": 77, "m.Error": true, "m.Direction": "mcDirectionUnset"}},
                      {"at": 0, "that": {"m.BufferMode": {"ne": "mcAborting"}, "m.Axis": "X"}}]"#,
    ));
    assert!(outcome.passed(), "{:?}", outcome.verdicts);
    assert_eq!(words(&outcome, "m.BufferMode"), "77 77 77");
    let note = &outcome.trace.notes()[0];
    assert_eq!(
        (note.subject.as_str(), note.text.as_str()),
        ("m", "refused: 110 BufferModeInvalid, BufferMode 77")
    );
}

#[test]
fn the_same_script_gives_the_same_trace() {
    let digest = |outcome: &Outcome| standstill_trace::digest::whole(&outcome.trace);
    assert_eq!(digest(&short_move("{}")), digest(&short_move("{}")));
}

#[test]
fn a_symbol_is_found_under_the_name_that_the_guest_exports() {
    const GUEST: &str = r#"(module
        (memory (export "memory") 1)
        (global (export "elsewhere") i32 (i32.const 8))
        (func (export "plc_scan") (param i32 i64)
            (i32.store8 (i32.const 9) (i32.load8_u (i32.const 8)))))"#;
    let read = |symbols: &str| {
        let text = script(
            4,
            &format!(
                r#""blocks": [], "programs": {{"main": {{"wasm": "main.wat", "symbols": {{{symbols}}}}}}},
                   "steps": [{{"at": 2, "set": {{"main.here": true}}}}]"#
            ),
        );
        let mut guest = |_: &str| Ok(GUEST.as_bytes().to_vec());
        read_with_programs(
            &text,
            "test.scan.json",
            &[],
            &mut |_| Err(String::new()),
            &mut guest,
        )
    };
    let found =
        read(r#""here": {"type": "BOOL", "export": "elsewhere"}, "copy": {"type": "BOOL", "address": 9}"#);
    let outcome = run(&found.unwrap()).unwrap();
    assert_eq!(words(&outcome, "main.here"), "0 0 1 1");
    assert_eq!(words(&outcome, "main.copy"), "0 0 1 1");
    // By its own name it is not there, and at two places it cannot be.
    let told = run(&read(r#""here": "BOOL""#).unwrap()).unwrap_err();
    assert!(told.to_string().contains("exports no variable `here`"), "{told}");
    let told = read(r#""here": {"type": "BOOL", "export": "elsewhere", "address": 8}"#).unwrap_err();
    assert!(told.to_string().contains("not both"), "{told}");
}
