//! The interface as C uses it, with all errors of a host: each has its code, changes nothing, and never
//! lets an axis move without a controlled stop. Miri runs this file, too.
#![allow(unsafe_code)]

mod host;
mod recorder;
mod simulated;

use host::{Host, config, size_of_runtime, sized};

use standstill_capi::*;
use std::ffi::CStr;
use std::mem::MaybeUninit;
use std::ptr::{null, null_mut};
use std::thread;

/// MC_MoveVelocity as its header lays it out.
#[repr(C)]
struct MoveVelocityIn {
    size: u32,
    axis: i32,
    execute: u8,
    continuous_update: u8,
    reserved: [u8; 6],
    velocity: f64,
    acceleration: f64,
    deceleration: f64,
    jerk: f64,
    direction: i32,
    buffer_mode: i32,
    snap: f64,
}

#[repr(C)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
struct MoveVelocityOut {
    size: u32,
    in_velocity: u8,
    busy: u8,
    active: u8,
    command_aborted: u8,
    error: u8,
    reserved: u8,
    error_id: u16,
    rest: u32,
}

fn inputs() -> MoveVelocityIn {
    MoveVelocityIn {
        size: size_of::<MoveVelocityIn>() as u32,
        axis: 1,
        execute: 1,
        continuous_update: 0,
        reserved: [0; 6],
        velocity: 10.0,
        acceleration: 0.0,
        deceleration: 0.0,
        jerk: 0.0,
        direction: 0,
        buffer_mode: 0,
        snap: 0.0,
    }
}

fn outputs() -> MoveVelocityOut {
    MoveVelocityOut {
        size: size_of::<MoveVelocityOut>() as u32,
        ..MoveVelocityOut::default()
    }
}

fn velocity(
    runtime: *mut Runtime,
    key: &mut u64,
    inputs: &MoveVelocityIn,
    outputs: &mut MoveVelocityOut,
) -> i32 {
    // SAFETY: all pointers are valid for their types; the runtime is null or a handle.
    unsafe {
        mc_move_velocity(
            runtime,
            key,
            std::ptr::from_ref(inputs).cast(),
            std::ptr::from_mut(outputs).cast(),
        )
    }
}

/// Tick number `scan` with one call.
fn tick(host: &Host, scan: i64, key: &mut u64, inputs: &MoveVelocityIn) -> MoveVelocityOut {
    let mut out = outputs();
    assert_eq!(host.begin(scan * 1_000_000), 0);
    assert_eq!(velocity(host.runtime, key, inputs, &mut out), 0);
    assert_eq!(host.end(), 0);
    out
}

/// A host whose axis has moved for 50 ticks; the next one is number 50.
fn moving() -> (Host, u64) {
    let host = Host::powered();
    let mut key = 0;
    for scan in 0..50 {
        assert_eq!(tick(&host, scan, &mut key, &inputs()).busy, 1);
    }
    assert!(host.status().velocity > 1.0);
    (host, key)
}

/// A host with one powered axis over its own drive, and the feedback of that: enabled, at 0.
fn with_own_drive() -> (Host, Feedback) {
    let host = Host::new(1, 4);
    let (mut axis, mut drive) = Host::setup();
    (axis.start_powered, drive.kind) = (1, 0);
    assert_eq!(host.add(&axis, &drive), Ok(1));
    // SAFETY: a structure of the library.
    let mut feedback = unsafe { sized::<Feedback>() };
    (feedback.enabled, feedback.voltage) = (1, 1);
    (host, feedback)
}

fn tell(host: &Host, feedback: &Feedback) -> i32 {
    // SAFETY: a handle, and as long as its size field says.
    unsafe { standstill_feedback_write(host.runtime, 1, feedback) }
}

#[test]
fn an_instance_begins_with_a_key_of_zero_and_is_found_again() {
    let (host, key) = moving();
    assert_eq!(key, 1 << 32 | 1, "place and generation");
    assert!(host.stop() == 0);
    assert!(host.run_down(50) < 0.011);
}

