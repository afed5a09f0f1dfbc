//! The terminal plot must show curves that fit their labels and lose no edge.

use crate::common;

use standstill_trace::plot::plot;
use standstill_trace::{Cell, Header, Input, Trace};

#[test]
fn a_move_is_drawn() {
    let text = plot(&common::run(2000, None), 100);
    println!("{text}");
    assert!(text.lines().all(|line| line.chars().count() <= 100));
}

/// Levels of one Boolean as they are drawn, without the label.
fn drawn(levels: &[bool], width: usize) -> String {
    let inputs = vec![Input {
        name: "GO".into(),
        iec_type: "BOOL".into(),
    }];
    let mut trace = Trace::new(Header {
        inputs,
        ..Header::default()
    });
    for &level in levels {
        trace.push_row(&[Cell::Bool(level)]).expect("the row fits");
    }
    let text = plot(&trace, width + "GO ".len());
    text.lines()
        .find_map(|line| line.strip_prefix("GO "))
        .unwrap_or_default()
        .to_owned()
}

#[test]
fn a_pulse_of_one_scan_is_seen_wherever_it_is() {
    for scans in [7, 20, 99, 1000, 1001] {
        for at in 0..scans {
            let rising: Vec<bool> = (0..scans).map(|scan| scan == at).collect();
            let shown = drawn(&rising, 40);
            assert!(
                shown.contains(['▔', '│']) && shown.contains('▁'),
                "{at} of {scans}: {shown}"
            );
            let falling: Vec<bool> = rising.iter().map(|level| !level).collect();
            let shown = drawn(&falling, 40);
            assert!(
                shown.contains(['▁', '│']) && shown.contains('▔'),
                "{at} of {scans}: {shown}"
            );
        }
    }
    assert_eq!(drawn(&[false, true], 20), "▁▁▁▁▁▁▁▁▁▁▔▔▔▔▔▔▔▔▔▔");
}

#[test]
fn what_does_not_change_takes_no_room_and_nothing_is_no_harm() {
    assert_eq!(drawn(&[true, true], 20), "");
    let empty = plot(&Trace::new(common::header()), 100);
    assert_eq!(empty.lines().count(), 1, "{empty}");
    let hard = plot(&common::hard_values(), 0);
    assert!(hard.contains('│'), "{hard}");
}
