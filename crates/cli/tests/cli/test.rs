//! Scripts as tests.

use crate::support::{SCRIPT, command, ended, late, read, scratch, standstill, typed, with_script, write};
use std::fs;
use std::path::Path;

#[test]
fn a_golden_is_accepted_once_and_judges_from_then_on() {
    let folder = with_script("test_accept");
    let missing = standstill(&folder, &["test", "."]);
    assert_eq!(missing.status, 1);
    missing.prints("FAILED    ./move.scan.json\n    golden: there is no golden yet\n");
    let accepted = standstill(&folder, &["test", "--accept", "."]);
    assert_eq!((accepted.status, accepted.err.as_str()), (0, ""));
    assert_eq!(accepted.out, "accepted  ./move.scan.json\n1 script: 1 accepted\n");
    let passed = standstill(&folder, &["test", "."]);
    assert_eq!(
        (passed.status, passed.out.as_str()),
        (0, "ok        ./move.scan.json\n1 script: 1 passed\n")
    );
    // Another run with the same claims: Done comes in the same scan, the position differs in one scan.
    write(
        &folder,
        "move.scan.json",
        &SCRIPT.replace(
            "\"GO\": true}}",
            "\"GO\": true}}, {\"at\": 25, \"set\": {\"GO\": false}}",
        ),
    );
    let differs = standstill(&folder, &["test", "."]);
    assert_eq!(differs.status, 1);
    assert!(
        differs.out.contains("first difference in scan 25")
            && differs.out.contains(
                "    why\n      another input: GO is FALSE instead of TRUE; look at: the steps that set it"
            ),
        "{}",
        differs.out
    );
}

#[test]
fn a_golden_of_version_1_passes_with_the_command_that_renews_it() {
    let folder = scratch("test_version_1");
    let kept = Path::new(env!("CARGO_MANIFEST_DIR")).join("../script/tests/version_1");
    for ending in ["scan.json", "snap", "exact"] {
        let name = format!("abort.{ending}");
        fs::copy(kept.join(&name), folder.join(&name)).unwrap();
    }
    let old = standstill(&folder, &["test", "abort.scan.json"]);
    let command = "standstill test --accept abort.scan.json";
    let note = format!("    a golden of version 1, met; this renews it: {command}\n");
    let passed = "ok        abort.scan.json\n";
    assert_eq!(
        (old.status, old.out),
        (0, format!("{passed}{note}1 script: 1 passed\n"))
    );
    let renewed = standstill(&folder, &command.split(' ').skip(1).collect::<Vec<_>>());
    assert_eq!(renewed.out, "accepted  abort.scan.json\n1 script: 1 accepted\n");
    let new = standstill(&folder, &["test", "abort.scan.json"]);
    assert_eq!(
        (new.status, new.out),
        (0, format!("{passed}1 script: 1 passed\n"))
    );
}

#[test]
fn the_default_is_scan_tests_or_what_is_in_the_folder() {
    let folder = scratch("test_default");
    let nothing = standstill(&folder, &["test"]);
    assert_eq!(nothing.status, 2);
    let told = "error: .: there is no .scan.json file in it; `standstill init` writes a first one\n";
    nothing.complains_first(told);
    write(&folder, "here.scan.json", SCRIPT);
    let here = standstill(&folder, &["test", "--golden", "none"]);
    assert_eq!(here.out, "ok        ./here.scan.json\n1 script: 1 passed\n");
    fs::create_dir_all(folder.join("scan-tests/moves")).unwrap();
    let empty = standstill(&folder, &["test"]);
    assert_eq!(empty.status, 2);
    let told = "scan-tests: there is no .scan.json file in it";
    empty.complains(told);
    write(&folder, "scan-tests/moves/move.scan.json", SCRIPT);
    assert_eq!(standstill(&folder, &["test", "--accept"]).status, 0);
    let passed = standstill(&folder, &["test"]);
    assert_eq!(
        passed.out,
        "ok        scan-tests/moves/move.scan.json\n1 script: 1 passed\n"
    );
}

