//! A host that records the actions of the executor and of its drives in one list.
#![allow(dead_code, reason = "each test target uses its own part")]

use standstill_axis::{
    AxisConfig, Comms, Drive, DriveCommand, DriveFeedback, DrivePosition, DriveRequest, DriveSignals, Limits,
    Standard, StartState,
};
use standstill_fb::Context;
use standstill_scan::{
    Executor, Fault, Machine, ProgramConfig, ProgramFault, ProgramId, Programs, ScanReport, ScanTime, Start,
    TaskConfig, TaskId,
};
use std::cell::RefCell;
use std::rc::Rc;

/// The base tick of all tests (ns).
pub const MS: u64 = 1_000_000;

pub type Tape = Rc<RefCell<Vec<String>>>;

/// A drive that notes each access and otherwise follows its command.
pub struct TapeDrive {
    name: &'static str,
    tape: Tape,
    enabled: bool,
    position: DrivePosition,
    pub written: Vec<DriveCommand>,
}

impl Drive for TapeDrive {
    fn read(&mut self, _now_ns: i64) -> DriveFeedback {
        self.tape.borrow_mut().push(format!("read {}", self.name));
        DriveFeedback {
            enabled: self.enabled,
            voltage: true,
            fault: None,
            position: self.position,
            comms: Comms::Ok,
            signals: DriveSignals::default(),
        }
    }

    fn write(&mut self, _now_ns: i64, command: &DriveCommand) {
        self.tape.borrow_mut().push(format!("write {}", self.name));
        self.enabled = command.request == DriveRequest::Enable;
        if self.enabled {
            self.position = command.position;
        }
        self.written.push(*command);
    }
}

pub type TestMachine = Machine<Standard, TapeDrive>;

/// What a program does in a scan: how long it took, or how it failed.
pub type Script = Box<dyn FnMut(ScanTime, &str) -> Result<u64, ProgramFault>>;

pub type Act = fn(u64, &mut Context<'_, Standard>) -> Result<(), ProgramFault>;

/// Notes every hook.
pub struct Host {
    pub tape: Tape,
    pub names: Vec<String>,
    pub script: Script,
    /// What programs do to the axes in a scan.
    pub act: Act,
    /// SINGLE by scan and task.
    pub single: fn(u64, TaskId) -> bool,
    /// Whether programs may be left out further.
    pub idles: bool,
    scan: u64,
    pub failed: Vec<Fault>,
}

impl Host {
    fn note(&self, text: String) {
        self.tape.borrow_mut().push(text);
    }
}

impl Programs<Standard, TapeDrive> for Host {
    fn start(&mut self, start: Start) {
        self.note(format!("start {start:?}"));
    }

    fn latch(&mut self, time: ScanTime, _machine: &mut TestMachine) {
        self.scan = time.scan;
        self.note("latch".into());
    }

    fn single(&mut self, task: TaskId) -> bool {
        (self.single)(self.scan, task)
    }

    fn run(&mut self, program: ProgramId, context: &mut Context<'_, Standard>) -> Result<u64, ProgramFault> {
        let name = &self.names[program.0];
        self.note(format!("run {name}"));
        (self.act)(context.scope.scan, context)?;
        let time = ScanTime {
            scan: context.scope.scan,
            now_ns: context.now_ns,
        };
        (self.script)(time, name)
    }

    fn observe(&mut self, _time: ScanTime, _machine: &TestMachine) {
        self.note("observe".into());
    }

    fn publish(&mut self, _time: ScanTime) {
        self.note("publish".into());
    }

    fn stopped(&mut self, fault: Option<&Fault>) {
        self.failed.extend(fault);
        self.note("stopped".into());
    }

    fn published(&mut self, _time: ScanTime, _machine: &TestMachine) {
        self.note("published".into());
    }

    fn idle(&mut self, time: ScanTime, _machine: &mut TestMachine) {
        self.note(format!("idle {}", time.scan));
    }

    fn idled(&mut self, time: ScanTime, _machine: &TestMachine) -> bool {
        self.note(format!("idled {}", time.now_ns));
        self.idles
    }
}

/// Executor, machine and host together.
pub struct Rig {
    pub executor: Executor,
    pub machine: TestMachine,
    pub host: Host,
}

impl Rig {
    /// Tasks and programs on a 1 ms tick, with one powered axis for each name.
    pub fn new(tasks: &[TaskConfig], programs: &[ProgramConfig], axes: &[&'static str]) -> Self {
        let tape = Tape::default();
        let mut machine = TestMachine::new();
        for name in axes {
            let drive = TapeDrive {
                name,
                tape: tape.clone(),
                enabled: true,
                position: DrivePosition::Units(0.0),
                written: Vec::new(),
            };
            machine
                .add_axis(axis_config(), Standard::new(0.001), drive)
                .unwrap();
        }
        Self {
            executor: Executor::new(MS, tasks, programs).unwrap(),
            machine,
            host: Host {
                tape,
                names: programs.iter().map(|program| program.name.clone()).collect(),
                script: Box::new(|_, _| Ok(0)),
                act: |_, _| Ok(()),
                single: |_, _| false,
                idles: true,
                scan: 0,
                failed: Vec::new(),
            },
        }
    }

    /// One program in a task of every tick, with these axes.
    pub fn of_axes(axes: &[&'static str]) -> Self {
        Self::new(
            &[task("main", 1, 0)],
            &[ProgramConfig::with("main", "main")],
            axes,
        )
    }

    /// A program of the same name for each task, no axes.
    pub fn of_tasks(tasks: &[TaskConfig]) -> Self {
        let programs: Vec<_> = tasks
            .iter()
            .map(|task| ProgramConfig::with(&task.name, &task.name))
            .collect();
        Self::new(tasks, &programs, &[])
    }

    pub fn scan_at(&mut self, now_ns: i64) -> ScanReport {
        self.executor
            .scan(now_ns, &mut self.host, &mut self.machine)
            .unwrap()
    }

    /// Scans at `ticks` (ms) and returns which programs ran in each.
    pub fn runs(&mut self, ticks: impl IntoIterator<Item = i64>) -> Vec<String> {
        ticks
            .into_iter()
            .map(|tick| {
                self.host.tape.borrow_mut().clear();
                self.scan_at(tick * MS as i64);
                let tape = self.host.tape.borrow();
                let ran: Vec<_> = tape.iter().filter_map(|line| line.strip_prefix("run ")).collect();
                ran.join(" ")
            })
            .collect()
    }

    pub fn taken_tape(&mut self) -> Vec<String> {
        self.host.tape.take()
    }
}

fn axis_config() -> AxisConfig {
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2000.0,
        snap: 40000.0,
    };
    AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(limits)
    }
}

/// A task with a priority.
pub fn task(name: &str, interval_ms: u64, priority: u32) -> TaskConfig {
    TaskConfig {
        priority,
        ..TaskConfig::every(name, interval_ms * MS)
    }
}
