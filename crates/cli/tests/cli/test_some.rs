//! `test` of some scripts, of none, and repeatedly.

use crate::support::{Ended, SCRIPT, command, ended, fed_to, late, standstill, with_script, write};
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
    // Neither the broken script nor the golden without a script is requested.
    let some = run(&["-k", "PRESS", "--golden", "none"]);
    assert_eq!(
        (some.status, some.out.as_str()),
        (0, "ok        ./Press/close.scan.json\n1 script: 1 passed\n")
    );
    let none = run(&["-k", "pres s"]);
    assert_eq!((none.status, none.out.as_str()), (2, ""));
    none.complains("-k pres s: none of 3 scripts has that in its path; `--list` prints them");
    let mutants = run(&["--mutate", "-k", "press"]);
    assert_eq!(mutants.status, 0, "{}", mutants.err);
    assert!(!mutants.out.contains("move.scan.json"), "{}", mutants.out);
    assert_eq!(run(&["--list", "--accept"]).status, 2);
}

#[test]
fn what_was_saved_is_judged_again_failures_first() {
    let folder = with_script("test_again");
    write(&folder, "z.scan.json", &late());
    let mut command = command(&["test", "--watch", "--golden", "none", "--report", "pages"]);
    let piped = command
        .current_dir(&folder)
        .stdout(Stdio::piped())
        .stderr(Stdio::piped());
    let mut child = piped.spawn().unwrap();
    let mut lines = BufReader::new(child.stdout.take().unwrap()).lines();
    // The names of the scripts in the order of judging, up to the line with the counts.
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
    // The page, which it wrote itself, starts nothing; a saved script does.
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

#[test]
fn a_review_asks_for_each_golden_that_differs_and_takes_only_what_is_answered_yes() {
    let folder = with_script("test_review");
    write(&folder, "b.scan.json", SCRIPT);
    write(&folder, "broken.scan.json", "{");
    write(&folder, "c.scan.json", &late());
    let review = |answers: &str| {
        let mut command = command(&["test", "--review"]);
        let Ended { status, out, err } = fed_to(command.current_dir(&folder), answers.as_bytes());
        (status, out, err)
    };
    // After an invalid answer it asks again; goldens that were not reviewed stay unchanged.
    let (status, out, err) = review("perhaps\nno\nq\n");
    assert_eq!(status, 3, "{out}{err}");
    assert!(
        out.starts_with("differs   ./b.scan.json\n    golden: there is no golden yet\n"),
        "{out}"
    );
    assert_eq!(
        err.matches("take it as the golden? yes, no, or quit").count(),
        3,
        "{err}"
    );
    assert!(out.ends_with("4 scripts: 3 failed, 1 broken\n"), "{out}");
    let is_there = |name: &str| folder.join(name).exists();
    assert!(!is_there("b.snap") && !is_there("move.snap") && !is_there("b.snap.new"));
    // It does not ask about a script whose claims fail.
    let (_, out, err) = review("y\n");
    assert!(out.contains("accepted  ./b.scan.json\n"), "{out}");
    assert_eq!(err.matches("take it as the golden?").count(), 2, "{err}");
    assert!(is_there("b.snap") && !is_there("move.snap") && !is_there("c.snap"));
    let (_, out, _) = review("yes\n");
    assert!(
        out.contains("ok        ./b.scan.json\n") && out.contains("accepted  ./move.scan.json\n"),
        "{out}"
    );
    // Without a reviewer nothing is accepted.
    let under_ci = ended(
        command(&["test", "--review"])
            .current_dir(&folder)
            .env("CI", "true"),
    );
    assert_eq!(under_ci.status, 2, "{}", under_ci.err);
    for other in ["--accept", "--json", "--watch"] {
        assert_eq!(
            standstill(&folder, &["test", "--review", other]).status,
            2,
            "{other}"
        );
    }
}

#[test]
fn a_terminal_has_colours_and_nothing_else_has() {
    let folder = with_script("test_colours");
    write(&folder, "broken.scan.json", "{\"standstill\": 1");
    let with = |variables: &[(&str, &str)], arguments: &[&str]| {
        let mut command = command(arguments);
        command.current_dir(&folder).envs(variables.iter().copied());
        ended(&mut command)
    };
    let test = &["test", "--golden", "none"];
    let plain = with(&[], test);
    assert!(
        !plain.out.contains('\u{1b}') && !plain.err.contains('\u{1b}'),
        "{plain:?}"
    );
    let forced = with(&[("CLICOLOR_FORCE", "1")], test);
    forced.prints("\u{1b}[32mok\u{1b}[0m        ./move.scan.json\n");
    forced.prints("\u{1b}[31mBROKEN\u{1b}[0m    ./broken.scan.json\n");
    forced.complains("\u{1b}[31merror\u{1b}[0m");
    let stripped = |text: &str| {
        let mut parts = text.split('\u{1b}');
        let first = parts.next().unwrap().to_owned();
        parts.fold(first, |all, part| all + part.split_once('m').unwrap().1)
    };
    assert_eq!(
        (stripped(&forced.out), stripped(&forced.err)),
        (plain.out.clone(), plain.err.clone())
    );
    let without = with(&[("CLICOLOR_FORCE", "1"), ("NO_COLOR", "1")], test);
    assert_eq!((without.out, without.err), (plain.out, plain.err));
    // Data have no colours, for any setting.
    let json = with(&[("CLICOLOR_FORCE", "1")], &["run", "--json", "move.scan.json"]);
    assert!(!json.out.contains('\u{1b}'), "{}", json.out);
}

#[test]
fn what_is_not_there_was_probably_something_that_is() {
    let folder = with_script("test_meant");
    fs::create_dir_all(folder.join("scan-tests/press")).unwrap();
    write(&folder, "scan-tests/press/close.scan.json", SCRIPT);
    for (arguments, meant) in [
        (&["test", "scan-test"][..], "scan-tests"),
        (&["test", "scan-tests/pres"], "scan-tests/press"),
        (
            &["run", "scan-tests/pres/close.scan.json"],
            "scan-tests/press/close.scan.json",
        ),
        (&["run", "mov.scan.json"], "move.scan.json"),
        (&["explain", "move.scan.jso", "move.scan.json"], ""),
    ] {
        let ended = standstill(&folder, arguments);
        let told = format!("; did you mean `{meant}`?");
        assert_eq!(
            ended.err.contains(&told),
            !meant.is_empty(),
            "{arguments:?}: {}",
            ended.err
        );
    }
    let other = standstill(&folder, &["test", "elsewhere"]);
    assert_eq!(other.status, 4);
    assert!(!other.err.contains("did you mean"), "{}", other.err);
    let slip = standstill(&folder, &["tset"]);
    assert_eq!(slip.status, 2);
    slip.complains("'test'");
}
