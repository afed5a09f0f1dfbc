//! Shifts of the coordinates under random motions. Increments and velocities continue as without a shift.

use super::rig::{CYCLE, Random, Rig};
use crate::standing;
use standstill_axis::{
    AxisConfig, Command, Direction, Dynamics, ExecutionMode, Fate, Limits, Scaling, Scope,
};

const LIMITS: Limits = Limits {
    velocity: 1000.0,
    acceleration: 10_000.0,
    deceleration: 10_000.0,
    jerk: 1e6,
    snap: f64::INFINITY,
};

fn config(modulo: Option<f64>) -> AxisConfig {
    AxisConfig {
        modulo,
        scaling: Scaling::new(8_388_608 * 7, 1080, false, 0.0).ok(),
        ..standing::config(LIMITS)
    }
}

/// Covers: V15
#[test]
fn increments_and_velocity_have_no_step() {
    let increment = 1080.0 / (8_388_608.0 * 7.0);
    for modulo in [None, Some(360.0)] {
        let mut rig = Rig::new(config(modulo));
        let mut random = Random(3);
        let dynamics = Dynamics::at(1000.0);
        let (mut before, mut velocity) = (None, 0.0);
        for scan in 0..30_000 {
            if scan % 500 == 0 {
                let direction = Direction::ShortestWay.into();
                rig.command(match random.below(4) {
                    0 => Command::MoveVelocity {
                        dynamics,
                        direction: Direction::Negative.into(),
                    },
                    1 => Command::Halt { dynamics },
                    2 => Command::MoveAbsolute {
                        position: random.between(0.0, 360.0),
                        dynamics,
                        direction,
                    },
                    _ => Command::MoveRelative {
                        distance: random.between(-500.0, 500.0),
                        dynamics,
                    },
                });
            }
            if random.below(40) == 0 {
                let relative = random.below(2) == 0;
                let position = random.between(0.0, 360.0);
                let (set, actual) = (rig.axis.setpoint().position, rig.axis.actual_position());
                let mode = ExecutionMode::Immediately.into();
                let id = rig
                    .axis
                    .set_position(position, relative, mode, &mut Scope::new(rig.scan, &mut rig.log))
                    .unwrap();
                assert_eq!(rig.axis.fate(id), Fate::Done);
                if !relative {
                    assert_eq!(rig.axis.actual_position(), position);
                }
                let moved = (rig.axis.setpoint().position - set) - (rig.axis.actual_position() - actual);
                let turns = (moved / 360.0).round() * if modulo.is_some() { 360.0 } else { 0.0 };
                assert!((moved - turns).abs() < 1e-9, "scan {scan}: both by the same");
            }
            let now = rig.step();
            let published = rig.axis.setpoint().velocity;
            assert!(
                (published - velocity).abs() <= 10_000.0 * CYCLE * (1.0 + 1e-9),
                "scan {scan}"
            );
            velocity = published;
            if let Some(before) = before.replace(now) {
                let moved = (now - before) as f64 * increment;
                assert!(
                    moved.abs() <= 1000.0 * CYCLE + 2.0 * increment,
                    "scan {scan}: {moved}"
                );
            }
        }
    }
}

/// MC_Home with a new position leaves increments unchanged.
#[test]
fn homing_leaves_increments_alone() {
    let mut rig = Rig::new(AxisConfig {
        position: 12.5,
        ..config(None)
    });
    let before = rig.step();
    let id = rig.command(Command::Home { position: -3.25 });
    assert_eq!(rig.run(id), Fate::Done);
    assert_eq!((rig.step(), rig.axis.setpoint().position), (before, -3.25));
    assert!((rig.axis.actual_position() + 3.25).abs() < 1e-4);
}
