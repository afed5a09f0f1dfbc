//! Reasons: through expressions in wires, steps and claims, and within their bound for any script.

use super::common;
use standstill_script::Outcome;
use std::fmt::Write as _;
use std::time::{Duration, Instant};

/// Two axes; X is on, Y is not. The test gives `inputs`, `blocks`, `steps` and `expect`.
fn outcome(inputs: &str, blocks: &str, steps: &str, expect: &str) -> Outcome {
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 200, "inputs": {{{inputs}}},
            "axes": {{"X": {{"limits": {{"velocity": 1000, "acceleration": 100000}}, "state": "Standstill"}},
                      "Y": {{"limits": {{"velocity": 1000, "acceleration": 100000}}}}}},
            "blocks": [{blocks}], "steps": [{steps}], "expect": [{expect}]}}"#
    );
    common::outcome(&text)
}

fn first(outcome: &Outcome) -> &str {
    assert!(!outcome.passed());
    outcome.why.first().map_or("", |reason| reason.text.as_str())
}

#[track_caller]
fn names(outcome: &Outcome, words: &[&str]) {
    let first = first(outcome);
    assert!(words.iter().all(|word| first.contains(word)), "{first}");
}

fn move_of(name: &str, axis: &str, execute: &str) -> String {
    format!(
        r#"{{"name": "{name}", "type": "MC_MoveAbsolute",
             "pins": {{"Axis": "{axis}", "Execute": {execute}, "Position": 10, "Velocity": 1000}}}}"#
    )
}

