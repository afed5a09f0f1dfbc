//! Sweeps: a scan script run with many values of its parameters, with one row of figures for each case.
//!
//! The crate runs the cases of a sweep file on any number of threads and writes the table of results. It
//! continues the table of an interrupted run and merges the tables of shards. The values of each case and
//! the file format belong to `standstill-script`, arguments and printing to the command line.
//!
//! A row depends only on the sweep file, the script and the number of its case: threads, shards and
//! interruptions leave no trace in a table.
#![forbid(unsafe_code)]

mod figure;
mod job;
mod part;
mod run;
mod shard;
mod table;

pub use job::{Job, Judged, Row, SweepError};
pub use part::Part;
pub use run::run;
pub use shard::Shard;
pub use table::{Rows, merge, write};