#[test]
fn the_abi_version_is_asked_for_before_anything_is_touched() {
    assert_eq!(standstill_abi_version(), ABI_VERSION);
    let mut runtime = null_mut();
    // SAFETY: nothing is read or written with another version.
    let code = unsafe { standstill_runtime_init(2, null_mut(), 0, null(), &mut runtime) };
    assert_eq!(code, Code::AbiMismatch as i32);
    assert!(runtime.is_null());
}

#[test]
fn storage_must_be_long_enough_and_aligned() {
    let config = config(1, 1);
    let bytes = size_of_runtime(&config);
    let mut storage = vec![0_u128; bytes.div_ceil(16) + 1];
    let at: *mut u8 = storage.as_mut_ptr().cast();
    let mut runtime = null_mut();
    let mut init = |at: *mut u8, bytes, config: &RuntimeConfig| {
        // SAFETY: inside the storage, and never more bytes than it has.
        unsafe { standstill_runtime_init(1, at.cast(), bytes, config, &mut runtime) }
    };
    assert_eq!(init(at, bytes - 1, &config), Code::Storage as i32);
    // SAFETY: inside the storage.
    assert_eq!(init(unsafe { at.add(8) }, bytes, &config), Code::Storage as i32);
    assert_eq!(init(null_mut(), bytes, &config), Code::NullPointer as i32);
    for wrong in [
        RuntimeConfig { axes: 0, ..config },
        RuntimeConfig { axes: 1025, ..config },
        RuntimeConfig {
            instances: 65_535,
            ..config
        },
        RuntimeConfig {
            cycle_ns: 0,
            ..config
        },
        RuntimeConfig {
            cycle_ns: -1,
            ..config
        },
        RuntimeConfig {
            history: (1 << 24) + 1,
            ..config
        },
    ] {
        assert_eq!(init(at, bytes, &wrong), Code::BadValue as i32);
    }
    assert_eq!(
        init(at, bytes, &RuntimeConfig { size: 23, ..config }),
        Code::StructSize as i32
    );
    assert_eq!(
        init(at, bytes, &RuntimeConfig { size: 99, ..config }),
        0,
        "one of a later version"
    );
}

/// Covers: G80
#[test]
fn a_store_of_cams_is_set_up_once_in_memory_that_is_long_enough_and_aligned() {
    let host = Host::powered();
    let size = |slots, pieces| {
        let mut bytes = 0;
        // SAFETY: the pointer is valid for its type.
        let code = unsafe { standstill_cams_size(slots, pieces, &mut bytes) };
        (code, bytes)
    };
    for (slots, pieces) in [
        (0, 1),
        (1, 0),
        (65_536, 1),
        (1, (1 << 24) + 1),
        (u32::MAX, u32::MAX),
    ] {
        assert_eq!(size(slots, pieces), (Code::BadValue as i32, 0));
    }
    // SAFETY: nothing is written to null.
    assert_eq!(
        unsafe { standstill_cams_size(1, 1, null_mut()) },
        Code::NullPointer as i32
    );
    let (code, bytes) = size(4, 64);
    assert!(code == 0 && bytes > 64 * 100);
    let mut storage = vec![0_u128; bytes.div_ceil(16) + 1];
    let at: *mut u8 = storage.as_mut_ptr().cast();
    let init = |at: *mut u8, bytes, slots| {
        // SAFETY: inside the storage, which lives as long as the host, and never more bytes than it has.
        unsafe { standstill_cams_init(host.runtime, at.cast(), bytes, slots, 64) }
    };
    assert_eq!(init(null_mut(), bytes, 4), Code::NullPointer as i32);
    assert_eq!(init(at, bytes - 1, 4), Code::Storage as i32);
    // SAFETY: inside the storage.
    assert_eq!(init(unsafe { at.add(8) }, bytes, 4), Code::Storage as i32);
    assert_eq!(init(at, bytes, 0), Code::BadValue as i32);
    assert_eq!(host.begin(0), 0);
    assert_eq!(init(at, bytes, 4), Code::InTick as i32);
    assert_eq!(host.end(), 0);
    assert_eq!(init(at, bytes, 4), 0);
    assert_eq!(init(at, bytes, 4), Code::NoRoom as i32, "there is one");
    assert!(host.stop() == 0);
    host.run_down(1);
}

