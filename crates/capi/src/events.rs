//! The ring of records in the form of C.

use crate::runtime::NOBODY;
use crate::{NAME, Record, raw};
use core::mem::offset_of;
use standstill_axis as axis;
use standstill_fb::ring::{FIELDS, FlatRecord, NAME_SIZE, RECORD_SIZE};

// Fields follow each other without gaps ([`FIELDS`]), so the offset of the last one proves all others.
const _: () = assert!(size_of::<Record>() == RECORD_SIZE && NAME == NAME_SIZE);
const _: () = assert!(offset_of!(Record, count) == FIELDS[6].3 && offset_of!(Record, name) == FIELDS[10].3);

/// Record `number` of the ring.
pub(crate) fn record(number: u64, from: &axis::Record) -> Record {
    let instance = if from.instance == NOBODY {
        0
    } else {
        from.instance.0.into()
    };
    let flat = FlatRecord::new(number, instance, from);
    Record {
        number,
        scan: flat.scan,
        axis: flat.axis,
        instance: flat.instance,
        event: flat.event,
        error_id: flat.error_id,
        count: flat.count,
        value: flat.value,
        limit: flat.limit,
        third: flat.third,
        name: raw::name(flat.name),
    }
}
