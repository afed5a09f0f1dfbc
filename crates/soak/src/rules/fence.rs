//! Set-points stay inside the software limits.
//!
//! A motion that was inside does not come out, whatever is commanded: what would is refused or stops before. Only
//! ramps to rest that nobody can refuse may, those after an error or without power, and what moves the coordinates.

use super::{Broken, rule};
use standstill_axis::{Axis, AxisState, Planner};

/// By how much a set-point may be outside, relative to the distance between the limits.
const RELATIVE: f64 = 1e-9;

/// The software limits of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Fence {
    limits: Option<(f64, f64)>,
    /// It was inside with the last set-point, from where it is not to come out.
    inside: bool,
}

impl Fence {
    /// Those of `axis`.
    pub fn new<P: Planner>(axis: &Axis<P>) -> Self {
        Self {
            limits: axis.config().software_limits,
            inside: false,
        }
    }

    /// Coordinates moved.
    pub fn forget(&mut self) {
        self.inside = false;
    }

    /// Looks at the set-point published in a scan.
    ///
    /// # Errors
    /// The rule that does not hold.
    #[inline]
    pub fn check<P: Planner>(&mut self, axis: &Axis<P>) -> Result<(), Broken> {
        let Some((min, max)) = self.limits else {
            return Ok(());
        };
        let position = axis.setpoint().position;
        let near = RELATIVE * (max - min);
        let is_inside = position >= min - near && position <= max + near;
        let was_inside = core::mem::replace(&mut self.inside, is_inside);
        let commanded =
            !(axis.is_following() || axis.state() == AxisState::ErrorStop || axis.outlook().going_off);
        rule(
            is_inside || !was_inside || !commanded,
            "software limits",
            "a motion leaves the software limits",
        )
    }
}
