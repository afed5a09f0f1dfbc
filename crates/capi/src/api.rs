//! The functions of `standstill.h`. Their comments are the documentation that C programmers read.
//!
//! A limit of all of them: a wrong pointer that is not null cannot be detected.

use crate::drive::AnyDrive;
use crate::enter::{When, enter};
use crate::runtime::{MAGIC, Runtime};
use crate::{
    ABI_VERSION, AxisSetup, AxisStatus, Code, Command, ConfigFault, DriveSetup, Feedback, Mishap, Record,
    RuntimeConfig, events, raw, storage,
};
use core::ffi::{c_char, c_void};
use core::sync::atomic::Ordering::Release;
use standstill_axis::{DIGITAL, DrivePosition, PROBES};
use standstill_drives::simulated::DriveChange;

/// The ABI version of the library. A host compares it with STANDSTILL_ABI_VERSION, its header's.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_abi_version"))]
pub extern "C" fn standstill_abi_version() -> u32 {
    ABI_VERSION
}

/// A code of a function as one sentence in English; never null, and not to be freed.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_result_text"))]
pub extern "C" fn standstill_result_text(result: i32) -> *const c_char {
    let text = match result {
        0 => c"done",
        -1 => c"a pointer is null",
        -2 => c"the size in front of a structure is smaller than its first version",
        -3 => c"the host was compiled with the header of another ABI version",
        -4 => c"the storage is too small, or not aligned to 16 bytes",
        -5 => c"there is no runtime at this address",
        -6 => c"another thread is in the runtime, or has a tick open",
        -7 => c"only between tick_begin and tick_end",
        -8 => c"only outside a tick: before tick_begin, or after tick_end",
        -9 => c"the instant is before that of the tick before",
        -10 => c"no instance has this key",
        -11 => c"the key is of an instance of another block",
        -12 => c"the runtime was set up for fewer axes or instances",
        -13 => c"no axis has this number; the first is 1",
        -14 => c"a value of the configuration cannot be used; config_error says which",
        -15 => c"the drive under the axis is of another kind",
        -16 => c"a number stands for nothing",
        -17 => c"an array has more records than its block takes, or stands at address null",
        -18 => c"an axis is switched on or moving",
        -19 => c"the resource was stopped",
        -20 => c"a defect of the library was caught; the resource was stopped",
        -21 => c"no flight recorder was set up",
        _ => c"not a result of this library",
    };
    text.as_ptr()
}

/// Number of bytes of storage that a runtime needs.
///
/// Codes: NULL_POINTER, STRUCT_SIZE, BAD_VALUE (a size of the configuration is 0 or too large).
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_runtime_size"))]
pub unsafe extern "C" fn standstill_runtime_size(config: *const RuntimeConfig, bytes: *mut usize) -> i32 {
    // SAFETY: the caller's contract.
    let size = unsafe { raw::read(config) }.and_then(|config| storage::size(&config));
    raw::code(size.and_then(|size| {
        if bytes.is_null() {
            return Err(Code::NullPointer);
        }
        // SAFETY: not null, so by contract it can be written.
        unsafe { bytes.write_unaligned(size) };
        Ok(())
    }))
}

/// Makes a runtime without axes in `storage`. The storage is aligned to 16 bytes, has the size that runtime_size
/// returns, and belongs to the runtime until it is closed. `abi_version` is STANDSTILL_ABI_VERSION. Nothing has to
/// be freed.
///
/// Codes: ABI_MISMATCH, NULL_POINTER, STRUCT_SIZE, BAD_VALUE, STORAGE.
///
/// # Safety
/// Each pointer is null or valid for its type; `storage` has the given number of bytes.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_runtime_init"))]
pub unsafe extern "C" fn standstill_runtime_init(
    abi_version: u32,
    storage: *mut c_void,
    bytes: usize,
    config: *const RuntimeConfig,
    runtime: *mut *mut Runtime,
) -> i32 {
    if abi_version != ABI_VERSION {
        return Code::AbiMismatch as i32;
    }
    if storage.is_null() || runtime.is_null() {
        return Code::NullPointer as i32;
    }
    // SAFETY: the caller's contract; the storage is not null.
    let made = unsafe { raw::read(config) }
        .and_then(|config| unsafe { storage::init(storage.cast(), bytes, &config) });
    raw::code(made.map(|made| {
        // SAFETY: not null, so by contract it can be written.
        unsafe { runtime.write_unaligned(made) }
    }))
}

