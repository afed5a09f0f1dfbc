//! What every call of an axis is made in: the scan, who speaks, and the ring that records go to.

use crate::{InstanceId, Log};

/// The scan a call belongs to, the block instance that makes it, and the ring its records go to.
#[derive(Debug)]
pub struct Scope<'a> {
    /// The scan.
    pub scan: u64,
    /// The block instance.
    pub instance: InstanceId,
    /// The ring of records.
    pub log: &'a mut Log,
}

impl<'a> Scope<'a> {
    /// Scan `scan` with its ring, for calls that no instance makes: its number is 0 until [`Scope::with`] gives another.
    pub fn new(scan: u64, log: &'a mut Log) -> Self {
        Self {
            scan,
            instance: InstanceId::default(),
            log,
        }
    }

    /// The same for `instance`.
    #[inline]
    pub fn with(&mut self, instance: InstanceId) -> Scope<'_> {
        Scope {
            scan: self.scan,
            instance,
            log: self.log,
        }
    }
}
