//! The functions of the flight recorder in `standstill.h`.

use crate::enter::{When, enter};
use crate::runtime::{Inner, Runtime};
use crate::{Code, Dump, Recorded, RecorderConfig, RecorderStatus, raw};
use core::ffi::{c_char, c_void};
use core::slice;
use standstill_record::text::Form;

/// The entries of a C list, each with its index. The stride may be longer than the entry this version
/// knows.
#[derive(Clone, Copy)]
struct Entries {
    at: *const Recorded,
    stride: usize,
    count: u32,
}

impl Entries {
    fn new(at: *const Recorded, size: u32, count: u32) -> Result<Self, Code> {
        if (size as usize) < size_of::<Recorded>() {
            return Err(Code::StructSize);
        }
        if at.is_null() && count > 0 {
            return Err(Code::NullPointer);
        }
        Ok(Self {
            at,
            stride: size as usize,
            count,
        })
    }

    /// # Safety
    /// `count` entries exist, `stride` bytes apart, and nothing writes to them.
    unsafe fn each(self) -> impl Iterator<Item = Recorded> + Clone {
        (0..self.count as usize).map(move |place| {
            let at = self.at.cast::<u8>().wrapping_add(place * self.stride);
            // SAFETY: the caller's contract; the entry may be unaligned.
            unsafe { at.cast::<Recorded>().read_unaligned() }
        })
    }
}

/// Number of bytes of storage that a flight recorder needs, for all axes of the runtime and the block instances in
/// the list `recorded`. The list has `count` entries, each of `recorded_size` bytes, sizeof(standstill_recorded).
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, STRUCT_SIZE, UNKNOWN_KEY, BAD_VALUE (a number of the configuration).
///
/// # Safety
/// Each pointer is null or valid for its type; `recorded` has `count` entries.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_size"))]
pub unsafe extern "C" fn standstill_recorder_size(
    runtime: *mut Runtime,
    config: *const RecorderConfig,
    recorded: *const Recorded,
    recorded_size: u32,
    count: u32,
    bytes: *mut usize,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            let config = raw::read(config)?;
            let entries = Entries::new(recorded, recorded_size, count)?;
            if bytes.is_null() {
                return Err(Code::NullPointer);
            }
            bytes.write_unaligned(inner.recorder_order(config).size(entries.each())?);
            Ok(())
        })
    }
}

/// Sets up a flight recorder in `storage`. The storage is aligned to 16 bytes, has the size that recorder_size
/// returns, and belongs to the runtime until recorder_end or runtime_close. From now on every tick_end keeps a
/// scan. Axes that are added later are not recorded.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STRUCT_SIZE, STORAGE, UNKNOWN_AXIS, UNKNOWN_KEY, NO_ROOM
/// (there is one already), BAD_VALUE (also: a name that is no IEC identifier, has no 0 at its end, or occurs twice;
/// a unit with quotes).
///
/// # Safety
/// Each pointer is null or valid for its type; `storage` has the given number of bytes, `recorded` has
/// `count` entries.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_init"))]
pub unsafe extern "C" fn standstill_recorder_init(
    runtime: *mut Runtime,
    storage: *mut c_void,
    bytes: usize,
    config: *const RecorderConfig,
    recorded: *const Recorded,
    recorded_size: u32,
    count: u32,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let config = raw::read(config)?;
            let entries = Entries::new(recorded, recorded_size, count)?;
            if storage.is_null() {
                return Err(Code::NullPointer);
            }
            if inner.recorder().is_ok() {
                return Err(Code::NoRoom);
            }
            let order = inner.recorder_order(config);
            let made = order.make(entries.each(), storage.cast(), bytes)?;
            inner.set_recorder(Some(made));
            Ok(())
        })
    }
}

/// Takes the flight recorder away; its storage belongs to the host again.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, NO_RECORDER.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_end"))]
pub unsafe extern "C" fn standstill_recorder_end(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            inner.recorder()?;
            inner.set_recorder(None);
            Ok(())
        })
    }
}

