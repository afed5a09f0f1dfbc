//! The arrows of the state machine as data.

use super::words::{Command, State};

/// An arrow that a control word takes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Transition {
    /// Its number in the profile.
    pub number: u8,
    /// From here ..
    pub from: State,
    /// .. to there.
    pub to: State,
    /// The command that takes it; `None` if the drive takes it by itself or on the edge of the fault
    /// reset.
    pub command: Option<Command>,
}

const fn arrow(number: u8, from: State, to: State, command: Option<Command>) -> Transition {
    Transition {
        number,
        from,
        to,
        command,
    }
}

/// Every arrow of the profile. Transition 13 leads from every state except the two of a fault; here it is
/// listed for [`State::OperationEnabled`].
pub const TRANSITIONS: [Transition; 20] = {
    use Command::{DisableVoltage, EnableOperation, QuickStop, Shutdown, SwitchOn};
    use State::{
        Fault, FaultReactionActive, NotReadyToSwitchOn, OperationEnabled, QuickStopActive, ReadyToSwitchOn,
        SwitchOnDisabled, SwitchedOn,
    };
    [
        arrow(1, NotReadyToSwitchOn, SwitchOnDisabled, None),
        arrow(2, SwitchOnDisabled, ReadyToSwitchOn, Some(Shutdown)),
        arrow(3, ReadyToSwitchOn, SwitchedOn, Some(SwitchOn)),
        // With 000Fh a drive continues with transition 4.
        arrow(3, ReadyToSwitchOn, SwitchedOn, Some(EnableOperation)),
        arrow(4, SwitchedOn, OperationEnabled, Some(EnableOperation)),
        arrow(5, OperationEnabled, SwitchedOn, Some(SwitchOn)),
        arrow(6, SwitchedOn, ReadyToSwitchOn, Some(Shutdown)),
        arrow(7, ReadyToSwitchOn, SwitchOnDisabled, Some(DisableVoltage)),
        arrow(7, ReadyToSwitchOn, SwitchOnDisabled, Some(QuickStop)),
        arrow(8, OperationEnabled, ReadyToSwitchOn, Some(Shutdown)),
        arrow(9, OperationEnabled, SwitchOnDisabled, Some(DisableVoltage)),
        arrow(10, SwitchedOn, SwitchOnDisabled, Some(DisableVoltage)),
        arrow(10, SwitchedOn, SwitchOnDisabled, Some(QuickStop)),
        arrow(11, OperationEnabled, QuickStopActive, Some(QuickStop)),
        arrow(12, QuickStopActive, SwitchOnDisabled, Some(DisableVoltage)),
        arrow(12, QuickStopActive, SwitchOnDisabled, None),
        arrow(13, OperationEnabled, FaultReactionActive, None),
        arrow(14, FaultReactionActive, Fault, None),
        arrow(15, Fault, SwitchOnDisabled, None),
        arrow(16, QuickStopActive, OperationEnabled, Some(EnableOperation)),
    ]
};

/// The arrow that `command` takes from `from`, if there is one.
pub fn command_transition(from: State, command: Command) -> Option<Transition> {
    TRANSITIONS
        .into_iter()
        .find(|arrow| arrow.from == from && arrow.command == Some(command))
}
