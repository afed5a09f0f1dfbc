//! The distance of the axis from its set position: the following error, and the window at the end of a
//! move.
//!
//! The following error is the set position published in the last scan, less the actual position latched in this one.
//! It is 0 for a drive that follows exactly. With a delay of some scans it is the travel in those scans.
//!
//! Source: PLCopen Motion Control Part 1, parameters 6 and 7; V12d.

use super::feedback::nearest;
use super::power::Reaction;
use super::{Axis, Motion};
use crate::{ErrorId, InPosition, Scope};
use standstill_planner::Planner;

/// Supervision of the following error.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lag {
    /// Largest following error (u); infinite if never given.
    pub most: f64,
    /// It is supervised.
    pub on: bool,
}

impl Lag {
    pub fn new(most: Option<f64>) -> Self {
        Self {
            most: most.unwrap_or(f64::INFINITY),
            on: most.is_some(),
        }
    }
}

/// The end of a move, until the axis is in position.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Arrival {
    /// Scans in a row inside the window.
    inside_for: u32,
}

impl Arrival {
    /// Scans in a row the axis has been inside the window.
    pub fn scans(&self) -> u32 {
        self.inside_for
    }

    /// Whether it has been inside for the required time, including this scan with this following error
    /// (u). NaN is outside.
    fn is_in_position(&mut self, error: f64, window: InPosition) -> bool {
        if !(error.abs() <= window.window) {
            self.inside_for = 0;
            return false;
        }
        let inside_for = self.inside_for;
        self.inside_for = inside_for.saturating_add(1);
        inside_for >= window.scans
    }
}

impl<P: Planner> Axis<P> {
    /// The set position last published less the actual position (u), on a modulo axis in the direction of the shorter
    /// distance.
    pub(super) fn following_error(&self) -> f64 {
        let error = self.mover.commanded().position - self.feedback.position();
        match &self.modulo {
            None => error,
            Some(modulo) => nearest(error, 0.0, modulo.length),
        }
    }

    /// Whether the following error is too large, or not a number.
    pub(super) fn lags(&self) -> bool {
        let lag = &self.parameters.lag;
        let is_led =
            self.power.is_on() && !matches!(self.mover.motion(), Motion::Follow | Motion::Torque { .. });
        lag.on && is_led && !(self.following_error().abs() <= lag.most)
    }

    /// After the latch: ErrorStop if the axis lags, or is about to leave the software limits under a torque.
    pub(super) fn supervise(&mut self, scope: &mut Scope<'_>) {
        if self.lags() {
            self.trip(ErrorId::FollowingErrorTooLarge, 0, Reaction::Ramp, scope);
        } else if matches!(self.mover.motion(), Motion::Torque { .. }) && self.torque_would_leave() {
            self.trip(ErrorId::SoftwareLimitReached, 0, Reaction::Ramp, scope);
        }
    }

    /// Whether a move at its goal is done: the actual position has been inside the window for the
    /// required time.
    pub(super) fn has_arrived(&mut self) -> bool {
        let Some(window) = self.config.in_position else {
            return true;
        };
        let error = self.following_error();
        self.arrival.is_in_position(error, window)
    }
}
