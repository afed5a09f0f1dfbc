//! Random programs, in one run and interrupted.

use crate::support::{read, scratch, standstill};

#[test]
fn programs_hold_and_an_interrupted_run_ends_as_one_that_is_not() {
    let folder = scratch("soak_blocks");
    let soak = |arguments: &[&str]| standstill(&folder, &[&["soak", "blocks"], arguments].concat());
    let whole = soak(&["--seed", "1", "--count", "100010"]);
    assert_eq!((whole.status, whole.err.as_str()), (0, ""), "{}", whole.out);
    whole.prints_last("seed 1: 100010 scans, 0 episodes failed\n");
    // It stops in the middle of an episode, and continues.
    let part = soak(&["--count", "30001", "--resume", "state.json"]);
    part.prints_last("seed 1: 30001 scans, 0 episodes failed\n");
    let rest = soak(&["--count", "100010", "--resume", "state.json"]);
    assert_eq!(rest.out, whole.out);
    assert!(read(&folder, "state.json").contains(r#""chains":50,"#));
    assert_ne!(soak(&["--seed", "2", "--count", "100010"]).out, whole.out);
}