#[test]
fn null_pointers_and_foreign_memory_are_no_runtimes() {
    let mut zeros = [0_u128; 64];
    let zeros: *mut Runtime = zeros.as_mut_ptr().cast();
    let (mut key, mut out) = (0, outputs());
    for (runtime, code) in [(null_mut(), Code::NullPointer), (zeros, Code::NoRuntime)] {
        assert_eq!(velocity(runtime, &mut key, &inputs(), &mut out), code as i32);
        // SAFETY: null, or readable memory.
        unsafe {
            assert_eq!(standstill_tick_begin(runtime, 0), code as i32);
            assert_eq!(standstill_tick_end(runtime), code as i32);
            assert_eq!(standstill_stop(runtime), code as i32);
            assert_eq!(standstill_start(runtime), code as i32);
            assert_eq!(standstill_runtime_close(runtime), code as i32);
            assert_eq!(
                standstill_axis_add(runtime, null(), null(), null_mut()),
                code as i32
            );
            assert_eq!(standstill_simulate(runtime, 1, 0, 0), code as i32);
            assert_eq!(standstill_config_error(runtime, null_mut()), code as i32);
            assert_eq!(standstill_instance_release(runtime, null_mut()), code as i32);
        }
    }
    let (host, _) = moving();
    let odd: *mut Runtime = host.runtime.cast::<u8>().wrapping_add(1).cast();
    assert_eq!(
        velocity(odd, &mut key, &inputs(), &mut out),
        Code::NoRuntime as i32
    );
    assert_eq!((key, out), (0, outputs()));
    // SAFETY: null or a handle.
    unsafe {
        let null_pointer = Code::NullPointer as i32;
        let rt = host.runtime;
        assert_eq!(standstill_axis_add(rt, null(), null(), null_mut()), null_pointer);
        assert_eq!(standstill_axis_read(rt, 1, null_mut()), null_pointer);
        assert_eq!(standstill_feedback_write(rt, 1, null()), null_pointer);
        assert_eq!(standstill_command_read(rt, 1, null_mut()), null_pointer);
        assert_eq!(standstill_config_error(rt, null_mut()), null_pointer);
        assert_eq!(standstill_instance_release(rt, null_mut()), null_pointer);
        assert_eq!(
            standstill_log_read(rt, null_mut(), null_mut(), 96, 0, null_mut()),
            null_pointer
        );
        assert_eq!(standstill_axis_defaults(null_mut()), null_pointer);
        assert_eq!(standstill_drive_defaults(null_mut()), null_pointer);
        assert_eq!(standstill_runtime_size(null(), null_mut()), null_pointer);
        assert_eq!(host.begin(50_000_000), 0);
        let (given, mut taken) = (inputs(), outputs());
        let (given, taken) = (
            std::ptr::from_ref(&given).cast(),
            std::ptr::from_mut(&mut taken).cast(),
        );
        assert_eq!(mc_move_velocity(rt, null_mut(), given, taken), null_pointer);
        assert_eq!(mc_move_velocity(rt, &mut key, null(), taken), null_pointer);
        assert_eq!(mc_move_velocity(rt, &mut key, given, null_mut()), null_pointer);
        assert_eq!(key, 0, "nothing was made");
        assert_eq!(host.end(), 0);
    }
}

#[test]
fn calls_have_their_place_in_a_tick() {
    let (host, mut key) = moving();
    let mut out = outputs();
    assert_eq!(
        velocity(host.runtime, &mut key, &inputs(), &mut out),
        Code::NotInTick as i32
    );
    assert_eq!(host.end(), Code::NotInTick as i32);
    assert_eq!(host.begin(10), Code::TimeBackwards as i32);
    assert_eq!(host.end(), Code::NotInTick as i32, "a refused tick was not begun");
    assert_eq!(host.begin(50_000_000), 0);
    let in_tick = Code::InTick as i32;
    assert_eq!(host.begin(51_000_000), in_tick);
    let (axis, drive) = Host::setup();
    assert_eq!(host.add(&axis, &drive), Err(in_tick));
    assert_eq!(host.close(), in_tick);
    assert_eq!(host.simulate(1, 1, 1), in_tick);
    assert_eq!(out, outputs(), "nothing was written");
    assert_eq!(velocity(host.runtime, &mut key, &inputs(), &mut out), 0);
    assert_eq!(host.end(), 0);
    assert_eq!(host.begin(50_000_000), 0, "the same instant again");
    assert_eq!(host.end(), 0);
    // After all of that the axis is at the same position as without: it was advanced once for each tick.
    let (other, mut key) = moving();
    for scan in [50, 50] {
        tick(&other, scan, &mut key, &inputs());
    }
    assert_eq!(
        host.status().position.to_bits(),
        other.status().position.to_bits()
    );
}

