//! A run that leaves out idle programs equals the run scan by scan, to the bit: the same rows, notes and verdicts.
//! Random scripts over ideal drives and mechanisms, with software limits, turns, overrides, blended moves,
//! vibration, masters, timers, faults, steps that wait for rows and an early end. The steps that follow show the
//! remaining state of an axis.

use serde_json::{Value, json};
use standstill_script::model::Script;
use standstill_script::suite::{Allowed, read_given};
use standstill_script::{Ahead, Kept, Outcome, Session};
use standstill_testkit::Random;
use standstill_trace::{Note, digest, extremes_text};
use std::path::Path;

/// The compared data of a run.
#[derive(Debug, PartialEq)]
struct Told {
    scans: usize,
    digest: u64,
    extremes: String,
    notes: Vec<Note>,
    verdicts: Verdicts,
}

/// Whether each claim is fulfilled, and the reasons against it.
type Verdicts = Vec<(bool, Vec<String>)>;

fn told(outcome: &Outcome) -> Told {
    let words = |verdict: &standstill_script::Verdict| {
        let failures = verdict.failures.iter().map(ToString::to_string);
        (verdict.passed(), failures.collect())
    };
    Told {
        scans: outcome.trace.scans(),
        digest: digest::whole(&outcome.trace),
        extremes: extremes_text(&outcome.trace),
        notes: outcome.trace.notes().to_vec(),
        verdicts: outcome.verdicts.iter().map(words).collect(),
    }
}

/// The run scan by scan.
fn by_scan(script: &Script) -> Outcome {
    let mut session = Session::new(script).unwrap_or_else(|error| panic!("{error}"));
    while session.advance().unwrap_or_else(|error| panic!("{error}")) {}
    session.finish()
}

/// The run far ahead, and the number of scans without programs.
fn far(script: &Script, random: &mut Random) -> Option<(Told, u64)> {
    let mut session = Session::new(script).unwrap_or_else(|error| panic!("{error}"));
    let mut left_out = 0;
    loop {
        let most = 1 + random.below(300);
        match session
            .advance_far(most)
            .unwrap_or_else(|error| panic!("{error}"))
        {
            Ahead::Broken => return None,
            Ahead::Scans(0) => break,
            Ahead::Scans(scans) => left_out += scans - 1,
        }
    }
    Some((told(&session.finish()), left_out))
}

/// The run far ahead with all columns except actual positions, whose drives need not be served. Returns the
/// verdicts and differences, and the number of scans without programs.
fn far_without_drives(
    script: &Script,
    whole: &Outcome,
    random: &mut Random,
) -> Option<(Verdicts, String, u64)> {
    let names = whole.trace.columns().iter().map(|column| column.name.clone());
    let names: Vec<String> = names.filter(|name| !name.ends_with("ActualPosition")).collect();
    let mut session =
        Session::keeping(script, Kept::read(script, &names)).unwrap_or_else(|error| panic!("{error}"));
    let mut left_out = 0;
    loop {
        match session
            .advance_far(1 + random.below(300))
            .unwrap_or_else(|error| panic!("{error}"))
        {
            Ahead::Broken => return None,
            Ahead::Scans(0) => break,
            Ahead::Scans(scans) => left_out += scans - 1,
        }
    }
    let outcome = session.finish();
    let trace = &outcome.trace;
    let of = |name: &String| (trace.column(name), whole.trace.column(name));
    let mut different = names.iter().filter_map(|name| match of(name) {
        (Some(one), Some(other)) => {
            let scan = trace
                .cells(one)
                .zip(whole.trace.cells(other))
                .position(|(one, other)| one != other);
            scan.map(|scan| format!("{name} in scan {scan}"))
        }
        _ => Some(format!("{name} is missing")),
    });
    let first = different.next().unwrap_or_default();
    assert_eq!(trace.scans(), whole.trace.scans());
    Some((told(&outcome).verdicts, first, left_out))
}

const AXES: [&str; 3] = ["X", "Y", "Z"];

