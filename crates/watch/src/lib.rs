//! A scan script in a terminal: run, stop, step by a scan, to the next event or to the next decided
//! claim, and change inputs by hand.
//!
//! The crate has the state of the view ([`App`]), its screen ([`draw`]), and the terminal around them
//! ([`watch`]). The run itself is a [`Session`](standstill_script::Session) of `standstill-script`, which
//! also reads scripts.
#![forbid(unsafe_code)]

mod app;
mod help;
mod panes;
mod points;
mod program;
mod terminal;
mod view;

pub use app::{App, Key, Mode, SPEEDS, Save};
pub use help::KEYS;
pub use terminal::{Ended, give_back, watch};
pub use view::{LEAST, draw};
