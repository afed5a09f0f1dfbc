//! The context of every call of an axis: the scan, the instance that calls, the ring of records, and memory lent by
//! the host.

use crate::{AxisId, Cams, ErrorId, Event, InstanceId, Log, Record};
use standstill_planner::Setpoint;

/// The scan of a call, the block instance that makes it, the ring for its records, and memory lent by the host.
#[derive(Debug)]
pub struct Scope<'a> {
    /// The scan.
    pub scan: u64,
    /// The block instance.
    pub instance: InstanceId,
    /// The ring of records.
    pub log: &'a mut Log,
    /// The cams; a store without memory (the default) if there are none.
    pub cams: Cams<'a>,
    /// Past set-points of axes with `vibration` ([`Axis::history_needed`](crate::Axis::history_needed)); empty if
    /// there are no such axes.
    pub history: &'a mut [Setpoint],
}

impl<'a> Scope<'a> {
    /// Scan `scan` with its ring, for calls that no instance makes: the instance number is 0 until [`Scope::with`]
    /// sets another.
    pub fn new(scan: u64, log: &'a mut Log) -> Self {
        Self {
            scan,
            instance: InstanceId::default(),
            log,
            cams: Cams::default(),
            history: &mut [],
        }
    }

    /// The same for `instance`.
    #[inline]
    pub fn with(&mut self, instance: InstanceId) -> Scope<'_> {
        Scope {
            scan: self.scan,
            instance,
            log: self.log,
            cams: self.cams.lend(),
            history: self.history,
        }
    }

    /// Records that `axis` at `pin` is not one of the `count` axes. No axis exists that could record it.
    #[cold]
    pub fn refuse_axis(&mut self, pin: &'static str, axis: AxisId, count: usize) -> ErrorId {
        let error = ErrorId::AxisUnknown;
        self.log.push(Record {
            scan: self.scan,
            axis,
            instance: self.instance,
            event: Event::Refused {
                pin,
                value: f64::from(axis.number()),
                limit: count as f64,
                error,
            },
        });
        error
    }
}
