//! The tests of this crate, in one program: linking one costs more than running most of them.

mod broken_programs;
mod claims;
mod common;
mod coupling_rows;
mod couplings;
mod empty_tests;
mod far_runs;
mod follows;
mod hints;
mod long_runs;
mod read_scripts;
mod recordings;
mod relative_claims;
mod runs;
mod sessions;
mod stories;
mod suites;
mod why;
