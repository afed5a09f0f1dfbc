//! The tasks that run in each scan.
//!
//! Ids: CF configuration, TK tasks, OV overrun.

use crate::common::{MS, Rig, task};
use standstill_scan::{
    ConfigError, Executor, ProgramConfig, TaskConfig, TaskCounts, TaskId, Watchdog, common_tick_ns,
};

fn counts(rig: &Rig, task: usize) -> (u64, u64, u64) {
    let TaskCounts {
        executions,
        overruns,
        skipped,
    } = rig.executor.counts(TaskId(task)).unwrap();
    (executions, overruns, skipped)
}

/// TK-11, TK-2, TK-7: 1 ms and 10 ms over 1 s. The whole interleaving of a period is written down, and it
/// repeats 100 times.
#[test]
fn a_slow_task_does_not_move_a_fast_one() {
    let mut rig = Rig::of_tasks(&[task("slow", 10, 5), task("fast", 1, 0)]);
    let period = [
        "fast slow",
        "fast",
        "fast",
        "fast",
        "fast",
        "fast",
        "fast",
        "fast",
        "fast",
        "fast",
    ];
    let runs = rig.runs(0..1000);
    for (scan, ran) in runs.iter().enumerate() {
        assert_eq!(ran, period[scan % 10], "scan {scan}");
    }
    assert_eq!(counts(&rig, 0), (100, 0, 0));
    assert_eq!(counts(&rig, 1), (1000, 0, 0));
}

/// CF-2, CF-3, CF-4: programs of a task in declaration order, those without a task last, once a scan.
#[test]
fn programs_run_in_declaration_order() {
    let mut rig = Rig::new(
        &[task("fast", 1, 0), task("slow", 2, 1)],
        &[
            ProgramConfig::free("free1"),
            ProgramConfig::with("s1", "SLOW"),
            ProgramConfig::with("f1", "fast"),
            ProgramConfig::with("s2", "slow"),
            ProgramConfig::with("f2", "fast"),
            ProgramConfig::free("free2"),
        ],
        &[],
    );
    assert_eq!(
        rig.runs(0..3),
        [
            "f1 f2 s1 s2 free1 free2",
            "f1 f2 free1 free2",
            "f1 f2 s1 s2 free1 free2"
        ]
    );
}

/// TK-4, TK-6: priority first, then declaration order.
#[test]
fn the_highest_priority_goes_first() {
    let mut rig = Rig::of_tasks(&[
        task("c", 1, 7),
        task("b", 1, 1),
        task("a", 2, 0),
        task("d", 1, 7),
        task("e", 1, u32::MAX),
    ]);
    assert_eq!(rig.runs(0..2), ["a b c d e", "b c d e"]);
}

/// TK-5, TK-6: while the unit is taken tasks wait; of two equals the one that waits longer goes first,
/// although it is declared later.
#[test]
fn among_equals_the_one_that_waits_longest_goes_first() {
    let mut rig = Rig::of_tasks(&[task("late", 3, 5), task("early", 2, 5), task("hog", 100, 9)]);
    rig.host.script = Box::new(|_, name| Ok(if name == "hog" { 4 * MS } else { 0 }));
    assert_eq!(
        rig.runs(0..7),
        ["late early hog", "", "", "", "early late", "", "late early"]
    );
    // Both kept to their grids; `early` merged the periods 2 and 4 into one execution.
    assert_eq!(counts(&rig, 0), (3, 0, 0));
    assert_eq!(counts(&rig, 1), (3, 0, 1));
}

/// TK-1, TK-3, TK-9, TK-10: one execution at the edge, none while TRUE, the old grid afterwards, once where
/// edge and period meet.
#[test]
fn single_executes_at_its_edge_and_suspends_the_period() {
    let mut rig = Rig::of_tasks(&[
        TaskConfig {
            single: true,
            ..task("both", 3, 0)
        },
        TaskConfig {
            single: true,
            ..task("edge", 0, 1)
        },
    ]);
    rig.host.single = |scan, _| matches!(scan, 4..=7 | 12 | 13);
    let ran = rig.runs(0..16);
    let expected = [
        (0, "both"),
        (3, "both"),
        (4, "both edge"),
        (9, "both"),
        (12, "both edge"),
        (15, "both"),
    ];
    for (scan, ran) in (0..).zip(&ran) {
        let wanted = expected
            .iter()
            .find(|(at, _)| *at == scan)
            .map_or("", |(_, ran)| ran);
        assert_eq!(ran, wanted, "scan {scan}");
    }
    assert_eq!(counts(&rig, 0), (6, 0, 0));
}

/// TK-1: SINGLE that is TRUE from the start has risen.
#[test]
fn single_true_at_the_start_is_an_edge() {
    let mut rig = Rig::of_tasks(&[TaskConfig {
        single: true,
        ..task("edge", 0, 0)
    }]);
    rig.host.single = |_, _| true;
    assert_eq!(rig.runs(0..3), ["edge", "", ""]);
}

/// OV-1, OV-2: periods over which an execution lasts are skipped and counted, there is no burst, and the
/// grid stays.
#[test]
fn an_overrun_skips_periods_and_keeps_the_phase() {
    let mut rig = Rig::of_tasks(&[task("t", 3, 0)]);
    rig.host.script = Box::new(|time, _| Ok(if time.scan == 3 { 4 * MS } else { MS }));
    let ran = rig.runs(0..13);
    for (scan, ran) in ran.iter().enumerate() {
        assert_eq!(ran == "t", matches!(scan, 0 | 3 | 9 | 12), "scan {scan}");
    }
    assert_eq!(counts(&rig, 0), (4, 1, 1));
}

