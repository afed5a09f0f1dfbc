//! The last check (ErrorID 904): an error of the planner moves nothing further than the limits allow.
//!
//! The planner here is the product's own, but one set-point of its plans is wrong.

use crate::double::{Faulty, Wrong};
use crate::standing;
use standstill_axis::{
    Axis, AxisId, AxisState, Command, Direction, Dynamics, ErrorId, Event, Limits, Log, Request, Scope,
    Setpoint,
};

const LIMITS: Limits = Limits {
    velocity: 50.0,
    acceleration: 200.0,
    deceleration: 200.0,
    jerk: 2000.0,
    snap: 40_000.0,
};

const CYCLE: f64 = 0.001;

/// Runs a plan that is wrong at scan 150 until the axis is at rest. Returns the set-points, the axis and the records.
fn run(wrong: Wrong) -> (Vec<Setpoint>, Axis<Faulty>, Log) {
    run_at(30.0, wrong)
}

/// The same at another velocity (u/s).
fn run_at(velocity: f64, wrong: Wrong) -> (Vec<Setpoint>, Axis<Faulty>, Log) {
    let config = standing::config(LIMITS);
    let mut axis =
        Axis::new(AxisId::new(0), config, Faulty::new(CYCLE, wrong)).expect("a good configuration");
    let mut log = Log::default();
    let go = Command::MoveVelocity {
        dynamics: Dynamics::at(velocity),
        direction: Direction::Unset.into(),
    };
    axis.command(&Request::aborting(go), &mut Scope::new(0, &mut log))
        .expect("taken");
    let mut published = vec![axis.setpoint()];
    for scan in 0..2000 {
        axis.step_alone(&mut Scope::new(scan, &mut log));
        published.push(axis.setpoint());
    }
    (published, axis, log)
}

/// Whether two set-points in a row are at most a scan apart.
fn is_step(pair: &[Setpoint]) -> bool {
    let near = |a: f64, b: f64, rate: f64| (a - b).abs() <= rate * CYCLE * (1.0 + 1e-8);
    let [one, two] = pair else { return true };
    near(one.position, two.position, LIMITS.velocity)
        && near(one.velocity, two.velocity, LIMITS.acceleration)
        && near(one.acceleration, two.acceleration, LIMITS.jerk)
}

#[test]
fn a_step_of_position_velocity_or_acceleration_is_never_published() {
    for wrong in [
        Wrong::Position(1.0),
        Wrong::Position(-0.2),
        Wrong::Position(1e300),
        Wrong::Velocity(5.0),
        Wrong::Acceleration(-80.0),
    ] {
        let (published, axis, log) = run(wrong);
        assert!(published.windows(2).all(is_step), "{wrong:?}");
        assert_eq!(
            (axis.state(), axis.error_id()),
            (AxisState::ErrorStop, ErrorId::SetpointStep),
            "{wrong:?}"
        );
        // The stop begins at the last good state and is a ramp, not a halt in one scan.
        let stopped = published
            .iter()
            .rposition(|state| !state.is_at_rest())
            .expect("a motion");
        assert!(stopped > 250, "{wrong:?} {stopped}");
        let fault = |event: &Event| {
            matches!(
                event,
                Event::Fault {
                    error: ErrorId::SetpointStep,
                    ..
                }
            )
        };
        assert!(log.since(0).any(|record| fault(&record.event)), "{wrong:?}");
    }
}

#[test]
fn what_the_limits_allow_is_published() {
    let (published, axis, _) = run(Wrong::Position(1e-12));
    assert!(published.windows(2).all(is_step));
    assert_eq!(
        (axis.state(), axis.error_id()),
        (AxisState::ContinuousMotion, ErrorId::None)
    );
}

#[test]
fn where_the_stop_ramp_is_wrong_too_the_axis_holds() {
    let (published, axis, _) = run(Wrong::Always(1.0));
    assert_eq!(axis.state(), AxisState::ErrorStop);
    let last = published.last().expect("set-points");
    assert!(
        last.is_at_rest() && published.iter().all(|state| state.position.abs() < 50.0),
        "{last:?}"
    );
    assert!(
        published
            .windows(2)
            .all(|pair| (pair[0].position - pair[1].position).abs() <= LIMITS.velocity * CYCLE)
    );
}

#[test]
fn a_stop_ramp_that_begins_wrong_is_not_gone_on_with() {
    // So slow that every later set-point of the ramp is one step from rest.
    let (published, axis, _) = run_at(0.05, Wrong::Begin(1.0));
    assert_eq!(axis.state(), AxisState::ErrorStop);
    let from = published
        .iter()
        .rposition(|state| !state.is_at_rest())
        .expect("a motion");
    assert!(from < 200, "{from}");
    let held = published[from].position;
    assert!(published[from + 1..].iter().all(|state| state.position == held));
}
