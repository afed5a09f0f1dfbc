//! The program from outside: its output and its exit.

mod blocks;
mod borders;
mod cam;
mod compare;
mod docs;
mod ends;
mod export;
mod fmt;
mod identify;
mod init;
mod live;
mod long;
mod lookup;
#[cfg(feature = "lsp")]
mod lsp;
mod machine;
#[cfg(feature = "mcp")]
mod mcp;
mod plan;
mod readme;
mod recorder;
mod refusals;
mod reports;
mod run;
mod serve;
mod soak;
mod soak_blocks;
mod st;
mod support;
mod sweep;
mod test;
mod test_some;
mod traces;
mod watch;