#[test]
fn a_structure_smaller_than_its_version_is_refused() {
    let (host, mut key) = moving();
    let code = Code::StructSize as i32;
    assert_eq!(host.begin(50_000_000), 0);
    let mut out = outputs();
    let small = MoveVelocityIn { size: 63, ..inputs() };
    assert_eq!(velocity(host.runtime, &mut key, &small, &mut out), code);
    assert_eq!(
        velocity(
            host.runtime,
            &mut key,
            &MoveVelocityIn { size: 0, ..inputs() },
            &mut out
        ),
        code
    );
    out.size = 15;
    assert_eq!(velocity(host.runtime, &mut key, &inputs(), &mut out), code);
    out.size = 999;
    assert_eq!(
        velocity(host.runtime, &mut key, &inputs(), &mut out),
        0,
        "one of a later version"
    );
    assert_eq!(host.end(), 0);
    let (axis, drive) = Host::setup();
    assert_eq!(host.add(&AxisSetup { size: 263, ..axis }, &drive), Err(code));
    assert_eq!(host.add(&axis, &DriveSetup { size: 4, ..drive }), Err(code));
    let (mut next, mut copied) = (0, 0);
    // SAFETY: there is no room to write to.
    let read = unsafe { standstill_log_read(host.runtime, &mut next, null_mut(), 95, 0, &mut copied) };
    assert_eq!(read, code);
}

#[test]
fn unknown_keys_and_keys_of_other_blocks_call_nothing() {
    let (host, mut key) = moving();
    let mut out = outputs();
    assert_eq!(host.begin(50_000_000), 0);
    for wrong in [key + 1, key + (1 << 32), 1, 1 << 32, u64::MAX, 5 | 1 << 32] {
        let mut wrong = wrong;
        assert_eq!(
            velocity(host.runtime, &mut wrong, &inputs(), &mut out),
            Code::UnknownKey as i32,
            "{wrong:x}"
        );
    }
    let stop = [0_u8; 128];
    // SAFETY: all long enough for what their sizes say, which are none.
    let code = unsafe { mc_stop(host.runtime, &mut key, stop.as_ptr(), stop.as_ptr().cast_mut()) };
    assert_eq!(code, Code::StructSize as i32);
    let mut given = [0_u8; 128];
    let mut taken = [0_u8; 128];
    (given[0], taken[0]) = (128, 128);
    // SAFETY: as long as their size fields say.
    let code = unsafe { mc_stop(host.runtime, &mut key, given.as_ptr(), taken.as_mut_ptr()) };
    assert_eq!(code, Code::WrongBlock as i32);
    // A key is valid until its place is released.
    let mut old = key;
    assert_eq!((host.release(&mut key), key), (0, 0));
    assert_eq!(host.release(&mut old), Code::UnknownKey as i32);
    assert_eq!(
        velocity(host.runtime, &mut old, &inputs(), &mut out),
        Code::UnknownKey as i32
    );
    assert_eq!(velocity(host.runtime, &mut key, &inputs(), &mut out), 0);
    assert_eq!(key, 2 << 32 | 1);
    assert_eq!(host.end(), 0);
}

#[test]
fn there_is_room_for_what_was_asked_for() {
    let host = Host::powered();
    let (axis, drive) = Host::setup();
    assert_eq!(host.add(&axis, &drive), Err(Code::NoRoom as i32));
    assert_eq!(host.begin(0), 0);
    let mut out = outputs();
    let mut keys = [0; 5];
    let codes = keys
        .each_mut()
        .map(|key| velocity(host.runtime, key, &inputs(), &mut out));
    assert_eq!(codes, [0, 0, 0, 0, Code::NoRoom as i32]);
    assert_eq!(keys[4], 0);
    assert_eq!(host.end(), 0);
}

