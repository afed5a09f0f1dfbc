//! The functions of the store of cams in `standstill.h`.

use crate::enter::{When, enter};
use crate::runtime::Runtime;
use crate::storage::CamStore;
use crate::{Code, raw};
use core::ffi::c_void;

/// Number of bytes of storage that a store of cams needs: for `slots` cams, 1 to 65535, and `pieces` pieces in all,
/// 1 to 2^24. A cam takes one piece less than it has rows.
///
/// Codes: NULL_POINTER, BAD_VALUE.
///
/// # Safety
/// `bytes` is null or valid for its type.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_cams_size"))]
pub unsafe extern "C" fn standstill_cams_size(slots: u32, pieces: u32, bytes: *mut usize) -> i32 {
    if bytes.is_null() {
        return Code::NullPointer as i32;
    }
    raw::code(CamStore::size(slots, pieces).map(|size| {
        // SAFETY: not null, so by contract it can be written.
        unsafe { bytes.write_unaligned(size) }
    }))
}

/// Sets up a store of cams in `storage`. The storage is aligned to 16 bytes, has the size that cams_size returns,
/// and belongs to the runtime until runtime_close. Without a store MC_CamTableSelect shows ErrorID 153.
///
/// Codes: NULL_POINTER, NO_RUNTIME, OTHER_THREAD, IN_TICK, STORAGE, NO_ROOM (there is one already), BAD_VALUE.
///
/// # Safety
/// Pointers are null or valid for their types, `storage` for the given number of bytes.
#[unsafe(export_name = concat!(env!("STANDSTILL_SYMBOLS"), "_cams_init"))]
pub unsafe extern "C" fn standstill_cams_init(
    runtime: *mut Runtime,
    storage: *mut c_void,
    bytes: usize,
    slots: u32,
    pieces: u32,
) -> i32 {
    // SAFETY: the caller's contract, here and in all that follows.
    unsafe {
        enter(runtime, When::Outside, |inner| {
            if storage.is_null() {
                return Err(Code::NullPointer);
            }
            if inner.cams.is_there() {
                return Err(Code::NoRoom);
            }
            inner.cams = CamStore::make(slots, pieces, storage.cast(), bytes)?;
            Ok(())
        })
    }
}
