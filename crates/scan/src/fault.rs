//! What stops a resource.

use crate::{ProgramId, TaskId};
use core::fmt;

/// Why the resource stopped. Programs run again only after a start.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Fault {
    /// A program reported a fault.
    Program {
        /// The scan.
        scan: u64,
        /// Its task, if it has one.
        task: Option<TaskId>,
        /// The program instance.
        program: ProgramId,
        /// What happened.
        reason: &'static str,
    },
    /// A task took longer than its watchdog permits, for as many executions in a row as its sensitivity
    /// says.
    Watchdog {
        /// The scan.
        scan: u64,
        /// The task.
        task: TaskId,
        /// The time of the last execution (ns).
        took_ns: u64,
        /// The allowed time (ns).
        limit_ns: u64,
    },
}

/// A fault with the names of its task and program; made by [`crate::Executor::describe`].
#[derive(Clone, Copy, Debug)]
pub struct FaultText<'a> {
    pub(crate) fault: Fault,
    pub(crate) task: Option<&'a str>,
    pub(crate) program: Option<&'a str>,
}

impl fmt::Display for FaultText<'_> {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let task = self.task.unwrap_or("(none)");
        match self.fault {
            Fault::Program { scan, reason, .. } => {
                let program = self.program.unwrap_or("(unknown)");
                write!(f, "scan {scan}, task {task}, program {program}: {reason}")
            }
            Fault::Watchdog {
                scan,
                took_ns,
                limit_ns,
                ..
            } => write!(
                f,
                "scan {scan}, task {task}: the watchdog fired, {took_ns} ns where {limit_ns} ns are permitted"
            ),
        }
    }
}
