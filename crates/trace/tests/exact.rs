//! The companion of a golden must hold every bit, be the same for the same trace, be small, and notice
//! damage.

mod common;

use standstill_trace::exact::{ExactError, decode, digest_of, encode};
use standstill_trace::{Trace, digest};

#[test]
fn every_bit_comes_back_and_the_file_is_small() {
    let trace = common::run(2000, None);
    let file = encode(&trace);
    println!(
        "{} columns, {} scans: {} bytes",
        trace.columns().len(),
        trace.scans(),
        file.len()
    );
    assert!(file.len() < 40_000, "{} bytes", file.len());
    assert_eq!(digest_of(&file), Ok(digest::whole(&trace)));
    let back = decode(&file).expect("our own file");
    assert_eq!(digest::whole(&back), digest::whole(&trace));
    assert_eq!(back.columns(), trace.columns());
    assert_eq!(back.header().cycle_ns, trace.header().cycle_ns);
    assert_eq!(encode(&back), file, "the file depends on the rows alone");
}

#[test]
fn damage_is_noticed_wherever_it_is() {
    let file = encode(&common::run(30, None));
    for at in 0..file.len() {
        let mut bad = file.clone();
        bad[at] ^= 0x10;
        // Deflate leaves a few bits unused before its check sum; those may be anything.
        assert!(
            decode(&bad).map_or(true, |trace| encode(&trace) == file),
            "byte {at}"
        );
        assert!(decode(&file[..at]).is_err(), "cut at {at}");
    }
    assert_eq!(decode(b"PK").err(), Some(ExactError::Foreign));
    assert_eq!(decode(&file[..24]).err(), Some(ExactError::Damaged));
}

#[test]
fn an_empty_trace_and_a_hard_one_come_back() {
    let empty = Trace::new(common::header());
    assert_eq!(decode(&encode(&empty)).map(|trace| trace.scans()), Ok(0));
    let hard = common::hard_values();
    let back = decode(&encode(&hard)).expect("our own file");
    assert_eq!(digest::whole(&back), digest::whole(&hard));
    for scan in 0..hard.scans() {
        let texts = |trace: &Trace| {
            trace
                .row(scan)
                .map(|cell| format!("{cell:?}"))
                .collect::<Vec<_>>()
        };
        assert_eq!(texts(&back), texts(&hard), "scan {scan}");
    }
}
