//! Sweeps: a scan script run with many values of its parameters, a row of figures a case.
//!
//! What stands here: the cases of a sweep file run on any number of threads, the table of what came of them, a part of
//! a table that an interrupted run left, and tables of shards put together. What does not: which values a case has and
//! how the file is read (`standstill-script`), arguments and printing (the command line).
//!
//! A row depends on the sweep file, the script and the number of its case, and on nothing else: threads, shards and
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
