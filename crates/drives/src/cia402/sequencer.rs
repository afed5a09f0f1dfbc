//! The control word that brings a drive to the state that the axis requests.

use super::words::{Command, State, Statusword};
use standstill_axis::DriveRequest;

/// Data the sequencer keeps from one scan to the next.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Memory {
    /// Bit 7 was set in the last word.
    reset: bool,
}

/// Returns the control word for this request and this status, and the data to keep.
///
/// Every step waits for the status and never for time (CI-1). A fault reset is an edge: the bit is set for one scan
/// and cleared in the next, as long as the reset is requested and the fault exists (CI-4). Every status word has an
/// answer. In an unknown state the answer is 0, which disables the voltage. Mode-specific bits stay 0. Pure.
pub fn controlword(request: DriveRequest, status: Statusword, memory: Memory) -> (u16, Memory) {
    let state = status.state();
    if request == DriveRequest::FaultReset && state == State::Fault {
        let reset = !memory.reset;
        let word = if reset { Command::FAULT_RESET } else { 0 };
        return (word, Memory { reset });
    }
    let command = match (request, state) {
        (DriveRequest::Enable, State::SwitchOnDisabled) => Command::Shutdown,
        (DriveRequest::Enable, State::ReadyToSwitchOn) => Command::SwitchOn,
        (DriveRequest::Enable, State::SwitchedOn | State::OperationEnabled | State::QuickStopActive) => {
            Command::EnableOperation
        }
        (DriveRequest::QuickStop, State::OperationEnabled | State::QuickStopActive) => Command::QuickStop,
        (
            DriveRequest::Enable | DriveRequest::Off | DriveRequest::QuickStop | DriveRequest::FaultReset,
            _,
        ) => Command::DisableVoltage,
    };
    (command.bits(), Memory::default())
}

#[cfg(test)]
mod tests {
    use super::*;
    use DriveRequest::{Enable, FaultReset, Off, QuickStop};

    /// Covers: CI-1, CI-2, CI-4
    #[test]
    fn every_status_word_has_the_one_right_answer() {
        for word in 0..=u16::MAX {
            let status = Statusword(word);
            for memory in [Memory { reset: false }, Memory { reset: true }] {
                let answer = |request| controlword(request, status, memory);
                let enable = match status.state() {
                    State::SwitchOnDisabled => 0x6,
                    State::ReadyToSwitchOn => 0x7,
                    State::SwitchedOn | State::OperationEnabled | State::QuickStopActive => 0xf,
                    _ => 0,
                };
                let stop = match status.state() {
                    State::OperationEnabled | State::QuickStopActive => 0x2,
                    _ => 0,
                };
                let raise = status.state() == State::Fault && !memory.reset;
                assert_eq!(answer(Enable), (enable, Memory::default()), "{word:#x}");
                assert_eq!(answer(Off), (0, Memory::default()), "{word:#x}");
                assert_eq!(answer(QuickStop), (stop, Memory::default()), "{word:#x}");
                let reset = (if raise { 0x80 } else { 0 }, Memory { reset: raise });
                assert_eq!(answer(FaultReset), reset, "{word:#x}");
            }
        }
    }
}
