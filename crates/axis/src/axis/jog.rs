//! What MC_Jog asks for: an endless motion while a button is held, or one step.
//!
//! MC_Jog is not in the standard. It has no motion of its own: an endless jog is that of MC_MoveVelocity, a step
//! that of MC_MoveRelative, a release that of MC_Halt.

use super::queue::Work;
use super::{Axis, Source};
use crate::{Dynamics, ErrorId, Log};
use standstill_planner::{Limits, Planner};

impl<P: Planner> Axis<P> {
    /// Checks the values at the pins of MC_Jog; a `distance` (u) of 0 is an endless motion.
    pub(super) fn jog(
        &self,
        forward: bool,
        distance: f64,
        dynamics: &Dynamics,
        source: Source,
        log: &mut Log,
    ) -> Result<(Work, Limits), ErrorId> {
        if !(distance >= 0.0 && distance.is_finite()) {
            return Err(self.refuse(
                "Distance",
                distance,
                0.0,
                ErrorId::JogDistanceInvalid,
                source,
                log,
            ));
        }
        let velocity = self.positive_velocity("Velocity", dynamics.velocity, source, log)?;
        let limits = self.resolve(dynamics, source, log)?;
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
