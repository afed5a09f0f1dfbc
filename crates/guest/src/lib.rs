//! Guests: control programs in WebAssembly that call the function blocks.
//!
//! A guest exports `plc_scan(tick: i32, now_ns: i64)`, `memory` and, if it likes, `plc_init()`; it imports functions of
//! blocks, `(key, in, out) -> result` of addresses in its memory, `log(text, bytes)`, `log_read`, which copies records
//! of the diagnostic ring, and `math_sin` and its kin. Nothing else can be imported.
//! `standstill export wasm` writes the blocks out, with the layout of every structure.
//!
//! A guest is not trusted. It is checked and compiled before it runs; every call of it has a budget of instructions,
//! so that it ends and does so at the same instruction everywhere; its memory has a limit that is checked before it is
//! had; and whatever it does wrong is a [`Fault`], after which the host stops the resource.
//!
//! What stands here: [`Program`], which is what was compiled, and [`Guest`], a running one. What does not: which file
//! a guest comes from, what its variables are called, tasks (`standstill-script`).
#![forbid(unsafe_code)]

mod engine;
mod error;
mod guest;
mod host;
mod symbol;
mod tick;

pub use error::{Fault, LoadError};
pub use guest::{Guest, Program, Settings, Snapshot};
pub use host::{Code, INSTANCES_MOST, Told};
pub use symbol::{Symbol, SymbolError, SymbolType};

/// Most bytes of a module.
pub const MODULE_MOST: usize = 16 << 20;

/// Bytes of a page of memory.
pub const PAGE: u64 = 1 << 16;

/// What the functions of blocks are imported from unless [`Settings::module`] says otherwise.
pub const MODULE: &str = "standstill";
