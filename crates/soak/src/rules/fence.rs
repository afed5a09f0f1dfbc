//! Set-points stay inside the software limits.
//!
//! A motion that was inside does not leave the limits, for any command: a motion that would leave is refused or
//! stops before. There are exceptions: ramps to rest that cannot be refused, ramps after an error or without power,
//! shifts of coordinates, and an axis that a drive moves until it has power again. A shaper may also still hold
//! positions from before the limits were written, or of a motion that began outside.

use super::{Broken, rule};
use standstill_axis::{Axis, AxisState, Planner};

/// The tolerance of a set-point outside, relative to the distance between the limits.
const RELATIVE: f64 = 1e-9;

/// No software limits.
const NONE: (f64, f64) = (f64::NEG_INFINITY, f64::INFINITY);

/// The software limits in force, infinite if there is none: those of the configuration, and those written
/// since.
fn limits_of<P: Planner>(axis: &Axis<P>) -> (f64, f64) {
    let on = |number| axis.bool_parameter(number) == Ok(true);
    let at = |number, off| {
        axis.real_parameter(number)
            .ok()
            .filter(|_| on(number + 2))
            .unwrap_or(off)
    };
    (at(3, NONE.0), at(2, NONE.1))
}

/// The software limits of one axis.
#[derive(Clone, Copy, Debug)]
pub struct Fence {
    limits: (f64, f64),
    /// It was inside with the last set-point, and must not leave.
    inside: bool,
    /// A shaper may hold a position outside: from before the limits were written, or from the start of the motion.
    comes_out: bool,
}

impl Fence {
    /// Those of `axis`.
    pub fn new<P: Planner>(axis: &Axis<P>) -> Self {
        Self {
            limits: limits_of(axis),
            inside: false,
            comes_out: false,
        }
    }

    /// The coordinates were shifted.
    pub fn forget(&mut self) {
        self.inside = false;
    }

    /// Checks the set-point published in a scan.
    ///
    /// # Errors
    /// The rule that does not hold.
    #[inline]
    pub fn check<P: Planner>(&mut self, axis: &Axis<P>) -> Result<(), Broken> {
        let limits @ (min, max) = limits_of(axis);
        let is_shaped = axis.config().vibration.iter().any(Option::is_some);
        if core::mem::replace(&mut self.limits, limits) != limits {
            self.forget();
            self.comes_out = is_shaped;
        }
        if limits == NONE {
            return Ok(());
        }
        let position = axis.setpoint().position;
        let apart = max - min;
        let near = RELATIVE * if apart.is_finite() { apart } else { position.abs() };
        let is_inside = position >= min - near && position <= max + near;
        let was_inside = core::mem::replace(&mut self.inside, is_inside);
        // A homing searches the reference of the limits, so they do not apply yet (docs/homing.md).
        let exempt = matches!(axis.state(), AxisState::ErrorStop | AxisState::Homing);
        let commanded = !(axis.is_following() || exempt || axis.outlook().going_off);
        self.comes_out &= axis.state() != AxisState::Standstill;
        self.comes_out |= is_shaped && !is_inside;
        if axis.is_following() || self.comes_out {
            self.forget();
        }
        rule(
            is_inside || !was_inside || !commanded,
            "software limits",
            "a motion leaves the software limits",
        )
    }
}
