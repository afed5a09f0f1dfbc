//! The ring of records as C reads it.

use crate::runtime::NOBODY;
use crate::{Record, raw};
use standstill_axis::{self as axis, Event, Goal};
use standstill_fb::axis_number;

/// Record `number` of the ring.
pub(crate) fn record(number: u64, from: &axis::Record) -> Record {
    let mut record = Record {
        number,
        scan: from.scan,
        axis: axis_number(from.axis),
        instance: if from.instance == NOBODY {
            0
        } else {
            from.instance.0.into()
        },
        event: 0,
        error_id: 0,
        count: 0,
        value: 0.0,
        limit: 0.0,
        third: 0.0,
        name: [0; crate::NAME],
    };
    match from.event {
        Event::Refused {
            pin,
            value,
            limit,
            error,
        } => {
            record.event = 1;
            record.error_id = error.number().into();
            (record.value, record.limit) = (value, limit);
            record.name = raw::name(pin);
        }
        Event::PointRefused {
            point,
            what,
            value,
            limit,
            error,
        } => {
            record.event = 2;
            record.error_id = error.number().into();
            record.count = point.into();
            (record.value, record.limit) = (value, limit);
            record.name = raw::name(what);
        }
        Event::Clamped { pin, value, limit } => {
            record.event = 3;
            (record.value, record.limit) = (value, limit);
            record.name = raw::name(pin);
        }
        Event::Raised { pin, value, limit } => {
            record.event = 4;
            (record.value, record.limit) = (value, limit);
            record.name = raw::name(pin);
        }
        Event::Unavoidable(excess) => {
            record.event = 5;
            record.value = excess.velocity;
            record.limit = excess.acceleration;
            record.third = excess.jerk;
        }
        Event::Shifted { by } => {
            record.event = 6;
            record.value = by;
        }
        Event::Planned { goal, scans } => {
            record.count = scans.into();
            match goal {
                Goal::Position(position) => (record.event, record.value) = (7, position),
                Goal::Velocity(velocity) => (record.event, record.value) = (8, velocity),
                Goal::Passing { position, velocity } => {
                    (record.event, record.value, record.limit) = (9, position, velocity);
                }
            }
        }
        Event::Superimposed { distance, scans } => {
            record.event = 10;
            record.count = scans.into();
            record.value = distance.unwrap_or_default();
        }
        Event::RoomAwaited => record.event = 11,
        Event::Paused { error } => {
            record.event = 12;
            record.error_id = error.number().into();
        }
        Event::Fault { error, code } => {
            record.event = 13;
            record.error_id = error.number().into();
            record.count = code.into();
        }
    }
    record
}
