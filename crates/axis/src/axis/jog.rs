//! The motions of MC_Jog: an endless motion while a button is held, or one step.
//!
//! MC_Jog is not in the standard. It uses existing motions: MC_MoveVelocity for an endless jog, MC_MoveRelative for a
//! step, and MC_Halt for a release. With `jog_at_limit` `stop`, an endless jog towards a software limit is
//! MC_MoveContinuousAbsolute to the limit with end velocity 0. It stays there, in control, until the release. A step
//! that would lead beyond the limit ends on it.

use super::Axis;
use super::commands::{Place, Work};
use crate::{Dynamics, ErrorId, JogAtLimit, Scope};
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
        let of_move = Limits { velocity, ..limits };
        Ok(match self.jog_ends_at(forward, distance) {
            Some(limit) if distance > 0.0 => (Work::Position(limit), of_move),
            Some(limit) => {
                let to = Place::At(limit);
                let end_velocity = 0.0;
                (Work::Through { to, end_velocity }, of_move)
            }
            None if distance > 0.0 => (Work::Distance(way(distance)), of_move),
            None => {
                let (velocity, along) = (way(velocity), false);
                (Work::Velocity { velocity, along }, limits)
            }
        })
    }

    /// The software limit (u) at which a jog must stop, if the jog moves towards it.
    fn jog_ends_at(&self, forward: bool, distance: f64) -> Option<f64> {
        if self.config.jog_at_limit == JogAtLimit::Error {
            return None;
        }
        let (min, max) = self.parameters.software_limits?;
        let here = self.mover.setpoint().position;
        let (limit, left) = if forward {
            (max, max - here)
        } else {
            (min, here - min)
        };
        let leads_there = distance == 0.0 || distance > left;
        (limit.is_finite() && left >= 0.0 && leads_there).then_some(limit)
    }
}
