//! A story must name the change that was made to a run, from the traces of both alone. Each test runs a script and a
//! changed one, through files as `standstill explain` does.

use super::common::outcome;
use standstill_script::run;
use standstill_trace::story::{Cause, Story, story};
use standstill_trace::{Cell, Trace, jsonl};

const SCRIPT: &str = r#"{"standstill": 1, "title": "There and back", "cycle": "T#1ms", "scans": 600,
  "axes": {"X": {"unit": "mm", "limits": {"velocity": 50, "acceleration": 1000, "jerk": 50000}, "drive": {"ideal": {"delay": 0, "power_on": 1}}}},
  "inputs": {"GO": false},
  "blocks": [
    {"name": "power", "type": "MC_Power", "pins": {"Axis": "X", "Enable": true}},
    {"name": "there", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"all": ["power.Status", "GO"]}, "Position": 4, "Velocity": 50}},
    {"name": "back", "type": "MC_MoveAbsolute", "pins": {"Axis": "X", "Execute": {"from": "there.Done"}, "Position": 0, "Velocity": 25}},
    {"name": "read", "type": "MC_ReadActualPosition", "pins": {"Axis": "X", "Enable": true}}
  ],
  "steps": [{"at": 1, "set": {"GO": true}}],
  "expect": []}"#;

/// The trace of a script as a file has it.
fn trace(script: &str) -> Trace {
    through_a_file(&outcome(script).trace)
}

fn through_a_file(trace: &Trace) -> Trace {
    let mut file = Vec::new();
    jsonl::write(trace, &mut file).expect("a vector takes all");
    let text = String::from_utf8(file).expect("UTF-8");
    jsonl::read(&text).expect("our own").trace
}

/// The story of the script and of a copy in which `from` is replaced.
fn changed(from: &str, to: &str) -> Story {
    assert!(SCRIPT.contains(from), "{from}");
    told(&trace(SCRIPT), &trace(&SCRIPT.replace(from, to)))
}

fn told(expected: &Trace, found: &Trace) -> Story {
    story(expected, found).expect("they differ")
}

/// The likeliest cause.
fn first(story: &Story) -> &Cause {
    story.causes.first().expect("a story has a cause")
}

/// A trace with one column of numbers changed: `change` gets the scan and the value.
fn with(trace: &Trace, name: &str, change: impl Fn(usize, f64) -> f64) -> Trace {
    let column = trace.column(name).expect("there is one");
    with_cells(trace, |scan, at, cell| match cell {
        Cell::Real(value) if at == column => Cell::Real(change(scan, value)),
        other => other,
    })
}

/// A trace with other cells: `change` gets the scan, the column and the cell.
fn with_cells<'t>(trace: &'t Trace, change: impl Fn(usize, usize, Cell<'t>) -> Cell<'t>) -> Trace {
    let mut other = Trace::new(trace.header().clone());
    for scan in 0..trace.scans() {
        let row = trace.row(scan).enumerate();
        let row: Vec<_> = row.map(|(column, cell)| change(scan, column, cell)).collect();
        other.push_row(&row).expect("the same columns");
    }
    other
}

#[test]
fn a_parameter() {
    let story = changed("\"Velocity\": 50}", "\"Velocity\": 40}");
    assert!(matches!(first(&story), Cause::Parameter(_)));
    insta::assert_snapshot!(story);
}

#[test]
fn a_step_that_comes_later_or_earlier() {
    let story = changed("\"at\": 1", "\"at\": 4");
    assert!(matches!(first(&story), Cause::Variable { later: Some(3), .. }));
    insta::assert_snapshot!(story);
    let story = told(&trace(&SCRIPT.replace("\"at\": 1", "\"at\": 4")), &trace(SCRIPT));
    assert!(
        matches!(first(&story), Cause::Variable { later: Some(-3), .. }),
        "{story}"
    );
    let story = changed("[{\"at\": 1, \"set\": {\"GO\": true}}]", "[]");
    assert!(
        matches!(first(&story), Cause::Variable { later: None, .. }),
        "{story}"
    );
}

#[test]
fn a_limit() {
    let story = changed("\"acceleration\": 1000", "\"acceleration\": 800");
    assert!(matches!(first(&story), Cause::Limits(axis, settings) if axis == "X" && settings.len() == 2));
    insta::assert_snapshot!(story);
}

