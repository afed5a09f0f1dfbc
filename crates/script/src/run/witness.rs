//! What a run shows of its calls to a program that checks each of them.

use super::bench::{Bench, ScriptMachine};
use super::drive::ScriptDrive;
use standstill_axis::{Axis, Log, Standard};
use standstill_blocks::BlockInstance;
use standstill_fb::Context;
use standstill_scan::{ProgramFault, ProgramId, Programs, ScanTime, TaskId};

/// Looks at every call of a run. It changes nothing.
pub trait Witness {
    /// The instances of a task are called next. In a scan, the axes have read their drives before the first one.
    fn begins(&mut self, scan: u64, axes: &[Axis<Standard>]);

    /// The instance at this place of [`Script::blocks`](crate::model::Script::blocks) is called next.
    fn before(&mut self, instance: usize, context: &Context<'_, Standard>);

    /// It was called.
    fn after(&mut self, instance: usize, block: &BlockInstance, context: &Context<'_, Standard>);

    /// A scan is over: the axes have published their set-points.
    fn published(&mut self, scan: u64, axes: &[Axis<Standard>], log: &Log);
}

/// The programs of a script with a witness.
pub(super) struct Witnessed<'w, 'a> {
    pub(super) bench: &'w mut Bench<'a>,
    pub(super) witness: &'w mut dyn Witness,
}

impl Programs<Standard, ScriptDrive> for Witnessed<'_, '_> {
    fn latch(&mut self, time: ScanTime, machine: &mut ScriptMachine) {
        self.bench.latch(time, machine);
    }

    fn single(&mut self, task: TaskId) -> bool {
        self.bench.single(task)
    }

    fn run(&mut self, program: ProgramId, context: &mut Context<'_, Standard>) -> Result<u64, ProgramFault> {
        self.bench.run_before(program, context, Some(self.witness))
    }

    fn observe(&mut self, time: ScanTime, machine: &ScriptMachine) {
        self.bench.observe(time, machine);
    }

    fn published(&mut self, time: ScanTime, machine: &ScriptMachine) {
        self.bench.published(time, machine);
        self.witness.published(time.scan, machine.axes(), machine.log());
    }
}