/// Ends a runtime whose axes are all off. Its storage belongs to the host again; its handle and keys are no longer
/// valid.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, NOT_OFF.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_runtime_close"))]
pub unsafe extern "C" fn standstill_runtime_close(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    let closed = unsafe { enter(runtime, When::Outside, |inner| inner.check_off()) };
    if closed == Code::Ok as i32 {
        // SAFETY: `enter` found a runtime just now. Nothing it holds needs a destructor.
        unsafe { (*runtime).magic.store(!MAGIC, Release) };
    }
    closed
}

/// Fills in everything but the five limits. `size` must be set before.
///
/// Codes: NULL_POINTER, STRUCT_SIZE.
///
/// # Safety
/// The pointer is null, or has as many bytes as its size field says.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_axis_defaults"))]
pub unsafe extern "C" fn standstill_axis_defaults(setup: *mut AxisSetup) -> i32 {
    // SAFETY: the caller's contract.
    raw::code(unsafe { raw::write_under(setup, AxisSetup::defaults) })
}

/// Describes an ideal drive, which follows every set-point in the next tick. `size` must be set before.
///
/// Codes: NULL_POINTER, STRUCT_SIZE.
///
/// # Safety
/// The pointer is null, or has as many bytes as its size field says.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_drive_defaults"))]
pub unsafe extern "C" fn standstill_drive_defaults(setup: *mut DriveSetup) -> i32 {
    // SAFETY: the caller's contract.
    raw::code(unsafe { raw::write_under(setup, DriveSetup::defaults) })
}

/// Adds an axis with its drive; `axis` gets its number, from 1 in the order of the calls.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STRUCT_SIZE, NO_ROOM, BAD_CONFIG.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_axis_add"))]
pub unsafe extern "C" fn standstill_axis_add(
    runtime: *mut Runtime,
    setup: *const AxisSetup,
    drive: *const DriveSetup,
    axis: *mut i32,
) -> i32 {
    // SAFETY: the caller's contract, here and below.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            // Fields that a host compiled with the first header does not have get their defaults.
            let setup = raw::read_over(setup, AxisSetup::defaults(0))?;
            let drive = raw::read_over(drive, DriveSetup::defaults(0))?;
            if axis.is_null() {
                return Err(Code::NullPointer);
            }
            let number = inner.add_axis(&setup, &drive)?;
            axis.write_unaligned(number);
            Ok(())
        })
    }
}

/// The key and the value of the last BAD_CONFIG of this runtime.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, STRUCT_SIZE.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_config_error"))]
pub unsafe extern "C" fn standstill_config_error(runtime: *mut Runtime, fault: *mut ConfigFault) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            raw::check(fault)?;
            fault.write_unaligned(inner.fault);
            Ok(())
        })
    }
}

/// Begins a tick at the instant `now_ns` of a monotonic clock: drives are read, and axis states are updated. This
/// thread may then call blocks until tick_end.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, TIME_BACKWARDS, INTERNAL.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_tick_begin"))]
pub unsafe extern "C" fn standstill_tick_begin(runtime: *mut Runtime, now_ns: i64) -> i32 {
    // SAFETY: the caller's contract.
    unsafe { enter(runtime, When::Outside, |inner| inner.begin(now_ns)) }
}

/// Ends a tick: every axis advances by one cycle of the configuration, drives are written.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, NOT_IN_TICK, INTERNAL.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_tick_end"))]
pub unsafe extern "C" fn standstill_tick_end(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::InTick, |inner| {
            inner.end();
            Ok(())
        })
    }
}

/// Stops the resource, inside a tick or between two: blocks are no longer called, and every axis stops and switches
/// off as configured. This takes further ticks, so continue with them.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_stop"))]
pub unsafe extern "C" fn standstill_stop(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Any, |inner| {
            inner.stop();
            Ok(())
        })
    }
}

