//! Records of the diagnostic ring as numbers and bytes: the one form in which hosts in other languages
//! read them. The C library and WebAssembly guests use it.

use crate::axis_number;
use crate::flat::Flat;
use standstill_axis::{Event, Goal, Record};

/// Bytes of a record.
pub const RECORD_SIZE: usize = 96;

/// Bytes of the name in a record, including the 0 at its end.
pub const NAME_SIZE: usize = 32;

/// The fields of a record: name, type, meaning and offset.
pub const FIELDS: [(&str, &str, &str, usize); 11] = [
    ("number", "u64", "Its number, from 0 since the start.", 0),
    ("scan", "u64", "The scan it happened in, from 0.", 8),
    ("axis", "i32", "The axis.", 16),
    (
        "instance",
        "u32",
        "The key of the block instance whose command it was; 0: none of the reader's.",
        20,
    ),
    (
        "event",
        "i32",
        "1 refused, 2 point refused, 3 clamped, 4 raised, 5 unavoidable, 6 shifted, 7 planned to a position, 8 planned \
         to a velocity, 9 planned past a position, 10 superimposed, 11 room awaited, 12 paused, 13 fault, 14 orphaned, 15 coupled, 16 approaching \
         the law of a gear, 17 in gear, 18 no longer in gear, 19 in sync late, 20 phase shift planned, 21 lowered to what a slave can follow, 22 cam \
         selected, 23 onto a cam, 24 plan onto a cam, 25 in sync, 26 no longer in sync, 27 more than one end of a cam passed in a scan, 28 a \
         master leads out of a software limit, 29 the slave of a cam rests at a row.",
        24,
    ),
    ("error_id", "u32", "ErrorID, 0 without one.", 28),
    (
        "count",
        "u64",
        "Scans of a plan, number of a point, of a row or of a master, ends of a cam, or code of a drive.",
        32,
    ),
    (
        "value",
        "f64",
        "What was asked for; the excess of velocity; where to; the velocity; the numerator of a ratio; the number of a cam; the jump.",
        40,
    ),
    (
        "limit",
        "f64",
        "What was used instead, or the limit; the excess of acceleration; the velocity when passing; the denominator.",
        48,
    ),
    ("third", "f64", "The excess of jerk.", 56),
    (
        "name",
        "char[32]",
        "Name of the pin, field, quantity or way, ending in 0; empty: the axis state decided.",
        64,
    ),
];

/// A record as the numbers of its fields; [`FIELDS`] says what they mean.
#[allow(missing_docs)]
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct FlatRecord {
    pub number: u64,
    pub scan: u64,
    pub axis: i32,
    pub instance: u32,
    pub event: i32,
    pub error_id: u32,
    pub count: u64,
    pub value: f64,
    pub limit: f64,
    pub third: f64,
    pub name: &'static str,
}

impl FlatRecord {
    /// Record `number` of the ring, with the name that the reader gives its instance.
    pub fn new(number: u64, instance: u32, from: &Record) -> Self {
        let mut record = Self {
            number,
            scan: from.scan,
            axis: axis_number(from.axis),
            instance,
            ..Self::default()
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
                record.name = pin;
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
                record.name = what;
            }
            Event::Clamped { pin, value, limit } => {
                record.event = 3;
                (record.value, record.limit) = (value, limit);
                record.name = pin;
            }
            Event::Raised { pin, value, limit } => {
                record.event = 4;
                (record.value, record.limit) = (value, limit);
                record.name = pin;
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
            Event::Orphaned => record.event = 14,
            Event::Coupled {
                master,
                numerator,
                denominator,
            } => {
                record.event = 15;
                record.count = master.number().into();
                (record.value, record.limit) = (numerator.into(), denominator.into());
            }
            Event::Approaching { way, velocity, scans } => {
                record.event = 16;
                record.count = scans.into();
                record.value = velocity;
                record.name = way.name();
            }
            Event::InGear => record.event = 17,
            Event::GearLost { what, value, limit } => {
                record.event = 18;
                (record.value, record.limit) = (value, limit);
                record.name = what;
            }
            Event::Phasing { to, scans } => {
                record.event = 20;
                record.count = scans.into();
                record.value = to;
            }
            Event::Slowed { pin, value, limit } => {
                record.event = 21;
                (record.value, record.limit) = (value, limit);
                record.name = pin;
            }
            Event::CamSelected { velocity, limit } => {
                record.event = 22;
                (record.value, record.limit) = (velocity, limit);
            }
            Event::CamStops { row, what, jump } => {
                record.event = 29;
                record.count = row.into();
                record.value = jump;
                record.name = what;
            }
            Event::OnCam { master, cam } => {
                record.event = 23;
                record.count = master.number().into();
                record.value = cam.number().into();
            }
            Event::OntoCam { way, value, scans } => {
                record.event = 24;
                record.count = scans.into();
                record.value = value;
                record.name = way.name();
            }
            Event::InSync => record.event = 25,
            Event::SyncLost { what, value, limit } => {
                record.event = 26;
                (record.value, record.limit) = (value, limit);
                record.name = what;
            }
            Event::CamPassed { periods } => {
                record.event = 27;
                record.count = periods.into();
            }
            Event::LeadsOutside { position, limit } => {
                record.event = 28;
                (record.value, record.limit) = (position, limit);
            }
            Event::SyncLate { by } => {
                record.event = 19;
                record.value = by;
            }
        }
        record
    }

