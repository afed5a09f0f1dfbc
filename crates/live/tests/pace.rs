//! The pacing under a test clock: late and skipped scans, without any effect on the motion.

use standstill_live::{Clock, Ended, OnOverrun, Overrun, Stopped, Timing, pace};
use standstill_script::{Outcome, Session, model::Script, read, run};
use standstill_trace::{Cell, Trace, digest};

const MS: u64 = 1_000_000;

/// A clock on which a test sets the times of waking and scanning.
struct Scripted {
    now_ns: u64,
    /// The delay with which the sleep of this number wakes (ns).
    late: fn(u64) -> u64,
    /// The duration of the scan after it (ns).
    takes: fn(u64) -> u64,
    /// The instants to which it slept.
    slept: Vec<u64>,
    looks: u32,
}

impl Scripted {
    fn new(late: fn(u64) -> u64, takes: fn(u64) -> u64) -> Self {
        Self {
            now_ns: 5,
            late,
            takes,
            slept: Vec::new(),
            looks: 0,
        }
    }

    fn sleeps(&self) -> u64 {
        self.slept.len() as u64
    }
}

impl Clock for Scripted {
    fn now_ns(&mut self) -> u64 {
        // The second look after a sleep is that at the end of a scan.
        if self.looks == 1 {
            self.now_ns += (self.takes)(self.sleeps() - 1);
        }
        self.looks += 1;
        self.now_ns
    }

    fn sleep_until_ns(&mut self, instant_ns: u64) {
        self.now_ns = self.now_ns.max(instant_ns) + (self.late)(self.sleeps());
        self.slept.push(instant_ns);
        self.looks = 0;
    }
}

/// A move from scan 1 on: it reaches 10 mm/s in 0.1 s, which is 0.1 mm a scan.
fn script(scans: u64, deceleration: f64) -> Script {
    let text = format!(
        r#"{{"standstill": 1, "cycle": "T#10ms", "scans": {scans},
        "axes": {{"X": {{"limits": {{"velocity": 20, "acceleration": 100, "deceleration": {deceleration}}}, "state": "Standstill"}}}},
        "inputs": {{"GO": false}},
        "blocks": [{{"name": "move", "type": "MC_MoveVelocity",
            "pins": {{"Axis": "X", "Execute": {{"from": "GO"}}, "Velocity": 10}}}}],
        "steps": [{{"at": 1, "set": {{"GO": true}}}}]}}"#
    );
    read(&text, "paced.scan.json", &[]).expect("a script")
}

fn paced(
    script: &Script,
    clock: &mut Scripted,
    on_overrun: OnOverrun,
    asked: impl FnMut() -> Option<&'static str>,
) -> (Ended, Outcome, Timing, Option<String>) {
    let mut session = Session::new(script).expect("a session");
    session.reserve();
    let mut timing = Timing::new(10 * MS);
    let ended = pace(&mut session, clock, on_overrun, asked, &mut timing).expect("a run");
    let on = session.not_off().map(|(axis, state)| format!("{axis} {state}"));
    (ended, session.finish(), timing, on)
}

fn positions(trace: &Trace) -> Vec<f64> {
    trace
        .reals(trace.column("X.Position").expect("a column"))
        .collect()
}

fn last_state(trace: &Trace) -> &str {
    let column = trace.column("X.State").expect("a column");
    match trace.cell(trace.scans() - 1, column) {
        Some(Cell::Name(name)) => name,
        other => panic!("no state: {other:?}"),
    }
}

/// No step is longer than that of full speed, and none goes back.
fn assert_steps_of_single_scans(trace: &Trace) {
    for pair in positions(trace).windows(2) {
        let step = pair[1] - pair[0];
        assert!((0.0..=0.1 + 1e-9).contains(&step), "{pair:?}");
    }
}

