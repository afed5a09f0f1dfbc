//! The error of an axis in ErrorStop, and the MC_Reset that waits to end it.

use crate::{CommandId, ErrorId};

/// Scans a drive may take to answer a fault reset before MC_Reset fails.
const RESET_PATIENCE: u32 = 1000;

/// The error of an axis; it starts without one.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Failure {
    error: ErrorId,
    code: u16,
    /// The cause of a fault of the axis itself persists.
    has_cause: bool,
    reset: Option<Reset>,
}

/// A reset under way.
#[derive(Clone, Copy, Debug)]
struct Reset {
    id: CommandId,
    /// Scans so far in ErrorStop.
    waited: u32,
}

impl Failure {
    pub fn error(&self) -> ErrorId {
        self.error
    }

    /// The code of the error from the drive or from its other source; 0 without one.
    pub fn code(&self) -> u16 {
        self.code
    }

    pub fn show(&mut self, error: ErrorId, code: u16) {
        (self.error, self.code) = (error, code);
    }

    pub fn has_cause(&self) -> bool {
        self.has_cause
    }

    pub fn set_cause(&mut self, has_cause: bool) {
        self.has_cause = has_cause;
    }

    /// The command of the reset in progress.
    pub fn reset(&self) -> Option<CommandId> {
        self.reset.map(|reset| reset.id)
    }

    pub fn begin_reset(&mut self, id: CommandId) {
        self.reset = Some(Reset { id, waited: 0 });
    }

    pub fn end_reset(&mut self) {
        self.reset = None;
    }

    /// Counts a scan of the reset in progress. Returns TRUE if the time for an answer of the drive is over.
    pub fn waits_too_long(&mut self) -> bool {
        self.reset.as_mut().is_some_and(|reset| {
            reset.waited = reset.waited.saturating_add(1);
            reset.waited > RESET_PATIENCE
        })
    }
}
