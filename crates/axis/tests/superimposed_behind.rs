//! Random superimposed motions on slaves. The sum keeps the limits of the slave, the law under it is unchanged, and
//! in the end the slave is shifted by the added distance.
//!
//! Every case runs a master, a slave that also gets superimposed commands, and an equal slave that does not. The
//! master gets new targets at random times, so the added motion has to wait, to slow down, or to end the gear.
//!
//! Covers: G66.

use crate::differences::Seen;
use crate::draw;
use crate::followed::behind;
use crate::standing;
use standstill_axis::{
    Axis, AxisId, AxisState, Command, CommandId, Direction, Dynamics, Fate, Limits, Log, Raw, Request, Scope,
    Standard, Superimpose, ValueSource, couple, steps,
};
use standstill_testkit::{Random, cases};

const CYCLE: f64 = 0.01;
const CASES: u64 = 5000;
/// From this scan on there are no new commands.
const ASKED: u64 = 400;
/// A case that takes longer is a motion that never ends.
const MOST_SCANS: u64 = 40_000;

const MASTER: usize = 0;
const SLAVE: usize = 1;
const TWIN: usize = 2;

struct Case {
    seed: u64,
    random: Random,
    axes: [Axis; 3],
    /// Limits of the master, and of the slave and its twin.
    limits: [Limits; 2],
    ratio: (i16, u16),
    log: Log,
    scan: u64,
}

/// Limits of a slave: those of its master, times the ratio and times `room`.
fn able(limits: &Limits, ratio: f64, room: f64) -> Limits {
    let by = ratio * room;
    Limits {
        velocity: limits.velocity * by,
        acceleration: limits.acceleration.max(limits.deceleration) * by,
        deceleration: limits.acceleration.max(limits.deceleration) * by,
        jerk: limits.jerk * by,
        snap: limits.snap * by,
    }
}

impl Case {
    fn new(seed: u64) -> Self {
        let mut random = Random(seed);
        let master = draw::limits(&mut random);
        let numerator = 1 + random.below(4) as i16;
        let ratio = (
            if random.below(2) == 0 {
                numerator
            } else {
                -numerator
            },
            1 + random.below(3) as u16,
        );
        let size = f64::from(ratio.0.abs()) / f64::from(ratio.1);
        let slave = match random.below(4) {
            0 => draw::limits(&mut random),
            _ => able(&master, size, random.between(1.0, 3.0)),
        };
        let axis = |number, limits| {
            let config = standing::config(limits);
            Axis::new(AxisId::new(number), config, Standard::new(CYCLE)).unwrap()
        };
        Self {
            seed,
            random,
            axes: [axis(0, master), axis(1, slave), axis(2, slave)],
            limits: [master, slave],
            ratio,
            log: Log::default(),
            scan: 0,
        }
    }

    fn couple(&mut self, slave: usize) {
        let command = Command::GearIn {
            followed: behind(&self.axes[MASTER], self.ratio, ValueSource::Set),
            sync: None,
            dynamics: Dynamics::default(),
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        let slave = AxisId::new(slave as u16);
        couple(&mut self.axes, slave, &Request::aborting(command), scope).unwrap();
    }

    fn move_master(&mut self) {
        let dynamics = draw::dynamics(&mut self.random, &self.limits[0]);
        let command = match self.random.below(4) {
            0 => Command::Halt { dynamics },
            1 => Command::MoveAbsolute {
                position: self.random.between(-150.0, 150.0),
                dynamics,
                direction: Raw::from(Direction::Unset),
            },
            _ => {
                let sign = if self.random.below(2) == 0 { 1.0 } else { -1.0 };
                let velocity = sign * dynamics.velocity;
                let dynamics = Dynamics { velocity, ..dynamics };
                let direction = Raw::from(Direction::Positive);
                Command::MoveVelocity { dynamics, direction }
            }
        };
        let scope = &mut Scope::new(self.scan, &mut self.log);
        self.axes[MASTER]
            .command(&Request::aborting(command), scope)
            .unwrap();
    }

    fn superimpose(&mut self) -> CommandId {
        let dynamics = draw::dynamics(&mut self.random, &self.limits[1]);
        let distance = self.random.between(-60.0, 60.0);
        let scope = &mut Scope::new(self.scan, &mut self.log);
        if self.random.below(6) == 0 {
            return self.axes[SLAVE].halt_superimposed(&dynamics, scope).unwrap();
        }
        let request = Superimpose { distance, dynamics };
        self.axes[SLAVE].superimpose(&request, scope).unwrap()
    }

    fn superimposed(&self) -> f64 {
        self.axes[SLAVE]
            .coupled()
            .map_or(0.0, |coupled| coupled.superimposed)
    }

    /// The distance of the slave from its twin plus the added distance, and the largest rounding error of it.
    fn off(&self) -> (f64, f64) {
        let [master, slave, twin] = [MASTER, SLAVE, TWIN].map(|axis| self.axes[axis].setpoint().position);
        let added = self.superimposed();
        let size = slave.abs() + twin.abs() + added.abs() + 4.0 * master.abs();
        ((slave - twin - added).abs(), 4.0 * f64::EPSILON * size)
    }
}

/// Any superimposed command on a slave, for any motion of its master.
fn play(seed: u64) {
    let mut case = Case::new(seed);
    case.couple(SLAVE);
    case.couple(TWIN);
    let mut seen = Seen::new(CYCLE);
    let mut last = None;
    for scan in 0..MOST_SCANS {
        case.scan = scan;
        if scan < ASKED && case.random.below(60) == 0 {
            case.move_master();
        }
        if scan < ASKED && case.random.below(40) == 0 {
            last = Some(case.superimpose());
        }
        if scan == ASKED {
            let dynamics = Dynamics::default();
            let scope = &mut Scope::new(scan, &mut case.log);
            let halt = Request::aborting(Command::Halt { dynamics });
            case.axes[MASTER].command(&halt, scope).unwrap();
        }
        steps::advance(&mut case.axes, &mut Scope::new(scan, &mut case.log));
        let what = format!("seed {seed}, scan {scan}");
        let size = f64::from(case.ratio.0) / f64::from(case.ratio.1);
        seen.made_of(size * case.axes[MASTER].setpoint().position);
        seen.check(&case.axes[SLAVE].setpoint(), &case.limits[1], &what);
        assert_eq!(case.axes[SLAVE].state(), AxisState::SynchronizedMotion, "{what}");
        // A slave that was out of gear returns to the same law.
        if case.axes[SLAVE].is_in_gear() && case.axes[TWIN].is_in_gear() {
            let (off, resolved) = case.off();
            assert!(off <= resolved, "{what}: {off:e}");
        }
        let rests = case.axes.iter().all(|axis| axis.setpoint().is_at_rest());
        let ended = last.is_none_or(|id| matches!(case.axes[SLAVE].fate(id), Fate::Done | Fate::Aborted));
        if scan > ASKED && rests && ended && case.axes[SLAVE].is_in_gear() {
            assert_eq!(case.axes[SLAVE].outlook().superimposed, None, "{what}");
            return;
        }
    }
    panic!("seed {}: {:?}", case.seed, case.axes[SLAVE].outlook());
}

#[test]
fn the_sum_of_law_and_distance_keeps_the_limits_and_ends() {
    for seed in 0..cases(CASES) {
        play(seed);
    }
}