/// Lets blocks be called again after stop, once every axis is off.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, NOT_OFF, INTERNAL.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_start"))]
pub unsafe extern "C" fn standstill_start(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe { enter(runtime, When::Outside, |inner| inner.start()) }
}

/// Frees the place of a block instance and sets its key to 0. The command of the instance continues.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, UNKNOWN_KEY.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_instance_release"))]
pub unsafe extern "C" fn standstill_instance_release(runtime: *mut Runtime, key: *mut u64) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            if key.is_null() {
                return Err(Code::NullPointer);
            }
            inner.release(key.read_unaligned())?;
            key.write_unaligned(0);
            Ok(())
        })
    }
}

/// The present data of an axis: its state, set-point, actual position and error. After tick_end the set-point is
/// that of this tick.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, STRUCT_SIZE, UNKNOWN_AXIS.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_axis_read"))]
pub unsafe extern "C" fn standstill_axis_read(
    runtime: *mut Runtime,
    axis: i32,
    status: *mut AxisStatus,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            raw::check(status)?;
            status.write_unaligned(inner.status(axis)?);
            Ok(())
        })
    }
}

/// Passes on the report of the host's own drive under `axis`. Call it before every tick_begin.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STRUCT_SIZE, UNKNOWN_AXIS, WRONG_DRIVE, BAD_VALUE.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_feedback_write"))]
pub unsafe extern "C" fn standstill_feedback_write(
    runtime: *mut Runtime,
    axis: i32,
    feedback: *const Feedback,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let feedback = raw::read(feedback)?;
            let place = inner.place(axis)?;
            match inner.drives.slice_mut().get_mut(place) {
                Some(AnyDrive::Host(drive)) => drive.tell(&feedback),
                _ => Err(Code::WrongDrive),
            }
        })
    }
}

/// Reads the command for the host's own drive under `axis`. Call it after every tick_end.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STRUCT_SIZE, UNKNOWN_AXIS, WRONG_DRIVE.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_command_read"))]
pub unsafe extern "C" fn standstill_command_read(
    runtime: *mut Runtime,
    axis: i32,
    command: *mut Command,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            raw::check(command)?;
            let place = inner.place(axis)?;
            match inner.drives.slice().get(place) {
                Some(AnyDrive::Host(drive)) => {
                    command.write_unaligned(drive.told(size_of::<Command>() as u32));
                    Ok(())
                }
                _ => Err(Code::WrongDrive),
            }
        })
    }
}

/// Applies a disturbance to the simulated drive under `axis`, or clears its cause. `mishap` is one of
/// standstill_mishap, `code` the number of the fault in the drive or the axis. WRONG_DRIVE also for a disturbance
/// that only a CiA 402 drive knows.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, BAD_VALUE, UNKNOWN_AXIS, WRONG_DRIVE.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_simulate"))]
pub unsafe extern "C" fn standstill_simulate(
    runtime: *mut Runtime,
    axis: i32,
    mishap: i32,
    code: u16,
) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let number = usize::try_from(mishap).map_err(|_| Code::BadValue)?;
            let mishap = *Mishap::ALL.get(number).ok_or(Code::BadValue)?;
            inner.suffer(axis, mishap, code)
        })
    }
}

/// Sets the digital input `number`, 0 to 31, of the simulated drive under `axis` to `level`. It shows from the next
/// tick_begin on.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, BAD_VALUE, UNKNOWN_AXIS, WRONG_DRIVE.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_simulate_input"))]
pub unsafe extern "C" fn standstill_simulate_input(
    runtime: *mut Runtime,
    axis: i32,
    number: u32,
    level: u8,
) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let drive = inner.simulated(axis)?;
            if number >= DIGITAL {
                return Err(Code::BadValue);
            }
            let level = level != 0;
            // Only `push` can be refused.
            let _done = drive.change(DriveChange::Input { number, level });
            Ok(())
        })
    }
}

