//! The parts of simulated drives, and their faults.

use crate::host::Host;
use crate::{inputs, tick};
use standstill_capi::*;

const TICK: i64 = 1_000_000;

/// Bytes of the drive's structure in the first header.
const FIRST: u32 = 96;

/// A host compiled with the first header does not know later fields: they are neither read nor written.
#[test]
fn the_drive_of_the_first_header_is_served() {
    let host = Host::new(1, 4);
    let (axis, mut drive) = Host::setup();
    drive.size = FIRST - 1;
    assert_eq!(host.add(&axis, &drive), Err(Code::StructSize as i32));
    // Behind the old structure there is other data of the host, here an axis that would be refused.
    drive.size = FIRST;
    (drive.limit_switches, drive.limit_switch_negative) = (1, f64::NAN);
    drive.delay = 7;
    // SAFETY: at least as long as its size field says.
    assert_eq!(unsafe { standstill_drive_defaults(&mut drive) }, 0);
    assert_eq!((drive.size, drive.delay, drive.limit_switches), (FIRST, 0, 1));
    assert!(drive.limit_switch_negative.is_nan());
    assert_eq!(host.add(&axis, &drive), Ok(1));
    // Exactly those bytes are enough.
    let bytes = vec![0_u64; FIRST as usize / 8].into_boxed_slice();
    let old = Box::into_raw(bytes).cast::<DriveSetup>();
    let other = Host::new(1, 4);
    // SAFETY: the memory is as long as the size in front says, and freed once.
    unsafe {
        old.cast::<u32>().write(FIRST);
        assert_eq!(standstill_drive_defaults(old), 0);
        let mut number = 0;
        assert_eq!(standstill_axis_add(other.runtime, &axis, old, &mut number), 0);
        drop(Box::from_raw(std::ptr::slice_from_raw_parts_mut(
            old.cast::<u64>(),
            FIRST as usize / 8,
        )));
    }
}

/// Bytes of the first axis_setup.
const FIRST_AXIS: u32 = 264;

#[test]
fn an_axis_of_the_first_header_has_no_power_timeout() {
    let host = Host::new(1, 4);
    let (mut axis, drive) = Host::setup();
    axis.size = FIRST_AXIS;
    axis.power_timeout = 7;
    axis.on_limit = 9;
    // SAFETY: at least as long as its size field says.
    assert_eq!(unsafe { standstill_axis_defaults(&mut axis) }, 0);
    let behind = (axis.size, axis.power_timeout, axis.on_limit);
    assert_eq!(behind, (FIRST_AXIS, 7, 9), "behind its end");
    (axis.velocity, axis.acceleration) = (10.0, 100.0);
    let never = DriveSetup {
        power_on: -1,
        ..drive
    };
    assert_eq!(host.add(&axis, &never), Ok(1));
    assert_eq!(switched_on(&host, 50), (0, 0), "it waits for ever");
}

#[test]
fn power_that_is_not_confirmed_is_an_error_of_mc_power() {
    let host = Host::new(1, 4);
    let (axis, drive) = Host::setup();
    let axis = AxisSetup {
        power_timeout: 20,
        ..axis
    };
    let never = DriveSetup {
        power_on: -1,
        ..drive
    };
    assert_eq!(host.add(&axis, &never), Ok(1));
    // Requested in the first tick, so that the last one in time is the twenty-first.
    assert_eq!(switched_on(&host, 20), (0, 0));
    let other = Host::new(1, 4);
    assert_eq!(other.add(&axis, &never), Ok(1));
    assert_eq!(switched_on(&other, 21), (503, 0), "the axis stays Disabled");
}

/// Calls MC_Power with Enable in this number of ticks. Returns its ErrorID and the state of the axis in the last
/// one.
fn switched_on(host: &Host, ticks: i64) -> (u32, i32) {
    #[repr(C)]
    struct In {
        size: u32,
        axis: i32,
        enable: u8,
        enable_positive: u8,
        enable_negative: u8,
        reserved: [u8; 5],
    }
    #[repr(C)]
    #[derive(Default)]
    struct Out {
        size: u32,
        status: u8,
        valid: u8,
        error: u8,
        reserved: u8,
        error_id: u16,
        reserved_2: [u8; 6],
    }
    let (mut key, mut out) = (0, Out::default());
    out.size = size_of::<Out>() as u32;
    let inputs = In {
        size: size_of::<In>() as u32,
        axis: 1,
        enable: 1,
        enable_positive: 1,
        enable_negative: 1,
        reserved: [0; 5],
    };
    for tick in 0..ticks {
        assert_eq!(host.begin(tick * 1_000_000), 0);
        // SAFETY: structures of the sizes they say.
        let code = unsafe {
            mc_power(
                host.runtime,
                &mut key,
                (&raw const inputs).cast(),
                (&raw mut out).cast(),
            )
        };
        assert_eq!((code, out.status), (0, 0));
        assert_eq!(out.error != 0, out.error_id != 0);
        assert_eq!(host.end(), 0);
    }
    (out.error_id.into(), host.status().state)
}

