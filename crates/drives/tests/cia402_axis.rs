//! An axis over a simulated CiA 402 node, through every kind of loss.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Direction, Drive, DrivePosition, Dynamics, Limits, Log,
    Permission, Request, Scaling, Scope, Standard,
};
use standstill_drives::cia402::{Cia402Drive, Reaction, Settings, State};
use standstill_testkit::Random;

const CYCLE: f64 = 0.001;

/// Increments a unit.
const SCALE: u32 = 10_000;

const LIMITS: Limits = Limits {
    velocity: 100.0,
    acceleration: 2000.0,
    deceleration: 2000.0,
    jerk: 100_000.0,
    snap: f64::INFINITY,
};

/// Largest number of increments between two set-points.
const STEP: i64 = (100.0 * CYCLE * SCALE as f64) as i64 + 1;

struct Rig {
    axis: Axis,
    drive: Cia402Drive,
    log: Log,
    scan: u64,
    /// The last commanded position, while the drive was enabled.
    last: Option<i64>,
    /// Scans in operation.
    enabled: u32,
    worst: i64,
}

impl Rig {
    fn new(settings: Settings) -> Self {
        let config = AxisConfig {
            scaling: Some(Scaling::new(SCALE, 1, false, 0.0).unwrap()),
            ..AxisConfig::new(LIMITS)
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).unwrap(),
            drive: Cia402Drive::simulated_node(settings),
            log: Log::default(),
            scan: 0,
            last: None,
            enabled: 0,
            worst: 0,
        }
    }

    /// One scan, `during` between feedback and motion.
    fn step(&mut self, during: impl FnOnce(&mut Axis, &mut Scope<'_>)) {
        let feedback = self.drive.read(0);
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axis.follow_feedback(&feedback, scope);
        during(&mut self.axis, scope);
        self.axis.step_alone(scope);
        let command = self.axis.drive_command();
        let (DrivePosition::Increments(target), DrivePosition::Increments(actual)) =
            (command.position, feedback.position)
        else {
            panic!("increments");
        };
        // Measures from one set-point in operation to the next, and from the actual position to the first.
        if feedback.enabled {
            let step = target - self.last.unwrap_or(actual);
            self.worst = self.worst.max(step.abs());
            self.enabled += 1;
        }
        self.last = feedback.enabled.then_some(target);
        self.drive.write(0, &command);
        self.scan += 1;
    }

    fn power(&mut self, wanted: bool) {
        self.step(|axis, scope| axis.set_power(wanted, Permission::BOTH, scope));
    }

    fn run(&mut self, scans: u32) {
        for _ in 0..scans {
            self.step(|_, _| {});
        }
    }

    fn state(&self) -> (AxisState, State) {
        (self.axis.state(), self.drive.node().state())
    }
}

fn endless(velocity: f64) -> Command {
    Command::MoveVelocity {
        dynamics: Dynamics::at(velocity),
        direction: Direction::Positive.into(),
    }
}

/// Covers: CI-1, CI-3
#[test]
fn enabling_takes_the_steps_of_the_profile() {
    let mut rig = Rig::new(Settings {
        start_up: 3,
        power_on: Some(2),
        ..Settings::default()
    });
    let mut states = vec![rig.state()];
    for _ in 0..20 {
        rig.power(true);
        if states.last() != Some(&rig.state()) {
            states.push(rig.state());
        }
    }
    use State::{NotReadyToSwitchOn, OperationEnabled, ReadyToSwitchOn, SwitchOnDisabled, SwitchedOn};
    let disabled = |state| (AxisState::Disabled, state);
    assert_eq!(
        states,
        [
            disabled(NotReadyToSwitchOn),
            disabled(SwitchOnDisabled),
            disabled(ReadyToSwitchOn),
            disabled(SwitchedOn),
            disabled(OperationEnabled),
            (AxisState::Standstill, OperationEnabled),
        ]
    );
}

/// Covers: CI-3
#[test]
fn an_axis_pushed_while_off_is_taken_where_it_stands() {
    let mut rig = Rig::new(Settings::default());
    rig.power(true);
    rig.run(10);
    rig.power(false);
    rig.run(10);
    assert_eq!(rig.state(), (AxisState::Disabled, State::SwitchOnDisabled));
    rig.drive.node_mut().displace(10 * i64::from(SCALE)).unwrap();
    rig.run(3);
    assert_eq!(rig.axis.setpoint().position, 10.0);
    rig.power(true);
    rig.run(10);
    assert_eq!(rig.state(), (AxisState::Standstill, State::OperationEnabled));
    assert_eq!(rig.axis.setpoint().position, 10.0);
    assert_eq!(rig.worst, 0);
}

