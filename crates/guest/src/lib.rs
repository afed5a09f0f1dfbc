//! Guests: control programs in WebAssembly that call the function blocks.
//!
//! A guest exports `plc_scan(tick: i32, now_ns: i64)`, `memory` and, optionally, `plc_init()`. It may
//! import functions of blocks, `(key, in, out) -> result` with addresses in its memory;
//! `log(text, bytes)`; `log_read`, which copies records of the diagnostic ring; and `math_sin` and
//! similar functions. It can import nothing else. `standstill export wasm` writes the blocks with the
//! layout of every structure.
//!
//! A guest is not trusted. It is checked and compiled before it runs. Every call has a budget of
//! instructions, so that it ends, and ends at the same instruction everywhere. Its memory has a limit
//! that is checked before memory is allocated. Any error of the guest is a [`Fault`], after which the
//! host stops the resource.
//!
//! Without the feature `engine`, which is on by default, there is no interpreter: every program is
//! refused as [`LoadError::NotBuilt`]. The code that reads and runs scan scripts is the same with and
//! without it.
//!
//! A build profile with `opt-level` 2 or 3 *and* `debug-assertions` needs
//! `[profile.<name>.package] wasmi = { opt-level = 1 }`. With those checks the interpreter's stack grows with every
//! instruction of a guest, and the process ends when it is full. The `dev` and `release` profiles of Cargo work
//! unchanged.
//!
//! A [`Program`] is a compiled guest and a [`Guest`] a running one. Files, names of variables and tasks
//! belong to `standstill-script`.
#![forbid(unsafe_code)]

#[cfg(not(feature = "engine"))]
mod absent;
#[cfg(feature = "engine")]
mod engine;
mod error;
#[cfg(feature = "engine")]
mod guest;
#[cfg(feature = "engine")]
mod host;
mod symbol;
mod terms;
#[cfg(feature = "engine")]
mod tick;

#[cfg(not(feature = "engine"))]
pub use absent::{Entry, Guest, Program};
pub use error::{Fault, LoadError};
#[cfg(feature = "engine")]
pub use guest::{Entry, Guest, Program, Snapshot};
#[cfg(feature = "engine")]
pub use host::Code;
pub use symbol::{Symbol, SymbolError, SymbolType};
pub use terms::{INSTANCES_MOST, Settings, Told};

/// Largest number of bytes of a module.
pub const MODULE_MOST: usize = 16 << 20;

/// Bytes of a page of memory.
pub const PAGE: u64 = 1 << 16;

/// The module from which the functions of blocks are imported, unless [`Settings::module`] names another.
pub const MODULE: &str = "standstill";
