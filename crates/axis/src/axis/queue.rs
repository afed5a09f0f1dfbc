//! Commands that wait.

use super::commands::Entry;
use crate::{CommandId, QUEUE_MAX};

/// First in, first out; at most [`QUEUE_MAX`] entries, without gaps.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Queue {
    entries: [Option<Entry>; QUEUE_MAX],
    len: usize,
}

impl Queue {
    pub fn len(&self) -> usize {
        self.len
    }

    pub fn is_empty(&self) -> bool {
        self.len == 0
    }

    /// Appends; the caller has checked the configured capacity.
    pub fn push(&mut self, entry: Entry) {
        if let Some(slot) = self.entries.get_mut(self.len) {
            *slot = Some(entry);
            self.len += 1;
        }
    }

    pub fn pop(&mut self) -> Option<Entry> {
        let first = self.entries.first_mut()?.take()?;
        self.entries.rotate_left(1);
        self.len -= 1;
        Some(first)
    }

    /// Removes command `id` from any position; `false` if it is not there.
    pub fn remove(&mut self, id: CommandId) -> bool {
        let Some(place) = self.iter().position(|entry| entry.id == id) else {
            return false;
        };
        if let Some(behind) = self.entries.get_mut(place..) {
            behind.rotate_left(1);
        }
        if let Some(last) = self.entries.last_mut() {
            *last = None;
        }
        self.len -= 1;
        true
    }

    pub fn first(&self) -> Option<&Entry> {
        self.entries.first()?.as_ref()
    }

    /// The last waiting command that moves the axis.
    pub fn last_motion(&self) -> Option<&Entry> {
        self.iter().filter(|entry| entry.work.manner().moves).last()
    }

    pub fn iter(&self) -> impl Iterator<Item = &Entry> {
        self.entries.iter().map_while(Option::as_ref)
    }

    pub fn iter_mut(&mut self) -> impl Iterator<Item = &mut Entry> {
        self.entries.iter_mut().map_while(Option::as_mut)
    }

    pub fn contains(&self, id: CommandId) -> bool {
        self.iter().any(|entry| entry.id == id)
    }
}
