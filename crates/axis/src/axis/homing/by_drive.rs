//! Homing by the drive: the drive leads, and the set-point follows it until the drive obeys the command
//! again.
//!
//! Source: CiA 402, homing mode; V11, CI-3.

use super::super::commands::Work;
use super::super::feedback::Feedback;
use super::super::power::Reaction;
use super::super::{Axis, Motion};
use super::Phase;
use crate::{AxisState, DriveHoming, DrivePosition, ErrorId, Scope};
use standstill_planner::Planner;

impl<P: Planner> Axis<P> {
    /// Whether the drive moves by itself.
    pub(in crate::axis) fn moves_itself(&self) -> bool {
        self.beside.report.homing != DriveHoming::Off
    }

    /// Whether the drive homes by itself.
    pub(in crate::axis) fn is_homed_by_drive(&self) -> bool {
        matches!(self.homing.phase, Phase::Drive | Phase::Named | Phase::Return)
    }

    /// Whether the set-point follows a drive that obeys the command again.
    pub(super) fn is_to_return(&self) -> bool {
        let in_operation = matches!(self.state, AxisState::Homing | AxisState::Stopping)
            && self.power.is_on()
            && !self.power.is_going_off();
        in_operation && matches!(self.mover.motion(), Motion::Follow) && !self.moves_itself()
    }

    /// The drive homes by itself, or has not returned to the command yet.
    pub(super) fn follow_drive_homing(&mut self, scope: &mut Scope<'_>) {
        let told = self.beside.report.homing;
        if let (DriveHoming::Attained(reference) | DriveHoming::Done(reference), Phase::Drive) =
            (told, self.homing.phase)
        {
            self.take_names_of_drive(reference, scope);
        }
        let homes = matches!(self.homing.phase, Phase::Drive | Phase::Named);
        match told {
            DriveHoming::Off if self.is_to_return() => {
                self.hold_at_actual();
                if self.homing.phase == Phase::Return {
                    self.homing.phase = Phase::Found;
                }
            }
            DriveHoming::Off => {}
            DriveHoming::Failed(code) if homes => {
                self.trip(ErrorId::DriveHomingFailed, code, Reaction::Follow, scope);
            }
            DriveHoming::Done(_) if homes => {
                self.mover.follow();
                self.homing.phase = Phase::Return;
                self.beside.order.homing = false;
            }
            DriveHoming::Busy | DriveHoming::Attained(_) | DriveHoming::Done(_) | DriveHoming::Failed(_) => {
                self.mover.follow();
            }
        }
        let limit = self.config.homing.time_limit;
        self.homing.scans = self.homing.scans.saturating_add(1);
        if self.is_homed_by_drive() && limit.is_some_and(|limit| self.homing.scans > limit) {
            self.trip(ErrorId::HomingTimedOut, 0, Reaction::Ramp, scope);
        }
    }

    /// The drive shifts its positions from this scan on: at the position of `reference` the homing has its Position.
    /// Earlier positions can't be compared with the new ones, so this scan counts as at rest.
    fn take_names_of_drive(&mut self, reference: DrivePosition, scope: &mut Scope<'_>) {
        let Some(Work::Home(position)) = self.owner.map(|owner| owner.work) else {
            return;
        };
        self.homing.phase = Phase::Named;
        self.homing.reference = position;
        let by = position - self.place_of(reference);
        self.frame.shift_by(by);
        self.is_plain = false;
        let actual = self.shown_place(self.feedback.position() + by);
        let step = actual - self.mover.setpoint().position;
        self.tell_moved(step, &mut self.owner_scope(scope));
        self.frame.count_move(step);
        self.feedback = Feedback::new(actual);
        self.measured.rename();
        self.mover.stand_at(actual);
        self.mover.follow();
    }
}
