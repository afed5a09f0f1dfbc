//! The forecast of an axis for its next motion.

use crate::standing;
use standstill_axis::{
    Axis, AxisState, BufferMode, Command, Direction, Dynamics, ErrorId, Limits, Log, Request, Scope,
    Superimpose,
};

/// An axis at rest with limits of 100 u/s and 1000 u/s^2.
fn axis() -> Axis {
    let limits = Limits {
        velocity: 100.0,
        acceleration: 1000.0,
        deceleration: 1000.0,
        ..Limits::NONE
    };
    standing::axis(limits, 0.01)
}

fn at(velocity: f64, acceleration: f64) -> Dynamics {
    Dynamics {
        velocity,
        acceleration,
        ..Dynamics::default()
    }
}

fn tried_in(axis: &Axis) -> u32 {
    axis.outlook().superimposed.map_or(0, |beside| beside.tried_in)
}

/// Starts the axis with `acceleration` up to 50 u/s, and after ten scans adds 200 u at `faster`.
fn moving(acceleration: f64, faster: f64) -> (Axis, Log) {
    let (mut axis, mut log) = (axis(), Log::default());
    let command = Command::MoveVelocity {
        dynamics: at(50.0, acceleration),
        direction: Direction::Unset.into(),
    };
    axis.command(&Request::aborting(command), &mut Scope::new(0, &mut log))
        .expect("taken");
    for scan in 0..10 {
        axis.step_alone(&mut Scope::new(scan, &mut log));
    }
    let added = Superimpose {
        distance: 200.0,
        dynamics: at(faster, 500.0),
    };
    axis.superimpose(&added, &mut Scope::new(0, &mut log))
        .expect("taken");
    (axis, log)
}

#[test]
fn what_was_lowered_is_tried_again_until_that_is_in_vain_and_before_the_owner_has_its_velocity() {
    // 50 u/s at 100 u/s^2 takes 50 scans, of which 10 have passed. Room for 60 u/s more never exists.
    let (mut axis, mut log) = moving(100.0, 60.0);
    let mut tried_in_vain = 0;
    for left in (1..=40).rev() {
        let tried = tried_in(&axis);
        if left > 3 && tried_in_vain >= 12 {
            assert_eq!(tried, (left - 3).max(1), "{left}");
        } else {
            assert_eq!(tried, 1, "{left}");
            tried_in_vain += 1;
        }
        axis.step_alone(&mut Scope::new(50 - u64::from(left), &mut log));
    }
}

#[test]
fn what_waits_for_room_is_tried_again_then_too() {
    // The owner needs all of the acceleration until it has its velocity, in scan 50 / 10 = 5. After that there is
    // room.
    let (mut axis, mut log) = (axis(), Log::default());
    let command = Command::MoveVelocity {
        dynamics: at(90.0, 0.0),
        direction: Direction::Unset.into(),
    };
    axis.command(&Request::aborting(command), &mut Scope::new(0, &mut log))
        .expect("taken");
    axis.step_alone(&mut Scope::new(0, &mut log));
    let added = Superimpose {
        distance: 20.0,
        dynamics: at(10.0, 0.0),
    };
    axis.superimpose(&added, &mut Scope::new(0, &mut log))
        .expect("taken");
    for left in (1..=8_u32).rev() {
        assert_eq!(tried_in(&axis), 1, "{left}");
        axis.step_alone(&mut Scope::new(9 - u64::from(left), &mut log));
    }
}

#[test]
fn what_is_added_as_asked_for_is_not_tried_again() {
    let (mut axis, mut log) = moving(100.0, 20.0);
    for scan in 10..60 {
        assert_eq!(tried_in(&axis), 0);
        axis.step_alone(&mut Scope::new(scan, &mut log));
    }
}

#[test]
fn a_stop_does_not_wait_behind_a_stop() {
    let (mut axis, mut log) = (axis(), Log::default());
    let go = Command::MoveVelocity {
        dynamics: at(50.0, 0.0),
        direction: Direction::Unset.into(),
    };
    let stop = Command::Stop {
        dynamics: Dynamics::default(),
    };
    for command in [go, stop] {
        axis.command(&Request::aborting(command), &mut Scope::new(0, &mut log))
            .expect("taken");
        axis.step_alone(&mut Scope::new(0, &mut log));
    }
    assert_eq!(axis.state(), AxisState::Stopping);
    for mode in [
        BufferMode::Aborting,
        BufferMode::Buffered,
        BufferMode::BlendingHigh,
    ] {
        let request = Request {
            buffer_mode: mode.into(),
            ..Request::aborting(stop)
        };
        let refused = axis.command(&request, &mut Scope::new(0, &mut log));
        assert_eq!(refused, Err(ErrorId::InStopping), "{mode:?}");
    }
    let halt = Request {
        buffer_mode: BufferMode::Buffered.into(),
        ..Request::aborting(Command::Halt {
            dynamics: Dynamics::default(),
        })
    };
    assert!(axis.command(&halt, &mut Scope::new(0, &mut log)).is_ok());
}