fn axis(random: &mut Random) -> Value {
    let mut axis = json!({
        "unit": "mm",
        "limits": {"velocity": 50, "acceleration": random.log(50.0, 2000.0)},
        "position": if random.one_in(2) { 0.0 } else { random.between(-20.0, 20.0) },
    });
    if random.one_in(2) {
        axis["limits"]["deceleration"] = json!(random.log(50.0, 2000.0));
    }
    if !random.one_in(3) {
        axis["limits"]["jerk"] = json!(random.log(1e3, 1e6));
        if random.one_in(2) {
            axis["limits"]["snap"] = json!(random.log(1e5, 1e9));
        }
    }
    if random.one_in(4) {
        axis["state"] = json!("Standstill");
    }
    match random.below(8) {
        0 => axis["software_limits"] = json!({"min": -40, "max": 30}),
        1 => axis["modulo"] = json!(36),
        2 if axis["limits"].get("deceleration").is_none() => {
            axis["vibration"] = json!([{"frequency": random.between(5.0, 40.0), "shaper": "zv"}])
        }
        3 => axis["scaling"] = json!({"increments": 1000, "units": 1}),
        4 => axis["max_following_error"] = json!(5),
        _ => {}
    }
    match random.below(6) {
        0 => axis["drive"] = json!({"ideal": {"delay": random.below(6), "power_on": random.below(5)}}),
        1 => {
            axis["drive"] = json!({"plant": {"inertia": 0.02, "viscous": 0.01, "coulomb": 0.05,
                "load": {"inertia": 0.05, "stiffness": 2000, "damping": 0.1}}});
        }
        2 => axis["drive"] = json!({"ideal": {"limit_switches": {"negative": -30, "positive": 25}}}),
        _ => {}
    }
    axis
}

/// A step at a scan that changes some of the items.
fn step(random: &mut Random, scan: u64, axes: usize) -> Value {
    let when = match random.below(12) {
        0 => json!({"when": {format!("{}.Velocity", AXES[random.place(axes)]): {"gt": 10}}}),
        1 => {
            json!({"when": {format!("{}.State", AXES[random.place(axes)]): "Standstill"}, "after": random.below(200)})
        }
        _ => json!({"at": scan}),
    };
    let mut step = when;
    let axis = AXES[random.place(axes)];
    match random.below(24) {
        0 => {
            step["fault"] = json!({"axis": axis, "kind": random.one_of(&["drive", "power", "communication", "axis"]), "code": 7})
        }
        1 => step["clear"] = json!({"axis": axis}),
        _ => {
            let input = random.one_of(&[
                "GO", "AGAIN", "ENDLESS", "HALT", "RESET", "WAIT", "GO", "AGAIN", "slow", "way", "POWER",
            ]);
            let value = match input {
                "slow" => json!(random.one_of(&[1.0, 0.5, 0.25, 0.0, 1.0])),
                "way" => json!(random.between(-25.0, 25.0)),
                "POWER" => json!(!random.one_in(4)),
                _ => json!(random.one_in(2)),
            };
            step["set"] = json!({input: value});
        }
    }
    step
}