#[test]
fn nothing_is_accepted_under_ci_or_against_the_claims() {
    let folder = scratch("test_refused");
    write(&folder, "late.scan.json", &late());
    let claims = standstill(&folder, &["test", "--accept", "late.scan.json"]);
    assert_eq!(claims.status, 1);
    claims.prints("golden: not accepted: claims fail");
    let ci = ended(
        command(&["test", "--accept", "late.scan.json"])
            .current_dir(&folder)
            .env("CI", "true"),
    );
    assert_eq!((ci.status, ci.out.as_str()), (2, ""));
    ci.complains("goldens are not accepted under CI");
    assert!(!folder.join("late.snap").exists());
}

#[test]
fn orphans_fail_and_broken_scripts_do_not_hide_the_others() {
    let folder = with_script("test_orphan");
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    fs::copy(folder.join("move.snap"), folder.join("gone.snap")).unwrap();
    let orphan = standstill(&folder, &["test", "."]);
    assert_eq!(orphan.status, 1);
    orphan.prints("ORPHAN    ./gone.snap\n");
    assert!(orphan.out.ends_with("1 script: 1 passed, 1 orphaned\n"));
    // A script of another name also has its golden.
    fs::copy(folder.join("move.scan.json"), folder.join("gone.json")).unwrap();
    let kept = standstill(&folder, &["test", "."]);
    kept.prints_last("1 script: 1 passed\n");
    fs::remove_file(folder.join("gone.json")).unwrap();
    write(&folder, "broken.scan.json", "{");
    let broken = standstill(&folder, &["test", "."]);
    assert_eq!(broken.status, 3);
    broken.prints("BROKEN    ./broken.scan.json\nok        ./move.scan.json\n");
    broken.complains("broken.scan.json:1:2");
}

#[test]
fn a_golden_that_is_no_snapshot_is_a_bad_file() {
    let folder = with_script("test_form");
    write(&folder, "move.snap", "not a snapshot");
    let ended = standstill(&folder, &["test", "move.scan.json"]);
    assert_eq!(ended.status, 3);
    ended.complains("move.snap: no snapshot in insta's form");
    assert_eq!(read(&folder, "move.snap"), "not a snapshot");
}

#[test]
fn the_outcome_goes_into_a_junit_file_that_a_reader_understands() {
    let folder = with_script("test_junit");
    fs::create_dir_all(folder.join("more")).unwrap();
    write(&folder, "more/late.scan.json", &late());
    write(&folder, "more/no.scan.json", "{<");
    assert_eq!(
        standstill(&folder, &["test", "--accept", "move.scan.json"]).status,
        0
    );
    let ended = standstill(&folder, &["test", ".", "--junit", "out.xml"]);
    assert_eq!(ended.status, 3);
    ended.prints_last("\nto look at\n  ./more/late.scan.json\n  ./more/no.scan.json\n3 scripts: 1 passed, 1 failed, 1 broken\n");
    let text = read(&folder, "out.xml");
    let document = roxmltree::Document::parse(&text).unwrap();
    let told: Vec<_> = document
        .descendants()
        .filter(|node| node.has_tag_name("testcase"))
        .map(|node| {
            let ending = node.first_element_child();
            let kind = ending.map_or("", |ending| ending.tag_name().name());
            let message = ending
                .and_then(|ending| ending.attribute("message"))
                .unwrap_or("");
            (node.attribute("name").unwrap(), kind, message.to_owned())
        })
        .collect();
    let [late, no, passed] = told.as_slice() else {
        panic!("{told:?}")
    };
    assert_eq!((passed.0, passed.1), ("move", ""));
    assert_eq!((late.0, late.1), ("late", "failure"));
    assert!(late.2.starts_with("expect[0]"), "{late:?}");
    assert_eq!((no.0, no.1), ("no", "error"));
    assert!(no.2.starts_with("error[syntax]"), "{no:?}");
}

