//! Slaves with `on_limit` `slow_master` at random (G51): for any command to their master, all stay in
//! gear and no axis leaves its limits.
//!
//! A master has one to three slaves, some of them in a chain, with limits, orders and ratios of their own. From the
//! scan after the last one is in gear the master gets all kinds of planned motion: moves of every kind in every
//! buffer mode, an override, superimposed motions, halts and stops, a direction barred and permitted, power off.
//! Slaves get shifts. Left out are the motions without a plan within the bound of the slaves (docs/coupling.md):
//! faults of the master, a profile or torque in progress, homing by the drive, and writes to the limits of a slave.
//!
//! `SLOW_MASTER_CASES` runs more of them.

use crate::differences::Seen;
use crate::draw;
use crate::followed::behind;
use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, BufferMode, Command, CommandId, Dynamics, Event, Factors, Following,
    Limits, Log, OnLimit, Permission, PhaseShift, Raw, Request, Scope, Standard, Superimpose, ValueSource,
    couple, steps,
};
use standstill_testkit::{Random, cases, given};

const CYCLE: f64 = 0.01;
const CASES: u64 = 1500;
const SCANS: u64 = 600;
const MASTER: AxisId = AxisId::new(0);

/// The master of each slave; the first axis is the top master.
const TREES: [&[usize]; 5] = [&[0], &[0, 0], &[0, 1], &[0, 1, 0], &[0, 1, 2]];

fn axis(number: u16, limits: Limits) -> Axis {
    let config = AxisConfig {
        override_max: 2.0,
        following: Following {
            on_limit: OnLimit::SlowMaster,
            ..Following::DEFAULT
        },
        ..standing::config(limits)
    };
    Axis::new(AxisId::new(number), config, Standard::new(CYCLE)).unwrap()
}

struct Case {
    random: Random,
    axes: Vec<Axis>,
    limits: Vec<Limits>,
    log: Log,
    scan: u64,
    stop: Option<CommandId>,
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let tree = TREES[random.below(TREES.len() as u64) as usize];
        let limits: Vec<Limits> = (0..=tree.len()).map(|_| draw::limits(&mut random)).collect();
        let axes = (0..).zip(&limits).map(|(number, limits)| axis(number, *limits));
        let mut case = Self {
            axes: axes.collect(),
            random,
            limits,
            log: Log::default(),
            scan: 0,
            stop: None,
        };
        for (slave, &master) in (1..).zip(tree) {
            let sign = if case.random.below(2) == 0 { 1 } else { -1 };
            let numerator = sign * case.random.below(8) as i16;
            let ratio = (numerator, 1 + case.random.below(7) as u16);
            let command = Command::GearIn {
                followed: behind(&case.axes[master], ratio, ValueSource::Set),
                sync: None,
                dynamics: Dynamics::default(),
            };
            let scope = &mut Scope::new(0, &mut case.log);
            couple(
                &mut case.axes,
                AxisId::new(slave),
                &Request::aborting(command),
                scope,
            )
            .unwrap();
        }
        case
    }

    fn dynamics(&mut self) -> Dynamics {
        draw::dynamics(&mut self.random, &self.limits[0])
    }

    fn signed(&mut self, most: f64) -> f64 {
        self.random.between(-most, most)
    }

    fn motion(&mut self) -> Command {
        let dynamics = self.dynamics();
        let direction = Raw::default();
        let backwards = Dynamics {
            velocity: if self.random.below(2) == 0 {
                dynamics.velocity
            } else {
                -dynamics.velocity
            },
            ..dynamics
        };
        let end_velocity = self.signed(dynamics.velocity);
        let distance = self.signed(100.0);
        match self.random.below(9) {
            0 | 1 => Command::MoveAbsolute {
                position: distance,
                dynamics,
                direction,
            },
            2 => Command::MoveRelative { distance, dynamics },
            3 => Command::MoveAdditive { distance, dynamics },
            4 => Command::MoveVelocity {
                dynamics: backwards,
                direction,
            },
            5 => Command::MoveContinuousAbsolute {
                position: distance,
                end_velocity,
                dynamics,
                direction,
            },
            6 => Command::MoveContinuousRelative {
                distance,
                end_velocity,
                dynamics,
            },
            7 => Command::Jog {
                forward: distance > 0.0,
                distance: if end_velocity > 0.0 { 0.0 } else { distance.abs() },
                dynamics,
            },
            _ => Command::Halt { dynamics },
        }
    }

    /// A command for the master, or a shift for a slave. A command that the state of an axis refuses changes nothing.
    fn act(&mut self) {
        const MODES: [BufferMode; 6] = [
            BufferMode::Aborting,
            BufferMode::Buffered,
            BufferMode::BlendingLow,
            BufferMode::BlendingPrevious,
            BufferMode::BlendingNext,
            BufferMode::BlendingHigh,
        ];
        if let Some(stop) = self.stop.take_if(|_| self.random.below(3) == 0) {
            self.axes[0].release_stop(stop);
        }
        let kind = self.random.below(16);
        let command = self.motion();
        let dynamics = self.dynamics();
        let mode = MODES[self.random.below(12).min(5) as usize];
        let value = self.random.between(0.0, 1.0);
        let distance = self.signed(60.0);
        let slave = 1 + self.random.below(self.axes.len() as u64 - 1) as usize;
        let follows = self.axes[slave].master();
        let shift_mode = MODES[self.random.below(2) as usize];
        let shift_dynamics = if self.random.below(2) == 0 {
            Dynamics::default()
        } else {
            dynamics
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        let master = &mut self.axes[0];
        match kind {
            0..=7 => {
                let request = Request {
                    buffer_mode: mode.into(),
                    ..Request::aborting(command)
                };
                let _ = master.command(&request, scope);
            }
            8 => {
                self.stop = master
                    .command(&Request::aborting(Command::Stop { dynamics }), scope)
                    .ok()
                    .or(self.stop);
            }
            9 | 10 => {
                let _ = master.superimpose(&Superimpose { distance, dynamics }, scope);
            }
            11 => {
                let _ = master.halt_superimposed(&dynamics, scope);
            }
            12 => {
                let factors = Factors {
                    velocity: if value < 0.1 { 0.0 } else { 2.0 * value },
                    acceleration: 0.3 + value,
                    jerk: 1.0,
                };
                master.set_override(factors, scope).unwrap();
            }
            13 => {
                let permitted = Permission {
                    positive: value < 0.7,
                    negative: value > 0.2,
                };
                master.set_power(true, permitted, scope);
            }
            _ => {
                let request = PhaseShift {
                    master: follows.unwrap(),
                    shift: distance / 4.0,
                    is_relative: value < 0.5,
                    dynamics: shift_dynamics,
                    buffer_mode: shift_mode.into(),
                };
                let _ = self.axes[slave].shift_phase(&request, scope);
            }
        }
    }
}

