//! The core of blocks with an `Execute` pin: edge, one command, and a result that stays for at least one
//! call.
//!
//! Source: PLCopen Motion Control Part 1, section on Execute/Done; rules R19 to R38.

use crate::Context;
use standstill_axis::{AxisId, AxisState, CommandId, EdgeWhileBusy, ErrorId, Fate, Planner};

/// What an Execute-type block shows. Outputs are derived from it, so two terminal outputs at once cannot be
/// written (R21).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Phase {
    /// Nothing commanded, or the result was seen.
    #[default]
    Idle,
    /// Commanded, not finished.
    Busy {
        /// The command owns the axis.
        active: bool,
        /// An endless motion has reached its goal.
        reached: bool,
    },
    /// Completed.
    Done,
    /// Interrupted by another command.
    Aborted,
    /// Refused, or ended by an error.
    Failed(ErrorId),
}

impl Phase {
    /// `Done`.
    pub fn is_done(self) -> bool {
        self == Self::Done
    }

    /// `Busy`.
    pub fn is_busy(self) -> bool {
        matches!(self, Self::Busy { .. })
    }

    /// `Active`.
    pub fn is_active(self) -> bool {
        matches!(self, Self::Busy { active: true, .. })
    }

    /// `InVelocity` and its like.
    pub fn is_reached(self) -> bool {
        matches!(self, Self::Busy { reached: true, .. })
    }

    /// `CommandAborted`.
    pub fn is_aborted(self) -> bool {
        self == Self::Aborted
    }

    /// `Error`.
    pub fn is_error(self) -> bool {
        matches!(self, Self::Failed(_))
    }

    /// `ErrorID`.
    pub fn error_id(self) -> ErrorId {
        if let Self::Failed(id) = self {
            id
        } else {
            ErrorId::None
        }
    }
}

impl From<Fate> for Phase {
    fn from(fate: Fate) -> Self {
        match fate {
            Fate::Waiting => Self::Busy {
                active: false,
                reached: false,
            },
            Fate::Active { reached } => Self::Busy {
                active: true,
                reached,
            },
            Fate::Done => Self::Done,
            Fate::Aborted => Self::Aborted,
            Fate::Failed(id) => Self::Failed(id),
        }
    }
}

/// State kept between calls.
#[derive(Clone, Copy, Debug, Default)]
pub struct ExecuteCore {
    executed: bool,
    /// The phase shown in the last call.
    phase: Phase,
    command: Option<(AxisId, CommandId)>,
}

impl ExecuteCore {
    /// The phase shown in the last call.
    pub fn phase(&self) -> Phase {
        self.phase
    }

    /// One call. At a rising edge (R8) `issue` gives the command. Its argument is the command the
    /// instance held before, which a retrigger replaces silently (R32). It returns the place where the
    /// status of the new command is read.
    #[inline]
    pub fn scan<P: Planner>(
        &mut self,
        execute: bool,
        context: &mut Context<'_, P>,
        issue: impl FnOnce(&mut Context<'_, P>, Option<CommandId>) -> Result<(AxisId, CommandId), ErrorId>,
    ) -> Phase {
        let rising = execute && !self.executed && !self.ignores_edges(context);
        self.executed = execute;
        if rising && let Err(id) = self.start(context, issue) {
            self.phase = Phase::Failed(id);
            return self.phase;
        }
        let phase = match self.command {
            Some((axis, id)) => match context.axes.get(axis.index()) {
                Some(axis) => axis.fate(id).into(),
                None => Phase::Failed(ErrorId::AxisUnknown),
            },
            // A result shown in an earlier call disappears when Execute is FALSE (R28, R30).
            None if !execute => Phase::Idle,
            None => self.phase,
        };
        if !phase.is_busy() {
            self.command = None;
        }
        self.phase = phase;
        phase
    }

    /// The command that continues in a call with `execute`. There is none if it has ended or if a rising
    /// edge is about to replace it.
    pub fn running<P: Planner>(
        &self,
        execute: bool,
        context: &Context<'_, P>,
    ) -> Option<(AxisId, CommandId)> {
        let rising = execute && !self.executed && !self.ignores_edges(context);
        self.command.filter(|_| !rising)
    }

    /// Whether the command runs on an axis that ignores edges while an instance is Busy. MC_Stop never
    /// ignores an edge: its Execute is a lock.
    fn ignores_edges<P: Planner>(&self, context: &Context<'_, P>) -> bool {
        let Some((axis, id)) = self.command else {
            return false;
        };
        context.axes.get(axis.index()).is_some_and(|axis| {
            axis.config().edge_while_busy == EdgeWhileBusy::Ignore
                && axis.state() != AxisState::Stopping
                && Phase::from(axis.fate(id)).is_busy()
        })
    }

    fn start<P: Planner>(
        &mut self,
        context: &mut Context<'_, P>,
        issue: impl FnOnce(&mut Context<'_, P>, Option<CommandId>) -> Result<(AxisId, CommandId), ErrorId>,
    ) -> Result<(), ErrorId> {
        let Some((axis, held)) = self.command.take() else {
            self.command = Some(issue(context, None)?);
            return Ok(());
        };
        // A waiting command gives up its place first, even if the new command is then refused (R97).
        let waited = context.axis(axis).is_ok_and(|(holder, _)| holder.withdraw(held));
        let issued = issue(context, Some(held));
        let new = issued.ok().filter(|(given_to, _)| *given_to == axis);
        if let Ok((holder, scope)) = context.axis(axis) {
            holder.replaced(held, waited, new.map(|(_, id)| id), scope);
        }
        self.command = Some(issued?);
        Ok(())
    }
}
