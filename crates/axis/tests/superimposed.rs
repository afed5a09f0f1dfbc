//! Random superimposed motions: the sum keeps the limits of the axis, the motion under it is unchanged,
//! and both targets are reached to the bit.
//!
//! Every case runs two axes with the same commands. One of them also gets superimposed commands, at random times, in
//! both directions, halted or replaced while they run.

use crate::differences::Seen;
use crate::draw;
use crate::standing;
use standstill_axis::{
    Axis, AxisState, BufferMode, Command, CommandId, Direction, Dynamics, Fate, Limits, Log, Plan, Raw,
    Request, Scope, Setpoint, Superimpose,
};
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.01;
const CASES: u64 = 10_000;
/// A case that takes longer is a motion that never ends.
const MOST_SCANS: u64 = 40_000;

fn bits(setpoint: &Setpoint) -> [u64; 4] {
    [
        setpoint.position,
        setpoint.velocity,
        setpoint.acceleration,
        setpoint.jerk,
    ]
    .map(f64::to_bits)
}

struct Case {
    limits: Limits,
    random: Random,
    with: Axis,
    without: Axis,
    log: Log,
    scan: u64,
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let limits = draw::limits(&mut random);
        Self {
            limits,
            random,
            with: standing::axis(limits, CYCLE),
            without: standing::axis(limits, CYCLE),
            log: Log::default(),
            scan: 0,
        }
    }

    /// Gives the same command to both axes.
    fn command(&mut self, request: &Request) -> (CommandId, CommandId) {
        let with = self
            .with
            .command(request, &mut Scope::new(self.scan, &mut self.log))
            .unwrap();
        let without = self
            .without
            .command(request, &mut Scope::new(self.scan, &mut self.log))
            .unwrap();
        (with, without)
    }

    fn base(&mut self) -> (Command, Option<f64>) {
        let dynamics = draw::dynamics(&mut self.random, &self.limits);
        if self.random.below(4) == 0 {
            let direction: Raw<Direction> = Direction::Positive.into();
            let signed = if self.random.below(2) == 0 { 1.0 } else { -1.0 };
            let dynamics = Dynamics {
                velocity: signed * dynamics.velocity,
                ..dynamics
            };
            return (Command::MoveVelocity { dynamics, direction }, None);
        }
        let position = self.random.between(-150.0, 150.0);
        let direction: Raw<Direction> = Direction::Unset.into();
        (
            Command::MoveAbsolute {
                position,
                dynamics,
                direction,
            },
            Some(position),
        )
    }

    fn superimpose(&mut self) -> (CommandId, f64) {
        let distance = self.random.between(-60.0, 60.0);
        let request = Superimpose {
            distance,
            dynamics: draw::dynamics(&mut self.random, &self.limits),
        };
        let id = self
            .with
            .superimpose(&request, &mut Scope::new(self.scan, &mut self.log))
            .unwrap();
        (id, distance)
    }
}

