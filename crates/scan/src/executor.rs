//! The executor: which programs run, and the order of everything in a scan.

use crate::config::{by_name, check, upper};
use crate::task::Task;
use crate::{
    ConfigError, Fault, FaultText, Machine, NotOff, ProgramConfig, ProgramId, Programs, RUNTIME, ScanTime,
    Start, TaskConfig, TaskCounts, TaskId,
};
use alloc::string::String;
use alloc::vec;
use alloc::vec::Vec;
use core::fmt;
use core::num::NonZero;
use standstill_axis::{Drive, Planner};

/// What a scan did.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ScanReport {
    /// Number of the scan, from 0.
    pub scan: u64,
    /// The base tick of its instant, counted from the start.
    pub tick: u64,
    /// Ticks since the last scan that had no scan.
    pub missed_ticks: u64,
    /// Tasks executed.
    pub executions: usize,
    /// Number of these whose next due time had passed when they ended.
    pub overruns: usize,
    /// Whether programs run from now on.
    pub mode: Mode,
}

/// Whether a resource runs its programs. Axes and drives are served in every mode.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Mode {
    /// Programs run.
    #[default]
    Running,
    /// Stopped on request.
    Stopped,
    /// Stopped by a fault.
    Faulted(Fault),
}

impl Mode {
    /// The fault that stopped the resource.
    pub fn fault(&self) -> Option<&Fault> {
        match self {
            Self::Faulted(fault) => Some(fault),
            Self::Running | Self::Stopped => None,
        }
    }
}

/// The instant given to a scan is earlier than that of the last scan. Nothing was executed.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimeRanBackwards {
    /// The instant given (ns).
    pub now_ns: i64,
    /// The instant of the last scan (ns).
    pub previous_ns: i64,
}

impl fmt::Display for TimeRanBackwards {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(
            f,
            "the scan's instant {} ns is before the last one, {} ns: use a monotonic time source",
            self.now_ns, self.previous_ns
        )
    }
}

impl core::error::Error for TimeRanBackwards {}

/// A program instance at run time.
#[derive(Clone, Debug)]
struct Program {
    name: String,
    task: Option<TaskId>,
}

/// An execution that waits. The order is: highest priority first, then the task that waits longest, then
/// the one declared first.
type Waiting = (u32, u64, TaskId);

/// One resource: its tasks and program instances, executed one after the other without preemption.
///
/// A task is due on the ticks of its phase grid, which begins at the first scan after a start. An instant
/// belongs to the nearest tick, so jitter below half a tick changes nothing. If programs report how long
/// they take, the processing unit is busy for that time. A task that becomes due meanwhile waits for one
/// execution; further periods are skipped and counted. Motion does not depend on this: every axis
/// advances by one nominal tick in every scan.
#[derive(Clone, Debug)]
pub struct Executor {
    base_tick_ns: NonZero<u64>,
    tasks: Vec<Task>,
    programs: Vec<Program>,
    /// The programs of each task, then those without one, in declaration order.
    by_task: Vec<Vec<ProgramId>>,
    /// The executions of the current scan; it has room for all tasks.
    waiting: Vec<Waiting>,
    /// Number of the next scan.
    next_scan: u64,
    previous_ns: Option<i64>,
    /// Instant of tick 0, and the tick of the last scan.
    grid: Option<(i64, u64)>,
    /// First tick at which the processing unit is free.
    free_from: u64,
    mode: Mode,
}

/// The results of the programs of a scan.
#[derive(Clone, Copy, Default)]
struct Work {
    used_ns: u64,
    executions: usize,
    overruns: usize,
}