/// Trips the flight recorder in the open or the next tick, for a reason of the host's own. No effect on a recorder
/// that has tripped.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, NO_RECORDER.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_trip"))]
pub unsafe extern "C" fn standstill_recorder_trip(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Any, |inner| {
            inner.recorder().map(|recorder| recorder.trip())
        })
    }
}

/// Deletes the contents of the flight recorder and waits for the next trigger.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, NO_RECORDER.
///
/// # Safety
/// `runtime` is null or a handle whose storage still exists.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_arm"))]
pub unsafe extern "C" fn standstill_recorder_arm(runtime: *mut Runtime) -> i32 {
    // SAFETY: the caller's contract.
    unsafe {
        enter(runtime, When::Any, |inner| {
            inner.recorder().map(|recorder| recorder.arm())
        })
    }
}

/// The state of the flight recorder.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, STRUCT_SIZE, NO_RECORDER.
///
/// # Safety
/// Each pointer is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_state"))]
pub unsafe extern "C" fn standstill_recorder_state(
    runtime: *mut Runtime,
    status: *mut RecorderStatus,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            raw::check(status)?;
            status.write_unaligned(inner.recorder()?.status());
            Ok(())
        })
    }
}

/// Copies the next part of the flight recorder's text to `buffer`, which has `room` bytes, and returns the number
/// of bytes: 0 after the last one. `dump` selects the text and has the progress: set all fields except its size and
/// form to 0 before the first call. The text is a trace for `standstill explain`, `report` and `compare`; it has no
/// 0 at its end.
///
/// A line that does not fit is begun again in the next call, so a buffer of some kilobytes is faster than one of
/// some bytes. No scan may be kept between the parts: dump a frozen recorder, or dump between two ticks.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STRUCT_SIZE, NO_RECORDER, BAD_VALUE (no such form; or
/// scans were kept since the first part).
///
/// # Safety
/// Each pointer is null or valid for its type; `buffer` has `room` bytes.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_recorder_read"))]
pub unsafe extern "C" fn standstill_recorder_read(
    runtime: *mut Runtime,
    dump: *mut Dump,
    buffer: *mut c_char,
    room: usize,
    length: *mut usize,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            let mut at = raw::read(dump)?;
            if length.is_null() || (buffer.is_null() && room > 0) {
                return Err(Code::NullPointer);
            }
            let form = match at.form {
                0 => Form::JsonLines,
                1 => Form::Csv,
                2 => Form::Meta,
                _ => return Err(Code::BadValue),
            };
            let Inner {
                axes,
                recorder,
                cycle_ns,
                ..
            } = inner;
            let recorder = recorder.slice().first().ok_or(Code::NoRecorder)?;
            if at.line == 0 && at.skip == 0 {
                at.stamp = recorder.stamp();
            } else if at.stamp != recorder.stamp() {
                return Err(Code::BadValue);
            }
            let mut written = 0;
            if room > 0 {
                // The bytes are not read, but a reference to bytes needs initialized ones.
                buffer.write_bytes(0, room);
                let room = slice::from_raw_parts_mut(buffer.cast::<u8>(), room);
                (at.line, at.skip, written) =
                    recorder.read(axes.slice(), form, *cycle_ns, (at.line, at.skip), room);
            }
            dump.write_unaligned(at);
            length.write_unaligned(written);
            Ok(())
        })
    }
}

/// Makes an instance of the block with this IEC name before its first call, and sets its key. A flight recorder
/// needs keys. A call with a key of 0 does the same.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, BAD_VALUE (no block has this name), NO_ROOM.
///
/// # Safety
/// Each pointer is null or valid for its type; `block` ends in 0.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_instance_make"))]
pub unsafe extern "C" fn standstill_instance_make(
    runtime: *mut Runtime,
    block: *const c_char,
    key: *mut u64,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Any, |inner| {
            if block.is_null() || key.is_null() {
                return Err(Code::NullPointer);
            }
            let name = core::ffi::CStr::from_ptr(block)
                .to_str()
                .map_err(|_| Code::BadValue)?;
            let made = standstill_blocks::BlockInstance::new(name).ok_or(Code::BadValue)?;
            key.write_unaligned(inner.create(made)?);
            Ok(())
        })
    }
}
