//! One task: when it is released, and how periods it could not keep are counted.
//!
//! All times are base ticks since the start, so jitter of the scan's instant never shifts a task.

use crate::{TaskConfig, Watchdog};
use alloc::string::String;
use core::num::NonZero;

/// What a task did since the start.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct TaskCounts {
    /// Executions.
    pub executions: u64,
    /// Executions at whose end the next due time had passed.
    pub overruns: u64,
    /// Periods without an execution of their own. Causes: an execution lasted longer, the processing unit
    /// was busy, or no scan came in time. Periods suspended by SINGLE do not count.
    pub skipped: u64,
}

/// A task at run time.
#[derive(Clone, Debug)]
pub(crate) struct Task {
    pub(crate) name: String,
    pub(crate) priority: u32,
    pub(crate) has_single: bool,
    /// Interval (ticks).
    interval: Option<NonZero<u64>>,
    watchdog: Option<Watchdog>,
    state: State,
}

/// What a start resets.
#[derive(Clone, Copy, Debug, Default)]
struct State {
    /// Next tick of the phase grid that has not come yet; the grid begins at tick 0.
    next_due: u64,
    /// Due since this tick and not executed yet.
    waiting_since: Option<u64>,
    /// SINGLE at the last sample.
    single: bool,
    /// Watchdog violations in a row.
    violations: u32,
    counts: TaskCounts,
}

/// How an execution ended.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(crate) struct Ended {
    pub(crate) overrun: bool,
    /// The limit that was exceeded, if the watchdog stops the resource.
    pub(crate) fired: Option<u64>,
}

impl Task {
    pub(crate) fn new(config: &TaskConfig, base_tick_ns: u64) -> Self {
        Self {
            name: config.name.clone(),
            priority: config.priority,
            has_single: config.single,
            interval: NonZero::new(config.interval_ns.checked_div(base_tick_ns).unwrap_or(0)),
            watchdog: config.watchdog,
            state: State::default(),
        }
    }

    /// Returns to the state before the first tick.
    pub(crate) fn restart(&mut self) {
        self.state = State::default();
    }

    pub(crate) fn waiting_since(&self) -> Option<u64> {
        self.state.waiting_since
    }

    pub(crate) fn counts(&self) -> TaskCounts {
        self.state.counts
    }

    /// Makes the task wait for execution if `tick` or an edge of `single` makes it due.
    pub(crate) fn release(&mut self, tick: u64, single: bool) {
        let edge = single && !self.state.single;
        self.state.single = single;
        let due = self.state.next_due;
        let periods = self.pass(tick.saturating_add(1));
        let waiting = self.state.waiting_since;
        if single {
            // Periods are suspended, not missed.
            if edge {
                self.state.waiting_since = waiting.or(Some(tick));
            }
        } else if periods > 0 {
            self.state.waiting_since = waiting.or(Some(due));
            let own_execution = u64::from(waiting.is_none());
            self.state.counts.skipped += periods - own_execution;
        }
    }

    /// Ends an execution that took `took_ns`; the processing unit is free from tick `free_from` on.
    pub(crate) fn end(&mut self, free_from: u64, took_ns: u64) -> Ended {
        let passed = self.pass(free_from);
        let missed = if self.state.single { 0 } else { passed };
        let overrun = missed > 0;
        self.state.waiting_since = None;
        self.state.counts.executions += 1;
        self.state.counts.overruns += u64::from(overrun);
        self.state.counts.skipped += missed;
        let violated = self.watchdog.filter(|watchdog| took_ns > watchdog.limit_ns);
        self.state.violations = violated.map_or(0, |_| self.state.violations.saturating_add(1));
        Ended {
            overrun,
            fired: violated
                .filter(|watchdog| self.state.violations >= watchdog.sensitivity)
                .map(|watchdog| watchdog.limit_ns),
        }
    }

    /// Whether the task is due in every tick, `tick` was the last one, and no execution is waiting.
    pub(crate) fn is_even(&self, tick: u64) -> bool {
        let is_due = self.interval.is_some_and(|interval| interval.get() == 1);
        let was_due = self.state.next_due == tick.saturating_add(1) && self.state.waiting_since.is_none();
        is_due && was_due && !self.has_single
    }

    /// Counts one execution, which took no time, in each of the next `ticks`.
    pub(crate) fn go_on(&mut self, ticks: u64) {
        self.state.next_due = self.state.next_due.saturating_add(ticks);
        self.state.counts.executions = self.state.counts.executions.saturating_add(ticks);
        self.state.violations = 0;
    }

    /// Moves `next_due` along the phase grid to the first point not before `tick`. Returns the number of
    /// points passed.
    fn pass(&mut self, tick: u64) -> u64 {
        let Some(interval) = self.interval else {
            return 0;
        };
        let passed = tick.saturating_sub(self.state.next_due).div_ceil(interval.get());
        let distance = passed.saturating_mul(interval.get());
        self.state.next_due = self.state.next_due.saturating_add(distance);
        passed
    }
}