/// OV-1: an execution that ends exactly when the next is due is in time.
#[test]
fn ending_on_the_due_time_is_no_overrun() {
    for (took, expected) in [(2 * MS, (10, 0, 0)), (2 * MS + 1, (5, 5, 5))] {
        let mut rig = Rig::of_tasks(&[task("t", 2, 0)]);
        rig.host.script = Box::new(move |_, _| Ok(took));
        rig.runs(0..20);
        assert_eq!(counts(&rig, 0), expected, "{took} ns");
    }
}

/// TK-3, OV-1: periods suspended by SINGLE cannot be missed, however long the execution lasts.
#[test]
fn suspended_periods_are_no_overrun() {
    let mut rig = Rig::of_tasks(&[TaskConfig {
        single: true,
        ..task("t", 2, 0)
    }]);
    rig.host.single = |scan, _| scan < 8;
    rig.host.script = Box::new(|time, _| Ok(if time.scan == 0 { 5 * MS } else { 0 }));
    let ran = rig.runs(0..11);
    for (scan, ran) in ran.iter().enumerate() {
        assert_eq!(ran == "t", matches!(scan, 0 | 8 | 10), "scan {scan}");
    }
    assert_eq!(counts(&rig, 0), (3, 0, 0));
}

/// OV-1: the unit is one; what runs first in a scan delays what runs after it.
#[test]
fn executions_of_one_scan_add_up() {
    let mut rig = Rig::of_tasks(&[task("first", 2, 0), task("second", 1, 1)]);
    rig.host.script = Box::new(|_, _| Ok(600_000));
    assert_eq!(rig.scan_at(0).overruns, 1);
    assert_eq!(counts(&rig, 0), (1, 0, 0));
    assert_eq!(counts(&rig, 1), (1, 1, 1));
}

/// OV-1, OV-2, TM-5: a late host finds one execution; the other periods are counted, and the phase is kept.
#[test]
fn ticks_without_a_scan_are_skipped_periods() {
    let mut rig = Rig::of_tasks(&[task("t", 2, 0)]);
    assert_eq!(rig.runs([0, 7, 8, 9, 10]), ["t", "t", "t", "", "t"]);
    assert_eq!(counts(&rig, 0), (4, 0, 2));
}

/// TM-5: jitter below half a tick moves nothing, and it does not add up.
#[test]
fn jitter_does_not_move_a_task() {
    let mut rig = Rig::of_tasks(&[task("t", 2, 0)]);
    for tick in 0..100_i64 {
        let jitter = [0, 499_999, -500_000, -1][tick as usize % 4];
        let report = rig.scan_at(tick * MS as i64 + jitter);
        assert_eq!((report.tick, report.missed_ticks), (tick as u64, 0));
        assert_eq!(report.executions, usize::from(tick % 2 == 0));
    }
}

/// Extreme times are counted without overflow.
#[test]
fn extreme_instants_and_durations_are_counted_without_overflow() {
    let mut rig = Rig::of_tasks(&[task("t", 1, 0)]);
    rig.host.script = Box::new(|_, _| Ok(u64::MAX));
    rig.scan_at(i64::MIN);
    let report = rig.scan_at(i64::MAX);
    assert_eq!(report.tick, 18_446_744_073_710);
    assert_eq!(report.executions, 1);
}

/// TK-8: whole multiples only; the common tick is the greatest common divisor.
#[test]
fn intervals_are_whole_multiples_of_the_tick() {
    let tasks = [task("a", 4, 0), task("b", 6, 0)];
    assert_eq!(common_tick_ns(&tasks), Some(2 * MS));
    assert_eq!(common_tick_ns(&[]), None);
    assert!(Executor::new(2 * MS, &tasks, &[]).is_ok());
    let error = Executor::new(4 * MS, &tasks, &[]).unwrap_err();
    assert_eq!(
        error.to_string(),
        "the interval of task b is 6000000 ns, no whole multiple of the base tick of 4000000 ns: change it, \
         or use a base tick of 2000000 ns"
    );
}

/// Every defect of a configuration has its own error with the values.
#[test]
fn wrong_configurations_are_refused() {
    let main = || task("main", 1, 0);
    let dog = |limit_ns, sensitivity| TaskConfig {
        watchdog: Some(Watchdog {
            limit_ns,
            sensitivity,
        }),
        ..main()
    };
    let refused = |tick, tasks: &[TaskConfig], programs: &[ProgramConfig]| {
        Executor::new(tick, tasks, programs).unwrap_err()
    };
    assert_eq!(refused(0, &[main()], &[]), ConfigError::BaseTick);
    assert_eq!(
        refused(MS, &[main(), task("MAIN", 2, 0)], &[]),
        ConfigError::DuplicateTask { name: "MAIN".into() }
    );
    assert_eq!(
        refused(MS, &[task("idle", 0, 0)], &[]),
        ConfigError::NeverRuns { task: "idle".into() }
    );
    for (limit_ns, sensitivity) in [(0, 1), (1, 0)] {
        assert!(matches!(
            refused(MS, &[dog(limit_ns, sensitivity)], &[]),
            ConfigError::Watchdog { .. }
        ));
    }
    assert_eq!(
        refused(
            MS,
            &[main()],
            &[ProgramConfig::with("p", "main"), ProgramConfig::free("P")]
        ),
        ConfigError::DuplicateProgram { name: "P".into() }
    );
    assert_eq!(
        refused(MS, &[main()], &[ProgramConfig::with("p", "mian")]),
        ConfigError::UnknownTask {
            program: "p".into(),
            task: "mian".into()
        }
    );
}
