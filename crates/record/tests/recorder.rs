//! The contents of a recorder, its stop, and the agreement of its trace with the run.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Drive, DrivePosition, ErrorId, Event, ExecutionMode, IdealDrive, InstanceId,
    Limits, Log, Record, Scope, Standard, StartState, steps,
};
use standstill_record::{Recorder, Setup, Signals, State, Trigger};
use standstill_trace::Cell;

fn config() -> AxisConfig {
    let limits = Limits {
        velocity: 50.0,
        acceleration: 200.0,
        deceleration: 200.0,
        jerk: 2e3,
        snap: 4e4,
    };
    AxisConfig {
        start: StartState::Standstill,
        ..AxisConfig::new(limits)
    }
}

/// An axis at rest, and a recorder of it.
struct Bench {
    axes: [Axis; 1],
    drive: IdealDrive,
    log: Log,
    scan: u64,
    recorder: Recorder,
}

impl Bench {
    fn new(setup: Setup) -> Self {
        let axis = Axis::new(AxisId::new(0), config(), Standard::new(0.001)).expect("a good axis");
        Self {
            axes: [axis],
            drive: IdealDrive::new(DrivePosition::Units(0.0), 0, Some(0), true),
            log: Log::default(),
            scan: 0,
            recorder: Recorder::new(setup, Signals::new().axis("X", "mm", &config())),
        }
    }

    /// Runs `count` scans. `before` is called in each, at the place of the blocks.
    fn scans(&mut self, count: u64, before: impl Fn(&mut Self)) {
        for _ in 0..count {
            let [axis] = &mut self.axes;
            axis.follow_feedback(&self.drive.read(0), &mut Scope::new(self.scan, &mut self.log));
            before(self);
            self.recorder.observe(&self.axes);
            steps::advance(&mut self.axes, &mut Scope::new(self.scan, &mut self.log));
            let [axis] = &mut self.axes;
            self.drive.write(0, &axis.drive_command());
            self.recorder.record(self.scan, &self.axes, &self.log, |_| {});
            self.scan += 1;
        }
    }

    fn fail(&mut self) {
        self.axes[0].raise(ErrorId::AxisFault, 7, &mut Scope::new(self.scan, &mut self.log));
    }
}

const SETUP: Setup = Setup {
    scans: 10,
    after: 3,
    records: 4,
    trigger: Trigger::ErrorStop,
};

#[test]
fn it_keeps_the_last_scans_until_one_trips_it_and_a_few_behind() {
    let mut bench = Bench::new(SETUP);
    bench.scans(4, |_| {});
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans()),
        (State::Armed, (0, 4))
    );
    bench.scans(20, |_| {});
    assert_eq!(bench.recorder.scans(), (14, 10));
    bench.scans(1, Bench::fail);
    assert_eq!(bench.recorder.state(), State::Tripped { left: 2 });
    bench.scans(3, |_| {});
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans()),
        (State::Frozen, (18, 10))
    );
    // Later scans do not change it.
    bench.scans(50, |_| {});
    assert_eq!(bench.recorder.scans(), (18, 10));
    let trace = bench.recorder.trace("t", 1_000_000).expect("a trace");
    let states: Vec<_> = (0..10).map(|row| trace.cell(row, 0)).collect();
    assert_eq!(states[..6], [Some(Cell::Name("Standstill")); 6]);
    assert_eq!(states[6..], [Some(Cell::Name("ErrorStop")); 4]);
    let notes: Vec<_> = trace
        .notes()
        .iter()
        .map(|note| (note.scan, note.text.as_str()))
        .collect();
    assert_eq!(
        notes[0],
        (
            0,
            "scans 18 to 27 of the machine; tripped by ErrorStop of X in scan 24, here 6"
        )
    );
    assert!(notes[1].0 == 6 && notes[1].1.starts_with("fault "), "{notes:?}");
}

#[test]
fn armed_again_it_waits_for_the_next_one() {
    let mut bench = Bench::new(SETUP);
    bench.scans(1, Bench::fail);
    bench.scans(5, |_| {});
    assert_eq!(bench.recorder.state(), State::Frozen);
    bench.recorder.arm();
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans().1),
        (State::Armed, 0)
    );
    // The axis is still in ErrorStop. That is no entry into it.
    bench.scans(5, |_| {});
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans()),
        (State::Armed, (6, 5))
    );
    // The records of the first recording are gone.
    let trace = bench.recorder.trace("t", 1_000_000).expect("a trace");
    assert_eq!(trace.notes().len(), 1);
    assert_eq!(trace.notes()[0].text, "scans 6 to 10 of the machine");
}

