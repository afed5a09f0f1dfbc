//! Scan scripts: reading, binding, running, judging.
//!
//! What stands here: the script format of the contract as values, its errors with file, line and column,
//! the run of a script through the executor into a trace, and the judgement of claims and goldens. What does
//! not: arguments and printing (the command line), motion, block behaviour.
#![forbid(unsafe_code)]

pub mod claims;
pub mod model;
pub mod run;

pub use claims::{Failure, Verdict};
pub use run::{Outcome, RunError, run, run_with};
