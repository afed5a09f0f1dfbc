//! Status word 6041h and control word 6040h.

/// State of a power drive system.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum State {
    /// Self-test; no function is available yet.
    #[default]
    NotReadyToSwitchOn,
    /// Waits for a controller.
    SwitchOnDisabled,
    /// May be switched on.
    ReadyToSwitchOn,
    /// The power stage may be on; no torque.
    SwitchedOn,
    /// Torque is on and the command is followed.
    OperationEnabled,
    /// Torque is on; the drive stops by itself.
    QuickStopActive,
    /// A fault was found; the drive stops by itself.
    FaultReactionActive,
    /// No torque until the fault is reset.
    Fault,
    /// A combination of bits that the profile does not have; treated as not enabled (CI-2).
    Unknown,
}

/// Mask, value and state: a word has the state of the first row it matches.
const STATES: [(u16, u16, State); 8] = [
    (0x4f, 0x00, State::NotReadyToSwitchOn),
    (0x4f, 0x40, State::SwitchOnDisabled),
    (0x6f, 0x21, State::ReadyToSwitchOn),
    (0x6f, 0x23, State::SwitchedOn),
    (0x6f, 0x27, State::OperationEnabled),
    (0x6f, 0x07, State::QuickStopActive),
    (0x4f, 0x0f, State::FaultReactionActive),
    (0x4f, 0x08, State::Fault),
];

impl State {
    /// All states of the profile.
    pub const ALL: [Self; 8] = [
        Self::NotReadyToSwitchOn,
        Self::SwitchOnDisabled,
        Self::ReadyToSwitchOn,
        Self::SwitchedOn,
        Self::OperationEnabled,
        Self::QuickStopActive,
        Self::FaultReactionActive,
        Self::Fault,
    ];

    /// The state's bits in a status word; 0 for [`State::Unknown`].
    pub fn bits(self) -> u16 {
        STATES
            .iter()
            .find(|(.., state)| *state == self)
            .map_or(0, |(_, value, _)| *value)
    }

    /// Whether the motor has torque.
    pub fn has_torque(self) -> bool {
        matches!(
            self,
            Self::OperationEnabled | Self::QuickStopActive | Self::FaultReactionActive
        )
    }
}

/// The meaning of bits 13, 12 and 10 in homing mode.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub enum HomingStatus {
    /// 0 0 0: it moves.
    InProgress,
    /// 0 0 1: interrupted or not started.
    Stopped,
    /// 0 1 0: the reference is known, the drive still moves.
    Attained,
    /// 0 1 1: done.
    Done,
    /// 1 0 0: an error, and the drive still moves. Also 1 1 0, which the profile does not have.
    ErrorMoving,
    /// 1 0 1: an error, and the drive is at rest. Also 1 1 1.
    ErrorStopped,
}

impl HomingStatus {
    /// Whether the drive is at rest.
    pub const fn is_at_rest(self) -> bool {
        matches!(self, Self::Stopped | Self::Done | Self::ErrorStopped)
    }

    /// Its bits in a status word.
    pub const fn bits(self) -> u16 {
        let (error, attained, reached) = match self {
            Self::InProgress => (0, 0, 0),
            Self::Stopped => (0, 0, 1),
            Self::Attained => (0, 1, 0),
            Self::Done => (0, 1, 1),
            Self::ErrorMoving => (1, 0, 0),
            Self::ErrorStopped => (1, 0, 1),
        };
        error << 13 | attained << 12 | reached << 10
    }
}

/// A status word.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Statusword(pub u16);

impl Statusword {
    /// The state in its bits 0 to 3, 5 and 6.
    pub fn state(self) -> State {
        STATES
            .iter()
            .find(|(mask, value, _)| self.0 & mask == *value)
            .map_or(State::Unknown, |(.., state)| *state)
    }

    /// Bit 4: power for the stage is there.
    pub const fn voltage(self) -> bool {
        self.0 & (1 << 4) != 0
    }

    /// Bit 7: a warning is present.
    pub const fn warning(self) -> bool {
        self.0 & (1 << 7) != 0
    }

    /// Bit 9: the drive obeys the control word.
    pub const fn remote(self) -> bool {
        self.0 & (1 << 9) != 0
    }

    /// Bit 11: an internal limit is active.
    pub const fn internal_limit(self) -> bool {
        self.0 & (1 << 11) != 0
    }

