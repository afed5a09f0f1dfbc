//! Waveforms, read back with the library of Surfer: every value of every scan must be there.

use crate::common;

use std::collections::BTreeMap;
use std::io::Cursor;

use standstill_trace::{Cell, Trace, cell_text, vcd};
use wellen::SignalValueRef;

fn written(trace: &Trace) -> Vec<u8> {
    let mut out = Vec::new();
    vcd::write(trace, &mut out).expect("a vector takes all");
    out
}

/// For each variable by full name, its value in each scan as text.
fn read_back(trace: &Trace) -> BTreeMap<String, Vec<String>> {
    let mut wave = wellen::simple::read_from_reader(Cursor::new(written(trace))).expect("a waveform");
    let cycle = trace.header().cycle_ns;
    let times = wave.time_table().to_vec();
    assert_eq!(
        times.last(),
        Some(&(trace.scans() as u64 * cycle)),
        "the last row has a width"
    );
    let variables: Vec<_> = wave.hierarchy().all_vars().collect();
    let mut found = BTreeMap::new();
    for variable in variables {
        let hierarchy = wave.hierarchy();
        let (name, signal) = {
            let variable = &hierarchy[variable];
            (variable.full_name(hierarchy), variable.signal_ref())
        };
        wave.load_signals(&[signal]);
        let mut values = Vec::new();
        let changes: Vec<_> = wave.get_signal(signal).expect("loaded").iter_changes().collect();
        for (at, (index, value)) in changes.iter().enumerate() {
            let scan = times[*index as usize] / cycle;
            let next = changes
                .get(at + 1)
                .map_or(trace.scans() as u64, |(index, _)| times[*index as usize] / cycle);
            values.extend((scan..next).map(|_| text(value)));
        }
        assert!(found.insert(name, values).is_none());
    }
    found
}

fn text(value: &SignalValueRef<'_>) -> String {
    match value {
        SignalValueRef::BitVec(bits) if bits.width() == 1 => {
            if bits.bit_string() == "1" { "TRUE" } else { "FALSE" }.into()
        }
        SignalValueRef::BitVec(bits) => {
            let bits = u64::from_str_radix(&bits.bit_string(), 2).expect("zeros and ones");
            bits.cast_signed().to_string()
        }
        SignalValueRef::Real(value) => cell_text(Cell::Real(*value)),
        SignalValueRef::String(text) => (*text).to_owned(),
        SignalValueRef::Event => "event".into(),
    }
}

fn assert_all_there(trace: &Trace) {
    let found = read_back(trace);
    assert_eq!(found.len(), trace.columns().len());
    for (at, column) in trace.columns().iter().enumerate() {
        let subject = if column.subject().is_empty() {
            "inputs"
        } else {
            column.subject()
        };
        let name = format!("standstill.{subject}.{}", column.signal());
        let expected: Vec<_> = trace
            .cells(at)
            .map(|cell| cell_text(cell).replace(' ', "_"))
            .collect();
        assert_eq!(found.get(&name), Some(&expected), "{name}");
    }
}

#[test]
fn booleans_states_and_numbers_come_back_to_the_bit() {
    assert_all_there(&common::run(1000, None));
}

#[test]
fn values_that_are_hard_to_write_come_back_too() {
    assert_all_there(&common::hard_values());
}
