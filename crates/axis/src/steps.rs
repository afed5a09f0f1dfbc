//! The steps of a scan on axes and drives, which are given as slices: hosts keep both where they like.
//!
//! The order of the steps belongs to the host's scan. The content of each step, and the order of the axes
//! in it, are defined here once for the executor, the C library and a host's own loop.

use crate::{Axis, AxisId, AxisState, Drive, DriveFeedback, Planner, Scope, couple};

/// In axis order: takes the report of the drive, then updates the state of the axis. Call it
/// after every drive was read.
#[inline]
pub fn follow<P: Planner, D: Drive>(
    axes: &mut [Axis<P>],
    drives: &mut [D],
    feedback: &[DriveFeedback],
    scope: &mut Scope<'_>,
) {
    for ((axis, drive), feedback) in axes.iter_mut().zip(drives).zip(feedback) {
        drive.report(axis.report_mut());
        axis.follow_report();
        axis.follow_feedback(feedback, scope);
    }
}

/// After all blocks were called: computes the set-point of every axis for the end of this scan. Each axis
/// advances by one nominal tick, in the order of their numbers, but masters before their slaves. A late
/// scan does not stretch a motion.
///
/// Cost: for each axis one evaluation of its plan. If a command completes: at most one plan for each that
/// waits. With software limits: a ramp plan in each scan of an endless motion or a stop. For a slave: one
/// evaluation of its law, and if the master got another plan at most seven plans.
#[inline]
pub fn advance<P: Planner>(axes: &mut [Axis<P>], scope: &mut Scope<'_>) {
    advance_each(axes, scope, |_| ());
}

/// [`advance`] and [`publish`], in one pass where no axis follows another.
#[inline]
pub fn advance_and_publish<P: Planner, D: Drive>(
    axes: &mut [Axis<P>],
    drives: &mut [D],
    now_ns: i64,
    scope: &mut Scope<'_>,
) {
    let mut drives = drives.iter_mut();
    advance_each(axes, scope, |axis| {
        if let Some(drive) = drives.next() {
            write(axis, drive, now_ns);
        }
    });
}

/// [`advance`]; `then` takes every axis with its new set-point, in the order of their numbers.
// One pass: with thousands of axes each access is a cache miss, and a second pass would double them.
#[inline]
pub fn advance_each<P: Planner>(
    axes: &mut [Axis<P>],
    scope: &mut Scope<'_>,
    mut then: impl FnMut(&mut Axis<P>),
) {
    if axes.first().is_some_and(|first| first.links().some_follow()) {
        couple::advance(axes, scope);
        for axis in axes {
            axis.shape(scope);
            then(axis);
        }
        return;
    }
    for axis in axes {
        debug_assert!(!axis.links().is_bound(), "coupled past `couple`");
        axis.step_alone(scope);
        then(axis);
    }
}

/// Writes every drive once, in axis order.
#[inline]
pub fn publish<P: Planner, D: Drive>(axes: &mut [Axis<P>], drives: &mut [D], now_ns: i64) {
    for (axis, drive) in axes.iter_mut().zip(drives) {
        write(axis, drive, now_ns);
    }
}

#[inline]
fn write<P: Planner, D: Drive>(axis: &mut Axis<P>, drive: &mut D, now_ns: i64) {
    drive.order(axis.order());
    drive.write(now_ns, &axis.drive_command());
}

/// Asks every axis to stop and switch off, each as it is configured.
pub fn switch_off<P: Planner>(axes: &mut [Axis<P>], scope: &mut Scope<'_>) {
    for axis in axes {
        axis.switch_off(scope);
    }
}

/// The first axis that is neither Disabled nor at rest in ErrorStop; no motion can be carried over a new
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

/// Compiles the motion step for `Standard` once, here. In builds that are optimised little, crates that move axes use this
/// code instead of compiling a copy each.
#[cfg(all(debug_assertions, not(test)))]
#[used]
static ADVANCE: fn(&mut [Axis<standstill_planner::Standard>], &mut Scope<'_>) = advance;
