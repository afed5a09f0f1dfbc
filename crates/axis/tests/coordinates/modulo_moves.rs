//! Random moves on modulo axes against the rule for Direction, which is stated here independently of the axis: the
//! length of the whole travel, no reversal that is not permitted, and the target met to the bit.

use super::rig::{CYCLE, Random, Rig};
use crate::standing;
use standstill_axis::{
    AxisConfig, BufferMode, Command, Direction, DrivePosition, Dynamics, Fate, IdealDrive, Limits,
    Permission, Request, Scaling, Scope, StartState,
};

fn dynamics(random: &mut Random, limits: &Limits) -> Dynamics {
    let mut part = |limit: f64| {
        if limit.is_finite() {
            limit * random.between(0.3, 1.0)
        } else {
            0.0
        }
    };
    Dynamics {
        velocity: part(limits.velocity),
        acceleration: part(limits.acceleration),
        deceleration: part(limits.deceleration),
        jerk: part(limits.jerk),
        snap: part(limits.snap),
    }
}

fn random_config(random: &mut Random) -> AxisConfig {
    let length = [360.0, 1.0, std::f64::consts::TAU, 7.0 / 3.0, 5000.0][random.below(5) as usize];
    let velocity = length * random.between(0.2, 20.0);
    let acceleration = velocity * random.between(0.5, 30.0);
    let jerk = acceleration * random.between(2.0, 50.0);
    let snap = jerk * random.between(5.0, 100.0);
    let order = random.below(3);
    let limits = Limits {
        velocity,
        acceleration,
        deceleration: acceleration * random.between(0.5, 1.5),
        jerk: if order > 0 { jerk } else { f64::INFINITY },
        snap: if order > 1 { snap } else { f64::INFINITY },
    };
    let scaling = match random.below(3) {
        0 => None,
        1 => Scaling::new(8_388_608 * 7, 1080, false, 0.0).ok(),
        _ => Scaling::new(1000, 7, true, 0.25).ok(),
    };
    AxisConfig {
        modulo: Some(length),
        position: length * random.unit(),
        scaling: scaling.filter(|scaling| scaling.turn(length).is_some()),
        ..standing::config(limits)
    }
}

/// A turn of 360 u, and of 2^23 * 7 / 3 increments; no jerk limit.
fn gear(limit: f64, invert: bool, offset: f64) -> AxisConfig {
    let limits = Limits {
        velocity: limit,
        acceleration: 10.0 * limit,
        deceleration: 10.0 * limit,
        jerk: f64::INFINITY,
        snap: f64::INFINITY,
    };
    AxisConfig {
        modulo: Some(360.0),
        scaling: Scaling::new(8_388_608 * 7, 1080, invert, offset).ok(),
        ..standing::config(limits)
    }
}

/// Units per increment of that gear.
const INCREMENT: f64 = 1080.0 / (8_388_608.0 * 7.0);

/// The table: the travel if the target is `ahead`, from 0 to a turn, and a stop travels `stop`.
fn expected(direction: Direction, ahead: f64, length: f64, forward: bool, stop: f64, slack: f64) -> f64 {
    match direction {
        Direction::Unset | Direction::ShortestWay if ahead <= length / 2.0 => ahead,
        Direction::Unset | Direction::ShortestWay => ahead - length,
        Direction::Current => {
            let direction = if forward {
                Direction::Positive
            } else {
                Direction::Negative
            };
            expected(direction, ahead, length, forward, stop, slack)
        }
        Direction::Positive => {
            let mut way = ahead;
            while way < stop - slack {
                way += length;
            }
            way
        }
        Direction::Negative => {
            let mut way = if ahead == 0.0 { 0.0 } else { ahead - length };
            while way > stop + slack {
                way -= length;
            }
            way
        }
    }
}

