//! Waveforms; a reader of others reads them in `crates/peers`.

use crate::common;
use standstill_trace::vcd;

#[test]
fn only_changes_are_written() {
    let mut out = Vec::new();
    vcd::write(&common::run(1000, None), &mut out).expect("a vector takes all");
    let text = String::from_utf8(out).expect("UTF-8");
    let done = text
        .lines()
        .filter(|line| line.starts_with("$var wire 1") && line.contains("Done"))
        .count();
    assert!(done > 0);
    assert!(text.lines().count() < 12_000, "{} lines", text.lines().count());
    assert!(
        text.contains("$scope module X $end\n$var string 1 ! State $end\n$var real 64 \" Position $end\n")
    );
}
