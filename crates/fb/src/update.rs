//! The core of moves that take new values while they run: an Execute core with ContinuousUpdate.
//!
//! Source: PLCopen Motion Control Part 1, sections on Execute/Done and ContinuousUpdate; R8 to R14.

use crate::{Context, ExecuteCore, Phase};
use standstill_axis::{
    Axis, AxisId, BufferMode, Command, CommandId, ErrorId, Planner, Raw, Request, Scope, Superimpose,
    update_coupled,
};

/// The values of a command, from the pins of its block.
pub trait Values: Copy {
    /// Whether `other` has the same values, bit for bit.
    fn is_same(&self, other: &Self) -> bool;

    /// Gives the running command `id` these values. Invalid values change nothing; the axis records them.
    fn apply<P: Planner>(&self, axis: AxisId, id: CommandId, context: &mut Context<'_, P>);
}

impl Values for Command {
    fn is_same(&self, other: &Self) -> bool {
        self.is_same(other)
    }

    fn apply<P: Planner>(&self, axis: AxisId, id: CommandId, context: &mut Context<'_, P>) {
        // The block shows no Error: its command continues unchanged (R21).
        let _recorded = update_coupled(context.axes, axis, id, self, &mut context.scope);
    }
}

impl Values for Superimpose {
    fn is_same(&self, other: &Self) -> bool {
        self.is_same(other)
    }

    fn apply<P: Planner>(&self, axis: AxisId, id: CommandId, context: &mut Context<'_, P>) {
        if let Ok((axis, scope)) = context.axis(axis) {
            let _recorded = axis.update_superimposed(id, self, scope);
        }
    }
}

/// The pins every such block has.
#[derive(Clone, Copy, Debug)]
pub struct Move {
    /// Axis.
    pub axis: AxisId,
    /// Execute.
    pub execute: bool,
    /// ContinuousUpdate.
    pub continuous_update: bool,
}

/// State kept between calls.
#[derive(Clone, Copy, Debug)]
pub struct UpdateCore<V> {
    execute: ExecuteCore,
    /// The values last seen. They exist while changes count: from a rising edge with ContinuousUpdate
    /// TRUE until it is FALSE or the command has ended (R10, R11).
    seen: Option<V>,
}

impl<V> Default for UpdateCore<V> {
    fn default() -> Self {
        Self {
            execute: ExecuteCore::default(),
            seen: None,
        }
    }
}

impl UpdateCore<Command> {
    /// The same as [`UpdateCore::scan`], for a command that the axis takes with this buffer mode.
    #[inline]
    pub fn command<P: Planner>(
        &mut self,
        pins: Move,
        buffer_mode: Raw<BufferMode>,
        context: &mut Context<'_, P>,
        values: impl Fn() -> Command,
    ) -> Phase {
        self.scan(pins, context, values, move |axis, command, replaces, scope| {
            let request = Request {
                command,
                buffer_mode,
                replaces,
            };
            axis.command(&request, scope)
        })
    }
}

impl<V: Values> UpdateCore<V> {
    /// The phase shown in the last call.
    pub fn phase(&self) -> Phase {
        self.execute.phase()
    }

    /// One call. `values` reads the pins; `issue` gives the command at a rising edge, as for [`ExecuteCore::scan`].
    #[inline]
    pub fn scan<P: Planner>(
        &mut self,
        pins: Move,
        context: &mut Context<'_, P>,
        values: impl Fn() -> V,
        issue: impl FnOnce(&mut Axis<P>, V, Option<CommandId>, &mut Scope<'_>) -> Result<CommandId, ErrorId>,
    ) -> Phase {
        self.scan_among(
            pins,
            context,
            move |_| values(),
            move |context, given, replaces| {
                let (axis, scope) = context.axis(pins.axis)?;
                issue(axis, given, replaces, scope)
            },
        )
    }

    /// The same for a command that also reads other axes.
    // Every block has its own copy, so it is inlined there.
    #[inline(always)]
    pub fn scan_among<P: Planner>(
        &mut self,
        pins: Move,
        context: &mut Context<'_, P>,
        values: impl Fn(&Context<'_, P>) -> V,
        issue: impl FnOnce(&mut Context<'_, P>, V, Option<CommandId>) -> Result<CommandId, ErrorId>,
    ) -> Phase {
        if (self.execute.is_edge(pins.execute) || self.seen.is_some())
            && let Err(error) = self.give(pins, context, values, issue)
        {
            return self.execute.fail(error);
        }
        // After that, so that its effect shows in the same call.
        self.execute.status(pins.execute, context)
    }

    /// Gives the command of a rising edge, or changed values to the command that runs.
    // Not inlined: in most calls there is nothing to give.
    #[inline(never)]
    fn give<P: Planner>(
        &mut self,
        pins: Move,
        context: &mut Context<'_, P>,
        values: impl Fn(&Context<'_, P>) -> V,
        issue: impl FnOnce(&mut Context<'_, P>, V, Option<CommandId>) -> Result<CommandId, ErrorId>,
    ) -> Result<(), ErrorId> {
        if self.execute.rises(pins.execute, context) {
            self.seen = None;
            let seen = &mut self.seen;
            return self.execute.start(pins.axis, context, |context, replaces| {
                let given = values(context);
                let id = issue(context, given, replaces)?;
                *seen = pins.continuous_update.then_some(given);
                Ok(id)
            });
        }
        let running = self.execute.running(pins.execute, context);
        let (Some((axis, id)), Some(seen), true) = (running, &mut self.seen, pins.continuous_update) else {
            self.seen = None;
            return Ok(());
        };
        let given = values(context);
        if !seen.is_same(&given) {
            *seen = given;
            given.apply(axis, id, context);
        }
        Ok(())
    }
}