/// One superimposed motion on one command. The command's own set-points and its end are the same to the bit, and the
/// axis ends at its target plus the distance.
fn one_on_one(seed: u64) {
    let mut case = Case::new(seed);
    let (base, target) = case.base();
    let (with, without) = case.command(&Request::aborting(base));
    let at = case.random.below(150);
    let mut added = None;
    let mut seen = Seen::new(CYCLE);
    for scan in 0..MOST_SCANS {
        case.scan = scan;
        if scan == at {
            // If the move is over by now, there is nothing to compare.
            added = Some(case.superimpose());
        }
        assert_eq!(
            case.with.fate(with),
            case.without.fate(without),
            "seed {seed}, scan {scan}"
        );
        case.with.step_alone(&mut Scope::new(scan, &mut case.log));
        case.without.step_alone(&mut Scope::new(scan, &mut case.log));
        let now = case.with.setpoint();
        seen.check(&now, &case.limits, &format!("seed {seed}, scan {scan}"));
        let twin = case.without.setpoint();
        if let Some((plan, elapsed)) = case.with.plan() {
            assert_eq!(bits(&plan.at(elapsed)), bits(&twin), "seed {seed}, scan {scan}");
        }
        let Some((id, distance)) = added else { continue };
        if case.with.fate(id) == Fate::Done && case.without.fate(without) != (Fate::Active { reached: false })
        {
            assert_eq!(case.with.covered_distance(id), Some(distance), "seed {seed}");
            match target {
                Some(target) => {
                    assert_eq!(case.with.state(), AxisState::Standstill, "seed {seed}");
                    // A move that was over counted its distance from its rest position: the sum is the same.
                    assert_eq!(now.position, target + distance, "seed {seed}");
                }
                None => assert_eq!(now.velocity, twin.velocity, "seed {seed}"),
            }
            return;
        }
        // An endless motion at the velocity limit never leaves room, or hardly any.
        if target.is_none() && scan > 20_000 {
            assert!(twin.velocity.abs() > 0.99 * case.limits.velocity, "seed {seed}");
            return;
        }
        assert!(
            !matches!(case.with.fate(id), Fate::Aborted | Fate::Failed(_)),
            "seed {seed}"
        );
    }
    panic!("seed {seed}: {:?}", case.with.outlook());
}

/// Any command on any motion: more superimposed motions, halts, and buffered moves under them. The sum keeps the
/// limits, nothing fails, and every motion ends.
fn many_on_many(seed: u64) {
    let mut case = Case::new(seed);
    let mut seen = Seen::new(CYCLE);
    let (mut last, mut halted) = (None, false);
    for scan in 0..MOST_SCANS {
        case.scan = scan;
        if scan < 400 && case.random.below(40) == 0 {
            match case.random.below(5) {
                0 | 1 => last = Some(case.superimpose().0),
                2 => {
                    let dynamics = draw::dynamics(&mut case.random, &case.limits);
                    last = Some(
                        case.with
                            .halt_superimposed(&dynamics, &mut Scope::new(case.scan, &mut case.log))
                            .unwrap(),
                    );
                }
                _ => {
                    let request = Request {
                        buffer_mode: BufferMode::Buffered.into(),
                        ..Request::aborting(case.base().0)
                    };
                    // A full buffer refuses.
                    let _ = case
                        .with
                        .command(&request, &mut Scope::new(case.scan, &mut case.log));
                }
            }
        }
        if scan >= 400 && !halted {
            let request = Request {
                buffer_mode: BufferMode::Buffered.into(),
                ..Request::aborting(Command::Halt {
                    dynamics: Dynamics::default(),
                })
            };
            halted = case
                .with
                .command(&request, &mut Scope::new(case.scan, &mut case.log))
                .is_ok();
        }
        case.with.step_alone(&mut Scope::new(scan, &mut case.log));
        let now = case.with.setpoint();
        seen.check(&now, &case.limits, &format!("seed {seed}, scan {scan}"));
        assert_ne!(
            case.with.state(),
            AxisState::ErrorStop,
            "seed {seed}, scan {scan}"
        );
        if scan > 400 && halted && case.with.state() == AxisState::Standstill {
            assert_eq!(case.with.outlook().superimposed, None, "seed {seed}");
            assert!(now.is_at_rest(), "seed {seed}");
            let ended = last.is_none_or(|id| matches!(case.with.fate(id), Fate::Done | Fate::Aborted));
            assert!(ended, "seed {seed}");
            return;
        }
    }
    panic!("seed {seed}: {:?}", case.with.outlook());
}

#[test]
fn the_move_under_it_keeps_its_bits_and_the_sum_its_limits() {
    for seed in 0..cases(CASES) {
        one_on_one(seed);
    }
}

#[test]
fn any_sequence_of_commands_keeps_the_limits_and_ends() {
    for seed in 0..cases(CASES) {
        many_on_many(seed);
    }
}
