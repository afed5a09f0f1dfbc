//! Scan scripts: reading, binding, running, judging.
//!
//! The crate has the script format as values, its errors with file, line and column, the run of a script
//! through the executor into a trace, and the judgement of claims and goldens. It has no arguments and no
//! printing (these are in the command line), no motion and no block behaviour.
#![forbid(unsafe_code)]

mod advice;
pub mod bare;
pub mod cam;
mod changes;
pub mod claims;
pub mod csv;
mod error;
mod format;
pub mod golden;
pub mod model;
pub mod mutate;
mod read;
pub mod run;
mod schema;
mod schema_machine;
mod schema_map;
mod schema_sweep;
pub mod suite;
pub mod sweep;
mod variable;
mod warn;
mod why;
pub mod write;

pub use changes::with_changes;
pub use claims::{Failure, Standing, Verdict};
pub use error::{Code, DIAGNOSTICS_SHOWN, Diagnostic, ScriptError};
pub use format::format;
pub use read::machine_map::read_map;
pub use read::sweep::read_sweep;
pub use read::time::parse as parse_time;
pub use read::{
    CELLS_MAX, ENTITIES_MAX, GUEST_MEMORY, LOOKS_MAX, SCANS_MAX, VERSION, read, read_with, read_with_programs,
};
pub use run::{
    Advance, Ahead, Change, Counted, Kept, Ordered, Outcome, ROWS_MAX, RecordingError, RunError, Session,
    Shown, Witness, far_or_by_scan, judge_recording, keeps_rows, run, run_with,
};
pub use schema::schema;
pub use schema_machine::machine_schema;
pub use schema_map::map_schema;
pub use schema_sweep::sweep_schema;
pub use standstill_axis::ErrorId;
pub use warn::{Warning, WarningKind, Warnings, warnings};
pub use why::Reason;
