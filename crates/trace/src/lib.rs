//! Scan traces: the value of every signal in every scan, as data and as text.
//!
//! A host describes a run in a [`Header`], makes a [`Trace`] of it and pushes one row a scan. From then on
//! the trace is read only: it can be written as CSV or JSON Lines and read back bit by bit, condensed
//! into a golden text for people to review, and compared with another one.
//!
//! The crate knows no script, no executor and no block, and reads no clock; only [`file`](mod@file) and
//! [`golden`] touch files. The same trace gives the same bytes on every processor: numbers have their
//! shortest round-trip form, digests use a fixed byte order, and nothing is iterated in random order.
//!
//! ```
//! use standstill_trace::{Cell, Header, Input, Trace, events_text};
//!
//! let go = Input { name: "GO".into(), iec_type: "BOOL".into() };
//! let mut trace = Trace::new(Header { cycle_ns: 1_000_000, inputs: vec![go], ..Header::default() });
//! for scan in 0..10 {
//!     trace.push_row(&[Cell::Bool(scan >= 3)])?;
//! }
//! assert_eq!(events_text(&trace), "    3  inputs  +GO\n");
//! # Ok::<(), standstill_trace::RowError>(())
//! ```
//!
//! The work of every function here is proportional to rows times columns, unless its documentation says
//! otherwise.

#![forbid(unsafe_code)]

mod cells;
mod column;
mod columns;
pub mod compare;
pub mod csv;
pub mod digest;
mod events;
pub mod exact;
mod extremes;
pub mod file;
pub mod foreign;
pub mod golden;
mod header;
pub mod jsonl;
pub mod machine;
mod number;
mod printable;
mod read;
pub mod ring_down;
pub mod story;
pub mod subjects;
mod trace;
pub mod vcd;

pub use column::{Cell, Column, Kind, Role};
pub use events::{Event, EventLog, Widths, events, events_text, same};
pub use extremes::{Extreme, Extremes, axis_title, extremes, extremes_text, greatest};
pub use header::{
    AXIS_SIGNALS, Axis, CAM_SIGNALS, CAMS_MAX, COMBINED_SIGNALS, Cam, Claim, ClaimFailure, ClaimVerdict,
    Direction, Header, Input, Instance, Limits, Pin, SLAVE_SIGNALS, SUPERIMPOSED_SIGNALS, Scaling, Written,
};
pub use number::{cell_text, fixed, shortest, time_literal};
pub use printable::{printable, printable_lines};
pub use read::{Loaded, ReadError};
pub use trace::{Note, RowError, Trace};
