//! `test` of some scripts only, of none, and again and again.

use crate::support::{SCRIPT, command, standstill, with_script, write};
use std::fs;
use std::io::{BufRead as _, BufReader};
use std::process::Stdio;

#[test]
fn a_word_picks_scripts_and_list_only_names_them() {
    let folder = with_script("test_some");
    fs::create_dir_all(folder.join("Press")).unwrap();
    write(&folder, "Press/close.scan.json", SCRIPT);
    write(&folder, "broken.scan.json", "{");
    write(&folder, "gone.snap", "");
    let run = |arguments: &[&str]| {
        let mut parts = vec!["test"];
        parts.extend(arguments);
        standstill(&folder, &parts)
    };
    let all = run(&["--list", "."]);
    assert_eq!(all.status, 0, "{}", all.err);
    assert_eq!(
        all.out,
        "./Press/close.scan.json\n./broken.scan.json\n./move.scan.json\n"
    );
    assert_eq!(run(&["--list", "-k", "press"]).out, "./Press/close.scan.json\n");
    // Neither the broken script nor the golden without a script is asked for.
    let some = run(&["-k", "PRESS", "--golden", "none"]);
    assert_eq!(
        (some.status, some.out.as_str()),
        (0, "ok        ./Press/close.scan.json\n1 script: 1 passed\n")
    );
    let none = run(&["-k", "pres s"]);
    assert_eq!((none.status, none.out.as_str()), (2, ""));
    assert!(
        none.err
            .contains("-k pres s: none of 3 scripts has that in its path; `--list` prints them"),
        "{}",
        none.err
    );
    let mutants = run(&["--mutate", "-k", "press"]);
    assert_eq!(mutants.status, 0, "{}", mutants.err);
    assert!(!mutants.out.contains("move.scan.json"), "{}", mutants.out);
    assert_eq!(run(&["--list", "--accept"]).status, 2);
}

#[test]
fn what_was_saved_is_judged_again_failures_first() {
    let folder = with_script("test_again");
    write(
        &folder,
        "z.scan.json",
        &SCRIPT.replace("\"at\": 21", "\"at\": 19"),
    );
    let mut command = command(&["test", "--watch", "--golden", "none", "--report", "pages"]);
    let piped = command
        .current_dir(&folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // The names of the scripts as they were judged, up to the line with the counts.
    let mut round = || {
        let mut judged = Vec::new();
        for line in lines.by_ref() {
            let line = line.unwrap();
            if line.contains("2 scripts: ") {
                return (judged, line);
            }
            let verdict = ["ok ", "FAILED"].iter().any(|word| line.starts_with(word));
            judged.extend(verdict.then(|| line.rsplit('/').next().unwrap_or_default().to_owned()));
        }
        panic!("it ended: {judged:?}");
    };
    let (judged, counts) = round();
    assert_eq!(judged, ["move.scan.json", "z.scan.json"]);
    assert_eq!(counts, "2 scripts: 1 passed, 1 failed");
    // What it wrote itself, the page, starts nothing; a script that is saved does.
    write(
        &folder,
        "move.scan.json",
        &SCRIPT.replace("One short move", "One more short move"),
    );
    let (judged, counts) = round();
    assert_eq!(judged, ["z.scan.json", "move.scan.json"]);
    assert_eq!(counts, "2 scripts: 1 passed, 1 failed");
    write(&folder, "z.scan.json", SCRIPT);
    assert_eq!(round().1, "2 scripts: 2 passed");
    child.kill().unwrap();
    child.wait().unwrap();
}
