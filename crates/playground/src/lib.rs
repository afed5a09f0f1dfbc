//! Scan scripts in a browser: reader, runner, judge and planner behind a few functions on JSON.
//!
//! The crate defines what each function takes and returns, and its limits. Motion, scripts and traces
//! belong to the libraries; the page is in `page/`. There are no files, no clock and no network: a script
//! comes with the texts of the files it names.
//!
//! Everything is bounded, and a message names the bound, so that a link to a large script does not block
//! its reader. A run reports its progress, and its caller may end it.

mod bounds;
#[cfg(target_arch = "wasm32")]
mod browser;
mod hand;
mod plans;
mod project;
mod runs;
#[cfg(feature = "guest")]
mod save;
mod share;

pub use bounds::{BLOCKS_MAX, BYTES_MAX, CELLS_MAX, FUEL_MAX, LINES_MAX, LINK_MAX, SCANS_MAX};
pub use hand::hand;
pub use plans::plan;
pub use project::check;
pub use runs::{Ran, run};
#[cfg(feature = "guest")]
pub use save::save;
pub use share::share;

/// Only the module with guests writes files, because a report contains a large page.
#[cfg(not(feature = "guest"))]
#[must_use]
pub fn save(_: &str, _: &str) -> String {
    r#"{"needs": "guests"}"#.to_owned()
}