/// Sets the input of touch probe `number`, 1 or 2, of the simulated drive under `axis` to `level`. The change is at
/// the part `at` (0 to 1) of the cycle that ends with the next tick_begin. Up to four changes before a tick are
/// kept.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, BAD_VALUE, UNKNOWN_AXIS, WRONG_DRIVE.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_simulate_probe"))]
pub unsafe extern "C" fn standstill_simulate_probe(
    runtime: *mut Runtime,
    axis: i32,
    number: u32,
    at: f64,
    level: u8,
) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let drive = inner.simulated(axis)?;
            let number = (number as usize).wrapping_sub(1);
            if number >= PROBES || !(0.0..=1.0).contains(&at) {
                return Err(Code::BadValue);
            }
            let level = level != 0;
            // Only a push can be refused.
            let _done = drive.change(DriveChange::Probe { number, at, level });
            Ok(())
        })
    }
}

/// Pushes the axis by `distance` while the power stage of its simulated drive is off. The distance is in units;
/// with a CiA 402 drive, and an ideal one that counts, in increments.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, BAD_VALUE, UNKNOWN_AXIS, WRONG_DRIVE, NOT_OFF (it has
/// torque).
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_simulate_push"))]
pub unsafe extern "C" fn standstill_simulate_push(runtime: *mut Runtime, axis: i32, distance: f64) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let drive = inner.simulated(axis)?;
            if !distance.is_finite() {
                return Err(Code::BadValue);
            }
            let pushed = drive.change(DriveChange::Displace(distance));
            pushed.map_err(|_| Code::NotOff)
        })
    }
}

/// Makes the simulated drive under `axis` report `value` instead of its measurement, from the next tick_begin on
/// until standstill_simulate clears the cause. `quantity` 0: its position, in increments if the axis has a scaling,
/// otherwise in units; 1: its actual torque, if it reports one. A number of units or torque may be NaN or infinite;
/// a number of increments must be whole.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, BAD_VALUE, UNKNOWN_AXIS, WRONG_DRIVE.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_simulate_report"))]
pub unsafe extern "C" fn standstill_simulate_report(
    runtime: *mut Runtime,
    axis: i32,
    quantity: i32,
    value: f64,
) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let counts = inner.counts_increments(axis)?;
            let drive = inner.simulated(axis)?;
            let whole = value as i64;
            let change = match quantity {
                // A value that does not fit changes when it is converted back.
                0 if counts && whole as f64 != value => return Err(Code::BadValue),
                0 if counts => DriveChange::ReportPosition(DrivePosition::Increments(whole)),
                0 => DriveChange::ReportPosition(DrivePosition::Units(value)),
                1 => DriveChange::ReportTorque(value),
                _ => return Err(Code::BadValue),
            };
            // Only a push can be refused.
            let _done = drive.change(change);
            Ok(())
        })
    }
}

/// Copies records of the diagnostic ring, oldest first, from number `*next` on. `*next` becomes the number to
/// continue from, and `*copied` the number of records. Records that were overwritten meanwhile are left out, with
/// their numbers. `record_size` is sizeof(standstill_record), `room` the number of records that fit.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, STRUCT_SIZE.
///
/// # Safety
/// Each pointer is null or valid for its type; `records` has `room` entries.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_log_read"))]
pub unsafe extern "C" fn standstill_log_read(
    runtime: *mut Runtime,
    next: *mut u64,
    records: *mut Record,
    record_size: u32,
    room: u32,
    copied: *mut u32,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            if next.is_null() || copied.is_null() || (records.is_null() && room > 0) {
                return Err(Code::NullPointer);
            }
            let stride = record_size as usize;
            if stride < size_of::<Record>() {
                return Err(Code::StructSize);
            }
            let from = next.read_unaligned();
            let total = inner.log.total();
            let held = inner.log.since(from);
            // Records no longer in the ring are skipped.
            let first = total - held.count().min(total as usize) as u64;
            let (mut number, mut count) = (first, 0_usize);
            for record in inner.log.since(from).take(room as usize) {
                let to = records.cast::<u8>().add(count * stride);
                to.cast::<Record>()
                    .write_unaligned(events::record(number, record));
                number += 1;
                count += 1;
            }
            next.write_unaligned(number);
            copied.write_unaligned(count as u32);
            Ok(())
        })
    }
}
