//! The golden text must tell what happened, stay short, and change where behaviour changes and only there.

mod common;

use standstill_trace::golden;

#[test]
fn a_move_there_and_back_reads_well_and_stays_short() {
    let text = golden::text(&common::run(2000, None));
    println!("{text}");
    let lines = text.lines().count();
    assert!(lines <= 120, "{lines} lines");
}