#[test]
fn an_axis_of_no_number_is_the_blocks_own_error() {
    let host = Host::powered();
    let (mut key, mut out) = (0, outputs());
    assert_eq!(host.begin(0), 0);
    for axis in [0, 2, -1, i32::MAX, i32::MIN] {
        let given = MoveVelocityIn { axis, ..inputs() };
        let (mut key, mut out) = (key, outputs());
        assert_eq!(velocity(host.runtime, &mut key, &given, &mut out), 0);
        assert_eq!((out.error, out.error_id > 0), (1, true), "{axis}");
        assert_eq!(host.release(&mut key), 0);
    }
    assert_eq!(velocity(host.runtime, &mut key, &inputs(), &mut out), 0);
    assert_eq!(host.end(), 0);
    let mut status = host.status();
    // SAFETY: as long as its size field says.
    let read = |axis, status: &mut AxisStatus| unsafe { standstill_axis_read(host.runtime, axis, status) };
    for axis in [0, 2, -1, i32::MIN] {
        assert_eq!(read(axis, &mut status), Code::UnknownAxis as i32);
    }
}

#[test]
fn a_configuration_that_cannot_be_used_is_named() {
    let host = Host::new(1, 1);
    let (axis, drive) = Host::setup();
    let shaped = AxisSetup {
        vibration_frequency: 12.0,
        ..axis
    };
    let rows: [(AxisSetup, DriveSetup, &str, f64); 9] = [
        (
            AxisSetup {
                velocity: 0.0,
                ..axis
            },
            drive,
            "limits.velocity",
            0.0,
        ),
        (AxisSetup { jerk: -5.0, ..axis }, drive, "limits.jerk", -5.0),
        // There is no memory for its past; this is the need.
        (shaped, drive, "vibration", 170.0),
        (
            AxisSetup {
                vibration2_frequency: 300.0,
                ..shaped
            },
            drive,
            "vibration.1.frequency",
            300.0,
        ),
        (
            AxisSetup {
                vibration_shaper: 4,
                ..shaped
            },
            drive,
            "vibration_shaper",
            4.0,
        ),
        (AxisSetup { profile: 8, ..axis }, drive, "profile", 8.0),
        (axis, DriveSetup { kind: 9, ..drive }, "drive.kind", 9.0),
        (axis, DriveSetup { kind: 2, ..drive }, "scaling_increments", 0.0),
        (axis, DriveSetup { kind: 3, ..drive }, "inertia", 0.0),
    ];
    for (axis, drive, key, value) in rows {
        assert_eq!(host.add(&axis, &drive), Err(Code::BadConfig as i32));
        assert_eq!(host.fault(), (key.to_owned(), value));
    }
    assert_eq!(host.add(&axis, &drive), Ok(1));
    assert_eq!(host.close(), 0);
    assert_eq!(host.close(), Code::NoRuntime as i32);
}

/// A period of 84 scans later than without shaping.
#[test]
fn a_shaped_axis_has_its_velocity_when_all_of_it_has_come_out() {
    let host = Host::made(&RuntimeConfig {
        history: 170,
        ..config(1, 4)
    });
    let (axis, drive) = Host::setup();
    let axis = AxisSetup {
        start_powered: 1,
        vibration_frequency: 12.0,
        ..axis
    };
    assert_eq!(host.add(&axis, &drive), Ok(1));
    let mut key = 0;
    for scan in 0..300 {
        let out = tick(&host, scan, &mut key, &inputs());
        // The motion has 10 u/s after 100 scans.
        assert_eq!(out.in_velocity, u8::from(scan >= 184), "{scan}");
        assert_eq!(host.status().velocity == 10.0, scan >= 183, "{scan}");
    }
    assert_eq!(host.stop(), 0);
    assert!(host.run_down(300) <= 0.01 + 1e-12);
}

