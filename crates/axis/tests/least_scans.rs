//! MC_Stop and MC_Halt compared with the least number of scans that any sequence of snaps needs, by linear
//! programming.
//!
//! The cases are those of the planner (`crates/planner/tests/data`). Each is the state of a move in progress. No
//! command brings an axis into exactly such a state, so a test planner does. The stop is planned by the product's own
//! planner.

use standstill_axis::{
    Axis, AxisConfig, AxisId, AxisState, Command, Direction, Dynamics, Excess, Fate, Limits, Log,
    MoveProfile, Passage, Plan, PlanError, Planner, ProfileFault, ProfileKind, ProfilePoint, Request, Scope,
    Setpoint, Standard, StandardPlan, StartState, steps,
};
use std::cell::Cell;
use std::collections::BTreeMap;
use std::slice;

/// Puts an axis into `state` with its first ramp, in steps that the axis accepts from a plan. After that it is
/// [`Standard`].
#[derive(Clone, Debug)]
struct Placing {
    state: Cell<Option<Setpoint>>,
    standard: Standard,
}

#[derive(Clone, Copy, Debug)]
#[expect(clippy::large_enum_variant, reason = "a plan is copied, so it is not boxed")]
enum Placed {
    /// In equal steps from rest at its position to a state, in this number of scans.
    At(Setpoint, u64),
    Then(StandardPlan),
}

impl Plan for Placed {
    fn scans(&self) -> u32 {
        match self {
            Self::At(..) => u32::MAX,
            Self::Then(plan) => plan.scans(),
        }
    }

    fn at(&self, scan: u64) -> Setpoint {
        match self {
            Self::At(state, scans) if scan < *scans => {
                let part = scan as f64 / *scans as f64;
                Setpoint {
                    velocity: part * state.velocity,
                    acceleration: part * state.acceleration,
                    ..Setpoint::at_rest(state.position)
                }
            }
            Self::At(state, _) => *state,
            Self::Then(plan) => plan.at(scan),
        }
    }

    fn excess(&self) -> Option<Excess> {
        match self {
            Self::At(..) => None,
            Self::Then(plan) => plan.excess(),
        }
    }

    fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        match self {
            Self::At(..) => None,
            Self::Then(plan) => plan.excess_over(limits),
        }
    }

    fn shift(&mut self, _: f64) {
        unreachable!("coordinates stay")
    }
}

impl Planner for Placing {
    type Plan = Placed;

    fn cycle(&self) -> f64 {
        self.standard.cycle()
    }

    fn ramp_to(
        &self,
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Placed, PlanError> {
        match self.state.take() {
            Some(state) => {
                let steps = [
                    state.velocity.abs() / (limits.acceleration * self.cycle()),
                    state.acceleration.abs() / (limits.jerk * self.cycle()),
                ];
                Ok(Placed::At(state, 1 + steps[0].max(steps[1]).ceil() as u64))
            }
            None => self
                .standard
                .ramp_to(start, velocity, limits, before)
                .map(Placed::Then),
        }
    }

    fn move_to(
        &self,
        _: MoveProfile,
        _: &Setpoint,
        _: f64,
        _: &Limits,
        _: &Limits,
    ) -> Result<Placed, PlanError> {
        unreachable!("only ramps are asked for")
    }

    fn pass(&self, _: &Setpoint, _: f64, _: f64, _: &Limits, _: &Limits) -> Result<Placed, PlanError> {
        unreachable!("only ramps are asked for")
    }

    fn blend(
        &self,
        _: &Setpoint,
        _: f64,
        _: &Passage,
        _: &Limits,
        _: &Limits,
    ) -> Result<Option<Placed>, PlanError> {
        unreachable!("only ramps are asked for")
    }

    fn profile(
        &self,
        _: ProfileKind,
        _: &Setpoint,
        _: &[ProfilePoint],
        _: &Limits,
        _: Option<(f64, f64)>,
    ) -> Result<Placed, ProfileFault> {
        unreachable!("no profile is commanded")
    }

    fn entry_speed(&self, _: f64, _: f64, _: f64, _: f64, _: &Limits) -> f64 {
        unreachable!("nothing is blended")
    }

    fn fits(&self, _: (&Placed, u64), _: (&Placed, u64), _: &Limits, _: Option<(f64, f64)>) -> bool {
        unreachable!("nothing is superimposed")
    }

    fn room(&self, _: (&Placed, u64), _: &Limits) -> Limits {
        unreachable!("nothing is superimposed")
    }

    fn next_switch(&self, _: (&Placed, u64)) -> u64 {
        unreachable!("nothing is superimposed")
    }

    fn ways(&self, _: (&Placed, u64)) -> (f64, f64) {
        unreachable!("nothing is superimposed")
    }
}

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
    fn axis(&self, log: &mut Log) -> Axis<Placing> {
        let config = AxisConfig {
            start: StartState::Standstill,
            position: self.start.position,
            ..AxisConfig::new(self.limits)
        };
        let planner = Placing {
            state: Cell::new(Some(self.start)),
            standard: Standard::new(self.cycle),
        };
        let mut axis = Axis::new(AxisId::new(0), config, planner).expect("a good configuration");
        let there = self.velocity(self.limits.velocity);
        axis.command(&Request::aborting(there), &mut Scope::new(0, log))
            .expect("taken");
        for scan in 0..100_000 {
            steps::advance(slice::from_mut(&mut axis), &mut Scope::new(scan, log));
            if axis.setpoint() == self.start {
                return axis;
            }
        }
        panic!("not there: {:?}", axis.setpoint());
    }

    fn velocity(&self, velocity: f64) -> Command {
        let dynamics = Dynamics {
            velocity,
            ..Dynamics::default()
        };
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
            steps::advance(slice::from_mut(&mut axis), &mut Scope::new(scan, &mut log));
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