/// Covers: R98
#[test]
fn a_simulated_drive_tells_what_it_is_told_to() {
    let host = Host::new(3, 4);
    let (axis, drive) = Host::setup();
    let axis = AxisSetup {
        start_powered: 1,
        max_following_error: 1.0,
        ..axis
    };
    let counts = AxisSetup {
        scaling_increments: 1000,
        ..axis
    };
    let own = DriveSetup { kind: 0, ..drive };
    assert_eq!(host.add(&axis, &drive), Ok(1));
    assert_eq!(host.add(&counts, &drive), Ok(2));
    assert_eq!(host.add(&axis, &own), Ok(3));
    // SAFETY: a handle.
    let report =
        |axis, quantity, value| unsafe { standstill_simulate_report(host.runtime, axis, quantity, value) };
    let (bad, wrong) = (Code::BadValue as i32, Code::WrongDrive as i32);
    assert_eq!(
        (report(4, 0, 1.0), report(3, 0, 1.0)),
        (Code::UnknownAxis as i32, wrong)
    );
    assert_eq!((report(1, 2, 1.0), report(1, -1, 1.0)), (bad, bad));
    for no_count in [f64::NAN, 0.5, 1e300] {
        assert_eq!(report(2, 0, no_count), bad, "{no_count}");
    }
    assert_eq!(
        (report(1, 0, f64::NAN), report(2, 0, -1001.0), report(1, 1, 7.0)),
        (0, 0, 0)
    );
    assert_eq!(
        (host.begin(0), report(1, 0, 1.0), host.end()),
        (0, Code::InTick as i32, 0)
    );
    let errors = || [1, 2].map(|axis| host.status_of(axis).error_id);
    assert_eq!(errors(), [602, 404]);
    assert_eq!(host.status_of(2).actual_position, -1.001);
    assert_eq!((host.simulate(1, 0, 0), host.simulate(2, 0, 0)), (0, 0));
    assert_eq!((host.begin(1_000_000), host.end()), (0, 0));
    assert_eq!(host.status_of(2).actual_position, 0.0);
}

#[test]
fn what_a_drive_cannot_have_is_named() {
    let host = Host::new(1, 4);
    let (mut axis, ideal) = Host::setup();
    let refused = |axis: &AxisSetup, drive: &DriveSetup| {
        assert_eq!(host.add(axis, drive), Err(Code::BadConfig as i32));
        host.fault()
    };
    let mut drive = ideal;
    (
        drive.limit_switches,
        drive.limit_switch_negative,
        drive.limit_switch_positive,
    ) = (1, 5.0, 4.0);
    assert_eq!(
        refused(&axis, &drive),
        ("drive.limit_switch_positive".to_owned(), 4.0)
    );
    drive = ideal;
    (drive.home_switch, drive.home_switch_from) = (1, f64::NEG_INFINITY);
    assert_eq!(refused(&axis, &drive).0, "drive.home_switch_from");
    drive = ideal;
    (drive.marker, drive.marker_every) = (1, -1.0);
    assert_eq!(refused(&axis, &drive), ("drive.marker_every".to_owned(), -1.0));
    drive.marker_at = f64::NAN;
    assert_eq!(refused(&axis, &drive).0, "drive.marker_at");
    drive = ideal;
    drive.kind = 2;
    assert_eq!(refused(&axis, &drive).0, "scaling_increments");
    axis.scaling_increments = 1000;
    drive.homing_velocity = -1.0;
    assert_eq!(refused(&axis, &drive).0, "drive.homing_velocity");
    (drive.homing_velocity, drive.homing_direction) = (1.0, 2);
    assert_eq!(refused(&axis, &drive), ("drive.homing_direction".to_owned(), 2.0));
    (drive.homing_direction, drive.rated_torque) = (0, 2.0);
    assert_eq!(refused(&axis, &drive).0, "drive.inertia");
    (drive.inertia, drive.torque_max) = (0.1, 100.0);
    assert_eq!(refused(&axis, &drive), ("drive.torque_max".to_owned(), 100.0));
    drive.torque_max = 0.0;
    drive.deceleration = f64::NAN;
    assert_eq!(refused(&axis, &drive).0, "drive.deceleration");
    drive = ideal;
    (drive.kind, drive.inertia, drive.stop_stiffness) = (3, 0.1, -1.0);
    (drive.stop_negative, drive.stop_positive) = (-5.0, 5.0);
    assert_eq!(refused(&axis, &drive).1, -1.0);
    (drive.stop_stiffness, drive.gain_position) = (0.0, -3.0);
    assert_eq!(refused(&axis, &drive).1, -3.0);
    drive.gain_position = f64::NAN;
    assert_eq!(host.add(&axis, &drive), Ok(1), "all of that was the values'");
}

