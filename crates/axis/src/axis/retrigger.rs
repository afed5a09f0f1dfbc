//! An instance that is triggered again while it has a command.
//!
//! A waiting command gives up its place before the new command is checked, even if that is then refused.
//! A moving command continues to its end. If the new command is refused, no block follows the moving one
//! any more. This is recorded, and from then on every event that would pause the motion ends it, like
//! MC_Halt: it never starts again by itself.
//!
//! Source: PLCopen Motion Control Part 1, section on Execute/Done; R32, R38, R97, B19.

use super::Axis;
use super::commands::{Entry, REST, Run, Work};
use super::power::Reaction;
use crate::{AxisEvent, CommandId, Event, Fate, Scope};
use standstill_planner::Planner;

impl<P: Planner> Axis<P> {
    /// The instance of command `id` is about to give another one. If `id` waits, it is removed from the buffer, or
    /// from the wait for room, and never becomes active. Returns whether it was removed. [`Axis::replaced`] must
    /// follow in the same call.
    pub fn withdraw(&mut self, id: CommandId) -> bool {
        if self.queue.remove(id) {
            self.decide(id, Fate::Aborted);
            return true;
        }
        if self.awaits_start(id) {
            self.end_awaited(Fate::Aborted);
            return true;
        }
        self.withdraw_superimposed(id) || self.withdraw_shift(id)
    }

    /// The instance of command `id` now follows the command `new`; none if that was refused, or was given to another
    /// axis. [`Axis::withdraw`] returned whether `id` `waited`.
    ///
    /// Cost: at most two plans, and a search of the buffer.
    pub fn replaced(&mut self, id: CommandId, waited: bool, new: Option<CommandId>, scope: &mut Scope<'_>) {
        if waited {
            self.arm_anew(scope);
            // A move that is barred behind its end was waiting for the removed command.
            self.resume(scope);
        } else if self.profile_is_due(id) {
            return self.pass_over_due_profile(id, scope);
        }
        let of_instance = |owner: &&mut Entry| owner.id == id || owner.heir == Some(id);
        match (self.owner.as_mut().filter(of_instance), new) {
            (Some(owner), Some(new)) => owner.heir = Some(new),
            (Some(owner), None) => {
                let owner = owner.id;
                self.orphan(owner, scope);
            }
            (None, None) if !waited => self.orphan(id, scope),
            (None, _) => {}
        }
    }

    /// Command `id`, which waited, has failed: the motion of its instance continues (B19, R79).
    pub(super) fn lose_heir(&mut self, id: CommandId, scope: &mut Scope<'_>) {
        if let Some(owner) = self.owner.filter(|owner| owner.heir == Some(id)) {
            self.orphan(owner.id, scope);
        }
    }

    /// No block follows command `id` any more.
    fn orphan(&mut self, id: CommandId, scope: &mut Scope<'_>) {
        let owner = self.owner.as_mut().filter(|owner| owner.id == id);
        if let Some(owner) = owner {
            owner.orphaned = true;
        } else if !self.orphan_superimposed(id) {
            return;
        }
        self.record(Event::Orphaned, scope);
        self.end_orphan();
    }

    /// An owner that no block follows has been held up: it becomes a halt.
    pub(super) fn end_orphan(&mut self) {
        let held_up = |owner: &Entry| owner.orphaned && (owner.paused || owner.halted);
        if let Some(owner) = self.owner.filter(held_up) {
            self.end_coupling();
            self.enter(AxisEvent::StartDiscrete);
            self.own(Entry {
                work: Work::Halt,
                end: None,
                passage: REST,
                run: Run::NONE,
                paused: false,
                halted: false,
                ..owner
            });
        }
    }

    /// The profile that becomes active no longer has a block to give its points. The next command becomes
    /// active. If there is none, the axis comes to rest, by a motion that no block follows.
    #[cold]
    fn pass_over_due_profile(&mut self, id: CommandId, scope: &mut Scope<'_>) {
        if self.mover.setpoint().is_at_rest() {
            self.end_owner(Fate::Aborted);
            self.rest_due();
        }
        self.hand_over(self.mover.setpoint().position, scope);
        let Some(mut halt) = self.owner.filter(|owner| owner.id == id) else {
            return;
        };
        halt.work = Work::Halt;
        self.halt_alone(halt, scope);
    }

    /// The owner has passed its end in motion, and the command that was to take over has failed. The
    /// owner is done, and the axis comes to rest.
    #[cold]
    pub(super) fn halt_behind_end(&mut self, scope: &mut Scope<'_>) {
        let scope = &mut self.owner_scope(scope);
        if let Some(owner) = self.owner {
            self.end_owner(Fate::Done);
            self.halt_after(&owner, scope);
        }
    }

    /// `ended` has ended and nothing takes over. An axis in motion comes to rest, unless the motion has
    /// an end of its own.
    pub(super) fn halt_after(&mut self, ended: &Entry, scope: &mut Scope<'_>) {
        let id = self.new_id();
        let halt = Entry {
            // For an axis at rest there is nothing to record.
            orphaned: self.mover.setpoint().is_at_rest(),
            ..Entry::new(id, ended.instance, Work::Halt, ended.limits, ended.mode)
        };
        self.halt_alone(halt, scope);
    }

    /// The axis comes to rest by `halt`, which no block follows.
    fn halt_alone(&mut self, mut halt: Entry, scope: &mut Scope<'_>) {
        self.bound_entry(&mut halt);
        let before = self.limits_before(&halt.limits);
        let planned = match self.plan_next(&mut halt) {
            Ok(Some(motion)) => Ok(motion),
            Ok(None) => {
                // There is no room for a stop beside the superimposed motion, so that motion ends too.
                self.end_superimposed(Fate::Aborted);
                self.plan_for(&mut halt)
            }
            Err(error) => Err(error),
        };
        match planned {
            Ok(motion) => {
                self.begin(halt, motion, before, scope);
                if !halt.orphaned {
                    self.orphan(halt.id, scope);
                }
            }
            Err(error) => self.trip(error, 0, Reaction::Ramp, scope),
        }
    }
}
