//! The order of one scan, its instant, and its effect on drives and outputs.
//!
//! Ids: TM time, SC scan cycle, OV overrun and faults, ST starts.

use crate::common::{MS, Rig, task};
use standstill_scan::{
    Fault, Mode, ProgramConfig, ProgramFault, ScanTime, Start, TaskConfig, TaskId, TimeRanBackwards, Watchdog,
};
use std::cell::RefCell;
use std::rc::Rc;

fn two_axes() -> Rig {
    Rig::new(
        &[task("fast", 1, 0), task("slow", 2, 1)],
        &[
            ProgramConfig::with("a", "fast"),
            ProgramConfig::with("b", "slow"),
            ProgramConfig::free("c"),
        ],
        &["X", "Y"],
    )
}

/// SC-1, SC-4, SC-6, DR-1: the whole order, with each drive read and written once in axis order.
#[test]
fn a_scan_has_one_order() {
    let mut rig = two_axes();
    rig.scan_at(0);
    let order = [
        "latch",
        "read X",
        "read Y",
        "run a",
        "run b",
        "run c",
        "observe",
        "write X",
        "write Y",
        "publish",
        "published",
    ];
    assert_eq!(rig.taken_tape(), order);
}

/// SC-2, SC-5: an input that changes while programs run is latched in the next scan and published there.
#[test]
fn programs_see_the_latched_image_only() {
    struct Io {
        input: bool,
        image: bool,
        output: bool,
        published: Vec<bool>,
    }
    use standstill_axis::{IdealDrive, Standard};
    use standstill_fb::Context;
    use standstill_scan::{Executor, Machine, ProgramId, Programs};
    impl Programs<Standard, IdealDrive> for Io {
        fn latch(&mut self, _time: ScanTime, _machine: &mut Machine) {
            self.image = self.input;
        }
        fn run(&mut self, program: ProgramId, _context: &mut Context<'_>) -> Result<u64, ProgramFault> {
            if program == ProgramId(0) {
                self.input = true;
                // SC-3: an earlier writer of the same output never reaches the outside.
                self.output = !self.image;
            } else {
                self.output = self.image;
            }
            Ok(0)
        }
        fn publish(&mut self, _time: ScanTime) {
            self.published.push(self.output);
        }
    }
    let tasks = [TaskConfig::every("main", MS)];
    let programs = [
        ProgramConfig::with("first", "main"),
        ProgramConfig::with("last", "main"),
    ];
    let mut executor = Executor::new(MS, &tasks, &programs).unwrap();
    let mut io = Io {
        input: false,
        image: false,
        output: false,
        published: Vec::new(),
    };
    let mut machine = Machine::new();
    for scan in 0..3 {
        executor.scan(scan * MS as i64, &mut io, &mut machine).unwrap();
    }
    assert_eq!(io.published, [false, true, true]);
}

/// TM-1, TM-2: the time given is the only one, and it is the same for all programs of a scan.
#[test]
fn time_is_the_argument_and_constant_in_a_scan() {
    let mut rig = two_axes();
    let seen = Rc::new(RefCell::new(Vec::new()));
    let note = seen.clone();
    rig.host.script = Box::new(move |time, _| {
        note.borrow_mut().push((time.scan, time.now_ns));
        Ok(100)
    });
    rig.scan_at(-7);
    rig.scan_at(2_000_123);
    assert_eq!(
        *seen.borrow(),
        [
            (0, -7),
            (0, -7),
            (0, -7),
            (1, 2_000_123),
            (1, 2_000_123),
            (1, 2_000_123)
        ]
    );
}

/// TM-4: nothing at all happens in a refused scan; the same instant twice is no step back.
#[test]
fn time_running_backwards_is_refused() {
    let mut rig = two_axes();
    rig.scan_at(5);
    rig.taken_tape();
    let refused = rig.executor.scan(4, &mut rig.host, &mut rig.machine);
    assert_eq!(
        refused,
        Err(TimeRanBackwards {
            now_ns: 4,
            previous_ns: 5
        })
    );
    assert!(rig.taken_tape().is_empty());
    assert_eq!(rig.scan_at(5).scan, 1);
}

/// TM-3: the same instants, durations and edges give the same tape, scripted here by a fixed generator.
#[test]
fn the_same_inputs_give_the_same_tape() {
    let tape = || {
        let mut rig = Rig::of_tasks(&[
            task("a", 1, 2),
            task("b", 3, 1),
            TaskConfig {
                single: true,
                ..task("c", 2, 1)
            },
        ]);
        let mut seed = 1_u64;
        let mut random = move || {
            seed = seed
                .wrapping_mul(6364136223846793005)
                .wrapping_add(1442695040888963407);
            seed >> 33
        };
        let mut jitter = random;
        rig.host.script = Box::new(move |_, _| Ok(random() % MS));
        rig.host.single = |scan, _| scan % 7 < 2;
        let mut now = 0;
        for _ in 0..2000 {
            now += (MS / 2 + jitter() % MS) as i64;
            rig.scan_at(now);
        }
        let counts: Vec<_> = (0..3).map(|id| rig.executor.counts(TaskId(id))).collect();
        (rig.taken_tape(), counts)
    };
    assert_eq!(tape(), tape());
}