#[test]
fn random_moves_follow_the_table() {
    let directions = [
        Direction::Unset,
        Direction::Positive,
        Direction::ShortestWay,
        Direction::Negative,
        Direction::Current,
    ];
    let mut repetitions = 0;
    for seed in 0..standstill_testkit::cases(3000) {
        let mut random = Random(seed);
        let config = random_config(&mut random);
        let length = config.modulo.unwrap();
        let mut rig = Rig::new(config);
        // In motion in either direction, at rest after it, or at rest from the beginning.
        let sign = if random.below(2) == 0 { 1.0 } else { -1.0 };
        let mut forward = true;
        let start = random.below(4);
        if start > 0 {
            let mut dynamics = dynamics(&mut random, &config.limits);
            dynamics.velocity *= sign;
            let direction = Direction::Positive.into();
            rig.command(Command::MoveVelocity { dynamics, direction });
            for _ in 0..1 + random.below(1500) {
                rig.step();
            }
            forward = sign > 0.0;
        }
        if start == 1 {
            let dynamics = dynamics(&mut random, &config.limits);
            let halt = rig.command(Command::Halt { dynamics });
            rig.run(halt);
        }
        let here = rig.axis.setpoint();
        let target = match random.below(6) {
            0 => here.position,
            1 => 0.0,
            _ => length * random.unit(),
        };
        let direction = directions[random.below(5) as usize];
        let dynamics = dynamics(&mut random, &config.limits);

        rig.forget();
        let mut halted = rig.clone();
        let halt = halted.command(Command::Halt { dynamics });
        halted.run(halt);
        let stop = halted.way;

        let id = rig.command(Command::MoveAbsolute {
            position: target,
            dynamics,
            direction: direction.into(),
        });
        assert_eq!(rig.run(id), Fate::Done, "seed {seed}");
        assert_eq!(
            rig.axis.setpoint().position,
            target,
            "seed {seed}: met to the bit"
        );

        let mut ahead = target - here.position;
        if ahead < 0.0 {
            ahead += length;
        }
        let slack = 1e-8 * (length + stop.abs());
        let way = expected(direction, ahead, length, forward, stop, slack);
        // Beyond its limits a command may stop with the higher ones of the motion before, in a shorter distance.
        let outside = here.velocity.abs() > dynamics.velocity
            || here.acceleration.abs() > dynamics.acceleration.min(dynamics.deceleration)
            || (dynamics.jerk > 0.0 && here.jerk.abs() > dynamics.jerk);
        let turns = (rig.way - way) / length;
        let fewer = outside && (turns - turns.round()).abs() < 1e-8 && rig.way.abs() < way.abs();
        assert!(
            fewer || (rig.way - way).abs() < slack,
            "seed {seed}: {direction:?} from {here:?} to {target} of {length}: {} instead of {way}, stop {stop}",
            rig.way
        );
        repetitions += usize::from(way.abs() >= length);
        let only_forward = match direction {
            Direction::Positive => Some(true),
            Direction::Negative => Some(false),
            Direction::Current => Some(forward),
            Direction::Unset | Direction::ShortestWay => None,
        };
        let slow = 1e-6 * config.limits.velocity;
        match only_forward {
            Some(true) if here.velocity >= 0.0 && stop >= 0.0 => {
                assert!(rig.least > -slow, "seed {seed}: {}", rig.least);
            }
            Some(false) if here.velocity <= 0.0 && stop <= 0.0 => {
                assert!(rig.most < slow, "seed {seed}: {}", rig.most);
            }
            _ => {}
        }
    }
    assert!(
        repetitions > standstill_testkit::whole_or(200, 0),
        "{repetitions}"
    );
}

#[test]
fn distances_beyond_a_turn_are_gone_in_full() {
    for seed in 0..standstill_testkit::cases(300) {
        let mut random = Random(seed);
        let config = random_config(&mut random);
        let length = config.modulo.unwrap();
        let mut rig = Rig::new(config);
        let distance = length * random.between(-40.0, 40.0);
        let here = rig.axis.setpoint().position;
        let dynamics = dynamics(&mut random, &config.limits);
        let id = rig.command(Command::MoveRelative { distance, dynamics });
        assert_eq!(rig.run(id), Fate::Done, "seed {seed}");
        let tolerance = 1e-9 * length;
        assert!((rig.way - distance).abs() < tolerance, "seed {seed}");
        let end = (here + distance).rem_euclid(length);
        let off = (rig.axis.setpoint().position - end).abs();
        assert!(off < tolerance || (off - length).abs() < tolerance, "seed {seed}");
    }
}

/// Increments continue steadily in any turn, and the feedback is the set-point of the scan before, to within an
/// increment.
#[test]
fn increments_never_jump() {
    for invert in [false, true] {
        let config = AxisConfig {
            position: 350.0,
            ..gear(3600.0, invert, 11.0)
        };
        let mut rig = Rig::new(config);
        let dynamics = Dynamics::at(3600.0);
        let mut random = Random(7);
        let mut before = None;
        for scan in 0..20_000 {
            if scan % 700 == 0 {
                let direction = if random.below(2) == 0 {
                    Direction::Positive.into()
                } else {
                    Direction::Negative.into()
                };
                rig.command(match random.below(3) {
                    0 => Command::MoveVelocity { dynamics, direction },
                    1 => Command::MoveAbsolute {
                        position: 359.9,
                        dynamics,
                        direction,
                    },
                    _ => Command::MoveRelative {
                        distance: random.between(-3000.0, 3000.0),
                        dynamics,
                    },
                });
            }
            let published = rig.axis.setpoint().position;
            let now = rig.step();
            let off = (rig.axis.actual_position() - published).abs();
            assert!(
                off < INCREMENT || (off - 360.0).abs() < INCREMENT,
                "scan {scan}: {off}"
            );
            if let Some(before) = before.replace(now) {
                let moved = (now - before) as f64 * INCREMENT;
                assert!(
                    moved.abs() < 3600.0 * CYCLE + 2.0 * INCREMENT,
                    "scan {scan}: {moved}"
                );
            }
        }
    }
}

