//! Declarations of tasks and programs, and the check that finds their defects.

use alloc::collections::{BTreeMap, BTreeSet};
use alloc::string::String;
use core::fmt;

/// When a resource stops because a task takes too long.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Watchdog {
    /// Longest permitted execution of the task (ns), all its programs together; at least 1.
    pub limit_ns: u64,
    /// Fires after this many violations in a row; at least 1.
    pub sensitivity: u32,
}

/// A task as declared.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct TaskConfig {
    /// IEC identifier, unique without regard to case.
    pub name: String,
    /// INTERVAL (ns), a whole multiple of the base tick; 0 has no periodic execution.
    pub interval_ns: u64,
    /// PRIORITY; 0 is the highest.
    pub priority: u32,
    /// SINGLE is bound: a rising edge executes the task once. There is no periodic execution while it is
    /// TRUE.
    pub single: bool,
    /// Watchdog, if any.
    pub watchdog: Option<Watchdog>,
}

impl TaskConfig {
    /// A periodic task of the highest priority, without watchdog.
    pub fn every(name: &str, interval_ns: u64) -> Self {
        Self {
            name: name.into(),
            interval_ns,
            priority: 0,
            single: false,
            watchdog: None,
        }
    }
}

/// A program instance as declared. Function block instances cannot be bound to tasks of their own.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct ProgramConfig {
    /// IEC identifier, unique without regard to case.
    pub name: String,
    /// Its task; `None` runs once a scan, after all tasks.
    pub task: Option<String>,
}

impl ProgramConfig {
    /// `PROGRAM name WITH task`.
    pub fn with(name: &str, task: &str) -> Self {
        Self {
            name: name.into(),
            task: Some(task.into()),
        }
    }

    /// `PROGRAM name`, without a task.
    pub fn free(name: &str) -> Self {
        Self {
            name: name.into(),
            task: None,
        }
    }
}

/// The greatest common divisor of all intervals (ns): the slowest base tick they allow. `None` if no task
/// is periodic.
pub fn common_tick_ns(tasks: &[TaskConfig]) -> Option<u64> {
    let divisor = tasks
        .iter()
        .map(|task| task.interval_ns)
        .fold(0, greatest_common_divisor);
    (divisor > 0).then_some(divisor)
}

/// Euclid's algorithm; at most 93 steps for 64-bit numbers.
fn greatest_common_divisor(mut a: u64, mut b: u64) -> u64 {
    while b > 0 {
        (a, b) = (b, a % b);
    }
    a
}

/// Why an executor was not set up.
#[derive(Clone, Debug, PartialEq, Eq)]
#[non_exhaustive]
pub enum ConfigError {
    /// The base tick is 0.
    BaseTick,
    /// Two tasks have one name.
    DuplicateTask {
        /// The name.
        name: String,
    },
    /// Two program instances have one name.
    DuplicateProgram {
        /// The name.
        name: String,
    },
    /// A program names a task that is not declared.
    UnknownTask {
        /// The program instance.
        program: String,
        /// The task it names.
        task: String,
    },
    /// An interval is not a whole multiple of the base tick.
    Interval {
        /// The task.
        task: String,
        /// Its interval (ns).
        interval_ns: u64,
        /// The base tick (ns).
        base_tick_ns: u64,
        /// A base tick that fits all tasks (ns).
        fitting_ns: u64,
    },
    /// A task has neither an interval nor SINGLE.
    NeverRuns {
        /// The task.
        task: String,
    },
    /// A watchdog with a limit or sensitivity of 0.
    Watchdog {
        /// The task.
        task: String,
        /// Its watchdog.
        watchdog: Watchdog,
    },
}

impl fmt::Display for ConfigError {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::BaseTick => write!(f, "the base tick is 0 ns: it must be at least 1 ns"),
            Self::DuplicateTask { name } => {
                write!(
                    f,
                    "two tasks are called {name}: rename one (case makes no difference)"
                )
            }
            Self::DuplicateProgram { name } => {
                write!(
                    f,
                    "two programs are called {name}: rename one (case makes no difference)"
                )
            }
            Self::UnknownTask { program, task } => {
                write!(
                    f,
                    "program {program} names task {task}, which is not declared: declare it or name another"
                )
            }
            Self::Interval {
                task,
                interval_ns,
                base_tick_ns,
                fitting_ns,
            } => write!(
                f,
                "the interval of task {task} is {interval_ns} ns, no whole multiple of the base tick of \
                 {base_tick_ns} ns: change it, or use a base tick of {fitting_ns} ns"
            ),
            Self::NeverRuns { task } => {
                write!(f, "task {task} would never run: give it an interval or SINGLE")
            }
            Self::Watchdog { task, watchdog } => write!(
                f,
                "the watchdog of task {task} has a limit of {} ns and sensitivity {}: both must be at least 1",
                watchdog.limit_ns, watchdog.sensitivity
            ),
        }
    }
}

impl core::error::Error for ConfigError {}

/// Checks all declarations; the first defect in declaration order is reported.
pub(crate) fn check(
    base_tick_ns: u64,
    tasks: &[TaskConfig],
    programs: &[ProgramConfig],
) -> Result<(), ConfigError> {
    if base_tick_ns == 0 {
        return Err(ConfigError::BaseTick);
    }
    let mut names = BTreeSet::new();
    for task in tasks {
        if !names.insert(upper(&task.name)) {
            return Err(ConfigError::DuplicateTask {
                name: task.name.clone(),
            });
        }
        if task.interval_ns == 0 && !task.single {
            return Err(ConfigError::NeverRuns {
                task: task.name.clone(),
            });
        }
        if !task.interval_ns.is_multiple_of(base_tick_ns) {
            return Err(ConfigError::Interval {
                task: task.name.clone(),
                interval_ns: task.interval_ns,
                base_tick_ns,
                fitting_ns: common_tick_ns(tasks).map_or(task.interval_ns, |tick| {
                    greatest_common_divisor(tick, base_tick_ns)
                }),
            });
        }
        if let Some(watchdog) = task.watchdog
            && (watchdog.limit_ns == 0 || watchdog.sensitivity == 0)
        {
            return Err(ConfigError::Watchdog {
                task: task.name.clone(),
                watchdog,
            });
        }
    }
    let mut programs_named = BTreeSet::new();
    for program in programs {
        if !programs_named.insert(upper(&program.name)) {
            return Err(ConfigError::DuplicateProgram {
                name: program.name.clone(),
            });
        }
        if let Some(task) = &program.task
            && !names.contains(&upper(task))
        {
            return Err(ConfigError::UnknownTask {
                program: program.name.clone(),
                task: task.clone(),
            });
        }
    }
    Ok(())
}

/// The tasks by name, without regard to case as IEC identifiers are.
pub(crate) fn by_name(tasks: &[TaskConfig]) -> BTreeMap<String, usize> {
    let tasks = tasks.iter().enumerate();
    tasks.map(|(index, task)| (upper(&task.name), index)).collect()
}

/// The name in upper case: names that differ in case only are equal.
pub(crate) fn upper(name: &str) -> String {
    name.to_ascii_uppercase()
}
