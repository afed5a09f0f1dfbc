//! Scripts, run and shown.

use crate::support::{SCRIPT, late, scratch, standstill, typed, with_script, write};

#[test]
fn a_run_shows_events_curves_extremes_and_a_digest() {
    let folder = with_script("run_shows");
    let ended = standstill(&folder, &["run", "move.scan.json"]);
    assert_eq!((ended.status, ended.err.as_str()), (0, ""));
    for part in [
        "One short move\naxis X (mm): order 2\n",
        "    1  move    +Execute +Busy +Active",
        "    1  X       Standstill -> DiscreteMotion\n",
        "   21  move    +Done -Busy -Active\n",
        "X.Position (mm)\n",
        "X.Velocity (mm/s)\n",
        "move.Done ▁",
        "extremes of X (mm)\n",
        "100.00 % of 100.0\n",
        "move.scan.json: passed, 2 of 2 claims, 30 scans, digest ",
    ] {
        assert!(ended.out.contains(part), "{part:?} is missing in\n{}", ended.out);
    }
    assert!(!ended.out.contains('\x1b'), "no colours");
    let again = standstill(&folder, &["run", "move.scan.json"]);
    assert_eq!(ended.out, again.out, "the same every time");
}

#[test]
fn a_failing_claim_is_shown_and_fails() {
    let folder = scratch("run_fails");
    write(&folder, "late.scan.json", &late());
    let ended = standstill(&folder, &["run", "--quiet", "late.scan.json"]);
    assert_eq!((ended.status, ended.err.as_str()), (1, ""));
    let lines: Vec<_> = ended.out.lines().collect();
    assert_eq!(
        lines[0],
        "  expect[0].that.move.Done: FALSE at scan 19, expected TRUE; it came at 21, 2 later"
    );
    assert!(
        lines
            .last()
            .unwrap()
            .starts_with("late.scan.json: FAILED, 1 of 2 claims, 30 scans, digest ")
    );
    assert!(
        standstill(&folder, &["run", "late.scan.json"])
            .out
            .contains("\nfailing claims\n  expect[0]")
    );
}

#[test]
fn parameters_are_replaced() {
    let folder = with_script("run_set");
    let ended = standstill(&folder, &["run", "-q", "--set", "v=2", "move.scan.json"]);
    assert_eq!(ended.status, 1, "slower, so Done comes later");
    let ended = typed(&folder, "run -q --set v=2 --set v=10 move.scan.json");
    assert_eq!(ended.status, 0, "the last one counts");
}

#[test]
fn a_parameter_that_makes_no_sense_is_a_mistake_of_the_command_line() {
    let folder = with_script("run_set_wrong");
    let wrong = |set: &str, message: &str| {
        let ended = standstill(&folder, &["run", "--set", set, "move.scan.json"]);
        assert_eq!((ended.status, ended.out.as_str()), (2, ""), "{set}");
        ended.complains(message);
    };
    wrong(
        "v=fast",
        "invalid value 'v=fast' for '--set <NAME=VALUE>': `fast` is no number",
    );
    wrong(
        "v",
        "invalid value 'v' for '--set <NAME=VALUE>': write NAME=VALUE, such as v=60",
    );
    wrong("w=3", "the script has no parameter `w`");
}

#[test]
fn several_scripts_are_run_in_order_and_the_worst_one_counts() {
    let folder = with_script("run_several");
    write(&folder, "broken.scan.json", "{");
    write(&folder, "late.scan.json", &late());
    let ended = typed(&folder, "run -q late.scan.json broken.scan.json move.scan.json");
    assert_eq!(ended.status, 3);
    ended.complains("--> broken.scan.json:1:2");
    assert!(
        ended
            .out
            .lines()
            .last()
            .unwrap()
            .starts_with("move.scan.json: passed")
    );
    assert_eq!(
        standstill(&folder, &["run", "-q", "late.scan.json", "move.scan.json"]).status,
        1
    );
}

#[test]
fn a_mistake_in_a_script_is_pointed_at() {
    let folder = scratch("run_mistake");
    write(
        &folder,
        "typing.scan.json",
        &SCRIPT.replace("\"Execute\"", "\"Exceute\""),
    );
    let ended = standstill(&folder, &["run", "typing.scan.json"]);
    assert_eq!((ended.status, ended.out.as_str()), (3, ""));
    ended.complains("typing.scan.json:15:29");
    ended.complains("did you mean `Execute`?");
}