fn blocks(random: &mut Random, axes: usize) -> Vec<Value> {
    let mut blocks = Vec::new();
    for (place, axis) in AXES.iter().enumerate().take(axes) {
        let name = |name: &str| format!("{name}{place}");
        blocks.push(json!({"name": name("power"), "type": "MC_Power", "pins": {"Axis": axis, "Enable": {"from": "POWER"}}}));
        blocks.push(json!({"name": name("go"), "type": "MC_MoveAbsolute", "pins": {"Axis": axis, "Execute": {"from": "GO"},
            "Position": {"from": "way"}, "Velocity": random.between(1.0, 50.0), "ContinuousUpdate": random.one_in(2)}}));
        blocks.push(json!({"name": name("on"), "type": random.one_of(&["MC_MoveRelative", "MC_MoveAdditive"]),
            "pins": {"Axis": axis, "Execute": {"from": "AGAIN"}, "Distance": random.between(-10.0, 10.0), "Velocity": random.between(1.0, 50.0),
            "BufferMode": random.one_of(&["mcAborting", "mcBuffered", "mcBlendingLow", "mcBlendingNext", "mcBlendingHigh"])}}));
        blocks.push(json!({"name": name("round"), "type": "MC_MoveVelocity", "pins": {"Axis": axis, "Execute": {"from": "ENDLESS"},
            "Velocity": random.between(1.0, 50.0)}}));
        blocks.push(json!({"name": name("halt"), "type": random.one_of(&["MC_Halt", "MC_Stop"]), "pins": {"Axis": axis, "Execute": {"from": "HALT"}}}));
        blocks.push(json!({"name": name("reset"), "type": "MC_Reset", "pins": {"Axis": axis, "Execute": {"from": "RESET"}}}));
        if random.one_in(2) {
            blocks.push(json!({"name": name("speed"), "type": "MC_SetOverride", "pins": {"Axis": axis, "Enable": true, "VelFactor": {"from": "slow"}}}));
        }
        if random.one_in(2) {
            let read = random.one_of(&[
                "MC_ReadActualPosition",
                "MC_ReadActualVelocity",
                "MC_ReadMotionState",
                "MC_ReadStatus",
            ]);
            blocks.push(json!({"name": name("read"), "type": read, "pins": {"Axis": axis, "Enable": true}}));
        }
        if random.one_in(4) {
            blocks.push(
                json!({"name": name("then"), "type": "MC_MoveAbsolute", "pins": {"Axis": axis,
                "Execute": {"from": name("go") + ".Done"}, "Position": 3, "Velocity": 20}}),
            );
        }
    }
    if random.one_in(3) {
        let kind = random.one_of(&["TON", "TOF", "TP"]);
        blocks.push(json!({"name": "t", "type": kind, "pins": {"IN": {"from": "WAIT"}, "PT": "T#130ms"}}));
    }
    if axes > 1 && random.one_in(5) {
        blocks.push(json!({"name": "gear", "type": "MC_GearIn", "pins": {"Master": "X", "Slave": "Y", "Execute": {"from": "WAIT"}}}));
    }
    let end = blocks.len();
    for place in 1..end {
        if random.one_in(3) {
            blocks.swap(place - 1, place);
        }
    }
    blocks
}

fn script(random: &mut Random) -> Value {
    let count = 1 + random.place(3);
    let scans = 600 + random.below(1500);
    let axes = AXES
        .iter()
        .take(count)
        .map(|name| ((*name).to_owned(), axis(random)));
    let axes: serde_json::Map<String, Value> = axes.collect();
    let mut at = 0;
    let mut steps = vec![json!({"at": 3, "set": {"POWER": true}})];
    while at < scans {
        steps.push(step(random, at, count));
        at += random.below(250);
    }
    let reading = if random.one_in(2) {
        "X.ActualPosition"
    } else {
        "X.Position"
    };
    let mut script = json!({
        "standstill": 1, "title": "Random", "cycle": "T#1ms", "scans": scans, "golden": false,
        "axes": axes,
        "inputs": {"GO": false, "AGAIN": false, "ENDLESS": false, "HALT": false, "RESET": false, "WAIT": false, "POWER": false,
            "slow": 1.0, "way": 10.0},
        "blocks": blocks(random, count),
        "steps": steps,
        "expect": [
            {"always": {"X.Position": {"le": random.between(0.0, 20.0)}}},
            {"never": {"X.Velocity": {"gt": random.between(0.0, 50.0), "lt": 60}}},
            {"always": {reading: {"near": 0, "within": 15}}, "while": {"go0.Busy": true}},
            {"by": scans / 2, "that": {"go0.Done": true}},
            {"once": {"go0.Done": true, "X.Velocity": 0}},
            {"at": scans / 3, "that": {"X.State": "Standstill"}},
            {"exclusive": ["go0.Done", "go0.Busy", "on0.Busy"]},
            {"when": {"GO": true}, "within": random.below(400), "that": {"go0.Done": true}},
            {"never": {"X.State": "DiscreteMotion"}, "for": 1 + random.below(300)},
            {"duration": [{"go0.Busy": true}, {"go0.Busy": false}], "le": random.below(600), "each": true},
            {"count": {"on0.Busy": true}, "eq": 2},
            {"within_limits": "X", "factor": random.one_of(&[1.0, 0.5])},
            {"from": {"when": {"X.Velocity": {"gt": 5}}}, "to": {"when": {"X.State": "Standstill"}}, "always": {"X.Acceleration": {"abs_le": 200}}},
        ],
    });
    if random.one_in(6) {
        // A timer, if there is one, is called in every third scan.
        script["tasks"] = json!({"main": {"interval": 1}, "slow": {"interval": 3}});
        for block in script["blocks"].as_array_mut().into_iter().flatten() {
            if block["name"] == "t" {
                block["task"] = json!("slow");
            }
        }
    }
    if random.one_in(5) {
        script["stop_when"] = json!({"X.Position": {"ge": random.between(5.0, 20.0)}});
        script["after"] = json!(random.below(100));
    }
    script
}

