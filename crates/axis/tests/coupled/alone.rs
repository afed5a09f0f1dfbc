//! Axes that follow no master, together with axes that do.

use super::rig::Rig;
use crate::standing;
use standstill_axis::{
    AxisConfig, AxisState, Command, Direction, Dynamics, ErrorId, Limits, Raw, Request, Scope,
};
use standstill_testkit::Random;

const CYCLE: f64 = 0.001;

/// The number of axes that are commanded at random.
const ALONE: usize = 3;

fn config(modulo: Option<f64>) -> AxisConfig {
    let limits = Limits {
        velocity: 200.0,
        acceleration: 1000.0,
        deceleration: 1500.0,
        jerk: 20_000.0,
        snap: 1e6,
    };
    AxisConfig {
        modulo,
        ..standing::config(limits)
    }
}

fn some_motion(random: &mut Random) -> Command {
    let dynamics = Dynamics::at(random.between(10.0, 200.0));
    let place = random.between(0.0, 360.0);
    match random.below(4) {
        0 => Command::Halt { dynamics },
        1 => Command::MoveAbsolute {
            position: place,
            dynamics,
            direction: Raw::from(Direction::ShortestWay),
        },
        2 => Command::MoveRelative {
            distance: place - 180.0,
            dynamics,
        },
        _ => Command::MoveVelocity {
            dynamics,
            direction: Raw::from(Direction::Positive),
        },
    }
}

/// A motion step without couplings runs other code than one in which an axis follows another.
///
/// Covers: G4
#[test]
fn they_move_as_they_do_alone_to_the_bit() {
    let alone = [config(None), config(Some(360.0)), config(None)];
    let more = [config(None), config(None), config(Some(360.0))];
    let mut one = Rig::new(&alone, CYCLE);
    let mut other = Rig::new(&[&alone[..], &more[..]].concat(), CYCLE);
    let mut random = Random(17);
    for scan in 0..20_000 {
        if random.one_in(50) {
            let (axis, command) = (random.place(ALONE), some_motion(&mut random));
            assert_eq!(
                one.command(axis, command).is_ok(),
                other.command(axis, command).is_ok()
            );
        }
        // The other axes couple, move and uncouple.
        if random.one_in(200) {
            let master = ALONE + random.place(3);
            let slave = ALONE + (master - ALONE + 1) % 3;
            let command = match random.below(3) {
                0 => some_motion(&mut random),
                1 => Command::GearOut,
                _ => other.gear(master, (random.one_of(&[1, -2, 3]), 2), None, Dynamics::default()),
            };
            let _may_be_refused = other.command(slave, command);
        }
        one.step();
        other.step();
        for (one, other) in one.axes.iter().zip(&other.axes) {
            assert_eq!(one.setpoint(), other.setpoint(), "scan {scan}");
            assert_eq!(
                one.setpoint().position.to_bits(),
                other.setpoint().position.to_bits()
            );
            assert_eq!(one.state(), other.state());
        }
    }
    assert!(other.axes[ALONE..].iter().any(|axis| axis.gears()[0].is_some()));
}

/// An axis by itself knows no masters; `couple` does.
#[test]
fn an_axis_by_itself_follows_no_other() {
    let mut rig = Rig::new(&[config(None), config(None)], CYCLE);
    let gear = Request::aborting(rig.gear(0, (1, 1), None, Dynamics::default()));
    let refused = rig.axes[1].command(&gear, &mut Scope::new(rig.scan, &mut rig.log));
    assert_eq!(refused, Err(ErrorId::AxisUnknown));
    assert_eq!(rig.axes[1].state(), AxisState::Standstill);
}