#[test]
fn inputs_probes_and_pushes_have_their_ranges_and_their_time() {
    let host = Host::powered();
    let rt = host.runtime;
    // SAFETY: a handle.
    let input = |axis, number| unsafe { standstill_simulate_input(rt, axis, number, 1) };
    // SAFETY: a handle.
    let probe = |axis, number, at| unsafe { standstill_simulate_probe(rt, axis, number, at, 1) };
    // SAFETY: a handle.
    let push = |axis, distance| unsafe { standstill_simulate_push(rt, axis, distance) };
    let (bad, unknown) = (Code::BadValue as i32, Code::UnknownAxis as i32);
    assert_eq!(
        [input(1, 31), input(1, 32), input(2, 0), input(0, 0)],
        [0, bad, unknown, unknown]
    );
    assert_eq!(
        [
            probe(1, 1, 0.0),
            probe(1, 2, 1.0),
            probe(1, 0, 0.5),
            probe(1, 3, 0.5)
        ],
        [0, 0, bad, bad]
    );
    assert_eq!(
        [probe(1, 1, -0.1), probe(1, 1, 1.1), probe(1, 1, f64::NAN)],
        [bad; 3]
    );
    assert_eq!(push(1, f64::NAN), bad);
    assert_eq!(
        push(1, 1.0),
        Code::NotOff as i32,
        "an ideal drive with torque holds its place"
    );
    assert_eq!(host.begin(0), 0);
    assert_eq!(
        [input(1, 0), probe(1, 1, 0.5), push(1, 1.0)],
        [Code::InTick as i32; 3]
    );
    assert_eq!(host.end(), 0);
    // Pushed while it is off, the axis is at another position.
    assert_eq!(host.stop(), 0);
    for scan in 1..4 {
        assert_eq!((host.begin(scan * TICK), host.end()), (0, 0));
    }
    assert_eq!(push(1, 2.5), 0);
    assert_eq!((host.begin(4 * TICK), host.end()), (0, 0));
    assert_eq!(host.status().actual_position, 2.5);
    // Nothing is simulated for a host's own drive.
    let own = Host::new(1, 1);
    let (axis, mut drive) = Host::setup();
    drive.kind = 0;
    assert_eq!(own.add(&axis, &drive), Ok(1));
    // SAFETY: a handle.
    unsafe {
        let wrong = Code::WrongDrive as i32;
        assert_eq!(standstill_simulate_input(own.runtime, 1, 0, 1), wrong);
        assert_eq!(standstill_simulate_probe(own.runtime, 1, 1, 0.5, 1), wrong);
        assert_eq!(standstill_simulate_push(own.runtime, 1, 1.0), wrong);
        assert_eq!(standstill_simulate(own.runtime, 1, 4, 1), wrong);
    }
}

/// A limit switch of the drive stops an axis that runs into it. CLEAR and disturbances that only a CiA 402 node
/// knows have their codes.
#[test]
fn a_limit_switch_stops_and_an_axis_fails() {
    let host = Host::new(2, 4);
    let (mut axis, mut drive) = Host::setup();
    axis.start_powered = 1;
    (
        drive.limit_switches,
        drive.limit_switch_negative,
        drive.limit_switch_positive,
    ) = (1, -1.0, 0.5);
    assert_eq!(host.add(&axis, &drive), Ok(1));
    axis.scaling_increments = 1000;
    drive.kind = 2;
    assert_eq!(host.add(&axis, &drive), Ok(2));
    for only_a_node in 5..=8 {
        assert_eq!(host.simulate(1, only_a_node, 77), Code::WrongDrive as i32);
        assert_eq!(host.simulate(2, only_a_node, 77), 0);
    }
    let mut key = 0;
    for scan in 0..249 {
        tick(&host, scan, &mut key, &inputs());
    }
    let out = tick(&host, 249, &mut key, &inputs());
    let status = host.status();
    assert_eq!((out.error, status.state, status.velocity), (1, 7, 0.0));
    assert_eq!(status.error_id, u32::from(out.error_id));
    assert!(
        status.position > 0.5 && status.position < 1.1,
        "it stopped behind the switch"
    );
    // The axis itself fails, and its cause is cleared.
    let host = Host::powered();
    assert_eq!(host.simulate(1, 4, 77), 0);
    assert_eq!((host.begin(0), host.end()), (0, 0));
    assert_eq!((host.status().state, host.status().error_code), (7, 77));
    assert_eq!(host.simulate(1, 0, 0), 0);
}