#[test]
fn random_runs_far_ahead_are_the_runs_scan_by_scan() {
    let (mut scans, mut left_out, mut broken, mut refused) = (0, 0, 0, 0);
    let count = standstill_testkit::soak(standstill_testkit::cases(150));
    for seed in 0..count {
        let mut random = Random(seed);
        let text = script(&mut random).to_string();
        let script = match read_given(&text, Path::new("random.scan.json"), &[], &Allowed::default()) {
            Ok(script) => script,
            Err(error) => {
                assert!(refused < count / 20, "{error}\n{text}");
                refused += 1;
                continue;
            }
        };
        let whole = by_scan(&script);
        let expected = told(&whole);
        scans += 2 * expected.scans as u64;
        match far(&script, &mut random) {
            Some((found, rested)) => {
                assert_eq!(found, expected, "seed {seed}\n{text}");
                left_out += rested;
            }
            None => broken += 1,
        }
        match far_without_drives(&script, &whole, &mut random) {
            Some((verdicts, different, rested)) => {
                assert_eq!(different, "", "seed {seed}\n{text}");
                assert_eq!(verdicts, expected.verdicts, "seed {seed}\n{text}");
                left_out += rested;
            }
            None => broken += 1,
        }
    }
    println!(
        "{left_out} of {scans} scans without programs, {broken} of {count} broken off, {refused} refused"
    );
    assert!(
        left_out > scans / 5,
        "{left_out} of {scans} scans without programs"
    );
    assert!(broken <= count / 50, "{broken} runs of {count} are broken off");
}

/// An endless motion over 180 scans. Then positions leave the range of numbers, and the axis fails in a scan
/// without programs.
#[test]
fn a_run_that_is_broken_off_is_done_again_scan_by_scan() {
    let text = json!({
        "standstill": 1, "title": "Out of numbers", "cycle": "T#1s", "scans": 400, "golden": false,
        "axes": {"X": {"unit": "m", "limits": {"velocity": 1e306, "acceleration": 1e306}, "state": "Standstill"}},
        "inputs": {"GO": false},
        "blocks": [{"name": "move", "type": "MC_MoveVelocity",
            "pins": {"Axis": "X", "Execute": {"from": "GO"}, "Velocity": 1e306}}],
        "steps": [{"at": 5, "set": {"GO": true}}],
        "expect": [{"at": 186, "that": {"X.State": "ErrorStop", "move.Error": true}}],
    })
    .to_string();
    let script = read_given(&text, Path::new("out.scan.json"), &[], &Allowed::default())
        .unwrap_or_else(|error| panic!("{error}"));
    let whole = by_scan(&script);
    assert!(whole.passed());
    assert_eq!(far(&script, &mut Random(1)), None);
    assert_eq!(far_without_drives(&script, &whole, &mut Random(1)), None);
    let done = standstill_script::run(&script).unwrap_or_else(|error| panic!("{error}"));
    assert_eq!(told(&done), told(&whole));
}
