//! `standstill live`: a script as a cyclic task.

use crate::args::LiveArguments;
use crate::exit::{Exit, Failure};
use std::io::Write;

/// The replacement on systems without real-time support.
#[cfg(not(target_os = "linux"))]
pub fn live(_: &LiveArguments, _: &mut dyn Write) -> Result<Exit, Failure> {
    Err(Failure::usage(
        "live is unsupported on this system: it needs Linux; `standstill run` gives the same trace without the clock",
    ))
}

#[cfg(target_os = "linux")]
pub use linux::live;

#[cfg(target_os = "linux")]
mod linux {
    use super::*;
    use crate::apart;
    use crate::args;
    use crate::exit::complain;
    use crate::limit;
    use crate::run::{failing_claims, failure, verdict};
    use serde_json::{Map, json};
    use standstill_live::{Ended, OnOverrun, Stopped, System, Timing, pace};
    use standstill_script::suite::{self, SuiteError, shown};
    use standstill_script::{RunError, Session};
    use standstill_trace::csv::Dialect;
    use standstill_trace::digest;
    use standstill_trace::file::{Draft, Saving};

    /// Runs the script in real time. Events and times go to files; the last line is that of `run`.
    pub fn live(arguments: &LiveArguments, out: &mut dyn Write) -> Result<Exit, Failure> {
        let LiveArguments {
            script: path,
            period,
            set,
            outside,
            ..
        } = arguments;
        let timing = apart::written("--timing", arguments.timing.as_deref());
        let writes = [apart::trace(arguments.trace.as_deref())?, timing];
        apart::checked(&writes.concat(), [path.as_path()])?;
        let name = shown(path);
        limit::doing(format!("reading {name}"));
        let (script, _) = suite::read_file(path, set, &outside.allowed()).map_err(failure)?;
        let cycle = script.cycle_ns.unsigned_abs();
        if cycle != *period {
            return Err(Failure::usage(&format!(
                "--period {period} ns: the cycle of {name} is {cycle} ns, and a scan moves axes by one cycle, so at \
                 another pace every velocity would be another; write `--period {cycle}ns`, or change `cycle` in the script"
            )));
        }
        let wrong = |source: RunError| {
            Failure::from(SuiteError::Run {
                path: path.clone(),
                source,
            })
        };
        let mut session = Session::new(&script).map_err(wrong)?;
        session.reserve();
        // A file that cannot be written is detected now, not after the run.
        let saving = arguments.trace.as_deref().map(Saving::begin).transpose()?;
        let times = arguments.timing.as_deref().map(Draft::begin).transpose()?;
        limit::doing(format!("{name}, paced"));
        let mut timing = Timing::new(*period);
        let system = System::prepare().map_err(|error| Failure::io("signals", &error))?;
        for lack in system.lacks() {
            complain(&format!("{name}: {lack}"));
        }
        let on_overrun = match arguments.on_overrun {
            args::OnOverrun::Continue => OnOverrun::Continue,
            args::OnOverrun::Stop => OnOverrun::Stop,
        };
        let ended = pace(
            &mut session,
            &mut &system,
            on_overrun,
            || system.asked(),
            &mut timing,
        );
        let mut about = Map::new();
        about.insert("script".to_owned(), json!(name));
        about.insert("ended".to_owned(), json!(told(&ended)));
        about.insert("system".to_owned(), system.to_json());
        drop(system);
        tell(&name, &timing);
        if let Some(times) = times {
            let text = format!("{:#}\n", timing.to_json(&about));
            times.finish(|out| out.write_all(text.as_bytes()))?;
        }
        let ended = ended.map_err(wrong)?;
        let on = session
            .not_off()
            .map(|(axis, state)| format!("axis {axis} is still in {state}"));
        let scans = session.scans();
        let (trace, exit) = match ended {
            Ended::Script => {
                let outcome = session.finish();
                write!(out, "{}", failing_claims(&outcome))?;
                writeln!(
                    out,
                    "{name}: {}",
                    verdict(&outcome, digest::whole(&outcome.trace))
                )?;
                let exit = Exit::of(outcome.passed());
                (outcome.trace, exit)
            }
            Ended::Stopped { why, after } => {
                let trace = session.into_trace();
                let digest = digest::whole(&trace);
                let ramp = scans.saturating_sub(after + 1);
                let how = on.as_deref().unwrap_or("all axes are off");
                let cause = cause(why);
                writeln!(
                    out,
                    "{name}: stopped by {cause} after scan {after}, then {ramp} scans to switch off: {how}, \
                     digest {digest:016x}"
                )?;
                (trace, Exit::of(on.is_none() && why != Stopped::Overrun))
            }
        };
        if let Some(saving) = saving {
            saving.finish(&trace, Dialect::default())?;
        }
        Ok(exit)
    }

    fn cause(why: Stopped) -> &'static str {
        match why {
            Stopped::Asked(signal) => signal,
            Stopped::Overrun => "an overrun",
        }
    }

    fn told(ended: &Result<Ended, RunError>) -> String {
        match ended {
            Ok(Ended::Script) => "script".to_owned(),
            Ok(Ended::Stopped { why, after }) => format!("{} after scan {after}", cause(*why)),
            Err(error) => format!("error: {error}"),
        }
    }

    /// Text that differs from run to run belongs on standard error.
    fn tell(name: &str, timing: &Timing) {
        let us = |ns: u64| ns as f64 / 1e3;
        let (wake, scan) = (timing.wake_latency(), timing.scan_time());
        complain(&format!(
            "{name}: {} scans; woken late by {:.1} us (median), {:.1} us (99 %), {:.1} us (most); a scan took {:.1} us \
             (median), {:.1} us (most); {} overruns, {} periods skipped",
            scan.count(),
            us(wake.quantile_ns(0.5)),
            us(wake.quantile_ns(0.99)),
            us(wake.max_ns()),
            us(scan.quantile_ns(0.5)),
            us(scan.max_ns()),
            timing.overruns(),
            timing.skipped(),
        ));
    }
}