/// The output is in the order of the files, whichever ends first.
#[test]
fn any_number_of_threads_prints_the_same() {
    let folder = with_script("test_threads");
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    for number in 0..12 {
        let script = match number % 3 {
            // The first of all takes longest.
            0 => SCRIPT.replace("\"scans\": 30", &format!("\"scans\": {}", 9_000 / (number + 1))),
            1 => SCRIPT.replace("\"at\": 21", "\"at\": 19"),
            _ => "{".to_owned(),
        };
        write(&folder, &format!("a{number:02}.scan.json"), &script);
    }
    let run = |threads: &[&str]| {
        let mut parts = vec!["test", ".", "--golden", "none", "--strict"];
        parts.extend(threads);
        let ended = standstill(&folder, &parts);
        (ended.status, ended.out, ended.err)
    };
    let one = run(&["--threads", "1"]);
    assert_eq!(one.0, 3);
    assert!(
        one.1
            .contains("\nto look at\n  ./a01.scan.json\n  ./a02.scan.json\n  ./a04"),
        "{}",
        one.1
    );
    for threads in [&["--threads", "2"][..], &["--threads", "7"], &[]] {
        assert_eq!(run(threads), one, "{threads:?}");
    }
    // A script that is named twice is judged twice in succession: both runs write the same golden.
    let twice = typed(&folder, "test move.scan.json ./move.scan.json --accept");
    assert_eq!(
        (twice.status, twice.out.matches("move.scan.json").count()),
        (0, 2)
    );
}

#[test]
fn a_junit_file_that_cannot_be_written_leaves_nothing_behind() {
    let folder = with_script("test_junit_refused");
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    let ended = standstill(&folder, &["test", ".", "--junit", "nowhere/out.xml"]);
    assert_eq!(ended.status, 4);
    ended.complains_first("error: nowhere/out.xml: ");
    ended.prints_last("1 script: 1 passed\n");
    assert!(!folder.join("nowhere").exists());
}

#[test]
fn a_failing_script_gets_a_page_of_golden_and_run() {
    let folder = with_script("test_report");
    fs::create_dir_all(folder.join("more")).unwrap();
    write(&folder, "more/fine.scan.json", SCRIPT);
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    let other = SCRIPT.replace(
        "\"GO\": true}}",
        "\"GO\": true}}, {\"at\": 25, \"set\": {\"GO\": false}}",
    );
    write(&folder, "move.scan.json", &other);
    let ended = typed(&folder, "test . ../test_report/move.scan.json --report pages");
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    ended.prints("\n    report: pages/move.html\n");
    ended.prints("\n    report: pages/test_report/move.html\n");
    let page = read(&folder, "pages/move.html");
    let traces = page
        .matches("<script type=\"text/plain\" class=\"rows\">")
        .count();
    assert_eq!(traces, 2);
    // The first output that differs: Done falls with Execute.
    assert!(page.contains("why: scan 25</button>"), "{page:.3000}");
    assert!(page.contains("<b>A</b>expected: golden of ./move.scan.json: 30 scans"));
    assert!(page.contains("<b>B</b>found: ./move.scan.json: 30 scans"));
    assert!(page.contains("data-scan=\"25\">first difference in scan 25 (T#250ms)</button>"));
    assert!(page.contains("\"marks\":[25]"));
    assert!(page.contains("move.Execute  expected TRUE  found FALSE"));
    assert!(!folder.join("pages/more").exists(), "only what failed has a page");
}

#[test]
fn a_page_of_one_run_where_there_is_nothing_to_lay_it_over() {
    let folder = with_script("test_report_alone");
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    let alone = |script: &str, title: &str| {
        write(&folder, "move.scan.json", script);
        let ended = standstill(&folder, &["test", ".", "--report", "pages"]);
        assert_eq!(ended.status, 1);
        let page = read(&folder, "pages/move.html");
        assert_eq!(page.matches("class=\"rows\">").count(), 1, "{title}");
        assert!(page.contains(title), "{title}");
    };
    // The claim fails, the run is as recorded.
    alone(&late(), "1 of 2 claims hold");
    // Other cycles have no common scans.
    let slow = SCRIPT
        .replace("T#10ms", "T#20ms")
        .replace("\"at\": 21", "\"at\": 25");
    alone(&slow, "cycle: expected T#10ms, found T#20ms");
    fs::remove_file(folder.join("move.exact")).unwrap();
    alone(
        &SCRIPT.replace("\"scans\": 30", "\"scans\": 31"),
        "2 of 2 claims hold",
    );
}

