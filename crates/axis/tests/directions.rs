//! Directions barred at random, under random moves. In a barred direction an axis only brakes, and a paused command
//! comes to its end once it is permitted.

use crate::draw;
use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, BufferMode, Command, CommandId, Direction, Dynamics, ErrorId, Factors, Fate,
    Limits, Log, Permission, Plan, Planner, Raw, Request, Scope, Standard, Superimpose,
};
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.01;
const CASES: u64 = 4_000;
/// Scans with random commands and permissions; afterwards everything is permitted.
const RESTLESS: u64 = 400;
/// A case that takes longer is a motion that never ends.
const MOST_SCANS: u64 = 20_000;

fn command(random: &mut Random, limits: &Limits) -> Command {
    let dynamics = Dynamics::at(limits.velocity * random.between(0.1, 1.0));
    let way = random.between(-60.0, 60.0);
    let direction = Raw::from(Direction::Unset);
    match random.below(7) {
        0 | 1 => Command::MoveAbsolute {
            position: way,
            dynamics,
            direction,
        },
        2 => Command::MoveRelative {
            distance: way,
            dynamics,
        },
        3 => Command::MoveAdditive {
            distance: way,
            dynamics,
        },
        4 => Command::MoveContinuousRelative {
            distance: way,
            end_velocity: dynamics.velocity * random.between(-1.0, 1.0),
            dynamics,
        },
        5 => Command::MoveVelocity {
            dynamics: Dynamics {
                velocity: dynamics.velocity * random.between(-1.0, 1.0),
                ..dynamics
            },
            direction,
        },
        _ => Command::Halt { dynamics },
    }
}

struct Case {
    axis: Axis,
    log: Log,
    random: Random,
    permitted: Permission,
    scan: u64,
    given: Vec<CommandId>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let limits = draw::limits(&mut random);
        let config = AxisConfig {
            stop_deceleration: (random.below(2) == 0).then_some(limits.deceleration * 0.4),
            ..standing::config(limits)
        };
        Self {
            axis: Axis::new(AxisId::new(0), config, Standard::new(CYCLE)).unwrap(),
            log: Log::default(),
            random,
            permitted: Permission::BOTH,
            scan: 0,
            given: Vec::new(),
        }
    }

    /// Whether `error` is one that a barred command may show.
    fn is_fair(&self, error: ErrorId) -> bool {
        match error {
            ErrorId::PositiveBarred => !self.permitted.positive,
            ErrorId::NegativeBarred => !self.permitted.negative,
            ErrorId::BufferFull => true,
            _ => false,
        }
    }

    /// The distances that an immediate stop still travels up and down (u).
    fn braking(&self) -> [f64; 2] {
        let config = self.axis.config();
        let limits = Limits {
            deceleration: config.stop_deceleration.unwrap_or(config.limits.deceleration),
            ..config.limits
        };
        let planner = Standard::new(CYCLE);
        let ramp = planner
            .ramp_to(&self.axis.setpoint(), 0.0, &limits, &limits)
            .unwrap();
        let (up, down) = planner.ways((&ramp, 0));
        [up, down]
    }

    /// The last records of the axis.
    fn story(&self) -> String {
        let last = self.log.total().saturating_sub(12);
        self.log.since(last).fold(String::new(), |story, record| {
            format!("{story}\n{} {:?}", record.scan, record.event)
        })
    }

    fn disturb(&mut self, superimposes: bool) {
        if self.random.below(30) == 0 {
            self.permitted = Permission {
                positive: self.random.below(2) == 0,
                negative: self.random.below(2) == 0,
            };
        }
        self.axis
            .set_power(true, self.permitted, &mut Scope::new(self.scan, &mut self.log));
        if self.random.below(40) == 0 {
            let factors = Factors {
                velocity: [0.0, 0.3, 1.0][self.random.below(3) as usize],
                acceleration: self.random.between(0.2, 1.0),
                ..Factors::ONE
            };
            let changed = self
                .axis
                .set_override(factors, &mut Scope::new(self.scan, &mut self.log));
            assert!(changed.is_ok(), "{changed:?} in {}: {}", self.scan, self.story());
        }
        let limits = self.axis.config().limits;
        if self.random.below(25) == 0 {
            let mode = match self.random.below(4) {
                0 => BufferMode::Buffered,
                1 if !superimposes => BufferMode::BlendingHigh,
                _ => BufferMode::Aborting,
            };
            let request = Request {
                buffer_mode: mode.into(),
                ..Request::aborting(command(&mut self.random, &limits))
            };
            match self
                .axis
                .command(&request, &mut Scope::new(self.scan, &mut self.log))
            {
                Ok(id) => self.given.push(id),
                Err(error) => assert!(
                    self.is_fair(error),
                    "{error:?} for {request:?} in {}: {}",
                    self.scan,
                    self.story()
                ),
            }
        }
        if superimposes && self.random.below(40) == 0 {
            let request = Superimpose {
                distance: self.random.between(-20.0, 20.0),
                dynamics: Dynamics::at(limits.velocity * 0.3),
            };
            match self
                .axis
                .superimpose(&request, &mut Scope::new(self.scan, &mut self.log))
            {
                Ok(id) => self.given.push(id),
                Err(error) => assert!(
                    self.is_fair(error),
                    "{error:?} for {request:?} in {}: {}",
                    self.scan,
                    self.story()
                ),
            }
        }
    }
}

