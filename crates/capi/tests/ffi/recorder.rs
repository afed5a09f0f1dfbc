//! The flight recorder in memory of the host: its contents, its dump, and every wrong use.

use crate::host::{Host, sized};
use crate::inputs;
use standstill_capi::*;
use std::ffi::{CStr, c_char};
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};

const TICK: i64 = 1_000_000;

const ENTRY: u32 = size_of::<Recorded>() as u32;

fn keep(scans: u32, after: u32) -> RecorderConfig {
    RecorderConfig {
        size: size_of::<RecorderConfig>() as u32,
        scans,
        after,
        records: 16,
        trigger: 0,
        reserved: 0,
    }
}

fn text<const N: usize>(name: &str) -> [c_char; N] {
    let mut text = [0; N];
    for (to, from) in text.iter_mut().zip(name.bytes()) {
        *to = from as c_char;
    }
    text
}

fn entry(key: u64, axis: i32, name: &str, unit: &str) -> Recorded {
    Recorded {
        key,
        axis,
        reserved: 0,
        name: text(name),
        unit: text(unit),
    }
}

fn make(host: &Host, block: &CStr) -> Result<u64, i32> {
    let mut key = 0;
    // SAFETY: all pointers are valid for their types.
    match unsafe { standstill_instance_make(host.runtime, block.as_ptr(), &mut key) } {
        0 => Ok(key),
        code => Err(code),
    }
}

/// Memory of a recorder, which outlives it in every test.
fn init(host: &Host, config: &RecorderConfig, recorded: &[Recorded]) -> Result<Vec<u128>, i32> {
    let (mut bytes, count) = (0, recorded.len() as u32);
    // SAFETY: all pointers are valid for their types.
    let code = unsafe {
        standstill_recorder_size(host.runtime, config, recorded.as_ptr(), ENTRY, count, &mut bytes)
    };
    // Names are checked when it is made.
    let bytes = if code == 0 { bytes } else { 4096 };
    let mut storage = vec![0_u128; bytes.div_ceil(16)];
    // SAFETY: the storage is as long as it says.
    let made = unsafe {
        let at = storage.as_mut_ptr().cast();
        standstill_recorder_init(host.runtime, at, bytes, config, recorded.as_ptr(), ENTRY, count)
    };
    if made == 0 { Ok(storage) } else { Err(made) }
}

fn state(host: &Host) -> Result<RecorderStatus, i32> {
    // SAFETY: a handle, and a structure of the library.
    unsafe {
        let mut status = sized();
        match standstill_recorder_state(host.runtime, &mut status) {
            0 => Ok(status),
            code => Err(code),
        }
    }
}

fn dump(form: i32) -> Dump {
    Dump {
        size: size_of::<Dump>() as u32,
        form,
        line: 0,
        skip: 0,
        stamp: 0,
    }
}

/// One part, of at most `room` bytes.
fn piece(host: &Host, at: &mut Dump, room: usize) -> Result<String, i32> {
    // Memory that was never written: none of it may be read.
    let mut buffer = vec![MaybeUninit::<u8>::uninit(); room];
    let mut length = usize::MAX;
    // SAFETY: so much room is there.
    let code =
        unsafe { standstill_recorder_read(host.runtime, at, buffer.as_mut_ptr().cast(), room, &mut length) };
    if code != 0 {
        return Err(code);
    }
    // SAFETY: the library says that so many were written.
    let bytes = buffer[..length].iter().map(|byte| unsafe { byte.assume_init() });
    Ok(String::from_utf8(bytes.collect()).unwrap())
}

fn whole(host: &Host, form: i32, room: usize) -> String {
    let (mut at, mut all) = (dump(form), String::new());
    loop {
        let next = piece(host, &mut at, room).unwrap();
        if next.is_empty() {
            return all;
        }
        all += &next;
    }
}

/// Moves an axis for `scans` ticks from `from` on.
fn tick(host: &Host, key: &mut u64, from: i64, scans: i64) {
    for scan in from..from + scans {
        crate::tick(host, scan, key, &inputs());
    }
}