/// The same as [`SCRIPT`], to another target.
fn moved_to(position: &str) -> String {
    SCRIPT
        .replace("\"Position\": 1,", &format!("\"Position\": {position},"))
        .replace(
            "\"X.Position\": 1}",
            "\"X.Position\": {\"near\": 1, \"within\": 0.1}}",
        )
}

#[test]
fn by_events_a_golden_admits_what_no_machine_notices() {
    let folder = scratch("test_events");
    write(&folder, "move.scan.json", &moved_to("1"));
    assert_eq!(standstill(&folder, &["test", "--accept", "."]).status, 0);
    let test = |more: &[&str]| standstill(&folder, &[&["test", "."], more].concat());
    let events = ["--golden", "events"];
    assert_eq!(
        test(&events).out,
        "ok        ./move.scan.json\n1 script: 1 passed\n"
    );
    write(&folder, "move.scan.json", &moved_to("0.999999999999"));
    assert_eq!(test(&[]).status, 1);
    let close = test(&[&events[..], &["--junit", "out.xml", "--report", "pages"]].concat());
    assert_eq!((close.status, close.err.as_str()), (0, ""));
    close.prints_first("ok        ./move.scan.json\n    ");
    close.prints(" values within tolerance, the furthest ");
    close.prints_last("1 script: 1 passed\n");
    assert!(read(&folder, "out.xml").contains("failures=\"0\""));
    assert!(!folder.join("pages/move.html").exists());
    // The strict mode finds it, names its subject, and marks it in the report and for JUnit.
    let strict = [
        "--abs", "0", "--rel", "1e-13", "--junit", "out.xml", "--report", "pages",
    ];
    let found = test(&[&events[..], &strict].concat());
    assert_eq!(found.status, 1);
    found.prints("first difference in scan 0 (T#0s)");
    let line = "move.Position  expected 1.0  found 0.999999999999  (may be 1.0e-13 apart)";
    found.prints(line);
    assert!(read(&folder, "pages/move.html").contains(",0]}"));
    assert!(read(&folder, "out.xml").contains("move.Position  expected 1.0  found 0.999999999999"));
}

#[test]
fn tolerances_belong_to_events_and_are_numbers() {
    let folder = with_script("test_tolerances");
    for arguments in [
        &["--abs", "1e-3"][..],
        &["--golden", "exact", "--rel", "1e-3"],
        &["--golden", "events", "--abs", "-1"],
        &["--golden", "events", "--rel", "NaN"],
        &["--golden", "roughly"],
    ] {
        let ended = standstill(&folder, &[&["test", "."], arguments].concat());
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{arguments:?}");
        ended.complains_first("error: ");
    }
}

#[test]
fn a_folder_that_cannot_be_made_is_told_before_the_tests_run() {
    let folder = with_script("test_report_refused");
    let ended = standstill(&folder, &["test", ".", "--report", "move.scan.json"]);
    assert_eq!((ended.status, ended.out.as_str()), (4, ""));
    ended.complains_first("error: move.scan.json: ");
}

