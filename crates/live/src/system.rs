//! The services of Linux for a cyclic task: a clock, a scheduling policy, locked memory, signals.

use crate::pace::Clock;
use rustix::mm::{MlockAllFlags, mlockall, munlockall};
use rustix::process::{Resource, getrlimit};
use rustix::thread::clock_nanosleep_absolute;
use rustix::time::{ClockId, Timespec, clock_gettime};
use serde_json::{Value, json};
use signal_hook::consts::{SIGHUP, SIGINT, SIGTERM};
use std::io;
use std::sync::Arc;
use std::sync::atomic::{AtomicUsize, Ordering};
use thread_priority::unix::{
    RealtimeThreadSchedulePolicy, ThreadSchedulePolicy, get_current_thread_priority,
    set_thread_priority_and_policy, thread_native_id, thread_schedule_policy,
};
use thread_priority::{ThreadPriority, ThreadPriorityValue};

/// The requested priority: above the interrupt threads of a PREEMPT_RT kernel (50), below watchdogs (99).
const PRIORITY: u8 = 80;

/// The signals that request a stop.
const SIGNALS: [(i32, &str); 3] = [(SIGINT, "SIGINT"), (SIGTERM, "SIGTERM"), (SIGHUP, "SIGHUP")];

/// The scheduling of the calling thread.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Scheduling {
    /// Real-time, with this priority; `kept` if it was so before.
    RealTime {
        /// 1 to 99.
        priority: u8,
        /// It was set from outside (chrt, systemd).
        kept: bool,
    },
    /// Like any other program, for this reason.
    Normal(String),
}

/// The memory that cannot be paged out.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Memory {
    /// All of it, including future memory.
    All,
    /// The memory of the process before its first scan, which is all that a run is known to need. Later
    /// memory is not locked, because under a limit an allocation beyond it would fail.
    Present,
    /// None, because of this.
    None(String),
}

/// The calling thread as a cyclic task; memory is unlocked when this is dropped.
#[derive(Debug)]
pub struct System {
    /// The scheduling of the thread.
    pub scheduling: Scheduling,
    /// The locked memory.
    pub memory: Memory,
    signal: Arc<AtomicUsize>,
}

impl System {
    /// Makes signals wait for a scan instead of ending the process, then asks for real-time scheduling
    /// and locked memory. A request that is not permitted is left out, with the reason. Call it after
    /// memory for the run was reserved.
    ///
    /// # Errors
    /// A signal cannot be taken.
    pub fn prepare() -> io::Result<Self> {
        let signal = Arc::new(AtomicUsize::new(0));
        for (number, (what, _)) in (1..).zip(SIGNALS) {
            signal_hook::flag::register_usize(what, Arc::clone(&signal), number)?;
        }
        Ok(Self {
            scheduling: schedule(),
            memory: lock(),
            signal,
        })
    }

    /// The last signal that requested a stop.
    #[must_use]
    pub fn asked(&self) -> Option<&'static str> {
        let number = self.signal.load(Ordering::Relaxed).checked_sub(1)?;
        SIGNALS.get(number).map(|(_, name)| *name)
    }

    /// The missing parts of real time, for people.
    #[must_use]
    pub fn lacks(&self) -> Vec<String> {
        let scheduling = match &self.scheduling {
            Scheduling::Normal(why) => Some(format!(
                "no real-time scheduling ({why}): other programs delay scans; allow it with `LimitRTPRIO` or `ulimit -r`"
            )),
            Scheduling::RealTime { .. } => None,
        };
        let memory = match &self.memory {
            Memory::None(why) => Some(format!(
                "memory is not locked ({why}): paging delays scans; allow it with `LimitMEMLOCK` or `ulimit -l`"
            )),
            Memory::All | Memory::Present => None,
        };
        scheduling.into_iter().chain(memory).collect()
    }

    /// Its entry in the timing file.
    #[must_use]
    pub fn to_json(&self) -> Value {
        let name = rustix::system::uname();
        let scheduling = match &self.scheduling {
            Scheduling::RealTime { priority, kept } => {
                json!({"policy": "real-time", "priority": priority, "given": kept})
            }
            Scheduling::Normal(why) => json!({"policy": "normal", "why": why}),
        };
        let memory = match &self.memory {
            Memory::All => json!({"locked": "all"}),
            Memory::Present => json!({"locked": "present"}),
            Memory::None(why) => json!({"locked": "none", "why": why}),
        };
        json!({
            "kernel": name.release().to_string_lossy(),
            "kernel_version": name.version().to_string_lossy(),
            "scheduling": scheduling,
            "memory": memory,
        })
    }
}

impl Drop for System {
    fn drop(&mut self) {
        if matches!(self.memory, Memory::All | Memory::Present) {
            // Nothing depends on it: locked memory ends with the process.
            munlockall().ok();
        }
    }
}

impl Clock for &System {
    fn now_ns(&mut self) -> u64 {
        let now = clock_gettime(ClockId::Monotonic);
        let seconds = u64::try_from(now.tv_sec).unwrap_or_default();
        let rest = u64::try_from(now.tv_nsec).unwrap_or_default();
        seconds.saturating_mul(1_000_000_000).saturating_add(rest)
    }

    fn sleep_until_ns(&mut self, instant_ns: u64) {
        let instant = Timespec {
            tv_sec: (instant_ns / 1_000_000_000).cast_signed(),
            tv_nsec: (instant_ns % 1_000_000_000).cast_signed(),
        };
        // A signal interrupts the sleep; the rest has the same end.
        while clock_nanosleep_absolute(ClockId::Monotonic, &instant) == Err(rustix::io::Errno::INTR) {}
    }
}

fn schedule() -> Scheduling {
    if let (Ok(ThreadSchedulePolicy::Realtime(_)), Ok(ThreadPriority::Crossplatform(given))) =
        (thread_schedule_policy(), get_current_thread_priority())
    {
        return Scheduling::RealTime {
            priority: given.into(),
            kept: true,
        };
    }
    let limit = getrlimit(Resource::Rtprio).current.unwrap_or(PRIORITY.into());
    let allowed = u8::try_from(limit).unwrap_or(PRIORITY).min(PRIORITY);
    let mut why = String::new();
    // Root may exceed the limit; others may come up to it.
    for priority in [PRIORITY, allowed] {
        match ask_for(priority) {
            Ok(()) => {
                return Scheduling::RealTime {
                    priority,
                    kept: false,
                };
            }
            Err(error) => why = error,
        }
        if allowed == 0 {
            break;
        }
    }
    Scheduling::Normal(why)
}

fn ask_for(priority: u8) -> Result<(), String> {
    let value = ThreadPriorityValue::try_from(priority).map_err(|error| format!("{error:?}"))?;
    set_thread_priority_and_policy(
        thread_native_id(),
        ThreadPriority::Crossplatform(value),
        ThreadSchedulePolicy::Realtime(RealtimeThreadSchedulePolicy::Fifo),
    )
    .map_err(|error| match error {
        thread_priority::Error::OS(code) => io::Error::from_raw_os_error(code).to_string(),
        other => format!("{other:?}"),
    })
}

fn lock() -> Memory {
    let unlimited = getrlimit(Resource::Memlock).current.is_none();
    let (flags, locked) = if unlimited {
        (MlockAllFlags::CURRENT | MlockAllFlags::FUTURE, Memory::All)
    } else {
        (MlockAllFlags::CURRENT, Memory::Present)
    };
    match mlockall(flags) {
        Ok(()) => locked,
        Err(error) => Memory::None(io::Error::from(error).to_string()),
    }
}