/// Covers: CI-5, CI-8
#[test]
fn each_loss_is_told_in_the_scan_it_is_seen() {
    type Loss = fn(&mut Rig);
    let losses: [(&str, Loss); 3] = [
        ("fault", |rig| rig.drive.node_mut().fail(7)),
        ("power", |rig| rig.drive.node_mut().cut_power()),
        ("communication", |rig| rig.drive.node_mut().cut_communication()),
    ];
    for (name, lose) in losses {
        let mut rig = Rig::new(Settings {
            deceleration: 10.0,
            ..Settings::default()
        });
        rig.power(true);
        rig.run(10);
        rig.step(|axis, scope| {
            axis.command(&Request::aborting(endless(50.0)), scope).unwrap();
        });
        rig.run(100);
        lose(&mut rig);
        // A fault shows in the status word of the next scan.
        rig.run(if name == "fault" { 2 } else { 1 });
        assert_eq!(rig.axis.state(), AxisState::ErrorStop, "{name}");
        rig.run(200);
        rig.drive.node_mut().clear_cause();
        rig.run(2);
        rig.step(|axis, scope| {
            axis.reset(scope).unwrap();
        });
        rig.run(20);
        assert_eq!(
            rig.state(),
            (AxisState::Standstill, State::OperationEnabled),
            "{name}"
        );
        assert!(rig.worst <= STEP, "{name}: {}", rig.worst);
    }
}

/// With any events at the drive, no set-point in operation is farther from the one before than the axis may move in
/// a scan, and enabling starts from the actual position. (An axis that takes an arrow that the state machine does
/// not have fails a debug assertion.)
///
/// Covers: CI-3, CI-5, CI-8
fn schedules(seeds: core::ops::Range<u64>) {
    let (mut enabled, mut worst, mut faults) = (0, 0, 0);
    for seed in seeds {
        let mut random = Random(seed);
        let reactions = [Reaction::Coast, Reaction::Ramp, Reaction::RampAndStay];
        let mut rig = Rig::new(Settings {
            // Near the end of the 32 bits, so that some schedules wrap.
            position: i64::from(i32::MAX) - random.below(20_000) as i64,
            delay: random.below(4) as usize,
            start_up: random.below(5) as u32,
            power_on: Some(random.below(5) as u32),
            deceleration: 1.0 + random.below(100) as f64,
            quick_stop: random.one_of(&reactions),
            leaving: random.one_of(&reactions),
            fault: random.one_of(&reactions),
            ..Settings::default()
        });
        let mut power = true;
        for _ in 0..12 {
            match random.below(10) {
                0 => rig.drive.node_mut().fail(random.below(100) as u16),
                1 => rig.drive.node_mut().cut_power(),
                2 => rig.drive.node_mut().cut_communication(),
                3 => power = !power,
                4 | 5 => rig.drive.node_mut().clear_cause(),
                6 => {
                    // Refused while there is torque, which is correct.
                    let _ = rig
                        .drive
                        .node_mut()
                        .displace(random.below(200_000) as i64 - 100_000);
                }
                7 => rig.drive.node_mut().set_remote(random.below(2) == 0),
                _ => {
                    power = true;
                    rig.drive.node_mut().clear_cause();
                    rig.drive.node_mut().set_remote(true);
                    rig.step(|axis, scope| {
                        // Only ErrorStop has something to reset.
                        let _ = axis.reset(scope);
                    });
                }
            }
            let velocity = 200.0 * (random.below(1000) as f64 / 1000.0) - 100.0;
            let command = if random.below(2) == 0 {
                endless(velocity)
            } else {
                Command::MoveRelative {
                    distance: 0.01 * velocity,
                    dynamics: Dynamics::at(1.0 + velocity.abs() / 2.0),
                }
            };
            for scan in 0..random.below(40) {
                rig.step(|axis, scope| {
                    axis.set_power(power, Permission::BOTH, scope);
                    if scan == 5 {
                        // Refused where the state does not allow it.
                        let _ = axis.command(&Request::aborting(command), scope);
                    }
                });
                faults += u32::from(rig.axis.state() == AxisState::ErrorStop);
            }
        }
        assert!(rig.worst <= STEP, "seed {seed}: {} increments", rig.worst);
        worst = worst.max(rig.worst);
        enabled += u64::from(rig.enabled);
    }
    println!(
        "{enabled} scans in operation, {faults} in ErrorStop, largest step {worst} of {STEP} increments"
    );
    assert!(enabled > 1000 && faults > 1000 && worst > STEP / 2);
}

#[test]
fn no_loss_makes_the_set_point_step() {
    schedules(0..3_000);
}

#[test]
#[ignore = "the long form: 100,000 schedules"]
fn no_loss_makes_the_set_point_step_in_the_long_run() {
    schedules(0..100_000);
}
