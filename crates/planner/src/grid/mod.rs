//! Rest to rest with every switching instant on the sample grid.
//!
//! A step that passes through m moving sums (boxes) of whole lengths is a profile of order m that ends exactly on
//! its target. Planning is the choice of the box lengths. `docs/planner.md` derives it.

mod euler;
mod plan;
mod problem;
mod profile;
mod search;
mod sequential;
mod unequal;

pub use euler::Euler;
pub use plan::{Counts, GridPlan};
pub use profile::{Peaks, Segment, Segments};
pub use search::{Family, MAX_CANDIDATES, MAX_ROWS, Work};
pub use unequal::{MAX_RAMP_ROWS, UnequalPlan, UnequalSegments, UnequalWork};

/// How the box lengths are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The published steps, each time rounded up to the grid, corrected (docs/planner.md, section 4).
    Sequential,
    /// The fewest samples inside the published 15-segment family (docs/planner.md, section 5).
    Grid,
    /// The fewest samples when the two middle jerk pulses may overlap: `n4 >= n2 + n3`.
    Overlapped,
}