#[test]
fn late_scans_stay_on_the_grid_and_leave_no_mark_in_the_trace() {
    let script = script(40, 100.0);
    let late = |number| match number {
        10 => 12 * MS,
        20 => 3 * MS,
        _ => 50_000,
    };
    let takes = |number| if number == 5 { 25 * MS } else { MS };
    let mut clock = Scripted::new(late, takes);
    let (ended, outcome, timing, _) = paced(&script, &mut clock, OnOverrun::Continue, || None);
    assert_eq!(ended, Ended::Script);
    let undisturbed = run(&script).expect("a run");
    assert_eq!(digest::whole(&outcome.trace), digest::whole(&undisturbed.trace));
    assert_eq!(outcome.trace.header_json(), undisturbed.trace.header_json());
    assert_steps_of_single_scans(&outcome.trace);

    // The first scan is due a period after the start, the others on its grid; 2 and 1 periods are left out.
    let mut grid: Vec<_> = (1..=43).map(|tick| 5 + tick * 10 * MS).collect();
    grid.drain(6..8);
    grid.remove(11);
    assert_eq!(clock.slept, grid);
    assert_eq!((timing.overruns(), timing.skipped()), (2, 3));
    let expected = [
        Overrun {
            scan: 5,
            wake_latency_ns: 50_000,
            scan_time_ns: 25 * MS,
            skipped: 2,
        },
        Overrun {
            scan: 10,
            wake_latency_ns: 12 * MS,
            scan_time_ns: MS,
            skipped: 1,
        },
    ];
    assert_eq!(timing.first_overruns(), expected);
    assert_eq!(
        (timing.wake_latency().count(), timing.wake_latency().max_ns()),
        (40, 12 * MS)
    );
    let median = timing.wake_latency().quantile_ns(0.5);
    assert!((50_000..=50_500).contains(&median), "{median}");
    assert_eq!(timing.scan_time().max_ns(), 25 * MS);
}

#[test]
fn a_scan_that_ends_as_the_next_is_due_is_no_overrun() {
    let script = script(10, 100.0);
    let mut clock = Scripted::new(|_| 0, |number| if number == 4 { 10 * MS } else { MS });
    let (_, _, timing, _) = paced(&script, &mut clock, OnOverrun::Continue, || None);
    assert_eq!((timing.overruns(), timing.skipped()), (0, 0));
    let mut clock = Scripted::new(|_| 0, |number| if number == 4 { 10 * MS + 1 } else { MS });
    let (_, _, timing, _) = paced(&script, &mut clock, OnOverrun::Continue, || None);
    assert_eq!((timing.overruns(), timing.skipped()), (1, 1));
}

#[test]
fn an_overrun_ramps_down_past_the_end_of_the_script_when_it_is_to_stop() {
    let script = script(15, 100.0);
    let mut clock = Scripted::new(|_| 0, |number| if number == 13 { 11 * MS } else { MS });
    let (ended, outcome, timing, on) = paced(&script, &mut clock, OnOverrun::Stop, || None);
    assert_eq!(
        ended,
        Ended::Stopped {
            why: Stopped::Overrun,
            after: 13
        }
    );
    assert_eq!(on, None);
    assert_eq!(timing.overruns(), 1);
    let trace = &outcome.trace;
    assert_eq!(last_state(trace), "Disabled");
    // From 10 mm/s at 100 mm/s^2 it takes 10 scans to rest.
    assert!((24..30).contains(&trace.scans()), "{}", trace.scans());
    assert_steps_of_single_scans(trace);
    let notes: Vec<_> = trace
        .notes()
        .iter()
        .filter(|note| note.subject == "run")
        .collect();
    assert!(
        matches!(&*notes, [note] if note.scan == 13 && note.text.contains("overrun")),
        "{notes:?}"
    );
    // Up to there it is the run without a stop.
    let undisturbed = run(&script).expect("a run");
    assert_eq!(positions(trace)[..14], positions(&undisturbed.trace)[..14]);
}

#[test]
fn who_is_asked_to_stop_ramps_down_once() {
    let script = script(1000, 50.0);
    let mut asked = 0;
    let (ended, outcome, _, on) = paced(
        &script,
        &mut Scripted::new(|_| 0, |_| MS),
        OnOverrun::Continue,
        || {
            asked += 1;
            (asked > 20).then_some("SIGTERM")
        },
    );
    assert_eq!(
        ended,
        Ended::Stopped {
            why: Stopped::Asked("SIGTERM"),
            after: 20
        }
    );
    assert_eq!((on, last_state(&outcome.trace)), (None, "Disabled"));
    assert!(
        (40..46).contains(&outcome.trace.scans()),
        "{}",
        outcome.trace.scans()
    );
    assert_steps_of_single_scans(&outcome.trace);
}

#[test]
fn a_ramp_without_an_end_is_given_up_and_named() {
    // 10 mm/s at 0.1 mm/s^2 would take 100 s.
    let script = script(1000, 0.1);
    let (_, outcome, _, on) = paced(&script, &mut Scripted::new(|_| 0, |_| MS), OnOverrun::Continue, {
        let mut scans = 0;
        move || {
            scans += 1;
            (scans > 20).then_some("SIGINT")
        }
    });
    assert!(on.is_some_and(|on| on.starts_with("X ")));
    assert_eq!(outcome.trace.scans(), 21 + 6000);
}
