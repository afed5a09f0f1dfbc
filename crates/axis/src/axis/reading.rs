//! Values for the reading blocks: actual values, the state of the motion, the reports of the drive.
//!
//! Source: PLCopen Motion Control Part 1, sections on MC_ReadMotionState, MC_ReadAxisInfo and
//! MC_ReadActualVelocity; V12b. Nothing here changes the axis.

use super::commands::Work;
use super::{Axis, Motion};
use crate::{Comms, DriveSignals, ErrorId, Raw, ValueSource};
use standstill_planner::{Plan, Planner, Setpoint};

/// A change of the actual velocity below this part of the lower acceleration limit counts as none.
const CONSTANT_WINDOW: f64 = 0.01;

/// Rounding of one difference of positions, in units of the last place of the position.
const ROUNDING: f64 = 4.0 * f64::EPSILON;

/// The change of a speed.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Pace {
    /// It is constant, also at 0.
    #[default]
    Constant,
    /// It grows.
    Accelerating,
    /// It shrinks.
    Decelerating,
}

/// The direction of a position.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Way {
    /// It stays.
    #[default]
    Rest,
    /// It grows.
    Positive,
    /// It shrinks.
    Negative,
}

impl Way {
    fn of(difference: f64) -> Self {
        if difference > 0.0 {
            Self::Positive
        } else if difference < 0.0 {
            Self::Negative
        } else {
            Self::Rest
        }
    }
}

/// The state of a motion, see [`Axis::motion_state`].
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct MotionState {
    /// The change of its speed.
    pub pace: Pace,
    /// The direction of the position.
    pub way: Way,
}

impl<P: Planner> Axis<P> {
    /// Takes this scan's actual position (u) if earlier ones may have to be shifted. Returns whether the velocity is
    /// a number; if not, nothing is taken.
    pub(super) fn latch_and_mend(&mut self, position: f64) -> bool {
        let before = self.feedback;
        let length = self.config.modulo;
        self.feedback.latch_and_mend(position, length);
        let is_number = self.latched_velocity().is_finite();
        if !is_number {
            self.feedback = before;
        }
        is_number
    }

    /// This scan has no fresh actual position.
    pub(super) fn latch_nothing(&mut self) {
        self.end_routine();
        self.feedback.latch_nothing();
    }

    /// Shifts the coordinates without motion: from the next feedback on, the position `old` (u) has the value `name`
    /// (u).
    pub(super) fn rename_actual(&mut self, old: f64, name: f64) {
        self.end_routine();
        self.feedback.rename(old, name);
        self.measured.shift(old, name);
    }

    /// The actual position (u) if it is fresh.
    ///
    /// # Errors
    /// If it was not latched in this scan: [`ErrorId::CommunicationLost`], or
    /// [`ErrorId::FeedbackInvalid`] if the drive reported an invalid number.
    pub fn fresh_position(&self) -> Result<f64, ErrorId> {
        match self.power.comms() {
            Comms::Ok => Ok(self.feedback.position()),
            Comms::Lost => Err(ErrorId::CommunicationLost),
            Comms::Invalid => Err(ErrorId::FeedbackInvalid),
        }
    }

    /// The actual velocity (u/s): the difference of the actual positions of this scan and the last one, divided by
    /// the cycle. After a loss of communication it is the mean since the last fresh position. A shift of the
    /// coordinates is no motion. Resolution: that of the position, divided by the cycle.
    ///
    /// # Errors
    /// As [`Axis::fresh_position`].
    pub fn actual_velocity(&self) -> Result<f64, ErrorId> {
        self.fresh_position()?;
        Ok(self.latched_velocity())
    }

    /// The actual velocity (u/s) by the positions latched last.
    fn latched_velocity(&self) -> f64 {
        self.feedback.step() / self.planner.cycle()
    }

    /// The actual velocity of the scan before (u/s).
    pub(super) fn velocity_before(&self) -> f64 {
        self.feedback.step_before() / self.planner.cycle()
    }

