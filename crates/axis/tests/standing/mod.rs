//! Axes that are in Standstill from the start.

use standstill_axis::{Axis, AxisConfig, AxisId, Limits, Standard, StartState};

pub fn config(limits: Limits) -> AxisConfig {
    AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(limits)
    }
}

/// The first axis.
pub fn axis(limits: Limits, cycle: f64) -> Axis {
    Axis::new(AxisId::new(0), config(limits), Standard::new(cycle)).expect("a good configuration")
}