#[test]
fn two_threads_are_never_in_one_runtime() {
    struct Shared(*mut Runtime);
    // SAFETY: what the other thread does with it is refused, which is what is shown.
    unsafe impl Send for Shared {}
    let (host, mut key) = moving();
    assert_eq!(host.begin(50_000_000), 0);
    let shared = Shared(host.runtime);
    let mut stolen = key;
    let codes = thread::spawn(move || {
        let shared = shared;
        let mut out = outputs();
        // SAFETY: the host outlives the thread.
        unsafe {
            [
                velocity(shared.0, &mut stolen, &inputs(), &mut out),
                standstill_tick_end(shared.0),
                standstill_tick_begin(shared.0, 51_000_000),
                standstill_stop(shared.0),
                standstill_runtime_close(shared.0),
            ]
        }
    })
    .join()
    .unwrap();
    assert_eq!(codes, [Code::OtherThread as i32; 5]);
    let mut out = outputs();
    assert_eq!(velocity(host.runtime, &mut key, &inputs(), &mut out), 0);
    assert_eq!(host.end(), 0);
    // Between ticks a runtime may change hands.
    let shared = Shared(host.runtime);
    let codes = thread::spawn(move || {
        let shared = shared;
        // SAFETY: the host outlives the thread.
        unsafe {
            [
                standstill_tick_begin(shared.0, 51_000_000),
                standstill_tick_end(shared.0),
            ]
        }
    })
    .join()
    .unwrap();
    assert_eq!(codes, [0, 0]);
}

#[test]
fn threads_that_race_for_a_runtime_get_a_code_or_a_whole_tick() {
    struct Shared(*mut Runtime);
    // SAFETY: the runtime refuses a second thread.
    unsafe impl Send for Shared {}
    let (host, _) = moving();
    let rounds = if cfg!(miri) { 20 } else { 20_000 };
    let workers: Vec<_> = (0..3)
        .map(|_| {
            let shared = Shared(host.runtime);
            thread::spawn(move || {
                let shared = shared;
                let mut ticks = 0_u64;
                for _ in 0..rounds {
                    // SAFETY: the host outlives the thread.
                    let begun = unsafe { standstill_tick_begin(shared.0, 60_000_000) };
                    if begun == 0 {
                        // SAFETY: as above.
                        assert_eq!(unsafe { standstill_tick_end(shared.0) }, 0);
                        ticks += 1;
                    } else {
                        assert_eq!(begun, Code::OtherThread as i32);
                    }
                }
                ticks
            })
        })
        .collect();
    let ticks: u64 = workers.into_iter().map(|worker| worker.join().unwrap()).sum();
    assert!(ticks > 0);
    // Each tick advanced the motion once: at 10 u/s by a hundredth of a unit.
    let went = host.status().position;
    assert!(
        (went - (ticks as f64 - 1.0) * 0.01).abs() < 1.0,
        "{ticks} ticks, {went}"
    );
}

#[test]
fn stop_ramps_down_and_calls_no_block_until_start() {
    let (host, mut key) = moving();
    let mut out = outputs();
    assert_eq!(host.close(), Code::NotOff as i32);
    // SAFETY: a handle.
    let start = || unsafe { standstill_start(host.runtime) };
    assert_eq!(start(), 0, "it runs already");
    assert_eq!(host.stop(), 0);
    assert_eq!(start(), Code::NotOff as i32);
    let mut before = host.status();
    let mut scan = 50;
    while start() == Code::NotOff as i32 {
        assert_eq!(host.begin(scan * 1_000_000), 0);
        assert_eq!(
            velocity(host.runtime, &mut key, &inputs(), &mut out),
            Code::Stopped as i32
        );
        assert_eq!(host.end(), 0);
        let now = host.status();
        // No faster than the deceleration of the axis.
        assert!((now.velocity - before.velocity).abs() <= 100.0 * 0.001 + 1e-9);
        before = now;
        scan += 1;
        assert!(scan < 500);
    }
    tick(&host, scan, &mut key, &inputs());
}