    /// The state of the motion, by the values that `source` names.
    ///
    /// - Commanded values are those of the active command. They change only in jumps, so the pace is
    ///   constant. The direction is that from the set position to the target, or that of the commanded
    ///   velocity.
    /// - Set values: pace and direction by the plan's acceleration and velocity at the last set-point,
    ///   and not by differences (V12b).
    /// - Actual values: by differences of latched positions. The velocity counts as constant while it
    ///   changes by no more than a hundredth of the lower acceleration limit plus the resolution of the
    ///   position.
    ///
    /// # Errors
    /// [`ErrorId::SourceInvalid`] if the number names no source, those of [`Axis::fresh_position`] if actual values
    /// are requested.
    pub fn motion_state(&self, source: Raw<ValueSource>) -> Result<MotionState, ErrorId> {
        match source.get().ok_or(ErrorId::SourceInvalid)? {
            ValueSource::Commanded => Ok(MotionState {
                pace: Pace::Constant,
                way: self.commanded_way(),
            }),
            ValueSource::Set => Ok(planned_state(&self.mover.commanded())),
            ValueSource::Actual => {
                let actual = self.fresh_position()?;
                Ok(self.measured_state(actual))
            }
        }
    }

    fn commanded_way(&self) -> Way {
        let owner = self.owner.as_ref().map(|owner| &owner.work);
        let left = match (self.mover.motion(), owner) {
            (Motion::Run { plan, .. }, Some(Work::Velocity { .. })) => {
                return Way::of(plan.end().velocity);
            }
            (Motion::Run { plan, .. }, Some(Work::Through { .. })) if self.goal_reached() => {
                return Way::of(plan.end().velocity);
            }
            (Motion::Run { plan, scans, .. }, Some(work)) if work.manner().place.is_some() => {
                plan.at(*scans).position - self.mover.base().position
            }
            (_, Some(_) | None) => 0.0,
        };
        Way::of(left + self.superimposed_left())
    }

    fn measured_state(&self, actual: f64) -> MotionState {
        let (limits, cycle) = (&self.config.limits, self.planner.cycle());
        let step = self.feedback.step();
        let step_before = self.feedback.step_before();
        let resolution = match self.config.scaling {
            // Each position has an error of at most half an increment, their second difference of at most
            // two.
            Some(scaling) => 2.0 * f64::from(scaling.units()) / f64::from(scaling.increments()),
            None => 0.0,
        };
        let window = CONSTANT_WINDOW * limits.lower_acceleration() * cycle * cycle
            + resolution
            + ROUNDING * actual.abs();
        let change = step.abs() - step_before.abs();
        MotionState {
            pace: if change > window {
                Pace::Accelerating
            } else if change < -window {
                Pace::Decelerating
            } else {
                Pace::Constant
            },
            way: Way::of(step),
        }
    }

    /// The communication with the drive is up.
    pub fn is_communicating(&self) -> bool {
        self.power.comms() == Comms::Ok
    }

    /// Whether no known cause keeps the power stage off: communication and supply are there, no fault is
    /// pending.
    pub fn is_ready_for_power(&self) -> bool {
        self.is_communicating() && self.power.has_voltage() && self.power.fault().is_none()
    }

    /// The signals of the drive beside its position.
    pub fn drive_signals(&self) -> DriveSignals {
        self.signals
    }
}

/// By the phase of the profile: in a phase of constant velocity the acceleration of a plan is exactly 0.
fn planned_state(setpoint: &Setpoint) -> MotionState {
    let (velocity, acceleration) = (setpoint.velocity, setpoint.acceleration);
    let pace = if acceleration == 0.0 {
        Pace::Constant
    } else if velocity == 0.0 || (velocity > 0.0) == (acceleration > 0.0) {
        Pace::Accelerating
    } else {
        Pace::Decelerating
    };
    MotionState {
        pace,
        way: Way::of(velocity),
    }
}