    /// Writes the record to [`RECORD_SIZE`] bytes. If `bytes` is shorter, the rest is left out.
    pub fn put_flat(&self, flat: &mut [u8]) {
        self.number.write(flat, 0);
        self.scan.write(flat, 8);
        self.axis.write(flat, 16);
        self.instance.write(flat, 20);
        self.event.write(flat, 24);
        self.error_id.write(flat, 28);
        self.count.write(flat, 32);
        self.value.write(flat, 40);
        self.limit.write(flat, 48);
        self.third.write(flat, 56);
        let name = flat.get_mut(64..).unwrap_or_default();
        name.iter_mut().take(NAME_SIZE).for_each(|byte| *byte = 0);
        for (to, from) in name.iter_mut().zip(self.name.bytes().take(NAME_SIZE - 1)) {
            *to = from;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use standstill_axis::{AxisId, ErrorId, Excess, InstanceId};

    #[test]
    fn a_record_stands_where_its_fields_say() {
        let from = Record {
            scan: 7,
            axis: AxisId::new(1),
            instance: InstanceId(40),
            event: Event::PointRefused {
                point: 3,
                what: "Velocity",
                value: 80.0,
                limit: 50.0,
                error: ErrorId::AxisUnknown,
            },
        };
        let mut flat = [0xA5; RECORD_SIZE + 1];
        FlatRecord::new(9, 5, &from).put_flat(&mut flat);
        let at = |name| {
            FIELDS
                .iter()
                .find(|field| field.0 == name)
                .map_or(0, |field| field.3)
        };
        assert_eq!(u64::read(&flat, at("number")), 9);
        assert_eq!(u64::read(&flat, at("scan")), 7);
        assert_eq!(i32::read(&flat, at("axis")), 2);
        assert_eq!(u32::read(&flat, at("instance")), 5);
        assert_eq!(i32::read(&flat, at("event")), 2);
        assert_eq!(
            u32::read(&flat, at("error_id")),
            u32::from(ErrorId::AxisUnknown.number())
        );
        assert_eq!(u64::read(&flat, at("count")), 3);
        assert_eq!(f64::read(&flat, at("value")), 80.0);
        assert_eq!(f64::read(&flat, at("limit")), 50.0);
        assert_eq!(f64::read(&flat, at("third")), 0.0);
        assert_eq!(flat[at("name")..][..9], *b"Velocity\0");
        assert_eq!(flat[RECORD_SIZE - 1..], [0, 0xA5]);
    }

    #[test]
    fn fields_follow_each_other_to_the_end() {
        let mut end = 0;
        for (name, ty, _, offset) in FIELDS {
            assert_eq!(offset, end, "{name}");
            end += match ty {
                "u64" | "f64" => 8,
                "i32" | "u32" => 4,
                _ => NAME_SIZE,
            };
        }
        assert_eq!(end, RECORD_SIZE);
        FlatRecord::default().put_flat(&mut [0; 3]);
    }

    /// The number of each event is documented in [`FIELDS`] and in the C header.
    #[test]
    fn every_event_has_its_number_and_its_values() {
        use standstill_axis::{Approach, CamId, Event as E};
        let error = ErrorId::AxisUnknown;
        let error_id = error.number().into();
        let (pin, value, limit) = ("Velocity", 80.0, 50.0);
        let (position, velocity) = (12.5, -3.5);
        let planned = |goal| E::Planned { goal, scans: 70 };
        let none = FlatRecord::default();
        #[rustfmt::skip]
        let events = [
            (E::Refused { pin, value, limit, error }, FlatRecord { event: 1, error_id, value, limit, name: pin, ..none }),
            (
                E::PointRefused { point: 3, what: pin, value, limit, error },
                FlatRecord { event: 2, error_id, count: 3, value, limit, name: pin, ..none },
            ),
            (E::Clamped { pin, value, limit }, FlatRecord { event: 3, value, limit, name: pin, ..none }),
            (E::Raised { pin, value, limit }, FlatRecord { event: 4, value, limit, name: pin, ..none }),
            (E::Slowed { pin, value, limit }, FlatRecord { event: 21, value, limit, name: pin, ..none }),
            (
                E::Unavoidable(Excess { velocity: 1.0, acceleration: 2.0, jerk: 4.0 }),
                FlatRecord { event: 5, value: 1.0, limit: 2.0, third: 4.0, ..none },
            ),
            (E::Shifted { by: 2.5 }, FlatRecord { event: 6, value: 2.5, ..none }),
            (planned(Goal::Position(position)), FlatRecord { event: 7, count: 70, value: position, ..none }),
            (planned(Goal::Velocity(velocity)), FlatRecord { event: 8, count: 70, value: velocity, ..none }),
            (
                planned(Goal::Passing { position, velocity }),
                FlatRecord { event: 9, count: 70, value: position, limit: velocity, ..none },
            ),
            (
                E::Superimposed { distance: Some(6.0), scans: 70 },
                FlatRecord { event: 10, count: 70, value: 6.0, ..none },
            ),
            (E::Superimposed { distance: None, scans: 70 }, FlatRecord { event: 10, count: 70, ..none }),
            (E::RoomAwaited, FlatRecord { event: 11, ..none }),
            (E::Paused { error }, FlatRecord { event: 12, error_id, ..none }),
            (E::Fault { error, code: 9 }, FlatRecord { event: 13, error_id, count: 9, ..none }),
            (E::Orphaned, FlatRecord { event: 14, ..none }),
            (
                E::Coupled { master: AxisId::new(2), numerator: -2, denominator: 3 },
                FlatRecord { event: 15, count: 3, value: -2.0, limit: 3.0, ..none },
            ),
            (
                E::Approaching { way: Approach::Stretch, velocity, scans: 70 },
                FlatRecord { event: 16, count: 70, value: velocity, name: Approach::Stretch.name(), ..none },
            ),
            (E::InGear, FlatRecord { event: 17, ..none }),
            (E::GearLost { what: pin, value, limit }, FlatRecord { event: 18, value, limit, name: pin, ..none }),
            (E::SyncLate { by: 2.5 }, FlatRecord { event: 19, value: 2.5, ..none }),
            (E::Phasing { to: 2.5, scans: 70 }, FlatRecord { event: 20, count: 70, value: 2.5, ..none }),
            (E::CamSelected { velocity: value, limit }, FlatRecord { event: 22, value, limit, ..none }),
            (E::OnCam { master: AxisId::new(2), cam: CamId::from_number(7) }, FlatRecord { event: 23, count: 3, value: 7.0, ..none }),
            (
                E::OntoCam { way: Approach::Stretch, value, scans: 70 },
                FlatRecord { event: 24, count: 70, value, name: Approach::Stretch.name(), ..none },
            ),
            (E::InSync, FlatRecord { event: 25, ..none }),
            (E::SyncLost { what: pin, value, limit }, FlatRecord { event: 26, value, limit, name: pin, ..none }),
            (E::CamPassed { periods: 3 }, FlatRecord { event: 27, count: 3, ..none }),
            (E::LeadsOutside { position: value, limit }, FlatRecord { event: 28, value, limit, ..none }),
            (E::CamStops { row: 3, what: pin, jump: 4.0 }, FlatRecord { event: 29, count: 3, value: 4.0, name: pin, ..none }),
        ];
        let documented = FIELDS[4].2;
        for (event, expected) in events {
            let from = Record {
                scan: 7,
                axis: AxisId::new(1),
                instance: InstanceId(40),
                event,
            };
            let expected = FlatRecord {
                number: 9,
                scan: 7,
                axis: 2,
                instance: 5,
                ..expected
            };
            let record = FlatRecord::new(9, 5, &from);
            assert_eq!(record, expected);
            let mut flat = [0xA5; RECORD_SIZE];
            record.put_flat(&mut flat);
            assert_eq!(f64::read(&flat, 56), expected.third, "{event:?}");
            let mut numbers = documented.split(", ").filter_map(|said| said.split(' ').next());
            let is_told = numbers.any(|number| number.parse() == Ok(expected.event));
            assert!(is_told, "{event:?}: {documented}");
        }
    }

    #[test]
    fn a_name_ends_in_0_however_long_it_is() {
        const LONG: &str = "A_name_of_a_pin_that_is_longer_than_its_field";
        let mut flat = [0xA5; RECORD_SIZE + NAME_SIZE];
        let record = FlatRecord {
            name: LONG,
            ..FlatRecord::default()
        };
        record.put_flat(&mut flat);
        assert_eq!(flat[64..][..NAME_SIZE - 1], LONG.as_bytes()[..NAME_SIZE - 1]);
        assert_eq!(
            flat[RECORD_SIZE - 1..],
            [[0].as_slice(), &[0xA5; NAME_SIZE]].concat()
        );
    }
}