#[test]
fn a_host_that_goes_silent_loses_its_own_drive_and_the_axis_stops() {
    let (host, mut feedback) = with_own_drive();
    assert_eq!(host.simulate(1, 1, 5), Code::WrongDrive as i32);
    let (mut key, mut out) = (0, outputs());
    for scan in 0..100 {
        if scan < 50 {
            assert_eq!(tell(&host, &feedback), 0);
        }
        out = tick(&host, scan, &mut key, &inputs());
        // SAFETY: a handle, and a structure of the library.
        feedback.position = unsafe {
            let mut command = sized::<Command>();
            assert_eq!(standstill_command_read(host.runtime, 1, &mut command), 0);
            command.position
        };
    }
    assert_eq!((out.error, host.status().state), (1, 7), "ErrorStop");
    for wrong in [
        Feedback {
            position: f64::NAN,
            ..feedback
        },
        Feedback {
            position: f64::INFINITY,
            ..feedback
        },
        Feedback {
            homing: 5,
            ..feedback
        },
        Feedback {
            torque_known: 1,
            torque: f64::NAN,
            ..feedback
        },
        Feedback {
            torque_known: 1,
            torque: f64::NEG_INFINITY,
            ..feedback
        },
        Feedback {
            probe_latched: [0, 1],
            probe_position: [0.0, f64::NAN],
            ..feedback
        },
        Feedback {
            marker_latched: 1,
            marker_position: f64::INFINITY,
            ..feedback
        },
        Feedback {
            homing: 3,
            home_position: f64::NAN,
            ..feedback
        },
    ] {
        assert_eq!(tell(&host, &wrong), Code::BadValue as i32);
    }
}

/// Covers: R98
#[test]
fn a_feedback_that_is_no_number_is_refused_and_the_axis_tells_why_it_stops() {
    let (host, feedback) = with_own_drive();
    let wrong = Feedback {
        position: f64::NAN,
        ..feedback
    };
    let tell = |feedback: &Feedback| tell(&host, feedback);
    let bad = Code::BadValue as i32;
    let mut now = 0;
    let mut tick = || {
        now += 1_000_000;
        assert_eq!(host.begin(now), 0);
        assert_eq!(host.end(), 0);
        let status = host.status();
        assert!(status.position == 0.0 && status.actual_position == 0.0);
        (status.state, status.error_id)
    };
    // A refused report does not change an accepted one of the same tick, before or after it.
    assert_eq!((tell(&feedback), tell(&wrong)), (0, bad));
    assert_eq!(tick(), (1, 0));
    assert_eq!((tell(&wrong), tell(&feedback)), (bad, 0));
    assert_eq!(tick(), (1, 0));
    // Alone it leaves the tick without feedback.
    assert_eq!(tell(&wrong), bad);
    assert_eq!(tick(), (7, 602));
    // The first error stays, for any later ones.
    assert_eq!(tick(), (7, 602));
}

#[test]
fn simulated_drives_fail_when_told_to() {
    let (host, mut key) = moving();
    for none in [-1, 9] {
        assert_eq!(host.simulate(1, none, 0), Code::BadValue as i32);
    }
    assert_eq!(host.simulate(1, 1, 0x7500), 0);
    tick(&host, 50, &mut key, &inputs());
    let status = host.status();
    assert_eq!((status.state, status.error_code), (7, 0x7500));
    assert_eq!(host.simulate(1, 0, 0), 0);
}