#[test]
fn it_keeps_the_last_scans_and_freezes_after_an_error_stop() {
    let host = Host::powered();
    let mut key = make(&host, c"mc_movevelocity").unwrap();
    let _memory = init(
        &host,
        &keep(10, 3),
        &[entry(key, 0, "go", ""), entry(0, 1, "X", "mm")],
    )
    .unwrap();
    tick(&host, &mut key, 0, 20);
    let now = state(&host).unwrap();
    assert_eq!((now.state, now.first, now.scans, now.left), (0, 10, 10, 0));
    assert_eq!(host.simulate(1, 1, 0x7500), 0);
    tick(&host, &mut key, 20, 1);
    let now = state(&host).unwrap();
    assert_eq!((now.state, now.tripped_at, now.axis, now.left), (1, 20, 1, 2));
    tick(&host, &mut key, 21, 9);
    let now = state(&host).unwrap();
    assert_eq!((now.state, now.first, now.scans, now.tripped_at), (2, 14, 10, 20));

    // The same text for parts of any size.
    let texts = [0, 1, 2].map(|form| whole(&host, form, 1 << 16));
    // Every part makes its line again, which takes Miri long.
    let rooms: &[usize] = if cfg!(miri) { &[2000] } else { &[7, 100] };
    for (form, expected) in (0..).zip(&texts) {
        for &room in rooms {
            assert_eq!(whole(&host, form, room), *expected, "form {form}, {room} bytes");
        }
    }
    let [lines, table, header] = &texts;
    assert_eq!(
        (
            lines.lines().count(),
            table.lines().count(),
            header.lines().count()
        ),
        (11, 11, 1)
    );
    assert_eq!(lines.lines().next(), header.lines().next());
    let first: Vec<_> = table.lines().nth(1).unwrap().split(',').take(4).collect();
    assert_eq!(first[..3], ["0", "0", "ContinuousMotion"]);
    let sixth = table.lines().nth(7).unwrap();
    assert!(sixth.starts_with("6,6000000,ErrorStop,"), "{sixth}");
    assert!(header.contains("scans 14 to 23 of the machine; tripped by ErrorStop of X in scan 20, here 6"));
    assert!(header.contains("fault 501 DriveFault, code 29952"));

    // Its text is that of every trace: read and written again it is the same.
    let table = standstill_trace::csv::read(table, Some(header)).unwrap();
    assert!(table.lacks.is_empty());
    let mut again = Vec::new();
    standstill_trace::jsonl::write(&table.trace, &mut again).unwrap();
    assert_eq!(String::from_utf8(again).unwrap(), *lines);
    let mut again = Vec::new();
    standstill_trace::csv::write(&table.trace, &mut again).unwrap();
    assert_eq!(String::from_utf8(again).unwrap(), texts[1]);

    // Armed again it is empty. It waits for an axis that goes into ErrorStop, not for one that is already there.
    // SAFETY: a handle.
    assert_eq!(unsafe { standstill_recorder_arm(host.runtime) }, 0);
    assert_eq!(state(&host).unwrap().scans, 0);
    tick(&host, &mut key, 30, 4);
    let now = state(&host).unwrap();
    assert_eq!((now.state, now.first, now.scans), (0, 30, 4));
    // SAFETY: a handle.
    assert_eq!(unsafe { standstill_recorder_trip(host.runtime) }, 0);
    tick(&host, &mut key, 34, 9);
    let now = state(&host).unwrap();
    assert_eq!((now.state, now.tripped_at, now.axis, now.scans), (2, 34, 0, 8));
}

/// The trace has the inputs of a block that does nothing as they were given, and zeros for a released instance.
#[test]
fn what_a_resting_block_was_given_is_recorded() {
    let host = Host::powered();
    let mut key = make(&host, c"MC_MoveVelocity").unwrap();
    let _memory = init(&host, &keep(4, 0), &[entry(key, 0, "go", "")]).unwrap();
    tick(&host, &mut key, 0, 300);
    // Without an edge the block ignores a new velocity.
    let other = 3.25;
    let changed = crate::MoveVelocityIn {
        velocity: other,
        ..inputs()
    };
    assert_eq!(crate::tick(&host, 300, &mut key, &changed).in_velocity, 1);
    assert_eq!(host.release(&mut key), 0);
    assert_eq!((host.begin(301 * TICK), host.end()), (0, 0));
    let (table, header) = (whole(&host, 1, 1 << 16), whole(&host, 2, 1 << 16));
    let trace = standstill_trace::csv::read(&table, Some(&header)).unwrap().trace;
    let column = trace.column("go.Velocity").unwrap();
    let real = |scan| match trace.cell(scan, column) {
        Some(standstill_trace::Cell::Real(value)) => value,
        found => panic!("{found:?}"),
    };
    assert_eq!([real(1), real(2), real(3)], [10.0, other, 0.0]);
    assert_eq!(trace.header().axes[0].name, "axis1");
}

