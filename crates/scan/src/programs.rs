//! The host's part: its programs, its inputs and outputs, and hooks to observe a scan.

use crate::{Fault, Machine};
use standstill_axis::{AxisId, AxisState, Drive, Planner};
use standstill_fb::Context;

/// A task: its index in the declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct TaskId(pub usize);

/// A program instance: its index in the declaration.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct ProgramId(pub usize);

/// Which scan, and its instant. Constant during the scan, so two timers called in it see the same time.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanTime {
    /// Number of the scan, from 0.
    pub scan: u64,
    /// Its instant (ns), as given to [`crate::Executor::scan`].
    pub now_ns: i64,
}

/// How variables get their values before the first scan (IEC 61131-3, RETAIN).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Start {
    /// Every variable takes its initial value.
    Cold,
    /// Retained variables keep theirs; all others as in a cold start.
    Warm,
}

/// A fault inside a program: a trap, a division by zero, an index out of range.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ProgramFault {
    /// What happened, for people.
    pub reason: &'static str,
}

/// A start was refused because an axis is switched on or still moves. Neither power nor motion may continue over a start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct NotOff {
    /// The first such axis.
    pub axis: AxisId,
    /// Its state.
    pub state: AxisState,
}

impl core::fmt::Display for NotOff {
    fn fmt(&self, f: &mut core::fmt::Formatter<'_>) -> core::fmt::Result {
        write!(
            f,
            "axis {} is in {}: stop the resource and go on scanning until every axis is Disabled, then start",
            self.axis.index(),
            self.state.name()
        )
    }
}

impl core::error::Error for NotOff {}

/// The host's side of a scan. [`crate::Executor::scan`] says when each hook is called.
pub trait Programs<P: Planner, D: Drive> {
    /// Sets all variables: globals first, then program instances in declaration order, and nested
    /// instances before their owner.
    fn start(&mut self, _start: Start) {}

    /// Latches the inputs: all programs of the scan see this image and nothing newer. A simulation also
    /// changes its drives here.
    fn latch(&mut self, _time: ScanTime, _machine: &mut Machine<P, D>) {}

    /// The BOOL bound to SINGLE of `task`. Asked once a scan and only of tasks that declare SINGLE.
    fn single(&mut self, _task: TaskId) -> bool {
        false
    }

    /// Runs a program instance to its end. Returns the time it took (ns) by a measure that is the same in
    /// every run, such as counted instructions, or 0 if none is counted. A measured time would make the
    /// schedule differ from run to run.
    ///
    /// `context.scope.instance` is [`crate::RUNTIME`] at first. A host that calls blocks sets it for each
    /// block.
    ///
    /// # Errors
    /// [`ProgramFault`] ends the scan's programs and stops the resource.
    fn run(&mut self, program: ProgramId, context: &mut Context<'_, P>) -> Result<u64, ProgramFault>;

    /// Called after all programs of this scan and before the motion step. Axis states are those the trace
    /// shows.
    fn observe(&mut self, _time: ScanTime, _machine: &Machine<P, D>) {}

    /// Publishes the outputs of the programs. Not called while the resource is stopped, nor in the scan of a
    /// fault.
    fn publish(&mut self, _time: ScanTime) {}

    /// The resource has stopped, because of a fault or on request: outputs take their fail values. Called
    /// once.
    fn stopped(&mut self, _fault: Option<&Fault>) {}

    /// The scan is over. The set-points are those that the drives received.
    fn published(&mut self, _time: ScanTime, _machine: &Machine<P, D>) {}

    /// Called in each scan of [`crate::Executor::coast`], instead of all hooks between feedback and the
    /// motion step.
    fn idle(&mut self, _time: ScanTime, _machine: &mut Machine<P, D>) {}

    /// Called at the end of each scan of [`crate::Executor::coast`]. Returns whether the next scan may run
    /// without programs, too.
    fn idled(&mut self, _time: ScanTime, _machine: &Machine<P, D>) -> bool {
        false
    }
}
