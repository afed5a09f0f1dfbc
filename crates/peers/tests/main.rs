//! Files of standstill, judged by readers and generators of others.

/// The runs of the trace crate's tests.
#[allow(dead_code, reason = "the tests of the trace crate use the rest")]
#[path = "../../trace/tests/common/mod.rs"]
mod common;
mod header;
mod plcopen_xml;
mod waveforms;