impl Executor {
    /// Creates an executor for these declarations. This is the only step that uses the heap.
    ///
    /// # Errors
    /// [`ConfigError`]: the first defect, with its values.
    pub fn new(
        base_tick_ns: u64,
        tasks: &[TaskConfig],
        programs: &[ProgramConfig],
    ) -> Result<Self, ConfigError> {
        check(base_tick_ns, tasks, programs)?;
        let places = by_name(tasks);
        let programs: Vec<_> = programs
            .iter()
            .map(|program| Program {
                name: program.name.clone(),
                task: (program.task.as_ref())
                    .and_then(|name| places.get(&upper(name)).copied())
                    .map(TaskId),
            })
            .collect();
        let mut by_task = vec![Vec::new(); tasks.len() + 1];
        for (index, program) in programs.iter().enumerate() {
            let place = program.task.map_or(tasks.len(), |task| task.0);
            if let Some(programs) = by_task.get_mut(place) {
                programs.push(ProgramId(index));
            }
        }
        Ok(Self {
            base_tick_ns: NonZero::new(base_tick_ns).ok_or(ConfigError::BaseTick)?,
            tasks: tasks.iter().map(|task| Task::new(task, base_tick_ns)).collect(),
            programs,
            by_task,
            waiting: Vec::with_capacity(tasks.len()),
            next_scan: 0,
            previous_ns: None,
            grid: None,
            free_from: 0,
            mode: Mode::Running,
        })
    }

    /// Starts the resource: sets the variables, restarts tasks and counts, and clears the fault.
    ///
    /// A resource whose programs already have their initial values needs no start before its first scan;
    /// axes then have their configured state. Before any later start the axes must be off, so that no
    /// motion continues after it. Scan numbers continue, so that records stay unambiguous.
    ///
    /// # Errors
    /// [`NotOff`] if an axis is not off; nothing has changed then.
    pub fn start<P: Planner, D: Drive>(
        &mut self,
        start: Start,
        programs: &mut impl Programs<P, D>,
        machine: &Machine<P, D>,
    ) -> Result<(), NotOff> {
        if self.next_scan > 0 {
            machine.is_off()?;
        }
        programs.start(start);
        for task in &mut self.tasks {
            task.restart();
        }
        self.grid = None;
        self.free_from = 0;
        self.mode = Mode::Running;
        Ok(())
    }

    /// Stops the resource: no program runs any more, and every axis stops and switches off as it is
    /// configured, which takes further scans. No effect on a stopped resource.
    pub fn stop<P: Planner, D: Drive>(
        &mut self,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) {
        if self.mode == Mode::Running {
            self.leave_running(Mode::Stopped, programs, machine);
        }
    }

    /// One scan at the instant `now_ns`. This function body is the order of everything in a scan.
    ///
    /// Work: each task at most once, each axis and drive once. A stopped resource runs no program, but
    /// axes and drives are served, because an axis needs scans to stop.
    ///
    /// # Errors
    /// [`TimeRanBackwards`] if `now_ns` is less than that of the last scan; nothing was executed.
    pub fn scan<P: Planner, D: Drive>(
        &mut self,
        now_ns: i64,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) -> Result<ScanReport, TimeRanBackwards> {
        let (tick, missed_ticks) = self.tick_of(now_ns)?;
        let scan = self.next_scan;
        let time = ScanTime { scan, now_ns };
        self.next_scan += 1;

        programs.latch(time, machine);
        machine.read_feedback(time);
        let work = self.run_due_tasks(time, tick, programs, machine);
        programs.observe(time, machine);
        machine.advance(time);
        if self.mode == Mode::Running {
            programs.publish(time);
        }
        programs.published(time, machine);

        Ok(ScanReport {
            scan,
            tick,
            missed_ticks,
            executions: work.executions,
            overruns: work.overruns,
            mode: self.mode,
        })
    }