#[test]
fn a_recorder_that_cannot_be_made_changes_nothing() {
    let host = Host::powered();
    let key = make(&host, c"MC_MoveVelocity").unwrap();
    let go = entry(key, 0, "go", "");
    let bad = Code::BadValue as i32;
    for wrong in [
        keep(0, 0),
        keep(10, 10),
        keep(u32::MAX, 0),
        RecorderConfig {
            trigger: 2,
            ..keep(10, 0)
        },
        RecorderConfig {
            reserved: 1,
            ..keep(10, 0)
        },
        RecorderConfig {
            records: u32::MAX,
            ..keep(10, 0)
        },
    ] {
        assert_eq!(init(&host, &wrong, &[go]).unwrap_err(), bad, "{wrong:?}");
    }
    let unended = Recorded {
        name: [b'a' as c_char; 32],
        ..go
    };
    let foreign = Recorded {
        unit: [-1_i8 as c_char; 16],
        ..go
    };
    for wrong in [
        entry(key, 0, "", ""),
        entry(key, 0, "1st", ""),
        entry(key, 0, "two words", ""),
        entry(0, 1, "X", "\""),
        entry(key, 0, "AXIS1", ""),
        unended,
        foreign,
    ] {
        assert_eq!(init(&host, &keep(10, 0), &[wrong]).unwrap_err(), bad);
    }
    assert_eq!(init(&host, &keep(10, 0), &[go, go]).unwrap_err(), bad, "twice");
    let unknown = Code::UnknownAxis as i32;
    for axis in [-1, 2, i32::MAX] {
        assert_eq!(
            init(&host, &keep(10, 0), &[entry(0, axis, "Y", "")]).unwrap_err(),
            unknown
        );
    }
    let unknown = Code::UnknownKey as i32;
    for wrong in [0, key + 1, key + (1 << 32)] {
        assert_eq!(
            init(&host, &keep(10, 0), &[entry(wrong, 0, "a", "")]).unwrap_err(),
            unknown
        );
    }
    assert_eq!(make(&host, c"MC_Nothing"), Err(bad));
    assert_eq!(make(&host, c"\xff"), Err(bad));

    let rt = host.runtime;
    let config = keep(4, 0);
    let mut bytes = 0;
    let mut storage = vec![0_u128; 4096];
    let at: *mut core::ffi::c_void = storage.as_mut_ptr().cast();
    // SAFETY: pointers are null or valid for their types.
    unsafe {
        let size = |config, list, size, bytes| standstill_recorder_size(rt, config, list, size, 1, bytes);
        let null_pointer = Code::NullPointer as i32;
        assert_eq!(size(null(), &go, ENTRY, &mut bytes), null_pointer);
        assert_eq!(size(&config, null(), ENTRY, &mut bytes), null_pointer);
        assert_eq!(size(&config, &go, ENTRY, null_mut()), null_pointer);
        assert_eq!(size(&config, &go, ENTRY - 1, &mut bytes), Code::StructSize as i32);
        let small = RecorderConfig { size: 23, ..config };
        assert_eq!(size(&small, &go, ENTRY, &mut bytes), Code::StructSize as i32);
        assert_eq!(size(&config, &go, ENTRY, &mut bytes), 0);
        let make = |at, bytes| standstill_recorder_init(rt, at, bytes, &config, &go, ENTRY, 1);
        assert_eq!(make(null_mut(), bytes), null_pointer);
        assert_eq!(make(at, bytes - 1), Code::Storage as i32);
        assert_eq!(make(at.cast::<u8>().add(8).cast(), bytes), Code::Storage as i32);
        let none = Code::NoRecorder as i32;
        assert_eq!(
            [standstill_recorder_end(rt), standstill_recorder_trip(rt)],
            [none; 2]
        );
        assert_eq!(standstill_recorder_arm(rt), none);
        assert_eq!(state(&host).unwrap_err(), none);
        assert_eq!(piece(&host, &mut dump(0), 100), Err(none));
        assert_eq!(make(at, bytes), 0);
        assert_eq!(make(at, bytes), Code::NoRoom as i32, "there is one");
        // Into its own memory again, once it was taken away.
        assert_eq!(standstill_recorder_end(rt), 0);
        assert_eq!(make(at, bytes), 0);
        let in_tick = Code::InTick as i32;
        assert_eq!(host.begin(0), 0);
        assert_eq!([make(at, bytes), standstill_recorder_end(rt)], [in_tick; 2]);
        assert_eq!(piece(&host, &mut dump(0), 100), Err(in_tick));
        assert_eq!(host.end(), 0);
    }
    // A partial dump cannot be continued after another scan was kept.
    let mut at = dump(0);
    assert_eq!(piece(&host, &mut at, 10).unwrap(), "{\"standsti");
    assert_eq!(piece(&host, &mut at, 0).unwrap(), "");
    assert_eq!((host.begin(TICK), host.end()), (0, 0));
    assert_eq!(piece(&host, &mut at, 10), Err(bad));
    for form in [-1, 3] {
        assert_eq!(piece(&host, &mut dump(form), 10), Err(bad));
    }
    // SAFETY: pointers are null or valid for their types.
    unsafe {
        let (mut at, mut length) = (dump(0), 0);
        let null_pointer = Code::NullPointer as i32;
        assert_eq!(
            standstill_recorder_read(rt, null_mut(), null_mut(), 0, &mut length),
            null_pointer
        );
        assert_eq!(
            standstill_recorder_read(rt, &mut at, null_mut(), 1, &mut length),
            null_pointer
        );
        assert_eq!(
            standstill_recorder_read(rt, &mut at, null_mut(), 0, null_mut()),
            null_pointer
        );
    }
    // A place far outside has no text.
    let mut far = Dump {
        line: u64::MAX,
        skip: u64::MAX,
        stamp: 2,
        ..dump(1)
    };
    assert_eq!(piece(&host, &mut far, 10).unwrap(), "");
    // Stopped, off and closed with a recorder in it.
    assert_eq!(host.stop(), 0);
    host.run_down(2);
}