/// Covers: V9
#[test]
fn in_a_barred_direction_an_axis_only_brakes() {
    let mut paused = 0;
    for seed in 0..cases(CASES) {
        let mut case = Case::new(seed);
        // For each direction: it was barred in the scan before, and an immediate stop would not have moved in it.
        let mut over = [false; 2];
        for _ in 0..RESTLESS {
            case.disturb(false);
            case.axis.step_alone(&mut Scope::new(case.scan, &mut case.log));
            case.scan += 1;
            let outlook = case.axis.outlook();
            paused += u64::from(outlook.paused);
            let velocity = case.axis.setpoint().velocity;
            let barred = [!case.permitted.positive, !case.permitted.negative];
            let ahead = [velocity, -velocity].into_iter().zip(case.braking());
            for ((over, barred), (speed, braking)) in over.iter_mut().zip(barred).zip(ahead) {
                let what = || format!("seed {seed}, scan {}: {}", case.scan, case.story());
                assert!(!*over || !barred || speed <= 1e-6, "{velocity} in {}", what());
                *over = barred && braking < 1e-9;
            }
        }
    }
    assert!(paused > cases(CASES), "{paused} scans paused");
}

/// Covers: V9
#[test]
fn what_was_paused_comes_to_its_end() {
    for seed in 0..cases(CASES / 4) {
        let mut case = Case::new(seed);
        for _ in 0..RESTLESS {
            case.disturb(true);
            case.axis.step_alone(&mut Scope::new(case.scan, &mut case.log));
            case.scan += 1;
        }
        while !case.axis.outlook().waiting.iter().all(Option::is_none)
            || case.axis.outlook().paused
            || case
                .axis
                .plan()
                .is_some_and(|(plan, elapsed)| elapsed < u64::from(plan.scans()))
            || case
                .axis
                .outlook()
                .superimposed
                .is_some_and(|beside| beside.command.is_some())
        {
            case.axis
                .set_power(true, Permission::BOTH, &mut Scope::new(case.scan, &mut case.log));
            let changed = case
                .axis
                .set_override(Factors::ONE, &mut Scope::new(case.scan, &mut case.log));
            assert!(changed.is_ok(), "seed {seed}: {changed:?}");
            case.axis.step_alone(&mut Scope::new(case.scan, &mut case.log));
            case.scan += 1;
            assert!(case.scan < MOST_SCANS, "seed {seed}: {:?}", case.axis.outlook());
        }
        for id in &case.given {
            let fate = case.axis.fate(*id);
            let fair = match fate {
                Fate::Done | Fate::Aborted | Fate::Active { .. } => true,
                Fate::Failed(error) => matches!(
                    error,
                    ErrorId::PositiveBarred | ErrorId::NegativeBarred | ErrorId::FateLost
                ),
                Fate::Waiting => false,
            };
            assert!(fair, "seed {seed}: {fate:?}");
        }
    }
}