    /// Runs at most `scans` further scans, a base tick apart, without programs. Use it where every program
    /// would repeat exactly what it did in the scan before. The host must know this: it is asked after each
    /// scan ([`Programs::idled`]). Axes and drives are served as in every scan. Returns the number of scans
    /// done. It is 0 unless all tasks are due in every tick.
    pub fn coast<P: Planner, D: Drive>(
        &mut self,
        scans: u64,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) -> u64 {
        let Some(mut now_ns) = self.previous_ns.filter(|now| self.is_even(*now)) else {
            return 0;
        };
        let mut done = 0;
        while done < scans {
            now_ns = now_ns.saturating_add_unsigned(self.base_tick_ns.get());
            let time = ScanTime {
                scan: self.next_scan.saturating_add(done),
                now_ns,
            };
            machine.read_feedback(time);
            programs.idle(time, machine);
            machine.advance(time);
            done += 1;
            if !programs.idled(time, machine) {
                break;
            }
        }
        self.pass(done);
        done
    }

    /// Lets time pass for `scans` scans and calls nothing. Use it where axes and drives are at rest too, so
    /// that no scan changes anything, or where the host advances the axes itself ([`Machine::along`]).
    /// Returns the number of scans that have passed.
    pub fn stand(&mut self, scans: u64) -> u64 {
        let is_even = self.previous_ns.is_some_and(|now_ns| self.is_even(now_ns));
        let scans = if is_even { scans } else { 0 };
        self.pass(scans);
        scans
    }

    /// Whether programs run in every tick, and the last scan, at this instant, was neither early nor late.
    fn is_even(&self, now_ns: i64) -> bool {
        let Some((start_ns, tick)) = self.grid else {
            return false;
        };
        let is_on_tick = Some(now_ns.abs_diff(start_ns)) == tick.checked_mul(self.base_tick_ns.get());
        let are_even = self.tasks.iter().all(|task| task.is_even(tick));
        is_on_tick && are_even && self.mode == Mode::Running && self.free_from <= tick
    }

    /// Counts this many scans, a base tick apart.
    fn pass(&mut self, scans: u64) {
        let ns = self.base_tick_ns.get().saturating_mul(scans);
        self.next_scan = self.next_scan.saturating_add(scans);
        self.previous_ns = self.previous_ns.map(|now| now.saturating_add_unsigned(ns));
        self.grid = self.grid.map(|(start, tick)| (start, tick.saturating_add(scans)));
        self.tasks.iter_mut().for_each(|task| task.go_on(scans));
        self.free_from = self.free_from.saturating_add(scans);
    }

    /// Whether programs run.
    pub fn mode(&self) -> Mode {
        self.mode
    }

