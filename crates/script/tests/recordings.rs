//! Claims judged on traces that a script did not make itself.

use super::common::scan_tests;
use standstill_script::suite::{Allowed, find, read_file, shown};
use standstill_script::{judge_recording, run};
use standstill_testkit::whole_or;

/// If the trace of a run is written to a file and read again, it is judged as the run was. The only difference is
/// unknown in a recording: the motion of the axes before its first row.
#[test]
fn a_recording_of_a_run_is_judged_as_the_run() {
    // Shifted and unwrapped positions, differences from the first scan on, variables of guests, names of enumerations.
    let folders = [
        "coupling",
        "mc_set_position",
        "modulo",
        "limits",
        "mc_move_superimposed",
        "guests",
        "reading",
    ];
    let folder = scan_tests();
    let scripts = folders.map(|name| find(&folder.join(name)).expect("a folder of scripts"));
    let step = whole_or(1, 53);
    let (mut claims, mut differing) = (0, Vec::new());
    for path in scripts.concat().into_iter().step_by(step) {
        let (script, _) = read_file(&path, &[], &Allowed::default()).expect("a good script");
        let ran = run(&script).expect("a run");
        let mut text = Vec::new();
        standstill_trace::jsonl::write(&ran.trace, &mut text).expect("memory");
        let text = std::str::from_utf8(&text).expect("text");
        let recording = standstill_trace::jsonl::read(text).expect("a trace");
        let recorded = judge_recording(&script, recording.trace).expect("all columns are there");
        claims += ran.verdicts.len();
        for (ran, recorded) in ran.verdicts.iter().zip(&recorded.verdicts) {
            if ran != recorded {
                differing.push(format!("{} {}: {recorded:?}", shown(&path), ran.path));
            }
        }
    }
    assert!(claims > 400 / step, "{claims}");
    assert_eq!(differing, [""; 0]);
}
