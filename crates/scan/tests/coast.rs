//! Scans without programs.

use crate::common::{MS, Rig, task};
use crate::stopping::forward;
use standstill_axis::Setpoint;
use standstill_scan::{ScanTime, TaskId};

fn coast(rig: &mut Rig, scans: u64) -> u64 {
    rig.executor.coast(scans, &mut rig.host, &mut rig.machine)
}

#[test]
fn they_count_as_scans_with_programs() {
    let (mut one, mut other) = (Rig::of_axes(&["X"]), Rig::of_axes(&["X"]));
    one.runs(0..20);
    other.runs(0..5);
    assert_eq!(coast(&mut other, 7), 7);
    assert_eq!(other.executor.stand(3), 3);
    assert_eq!(coast(&mut other, 5), 5);
    assert_eq!(
        one.executor.counts(TaskId(0)),
        other.executor.counts(TaskId(0)),
        "as often as if it had run"
    );
    for tick in [20, 21, 25] {
        let now_ns = tick * MS as i64;
        assert_eq!(one.scan_at(now_ns), other.scan_at(now_ns));
    }
}

#[test]
fn drives_are_served_in_the_order_of_a_scan() {
    let mut rig = Rig::of_axes(&["X"]);
    rig.runs(0..2);
    rig.taken_tape();
    coast(&mut rig, 1);
    let served = ["read X", "idle 2", "write X", "idled 2000000"];
    assert_eq!(rig.taken_tape(), served);
}

#[test]
fn an_axis_goes_along_without_its_drive() {
    let (mut one, mut other) = (Rig::of_axes(&["X"]), Rig::of_axes(&["X"]));
    for rig in [&mut one, &mut other] {
        rig.host.act = |scan, context| {
            if scan == 0 {
                forward(context);
            }
            Ok(())
        };
        rig.runs(0..2);
        rig.taken_tape();
    }
    let first = ScanTime {
        scan: 2,
        now_ns: 2 * MS as i64,
    };
    assert_eq!(other.executor.stand(3), 3);
    let mut along = Vec::new();
    let mut take = |step, setpoint: &Setpoint| along.push((step, *setpoint));
    other.machine.along(0, first, 3, &mut take);
    other.machine.along(1, first, 3, &mut take);
    let by_scan = (2..5).map(|scan| {
        one.runs(scan..scan + 1);
        one.machine.axes()[0].setpoint()
    });
    let by_scan: Vec<_> = (0..).zip(by_scan).collect();
    assert_eq!(along, by_scan, "and there is no axis 1");
    assert_eq!(other.taken_tape(), [""; 0], "nobody was called");
}

#[test]
fn they_end_when_the_host_says_so() {
    let mut rig = Rig::of_axes(&["X"]);
    rig.runs(0..2);
    rig.host.idles = false;
    assert_eq!(coast(&mut rig, 9), 1);
    assert_eq!(coast(&mut rig, 0), 0);
}

#[test]
fn there_are_none_where_a_program_is_not_due_in_every_tick() {
    let mut before = Rig::of_axes(&["X"]);
    assert_eq!(coast(&mut before, 9), 0, "nothing has run yet");
    let mut slow = Rig::of_tasks(&[task("fast", 1, 0), task("slow", 2, 0)]);
    slow.runs(0..4);
    assert_eq!(coast(&mut slow, 9), 0);
    let mut late = Rig::of_axes(&["X"]);
    late.runs(0..4);
    late.scan_at(4 * MS as i64 + 1);
    assert_eq!(coast(&mut late, 9), 0, "the last scan was late");
    assert_eq!(late.executor.stand(9), 0);
    let mut stopped = Rig::of_axes(&["X"]);
    stopped.runs(0..4);
    stopped.executor.stop(&mut stopped.host, &mut stopped.machine);
    assert_eq!(coast(&mut stopped, 9), 0);
}
