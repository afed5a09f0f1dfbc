//! Scripts that include machine files: the resulting scripts, and messages that name the right file.

use super::cases::GOOD;
use standstill_axis::StartState;
use standstill_script::{ScriptError, read_with};
use std::fmt::Write;

const MACHINE: &str = r#"{
  "standstill": 1,
  "parameters": {"v": 5},
  "axes": {
    "Y": {"unit": "mm", "limits": {"velocity": {"param": "v"}, "acceleration": 20}, "state": "Standstill"}
  },
  "inputs": {"lamp": true},
  "tasks": {"main": {"interval": 1}, "slow": {"interval": 10, "priority": 3}},
  "blocks": [
    {"name": "lift", "type": "MC_MoveAbsolute", "pins": {"Axis": "Y", "Execute": {"from": "lamp"}, "Position": 4}}
  ]
}
"#;

/// A path and its text.
type File<'a> = (&'a str, &'a str);

/// The good script with one more key, beside these files.
fn with(keys: &str, files: &[File<'_>]) -> Result<standstill_script::model::Script, ScriptError> {
    let text = GOOD.replacen("{\n", &format!("{{\n  {keys},\n"), 1);
    read_with(&text, "jobs/jog.scan.json", &[], &mut |wanted| {
        let file = files.iter().find(|(name, _)| *name == wanted);
        file.map(|(_, text)| (*text).to_owned())
            .ok_or_else(|| "there is no such file".to_owned())
    })
}

#[test]
fn entries_of_the_machine_come_before_those_of_the_script() {
    let script = with(r#""include": "m.machine.json""#, &[("m.machine.json", MACHINE)]).unwrap();
    let axes: Vec<_> = script.axes.iter().map(|axis| axis.name.as_str()).collect();
    assert_eq!(axes, ["Y", "X"]);
    let blocks: Vec<_> = script.blocks.iter().map(|block| block.name.as_str()).collect();
    assert_eq!(blocks, ["lift", "m", "n"]);
    let inputs: Vec<_> = script.inputs.iter().map(|input| input.name.as_str()).collect();
    assert_eq!(inputs, ["lamp", "GO", "speed"]);
    assert_eq!(script.tasks.len(), 2);
    assert_eq!(script.parameters["v"], 5.0);
}

#[test]
fn the_hash_is_of_all_files() {
    let keys = r#""include": "m.json""#;
    let hash = |machine: &str| with(keys, &[("m.json", machine)]).unwrap().hash;
    assert_eq!(hash(MACHINE), hash(MACHINE));
    assert_ne!(hash(MACHINE), hash(&MACHINE.replace("\"v\": 5", "\"v\": 6")));
}

#[test]
fn an_override_lays_its_keys_over_those_of_the_machine() {
    let other = r#"{"standstill": 1, "include": "m.json", "override": "lift",
        "blocks": [{"name": "LIFT", "task": "slow", "pins": {"Velocity": 2}}]}"#;
    let keys = r#""include": ["sub/a.json", "sub/m.json"], "override": ["x"]"#;
    let x = r#"{"standstill": 1, "axes": {"x": {"unit": "deg", "limits": {"velocity": 9, "acceleration": 9}}}, "blocks": [],
        "include": "./b/../a.json"}"#;
    let files = [("sub/a.json", other), ("sub/m.json", MACHINE), ("x.json", x)];
    let script = with(
        &keys.replace("sub/m.json", "x.json"),
        &[files[0], files[1], ("a.json", "{\"standstill\": 1}"), files[2]],
    )
    .unwrap();
    let lift = &script.blocks[0];
    assert_eq!((lift.name.as_str(), lift.task), ("LIFT", 1));
    assert_eq!(
        (lift.constants.len(), lift.wires.len()),
        (3, 1),
        "Axis, Position, Velocity; Execute"
    );
    let x = script.axes.iter().find(|axis| axis.name == "x").unwrap();
    assert_eq!((x.unit.as_str(), x.config.limits.velocity), ("deg", 50.0));
    assert_eq!(x.config.start, StartState::Standstill);
}

#[test]
fn a_file_that_two_include_is_read_once() {
    let one = r#"{"standstill": 1, "include": "m.json"}"#;
    let keys = r#""include": ["a.json", "b.json"]"#;
    with(keys, &[("a.json", one), ("b.json", one), ("m.json", MACHINE)]).unwrap();
}

