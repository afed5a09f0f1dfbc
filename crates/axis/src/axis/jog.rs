//! What MC_Jog asks for: an endless motion while a button is held, or one step.
//!
//! MC_Jog is not in the standard. It has no motion of its own: an endless jog is that of MC_MoveVelocity, a step
//! that of MC_MoveRelative, a release that of MC_Halt.

use super::Axis;
use super::commands::Work;
use crate::{Dynamics, ErrorId, Scope};
use standstill_planner::{Limits, Planner};

impl<P: Planner> Axis<P> {
    /// Checks the values at the pins of MC_Jog; a `distance` (u) of 0 is an endless motion.
    pub(super) fn jog(
        &self,
        forward: bool,
        distance: f64,
        dynamics: &Dynamics,
        scope: &mut Scope<'_>,
    ) -> Result<(Work, Limits), ErrorId> {
        if !(distance >= 0.0 && distance.is_finite()) {
            return Err(self.refuse("Distance", distance, 0.0, ErrorId::JogDistanceInvalid, scope));
        }
        let velocity = self.positive_velocity("Velocity", dynamics.velocity, scope)?;
        let limits = self.resolve(dynamics, scope)?;
        let way = |magnitude: f64| if forward { magnitude } else { -magnitude };
        Ok(if distance > 0.0 {
            (Work::Distance(way(distance)), Limits { velocity, ..limits })
        } else {
            let work = Work::Velocity {
                velocity: way(velocity),
                along: false,
            };
            (work, limits)
        })
    }
}