#[test]
fn files_outside_the_folder_are_included_only_where_that_is_allowed() {
    let folder = scratch("test_include");
    fs::create_dir_all(folder.join("jobs/in")).unwrap();
    fs::create_dir_all(folder.join("machines")).unwrap();
    let machine = r#"{"standstill": 1, "inputs": {"lamp": false}}"#;
    write(&folder, "machines/m.machine.json", machine);
    write(&folder, "jobs/in/m.machine.json", machine);
    let script = |path: &str| SCRIPT.replacen("{\n", &format!("{{\n  \"include\": \"{path}\",\n"), 1);
    write(&folder, "jobs/in.scan.json", &script("in/m.machine.json"));
    assert_eq!(standstill(&folder, &["test", "jobs", "--accept"]).status, 0);
    let out = script("../machines/m.machine.json");
    write(&folder, "jobs/in.scan.json", &out);
    for command in ["run", "test"] {
        let ended = standstill(&folder, &[command, "jobs/in.scan.json"]);
        assert_eq!(ended.status, 3, "{command}");
        let place = "--> jobs/in.scan.json:2:14";
        assert!(
            ended.err.contains(place) && ended.err.contains("outside the script's folder"),
            "{}",
            ended.err
        );
        let allowed = standstill(
            &folder,
            &[command, "jobs/in.scan.json", "--include-from", "machines"],
        );
        assert_ne!(allowed.status, 3, "{}", allowed.err);
        let allowed = standstill(&folder, &[command, "jobs/in.scan.json", "--allow-outside"]);
        assert_ne!(allowed.status, 3, "{}", allowed.err);
    }
    // A mistake in the machine file is reported there.
    write(
        &folder,
        "machines/m.machine.json",
        &machine.replace("lamp", "1amp"),
    );
    let ended = typed(&folder, "run jobs/in.scan.json --include-from machines");
    ended.complains("--> jobs/../machines/m.machine.json:1:30");
    write(&folder, "jobs/in.scan.json", &script("in/gone.json"));
    let ended = standstill(&folder, &["run", "jobs/in.scan.json"]);
    ended.complains("`in/gone.json` cannot be included: there is no such file");
}

