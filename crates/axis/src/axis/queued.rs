//! Administrative commands that wait their turn: `mcQueued`.
//!
//! Source: PLCopen Motion Control Part 1, MC_EXECUTION_MODE and the sections of the blocks that have it. They wait
//! like buffered motions, never own the axis, and do not change its state.

use super::Axis;
use super::commands::{Entry, Work, Write};
use crate::{AxisState, BufferMode, CommandId, ErrorId, ExecutionMode, Fate, Raw, Scope};
use standstill_planner::Planner;

impl<P: Planner> Axis<P> {
    /// Whether a command with this `ExecutionMode` has to wait: the axis has an owner, or other commands wait
    /// already.
    ///
    /// # Errors
    /// [`ErrorId::ExecutionModeInvalid`] if the number is undefined.
    pub(super) fn is_queued(&self, mode: Raw<ExecutionMode>, scope: &mut Scope<'_>) -> Result<bool, ErrorId> {
        let mode = self.element("ExecutionMode", mode, ErrorId::ExecutionModeInvalid, scope)?;
        Ok(mode == ExecutionMode::Queued && self.is_owned())
    }

    /// `work` waits behind all waiting commands.
    ///
    /// # Errors
    /// [`ErrorId::BufferFull`].
    pub(super) fn enqueue(&mut self, work: Work, scope: &mut Scope<'_>) -> Result<CommandId, ErrorId> {
        self.wait()
            .map_err(|(_, error)| self.refuse("ExecutionMode", 1.0, f64::NAN, error, scope))?;
        let id = self.new_id();
        let entry = Entry::new(id, scope.instance, work, self.config.limits, BufferMode::Buffered);
        self.unsettle();
        self.queue.push(entry);
        Ok(id)
    }

    /// Writes the value of the command at the head of the buffer; `false` if that command writes nothing.
    pub(super) fn write_queued(&mut self, scope: &mut Scope<'_>) -> bool {
        let Some(entry) = self.queue.first() else {
            return false;
        };
        let (id, instance, Work::Write(write)) = (entry.id, entry.instance, entry.work) else {
            return false;
        };
        self.queue.pop();
        let fate = match write {
            Write::Output { bit, value } => {
                self.set_output(bit, value);
                Fate::Done
            }
            Write::Parameter { parameter, value } => {
                match self.write_now(parameter, value, &mut scope.with(instance)) {
                    Ok(()) => Fate::Done,
                    Err(error) => Fate::Failed(error),
                }
            }
        };
        self.decide(id, fate);
        true
    }

    /// Whether there is something that a queued command waits for.
    fn is_owned(&self) -> bool {
        match self.state {
            AxisState::Disabled | AxisState::ErrorStop => false,
            AxisState::Standstill
            | AxisState::Homing
            | AxisState::Stopping
            | AxisState::DiscreteMotion
            | AxisState::ContinuousMotion
            | AxisState::SynchronizedMotion => self.owner.is_some() || !self.queue.is_empty(),
        }
    }
}