/// A profile of two points, and invalid tables.
#[test]
fn arrays_come_as_an_address_and_a_count() {
    #[repr(C)]
    struct Point {
        delta_time: i64,
        position: f64,
        level: u64,
    }
    #[repr(C)]
    struct In {
        size: u32,
        axis: i32,
        points: *const Point,
        count: u32,
        execute: u8,
        continuous_update: u8,
        reserved: [u8; 2],
        time_scale: f64,
        position_scale: f64,
        offset: f64,
        buffer_mode: i32,
        rest: u32,
    }
    let host = Host::powered();
    let points = [(500_000_000, 1.0), (500_000_000, 2.0)].map(|(delta_time, position)| Point {
        delta_time,
        position,
        level: 0,
    });
    let given = |points: *const Point, count| In {
        size: size_of::<In>() as u32,
        axis: 1,
        points,
        count,
        execute: 1,
        continuous_update: 0,
        reserved: [0; 2],
        time_scale: 1.0,
        position_scale: 1.0,
        offset: 0.0,
        buffer_mode: 0,
        rest: 0,
    };
    let mut out = [0_u64; 2];
    let mut call = |key: &mut u64, given: &In| {
        out = [16, 0];
        // SAFETY: all as their sizes and counts say, but for what is refused before it is read.
        let code = unsafe {
            mc_position_profile(
                host.runtime,
                key,
                std::ptr::from_ref(given).cast(),
                out.as_mut_ptr().cast(),
            )
        };
        (code, out[0].to_le_bytes()[4])
    };
    let table = Code::Table as i32;
    assert_eq!(host.begin(0), 0);
    let mut key = 0;
    assert_eq!(call(&mut key, &given(null(), 1)).0, table);
    assert_eq!(call(&mut key, &given(points.as_ptr(), 41)).0, table);
    assert_eq!(call(&mut key, &given(points.as_ptr(), u32::MAX)).0, table);
    assert_eq!(key, 0);
    assert_eq!(host.end(), 0);
    let mut done = 0;
    for scan in 1..1500 {
        assert_eq!(host.begin(scan * 1_000_000), 0);
        let (code, finished) = call(&mut key, &given(points.as_ptr(), 2));
        assert_eq!(code, 0);
        done = finished;
        assert_eq!(host.end(), 0);
        if cfg!(miri) && scan > 30 {
            return;
        }
    }
    assert_eq!((done, host.status().position), (1, 2.0));
}

#[test]
fn the_ring_is_read_in_pieces_and_what_was_overwritten_is_skipped() {
    let host = Host::powered();
    let mut key = 0;
    // Refused at every other tick, with a record each.
    for scan in 0..200_i64 {
        let given = MoveVelocityIn {
            velocity: f64::NAN,
            execute: u8::from(scan % 2 == 0),
            ..inputs()
        };
        tick(&host, scan, &mut key, &given);
    }
    let mut next = 0_u64;
    let mut numbers = Vec::new();
    loop {
        let mut records = [const { MaybeUninit::<Record>::uninit() }; 10];
        let mut copied = 0;
        // SAFETY: room for ten.
        let code = unsafe {
            standstill_log_read(
                host.runtime,
                &mut next,
                records.as_mut_ptr().cast(),
                96,
                10,
                &mut copied,
            )
        };
        assert_eq!(code, 0);
        for record in &records[..copied as usize] {
            // SAFETY: it was copied.
            let record = unsafe { record.assume_init() };
            assert_eq!((record.event, record.axis, record.instance), (1, 1, 1));
            // SAFETY: a name ends in 0.
            let name = unsafe { CStr::from_ptr(record.name.as_ptr()) };
            assert_eq!(name.to_str(), Ok("Velocity"));
            numbers.push(record.number);
        }
        if copied == 0 {
            break;
        }
    }
    assert_eq!(numbers, (36..100).collect::<Vec<_>>(), "the last 64 of 100");
    assert_eq!(next, 100);
    let mut far = u64::MAX;
    let mut copied = 7;
    // SAFETY: no room is needed.
    let code = unsafe { standstill_log_read(host.runtime, &mut far, null_mut(), 96, 0, &mut copied) };
    assert_eq!((code, copied, far), (0, 0, 100));
}

#[test]
fn several_runtimes_do_not_know_each_other() {
    let (one, other) = (moving().0, Host::powered());
    assert_eq!((one.begin(50_000_000), other.begin(0)), (0, 0));
    let (mut key, mut out) = (0, outputs());
    let given = MoveVelocityIn {
        velocity: -5.0,
        ..inputs()
    };
    assert_eq!(velocity(other.runtime, &mut key, &given, &mut out), 0);
    assert_eq!((one.end(), other.end()), (0, 0));
    assert!(one.status().velocity > 0.0 && other.status().velocity < 0.0);
}

#[test]
fn every_code_has_its_text() {
    let text = |code| {
        // SAFETY: a text of the library, ending in 0.
        unsafe { CStr::from_ptr(standstill_result_text(code)) }
            .to_str()
            .unwrap()
    };
    let known: Vec<_> = (-21..=0).map(text).collect();
    for (index, one) in known.iter().enumerate() {
        assert!(known.iter().skip(index + 1).all(|other| one != other), "{one}");
    }
    assert_eq!(text(1), text(-22), "not a result");
}
