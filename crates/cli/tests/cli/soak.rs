//! Random replans, in one run and interrupted.

use crate::support::{read, scratch, standstill, write};

#[test]
fn replans_hold_and_an_interrupted_run_ends_as_one_that_is_not() {
    let folder = scratch("soak");
    let soak = |arguments: &[&str]| standstill(&folder, &[&["soak", "planner"], arguments].concat());
    let whole = soak(&["--seed", "1", "--count", "20010"]);
    assert_eq!((whole.status, whole.err.as_str()), (0, ""), "{}", whole.out);
    whole.prints_last("seed 1: 20010 replans, 0 failed\n");
    // It stops in the middle of a chain, and continues.
    let part = soak(&["--count", "7007", "--resume", "state.json"]);
    part.prints_last("seed 1: 7007 replans, 0 failed\n");
    let rest = soak(&["--count", "20010", "--resume", "state.json"]);
    assert_eq!(rest.out, whole.out);
    assert!(read(&folder, "state.json").contains(r#""chains":1000,"#));
    assert_ne!(soak(&["--seed", "2", "--count", "20010"]).out, whole.out);
}

#[test]
fn a_state_that_does_not_fit_is_refused() {
    let folder = scratch("soak_refused");
    let soak = |arguments: &[&str]| {
        let always = ["soak", "planner", "--resume", "state.json"];
        let ended = standstill(&folder, &[&always, arguments].concat());
        (ended.status, ended.err)
    };
    assert_eq!(soak(&["--count", "40"]), (0, String::new()));
    let (status, told) = soak(&["--count", "40", "--seed", "2"]);
    assert_eq!(status, 2);
    assert!(
        told.starts_with("error: --seed 2: the run to resume has seed 1\n"),
        "{told}"
    );
    let (status, told) = soak(&["--count", "39"]);
    assert_eq!(status, 2);
    assert!(
        told.starts_with("error: --count 39: the run to resume has 40 replans already\n"),
        "{told}"
    );
    let state = read(&folder, "state.json");
    write(
        &folder,
        "state.json",
        &state.replace("\"version\":\"", "\"version\":\"0."),
    );
    let (status, told) = soak(&["--count", "40"]);
    assert_eq!(status, 3);
    assert_eq!(
        told,
        "error: state.json: written by another version; begin anew\n"
    );
    write(&folder, "state.json", &state[..state.len() / 2]);
    let (status, told) = soak(&["--count", "40"]);
    assert_eq!(status, 3);
    assert!(
        told.starts_with("error: state.json: no state of a soak: "),
        "{told}"
    );
}
