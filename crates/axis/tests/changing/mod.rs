//! Overrides and ContinuousUpdate at random. For any change in any scan the limits of the axis hold, nothing ends in
//! ErrorStop, every command ends, and the last target is met to the bit.
//!
//! Every case runs one axis through random commands (aborting, buffered, blended, superimposed, endless, halts). In
//! random scans the override gets new factors, 0 among them, and running or waiting commands get new values. At the
//! end one move runs alone with such changes, and must end as the newest values require.
//!
//! Set-points are checked against the limits of the axis by the rules of `standstill-soak`. A take-over that can't
//! stay inside a limit is recorded; that may happen in one case of a thousand. Without a record it never happens.

use crate::draw;
use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BufferMode, Command, CommandId, Direction, Event, Factors, Fate,
    Log, MoveProfile, Plan, Raw, Request, Scope, Standard, Superimpose,
};
use standstill_soak::rules::limits::Track;
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.01;
/// A case that takes longer is a motion that never ends.
const MOST_SCANS: u64 = 200_000;

struct Case {
    seed: u64,
    random: Random,
    axis: Axis,
    track: Track,
    log: Log,
    scan: u64,
    commands: Vec<(CommandId, Command)>,
    added: Option<CommandId>,
    changes: u64,
    /// The number of records read.
    told: u64,
    /// The axis has recorded that a take-over could not stay inside its limits.
    unavoidable: bool,
    /// A limit was exceeded.
    exceeded: bool,
    /// A limit was exceeded without a record.
    silent: Option<String>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let limits = draw::limits(&mut random);
        let profile = match random.below(3) {
            0 => MoveProfile::Overlapped,
            1 => MoveProfile::Online,
            _ => MoveProfile::Fastest,
        };
        let config = AxisConfig {
            modulo: (random.below(4) == 0).then_some(90.0),
            override_max: if random.below(4) == 0 { 2.0 } else { 1.0 },
            profile,
            ..standing::config(limits)
        };
        let axis = Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).unwrap();
        Self {
            seed,
            random,
            track: Track::new(&axis, CYCLE),
            axis,
            log: Log::default(),
            scan: 0,
            commands: Vec::new(),
            added: None,
            changes: 0,
            told: 0,
            unavoidable: false,
            exceeded: false,
            silent: None,
        }
    }

    fn advance(&mut self, scans: u64) {
        for _ in 0..scans {
            self.axis.step_alone(&mut Scope::new(self.scan, &mut self.log));
            for record in self.log.since(self.told) {
                match (record.event, self.axis.plan()) {
                    (Event::Unavoidable(_), _) => self.unavoidable = true,
                    (Event::Planned { .. }, Some((plan, _))) => {
                        let end = plan.end();
                        self.track.leads(plan.at(0).position, end.position, plan.scans());
                    }
                    _ => {}
                }
            }
            self.told = self.log.total();
            let what = format!("case {}, scan {}", self.seed, self.scan);
            let kept = self.track.check(&self.axis.setpoint());
            self.exceeded |= kept.is_err();
            if let Err(broken) = kept
                && !self.unavoidable
            {
                self.silent.get_or_insert(format!("{what}: {broken:?}"));
            }
            assert_ne!(self.axis.state(), AxisState::ErrorStop, "{what}");
            self.scan += 1;
        }
    }

    fn position(&mut self) -> f64 {
        match self.axis.config().modulo {
            Some(length) => self.random.between(0.0, length * 0.999),
            None => self.random.between(-100.0, 100.0),
        }
    }

    fn direction(&mut self) -> Raw<Direction> {
        let all = [
            Direction::Unset,
            Direction::Positive,
            Direction::Negative,
            Direction::Current,
            Direction::ShortestWay,
        ];
        all[self.random.below(5) as usize].into()
    }

    /// Random values for a command of kind `kind`.
    fn values(&mut self, kind: u64) -> Command {
        let dynamics = draw::dynamics(&mut self.random, &self.axis.config().limits);
        let distance = self.random.between(-120.0, 120.0);
        let end_velocity = dynamics.velocity * self.random.between(-1.0, 1.0);
        match kind {
            0 => Command::MoveAbsolute {
                position: self.position(),
                dynamics,
                direction: self.direction(),
            },
            1 => Command::MoveRelative { distance, dynamics },
            2 => Command::MoveAdditive { distance, dynamics },
            3 => Command::MoveContinuousAbsolute {
                position: self.position(),
                end_velocity,
                dynamics,
                direction: self.direction(),
            },
            4 => Command::MoveContinuousRelative {
                distance,
                end_velocity,
                dynamics,
            },
            5 => {
                let direction = match self.random.below(3) {
                    0 => Direction::Current,
                    1 => Direction::Negative,
                    _ => Direction::Positive,
                };
                let sign = if self.random.below(2) == 0 { 1.0 } else { -1.0 };
                let dynamics = standstill_axis::Dynamics {
                    velocity: sign * dynamics.velocity,
                    ..dynamics
                };
                Command::MoveVelocity {
                    dynamics,
                    direction: direction.into(),
                }
            }
            _ => Command::Halt { dynamics },
        }
    }

    fn command(&mut self) {
        let kind = self.random.below(7);
        let command = self.values(kind);
        let modes = [
            BufferMode::Aborting,
            BufferMode::Buffered,
            BufferMode::BlendingLow,
            BufferMode::BlendingPrevious,
            BufferMode::BlendingNext,
            BufferMode::BlendingHigh,
        ];
        let request = Request {
            buffer_mode: modes[self.random.below(6) as usize].into(),
            ..Request::aborting(command)
        };
        if let Ok(id) = self
            .axis
            .command(&request, &mut Scope::new(self.scan, &mut self.log))
        {
            self.commands.push((id, command));
        }
    }

    /// `command` with one of its values, or all of them, taken from another.
    fn changed(&mut self, command: Command) -> Command {
        let kind = match command {
            Command::MoveAbsolute { .. } => 0,
            Command::MoveRelative { .. } => 1,
            Command::MoveAdditive { .. } => 2,
            Command::MoveContinuousAbsolute { .. } => 3,
            Command::MoveContinuousRelative { .. } => 4,
            Command::MoveVelocity { .. } => 5,
            _ => 6,
        };
        let mut other = self.values(kind);
        match (&mut other, command) {
            (Command::MoveAbsolute { dynamics: new, .. }, Command::MoveAbsolute { dynamics, .. })
            | (Command::MoveRelative { dynamics: new, .. }, Command::MoveRelative { dynamics, .. })
                if self.random.below(2) == 0 =>
            {
                *new = dynamics;
            }
            (Command::MoveAbsolute { position: new, .. }, Command::MoveAbsolute { position, .. })
            | (
                Command::MoveRelative { distance: new, .. },
                Command::MoveRelative {
                    distance: position, ..
                },
            ) if self.random.below(2) == 0 => {
                *new = position;
            }
            _ => {}
        }
        other
    }

    fn update(&mut self) {
        let Some(last) = self.commands.len().checked_sub(1) else {
            return;
        };
        let index = last.saturating_sub(self.random.below(3) as usize);
        let (id, command) = self.commands[index];
        let new = self.changed(command);
        if self
            .axis
            .update(id, &new, &mut Scope::new(self.scan, &mut self.log))
            .is_ok()
        {
            self.commands[index].1 = new;
            self.changes += 1;
        }
    }

    fn factors(&mut self) {
        let most = self.axis.config().override_max;
        let one = |random: &mut Random| match random.below(3) {
            0 => 1.0,
            1 => most,
            _ => random.between(0.05, 1.0),
        };
        let factors = Factors {
            velocity: if self.random.below(4) == 0 {
                0.0
            } else {
                one(&mut self.random)
            },
            acceleration: one(&mut self.random),
            jerk: one(&mut self.random),
        };
        let taken = self
            .axis
            .set_override(factors, &mut Scope::new(self.scan, &mut self.log));
        assert!(taken.is_ok(), "case {}, scan {}: {taken:?}", self.seed, self.scan);
        self.changes += 1;
    }

    fn superimpose(&mut self) {
        let request = Superimpose {
            distance: self.random.between(-20.0, 20.0),
            dynamics: draw::dynamics(&mut self.random, &self.axis.config().limits),
        };
        match self.added {
            Some(id) if self.random.below(2) == 0 => {
                let _ended =
                    self.axis
                        .update_superimposed(id, &request, &mut Scope::new(self.scan, &mut self.log));
            }
            _ => {
                self.added = self
                    .axis
                    .superimpose(&request, &mut Scope::new(self.scan, &mut self.log))
                    .ok()
            }
        }
    }

    fn run(&mut self) {
        for _ in 0..4 + self.random.below(12) {
            match self.random.below(8) {
                0..3 => self.command(),
                3 | 4 => self.update(),
                5 | 6 => self.factors(),
                _ => self.superimpose(),
            }
            let scans = match self.random.below(3) {
                0 => self.random.below(2),
                1 => self.random.below(20),
                _ => self.random.below(200),
            };
            self.advance(scans);
        }
        self.end();
    }

    /// One aborting move with changes, until it ends.
    fn end(&mut self) {
        let kind = self.random.below(2);
        let mut command = self.values(kind);
        let from = self.axis.setpoint().position;
        let request = Request::aborting(command);
        let id = self
            .axis
            .command(&request, &mut Scope::new(self.scan, &mut self.log))
            .unwrap();
        for _ in 0..self.random.below(4) {
            let scans = self.random.below(60);
            self.advance(scans);
            let new = self.changed(command);
            let running = self.axis.active_command() == Some(id);
            if self
                .axis
                .update(id, &new, &mut Scope::new(self.scan, &mut self.log))
                .is_ok()
                && running
            {
                command = new;
            }
            self.factors();
        }
        self.axis
            .set_override(Factors::ONE, &mut Scope::new(self.scan, &mut self.log))
            .unwrap();
        let limit = self.scan + MOST_SCANS;
        while self.axis.fate(id) != Fate::Done {
            self.advance(1);
            assert!(
                self.scan < limit,
                "case {} never ends: {:?}",
                self.seed,
                self.axis.outlook()
            );
        }
        let end = self.axis.setpoint().position;
        let what = format!("case {}, {command:?} from {from}", self.seed);
        match command {
            Command::MoveAbsolute { position, .. } => assert_eq!(end.to_bits(), position.to_bits(), "{what}"),
            Command::MoveRelative { distance, .. } => match self.axis.config().modulo {
                None => assert_eq!(end.to_bits(), (from + distance).to_bits(), "{what}"),
                Some(length) => {
                    let turns = (end - from - distance) / length;
                    assert!((turns - turns.round()).abs() * length < 1e-9, "{what}: {end}");
                }
            },
            _ => unreachable!(),
        }
        for (id, _) in &self.commands {
            // The axis no longer remembers fates from long ago.
            let fate = self.axis.fate(*id);
            assert!(
                !matches!(fate, Fate::Waiting | Fate::Active { .. }),
                "{what}: {fate:?}"
            );
        }
    }
}

fn run(cases: core::ops::Range<u64>) {
    let count = cases.end - cases.start;
    let (mut changes, mut scans, mut exceeded, mut silent) = (0, 0, 0, Vec::new());
    for seed in cases {
        let mut case = Case::new(seed);
        case.run();
        changes += case.changes;
        scans += case.scan;
        exceeded += u64::from(case.exceeded);
        silent.extend(case.silent);
    }
    println!("{changes} changes in {scans} scans; {exceeded} of {count} cases out of a limit");
    println!("{} of them without a record: {silent:#?}", silent.len());
    assert!(exceeded * 1000 <= count, "{exceeded} of {count} cases");
    assert!(silent.is_empty(), "{silent:#?}");
}

/// Covers: R9, R12, R13, S6, B16, B17, V16
#[test]
fn changes_at_random_keep_the_limits_and_land_exactly() {
    run(0..cases(10_000));
}

/// Covers: R9, R12, R13, S6, B16, B17, V16
#[test]
#[ignore = "minutes"]
fn a_million_times() {
    run(10_000..1_010_000);
}
