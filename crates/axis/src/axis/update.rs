//! ContinuousUpdate: new values at the pins of a command that is not finished.
//!
//! The block decides whether it may update, and whether a value changed. Here the new values are checked
//! like those of a new command, and the owner is planned anew from the last set-point. It stays the same
//! command: the state, the buffer and the superimposed motion do not change, and a distance counts from
//! its original start. Invalid values change nothing and are recorded.
//!
//! Source: PLCopen Motion Control Part 1, section on ContinuousUpdate; R9 to R13, B16, T39a to T39c.

use super::commands::{Asked, Entry, Place, REST, Start, Work, direction_of};
use super::{Axis, Motion};
use crate::{Command, CommandId, ErrorId, Scope};
use core::mem;
use standstill_planner::{Limits, Planner};

impl<P: Planner> Axis<P> {
    /// Gives command `id` the values of `command`, which is of the same kind. A waiting command uses them
    /// when it becomes active. No effect on a command that has ended or does not move.
    ///
    /// Cost: that of a new command.
    ///
    /// # Errors
    /// The error of a new command with these values. It is recorded, and the command continues unchanged.
    pub fn update(&mut self, id: CommandId, command: &Command, scope: &mut Scope<'_>) -> Result<(), ErrorId> {
        match self.owner {
            Some(owner) if owner.id == id => self.update_owner(owner, command, scope),
            _ => self.update_waiting(id, command, scope),
        }
    }

    fn update_owner(
        &mut self,
        mut owner: Entry,
        command: &Command,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let Some((work, limits)) = self.check_update(&owner, command, scope)? else {
            return Ok(());
        };
        let direction = direction_of(command);
        let moved = work.manner().place != owner.work.manner().place || direction != owner.direction;
        let same_work = work == owner.work.with_velocity(owner.asked.velocity);
        if same_work && !moved && limits == owner.asked.limits {
            // The pins have the present values again, after others were refused.
            return Ok(());
        }
        let was = owner;
        self.note_passing(&mut owner);
        self.take_values(&mut owner, command, work, limits);
        owner.direction = direction;
        let planned = if moved {
            owner.passed = false;
            self.aim_anew(&mut owner);
            self.replan_aimed(owner, scope)
        } else {
            self.replan(owner, scope)
        };
        if let Err(error) = planned.and_then(|()| self.resume_at_rest(scope)) {
            self.own(was);
            return Err(self.refuse_plan(&owner, error, scope));
        }
        self.record_slowed(&owner, scope);
        Ok(())
    }

    fn update_waiting(
        &mut self,
        id: CommandId,
        command: &Command,
        scope: &mut Scope<'_>,
    ) -> Result<(), ErrorId> {
        let Some(mut entry) = self.queue.iter().find(|entry| entry.id == id).copied() else {
            return self.update_awaited(id, command, scope);
        };
        let Some((work, limits)) = self.check_update(&entry, command, scope)? else {
            return Ok(());
        };
        self.take_values(&mut entry, command, work, limits);
        entry.direction = direction_of(command);
        for slot in self.queue.iter_mut().filter(|slot| slot.id == id) {
            *slot = entry;
        }
        self.arm_anew(scope);
        self.resume(scope);
        Ok(())
    }

    /// The new values, checked; `None` if they are of another kind of command, or of one that does not move.
    pub(super) fn check_update(
        &self,
        entry: &Entry,
        command: &Command,
        scope: &mut Scope<'_>,
    ) -> Result<Option<(Work, Limits)>, ErrorId> {
        // It counts from its original start, not from the last target.
        let (work, limits) = match (*command, entry.work) {
            (Command::MoveAdditive { distance, dynamics }, Work::Position(_)) => {
                let added = Command::MoveRelative { distance, dynamics };
                let (_, limits) = self.check(&added, Start::Wait, scope)?;
                let position = self.finite("Distance", entry.from + distance, scope)?;
                self.inside("Distance", position, scope)?;
                (Work::Position(position), limits)
            }
            _ => self.check(command, Start::Wait, scope)?,
        };
        let is_same_kind = match (work, entry.work) {
            // Another master is another coupling.
            (Work::Gear(new), Work::Gear(old)) => new.masters() == old.masters(),
            (Work::Cam(new), Work::Cam(old)) => new.master == old.master,
            (new, old) => mem::discriminant(&new) == mem::discriminant(&old),
        };
        Ok((is_same_kind && work.manner().updated).then_some((work, limits)))
    }

    pub(super) fn take_values(&self, entry: &mut Entry, command: &Command, work: Work, limits: Limits) {
        entry.work = work;
        entry.limits = limits;
        entry.asked = Asked::by(command, &work, limits);
        self.override_entry(entry);
    }

    /// The end of the owner, from its present position.
    fn aim_anew(&self, owner: &mut Entry) {
        let base = self.mover.base();
        let from = match owner.place() {
            // On a modulo axis the direction to a position is found from here.
            Some(Place::At(_)) | None => base.position,
            Some(Place::By(_)) => owner.from,
        };
        self.aim_from(owner, &base, from);
    }

    /// A waiting command has changed: the velocity at the end of the owner may change (B16).
    pub(super) fn arm_anew(&mut self, scope: &mut Scope<'_>) {
        let leads = |owner: &Entry| owner.end.is_some();
        if !self.pass_at_rest(scope) && self.owner.as_ref().is_some_and(leads) {
            self.arm_owner(scope);
        }
    }

    /// The command that was to take over in motion may no longer do that: the owner then comes to rest at its end.
    /// Returns whether that is so.
    pub(super) fn pass_at_rest(&mut self, scope: &mut Scope<'_>) -> bool {
        let blends = |owner: &Entry| owner.end.is_some() && owner.passage != REST;
        let Some(owner) = self.owner.filter(blends) else {
            return false;
        };
        if self.passage(&owner, self.mover.base().position, 0) != REST {
            return false;
        }
        if matches!(self.mover.motion(), Motion::Run { .. }) && self.replan(owner, scope).is_err() {
            // If it would take too long to rest from here, it continues as planned.
            self.end_run();
        }
        true
    }
}
