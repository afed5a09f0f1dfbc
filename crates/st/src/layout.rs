//! The layout of a module's memory.
//!
//! | address | |
//! | ---: | --- |
//! | 8 | the number of the place of the last fault, 0 if there is none (u32) |
//! | 12 | the number of the place of the running or last loop (u32) |
//! | 16 | the value that caused the fault (i64) |
//! | 24 | the instant of this scan (i64, ns) |
//! | 32 | when each task is due next (i64, ns), then globals, frames of functions, and the programs |

/// The number of the place of a fault.
pub const FAULT_SITE: u32 = 8;

/// The number of the place of the running loop.
pub const LOOP_SITE: u32 = 12;

/// The value that led to a fault.
pub const FAULT_VALUE: u32 = 16;

/// The instant of a scan.
pub(crate) const NOW: u32 = 24;

const FIRST: u32 = 32;

/// The used part of the memory.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Layout {
    pub end: u32,
}

impl Default for Layout {
    fn default() -> Self {
        Self { end: FIRST }
    }
}

impl Layout {
    /// Reserves bytes at a multiple of 8; `u32::MAX` when there are no more addresses.
    pub(crate) fn take(&mut self, bytes: u32) -> u32 {
        let Some(place) = self.end.checked_next_multiple_of(8) else {
            return u32::MAX;
        };
        match place.checked_add(bytes) {
            Some(end) => self.end = end,
            None => {
                self.end = u32::MAX;
                return u32::MAX;
            }
        }
        place
    }
}