#[test]
fn a_thousand_million_turns_out_every_increment_is_right() {
    const TURNS: i64 = 1_000_000_000;
    for invert in [false, true] {
        let scaling = Scaling::new(8_388_608 * 7, 1080, invert, 0.0).unwrap();
        let turn = scaling.turn(360.0).unwrap();
        assert_eq!((turn.increments(), turn.turns()), (8_388_608 * 7, 3));
        let sign = if invert { -1 } else { 1 };
        for turns in TURNS..TURNS + 3 {
            for position in [0.0, 0.001, 90.0, 123.456, 359.999_999] {
                let there = scaling.to_increments_turned(&turn, turns, position);
                // Whole turns in thirds of an increment, exactly.
                let thirds = i128::from(turns) * 8_388_608 * 7;
                let near = (thirds % 3) as f64 / 3.0 + position / INCREMENT;
                let off = (i128::from(there * sign) - thirds / 3) as f64 - near;
                assert!(off.abs() <= 0.5 + 1e-6, "{off} at {position}");
                let (back_turns, back) = scaling.to_units_turned(&turn, 360.0, there);
                let whole = (back_turns - turns) as f64 * 360.0;
                assert!((back + whole - position).abs() <= 0.5001 * INCREMENT);
            }
        }
    }
}

/// An axis starts 10^9 turns away, runs and reverses: the increments are those near 0, shifted, and the positions
/// have the same bits.
#[test]
fn an_axis_a_thousand_million_turns_out_moves_as_one_at_home() {
    let config = AxisConfig {
        start: StartState::Disabled,
        ..gear(3600.0, false, 0.0)
    };
    // Three turns are a whole number of increments.
    let far = 1_000_000_002 / 3 * 8_388_608 * 7;
    let run = |base: i64| {
        let mut rig = Rig::new(config);
        rig.drive = IdealDrive::new(DrivePosition::Increments(base), 0, Some(0), false);
        let dynamics = Dynamics::at(3600.0);
        let mut rows = Vec::new();
        for scan in 0..4000 {
            rig.axis
                .set_power(true, Permission::BOTH, &mut Scope::new(rig.scan, &mut rig.log));
            if scan == 10 {
                let direction = Direction::Positive.into();
                rig.command(Command::MoveVelocity { dynamics, direction });
            }
            if scan == 2000 {
                rig.command(Command::MoveAbsolute {
                    position: 359.0,
                    dynamics,
                    direction: Direction::Negative.into(),
                });
            }
            let increments = rig.step() - base;
            let (actual, position) = (rig.axis.actual_position(), rig.axis.setpoint().position);
            rows.push((increments, actual.to_bits(), position.to_bits()));
        }
        assert_eq!(rig.axis.setpoint().position, 359.0);
        rows
    };
    assert!(run(0) == run(far), "the same increments, the same bits");
}

/// Enough turns that a lost increment would show if it were lost in a hundred turns.
#[test]
fn many_turns_end_on_the_increment_of_the_position() {
    let mut rig = Rig::new(gear(72_000.0, false, 0.0));
    let dynamics = Dynamics::at(72_000.0);
    let direction = Direction::Positive.into();
    rig.command(Command::MoveVelocity { dynamics, direction });
    for _ in 0..500_000 {
        rig.step();
    }
    let id = rig.command(Command::MoveAbsolute {
        position: 120.0,
        dynamics,
        direction: Direction::Positive.into(),
    });
    assert_eq!(rig.run(id), Fate::Done);
    let increments = rig.step();
    let turns = (rig.way / 360.0).round() as i64;
    assert!(turns > 99_000, "{turns}");
    // 120 u are a third of a turn, where increments are whole.
    let thirds = turns * 8_388_608 * 7 + 8_388_608 * 7 / 3;
    assert!((3 * increments - thirds).abs() <= 2, "{increments} {thirds}");
}

#[test]
fn buffered_moves_find_their_way_from_where_they_start() {
    let mut rig = Rig::new(gear(100.0, false, 0.0));
    let dynamics = Dynamics::at(100.0);
    rig.command(Command::MoveRelative {
        distance: 300.0,
        dynamics,
    });
    let request = Request {
        buffer_mode: BufferMode::Buffered.into(),
        ..Request::aborting(Command::MoveAbsolute {
            position: 100.0,
            dynamics,
            direction: Direction::ShortestWay.into(),
        })
    };
    let id = rig
        .axis
        .command(&request, &mut Scope::new(rig.scan, &mut rig.log))
        .unwrap();
    // From 0, where it is commanded, the travel would be 100; from 300 it is 160.
    assert_eq!(rig.run(id), Fate::Done);
    assert!((rig.way - 460.0).abs() < 1e-9, "{}", rig.way);
}