#[repr(C)]
struct SetPositionIn {
    size: u32,
    axis: i32,
    execute: u8,
    reserved: [u8; 7],
    position: f64,
    relative: u8,
    reserved_25: [u8; 3],
    execution_mode: i32,
}

#[repr(C)]
#[derive(Default)]
struct SetPositionOut {
    size: u32,
    done: u8,
    rest: [u8; 11],
}

/// The ring of records holds 64. If 70 axes shift their coordinates in one tick, it loses some records.
#[test]
fn the_moves_of_70_axes_in_one_tick_are_told() {
    const AXES: i32 = 70;
    let host = Host::new(AXES as u32, AXES as u32);
    let (mut axis, drive) = Host::setup();
    axis.start_powered = 1;
    for number in 1..=AXES {
        assert_eq!(host.add(&axis, &drive), Ok(number));
    }
    let _memory = init(&host, &keep(10, 3), &[]).unwrap();
    assert_eq!(host.begin(0), 0);
    for axis in 1..=AXES {
        let given = SetPositionIn {
            size: size_of::<SetPositionIn>() as u32,
            axis,
            execute: 1,
            reserved: [0; 7],
            position: 3.0,
            relative: 1,
            reserved_25: [0; 3],
            execution_mode: 0,
        };
        let mut out = SetPositionOut {
            size: size_of::<SetPositionOut>() as u32,
            ..SetPositionOut::default()
        };
        let mut key = 0;
        // SAFETY: all pointers are valid for their types.
        let code = unsafe {
            mc_set_position(
                host.runtime,
                &mut key,
                std::ptr::from_ref(&given).cast(),
                std::ptr::from_mut(&mut out).cast(),
            )
        };
        assert_eq!((code, out.done), (0, 1));
    }
    assert_eq!(host.end(), 0);
    let header = whole(&host, 2, 1 << 16);
    assert_eq!(header.matches("coordinates moved by 3.0").count(), AXES as usize);
}
