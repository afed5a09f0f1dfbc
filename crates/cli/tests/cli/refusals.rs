//! The output and the remaining files of a command that cannot do its work.

use crate::support::{LONG, SCRIPT, late, read, scratch, standstill, typed, with_script, write};
use std::fs;

#[test]
fn with_json_every_answer_is_an_object() {
    let folder = with_script("refusals_json");
    fs::create_dir(folder.join("empty")).expect("a folder");
    write(&folder, "late.scan.json", &late());
    write(&folder, "dense.scan.json", "{");
    write(&folder, "p.st", "PROGRAM p\nx := 1;\nEND_PROGRAM\n");
    for (arguments, command, status) in [
        (&["test", "empty"][..], "test", 2),
        (&["test", "absent"], "test", 4),
        (&["test", "-k", "nowhere", "."], "test", 2),
        (&["test", "--golden", "none", "--abs", "1", "."], "test", 2),
        (&["test", "--mutate", "empty"], "test", 2),
        (
            &["test", "--recording", "absent.csv", "move.scan.json"],
            "test",
            4,
        ),
        (&["test", "--junit", "absent/a.xml", "move.scan.json"], "test", 4),
        (&["test", "--no-such-option"], "test", 2),
        (&["run"], "run", 2),
        (&["run", "--trace", "a.txt", "move.scan.json"], "run", 2),
        (&["run", "absent.st"], "run", 4),
        (&["explain", "a.csv"], "explain", 2),
        (&["explain", "absent.csv", "absent.csv"], "explain", 4),
        (&["identify", "absent.csv"], "identify", 4),
        (
            &["cam", "check", "absent.csv", "--axis", "move.scan.json#X"],
            "cam check",
            4,
        ),
        (&["cam", "check"], "cam check", 2),
        (&["st", "check", "absent.st"], "st check", 4),
        (&["st", "lint", "absent.st"], "st lint", 4),
        (&["blocks", "MC_Nothing"], "blocks", 2),
    ] {
        let ended = standstill(&folder, &[arguments, &["--json"]].concat());
        assert_eq!(ended.status, status, "{arguments:?}: {}", ended.err);
        let answer = ended.answer();
        assert_eq!(answer["command"], command, "{arguments:?}");
        assert_eq!(answer["passed"], false, "{arguments:?}");
        assert_eq!(answer["status"], status, "{arguments:?}");
        let error = answer["error"].as_str().expect("why");
        assert_eq!(error, ended.err.trim_end(), "{arguments:?}");
    }
    // One script of several that cannot be read has its entry.
    for arguments in [&["test", "--golden", "none"][..], &["test", "--mutate"], &["run"]] {
        let scripts = ["--json", "move.scan.json", "dense.scan.json"];
        let ended = standstill(&folder, &[arguments, &scripts].concat());
        assert_eq!(ended.status, 3, "{}", ended.err);
        let answer = ended.answer();
        assert_eq!(answer["scripts"][1]["verdict"], "broken", "{answer}");
        assert!(answer["scripts"][1]["error"].is_string(), "{answer}");
    }
    // The name of another command is a word like any other.
    let ended = standstill(&folder, &["report", "run", "--json"]);
    assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{}", ended.err);
    let checked = standstill(&folder, &["st", "check", "--json", "p.st"]);
    assert_eq!(checked.status, 3);
    assert_eq!(checked.answer()["diagnostics"][0]["code"], "unknown_name");
}

#[test]
fn with_json_a_time_limit_is_an_answer() {
    let folder = scratch("refusals_time");
    write(&folder, "long.scan.json", LONG);
    for name in ["run", "test"] {
        let arguments = ["--time-limit", "300ms", name, "--json", "long.scan.json"];
        let ended = standstill(&folder, &arguments);
        assert_eq!(ended.status, 1);
        let answer = ended.answer();
        assert_eq!(answer["command"], name);
        assert_eq!(answer["status"], 1);
        assert_eq!(answer["error"].as_str(), Some(ended.err.trim_end()));
        ended.complains("the time is up");
    }
}

/// The names in a folder.
fn names(folder: &std::path::Path) -> Vec<String> {
    let all = fs::read_dir(folder).expect("a folder").flatten();
    let mut names: Vec<_> = all
        .map(|entry| entry.file_name().to_string_lossy().into_owned())
        .collect();
    names.sort();
    names
}