    /// `fault` with the names of its task and program.
    pub fn describe(&self, fault: Fault) -> FaultText<'_> {
        let (task, program) = match fault {
            Fault::Program { task, program, .. } => (task, Some(program)),
            Fault::Watchdog { task, .. } => (Some(task), None),
        };
        FaultText {
            fault,
            task: task.and_then(|id| self.tasks.get(id.0)).map(|task| &*task.name),
            program: program
                .and_then(|id| self.programs.get(id.0))
                .map(|program| &*program.name),
        }
    }

    /// The counts of a task since the start.
    pub fn counts(&self, task: TaskId) -> Option<TaskCounts> {
        self.tasks.get(task.0).map(Task::counts)
    }

    /// The base tick (ns).
    pub fn base_tick_ns(&self) -> u64 {
        self.base_tick_ns.get()
    }

    /// The tick nearest to `now_ns`, and the ticks left out since the last scan.
    fn tick_of(&mut self, now_ns: i64) -> Result<(u64, u64), TimeRanBackwards> {
        if let Some(previous_ns) = self.previous_ns
            && now_ns < previous_ns
        {
            return Err(TimeRanBackwards { now_ns, previous_ns });
        }
        self.previous_ns = Some(now_ns);
        let Some((start_ns, last)) = self.grid else {
            self.grid = Some((now_ns, 0));
            return Ok((0, 0));
        };
        let elapsed = now_ns.abs_diff(start_ns);
        let rest = elapsed % self.base_tick_ns;
        let round_up = rest >= self.base_tick_ns.get() - rest;
        let tick = elapsed / self.base_tick_ns + u64::from(round_up);
        self.grid = Some((start_ns, tick));
        Ok((tick, (tick - last).saturating_sub(1)))
    }

    /// Samples SINGLE, then runs the programs of this scan: tasks by priority, then programs without a
    /// task.
    fn run_due_tasks<P: Planner, D: Drive>(
        &mut self,
        time: ScanTime,
        tick: u64,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) -> Work {
        let mut work = Work::default();
        if self.mode != Mode::Running {
            return work;
        }
        for (index, task) in self.tasks.iter_mut().enumerate() {
            let single = task.has_single && programs.single(TaskId(index));
            task.release(tick, single);
        }
        if tick < self.free_from {
            return work;
        }
        let outcome = self.run_all(time, tick, programs, machine, &mut work);
        self.free_from = self.tick_after(tick, work.used_ns);
        if let Err(fault) = outcome {
            self.leave_running(Mode::Faulted(fault), programs, machine);
        }
        work
    }

    fn leave_running<P: Planner, D: Drive>(
        &mut self,
        mode: Mode,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) {
        self.mode = mode;
        programs.stopped(mode.fault());
        // The current scan; between scans, the last one.
        machine.power_off(self.next_scan.saturating_sub(1));
    }

    fn run_all<P: Planner, D: Drive>(
        &mut self,
        time: ScanTime,
        tick: u64,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
        work: &mut Work,
    ) -> Result<(), Fault> {
        // Executions only leave the waiting list during a scan, so it is sorted once.
        self.waiting.clear();
        let waiting = self.tasks.iter().enumerate();
        let waiting =
            waiting.filter_map(|(index, task)| Some((task.priority, task.waiting_since()?, TaskId(index))));
        self.waiting.extend(waiting);
        self.waiting.sort_unstable();
        for place in 0..self.waiting.len() {
            let Some(&(_, _, id)) = self.waiting.get(place) else {
                break;
            };
            let took_ns = self.run_programs(Some(id), time, programs, machine)?;
            work.used_ns = work.used_ns.saturating_add(took_ns);
            work.executions += 1;
            let free_from = self.tick_after(tick, work.used_ns);
            let Some(task) = self.tasks.get_mut(id.0) else {
                break;
            };
            let ended = task.end(free_from, took_ns);
            work.overruns += usize::from(ended.overrun);
            if let Some(limit_ns) = ended.fired {
                return Err(Fault::Watchdog {
                    scan: time.scan,
                    task: id,
                    took_ns,
                    limit_ns,
                });
            }
        }
        let took_ns = self.run_programs(None, time, programs, machine)?;
        work.used_ns = work.used_ns.saturating_add(took_ns);
        Ok(())
    }

    /// Runs the programs of `task`, or those without a task, in declaration order. Returns the time they
    /// took together (ns).
    fn run_programs<P: Planner, D: Drive>(
        &self,
        task: Option<TaskId>,
        time: ScanTime,
        programs: &mut impl Programs<P, D>,
        machine: &mut Machine<P, D>,
    ) -> Result<u64, Fault> {
        let mut used_ns = 0_u64;
        let place = task.map_or(self.tasks.len(), |task| task.0);
        for &program in self.by_task.get(place).into_iter().flatten() {
            let mut context = machine.context(time, RUNTIME);
            let took_ns = programs
                .run(program, &mut context)
                .map_err(|fault| Fault::Program {
                    scan: time.scan,
                    task,
                    program,
                    reason: fault.reason,
                })?;
            used_ns = used_ns.saturating_add(took_ns);
        }
        Ok(used_ns)
    }

    /// The first tick not before the end of work that began at `tick` and took `used_ns`.
    fn tick_after(&self, tick: u64, used_ns: u64) -> u64 {
        tick.saturating_add(used_ns.div_ceil(self.base_tick_ns.get()))
    }
}
