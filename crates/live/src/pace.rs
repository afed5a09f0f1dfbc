//! One scan in each period, and the handling of overruns.

use crate::timing::Timing;
use standstill_script::{RunError, Session};

/// A clock that can wait.
pub trait Clock {
    /// Time since some fixed instant (ns); it never goes back.
    fn now_ns(&mut self) -> u64;
    /// Returns at this instant (ns) or later; at once if it has passed.
    fn sleep_until_ns(&mut self, instant_ns: u64);
}

/// The reaction to an overrun.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum OnOverrun {
    /// It is counted, and the scans continue: a move takes longer by the skipped periods.
    #[default]
    Continue,
    /// The programs stop, and all axes stop and switch off.
    Stop,
}

/// The end of a run.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Ended {
    /// The script ended.
    Script,
    /// It was stopped before.
    Stopped {
        /// The reason.
        why: Stopped,
        /// The scan after which the programs stopped.
        after: u64,
    },
}

/// The reason why a run was stopped.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stopped {
    /// A stop was requested.
    Asked(&'static str),
    /// A scan was not over when the next one was due.
    Overrun,
}

/// The longest ramp down (ns of scans): a drive that never confirms must not keep the program running.
pub const RAMP_NS_MAX: u64 = 60_000_000_000;

/// Runs a session, one scan in every period of `timing`, until the script ends or all axes are off after a stop.
///
/// The scans do not know the clock: each is one nominal interval of motion. So a late or skipped period
/// stretches a move and never enlarges a step of a set-point. A scan that is not over when the next one
/// is due is an overrun. The periods that have passed are skipped, so scans stay on the grid of the first
/// one and never follow one another without a pause.
///
/// `asked` is called after every scan; the first name it returns stops the run. After that, further names
/// and overruns change nothing. After [`RAMP_NS_MAX`] worth of scans it returns even if axes are not off
/// ([`Session::not_off`]).
///
/// # Errors
/// Those of [`Session::advance`].
pub fn pace(
    session: &mut Session<'_>,
    clock: &mut impl Clock,
    on_overrun: OnOverrun,
    mut asked: impl FnMut() -> Option<&'static str>,
    timing: &mut Timing,
) -> Result<Ended, RunError> {
    let period_ns = timing.period_ns();
    let mut ended = Ended::Script;
    let mut left = RAMP_NS_MAX / period_ns;
    let mut due_ns = clock.now_ns().saturating_add(period_ns);
    while !session.is_over() {
        if matches!(ended, Ended::Stopped { .. }) {
            if left == 0 {
                break;
            }
            left -= 1;
        }
        clock.sleep_until_ns(due_ns);
        let woke_ns = clock.now_ns();
        let scan = session.scans();
        session.advance()?;
        let skipped = timing.record(scan, due_ns, woke_ns, clock.now_ns());
        session.keep_up();
        due_ns = due_ns.saturating_add(period_ns.saturating_mul(skipped.saturating_add(1)));
        if ended != Ended::Script || session.is_over() {
            continue;
        }
        let why = match asked() {
            Some(name) => Stopped::Asked(name),
            None if skipped > 0 && on_overrun == OnOverrun::Stop => Stopped::Overrun,
            None => continue,
        };
        ended = Ended::Stopped { why, after: scan };
        match why {
            Stopped::Asked(name) => session.stop(&format!("stopped by {name}: axes stop and switch off")),
            Stopped::Overrun => session.stop("stopped by an overrun: axes stop and switch off"),
        }
    }
    Ok(ended)
}
