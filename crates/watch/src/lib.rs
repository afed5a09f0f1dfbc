//! A scan script, watched in a terminal: run and stopped, stepped by a scan, to the next event or the next claim that is
//! decided, with inputs changed by hand.
//!
//! What stands here: the state of the watching ([`App`]), its screen ([`draw`]), and the terminal around them
//! ([`watch`]). What does not: the run itself, which is a [`Session`](standstill_script::Session), and reading scripts.
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
