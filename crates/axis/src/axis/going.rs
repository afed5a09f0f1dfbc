//! Scans in which an axis only goes on, for hosts that leave out calls of blocks which would do nothing new.

use super::mover::Motion;
use super::{Axis, Calm};
use crate::Scope;
use standstill_planner::Planner;

/// What an axis does in the next scan if nothing comes to it: no command, and from its drive no news but a position.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Going {
    /// It is not in operation, or something is pending, supervised or superimposed.
    Unknown,
    /// In operation with nothing pending, it comes to a goal, or does what is not told here.
    Arrives,
    /// It goes on along its plan, short of the goal.
    ToGoal,
    /// Its endless motion has come to its velocity, and goes on.
    AtVelocity,
    /// It rests, and nobody has commanded anything.
    Rests,
}

impl Going {
    /// Its next scan changes its set-point and its actual position, and nothing else that blocks see.
    #[must_use]
    pub fn is_onward(self) -> bool {
        matches!(self, Self::ToGoal | Self::AtVelocity | Self::Rests)
    }
}

impl<P: Planner> Axis<P> {
    /// What it does in the next scan, told after a motion step. Cost: a few comparisons.
    #[must_use]
    #[inline]
    pub fn going(&self) -> Going {
        let is_plain = self.calm == Calm::Alone && !self.links().is_bound();
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

    /// For how many scans it is going on as it is now, if nothing comes to it; see [`Axis::going`].
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

    /// The motion step of an axis without masters and slaves, as [`steps::advance`](crate::steps::advance) does it.
    // See `follow_feedback`.
    #[inline(always)]
    pub fn step_alone(&mut self, scope: &mut Scope<'_>) {
        self.advance(scope);
        self.shape(scope);
    }
}
