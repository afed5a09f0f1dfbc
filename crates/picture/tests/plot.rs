//! The terminal plot must show curves that fit their labels and lose no edge.

use standstill_picture::plot;
use standstill_trace::{Axis, Cell, Header, Input, Trace};

/// A run of one axis with these positions.
fn run(positions: impl IntoIterator<Item = f64>) -> Trace {
    let axis = Axis {
        name: "X".into(),
        unit: "mm".into(),
        ..Axis::default()
    };
    let mut trace = Trace::new(Header {
        cycle_ns: 1_000_000,
        axes: vec![axis],
        ..Header::default()
    });
    for position in positions {
        let mut row = vec![Cell::Name("DiscreteMotion")];
        row.extend([position, 0.0, 0.0, 0.0, 0.0, position].map(Cell::Real));
        trace.push_row(&row).expect("the row fits");
    }
    trace
}

#[test]
fn a_move_is_drawn_from_its_least_to_its_greatest_position() {
    let text = plot(&run((0..=2000).map(|scan| f64::from(scan) / 100.0)), 100);
    assert!(text.lines().all(|line| line.chars().count() <= 100), "{text}");
    assert!(
        text.contains("X.Position (mm)") && text.contains("scan 2000"),
        "{text}"
    );
    let labels: Vec<_> = text
        .lines()
        .filter_map(|line| line.split_whitespace().next())
        .collect();
    assert!(labels.contains(&"20") && labels.contains(&"0"), "{text}");
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
    let empty = plot(&run([]), 100);
    assert_eq!(empty.lines().count(), 1, "{empty}");
    let hard = [f64::NAN, f64::INFINITY, f64::MAX, f64::MIN, -0.0, 5e-324, 1e30];
    for width in [0, 1, 40] {
        let text = plot(&run(hard), width);
        assert!(text.contains("X.Position"), "{text}");
    }
}
