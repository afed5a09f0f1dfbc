//! A machine with its programs, built step by step: [`Builder`], [`Ready`], [`Running`].
//!
//! All memory is allocated while building. [`Running::scan`] allocates none, so a host can set up everything
//! at power-up and run for years. Axes and drives belong to the runtime. Block instances may belong to it,
//! too; a program then calls them by their [`BlockId`]. Or they are fields of the host's own structs, where
//! the compiler knows their types. A host that also wants its axes in its own structs needs no runtime: the
//! loop in the README is enough.

mod blocks;
mod builder;

pub use blocks::{BlockId, Blocks};
pub use builder::{BuildError, Builder};

use standstill_axis::{Drive, IdealDrive, Standard};
use standstill_fb::Context;
use standstill_record::{Pins, Recorder};
use standstill_scan::{
    Executor, Machine, NotOff, ProgramFault, ProgramId, Programs, ScanReport, ScanTime, Start, TaskId,
    TimeRanBackwards,
};

/// The host's side of a scan. [`Executor::scan`] says when each hook is called.
pub trait Program<D: Drive = IdealDrive> {
    /// Sets all variables.
    fn start(&mut self, _start: Start) {}

    /// Latches the inputs that the programs of the scan read.
    fn latch(&mut self, _time: ScanTime, _machine: &mut Machine<Standard, D>) {}

    /// The BOOL bound to SINGLE of `task`.
    fn single(&mut self, _task: TaskId) -> bool {
        false
    }

    /// Runs a program instance to its end. Returns the time it took (ns) by a deterministic measure, or 0.
    /// `blocks` are the runtime's own instances. Before a call of one of the host's own instances, set
    /// `context.scope.instance` to the number that [`Builder::own_block`] returned.
    ///
    /// # Errors
    /// [`ProgramFault`] ends the scan's programs and stops the resource.
    fn run(
        &mut self,
        program: ProgramId,
        blocks: &mut Blocks,
        context: &mut Context<'_>,
    ) -> Result<u64, ProgramFault>;

    /// Gives the recorder the pins of the host's own instances, in the order in which
    /// [`Builder::own_block`] declared them.
    fn pins(&self, _pins: &mut Pins<'_>) {}

    /// The scan is over. The set-points are those that the drives received.
    fn published(&mut self, _time: ScanTime, _machine: &Machine<Standard, D>) {}
}

/// A runtime that is checked and has its memory, before the first scan.
#[derive(Debug)]
pub struct Ready<D: Drive = IdealDrive> {
    executor: Executor,
    machine: Machine<Standard, D>,
    blocks: Blocks,
    recorder: Option<Recorder>,
}

impl<D: Drive> Ready<D> {
    /// The runtime with its program, before its first scan; [`Program::start`] is called with a cold start.
    pub fn start<P: Program<D>>(self, mut program: P) -> Running<P, D> {
        program.start(Start::Cold);
        Running {
            executor: self.executor,
            machine: self.machine,
            host: Host {
                program,
                blocks: self.blocks,
                recorder: self.recorder,
            },
        }
    }

    /// Axes and drives.
    pub fn machine(&self) -> &Machine<Standard, D> {
        &self.machine
    }
}

/// A runtime at work.
#[derive(Debug)]
pub struct Running<P, D: Drive = IdealDrive> {
    executor: Executor,
    machine: Machine<Standard, D>,
    host: Host<P>,
}

/// The part of a scan outside axes and drives.
#[derive(Debug)]
struct Host<P> {
    program: P,
    blocks: Blocks,
    recorder: Option<Recorder>,
}

impl<P: Program<D>, D: Drive> Running<P, D> {
    /// One scan at this instant (ns) of a monotonic clock. Axes advance by one nominal cycle at any
    /// instant: a late scan stretches a motion and never enlarges a step.
    ///
    /// Work: each task, axis, drive and recorded signal at most once; no heap.
    ///
    /// # Errors
    /// [`TimeRanBackwards`] if the instant is before that of the last scan; nothing was executed.
    pub fn scan(&mut self, now_ns: i64) -> Result<ScanReport, TimeRanBackwards> {
        self.executor.scan(now_ns, &mut self.host, &mut self.machine)
    }

    /// Stops all programs. Every axis stops and switches off as its configuration says. This takes further
    /// scans; [`Running::is_off`] reports when it is done.
    pub fn stop(&mut self) {
        self.executor.stop(&mut self.host, &mut self.machine);
    }

    /// Starts again after a stop or a fault.
    ///
    /// # Errors
    /// [`NotOff`] if an axis is not off yet; nothing has changed then.
    pub fn restart(&mut self, start: Start) -> Result<(), NotOff> {
        self.executor.start(start, &mut self.host, &self.machine)
    }

    /// Whether every axis is off.
    ///
    /// # Errors
    /// [`NotOff`] with the first axis that is not.
    pub fn is_off(&self) -> Result<(), NotOff> {
        self.machine.is_off()
    }

    /// The host's program.
    pub fn program(&self) -> &P {
        &self.host.program
    }

    /// The host's program, between scans.
    pub fn program_mut(&mut self) -> &mut P {
        &mut self.host.program
    }

    /// The runtime's own block instances.
    pub fn blocks(&self) -> &Blocks {
        &self.host.blocks
    }

    /// The runtime's own block instances, between scans.
    pub fn blocks_mut(&mut self) -> &mut Blocks {
        &mut self.host.blocks
    }

    /// Axes, drives and the ring of records.
    pub fn machine(&self) -> &Machine<Standard, D> {
        &self.machine
    }

    /// Axes and drives, between scans.
    pub fn machine_mut(&mut self) -> &mut Machine<Standard, D> {
        &mut self.machine
    }

    /// Tasks and their counts.
    pub fn executor(&self) -> &Executor {
        &self.executor
    }

    /// The recorder, if there is one.
    pub fn recorder(&self) -> Option<&Recorder> {
        self.host.recorder.as_ref()
    }

    /// The recorder, to trip or to arm it between scans.
    pub fn recorder_mut(&mut self) -> Option<&mut Recorder> {
        self.host.recorder.as_mut()
    }
}

impl<P: Program<D>, D: Drive> Programs<Standard, D> for Host<P> {
    fn start(&mut self, start: Start) {
        self.program.start(start);
    }

    fn latch(&mut self, time: ScanTime, machine: &mut Machine<Standard, D>) {
        self.program.latch(time, machine);
    }

    fn single(&mut self, task: TaskId) -> bool {
        self.program.single(task)
    }

    fn run(&mut self, program: ProgramId, context: &mut Context<'_>) -> Result<u64, ProgramFault> {
        self.program.run(program, &mut self.blocks, context)
    }

    fn observe(&mut self, _time: ScanTime, machine: &Machine<Standard, D>) {
        if let Some(recorder) = &mut self.recorder {
            recorder.observe(machine.axes());
        }
    }

    fn published(&mut self, time: ScanTime, machine: &Machine<Standard, D>) {
        if let Some(recorder) = &mut self.recorder {
            let (blocks, program) = (&self.blocks, &self.program);
            recorder.record(time.scan, machine.axes(), machine.log(), |pins| {
                for instance in blocks.instances() {
                    pins.add(instance);
                }
                program.pins(pins);
            });
        }
        self.program.published(time, machine);
    }
}
