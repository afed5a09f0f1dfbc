//! Torque control instead of position control.
//!
//! While MC_TorqueControl owns the axis the drive holds a torque, and the set-point is the actual state:
//! position and velocity as latched. So another motion takes over from the present place and velocity of
//! the axis. The velocity limit of the torque is a ramp with the accelerations of the command, from the
//! velocity at its start to the limit.
//!
//! Source: PLCopen Motion Control Part 1, MC_TorqueControl and MC_ReadActualTorque; V25.

use super::commands::{Entry, Work};
use super::{Axis, Motion};
use crate::{AxisState, Direction, Dynamics, ErrorId, Raw, Scope, TorqueOrder, TorqueReport};
use standstill_planner::{Limits, Plan, Planner, Setpoint};

impl<P: Planner> Axis<P> {
    /// The actual torque, in the unit of the drive; positive towards larger positions.
    ///
    /// # Errors
    /// [`ErrorId::TorqueUnknown`] if the drive does not report it, those of [`Axis::fresh_position`] if
    /// the last report is old.
    pub fn actual_torque(&self) -> Result<f64, ErrorId> {
        self.fresh_position()?;
        let report = self.beside.report.torque.ok_or(ErrorId::TorqueUnknown)?;
        Ok(report.actual)
    }

    /// The values at the pins of MC_TorqueControl.
    pub(super) fn check_torque(
        &self,
        (torque, ramp): (f64, f64),
        dynamics: &Dynamics,
        direction: Raw<Direction>,
        scope: &mut Scope<'_>,
    ) -> Result<(Work, Limits), ErrorId> {
        let mut refuse = |pin, value, limit, error| Err(self.refuse(pin, value, limit, error, scope));
        let most = match self.beside.report.torque {
            Some(TorqueReport { most, .. }) if most > 0.0 => most,
            _ => return refuse("Axis", f64::NAN, f64::NAN, ErrorId::TorqueNotHeld),
        };
        if !torque.is_finite() {
            return refuse("Torque", torque, f64::NAN, ErrorId::TorqueInvalid);
        }
        if !(ramp >= 0.0 && ramp.is_finite()) {
            return refuse("TorqueRamp", ramp, 0.0, ErrorId::TorqueInvalid);
        }
        if torque.abs() > most {
            return refuse("Torque", torque, most, ErrorId::TorqueAboveLimit);
        }
        let (torque, along) = match direction.get() {
            Some(Direction::Unset | Direction::Positive) => (torque, false),
            Some(Direction::Negative) => (-torque, false),
            Some(Direction::Current) => (torque, true),
            Some(Direction::ShortestWay) | None => {
                let number = f64::from(direction.number());
                return refuse("Direction", number, f64::NAN, ErrorId::DirectionInvalid);
            }
        };
        // Like the accelerations, 0 takes the value of the axis.
        let velocity = if dynamics.velocity == 0.0 {
            self.parameters.limits.velocity
        } else {
            self.positive_velocity("Velocity", dynamics.velocity, scope)?
        };
        let limits = self.resolve(dynamics, scope)?.with_velocity(velocity);
        Ok((Work::Torque { torque, ramp, along }, limits))
    }

    /// The velocity (u/s) to which the limit under the torque of `entry` changes. It has the direction of the torque.
    /// A torque of 0 lets an axis coast, which may be faster.
    ///
    /// # Errors
    /// [`ErrorId::OutwardFromSoftwareLimit`] if the torque leads out.
    pub(super) fn torque_goal(&self, entry: &Entry, start: &Setpoint) -> Result<f64, ErrorId> {
        let (torque, most) = (torque_of(entry), entry.limits.velocity);
        self.not_outward(start.position, torque)?;
        Ok(if torque != 0.0 {
            most.copysign(torque)
        } else if start.velocity.abs() > most {
            most.copysign(start.velocity)
        } else {
            0.0
        })
    }