#[test]
fn the_host_trips_it_for_its_own_reasons() {
    let mut bench = Bench::new(Setup {
        trigger: Trigger::Host,
        after: 0,
        ..SETUP
    });
    bench.scans(1, Bench::fail);
    assert_eq!(bench.recorder.state(), State::Armed, "ErrorStop is none of them");
    bench.recorder.trip();
    bench.scans(1, |_| {});
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans()),
        (State::Frozen, (0, 2))
    );
    let trace = bench.recorder.trace("t", 1_000_000).expect("a trace");
    let note = &trace.notes()[0].text;
    assert_eq!(
        note,
        "scans 0 to 1 of the machine; tripped by the host in scan 1, here 1"
    );
}

#[test]
fn of_records_the_last_ones_stay_in_order() {
    let mut bench = Bench::new(Setup { scans: 100, ..SETUP });
    bench.scans(6, |bench| {
        bench.log.push(Record {
            scan: bench.scan,
            axis: AxisId::new(0),
            instance: InstanceId::default(),
            event: Event::RoomAwaited,
        });
    });
    let trace = bench.recorder.trace("t", 1_000_000).expect("a trace");
    let rows: Vec<_> = trace.notes().iter().skip(1).map(|note| note.scan).collect();
    assert_eq!(rows, [2, 3, 4, 5]);
}

#[test]
fn a_setup_that_makes_no_sense_is_the_nearest_that_does() {
    let mut bench = Bench::new(Setup {
        scans: 0,
        after: 9,
        records: 0,
        trigger: Trigger::ErrorStop,
    });
    bench.scans(3, Bench::fail);
    assert_eq!(
        (bench.recorder.state(), bench.recorder.scans()),
        (State::Frozen, (0, 1))
    );
    assert_eq!(bench.recorder.trace("t", 1).expect("a trace").scans(), 1);
}

/// Without a shift, a trace would show a jump, which claims about limits take for a fault.
#[test]
fn every_move_of_coordinates_is_told_however_few_records_are_kept() {
    let mut bench = Bench::new(SETUP);
    bench.scans(12, |bench| {
        let log = &mut bench.log;
        for by in [1.0, 2.0] {
            let mode = ExecutionMode::Immediately.into();
            let scope = &mut Scope::new(bench.scan, log);
            bench.axes[0]
                .set_position(by, true, mode, scope)
                .expect("at rest");
        }
    });
    let trace = bench.recorder.trace("t", 1_000_000).expect("a trace");
    let moves: Vec<_> = trace
        .notes()
        .iter()
        .filter(|note| note.subject == "X")
        .map(|note| (note.scan, note.text.as_str()))
        .collect();
    let expected: Vec<_> = (0..10).map(|row| (row, "coordinates moved by 3.0")).collect();
    assert_eq!(moves, expected);
}

/// The ring of records holds 64. If 70 axes shift their coordinates in one scan, it loses some records.
#[test]
fn the_moves_of_70_axes_in_one_scan_are_told() {
    let axis = |number| Axis::new(AxisId::new(number), config(), Standard::new(0.001)).expect("a good axis");
    let mut axes: Vec<_> = (0..70).map(axis).collect();
    let names: Vec<_> = (1..=axes.len()).map(|number| format!("X{number}")).collect();
    let signals = names.iter().fold(Signals::new(), |signals, name| {
        signals.axis(name, "mm", &config())
    });
    let mut recorder = Recorder::new(Setup::default(), signals);
    let (mut log, scan) = (Log::default(), 0);
    let scope = &mut Scope::new(scan, &mut log);
    for axis in &mut axes {
        axis.set_position(3.0, true, ExecutionMode::Immediately.into(), scope)
            .expect("at rest");
    }
    recorder.observe(&axes);
    steps::advance(&mut axes, scope);
    recorder.record(scan, &axes, &log, |_| {});
    let trace = recorder.trace("t", 1_000_000).expect("a trace");
    let told = |name: &&String| {
        let mut notes = trace.notes().iter();
        notes.any(|note| note.subject == **name && note.text == "coordinates moved by 3.0")
    };
    assert_eq!(names.iter().filter(told).count(), names.len());
}
