//! The claim `follows`: it holds for the positions of the runtime, and fails for every position with an
//! error of one unit in the last place.

use super::common::{failures, outcome, script};
use standstill_script::{Outcome, judge_recording, read, run, warnings};
use standstill_testkit::Random;
use standstill_trace::{Cell, Trace};

/// M runs at 90 u/s from scan 5 on. S is coupled in scan 40, so it must first accelerate to M's velocity. The
/// numbers of the axes are deliberately not round.
fn text(ratio: (i16, u16), turns: [&str; 2], claims: &str) -> String {
    let (num, den) = ratio;
    let [master, slave] = turns;
    // Less than half a turn in a scan.
    let most = if slave.is_empty() { 1e7 } else { 1500.0 };
    format!(
        r#"{{"standstill": 1, "cycle": "T#1ms", "scans": 700, "inputs": {{"GO": false, "RUN": false, "NAME": false}},
            "axes": {{"M": {{{master}"limits": {{"velocity": 90.1, "acceleration": 1000.3}}, "position": 0.7, "state": "Standstill"}},
                     "S": {{{slave}"limits": {{"velocity": {most}, "acceleration": 1e8}}, "position": 3.3, "state": "Standstill"}}}},
            "blocks": [{{"name": "gear", "type": "MC_GearIn", "pins": {{"Master": "M", "Slave": "S",
                          "Execute": {{"from": "GO"}}, "RatioNumerator": {num}, "RatioDenominator": {den}}}}},
                       {{"name": "drive", "type": "MC_MoveVelocity", "pins": {{"Axis": "M", "Execute": {{"from": "RUN"}},
                          "Velocity": 90.05}}}},
                       {{"name": "set", "type": "MC_SetPosition", "pins": {{"Axis": "M", "Execute": {{"from": "NAME"}},
                          "Position": 3.1}}}}],
            "steps": [{{"at": 5, "set": {{"RUN": true}}}}, {{"at": 40, "set": {{"GO": true}}}}],
            "expect": [{claims}]}}"#
    )
}