/// TM-5, TM-6: a late scan is one scan: axes and drives take one step, and the report says what is missing.
#[test]
fn missed_ticks_are_reported_and_not_made_up_for() {
    let mut rig = two_axes();
    rig.scan_at(0);
    let report = rig.scan_at(4 * MS as i64);
    assert_eq!((report.scan, report.tick, report.missed_ticks), (1, 4, 3));
    for drive in rig.machine.drives() {
        assert_eq!(drive.written.len(), 2);
    }
}

fn watched(sensitivity: u32) -> Rig {
    let mut rig = Rig::new(
        &[
            TaskConfig {
                watchdog: Some(Watchdog {
                    limit_ns: 500,
                    sensitivity,
                }),
                ..task("main", 1, 0)
            },
            task("other", 1, 1),
        ],
        &[
            ProgramConfig::with("p", "main"),
            ProgramConfig::with("q", "other"),
        ],
        &["X"],
    );
    rig.host.script = Box::new(|time, name| match (name, time.scan) {
        ("p", 2 | 4 | 5 | 6) => Ok(501),
        _ => Ok(500),
    });
    rig
}

/// OV-3, OV-4, OV-5: it takes `sensitivity` violations in a row; from then on no program runs and outputs
/// fail, while axes and drives are still served.
#[test]
fn the_watchdog_stops_the_resource() {
    for (sensitivity, fires_in) in [(1, 2), (2, 5), (3, 6)] {
        let mut rig = watched(sensitivity);
        for scan in 0..10 {
            let report = rig.scan_at(scan * MS as i64);
            assert_eq!(
                report.mode.fault().is_some(),
                scan >= fires_in,
                "{sensitivity} {scan}"
            );
            let tape = rig.taken_tape();
            let has = |line: &str| tape.iter().any(|other| other == line);
            assert_eq!(has("run p"), scan <= fires_in);
            assert_eq!(has("run q"), scan < fires_in);
            assert_eq!(has("publish"), scan < fires_in);
            assert_eq!(has("stopped"), scan == fires_in);
            assert!(has("read X") && has("write X") && has("observe") && has("published"));
        }
        let fault = Fault::Watchdog {
            scan: fires_in as u64,
            task: TaskId(0),
            took_ns: 501,
            limit_ns: 500,
        };
        assert_eq!(rig.host.failed, [fault]);
        assert_eq!(
            rig.executor.describe(fault).to_string(),
            format!("scan {fires_in}, task main: the watchdog fired, 501 ns where 500 ns are permitted")
        );
    }
}

/// OV-6: the fault names task, program and scan; what ran before it in the scan is not published.
#[test]
fn a_program_fault_ends_the_scan() {
    let mut rig = two_axes();
    rig.host.script = Box::new(|time, name| match (name, time.scan) {
        ("b", 2) => Err(ProgramFault {
            reason: "division by zero",
        }),
        _ => Ok(0),
    });
    for scan in 0..2 {
        rig.scan_at(scan * MS as i64);
    }
    rig.taken_tape();
    let mode = rig.scan_at(2 * MS as i64).mode;
    let fault = *mode.fault().unwrap();
    let order = [
        "latch",
        "read X",
        "read Y",
        "run a",
        "run b",
        "stopped",
        "observe",
        "write X",
        "write Y",
        "published",
    ];
    assert_eq!(rig.taken_tape(), order);
    assert_eq!(
        rig.executor.describe(fault).to_string(),
        "scan 2, task slow, program b: division by zero"
    );
    assert_eq!(rig.executor.mode(), Mode::Faulted(fault));
}

/// ST-1, ST-2, ST-6, as far as an executor owns them: the host learns which start it is, tasks begin at phase
/// 0 again, counts and fault are cleared, and scan numbers continue.
#[test]
fn a_start_begins_anew() {
    for start in [Start::Cold, Start::Warm] {
        let mut rig = watched(1);
        for scan in 0..4 {
            rig.scan_at(scan * MS as i64);
        }
        assert!(rig.executor.mode().fault().is_some());
        rig.taken_tape();
        rig.executor.start(start, &mut rig.host, &rig.machine).unwrap();
        assert_eq!(rig.taken_tape(), [format!("start {start:?}")]);
        assert_eq!(rig.executor.mode(), Mode::Running);
        assert_eq!(rig.executor.counts(TaskId(0)).unwrap().executions, 0);
        rig.host.script = Box::new(|_, _| Ok(0));
        let report = rig.scan_at(1_234_567_890);
        assert_eq!((report.scan, report.tick, report.executions), (4, 0, 2));
        assert_eq!(report.mode, Mode::Running);
    }
}
