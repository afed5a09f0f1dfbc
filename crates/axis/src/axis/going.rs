//! Scans in which an axis only continues. A host may omit calls of blocks that would do nothing new in them.

use super::mover::Motion;
use super::{Axis, Routine};
use crate::Scope;
use standstill_planner::Planner;

/// The next scan of an axis if nothing happens: no command is given, and its drive reports nothing new but a
/// position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Going {
    /// It is not in operation, or something is pending, supervised or superimposed.
    Unknown,
    /// In operation with nothing pending: it reaches a goal, or does anything else that is not listed here.
    Arrives,
    /// It continues along its plan and does not reach the goal.
    ToGoal,
    /// Its endless motion has reached its velocity and continues.
    AtVelocity,
    /// It is at rest without a command.
    Rests,
}

impl Going {
    /// Whether its next scan changes only its set-point and its actual position, and nothing else that blocks see.
    #[must_use]
    pub fn is_onward(self) -> bool {
        matches!(self, Self::ToGoal | Self::AtVelocity | Self::Rests)
    }
}

impl<P: Planner> Axis<P> {
    /// What the axis does in the next scan. Call it after a motion step. Cost: a few comparisons.
    #[must_use]
    #[inline]
    pub fn going(&self) -> Going {
        let is_plain = self.routine == Routine::Alone && !self.links().is_bound();
        if !is_plain || self.mover.is_watched() || self.is_held_up() {
            return Going::Unknown;
        }
        match self.mover.motion() {
            Motion::Run { .. } if self.mover.is_short_of_goal() => Going::ToGoal,
            Motion::Run { elapsed, scans, .. }
                if elapsed >= scans && !self.is_shaped() && self.is_cruising() =>
            {
                Going::AtVelocity
            }
            Motion::Hold
                if self.owner.is_none()
                    && self.queue.is_empty()
                    && self.mover.setpoint().is_at_rest()
                    && self.mover.is_through() =>
            {
                Going::Rests
            }
            _ => Going::Arrives,
        }
    }

    /// The number of scans for which it continues like this if nothing happens; see [`Axis::going`].
    #[must_use]
    pub fn goes_on_for(&self) -> u64 {
        match (self.going(), self.mover.motion()) {
            (Going::ToGoal, Motion::Run { elapsed, scans, .. }) => {
                scans.saturating_sub(elapsed.saturating_add(1))
            }
            (Going::AtVelocity | Going::Rests, _) => u64::MAX,
            _ => 0,
        }
    }

    /// The motion step of an axis without masters and slaves, the same as in
    /// [`steps::advance`](crate::steps::advance).
    // See `follow_feedback`.
    #[inline(always)]
    pub fn step_alone(&mut self, scope: &mut Scope<'_>) {
        self.advance(scope);
        self.shape(scope);
    }
}
