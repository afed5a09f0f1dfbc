//! The limits of a guest, and its messages.

use crate::MODULE;
use standstill_axis::InstanceId;

/// Largest number of block instances of a guest.
pub const INSTANCES_MOST: usize = 1024;

/// The limits of a guest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Settings {
    /// Instructions of one call, counted by the interpreter; a call that needs more is a fault.
    pub fuel: u64,
    /// Largest number of bytes of memory.
    pub memory: u64,
    /// Name of the module that its imports come from.
    pub module: String,
    /// The number in records of its first block instance; the others follow. 1 or more.
    pub first_instance: u16,
}

impl Default for Settings {
    fn default() -> Self {
        Self {
            fuel: 1_000_000,
            memory: 16 << 20,
            module: MODULE.to_owned(),
            first_instance: 1,
        }
    }
}

/// A message of a guest.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Told {
    /// A line of `log`.
    Line(String),
    /// The number of lines beyond the limit of a scan.
    LinesLost(u64),
    /// It has a new instance.
    Made {
        /// Its number in records.
        id: InstanceId,
        /// Its index among the guest's instances, from 1.
        number: usize,
        /// Its block.
        block: &'static str,
        /// The address of its key.
        key: u32,
    },
}