#[test]
fn an_order_of_blocks() {
    let back = "{\"name\": \"back\"";
    let read = "{\"name\": \"read\"";
    let (start, middle) = (
        SCRIPT.find(back).expect("there"),
        SCRIPT.find(read).expect("there"),
    );
    let end = SCRIPT.find("\n  ],\n  \"steps\"").expect("there");
    let text = SCRIPT
        .get(start..middle)
        .expect("in it")
        .trim_end()
        .trim_end_matches(',');
    let there = SCRIPT.find("{\"name\": \"there\"").expect("there");
    let moved = format!(
        "{}{text},\n    {}{}{}",
        &SCRIPT[..there],
        &SCRIPT[there..start],
        &SCRIPT[middle..end],
        &SCRIPT[end..]
    );
    let story = told(&trace(SCRIPT), &trace(&moved));
    assert!(matches!(first(&story), Cause::Order { .. }), "{story}");
    insta::assert_snapshot!(story);
}

#[test]
fn a_fault_of_the_drive() {
    let story = changed(
        "{\"GO\": true}}]",
        "{\"GO\": true}}, {\"at\": 50, \"fault\": {\"axis\": \"X\", \"kind\": \"drive\", \"code\": 7}}]",
    );
    assert!(matches!(first(&story), Cause::Fault { in_found: true, .. }));
    insta::assert_snapshot!(story);
}

#[test]
fn a_shift_in_time() {
    let story = changed("\"power_on\": 1", "\"power_on\": 7");
    assert_eq!(first(&story), &Cause::Shift(6), "{story}");
    insta::assert_snapshot!(story);
    let story = told(
        &trace(&SCRIPT.replace("\"power_on\": 1", "\"power_on\": 7")),
        &trace(SCRIPT),
    );
    assert_eq!(first(&story), &Cause::Shift(-6), "{story}");
}

#[test]
fn other_durations() {
    // Limits say so themselves; without headers only the events do.
    let bare = |script: &str| {
        let mut trace = trace(script);
        let header = standstill_trace::Header::default();
        trace.describe_as(&standstill_trace::Header {
            axes: vec![standstill_trace::Axis {
                name: "X".to_owned(),
                ..Default::default()
            }],
            ..header
        });
        trace
    };
    let story = told(
        &bare(SCRIPT),
        &bare(&SCRIPT.replace("\"acceleration\": 1000", "\"acceleration\": 500")),
    );
    assert!(
        matches!(first(&story), Cause::Drift(first, last) if 0 < *first && first < last),
        "{story}"
    );
}

#[test]
fn another_path_to_the_same_events() {
    let before = trace(SCRIPT);
    let bent = with(&before, "X.Velocity", |scan, value| {
        if scan == 60 { value + 1.0 } else { value }
    });
    let story = told(&before, &bent);
    assert_eq!(first(&story), &Cause::Path);
    insta::assert_snapshot!(story);
}

#[test]
fn rounding() {
    let before = trace(SCRIPT);
    let rounded = with(&before, "X.Velocity", |scan, value| {
        if scan % 10 == 5 {
            value * (1.0 + f64::EPSILON)
        } else {
            value
        }
    });
    let story = told(&before, &rounded);
    assert!(
        matches!(first(&story), Cause::Rounding { share, .. } if *share < 1e-15),
        "{story}"
    );
    insta::assert_snapshot!(story);
}

#[test]
fn the_feedback_of_the_drive() {
    let story = changed("\"delay\": 0", "\"delay\": 1");
    assert!(
        matches!(first(&story), Cause::Feedback(signal) if signal == "X.ActualPosition"),
        "{story}"
    );
    insta::assert_snapshot!(story);
}

#[test]
fn blocks_that_are_not_there() {
    let story = changed("\"name\": \"read\"", "\"name\": \"look\"");
    let gone = Cause::Subjects(vec!["read".to_owned()], vec!["look".to_owned()]);
    assert_eq!(story.causes, [gone]);
    insta::assert_snapshot!(story);
}

#[test]
fn a_cycle_and_a_length() {
    let story = changed("T#1ms", "T#2ms");
    assert_eq!(first(&story), &Cause::Cycle(1_000_000, 2_000_000));
    let story = changed("\"scans\": 600", "\"scans\": 590");
    assert_eq!(story.causes, [Cause::Length(600, 590)]);
    insta::assert_snapshot!(story);
}

#[test]
fn an_event_that_never_comes() {
    // An output that one run does not raise, without any other evidence.
    let before = trace(SCRIPT);
    let done = before.column("back.Done").expect("there");
    let after = with_cells(&before, |_, column, cell| match column == done {
        true => Cell::Bool(false),
        false => cell,
    });
    let story = told(&before, &after);
    let Cause::Events {
        missing: Some(missing),
        new: Some(new),
    } = first(&story)
    else {
        panic!("{story}")
    };
    assert_eq!(
        (missing.text.as_str(), new.text.as_str()),
        ("+Done -Busy -Active", "-Busy -Active")
    );
    insta::assert_snapshot!(story);
}