/// The wire is an expression over outputs of a block that was refused.
#[test]
fn a_wire_that_is_an_expression_leads_to_what_it_reads() {
    let blocks = [
        move_of("there", "Y", r#""=go AND NOT stop""#),
        move_of("further", "X", r#""=there.Done OR (there.Error AND FALSE)""#),
    ];
    let found = outcome(
        r#""go": false, "stop": false"#,
        &blocks.join(","),
        r#"{"at": 1, "set": {"go": true}}"#,
        r#"{"by": 190, "that": {"further.Done": true}}"#,
    );
    names(
        &found,
        &[
            "further.Execute",
            "there was refused in scan 1: 201 NotPowered",
            "Y",
        ],
    );
}

/// What keeps an expression FALSE may be an operand that is TRUE.
#[test]
fn an_operand_that_blocks_an_expression_is_named() {
    let found = outcome(
        r#""go": false, "stop": true"#,
        &move_of("there", "X", r#""=go AND NOT stop""#),
        r#"{"at": 1, "set": {"go": true}}"#,
        r#"{"by": 190, "that": {"there.Done": true}}"#,
    );
    names(&found, &["there.Execute", "stop is TRUE", "no step sets it"]);
}

/// Each variable of a program that steps set leads to its own step.
#[test]
fn variables_of_a_program_lead_to_their_steps() {
    let text = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 100, "inputs": {"one": false, "other": false},
        "axes": {"X": {"limits": {"velocity": 1000, "acceleration": 100000}, "state": "Standstill"}},
        "programs": {"c": {"st": "c.st"}},
        "blocks": [{"name": "mv", "type": "MC_MoveAbsolute",
                    "pins": {"Axis": "X", "Execute": {"all": ["c.a", "c.b"]}, "Position": 5, "Velocity": 10}}],
        "steps": [{"when": {"one": true}, "set": {"c.a": true}}, {"when": {"other": true}, "set": {"c.b": true}}],
        "expect": [{"by": 50, "that": {"mv.Busy": true}}]}"#;
    let program = "PROGRAM P VAR_INPUT a, b : BOOL; END_VAR END_PROGRAM";
    let nothing = &mut |_: &str| Err("no such file".to_owned());
    let mut load = |_: &str| Ok(program.as_bytes().to_vec());
    let script = standstill_script::read_with_programs(text, "test.scan.json", &[], nothing, &mut load);
    let found = standstill_script::run(&script.unwrap_or_else(|error| panic!("{error}"))).unwrap();
    let reasons: Vec<_> = found.why.iter().map(|reason| reason.text.as_str()).collect();
    for words in [
        "steps[0] sets c.a when one TRUE",
        "steps[1] sets c.b when other TRUE",
    ] {
        assert!(
            reasons.iter().any(|reason| reason.contains(words)),
            "{reasons:#?}"
        );
    }
}

#[test]
fn a_step_whose_condition_is_an_expression_leads_to_what_it_reads() {
    let blocks = [
        move_of("there", "Y", r#"{"from": "go"}"#),
        move_of("further", "X", r#"{"from": "next"}"#),
    ];
    let found = outcome(
        r#""go": false, "next": false"#,
        &blocks.join(","),
        r#"{"at": 1, "set": {"go": true}}, {"when": "=there.Done AND Y.Position > 5.0", "set": {"next": true}}"#,
        r#"{"by": 190, "that": {"further.Done": true}}"#,
    );
    names(
        &found,
        &["steps[1]", "there was refused in scan 1: 201 NotPowered"],
    );
}

#[test]
fn a_claim_that_is_an_expression_leads_to_what_it_reads() {
    let found = outcome(
        r#""go": false"#,
        &move_of("there", "Y", r#"{"from": "go"}"#),
        r#"{"at": 1, "set": {"go": true}}"#,
        r#"{"by": 190, "that": "=there.Done AND Y.Position > 5.0"}"#,
    );
    names(&found, &["there was refused in scan 1: 201 NotPowered", "Y"]);
    assert_eq!(found.why[0].claims, ["expect[0]"]);
}

/// A number that a wire computes.
#[test]
fn a_number_from_an_expression_leads_to_the_block_it_goes_to() {
    let found = outcome(
        r#""go": false, "length": 4"#,
        r#"{"name": "there", "type": "MC_MoveAbsolute",
            "pins": {"Axis": "X", "Execute": {"from": "go"}, "Position": "=length * 2.0", "Velocity": 60000}}"#,
        r#"{"at": 1, "set": {"go": true}}"#,
        r#"{"by": 190, "that": {"X.Position": 10}}"#,
    );
    names(
        &found,
        &["there", "Velocity", "clamped", "60000.0 to 1000.0", "per minute"],
    );
    let all: String = found.why.iter().map(|reason| reason.text.as_str()).collect();
    assert!(all.contains("Position 8.0"), "{all}");
}

/// Blocks in a ring over many scans; each is started by the one before it. The walk back ends in time and reports
/// nothing untrue.
fn ring(blocks: usize, scans: usize, claims: usize, claim: &str) -> Outcome {
    let mut all = String::new();
    for index in 0..blocks {
        let before = (index + blocks - 1) % blocks;
        let comma = if index == 0 { "" } else { "," };
        write!(
            all,
            r#"{comma}{{"name": "b{index}", "type": "R_TRIG", "pins": {{"CLK": {{"from": "b{before}.Q"}}}}}}"#
        )
        .unwrap();
    }
    let expect: Vec<_> = (0..claims)
        .map(|index| {
            format!(
                r#"{{"by": {}, "that": {{"b{}.Q": {claim}}}}}"#,
                scans - 1,
                index * blocks / claims
            )
        })
        .collect();
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": {scans},
            "axes": {{"X": {{"limits": {{"velocity": 1, "acceleration": 1}}}}}},
            "blocks": [{all}], "expect": [{}]}}"#,
        expect.join(",")
    );
    common::outcome(&text)
}

/// Twenty claims, each at another place of a ring of many blocks: all walks together take the time of a few runs.
#[test]
fn a_ring_of_many_blocks_over_many_scans_is_walked_within_its_bound() {
    let blocks = standstill_testkit::whole_or(2_000, 500);
    let timed = |claim: &str| {
        let begin = Instant::now();
        let outcome = ring(blocks, 2 * blocks, 20, claim);
        (begin.elapsed(), outcome)
    };
    let (without, holds) = timed("false");
    assert!(holds.passed() && holds.why.is_empty());
    let (with, fails) = timed("true");
    assert!(!fails.passed() && !fails.why.is_empty() && fails.why.len() <= 6);
    let walk = with.saturating_sub(without);
    assert!(
        walk < 3 * without + Duration::from_secs(2),
        "{without:?} without, {with:?} with the walk"
    );
}

#[test]
fn a_ring_is_named_as_one() {
    let found = ring(3, 10, 1, "true");
    names(
        &found,
        &["b0.CLK is b2.Q, which never rose", "b0.CLK waits for itself"],
    );
}
