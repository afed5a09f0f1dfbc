//! The commands that read traces read the dumps of the flight recorder of the C library.
#![allow(unsafe_code)]

use crate::support::{read, scratch, standstill};
use standstill_capi::*;
use std::ffi::c_char;
use std::fs;
use std::ptr::null_mut;

const TICK: i64 = 1_000_000;

/// The texts of the recorder in all of its forms, for an axis that may be pushed into a limit switch.
fn dumps(is_pushed: bool) -> [Vec<u8>; 3] {
    let config = RuntimeConfig {
        size: size_of::<RuntimeConfig>() as u32,
        axes: 1,
        instances: 1,
        history: 0,
        cycle_ns: TICK,
    };
    let keep = RecorderConfig {
        size: size_of::<RecorderConfig>() as u32,
        scans: 50,
        after: 20,
        records: 8,
        trigger: 1,
        reserved: 0,
    };
    let mut name = [0; NAME];
    for (to, from) in name.iter_mut().zip(b"home") {
        *to = *from as c_char;
    }
    let mut runtime = null_mut();
    // SAFETY: structures of numbers, with their sizes in front; storage of the stated length, which lives to the
    // end.
    unsafe {
        let mut bytes = 0;
        assert_eq!(standstill_runtime_size(&config, &mut bytes), 0);
        let mut storage = vec![0_u128; bytes.div_ceil(16)];
        let at = storage.as_mut_ptr().cast();
        assert_eq!(
            standstill_runtime_init(ABI_VERSION, at, bytes, &config, &mut runtime),
            0
        );
        let (mut axis, mut drive): (AxisSetup, DriveSetup) = std::mem::zeroed();
        (axis.size, drive.size) = (size_of::<AxisSetup>() as u32, size_of::<DriveSetup>() as u32);
        assert_eq!(
            [
                standstill_axis_defaults(&mut axis),
                standstill_drive_defaults(&mut drive)
            ],
            [0; 2]
        );
        (axis.velocity, axis.acceleration) = (10.0, 100.0);
        let mut number = 0;
        assert_eq!(standstill_axis_add(runtime, &axis, &drive, &mut number), 0);
        let mut recorded = Recorded {
            key: 0,
            axis: 0,
            reserved: 0,
            name,
            unit: [0; UNIT],
        };
        assert_eq!(
            standstill_instance_make(runtime, c"MC_Home".as_ptr(), &mut recorded.key),
            0
        );
        let size = size_of::<Recorded>() as u32;
        assert_eq!(
            standstill_recorder_size(runtime, &keep, &recorded, size, 1, &mut bytes),
            0
        );
        let mut memory = vec![0_u128; bytes.div_ceil(16)];
        let at = memory.as_mut_ptr().cast();
        assert_eq!(
            standstill_recorder_init(runtime, at, bytes, &keep, &recorded, size, 1),
            0
        );
        for scan in 0..100 {
            if scan == 70 {
                assert_eq!(standstill_recorder_trip(runtime), 0);
            }
            if scan == 75 && is_pushed {
                assert_eq!(standstill_simulate_push(runtime, 1, 0.125), 0);
            }
            assert_eq!(standstill_tick_begin(runtime, scan * TICK), 0);
            assert_eq!(standstill_tick_end(runtime), 0);
        }
        let texts = [0, 1, 2].map(|form| {
            let mut at = Dump {
                size: size_of::<Dump>() as u32,
                form,
                line: 0,
                skip: 0,
                stamp: 0,
            };
            let (mut text, mut piece, mut length) = (Vec::new(), [0_u8; 512], 1);
            while length > 0 {
                let room = piece.as_mut_ptr().cast();
                assert_eq!(
                    standstill_recorder_read(runtime, &mut at, room, piece.len(), &mut length),
                    0
                );
                text.extend_from_slice(&piece[..length]);
            }
            text
        });
        assert_eq!(standstill_runtime_close(runtime), 0);
        texts
    }
}

#[test]
fn explain_and_report_read_what_a_c_host_recorded() {
    let folder = scratch("recorder");
    for (name, is_pushed) in [("still", false), ("pushed", true)] {
        let [lines, table, header] = dumps(is_pushed);
        fs::write(folder.join(format!("{name}.jsonl")), lines).unwrap();
        fs::write(folder.join(format!("{name}.csv")), table).unwrap();
        fs::write(folder.join(format!("{name}.csv.meta.json")), header).unwrap();
    }
    let same = standstill(&folder, &["explain", "still.csv", "still.jsonl"]);
    assert_eq!(
        (same.status, same.out.as_str()),
        (0, "still.csv and still.jsonl are equal to the bit\n"),
        "{}",
        same.err
    );
    let differ = standstill(&folder, &["explain", "still.csv", "pushed.jsonl"]);
    assert_eq!(differ.status, 1, "{}", differ.err);
    // The first row is scan 41 of the machine.
    differ.prints("first difference in scan 34 ");
    differ.prints("axis1.ActualPosition  expected 0.0  found 0.125");
    let report = standstill(&folder, &["report", "still.csv", "--output", "report.html"]);
    assert_eq!(report.status, 0, "{}", report.err);
    let page = read(&folder, "report.html");
    assert!(page.contains("scans 41 to 90 of the machine; tripped by the host in scan 70, here 29"));
}
