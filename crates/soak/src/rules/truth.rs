//! Rules on the state after the motion step, for any order of calls (R69).

use super::{Broken, rule};
use standstill_axis::AxisState;

/// A command that an instance holds, with the outputs that its next call would show.
#[derive(Clone, Copy, Debug)]
pub struct Held {
    /// It runs in addition to the owner.
    pub superimposed: bool,
    /// Not ended.
    pub busy: bool,
    /// It owns the axis, or is being superimposed.
    pub active: bool,
}

/// The known state of an axis.
#[derive(Clone, Copy, Debug)]
pub struct Truth {
    /// Its state.
    pub state: AxisState,
    /// A command owns it.
    pub owned: bool,
    /// The owner is MC_Stop, which has no Active.
    pub stopping: bool,
    /// Commands in the buffer.
    pub waiting: usize,
    /// A command that waits for a position of its master, in addition to the owner.
    pub awaited: bool,
    /// The first of them moves the coordinates: it waits for the next latch in every state.
    pub shift_due: bool,
    /// A superimposed command, and whether the added motion is its own.
    pub added: Option<bool>,
    /// No instance holds the superimposed command: its own was triggered anew and refused.
    pub orphaned: bool,
}

/// Rules on an axis and the commands held for it.
///
/// # Errors
/// The rule that does not hold.
pub fn check_truth(axis: &Truth, held: impl Iterator<Item = Held>) -> Result<(), Broken> {
    let (mut owners, mut beside, mut inactive) = (0_usize, 0_usize, 0_usize);
    for command in held {
        owners += usize::from(command.active && !command.superimposed);
        beside += usize::from(command.active && command.superimposed);
        inactive += usize::from(command.busy && !command.active);
    }
    let &Truth {
        state,
        owned,
        stopping,
        waiting,
        awaited,
        shift_due,
        added,
        orphaned,
    } = axis;
    rule(owners <= 1, "R48", "two commands are Active")?;
    rule(beside <= 1, "R48", "two superimposed commands are Active")?;
    rule(
        beside == usize::from(added == Some(true) && !orphaned),
        "R51",
        "Active is not whether the added motion is the block's",
    )?;
    let idle = matches!(
        state,
        AxisState::Disabled | AxisState::Standstill | AxisState::ErrorStop
    );
    rule(!(idle && owned), "S1", "an idle state with an owner")?;
    rule(
        !idle || owners + beside == 0,
        "R47",
        "an idle state with an Active block",
    )?;
    let moving = matches!(
        state,
        AxisState::Homing | AxisState::DiscreteMotion | AxisState::ContinuousMotion
    );
    rule(
        !moving || owned || (state == AxisState::DiscreteMotion && added.is_some()),
        "R25",
        "a motion state without an owner",
    )?;
    rule(
        !idle || waiting == 0 || (shift_due && state == AxisState::Standstill),
        "R77",
        "an idle state with a waiting command",
    )?;
    let beside_waits = usize::from(awaited) + usize::from(added == Some(false) && !orphaned);
    rule(
        inactive <= waiting + usize::from(stopping) + beside_waits,
        "R50",
        "an instance is Busy with a command that neither owns the axis nor waits",
    )
}
