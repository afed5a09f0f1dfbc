//! The words that every trace uses for axes, block instances, values and records, and a recorder's rows
//! as a trace.

mod cells;
mod dump;
mod notes;

pub use cells::{Cells, enum_number};
pub use notes::{Names, note};

use crate::text::order;
use standstill_axis::AxisConfig;
use standstill_fb::{BlockInfo, Direction};
use standstill_trace as trace;
use std::borrow::ToOwned;
use std::string::String;

/// The header entry of an axis; `unit` is the label of its unit.
pub fn axis(name: &str, unit: &str, config: &AxisConfig) -> trace::Axis {
    trace::Axis {
        name: name.to_owned(),
        unit: unit.to_owned(),
        order: order(config),
        limits: limits(config),
        modulo: config.modulo,
        scaling: config.scaling.map(|scaling| trace::Scaling {
            increments: scaling.increments().into(),
            units: scaling.units().into(),
            invert: scaling.invert(),
            offset: scaling.offset(),
        }),
        ..trace::Axis::default()
    }
}

/// The header entry of a block instance.
pub fn instance(name: String, block: &BlockInfo) -> trace::Instance {
    trace::Instance {
        name,
        block: block.name.to_owned(),
        pins: block
            .pins()
            .map(|pin| trace::Pin {
                name: pin.name.to_owned(),
                iec_type: pin.ty.iec_name().to_owned(),
                direction: match pin.direction {
                    Direction::InOut => trace::Direction::InOut,
                    Direction::Input => trace::Direction::Input,
                    Direction::Output => trace::Direction::Output,
                },
                default: None,
                named: false,
                written: Default::default(),
            })
            .collect(),
    }
}

fn limits(config: &AxisConfig) -> trace::Limits {
    let finite = |limit: f64| limit.is_finite().then_some(limit);
    trace::Limits {
        position_min: config.software_limits.and_then(|(min, _)| finite(min)),
        position_max: config.software_limits.and_then(|(_, max)| finite(max)),
        velocity: finite(config.limits.velocity),
        acceleration: finite(config.limits.acceleration),
        deceleration: finite(config.limits.deceleration),
        jerk: finite(config.limits.jerk),
        snap: finite(config.limits.snap),
    }
}
