//! The rules of every scan, for any actions on blocks and axes. They are defined once for the
//! breadth-first search over all states and for the random runs of `standstill soak blocks`.
//!
//! A broken rule is reported by its id in `docs/requirements` and its fault. Nothing here allocates.

pub mod arrows;
mod calls;
pub mod fence;
pub mod law;
pub mod limits;
mod truth;

pub use calls::{Call, Kind, Outputs, Shown, check_call};
pub use truth::{Held, Truth, check_truth};

/// A broken rule.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Broken {
    /// Its id.
    pub id: &'static str,
    /// What is wrong.
    pub what: &'static str,
}

/// `Ok` if the rule holds.
#[inline]
fn rule(holds: bool, id: &'static str, what: &'static str) -> Result<(), Broken> {
    if holds { Ok(()) } else { Err(Broken { id, what }) }
}