    /// Bits 13, 12 and 10 in homing mode.
    pub const fn homing(self) -> HomingStatus {
        let (error, attained, reached) = (self.0 >> 13 & 1, self.0 >> 12 & 1, self.0 >> 10 & 1);
        match (error, attained, reached) {
            (0, 0, 0) => HomingStatus::InProgress,
            (0, 0, _) => HomingStatus::Stopped,
            (0, _, 0) => HomingStatus::Attained,
            (0, _, _) => HomingStatus::Done,
            (_, _, 0) => HomingStatus::ErrorMoving,
            (_, _, _) => HomingStatus::ErrorStopped,
        }
    }

    /// Bit 12 in the cyclic modes: the drive follows the command.
    pub const fn follows_command(self) -> bool {
        self.0 & (1 << 12) != 0
    }
}

/// The command of a control word, without the edge of its bit 7.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Command {
    /// 0006h
    Shutdown,
    /// 0007h; from Operation enabled it disables operation.
    SwitchOn,
    /// 000Fh
    EnableOperation,
    /// 0002h
    QuickStop,
    /// 0000h
    DisableVoltage,
    /// A combination without a meaning, or the fault reset.
    None,
}

/// Mask, value and command.
const COMMANDS: [(u16, u16, Command); 5] = [
    (0x82, 0x00, Command::DisableVoltage),
    (0x86, 0x02, Command::QuickStop),
    (0x87, 0x06, Command::Shutdown),
    (0x8f, 0x07, Command::SwitchOn),
    (0x8f, 0x0f, Command::EnableOperation),
];

impl Command {
    /// Bit 4 of a control word in homing mode: home while it is set.
    pub const HOMING: u16 = 1 << 4;

    /// Bit 8 of a control word: come to rest.
    pub const HALT: u16 = 1 << 8;

    /// Bit 7 of a control word: fault reset, at its rising edge.
    pub const FAULT_RESET: u16 = 1 << 7;

    /// The command of a control word.
    pub fn of(controlword: u16) -> Self {
        COMMANDS
            .iter()
            .find(|(mask, value, _)| controlword & mask == *value)
            .map_or(Self::None, |(.., command)| *command)
    }

    /// Its control word; 0 for none, which disables the voltage.
    pub fn bits(self) -> u16 {
        COMMANDS
            .iter()
            .find(|(.., command)| *command == self)
            .map_or(0, |(_, value, _)| *value)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::BTreeMap;
    use std::vec::Vec;

    /// Covers: CI-2, CI-9
    #[test]
    fn all_patterns_of_bits_0_to_3_with_5_and_6_are_decoded() {
        let mut counts = BTreeMap::new();
        for pattern in 0..64_u16 {
            let word = (pattern & 0xf) | (pattern & 0x30) << 1;
            let state = Statusword(word).state();
            *counts.entry(state).or_insert(0) += 1;
            // Bits that a state does not use change nothing.
            for other in [0x10, 0x80, 0xff00, 0xff90] {
                assert_eq!(Statusword(word | other).state(), state, "{word:#x}");
            }
        }
        use State::*;
        let expected = [
            (NotReadyToSwitchOn, 2),
            (SwitchOnDisabled, 2),
            (ReadyToSwitchOn, 1),
            (SwitchedOn, 1),
            (OperationEnabled, 1),
            (QuickStopActive, 1),
            (FaultReactionActive, 2),
            (Fault, 2),
            (Unknown, 52),
        ];
        assert_eq!(counts.into_iter().collect::<Vec<_>>(), expected);
    }

    #[test]
    fn all_patterns_of_bits_13_12_and_10_are_decoded() {
        use HomingStatus::*;
        let rows = [
            InProgress,
            Stopped,
            Attained,
            Done,
            ErrorMoving,
            ErrorStopped,
            ErrorMoving,
            ErrorStopped,
        ];
        for (pattern, expected) in (0_u16..).zip(rows) {
            let word = (pattern & 4) << 11 | (pattern & 2) << 11 | (pattern & 1) << 10;
            for other in [0, 0x0237, 0xcbff] {
                assert_eq!(Statusword(word | other).homing(), expected, "{pattern:03b}");
            }
            if pattern < 6 {
                assert_eq!(expected.bits(), word);
            }
        }
    }

    #[test]
    fn states_and_commands_survive_their_bits() {
        for state in State::ALL {
            assert_eq!(Statusword(state.bits()).state(), state);
        }
        for (_, value, command) in COMMANDS {
            assert_eq!(Command::of(value), command);
            assert_eq!(command.bits(), value);
            assert_eq!(Command::of(value | Command::FAULT_RESET), Command::None);
        }
    }
}
