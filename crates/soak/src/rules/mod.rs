//! What must hold in every scan, whatever is done with blocks and axes: said once, for the breadth-first search
//! over all states and for the random runs of `standstill soak blocks`.
//!
//! A rule that does not hold is told by its id in `docs/requirements` and what is wrong. Nothing here allocates.

pub mod arrows;
mod calls;
pub mod fence;
pub mod law;
pub mod limits;
mod truth;

pub use calls::{Call, Kind, Outputs, Shown, check_call};
pub use truth::{Held, Truth, check_truth};

/// A rule that does not hold.
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