const PLAIN: [&str; 2] = ["", ""];
const ROUND: [&str; 2] = [r#""modulo": 7.3, "#, r#""modulo": 5.9, "#];

fn claim(ratio: (i16, u16), more: &str) -> String {
    let (num, den) = ratio;
    format!(
        r#"{{"follows": {{"slave": "S", "master": "M", "num": {num}, "den": {den}, "while": {{"gear.InGear": true}}{more}}}}}"#
    )
}

/// The trace with other cells where `change` returns some: scan, name of the column, cell.
fn changed(trace: &Trace, change: impl Fn(usize, &str, f64) -> f64) -> Trace {
    let mut other = Trace::new(trace.header().clone());
    for scan in 0..trace.scans() {
        let row = trace.row(scan).zip(trace.columns());
        let row = row.map(|(cell, column)| match cell {
            Cell::Real(value) => Cell::Real(change(scan, &column.name, value)),
            other => other,
        });
        other.push_cells(row).expect("a row of the trace");
    }
    trace
        .notes()
        .iter()
        .cloned()
        .for_each(|note| other.push_note(note));
    other
}

fn number(trace: &Trace, name: &str, scan: usize) -> f64 {
    match trace.cell(scan, trace.column(name).expect(name)) {
        Some(Cell::Real(value)) => value,
        other => panic!("{name}: {other:?}"),
    }
}

/// The first row with InGear, and the anchor that the runtime fixed, in the row before.
fn locked(trace: &Trace) -> (usize, String) {
    let in_gear = trace.column("gear.InGear").unwrap();
    let first = (0..trace.scans()).find(|scan| trace.cell(*scan, in_gear) == Some(Cell::Bool(true)));
    let first = first.expect("in gear");
    let at = |axis: &str| number(trace, &format!("{axis}.Position"), first - 1);
    let anchor = format!(
        r#", "anchor": {{"master": {:?}, "slave": {:?}}}"#,
        at("M"),
        at("S")
    );
    (first, anchor)
}

/// Covers: G11, G25, G26, G31
#[test]
fn every_ratio_follows_to_the_bit_with_and_without_turns() {
    let mut random = Random(31);
    let mut ratios = vec![
        (1, 2),
        (3, 7),
        (-3, 7),
        (1, 1),
        (0, 5),
        (32_767, 65_535),
        (-32_768, 1),
        (1, 65_535),
    ];
    for _ in 0..12 {
        let num = random.below(401) as i16 - 200;
        ratios.push((num, 1 + random.below(300) as u16));
    }
    let mut tried = 0;
    for ratio in ratios {
        for turns in [PLAIN, [ROUND[0], PLAIN[1]], [PLAIN[0], ROUND[1]], ROUND] {
            // A slave with turns is not fast enough for the largest ratios.
            if !turns[1].is_empty() && i32::from(ratio.0).abs() > 15 * i32::from(ratio.1) {
                continue;
            }
            let bare = outcome(&text(ratio, turns, ""));
            // A ratio of turns that no integers below 2^63 have is refused.
            if turns == ROUND && !has_gear(&bare) {
                continue;
            }
            let (_, anchor) = locked(&bare.trace);
            let claims = format!("{}, {}", claim(ratio, ""), claim(ratio, &anchor));
            let judged = outcome(&text(ratio, turns, &claims));
            assert_eq!(failures(&judged), Vec::<String>::new(), "{ratio:?} {turns:?}");
            tried += 1;
        }
    }
    assert!(tried >= 60, "{tried}");
}

fn has_gear(outcome: &Outcome) -> bool {
    let in_gear = outcome.trace.column("gear.InGear").unwrap();
    (0..outcome.trace.scans()).any(|scan| outcome.trace.cell(scan, in_gear) == Some(Cell::Bool(true)))
}

/// Without an anchor the first rows leave a range for the unrounded values. One of the rows then fails.
#[test]
fn one_unit_in_the_last_place_is_too_much() {
    for (ratio, turns) in [
        ((3, 7), PLAIN),
        ((1, 1), PLAIN),
        ((-5, 2), PLAIN),
        ((3, 7), [r#""modulo": 8, "#, r#""modulo": 4, "#]),
    ] {
        let bare = outcome(&text(ratio, turns, ""));
        let (first, anchor) = locked(&bare.trace);
        let with_anchor = script(&text(ratio, turns, &claim(ratio, &anchor)));
        let without = script(&text(ratio, turns, &claim(ratio, "")));
        for scan in [first, first + 1, 300, 301, 555, 698] {
            for up in [true, false] {
                let off = changed(&bare.trace, |at, name, value| {
                    match (at == scan && name == "S.Position", up) {
                        (false, _) => value,
                        (true, true) => value.next_up(),
                        (true, false) => value.next_down(),
                    }
                });
                let is = number(&off, "S.Position", scan);
                let expected = number(&bare.trace, "S.Position", scan);
                let judged = judge_recording(&with_anchor, off.clone()).expect("all columns are there");
                let found = failures(&judged);
                let begin = format!(
                    "expect[0].follows.S.Position: {is:?} at scan {scan}, expected {expected:?}: S follows M at "
                );
                assert_eq!(found.len(), 1, "{ratio:?} {scan}");
                assert!(found[0].starts_with(&begin), "{}\n{begin}", found[0]);
                assert!(
                    found[0].ends_with(&format!("; broken in scan {scan}")),
                    "{}",
                    found[0]
                );
                let judged = judge_recording(&without, off).expect("all columns are there");
                assert_eq!(failures(&judged).len(), 1, "{ratio:?} {scan}");
            }
        }
    }
}

#[test]
fn another_ratio_and_another_anchor_fail() {
    let bare = outcome(&text((3, 7), PLAIN, ""));
    let (first, anchor) = locked(&bare.trace);
    for wrong in [(3, 8), (-3, 7), (27_001, 63_000)] {
        let judged = outcome(&text((3, 7), PLAIN, &claim(wrong, "")));
        let found = failures(&judged);
        assert_eq!(found.len(), 1, "{wrong:?}");
        assert!(
            found[0].contains(&format!("at {}/{}; broken in ", wrong.0, wrong.1)),
            "{found:?}"
        );
    }
    let [m, s] = ["M", "S"].map(|axis| number(&bare.trace, &format!("{axis}.Position"), first - 1));
    assert!(anchor.contains(&format!("{s:?}")));
    for (m, s) in [(m, s.next_up()), (m.next_up().next_up(), s), (m + 1.0, s)] {
        let off = format!(r#", "anchor": {{"master": {m:?}, "slave": {s:?}}}"#);
        let judged = outcome(&text((3, 7), PLAIN, &claim((3, 7), &off)));
        assert_eq!(failures(&judged).len(), 1, "{m} {s}");
    }
}

#[test]
fn rows_are_judged_while_it_holds_in_them_and_in_the_next() {
    let bare = outcome(&text((3, 7), PLAIN, ""));
    let (first, _) = locked(&bare.trace);
    let all = r#"{"follows": {"slave": "S", "master": "M", "num": 3, "den": 7}}"#;
    assert_eq!(failures(&outcome(&text((3, 7), PLAIN, all))).len(), 1);
    // The row before InGear and the last one of the run are not judged; `from` and `to` leave out others.
    let wrong = |scan: usize, claim: &str| {
        let off = changed(&bare.trace, |at, name, value| {
            if at == scan && name == "S.Position" {
                value + 1.0
            } else {
                value
            }
        });
        failures(&judge_recording(&script(&text((3, 7), PLAIN, claim)), off).unwrap()).len()
    };
    let usual = claim((3, 7), "");
    assert_eq!(
        [first - 1, first, 698, 699].map(|scan| wrong(scan, &usual)),
        [0, 1, 1, 0]
    );
    let part = usual.replacen('{', r#"{"from": 300, "to": 400, "#, 1);
    assert_eq!(
        [299, 300, 301, 400, 401].map(|scan| wrong(scan, &part)),
        [0, 1, 1, 1, 0]
    );
    let window = usual.replacen('{', r#"{"from": {"when": {"M.Position": {"gt": 30}}}, "#, 1);
    assert_eq!([100, 699].map(|scan| wrong(scan, &window)), [0, 0]);
    assert_eq!(wrong(650, &window), 1);
}

#[test]
fn coordinates_that_move_begin_a_law_anew() {
    let names = text((3, 7), PLAIN, &claim((3, 7), ""));
    let names = names.replace(
        r#""set": {"GO": true}}"#,
        r#""set": {"GO": true}}, {"at": 400, "set": {"NAME": true}}"#,
    );
    let judged = outcome(&names);
    let jump = number(&judged.trace, "M.Position", 400) - number(&judged.trace, "M.Position", 399);
    assert!(jump < -10.0, "{jump}");
    assert_eq!(failures(&judged), Vec::<String>::new());
    // Without that note the judge finds the jump.
    let mut silent = Trace::new(judged.trace.header().clone());
    for scan in 0..judged.trace.scans() {
        silent.push_cells(judged.trace.row(scan)).unwrap();
    }
    assert_eq!(
        failures(&judge_recording(&script(&names), silent).unwrap()).len(),
        1
    );
}

#[test]
fn the_phase_is_added_to_the_master() {
    let bare = outcome(&text((1, 2), PLAIN, ""));
    let claims = script(&text((1, 2), PLAIN, &claim((1, 2), "")));
    let phase = |scan: usize| if scan < 350 { 0.0 } else { 1.625 };
    // On a grid of 2^-20 every sum is exact.
    let seen = |scan| (number(&bare.trace, "M.Position", scan) * 1_048_576.0).round() / 1_048_576.0;
    for told in [true, false] {
        let other = changed(&bare.trace, |scan, name, value| match name {
            "M.Position" => seen(scan) - phase(scan),
            "S.Position" => 0.125 + seen(scan) / 2.0,
            "S.Phase" if told => phase(scan),
            _ => value,
        });
        let found = failures(&judge_recording(&claims, other).unwrap());
        if told {
            assert_eq!(found, Vec::<String>::new());
        } else {
            assert!(found[0].contains(" at scan 350, expected "), "{found:?}");
        }
    }
}

#[test]
fn a_claim_without_a_judged_row_is_vacuous() {
    let never =
        r#"{"follows": {"slave": "S", "master": "M", "num": 1, "den": 2, "while": {"gear.Error": true}}}"#;
    let script = script(&text((1, 2), PLAIN, never));
    let outcome = run(&script).unwrap();
    assert_eq!(failures(&outcome), Vec::<String>::new());
    let told: Vec<_> = warnings(&script, &outcome, true)
        .all
        .iter()
        .map(|warning| warning.message.clone())
        .collect();
    let wanted = "the claim asks for nothing: its `while` held in no two scans on end";
    assert!(told.iter().any(|text| text.contains(wanted)), "{told:?}");
}

#[test]
fn what_it_says() {
    let claims = format!(
        r#"{}, {{"from": 3, "follows": {{"slave": "s", "master": "m", "num": 3, "den": 7, "while": {{"gear.InGear": true}}, "anchor": {{"master": 0, "slave": 1.5}}}}}}"#,
        claim((3, 7), "")
    );
    let says: Vec<_> = outcome(&text((3, 7), PLAIN, &claims))
        .verdicts
        .into_iter()
        .map(|verdict| verdict.says)
        .collect();
    assert_eq!(
        says,
        [
            "S follows M at 3/7 while gear.InGear TRUE",
            "S follows M at 3/7 through 1.5 at 0.0 from 3 while gear.InGear TRUE"
        ]
    );
}

#[test]
fn bad_input_is_told_at_its_place() {
    let good = claim((3, 7), r#", "anchor": {"master": 0, "slave": 1}"#);
    for (old, new, line) in [
        (
            r#""slave": "S""#,
            r#""slave": "N""#,
            "error[unknown_axis]: the script has no axis `N`",
        ),
        (
            r#""master": "M""#,
            r#""master": "S""#,
            "error[bad_value]: an axis does not follow itself",
        ),
        (
            r#""den": 7"#,
            r#""den": 0"#,
            "error[bad_value]: `den` is 0: it must be a whole number from 1 to 65535",
        ),
        (
            r#""num": 3"#,
            r#""num": 1.5"#,
            "error[bad_value]: `num` is 1.5: it must be a whole number from -32768 to 32767",
        ),
        (
            r#""num": 3"#,
            r#""num": 40000"#,
            "error[bad_value]: `num` is 40000: it must be a whole number from -32768 to 32767",
        ),
        (
            r#""num": 3, "#,
            "",
            "error[missing_key]: `follows` needs the key `num`",
        ),
        (
            r#""slave": 1}"#,
            r#""slave": "NaN"}"#,
            "error[bad_value]: `slave` is NaN: it must be a finite number",
        ),
        (
            r#", "slave": 1}"#,
            "}",
            "error[missing_key]: `anchor` needs the key `slave`",
        ),
        (r#""while""#, r#""when""#, "error[unknown_key]: "),
        (r#""gear.InGear""#, r#""gear.inGaer""#, "error[unknown_pin]: "),
        (r#"{"slave": "S""#, r#"[{"slave": "S""#, "error[syntax]: "),
    ] {
        assert!(good.contains(old), "{old}");
        let bad = text((3, 7), PLAIN, &good.replacen(old, new, 1));
        let error = read(&bad, "test.scan.json", &[]).expect_err(new);
        let told = error.to_string();
        assert!(told.starts_with(line), "{new}\n{told}");
        assert!(told.contains("--> test.scan.json:11:"), "{new}\n{told}");
        if line.contains("itself") {
            assert!(
                told.contains("help: `master` is the axis that leads, `slave` the one behind it"),
                "{told}"
            );
        }
    }
}