fn stays_in_gear(seed: u64) {
    let mut case = Case::new(seed);
    let mut seen = vec![Seen::new(CYCLE); case.axes.len()];
    let mut told = 0;
    let pace = 2 + case.random.below(40);
    for scan in 0..SCANS {
        case.scan = scan;
        if scan == 0 {
            for axis in &mut case.axes {
                axis.set_power(true, Permission::BOTH, &mut Scope::new(0, &mut case.log));
            }
        }
        if (2..SCANS - 100).contains(&scan) && case.random.below(pace) == 0 {
            case.act();
        }
        if scan == SCANS - 100 {
            case.axes[0].set_power(false, Permission::BOTH, &mut Scope::new(scan, &mut case.log));
        }
        steps::advance(&mut case.axes, &mut Scope::new(scan, &mut case.log));
        let records: Vec<_> = case.log.since(told).copied().collect();
        told = case.log.total();
        for record in &records {
            let lost = matches!(record.event, Event::GearLost { .. } | Event::Fault { .. });
            assert!(!lost, "seed {seed}, scan {scan}: {record:?}");
        }
        for (index, (axis, seen)) in case.axes.iter().zip(&mut seen).enumerate() {
            let what = format!("seed {seed}, scan {scan}, axis {index}");
            seen.check(&axis.setpoint(), &case.limits[index], &what);
            if index > 0 && scan > 0 {
                assert!(axis.is_in_gear(), "{what}: {:?}", axis.coupled());
            }
        }
        if scan >= SCANS - 100 && case.axes[0].setpoint().is_at_rest() {
            return;
        }
        let state = case.axes[0].state();
        assert!(state != AxisState::ErrorStop, "seed {seed}, scan {scan}");
    }
}

#[test]
fn slaves_stay_in_gear_whatever_their_master_is_told() {
    for seed in 0..given("SLOW_MASTER_CASES", cases(CASES)) {
        stays_in_gear(seed);
    }
}

/// A bound that comes into force while the master slows down to another one, or turns back (found among 40,000
/// seeds).
#[test]
fn a_bound_that_comes_late_is_kept() {
    for seed in [10_425, 13_353, 15_360, 17_574, 19_180, 25_347, 30_520] {
        stays_in_gear(seed);
    }
}

/// The bound is what the slave can follow, and the master can use all of it.
#[test]
fn a_master_uses_all_that_its_slave_leaves() {
    for seed in 0..cases(200) {
        let mut case = Case::new(seed);
        let ratios: Vec<f64> = (1..case.axes.len())
            .map(|slave| {
                let (_, numerator, denominator) = case.axes[slave].gears()[0].unwrap();
                (f64::from(numerator) / f64::from(denominator)).abs()
            })
            .collect();
        let most = (1..case.axes.len()).fold(case.limits[0].velocity, |most, slave| {
            let mut ratio = ratios[slave - 1];
            let mut above = case.axes[slave].master().unwrap();
            while above != MASTER {
                ratio *= ratios[above.index() - 1];
                above = case.axes[above.index()].master().unwrap();
            }
            most.min(case.limits[slave].velocity / ratio)
        });
        let run = Command::MoveVelocity {
            dynamics: Dynamics::at(case.limits[0].velocity),
            direction: Raw::default(),
        };
        for scan in 0..4000 {
            let scope = &mut Scope::new(scan, &mut case.log);
            if scan == 2 {
                case.axes[0].command(&Request::aborting(run), scope).unwrap();
            }
            steps::advance(&mut case.axes, scope);
        }
        let velocity = case.axes[0].setpoint().velocity;
        assert!(
            (velocity - most).abs() <= 1e-9 * most,
            "seed {seed}: {velocity}, {most}"
        );
    }
}
