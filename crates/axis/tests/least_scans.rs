//! MC_Stop and MC_Halt compared with the least number of scans that any sequence of snaps needs, by linear
//! programming.
//!
//! The cases are those of the planner (`crates/planner/tests/data`). Each is the state of a move in progress. No
//! command brings an axis into exactly such a state, so a test planner does. The stop is planned by the product's own
//! planner.

use crate::double::Faulty;
use crate::standing;
use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Direction, Dynamics, Fate, Limits, Log, Request, Scope,
    Setpoint,
};
use std::collections::BTreeMap;

/// A state in motion, and the least number of scans from there.
struct Case {
    cycle: f64,
    limits: Limits,
    start: Setpoint,
    /// The velocity at the end of the ramp (u/s).
    goal: f64,
    least: i64,
}

fn cases(text: &str) -> Vec<Case> {
    let list: Vec<serde_json::Value> = serde_json::from_str(text).expect("JSON");
    list.iter()
        .map(|case| {
            let number = |key: &str| case[key].as_f64().expect("a number");
            Case {
                cycle: number("Ts"),
                limits: Limits {
                    velocity: number("V"),
                    acceleration: number("A"),
                    deceleration: number("A"),
                    jerk: number("J"),
                    snap: number("S"),
                },
                start: Setpoint {
                    position: number("x0"),
                    velocity: number("v0"),
                    acceleration: number("a0"),
                    jerk: number("j0"),
                    snap: 0.0,
                },
                goal: case["ve"].as_f64().unwrap_or(0.0),
                least: case["n_star"].as_i64().expect("n_star"),
            }
        })
        .collect()
}

impl Case {
    /// An axis in the state of the case.
    fn axis(&self, log: &mut Log) -> Axis<Faulty> {
        let config = AxisConfig {
            position: self.start.position,
            ..standing::config(self.limits)
        };
        let planner = Faulty::placing(self.cycle, self.start);
        let mut axis = Axis::new(AxisId::new(0), config, planner).expect("a good configuration");
        let there = self.velocity(self.limits.velocity);
        axis.command(&Request::aborting(there), &mut Scope::new(0, log))
            .expect("taken");
        for scan in 0..100_000 {
            axis.step_alone(&mut Scope::new(scan, log));
            if axis.setpoint() == self.start {
                return axis;
            }
        }
        panic!("not there: {:?}", axis.setpoint());
    }

    fn velocity(&self, velocity: f64) -> Command {
        let dynamics = Dynamics::at(velocity);
        Command::MoveVelocity {
            dynamics,
            direction: Direction::Unset.into(),
        }
    }

    /// The number of scans above the least that `command` takes, which ends with the velocity of the case. Every
    /// set-point keeps the limits, and a stop keeps its direction.
    fn above(&self, command: Command) -> i64 {
        let mut log = Log::default();
        let mut axis = self.axis(&mut log);
        let id = axis
            .command(&Request::aborting(command), &mut Scope::new(0, &mut log))
            .expect("taken");
        let stops = self.goal == 0.0;
        let heading = self.start.velocity.signum();
        for scan in 1.. {
            axis.step_alone(&mut Scope::new(scan, &mut log));
            let Setpoint {
                velocity,
                acceleration,
                jerk,
                snap,
                ..
            } = axis.setpoint();
            let ratios = [
                velocity / self.limits.velocity,
                acceleration / self.limits.acceleration,
                jerk / self.limits.jerk,
                snap / self.limits.snap,
            ];
            assert!(ratios.iter().all(|ratio| ratio.abs() <= 1.0 + 1e-9), "{ratios:?}");
            assert!(
                !stops || velocity * heading >= -1e-9 * self.limits.velocity,
                "{velocity}"
            );
            if (velocity, acceleration, jerk) == (self.goal, 0.0, 0.0) {
                assert!(axis.state() != AxisState::ErrorStop);
                assert!(matches!(axis.fate(id), Fate::Done | Fate::Active { .. }));
                return scan as i64 - self.least;
            }
        }
        unreachable!("the loop has no end")
    }
}

/// The largest number of scans above the least in all `cases`, for the commands that `make` returns.
fn most_above(text: &str, make: impl Fn(&Case) -> Vec<Command>) -> i64 {
    let mut surplus = BTreeMap::new();
    let cases = cases(text);
    assert_eq!(cases.len(), 100);
    for case in &cases {
        for command in make(case) {
            *surplus.entry(case.above(command)).or_insert(0) += 1;
        }
    }
    println!("more scans than the least: {surplus:?}");
    *surplus.keys().last().expect("cases")
}

#[test]
fn a_stop_takes_no_more_scans_than_the_least() {
    let dynamics = Dynamics::default();
    let most = most_above(
        include_str!("../../planner/tests/data/least-scans-stops.json"),
        |_| vec![Command::Halt { dynamics }, Command::Stop { dynamics }],
    );
    assert!(most <= 0, "{most}");
}

#[test]
fn another_velocity_takes_no_more_scans_than_the_least() {
    let most = most_above(
        include_str!("../../planner/tests/data/least-scans-ramps.json"),
        |case| vec![case.velocity(case.goal)],
    );
    assert!(most <= 0, "{most}");
}