#[test]
fn every_mistake_names_its_file_and_place() {
    let good = ("m.json", MACHINE);
    let include = r#""include": "m.json""#;
    let bent = |old: &str, new: &str| {
        assert!(MACHINE.contains(old));
        MACHINE.replacen(old, new, 1)
    };
    let syntax = bent("\"unit\": \"mm\",", "\"unit\": \"mm\"");
    let key = bent("\"parameters\"", "\"steps\": [], \"parameters\"");
    let value = bent("\"acceleration\": 20", "\"acceleration\": -20");
    let pin = bent("\"Position\": 4", "\"Positon\": 4");
    let version = bent("\"standstill\": 1,", "");
    let taken = bent("\"Y\": {", "\"X\": {").replace("\"Axis\": \"Y\"", "\"Axis\": \"X\"");
    let block = bent("\"name\": \"lift\"", "\"name\": \"m\"");
    let both = bent("\"lamp\"", "\"n\"").replace("\"from\": \"lamp\"", "\"from\": \"n\"");
    let round = r#"{"standstill": 1, "include": "sub/b.json"}"#;
    let back = r#"{"standstill": 1, "include": "../m.json"}"#;
    let cases: Vec<(&str, &str, Vec<File<'_>>)> = vec![
        ("a file that is not there", include, vec![]),
        ("an absolute path", r#""include": "/etc/m.json""#, vec![]),
        ("a path with backslashes", r#""include": "sub\\m.json""#, vec![]),
        ("a number", r#""include": 7"#, vec![]),
        ("no JSON", include, vec![("m.json", &syntax)]),
        ("a list", include, vec![("m.json", "[]")]),
        ("a key of scripts", include, vec![("m.json", &key)]),
        ("no version", include, vec![("m.json", &version)]),
        ("a wrong value", include, vec![("m.json", &value)]),
        ("a wrong pin", include, vec![("m.json", &pin)]),
        ("an axis twice", include, vec![("m.json", &taken)]),
        ("a block twice", include, vec![("m.json", &block)]),
        (
            "an input and a block of one name",
            include,
            vec![("m.json", &both)],
        ),
        (
            "files in a circle",
            include,
            vec![("m.json", round), ("sub/b.json", back)],
        ),
        (
            "an override of nothing",
            r#""include": "m.json", "override": ["lift"]"#,
            vec![good],
        ),
        ("an override without a file", r#""override": ["X"]"#, vec![]),
    ];
    let mut messages = String::new();
    for (title, keys, files) in cases {
        let error = with(keys, &files).expect_err(title);
        assert_eq!(error.diagnostics().len(), 1, "{title}\n{error}");
        let place = error.diagnostics()[0].span.unwrap();
        let (line, column) = error.line_column(place);
        assert!(
            error
                .render()
                .contains(&format!("{}:{line}:{column}", error.file_of(place))),
            "{error}"
        );
        writeln!(messages, "# {title}\n{error}\n").unwrap();
    }
    insta::assert_snapshot!(messages);
}

#[test]
fn the_number_of_files_is_bounded() {
    let names: Vec<String> = (0..64).map(|number| format!("\"{number}.json\"")).collect();
    let include = |count: usize| {
        let keys = format!("\"include\": [{}]", names[..count].join(", "));
        let text = GOOD.replacen("{\n", &format!("{{\n  {keys},\n"), 1);
        read_with(&text, "a.scan.json", &[], &mut |_| {
            Ok("{\"standstill\": 1}".to_owned())
        })
    };
    assert!(include(63).is_ok());
    let error = include(64).unwrap_err();
    assert!(error.render().contains("more than the 64 files"), "{error}");
}

/// Blocks of which each is overridden, tasks of which each has a block: work in proportion, not with the square.
#[test]
fn many_entries_take_work_in_proportion() {
    let many = standstill_testkit::cases(40_000) as usize;
    let each = |text: &dyn Fn(usize) -> String| (0..many).map(text).collect::<Vec<_>>().join(",");
    let blocks = each(&|n| format!(r#"{{"name":"b{n}","type":"R_TRIG"}}"#));
    let machine = format!(r#"{{"standstill":1,"blocks":[{blocks}]}}"#);
    let names = each(&|n| format!(r#""B{n}""#));
    let tasks = each(&|n| format!(r#""t{n}":{{"interval":1}}"#));
    let in_tasks = each(&|n| format!(r#"{{"name":"b{n}","type":"R_TRIG","task":"t{}"}}"#, many - 1 - n));
    let text = format!(
        r#"{{"standstill":1,"cycle":"T#1ms","scans":20,"axes":{{}},"include":"m.machine.json","override":[{names}],
            "tasks":{{{tasks}}},"blocks":[{in_tasks}]}}"#
    );
    let begin = std::time::Instant::now();
    let script = read_with(&text, "a.scan.json", &[], &mut |_| Ok(machine.clone())).unwrap();
    let outcome = standstill_script::run(&script).expect("it runs");
    assert_eq!(outcome.trace.scans(), 20);
    let took = begin.elapsed();
    // All of them take half a second; with the square of the entries it was minutes.
    assert!(took < std::time::Duration::from_secs(30), "{took:?}");
    // Of so many mistakes only the first get the nearest name.
    let begin = std::time::Instant::now();
    let error = read_with(&text.replace(":\"t", ":\"u"), "a.scan.json", &[], &mut |_| {
        Ok(machine.clone())
    });
    assert_eq!(error.expect_err("no such task").diagnostics().len(), many);
    let took = begin.elapsed();
    assert!(took < std::time::Duration::from_secs(30), "{took:?}");
}
