//! An axis with a load that swings, beside an equal one without: the same commands in the same scans.
//!
//! The plain axis shows the motion. The shaped one has to publish the mean of its past, which is computed here from
//! the weights of the shapers alone, for any take-over at any time. It has to keep every limit, and to be done when
//! the last of the motion has come out of the shaper.

use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, CommandId, ConfigError, Direction, DriveFeedback,
    DrivePosition, DriveRequest, Dynamics, ErrorId, ExecutionMode, Fate, IdealDrive, Limits, Log,
    ParameterValue, Permission, Request, Scope, Setpoint, ShaperKind, Standard, Superimpose, VibrationMode,
    steps,
};
use standstill_axis::{Drive, PlanError};
use standstill_planner::Shapers;
use standstill_soak::rules::limits::Track;
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.001;

/// Longest motion that is followed to its end (scans).
const LONGEST: u64 = 100_000;

fn mode(frequency: f64, damping: f64, shaper: ShaperKind) -> VibrationMode {
    VibrationMode {
        frequency,
        damping,
        shaper,
    }
}

/// A shaped axis, the plain one, and the data for the checks of both.
struct Twins {
    axes: [Axis; 2],
    drives: [IdealDrive; 2],
    history: Vec<Setpoint>,
    log: Log,
    scan: u64,
    shapers: Shapers,
    /// Set-points of the plain axis, beginning with the rest before the first scan.
    plain: Vec<Setpoint>,
    track: Track,
    /// Both move alike. They do not if a superimposed motion finds other room under an owner that takes longer.
    alike: bool,
}

impl Twins {
    fn new(config: AxisConfig) -> Self {
        let plain = AxisConfig {
            vibration: [None; 2],
            ..config
        };
        let mut axes = [(0, config), (1, plain)].map(|(id, config)| {
            Axis::new(AxisId::new(id), config, Standard::new(CYCLE)).expect("a good configuration")
        });
        // Not at the beginning of the memory, to check that it uses only its part.
        axes[0].set_history(7);
        let drive = || IdealDrive::new(DrivePosition::Units(config.position), 0, Some(0), true);
        Self {
            track: Track::new(&axes[0], CYCLE),
            history: vec![Setpoint::at_rest(f64::NAN); 7 + axes[0].history_needed() + 7],
            axes,
            drives: [drive(), drive()],
            log: Log::default(),
            scan: 0,
            shapers: Shapers::new(&config.vibration, CYCLE).expect("shapers"),
            plain: vec![Setpoint::at_rest(config.position)],
            alike: true,
        }
    }

