//! An edge of a probe between two scans, at any place of the scan and any speed.

use standstill_axis::{
    Axis, AxisConfig, AxisId, Command, Direction, Drive, DrivePosition, Dynamics, Fate, IdealDrive, Limits,
    Log, Request, Scope, Standard, StartState, TouchProbe, Trigger,
};
use standstill_drives::peripherals::Peripherals;
use standstill_testkit::Random;

const CYCLE: f64 = 0.001;

const LIMITS: Limits = Limits {
    velocity: 1e4,
    acceleration: 1e6,
    deceleration: 1e6,
    jerk: 1e9,
    snap: f64::INFINITY,
};

struct Rig {
    axis: Axis,
    drive: IdealDrive,
    device: Peripherals,
    log: Log,
    scan: u64,
}

impl Rig {
    fn new(modulo: Option<f64>, delay: usize) -> Self {
        let config = AxisConfig {
            start: StartState::Standstill,
            modulo,
            ..AxisConfig::new(LIMITS)
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect("a good configuration"),
            drive: IdealDrive::new(DrivePosition::Units(0.0), delay, Some(0), true),
            device: Peripherals::new(modulo),
            log: Log::default(),
            scan: 0,
        }
    }

    /// A scan with these commands in its middle.
    fn scan(&mut self, commands: impl FnOnce(&mut Self)) {
        let feedback = self.drive.read(0);
        self.device.report(feedback.position, self.axis.report_mut());
        self.axis.follow_report();
        self.axis
            .follow_feedback(&feedback, &mut Scope::new(self.scan, &mut self.log));
        commands(self);
        self.axis.step_alone(&mut Scope::new(self.scan, &mut self.log));
        self.device.order(self.axis.order());
        self.drive.write(0, &self.axis.drive_command());
        self.scan += 1;
    }
}

/// The distance from one actual position to the next; on a modulo axis the shorter one.
fn way(from: f64, to: f64, modulo: Option<f64>) -> f64 {
    let nearest = |turn: f64| [-turn, 0.0, turn].map(|turns| to - from + turns);
    let nearest = modulo.map_or([to - from; 3], nearest);
    let shorter = |one: f64, other: f64| if other.abs() < one.abs() { other } else { one };
    nearest.into_iter().fold(f64::INFINITY, shorter)
}

/// Covers: T39g
#[test]
fn an_edge_between_scans_is_recorded_to_a_millionth_of_the_way() {
    let mut random = Random(11);
    let mut worst = 0.0_f64;
    for case in 0..2000 {
        let modulo = (case % 2 == 1).then_some(360.0);
        let mut rig = Rig::new(modulo, case % 3);
        // From very slow to ten units a scan, in both directions.
        let speed = 1e4 * random.unit() * random.unit() * random.unit() + 0.1;
        let velocity = if random.bits().is_multiple_of(2) {
            speed
        } else {
            -speed
        };
        let dynamics = Dynamics::at(velocity);
        let command = Command::MoveVelocity {
            dynamics,
            direction: Direction::Unset.into(),
        };
        let mut probing = None;
        rig.scan(|rig| {
            let request = Request::aborting(command);
            rig.axis
                .command(&request, &mut Scope::new(rig.scan, &mut rig.log))
                .expect("a motion");
            let request = TouchProbe {
                trigger: Trigger::Probe1Rising.into(),
                window: None,
                replaces: None,
            };
            let id = rig
                .axis
                .touch_probe(&request, &mut Scope::new(rig.scan, &mut rig.log));
            probing = Some(id.expect("a free probe"));
        });
        let probing = probing.expect("the scan was called");
        // In the ramp, or far behind it.
        for _ in 0..4 + random.bits() % 60 {
            rig.scan(|_| ());
            assert_eq!(rig.axis.fate(probing), Fate::Waiting);
        }
        let at = random.unit();
        let before = rig.axis.actual_position();
        rig.device.set_probe(0, at, true);
        rig.scan(|_| ());
        assert_eq!(rig.axis.fate(probing), Fate::Done);
        let travel = way(before, rig.axis.actual_position(), modulo);
        let recorded = rig.axis.recorded_position(probing).expect("recorded");
        let error = way(before + at * travel, recorded, modulo).abs();
        // The resolution of positions of this size is added.
        let resolved = 4.0 * f64::EPSILON * before.abs().max(recorded.abs()).max(360.0);
        assert!(
            error <= 1e-6 * travel.abs() + resolved,
            "case {case}: {error} of {travel}"
        );
        if travel != 0.0 {
            worst = worst.max((error - resolved).max(0.0) / travel.abs());
        }
    }
    println!("worst error {worst} of the way of its scan");
}
