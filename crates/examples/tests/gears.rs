//! The same three axes, coupled by a scan script, by a guest and by Structured Text: every column of
//! every axis is the same in every scan, to the bit. The C library is compared with the same script
//! beside its other examples.

use standstill_trace::{Cell, Trace};
use std::path::Path;

fn run(script: &str) -> Trace {
    let path = Path::new(env!("CARGO_MANIFEST_DIR"))
        .join("../../scan-tests")
        .join(script);
    let (_, script) = standstill_script::suite::Texts::read(&path, &Default::default()).unwrap();
    let outcome = standstill_script::run(&script).unwrap();
    assert!(outcome.passed(), "{}: {:?}", path.display(), outcome.verdicts);
    outcome.trace
}

/// The columns of an axis that every script has. A script whose blocks couple axes has more columns of its slaves;
/// its claims check those.
const COLUMNS: [&str; 6] = ["State", "Position", "Velocity", "Acceleration", "Jerk", "Snap"];

fn cells(trace: &Trace) -> Vec<String> {
    let columns: Vec<_> = ["M", "S", "W"]
        .iter()
        .flat_map(|axis| COLUMNS.map(|name| trace.column(&format!("{axis}.{name}")).unwrap()))
        .collect();
    let text = |cell: Cell<'_>| match cell {
        Cell::Real(value) => format!("{:016x}", value.to_bits()),
        other => format!("{other:?}"),
    };
    (0..trace.scans())
        .map(|scan| {
            let cells: Vec<_> = columns
                .iter()
                .map(|column| text(trace.cell(scan, *column).unwrap()))
                .collect();
            cells.join(" ")
        })
        .collect()
}

/// Covers: G5, G15, G60, G65, G85
#[test]
fn couplings_of_a_guest_and_of_structured_text_move_by_the_bits_of_a_script() {
    let script = cells(&run("embedding/gears.scan.json"));
    for other in [
        "guests/a_guest_couples_axes.scan.json",
        "structured_text/axes_in_gear.scan.json",
    ] {
        for (scan, (expected, found)) in script.iter().zip(&cells(&run(other))).enumerate() {
            assert_eq!(expected, found, "{other}, scan {scan}");
        }
    }
}
