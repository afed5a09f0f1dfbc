//! A paced scan of `standstill live` does not use the heap, including its row in the trace. Exceptions
//! are events with a note, and a word that is new in the trace. The trace is that of `run`.

mod counting;

use counting::allocations;
use standstill_live::{Clock, Ended, OnOverrun, Timing, pace};
use standstill_script::{Session, read, run};
use standstill_trace::{Cell, Trace, digest};
use std::collections::BTreeSet;
use std::fs;
use std::path::Path;

/// Records at every sleep the allocations so far.
struct Watching {
    now_ns: u64,
    taken: Vec<u64>,
}

impl Clock for Watching {
    fn now_ns(&mut self) -> u64 {
        self.now_ns
    }

    fn sleep_until_ns(&mut self, instant_ns: u64) {
        self.now_ns = instant_ns;
        self.taken.push(allocations());
    }
}

/// The scans in which a word appears in the trace for the first time.
fn new_words(trace: &Trace) -> BTreeSet<usize> {
    let mut seen = BTreeSet::new();
    let mut scans = BTreeSet::new();
    for scan in 0..trace.scans() {
        for cell in trace.row(scan) {
            if let Cell::Name(word) = cell
                && seen.insert(word.to_owned())
            {
                scans.insert(scan);
            }
        }
    }
    scans
}

/// With wires of all kinds, steps with conditions, switches, probes, and axes of all drives.
#[test]
fn a_paced_scan_uses_no_heap() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("../../scan-tests");
    let mut quiet = 0;
    for name in [
        "gallery/glue",
        "embedding/home_and_latch",
        "embedding/power_there_and_back",
        "standard_blocks/three_cycles_there_and_back",
        "tutorial/abort",
    ] {
        let text = fs::read_to_string(tests.join(name).with_extension("scan.json")).unwrap();
        let script = read(&text, name, &[]).unwrap();
        let expected = run(&script).unwrap().trace;
        let mut session = Session::new(&script).unwrap();
        session.reserve();
        let mut clock = Watching {
            now_ns: 0,
            taken: Vec::with_capacity(expected.scans() + 1),
        };
        let mut timing = Timing::new(script.cycle_ns.unsigned_abs());
        let ended = pace(
            &mut session,
            &mut clock,
            OnOverrun::Continue,
            || None,
            &mut timing,
        )
        .unwrap();
        clock.taken.push(allocations());
        assert_eq!(ended, Ended::Script);
        let trace = session.finish().trace;
        assert_eq!(digest::whole(&trace), digest::whole(&expected), "{name}");

        let words = new_words(&trace);
        let notes: BTreeSet<_> = trace.notes().iter().map(|note| note.scan).collect();
        for (scan, pair) in clock.taken.windows(2).enumerate() {
            let taken = pair[1] - pair[0];
            if words.contains(&scan) || notes.contains(&scan) {
                continue;
            }
            assert_eq!(taken, 0, "{name}, scan {scan}");
            quiet += 1;
        }
    }
    assert!(quiet > 4000, "{quiet}");
}
