//! The results of commands (R94, R95), kept long enough for their instances to ask.

use crate::{CommandId, ErrorId};

/// Number of ended commands an axis remembers. An instance that is not called while this many later
/// commands end loses its result and reports [`ErrorId::FateLost`].
pub const FATES_KEPT: usize = 64;

/// The state or result of a command.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fate {
    /// In the buffer; for a superimposed command: waits until the limits leave room.
    Waiting,
    /// Owns the axis, or is being superimposed. `reached` is TRUE once an endless motion runs at its
    /// goal, or a held stop is at rest.
    Active {
        /// The goal is reached.
        reached: bool,
    },
    /// Completed.
    Done,
    /// Interrupted or removed from the buffer by another command or by switching power off.
    Aborted,
    /// Ended by an error.
    Failed(ErrorId),
}

/// The numbers of commands, and the last [`FATES_KEPT`] that ended.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Fates {
    ended: [Option<(CommandId, Fate)>; FATES_KEPT],
    next: usize,
    newest: CommandId,
    /// The last superimposed command that ended, and the distance it added (u).
    covered: Option<(CommandId, f64)>,
}

impl Default for Fates {
    fn default() -> Self {
        Self {
            ended: [None; FATES_KEPT],
            next: 0,
            newest: CommandId(0),
            covered: None,
        }
    }
}

impl Fates {
    /// The number of the next command.
    pub(crate) fn new_id(&mut self) -> CommandId {
        self.newest = CommandId(self.newest.0.wrapping_add(1));
        self.newest
    }

    /// The number given last.
    pub(crate) fn newest(&self) -> CommandId {
        self.newest
    }

    /// Command `id` has ended with `fate`.
    pub(crate) fn record(&mut self, id: CommandId, fate: Fate) {
        if let Some(slot) = self.ended.get_mut(self.next) {
            *slot = Some((id, fate));
        }
        self.next = (self.next + 1) % FATES_KEPT;
    }

    /// Superimposed command `id` ends; it has added this distance (u).
    pub(crate) fn cover(&mut self, id: CommandId, distance: f64) {
        self.covered = Some((id, distance));
    }

    /// The distance (u) that superimposed command `id` added, if it is the last one that ended.
    pub(crate) fn covered(&self, id: CommandId) -> Option<f64> {
        self.covered
            .filter(|(ended, _)| *ended == id)
            .map(|(_, distance)| distance)
    }

    /// Finds an ended command; bounded by [`FATES_KEPT`] comparisons.
    pub(crate) fn find(&self, id: CommandId) -> Option<Fate> {
        self.ended
            .iter()
            .flatten()
            .find(|(ended, _)| *ended == id)
            .map(|(_, fate)| *fate)
    }
}
