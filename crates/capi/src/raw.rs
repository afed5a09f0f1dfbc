//! Pointers from C: checked as far as possible, read and written without a requirement on alignment.

use crate::Code;
use core::ffi::c_char;
use core::{ptr, slice};

/// A structure of the border. Its size is the `u32` it begins with.
///
/// # Safety
/// The type is `repr(C)`, begins with a `u32` and has no gaps, and every bit pattern is a valid value.
pub(crate) unsafe trait Sized32: Copy {
    /// Size of its first version in bytes: hosts compiled with that header are supported for ever.
    const LEAST: usize = size_of::<Self>();
}

macro_rules! sized {
    ($($ty:ident),*) => {$(
        // SAFETY: made of integers, floats and arrays of them behind a `u32`; `types` asserts its size.
        unsafe impl Sized32 for crate::$ty {}
    )*};
}

sized!(
    RuntimeConfig,
    Feedback,
    Command,
    AxisStatus,
    ConfigFault,
    RecorderConfig,
    RecorderStatus,
    Dump
);

// SAFETY: as above. New fields: power_timeout and the settings of a slave were added behind the first 264
// bytes.
unsafe impl Sized32 for crate::AxisSetup {
    const LEAST: usize = 264;
}

// SAFETY: as above. New fields: switches, homing, a motor, stops and gains were added behind the first 96
// bytes.
unsafe impl Sized32 for crate::DriveSetup {
    const LEAST: usize = 96;
}

/// Checks the size field of a structure of at least `needed` bytes.
///
/// # Safety
/// `at` is null, or a `u32` can be read there.
#[inline]
pub(crate) unsafe fn check_size(at: *const u8, needed: usize) -> Result<(), Code> {
    if at.is_null() {
        return Err(Code::NullPointer);
    }
    // SAFETY: not null, so by contract a `u32` is there; it may be unaligned.
    let size = unsafe { at.cast::<u32>().read_unaligned() };
    if (size as usize) < needed {
        return Err(Code::StructSize);
    }
    Ok(())
}

/// The structure at `at`.
///
/// # Safety
/// `at` is null, or points to as many bytes as the `u32` there says, at least four.
pub(crate) unsafe fn read<T: Sized32>(at: *const T) -> Result<T, Code> {
    // SAFETY: the caller's contract.
    unsafe { check_size(at.cast(), size_of::<T>())? };
    // SAFETY: not null, and long enough, because the size was checked.
    Ok(unsafe { at.read_unaligned() })
}

/// The structure at `at`. Fields that its older version does not have come from `otherwise`.
///
/// # Safety
/// As [`read`].
pub(crate) unsafe fn read_over<T: Sized32>(at: *const T, otherwise: T) -> Result<T, Code> {
    // SAFETY: the caller's contract.
    let known = unsafe { known::<T>(at.cast())? };
    let mut value = otherwise;
    // SAFETY: the size field says that these bytes exist. They are at most those of the value, and any
    // bytes are valid.
    unsafe { ptr::copy_nonoverlapping(at.cast::<u8>(), ptr::from_mut(&mut value).cast(), known) };
    Ok(value)
}

/// Writes as much of a value to `at` as its size field has room for. The size field does not change.
///
/// # Safety
/// As [`read`], and the bytes can be written.
pub(crate) unsafe fn write_under<T: Sized32>(at: *mut T, make: impl FnOnce(u32) -> T) -> Result<(), Code> {
    // SAFETY: the caller's contract.
    let known = unsafe { known::<T>(at.cast_const().cast())? };
    // SAFETY: not null, and a `u32` is there.
    let value = make(unsafe { at.cast::<u32>().read_unaligned() });
    // SAFETY: these bytes exist and are at most those of the value. The two do not overlap.
    unsafe { ptr::copy_nonoverlapping(ptr::from_ref(&value).cast(), at.cast::<u8>(), known) };
    Ok(())
}

/// Number of bytes at `at` that this version knows.
///
/// # Safety
/// As [`read`].
unsafe fn known<T: Sized32>(at: *const u8) -> Result<usize, Code> {
    // SAFETY: the caller's contract.
    unsafe { check_size(at, T::LEAST)? };
    // SAFETY: not null, and a `u32` is there.
    let size = unsafe { at.cast::<u32>().read_unaligned() } as usize;
    Ok(size.min(size_of::<T>()))
}

/// Checks that a structure can be written to `at`.
///
/// # Safety
/// As [`read`].
pub(crate) unsafe fn check<T: Sized32>(at: *mut T) -> Result<(), Code> {
    // SAFETY: the caller's contract.
    unsafe { check_size(at.cast_const().cast(), size_of::<T>()) }
}

/// The bytes at `at`, for writing.
///
/// # Safety
/// `at` is not null, `len` bytes can be written there, and nothing else uses them meanwhile.
#[inline]
pub(crate) unsafe fn bytes_mut<'a>(at: *mut u8, len: usize) -> &'a mut [u8] {
    // SAFETY: the caller's contract.
    unsafe { slice::from_raw_parts_mut(at, len) }
}

/// The code of a result.
pub(crate) fn code(result: Result<(), Code>) -> i32 {
    result.map_or_else(|code| code as i32, |()| Code::Ok as i32)
}

/// A name in the form of C: cut to its room, ended by 0.
pub(crate) fn name<const N: usize>(text: &str) -> [c_char; N] {
    let mut name = [0; N];
    for (to, from) in name.iter_mut().zip(text.bytes().take(N.saturating_sub(1))) {
        *to = from as c_char;
    }
    name
}