#[test]
fn two_outputs_in_one_file_are_refused_before_anything_is_written() {
    let folder = with_script("refusals_two");
    fs::create_dir(folder.join("sub")).expect("a folder");
    write(
        &folder,
        "line.jsonl",
        r#"{"Ts":0.01,"target":1,"limits":{"velocity":1}}"#,
    );
    write(
        &folder,
        "p.st",
        "PROGRAM p\nVAR x : INT; END_VAR\nx := 1;\nEND_PROGRAM\n",
    );
    write(&folder, "cam.csv", "Master,Slave\n0,0\n180,10\n");
    let traced = ["run", "-q", "move.scan.json", "--trace", "t.csv"];
    assert_eq!(standstill(&folder, &traced).status, 0);
    let absolute = folder.join("a.csv").to_string_lossy().into_owned();
    let before = names(&folder);
    let run = &["run", "move.scan.json"][..];
    for (arguments, told) in [
        (
            &[run, &["--trace", "a.csv", "--report", "a.csv"]].concat()[..],
            "--trace and --report are one file, a.csv",
        ),
        (
            &[run, &["--trace", "a.csv", "--svg", "./sub/../a.csv"]].concat(),
            "--trace and --svg are one file",
        ),
        (
            &[run, &["--trace", "a.csv", "--vcd", &absolute]].concat(),
            "--trace and --vcd are one file",
        ),
        (
            &[run, &["--svg", "a", "--vcd", "a"]].concat(),
            "--svg and --vcd are one file, a",
        ),
        (
            &[run, &["--trace", "a.csv", "--svg", "a.csv.meta.json"]].concat(),
            "the header of --trace and --svg are one file, a.csv.meta.json",
        ),
        (
            &[run, &["--report", "sub/../move.scan.json"]].concat(),
            "--report would replace move.scan.json, which is read",
        ),
        (
            &["plan", "line.jsonl", "--samples", "a", "--svg", "./a"],
            "--samples and --svg are one file",
        ),
        (
            &["plan", "line.jsonl", "--samples", "line.jsonl"],
            "--samples would replace line.jsonl, which is read",
        ),
        (
            &["report", "t.csv", "-o", "a", "--svg", "./a"],
            "--output and --svg are one file",
        ),
        (
            &["report", "t.csv", "-o", "t.csv"],
            "--output would replace t.csv, which is read",
        ),
        (
            &["test", ".", "--junit", "a", "--coverage", "./a"],
            "--junit and --coverage are one file",
        ),
        (
            &["test", "move.scan.json", "--junit", "move.scan.json"],
            "--junit would replace move.scan.json, which is read",
        ),
        (
            &["st", "build", "p.st", "-o", "p.st"],
            "--output would replace p.st, which is read",
        ),
        (
            &["cam", "plot", "cam.csv", "--svg", "cam.csv"],
            "--svg would replace cam.csv, which is read",
        ),
    ] {
        let refused = standstill(&folder, arguments);
        assert_eq!(refused.status, 2, "{arguments:?}: {}{}", refused.out, refused.err);
        refused.complains_first(&format!("error: {told}"));
        assert_eq!(refused.out, "", "{arguments:?}");
        assert_eq!(names(&folder), before, "{arguments:?}");
    }
    assert_eq!(read(&folder, "move.scan.json"), SCRIPT);
}

#[test]
#[cfg(unix)]
fn a_link_to_a_folder_is_another_way_to_the_same_file_and_a_device_takes_two() {
    use std::os::unix::fs::symlink;
    let folder = with_script("refusals_links");
    fs::create_dir(folder.join("sub")).expect("a folder");
    symlink("sub", folder.join("other")).expect("a link");
    symlink("move.scan.json", folder.join("link.scan.json")).expect("a link");
    for arguments in [
        "run -q move.scan.json --trace sub/a.csv --report other/a.csv",
        // The target of the link is read, not the link.
        "run -q link.scan.json --svg a.svg --report move.scan.json",
        "run -q link.scan.json --svg a.svg --report link.scan.json",
    ] {
        let refused = typed(&folder, arguments);
        assert_eq!(refused.status, 2, "{arguments}: {}", refused.err);
    }
    assert!(names(&folder.join("sub")).is_empty());
    assert_eq!(read(&folder, "link.scan.json"), SCRIPT);
    assert_eq!(
        typed(
            &folder,
            "run -q move.scan.json --svg /dev/null --report /dev/null"
        )
        .status,
        0
    );
    // A link at the place of an output is replaced, so these are two files.
    symlink("b.svg", folder.join("a.svg")).expect("a link");
    assert_eq!(
        typed(&folder, "run -q move.scan.json --svg a.svg --report b.svg").status,
        0
    );
    assert!(read(&folder, "a.svg").starts_with("<svg"));
    assert!(read(&folder, "b.svg").starts_with("<!"));
}

#[test]
fn a_claim_without_a_value_says_so_and_why() {
    let folder = scratch("refusals_value");
    let script = SCRIPT
        .replace("\"inputs\": {\"GO\": false}", "\"inputs\": {\"GO\": false, \"n\": 0, \"ask\": false}, \"tasks\": {\"main\": {\"interval\": \"T#10ms\", \"priority\": 0}, \"asked\": {\"single\": {\"from\": \"ask\"}, \"priority\": 1}}")
        .replace("\"blocks\": [", "\"blocks\": [\n    {\"name\": \"late\", \"type\": \"MC_MoveAbsolute\", \"task\": \"asked\", \"pins\": {\"Axis\": \"X\", \"Position\": 1, \"Velocity\": 10}},")
        .replace(
            "{\"never\": {\"move.Error\": true}}",
            "{\"at\": 5, \"that\": \"=1 / TRUNC(n) = 1\"}, {\"always\": \"=1 / TRUNC(n) = 1\"}, {\"at\": 5, \"that\": \"=late.Done\"}",
        );
    write(&folder, "value.scan.json", &script);
    let ended = standstill(&folder, &["run", "-q", "value.scan.json"]);
    assert_eq!(ended.status, 1, "{}", ended.err);
    for line in [
        "  expect[1].that.=1 / TRUNC(n) = 1: no value at scan 5, expected TRUE; it was so in no scan\n",
        "  expect[1]: =1 / TRUNC(n) = 1 has no value at scan 5: a division by zero: the dividend is 1\n",
        "  expect[2].always.=1 / TRUNC(n) = 1: no value at scan 0, expected TRUE; it was so in no scan; broken in 30 scans: 0, 1, 2, 3, 4 .. 29\n",
        // It has the value of a block that was never called, and the reason reports this.
        "  expect[3].that.=late.Done: FALSE at scan 5, expected TRUE; it was so in no scan\n",
        "    late is never called: its task asked never runs\n",
    ] {
        ended.prints(line);
    }
}
