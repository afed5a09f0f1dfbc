//! What a scan does to axes and the drives under them, in slices: hosts keep both where they like.
//!
//! The order of the steps belongs to the host's scan; what happens in each of them stands here once.

use crate::{Axis, AxisId, AxisState, Drive, DriveFeedback, Log, Planner, Source};

/// After every drive was read: takes what drives tell beside their motion, then lets the states follow, in axis order.
#[inline]
pub fn follow<P: Planner, D: Drive>(
    axes: &mut [Axis<P>],
    drives: &mut [D],
    feedback: &[DriveFeedback],
    scan: u64,
    log: &mut Log,
) {
    for (axis, drive) in axes.iter_mut().zip(drives) {
        drive.report(axis.report_mut());
        axis.follow_report();
    }
    for (axis, feedback) in axes.iter_mut().zip(feedback) {
        axis.follow_feedback(feedback, scan, log);
    }
}

/// Writes every drive once, in axis order.
#[inline]
pub fn publish<P: Planner, D: Drive>(axes: &mut [Axis<P>], drives: &mut [D], now_ns: i64) {
    for (axis, drive) in axes.iter_mut().zip(drives) {
        drive.order(axis.order());
        drive.write(now_ns, &axis.drive_command());
    }
}

/// Asks every axis to stop and switch off, each as its configuration says.
pub fn switch_off<P: Planner>(axes: &mut [Axis<P>], source: Source, log: &mut Log) {
    for axis in axes {
        axis.switch_off(source, log);
    }
}

/// The first axis that is neither Disabled nor at rest in ErrorStop; nothing of a motion can be carried over a new
/// start.
pub fn first_not_off<P: Planner>(axes: &[Axis<P>]) -> Option<(AxisId, AxisState)> {
    let on = axes.iter().find(|axis| match axis.state() {
        AxisState::Disabled => false,
        // After a fault an axis may still be on its ramp.
        AxisState::ErrorStop => !axis.setpoint().is_at_rest(),
        AxisState::Standstill
        | AxisState::Homing
        | AxisState::DiscreteMotion
        | AxisState::ContinuousMotion
        | AxisState::SynchronizedMotion
        | AxisState::Stopping => true,
    })?;
    Some((on.id(), on.state()))
}
