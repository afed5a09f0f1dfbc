//! The core of blocks with an `Execute` pin: edge, one command, and a result that stays for at least one
//! call.
//!
//! Source: PLCopen Motion Control Part 1, section on Execute/Done; rules R19 to R38.

use crate::Context;
use standstill_axis::{Axis, AxisId, AxisState, CommandId, EdgeWhileBusy, ErrorId, Fate, Planner, Scope};

/// What an Execute-type block shows: the fate of its command, or nothing. Outputs are derived from it, so two
/// terminal outputs cannot be TRUE at once (R21).
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Phase(Option<Fate>);

impl Phase {
    /// The fate of the command; `None` if the block shows nothing.
    #[inline]
    pub fn fate(self) -> Option<Fate> {
        self.0
    }

    /// `Done`.
    #[inline]
    pub fn is_done(self) -> bool {
        self.0 == Some(Fate::Done)
    }

    /// `Busy`.
    #[inline]
    pub fn is_busy(self) -> bool {
        matches!(self.0, Some(Fate::Waiting | Fate::Active { .. }))
    }

    /// `Active`.
    #[inline]
    pub fn is_active(self) -> bool {
        matches!(self.0, Some(Fate::Active { .. }))
    }

    /// `InVelocity` and its like.
    #[inline]
    pub fn is_reached(self) -> bool {
        self.0 == Some(Fate::Active { reached: true })
    }

    /// `CommandAborted`.
    #[inline]
    pub fn is_aborted(self) -> bool {
        self.0 == Some(Fate::Aborted)
    }

    /// `Error`.
    #[inline]
    pub fn is_error(self) -> bool {
        matches!(self.0, Some(Fate::Failed(_)))
    }

    /// `ErrorID`.
    #[inline]
    pub fn error_id(self) -> ErrorId {
        if let Some(Fate::Failed(id)) = self.0 {
            id
        } else {
            ErrorId::None
        }
    }
}

impl From<Fate> for Phase {
    #[inline]
    fn from(fate: Fate) -> Self {
        Self(Some(fate))
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

    /// One call. At a rising edge (R8) `issue` gives the command to `axis`. Its second argument is the command the
    /// instance held there before, which a retrigger replaces silently (R32).
    #[inline]
    pub fn scan<P: Planner>(
        &mut self,
        execute: bool,
        axis: AxisId,
        context: &mut Context<'_, P>,
        issue: impl FnOnce(&mut Axis<P>, Option<CommandId>, &mut Scope<'_>) -> Result<CommandId, ErrorId>,
    ) -> Phase {
        self.scan_among(execute, axis, context, |context, replaces| {
            let (axis, scope) = context.axis(axis)?;
            issue(axis, replaces, scope)
        })
    }

    /// The same for a command that also needs other axes.
    #[inline]
    pub fn scan_among<P: Planner>(
        &mut self,
        execute: bool,
        axis: AxisId,
        context: &mut Context<'_, P>,
        issue: impl FnOnce(&mut Context<'_, P>, Option<CommandId>) -> Result<CommandId, ErrorId>,
    ) -> Phase {
        if self.rises(execute, context)
            && let Err(error) = self.start(axis, context, issue)
        {
            return self.fail(error);
        }
        self.status(execute, context)
    }

    /// Whether `execute` differs from that of the last call.
    #[inline]
    pub(crate) fn is_edge(&self, execute: bool) -> bool {
        execute != self.executed
    }

    /// Whether `execute` rises in this call and gives a command.
    #[inline]
    pub(crate) fn rises<P: Planner>(&mut self, execute: bool, context: &Context<'_, P>) -> bool {
        let rises = self.is_rising(execute, context);
        self.executed = execute;
        rises
    }

    #[inline]
    fn is_rising<P: Planner>(&self, execute: bool, context: &Context<'_, P>) -> bool {
        execute && !self.executed && !self.ignores_edges(context)
    }

    /// The command of the rising edge was refused.
    pub(crate) fn fail(&mut self, error: ErrorId) -> Phase {
        self.phase = Fate::Failed(error).into();
        self.phase
    }

    /// What the block shows in a call, after the command of a rising edge was given.
    #[inline(always)]
    pub(crate) fn status<P: Planner>(&mut self, execute: bool, context: &Context<'_, P>) -> Phase {
        let phase = match self.command {
            Some((axis, id)) => match context.axes.get(axis.index()) {
                Some(axis) => axis.fate(id).into(),
                None => Fate::Failed(ErrorId::AxisUnknown).into(),
            },
            // A result shown in an earlier call disappears when Execute is FALSE (R28, R30).
            None if !execute => Phase::default(),
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
        self.command.filter(|_| !self.is_rising(execute, context))
    }

    /// Whether the command runs on an axis that ignores edges while an instance is Busy. MC_Stop never
    /// ignores an edge: its Execute is a lock.
    #[inline(never)]
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

    /// Gives the command of a rising edge, as [`ExecuteCore::scan`] says.
    // Not inlined: most calls give no command, and would save registers for it.
    #[inline(never)]
    pub(crate) fn start<P: Planner>(
        &mut self,
        axis: AxisId,
        context: &mut Context<'_, P>,
        issue: impl FnOnce(&mut Context<'_, P>, Option<CommandId>) -> Result<CommandId, ErrorId>,
    ) -> Result<(), ErrorId> {
        let Some((before, held)) = self.command.take() else {
            self.command = Some((axis, issue(context, None)?));
            return Ok(());
        };
        // A waiting command gives up its place first, even if the new command is then refused (R97).
        let waited = context
            .axis(before)
            .is_ok_and(|(holder, _)| holder.withdraw(held));
        // Each axis numbers its own commands.
        let issued = issue(context, (axis == before).then_some(held));
        let new = issued.ok().filter(|_| axis == before);
        if let Ok((holder, scope)) = context.axis(before) {
            holder.replaced(held, waited, new, scope);
        }
        self.command = Some((axis, issued?));
        Ok(())
    }
}