    /// The motion under a torque, starting from the present torque as far as the drive can hold it.
    /// `plan` is the ramp of the velocity limit.
    pub(super) fn under_torque(&self, plan: P::Plan) -> Motion<P::Plan> {
        let torque = match (self.mover.motion(), &self.beside.report.torque) {
            (Motion::Torque { torque, .. }, _) => *torque,
            (_, Some(report)) => report.actual,
            (_, None) => 0.0,
        };
        Motion::Torque {
            plan,
            elapsed: 0,
            torque: within(torque, self.most_torque()),
        }
    }

    /// The largest torque that the drive reports it can hold now; 0 if it holds none.
    fn most_torque(&self) -> f64 {
        let told = self.beside.report.torque.map(|torque| torque.most);
        told.filter(|most| *most > 0.0).unwrap_or(0.0)
    }

    /// After the latch: under a torque the set-point is the actual state. The ramp of an error that was raised before
    /// the latch begins there, too.
    pub(super) fn follow_actual(&mut self, scope: &mut Scope<'_>) {
        let Ok(velocity) = self.actual_velocity() else {
            return;
        };
        let is_raised = self.state == AxisState::ErrorStop
            && self.beside.order.torque.is_some()
            && matches!(self.mover.motion(), Motion::Run { .. } | Motion::Hold);
        if is_raised || matches!(self.mover.motion(), Motion::Torque { .. }) {
            self.mover.take_actual(self.feedback.position(), velocity);
            self.count_actual_turns();
        }
        if is_raised {
            self.ramp_down(self.stop_limits(), &self.hardest_limits(), scope);
        }
    }

    /// The torque of this scan, on its ramp, and the velocity at which it is held.
    #[cold]
    #[inline(never)]
    pub(super) fn step_torque(&mut self) {
        let (cycle, most_torque) = (self.planner.cycle(), self.most_torque());
        let Some(owner) = self.owner else { return };
        let (
            Work::Torque { ramp, .. },
            Motion::Torque {
                plan,
                elapsed,
                torque,
            },
        ) = (owner.work, self.mover.motion())
        else {
            return;
        };
        let limit = plan.at(elapsed.saturating_add(1)).velocity;
        let goal = torque_of(&owner);
        let step = if ramp > 0.0 { ramp * cycle } else { f64::INFINITY };
        let left = goal - *torque;
        let next = if left.abs() <= step {
            goal
        } else {
            *torque + step.copysign(left)
        };
        // The largest torque of the drive may have decreased.
        let torque = within(next, most_torque);
        let most = owner.limits.velocity;
        let velocity = (
            if goal < 0.0 { limit } else { limit.min(-most) },
            if goal > 0.0 { limit } else { limit.max(most) },
        );
        self.mover.step_torque(torque);
        self.beside.order.torque = Some(TorqueOrder { torque, velocity });
        self.mover.publish(*self.mover.setpoint());
    }

    /// Withdraws the torque order when the motion is another one.
    #[inline]
    pub(super) fn follow_torque_order(&mut self) {
        if self.beside.order.torque.is_some() && !matches!(self.mover.motion(), Motion::Torque { .. }) {
            self.beside.order.torque = None;
        }
    }

    /// Whether the torque ordered last is the commanded one, and nothing limits it (R40).
    #[inline(never)]
    pub(super) fn torque_is_held(&self, torque: f64) -> bool {
        let goal = self.owner.as_ref().map(torque_of);
        let limited = self.beside.report.torque.is_some_and(|report| report.limited);
        goal == Some(torque) && !limited
    }
}

/// `torque`, limited to the largest torque `most` (from 0) of a drive; none if it is not a number.
fn within(torque: f64, most: f64) -> f64 {
    if !torque.is_finite() {
        0.0
    } else if torque > most {
        most
    } else if torque < -most {
        -most
    } else {
        torque
    }
}

/// The torque of `entry`.
fn torque_of(entry: &Entry) -> f64 {
    match entry.work {
        Work::Torque {
            torque, along: true, ..
        } => torque * entry.sign,
        Work::Torque { torque, .. } => torque,
        _ => 0.0,
    }
}