#[cfg(unix)]
#[test]
fn a_link_does_not_lead_outside() {
    let folder = scratch("test_include_link");
    fs::create_dir_all(folder.join("jobs")).unwrap();
    write(&folder, "m.machine.json", r#"{"standstill": 1}"#);
    std::os::unix::fs::symlink("../m.machine.json", folder.join("jobs/m.machine.json")).unwrap();
    let script = SCRIPT.replacen("{\n", "{\n  \"include\": \"m.machine.json\",\n", 1);
    write(&folder, "jobs/a.scan.json", &script);
    let ended = standstill(&folder, &["run", "jobs/a.scan.json"]);
    assert_eq!(ended.status, 3);
    ended.complains("outside the script's folder");
}

/// The claims of a script on the trace of another run, with the same names in another order of columns.
#[test]
fn a_recording_is_judged_by_the_claims_of_a_script() {
    let folder = with_script("test_recording");
    let slow = typed(&folder, "run --quiet move.scan.json --trace run.jsonl --set v=5");
    assert_eq!(slow.status, 1, "{}", slow.out);
    let judged = typed(
        &folder,
        "test move.scan.json --recording run.jsonl --junit out.xml",
    );
    assert_eq!(
        (judged.status, judged.out.as_str()),
        (
            1,
            "FAILED    move.scan.json on run.jsonl\n    expect[0].that.move.Done: FALSE at scan 21, expected TRUE; it \
             came at 26, 5 later\n    expect[0].that.X.Position: 0.92 at scan 21, expected 1.0; it came at 25, 4 later\n    \
             why\n      move (MC_MoveAbsolute) is under way since scan 1 with Position 1.0, Velocity 5.0, held by its \
             Velocity 5.0\n1 script: 1 failed\n"
        )
    );
    assert!(read(&folder, "out.xml").contains("it came at 26, 5 later"));
    // A recording that has less than the script, and begins during the move.
    let csv = "scan,time_ns,X.State,X.Position,X.Velocity,X.Acceleration,X.Jerk,X.Snap,X.ActualPosition\n";
    let row = |scan: i32| {
        format!(
            "{scan},{}0000000,DiscreteMotion,{},5.0,0.0,0.0,0.0,0.0\n",
            scan,
            f64::from(scan) * 0.05
        )
    };
    let rows: String = (0..9).map(row).collect();
    write(&folder, "cut.csv", &format!("{csv}{rows}"));
    let missing = standstill(&folder, &["test", "move.scan.json", "--recording", "cut.csv"]);
    assert_eq!(missing.status, 3);
    missing.complains("error: cut.csv: expect[0] speaks of move.Done, which the recording has not (nor what another claim speaks \
             of); columns go by name, as the script's own trace has them\n");
    let claims = SCRIPT
        .replace(
            r#"{"at": 21, "that": {"move.Done": true, "X.Position": 1}}"#,
            r#"{"within_limits": "X"}"#,
        )
        .replace(
            r#"{"never": {"move.Error": true}}"#,
            r#"{"at": 4, "that": {"X.Position.d1": {"near": 5, "within": 1e-9}}}"#,
        );
    write(&folder, "claims.scan.json", &claims);
    let passed = standstill(&folder, &["test", "claims.scan.json", "--recording", "cut.csv"]);
    assert_eq!(
        (passed.status, passed.out.as_str()),
        (0, "ok        claims.scan.json on cut.csv\n1 script: 1 passed\n"),
        "{}",
        passed.err
    );
    let faster = claims.replace("\"velocity\": 20", "\"velocity\": 4");
    write(&folder, "claims.scan.json", &faster);
    let failed = standstill(&folder, &["test", "claims.scan.json", "--recording", "cut.csv"]);
    failed.prints(
        "expect[0].within_limits.X.Position.d1: 4.999999999999999 at scan 5, expected of magnitude <= 4.0",
    );
    write(&folder, "claims.scan.json", &claims.replace("T#10ms", "T#1ms"));
    let other = standstill(&folder, &["test", "claims.scan.json", "--recording", "cut.csv"]);
    assert_eq!(other.status, 3);
    other.complains("its cycle is 10000000 ns and that of the script 1000000 ns");
}

#[test]
fn a_recording_needs_one_script_and_no_golden() {
    let folder = with_script("test_recording_usage");
    for (arguments, wanted) in [
        (&["test", ".", "--recording", "run.csv"][..], "this is a folder"),
        (
            &[
                "test",
                "move.scan.json",
                "move.scan.json",
                "--recording",
                "run.csv",
            ],
            "--recording is judged by one script",
        ),
        (
            &["test", "move.scan.json", "--accept", "--recording", "run.csv"],
            "cannot be used with",
        ),
        (
            &[
                "test",
                "move.scan.json",
                "--golden",
                "events",
                "--recording",
                "run.csv",
            ],
            "cannot be used with",
        ),
        (&["test", "move.scan.json", "--recording", "run.txt"], "run.txt"),
    ] {
        let ended = standstill(&folder, arguments);
        assert_eq!(ended.status, 2, "{arguments:?}: {}", ended.err);
        ended.complains(wanted);
    }
}

#[test]
fn a_failing_test_says_why_in_every_form() {
    let folder = scratch("test_why");
    write(
        &folder,
        "off.scan.json",
        &SCRIPT.replace(", \"state\": \"Standstill\"", ""),
    );
    let why = "move was refused in scan 1: 201 NotPowered: switch it on with MC_Power and wait for Status; there is no \
               MC_Power for X, and it does not start in Standstill";
    let tested = typed(
        &folder,
        "test off.scan.json --golden none --junit out.xml --report pages",
    );
    assert_eq!(tested.status, 1);
    tested.prints(&format!("    why\n      {why}\n"));
    let quiet = standstill(&folder, &["run", "-q", "off.scan.json", "--report", "run.html"]);
    quiet.prints(&format!("  why\n    {why}\n"));
    let junit = read(&folder, "out.xml");
    let document = roxmltree::Document::parse(&junit).unwrap();
    let failure = document
        .descendants()
        .find(|node| node.has_tag_name("failure"))
        .unwrap();
    assert!(
        failure
            .attribute("message")
            .unwrap()
            .contains(&format!("; why: {why}")),
        "{junit}"
    );
    assert!(failure.text().unwrap().contains(why));
    for page in ["pages/off.html", "run.html"] {
        let page = read(&folder, page);
        assert!(page.contains("data-scan=\"1\">why: scan 1</button>"));
        assert!(page.contains("move was refused in scan 1: 201 NotPowered"));
        assert!(page.contains("\"marks\":[1"));
    }
}

/// The script with an input that is never read and a velocity per minute.
fn doubtful() -> String {
    SCRIPT
        .replace("\"GO\": false", "\"GO\": false, \"STOP\": false")
        .replace("\"v\": 10", "\"v\": 600")
        .replace("\"at\": 21", "\"by\": 28")
}

#[test]
fn what_tests_nothing_is_told_and_fails_only_under_strict() {
    let folder = scratch("test_strict");
    write(&folder, "a.scan.json", &doubtful());
    let arguments = ["test", "a.scan.json", "--golden", "none"];
    let loose = standstill(&folder, &arguments);
    assert_eq!(
        (loose.status, loose.out.as_str()),
        (0, "ok        a.scan.json\n1 script: 1 passed\n")
    );
    let nobody = "warning[vacuous]: the input STOP is read by no wire, step or claim";
    let clamped = "warning[clamped]: move.Velocity 600.0 was lowered to 20.0 in scan 1";
    for told in [nobody, clamped, "a.scan.json:10:27"] {
        loose.complains(told);
    }
    let strict = standstill(&folder, &[&arguments[..], &["--strict"]].concat());
    assert_eq!(strict.status, 1);
    assert_eq!(
        strict.out,
        "FAILED    a.scan.json\n    inputs.STOP (10:27): vacuous: the input STOP is read by no wire, step or claim\n    \
         blocks[0] (12:5): clamped: move.Velocity 600.0 was lowered to 20.0 in scan 1\n1 script: 1 failed\n"
    );
    let quiet = standstill(&folder, &["run", "-q", "a.scan.json"]);
    assert_eq!(quiet.status, 0);
    quiet.complains(clamped);
    // An intended item is marked as such.
    let meant = doubtful()
        .replace(
            "\"STOP\": false",
            "\"STOP\": {\"value\": false, \"vacuous\": \"allowed\"}",
        )
        .replace("\"scans\": 30,", "\"scans\": 30, \"clamps\": \"expected\",");
    write(&folder, "a.scan.json", &meant);
    let strict = standstill(&folder, &[&arguments[..], &["--strict"]].concat());
    assert_eq!((strict.status, strict.err.as_str()), (0, ""), "{}", strict.out);
}

#[test]
fn claims_decide_alone_where_no_golden_is_asked_for() {
    let folder = scratch("test_no_golden");
    write(&folder, "a.scan.json", SCRIPT);
    assert_eq!(
        standstill(&folder, &["test", "a.scan.json"]).status,
        1,
        "there is no golden yet"
    );
    let none = standstill(&folder, &["test", "a.scan.json", "--golden", "none"]);
    assert_eq!(
        (none.status, none.out.as_str()),
        (0, "ok        a.scan.json\n1 script: 1 passed\n")
    );
    let said = SCRIPT.replace("\"scans\": 30,", "\"scans\": 30, \"golden\": false,");
    write(&folder, "a.scan.json", &said);
    for arguments in [&["test", "a.scan.json"][..], &["test", "--accept", "a.scan.json"]] {
        assert_eq!(standstill(&folder, arguments).status, 0);
    }
    assert!(!folder.join("a.snap").exists() && !folder.join("a.exact").exists());
    let both = standstill(&folder, &["test", "--accept", "--golden", "none", "a.scan.json"]);
    assert_eq!(both.status, 2);
    // A script without steps and claims tests nothing.
    let empty = said.replace("\"expect\": [", "\"expect\": [],\n  \"covers\": [");
    let start = empty.find("\"covers\": [").unwrap();
    write(
        &folder,
        "a.scan.json",
        &(empty[..start].trim_end().trim_end_matches(',').to_owned() + "}"),
    );
    let nothing = standstill(&folder, &["test", "--strict", "a.scan.json"]);
    assert_eq!(nothing.status, 1);
    nothing.prints("the script has no claims and no golden");
}

#[test]
fn the_outcome_as_json_is_what_its_schema_says() {
    let folder = scratch("test_json");
    write(&folder, "a.scan.json", &doubtful());
    write(
        &folder,
        "off.scan.json",
        &SCRIPT.replace(", \"state\": \"Standstill\"", ""),
    );
    write(&folder, "broken.scan.json", "{");
    fs::write(folder.join("gone.snap"), "").unwrap();
    let tested = standstill(&folder, &["test", ".", "--json", "--golden", "none"]);
    let ran = standstill(&folder, &["run", "--json", "a.scan.json", "off.scan.json"]);
    assert_eq!((tested.status, ran.status), (3, 1));
    let [tested, ran] = [tested, ran].map(|ended| ended.answer());
    let verdicts: Vec<_> = tested["scripts"]
        .as_array()
        .unwrap()
        .iter()
        .map(|script| &script["verdict"])
        .collect();
    assert_eq!(verdicts, ["passed", "broken", "failed", "orphaned"]);
    let off = &tested["scripts"][2];
    assert_eq!(off["why"][0]["scan"], 1);
    assert!(off["why"][0]["text"].as_str().unwrap().contains("201 NotPowered"));
    assert_eq!(off["claims"][0]["failures"][0]["scan"], 21);
    assert_eq!(ran["scripts"][0]["warnings"][1]["kind"], "clamped");
}

#[test]
fn a_file_that_looks_like_a_script_is_mentioned() {
    let folder = with_script("test_overlooked");
    write(&folder, "second.json", SCRIPT);
    write(&folder, "settings.json", "{\"cycle\": 1}");
    let ended = standstill(&folder, &["test", ".", "--golden", "none"]);
    assert_eq!(ended.status, 0);
    assert_eq!(
        ended.err,
        "note: ./second.json looks like a scan script, but is not tested: its name does not end in .scan.json\n"
    );
}

#[test]
fn mutants_that_no_claim_notices_survive() {
    let folder = scratch("test_mutate");
    let loose = SCRIPT.replace("\"at\": 21", "\"by\": 28");
    write(&folder, "a.scan.json", &loose);
    let first = standstill(&folder, &["test", "--mutate", "a.scan.json"]);
    assert_eq!((first.status, first.err.as_str()), (0, ""));
    // With a higher acceleration, velocity or limit nothing changes: a move of 20 scans has no time for it.
    assert_eq!(
        first.out,
        "survived  axes.X.limits.acceleration: 100.0 to 90.0\n\
         killed    blocks[0]: move left out (expect[0])\n\
         survived  blocks[0].pins.Execute: from to not\n\
         killed    blocks[0].pins.Position: 1.0 to 0.9 (expect[0])\n\
         killed    blocks[0].pins.Position: 1.0 to 1.1 (expect[0])\n\
         survived  blocks[0].pins.Velocity: 10.0 to 9.0\n\
         a.scan.json: 3 of 6 mutants killed (50.0 %), 5 change nothing\n"
    );
    let again = standstill(&folder, &["test", "--mutate", "a.scan.json", "--seed", "7"]);
    assert_eq!(again.out, first.out, "all fit, so none is drawn");
    // With two more claims there are no survivors.
    let told = r#"{"duration": [{"move.Busy": true}, {"move.Done": true}], "ge": 20, "le": 20},
        {"never": {"move.Busy": true}, "to": 0}, {"never": {"move.Error""#;
    let better = loose.replace("{\"never\": {\"move.Error\"", told);
    write(&folder, "a.scan.json", &better);
    let json = standstill(&folder, &["test", "--mutate", "a.scan.json", "--json"]);
    let json: serde_json::Value = serde_json::from_str(&json.out).unwrap();
    let script = &json["scripts"][0];
    assert_eq!((&script["killed"], &script["survived"]), (&6.into(), &0.into()));
    assert_eq!(script["mutants"][0]["claim"], "expect[1]");
    write(&folder, "a.scan.json", &late());
    let broken = standstill(&folder, &["test", "--mutate", "a.scan.json"]);
    assert_eq!(broken.status, 1);
    broken.prints("its claims fail without a change");
}