    fn each<T>(&mut self, mut call: impl FnMut(&mut Axis, &mut Scope<'_>) -> T) -> [T; 2] {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        let [shaped, plain] = &mut self.axes;
        [call(shaped, scope), call(plain, scope)]
    }

    fn command(&mut self, command: Command) -> [CommandId; 2] {
        self.each(|axis, scope| axis.command(&Request::aborting(command), scope).expect("taken"))
    }

    /// One scan; the shaped set-point is the mean of the plain ones.
    fn step(&mut self) -> Setpoint {
        let scope = &mut Scope::new(self.scan, &mut self.log);
        scope.history = &mut self.history;
        let feedback: Vec<DriveFeedback> = self.drives.iter_mut().map(|drive| drive.read(0)).collect();
        steps::follow(&mut self.axes, &mut self.drives, &feedback, scope);
        steps::advance(&mut self.axes, scope);
        steps::publish(&mut self.axes, &mut self.drives, 0);
        self.scan += 1;
        self.plain.push(self.axes[1].setpoint());
        self.axes[0].setpoint()
    }

    /// The difference of the shaped set-point from the mean of the plain ones.
    fn off(&self) -> Setpoint {
        let newest = self.plain.len() as u64 - 1;
        let at = |scan: u64| self.plain[scan as usize];
        self.axes[0]
            .setpoint()
            .plus(&self.shapers.at(newest, at).times(-1.0))
    }

    fn judged_step(&mut self) -> Setpoint {
        let setpoint = self.step();
        if let Err(broken) = self.track.check(&setpoint) {
            panic!(
                "scan {}: {broken:?}: {setpoint:?} {:?} {:?}",
                self.scan,
                self.axes[0].config(),
                self.plain.last()
            );
        }
        if !self.alike {
            return setpoint;
        }
        let (off, limits) = (self.off(), &self.axes[0].config().limits);
        let size = 1e-12 * (setpoint.position.abs() + 1.0);
        assert!(off.position.abs() <= size, "scan {}: {off:?}", self.scan);
        assert!(
            off.velocity.abs() <= 1e-12 * limits.velocity,
            "scan {}: {off:?}",
            self.scan
        );
        let steepest = limits.acceleration.max(limits.deceleration);
        assert!(
            off.acceleration.abs() <= 1e-12 * steepest,
            "scan {}: {off:?}",
            self.scan
        );
        setpoint
    }

    /// Steps until `done` is true.
    fn until(&mut self, mut done: impl FnMut(&Self) -> bool) {
        for _ in 0..LONGEST {
            if done(self) {
                return;
            }
            self.judged_step();
        }
        panic!("it does not come to an end");
    }

    fn delay(&self) -> u64 {
        self.shapers.delay().into()
    }

    /// Steps until command `id` has ended.
    fn finish(&mut self, id: CommandId) {
        self.until(|twins| !matches!(twins.axes[0].fate(id), Fate::Active { .. } | Fate::Waiting));
    }
}

fn limits(random: &mut Random) -> Limits {
    let order = random.below(3);
    let velocity = random.log(0.5, 200.0);
    let acceleration = velocity / (CYCLE * random.log(2.0, 60.0));
    let jerk = acceleration / (CYCLE * random.log(2.0, 60.0));
    Limits {
        velocity,
        acceleration,
        deceleration: acceleration,
        jerk: if order >= 1 { jerk } else { f64::INFINITY },
        snap: if order >= 2 {
            jerk / (CYCLE * random.log(2.0, 60.0))
        } else {
            f64::INFINITY
        },
    }
}

fn drawn_mode(random: &mut Random) -> VibrationMode {
    let damping = if random.below(2) == 0 {
        0.0
    } else {
        random.log(1e-3, 0.2)
    };
    let shaper = ShaperKind::ALL[random.below(4) as usize];
    mode(1.0 / (CYCLE * random.log(6.0, 150.0)), damping, shaper)
}

fn dynamics(random: &mut Random, limits: &Limits) -> Dynamics {
    let mut part = |limit: f64| {
        if limit.is_finite() && random.below(4) > 0 {
            limit * random.log(0.05, 1.0)
        } else {
            0.0
        }
    };
    let [acceleration, deceleration, jerk, snap] =
        [limits.acceleration, limits.deceleration, limits.jerk, limits.snap].map(&mut part);
    Dynamics {
        velocity: limits.velocity * random.between(0.05, 1.0),
        acceleration,
        deceleration,
        jerk,
        snap,
    }
}

fn config(limits: Limits, vibration: [Option<VibrationMode>; 2]) -> AxisConfig {
    AxisConfig {
        vibration,
        ..standing::config(limits)
    }
}

/// A random command from any state.
fn disturb(twins: &mut Twins, random: &mut Random, limits: &Limits) -> [CommandId; 2] {
    let dynamics = dynamics(random, limits);
    let here = twins.axes[1].setpoint().position;
    let way =
        limits.velocity * CYCLE * random.log(0.5, 300.0) * if random.below(2) == 0 { 1.0 } else { -1.0 };
    let direction = Direction::Unset.into();
    twins.command(match random.below(6) {
        0 => Command::MoveVelocity {
            dynamics: Dynamics {
                velocity: dynamics.velocity * way.signum(),
                ..dynamics
            },
            direction: Direction::Positive.into(),
        },
        1 => Command::Halt { dynamics },
        2 => Command::MoveContinuousAbsolute {
            position: here + way,
            end_velocity: 0.5 * dynamics.velocity * way.signum(),
            dynamics,
            direction,
        },
        _ => Command::MoveAbsolute {
            position: here + way,
            dynamics,
            direction,
        },
    })
}

/// Moves, endless motions and halts take over from each other at random. The last move ends on its target, later by
/// the delay of the shapers.
///
/// Covers: VB1, VB4, VB5
#[test]
fn whatever_takes_over_the_rest_of_it_comes_out_first() {
    for number in 0..cases(400) {
        let mut random = Random(0x5A_0000 + number);
        let limits = limits(&mut random);
        let second = (random.below(2) == 0).then(|| drawn_mode(&mut random));
        let mut twins = Twins::new(config(limits, [Some(drawn_mode(&mut random)), second]));
        for _ in 0..6 {
            disturb(&mut twins, &mut random, &limits);
            for _ in 0..random.log(1.0, 200.0) as u64 {
                twins.judged_step();
            }
        }
        let position = twins.axes[1].setpoint().position + limits.velocity * CYCLE * 50.0;
        let dynamics = dynamics(&mut random, &limits);
        let direction = Direction::Unset.into();
        let [shaped, plain] = twins.command(Command::MoveAbsolute {
            position,
            dynamics,
            direction,
        });
        twins.until(|twins| twins.axes[1].fate(plain) == Fate::Done);
        let at = twins.scan;
        assert_eq!(twins.axes[0].state(), AxisState::DiscreteMotion, "case {number}");
        twins.finish(shaped);
        assert_eq!(twins.axes[0].fate(shaped), Fate::Done, "case {number}");
        assert_eq!(twins.scan, at + twins.delay(), "case {number}");
        let end = twins.axes[0].setpoint();
        assert_eq!(
            (end.position, end.is_at_rest()),
            (position, true),
            "case {number}"
        );
        assert_eq!(twins.axes[0].state(), AxisState::Standstill, "case {number}");
        twins.until(|twins| twins.scan == at + 2 * twins.delay() + 3);
        assert_eq!(twins.axes[0].setpoint(), Setpoint::at_rest(position));
    }
}

/// With superimposed moves at random: every limit holds for the sum, and both distances are exact to the bit.
///
/// Covers: VB4, VB11
#[test]
fn a_superimposed_move_is_shaped_with_what_it_is_on() {
    for number in 0..cases(200) {
        let mut random = Random(0x5C_0000 + number);
        let limits = limits(&mut random);
        let mut twins = Twins::new(config(limits, [Some(drawn_mode(&mut random)), None]));
        let (position, distance) = (limits.velocity * CYCLE * random.log(20.0, 400.0), 0.25);
        let direction = Direction::Unset.into();
        let moved = Command::MoveAbsolute {
            position,
            dynamics: dynamics(&mut random, &limits),
            direction,
        };
        let [id, _] = twins.command(moved);
        for _ in 0..random.log(1.0, 100.0) as u64 {
            twins.judged_step();
        }
        twins.alike = false;
        let request = Superimpose {
            distance,
            dynamics: dynamics(&mut random, &limits),
        };
        let [beside, _] = twins.each(|axis, scope| axis.superimpose(&request, scope).expect("taken"));
        twins.finish(id);
        twins.finish(beside);
        twins.until(|twins| twins.axes[0].state() == AxisState::Standstill);
        let end = twins.axes[0].setpoint();
        assert_eq!(
            (twins.axes[0].fate(id), twins.axes[0].fate(beside)),
            (Fate::Done, Fate::Done),
            "case {number}"
        );
        assert_eq!(
            end.position,
            position + distance,
            "case {number} {position} {:?} {:?}",
            twins.axes[1].setpoint(),
            twins.axes[1].state()
        );
        assert!(end.is_at_rest(), "case {number}");
    }
}

/// Later by the delay of the shaper.
///
/// Covers: VB6
#[test]
fn a_velocity_is_reached_when_it_is_published() {
    let mut random = Random(0x5B);
    for _ in 0..100 {
        let limits = limits(&mut random);
        let mut twins = Twins::new(config(limits, [Some(drawn_mode(&mut random)), None]));
        let dynamics = dynamics(&mut random, &limits);
        let direction = Direction::Positive.into();
        let [shaped, plain] = twins.command(Command::MoveVelocity { dynamics, direction });
        let reached = Fate::Active { reached: true };
        twins.until(|twins| twins.axes[1].fate(plain) == reached);
        let at = twins.scan;
        twins.until(|twins| twins.axes[0].fate(shaped) == reached);
        assert_eq!(twins.scan, at + twins.delay());
        let there = twins.axes[0].setpoint();
        assert_eq!((there.velocity, there.acceleration), (dynamics.velocity, 0.0));
    }
}

/// MC_SetPosition and turns: shifts of the coordinates do not change the motion.
///
/// Covers: VB10
#[test]
fn coordinates_may_move_while_something_is_in_the_shaper() {
    for modulo in [None, Some(10.0)] {
        let limits = Limits {
            velocity: 40.0,
            acceleration: 400.0,
            deceleration: 400.0,
            jerk: 8e3,
            snap: f64::INFINITY,
        };
        let config = AxisConfig {
            modulo,
            ..config(limits, [Some(mode(12.0, 0.01, ShaperKind::Ei)), None])
        };
        let mut twins = Twins::new(config);
        let dynamics = Dynamics::at(40.0);
        let direction = Direction::Positive.into();
        twins.command(Command::MoveVelocity { dynamics, direction });
        let mut last = twins.axes[0].setpoint();
        for scan in 0..3000_u64 {
            let mut by = 0.0;
            if scan % 171 == 30 {
                by = 1.25;
                let queued = ExecutionMode::Immediately.into();
                twins.each(|axis, scope| axis.set_position(by, true, queued, scope).expect("taken"));
            }
            if scan == 2000 {
                twins.command(Command::Halt {
                    dynamics: Dynamics::default(),
                });
            }
            let now = twins.step();
            let mut way = now.position - last.position - by;
            if let Some(turn) = modulo {
                way -= turn * (way / turn).round();
            }
            let expected = 0.5 * (now.velocity + last.velocity) * CYCLE;
            assert!((way - expected).abs() < 1e-6, "scan {scan}: {way} {expected}");
            last = now;
        }
        assert_eq!(twins.axes[0].state(), AxisState::Standstill);
        let (one, other) = (twins.axes[0].setpoint(), twins.axes[1].setpoint());
        assert!((one.position - other.position).abs() < 1e-11, "{one:?} {other:?}");
        assert!(one.is_at_rest());
    }
}

/// Switched off, or stopped by a fault: power stays on until the shaper holds nothing, although the motion is already
/// at rest.
///
/// Covers: VB9
#[test]
fn power_stays_on_until_nothing_is_left() {
    let limits = Limits {
        velocity: 40.0,
        acceleration: 4000.0,
        deceleration: 4000.0,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    };
    for fault in [false, true] {
        let mut twins = Twins::new(config(limits, [Some(mode(5.0, 0.0, ShaperKind::Zvd)), None]));
        let dynamics = Dynamics::at(40.0);
        let direction = Direction::Positive.into();
        twins.command(Command::MoveVelocity { dynamics, direction });
        for _ in 0..300 {
            twins.judged_step();
        }
        if fault {
            twins.each(|axis, scope| axis.raise(ErrorId::AxisFault, 0, scope));
        } else {
            twins.each(|axis, scope| axis.set_power(false, Permission::BOTH, scope));
        }
        let mut scans = 0;
        while !twins.axes[0].setpoint().is_at_rest() || scans < 20 {
            assert_eq!(
                twins.axes[0].drive_command().request,
                DriveRequest::Enable,
                "scan {scans}"
            );
            if fault && scans == 100 {
                twins.each(Axis::clear_cause_in);
                assert_eq!(twins.axes[0].state(), AxisState::ErrorStop);
            }
            twins.judged_step();
            scans += 1;
        }
        // 11 scans to rest and 200 of the shaper.
        assert!((200..215).contains(&scans), "{scans}");
    }
}

/// Lets `each` call a function that takes no scope.
trait InScope {
    fn clear_cause_in(&mut self, scope: &mut Scope<'_>);
}

impl InScope for Axis {
    fn clear_cause_in(&mut self, _scope: &mut Scope<'_>) {
        self.clear_cause();
    }
}

/// The parameters 1002 to 1007.
///
/// Covers: VB8, VB12
#[test]
fn modes_are_read_and_written_by_number() {
    let limits = limits(&mut Random(1));
    let mut twins = Twins::new(config(limits, [Some(mode(12.0, 0.02, ShaperKind::Zv)), None]));
    let read = |twins: &Twins| [1002, 1003, 1004, 1005, 1006, 1007].map(|n| twins.axes[0].real_parameter(n));
    assert_eq!(read(&twins), [12.0, 0.02, 2.0, 0.0, 0.0, 0.0].map(Ok));
    let write = |twins: &mut Twins, number, value| {
        let scope = &mut Scope::new(twins.scan, &mut twins.log);
        let mode = ExecutionMode::Immediately.into();
        twins.axes[0].write_parameter(number, ParameterValue::Real(value), mode, scope)
    };
    for (number, value) in [(1002, 6.0), (1003, 0.1), (1004, 1.0)] {
        assert!(write(&mut twins, number, value).is_ok(), "{number} {value}");
    }
    assert_eq!(read(&twins), [6.0, 0.1, 1.0, 0.0, 0.0, 0.0].map(Ok));
    for (number, value, error) in [
        (1002, 5.9, ErrorId::ParameterValueInvalid),
        (1002, 0.0, ErrorId::ParameterValueInvalid),
        (1002, f64::NAN, ErrorId::ParameterValueInvalid),
        (1002, 260.0, ErrorId::ParameterValueInvalid),
        (1003, -0.1, ErrorId::ParameterValueInvalid),
        (1003, 0.91, ErrorId::ParameterValueInvalid),
        (1004, 0.0, ErrorId::ParameterValueInvalid),
        (1004, 2.5, ErrorId::ParameterValueInvalid),
        (1004, 5.0, ErrorId::ParameterValueInvalid),
        (1005, 20.0, ErrorId::VibrationMissing),
        (1008, 20.0, ErrorId::ParameterNumberInvalid),
    ] {
        assert_eq!(write(&mut twins, number, value), Err(error), "{number} {value}");
    }
    // It shapes with the written values.
    twins.shapers = Shapers::new(&[Some(mode(6.0, 0.1, ShaperKind::Period)), None], CYCLE).expect("shapers");
    let [id, _] = disturb(&mut twins, &mut Random(5), &limits);
    twins.judged_step();
    assert_eq!(write(&mut twins, 1002, 12.0), Err(ErrorId::InMotion));
    twins.finish(id);
    assert!(write(&mut twins, 1002, 12.0).is_ok());
    // An axis without modes has no such parameter to write.
    let scope = &mut Scope::new(twins.scan, &mut twins.log);
    let value = ParameterValue::Real(12.0);
    let error = twins.axes[1].write_parameter(1002, value, ExecutionMode::Immediately.into(), scope);
    assert_eq!(error, Err(ErrorId::VibrationMissing));
}

/// Covers: VB12
#[test]
fn a_mode_that_cannot_be_shaped_is_refused_at_set_up() {
    let refused = |modes| {
        let config = config(limits(&mut Random(1)), modes);
        Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).expect_err("refused")
    };
    let error = refused([
        Some(mode(12.0, 0.0, ShaperKind::Ei)),
        Some(mode(600.0, 0.0, ShaperKind::Ei)),
    ]);
    assert_eq!(error.key(), "vibration.1.frequency");
    assert_eq!(
        error.to_string(),
        "vibration.1.frequency is 600.0: a period takes from 4 to 4096 cycles, so the nearest frequency is 250.0; a shorter or longer cycle moves the range"
    );
    let two_rates = Limits {
        deceleration: 7.0,
        acceleration: 8.0,
        ..limits(&mut Random(1))
    };
    let error = config(two_rates, [Some(mode(12.0, 0.0, ShaperKind::Ei)), None]).check();
    assert_eq!(error.map_err(|error| error.key()), Err("limits.deceleration"));
    let error = refused([Some(mode(12.0, 1.0, ShaperKind::Ei)), None]);
    assert_eq!(
        error.to_string(),
        "vibration.0.damping is 1.0: a damping ratio is from 0 to 0.9"
    );
    assert!(matches!(
        refused([Some(mode(-12.0, 0.0, ShaperKind::Ei)), None]),
        ConfigError::NotPositive {
            key: "vibration.0.frequency",
            ..
        } | ConfigError::Vibration {
            place: 0,
            error: PlanError::InvalidInput { .. }
        }
    ));
}