const CELL: &str = "TYPE E_State : (Idle, Feeding, Ready); END_TYPE
FUNCTION_BLOCK Counter
VAR_INPUT Step : INT; END_VAR
VAR_OUTPUT Value : INT; END_VAR
Value := Value + Step;
END_FUNCTION_BLOCK
PROGRAM Cell
VAR_INPUT Go : BOOL; END_VAR
VAR_OUTPUT State : E_State; Level : LREAL; Marks : ARRAY [0..2] OF BOOL; END_VAR
VAR c : Counter; i : INT; END_VAR
c(Step := 1);
CASE State OF
  Idle: IF Go THEN State := Feeding; END_IF;
  Feeding: IF c.Value >= 10 THEN State := Ready; END_IF;
  Ready: IF NOT Go THEN
    State := Idle;
  END_IF;
END_CASE;
Level := INT_TO_LREAL(c.Value) * 0.5;
FOR i := 0 TO 2 DO Marks[i] := c.Value > i * 4; END_FOR;
END_PROGRAM
";

/// The trace of a script with a program.
fn trace_of_program(source: &str) -> Trace {
    let script = r#"{"standstill": 1, "cycle": "T#1ms", "scans": 40, "axes": {}, "blocks": [],
      "programs": {"cell": {"st": "cell.st", "trace": ["State", "Level", "Marks", "c"]}},
      "steps": [{"at": 3, "set": {"cell.Go": true}}, {"at": 30, "set": {"cell.Go": false}}], "expect": []}"#;
    let nothing = &mut |_: &str| Err("nothing is included".to_owned());
    let script =
        standstill_script::read_with_programs(script, "tests/t.scan.json", &[], nothing, &mut |_| {
            Ok(source.as_bytes().to_vec())
        });
    let script = script.unwrap_or_else(|error| panic!("{error}"));
    through_a_file(&run(&script).unwrap_or_else(|error| panic!("{error}")).trace)
}

/// The line where the difference began, after a change of the program.
fn line_of(from: &str, to: &str) -> Option<String> {
    assert!(CELL.contains(from), "{from}");
    let story = told(
        &trace_of_program(CELL),
        &trace_of_program(&CELL.replace(from, to)),
    );
    story.line.map(|line| line.to_string())
}

#[test]
fn the_line_of_a_program_whose_change_came_first() {
    // Another value, written by the only statement.
    assert_eq!(
        line_of("* 0.5", "* 0.25").unwrap(),
        "cell.Level in scan 0: 0.25 instead of 0.5, written at cell.st:19:1"
    );
    // Of the three statements that write the state, the one that writes this value.
    assert_eq!(
        line_of("c.Value >= 10", "c.Value >= 8").unwrap(),
        "cell.State in scan 7: Ready instead of Feeding, written at cell.st:14:33"
    );
    // An event that no longer happens is reported by the place where it happened.
    assert_eq!(
        line_of("c.Value >= 10", "c.Value >= 12").unwrap(),
        "cell.State in scan 9: it stays Feeding; what was expected makes it Ready at cell.st:14:34"
    );
    assert_eq!(
        line_of("IF NOT Go THEN", "IF FALSE THEN").unwrap(),
        "cell.State in scan 30: it stays Ready; what was expected makes it Idle at cell.st:16:5"
    );
    // An array whose element is chosen at run time, and an input that a call gives; of several lines the first
    // comes first.
    assert_eq!(
        line_of("i * 4", "i * 5").unwrap(),
        "cell.Marks[1] in scan 4: it stays FALSE; what was expected makes it TRUE at cell.st:20:20"
    );
    assert_eq!(
        line_of("Step := 1", "Step := 2").unwrap(),
        "cell.c.Value in scan 0: 2 instead of 1, written at cell.st:5:1"
    );
}

#[test]
fn a_program_that_only_follows_has_no_line() {
    let trace = trace_of_program(CELL);
    for instance in &trace.header().instances {
        assert!(instance.pins.iter().any(|pin| !pin.written.is_empty()));
    }
    let other = with_cells(&trace, |scan, _, cell| match cell {
        Cell::Integer(value) if scan == 5 => Cell::Integer(value + 1),
        other => other,
    });
    assert!(told(&trace, &other).line.is_some());
    // The same in a trace that knows no statements: an older one.
    let mut header = trace.header().clone();
    let pins = header.instances.iter_mut().flat_map(|it| &mut it.pins);
    pins.for_each(|pin| pin.written.clear());
    let bare = |trace: &Trace| {
        let mut bare = Trace::new(header.clone());
        for scan in 0..trace.scans() {
            let row: Vec<_> = trace.row(scan).collect();
            bare.push_row(&row).expect("the same columns");
        }
        bare
    };
    assert_eq!(told(&bare(&trace), &bare(&other)).line, None);
}
