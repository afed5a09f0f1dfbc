//! The C library: a runtime behind an opaque handle, blocks as functions on flat structures.
//!
//! This crate is the border to C. It checks its arguments and returns a result code instead of undefined behaviour
//! wherever C permits it; `docs/embedding-c.md` lists what it cannot detect. It has no motion, states or blocks of
//! its own. There is no global state, no heap and no clock: a runtime is in memory of its host.
//!
//! The two headers in `include/` are generated: `standstill.h` from this crate, `standstill_blocks.h` from the table of
//! blocks.
#![cfg_attr(not(feature = "std"), no_std)]
// The only crate of the repository that may use `unsafe`: it is the border to C. Each use says why it is
// sound.
#![allow(unsafe_code)]
#![deny(unsafe_op_in_unsafe_fn, clippy::undocumented_unsafe_blocks)]

// Pins have the layout of `fb::flat`, which is the memory layout of these processors.
#[cfg(target_endian = "big")]
compile_error!("the C library is for little-endian processors: pins would cross the border turned round");

mod api;
mod api_cam;
mod api_record;
mod blocks;
mod config;
mod drive;
mod enter;
mod events;
mod raw;
mod recorder;
mod runtime;
mod storage;
mod types;

pub use api::*;
pub use api_cam::*;
pub use api_record::*;
pub use blocks::*;
pub use runtime::Runtime;
pub use types::*;

/// Version of the functions and structures below. It rises with a change that an already compiled host
/// would misread.
pub const ABI_VERSION: u32 = 1;

// A host without `std` brings its own panic handler; `.ci/no-panic` shows that nothing calls it.
#[cfg(all(not(feature = "std"), not(test)))]
mod panic {
    unsafe extern "C" {
        fn standstill_panicked() -> !;
    }

    #[panic_handler]
    fn panic(_: &core::panic::PanicInfo<'_>) -> ! {
        // SAFETY: the host defines it without arguments and without a return, or links nothing that calls it.
        unsafe { standstill_panicked() }
    }
}
