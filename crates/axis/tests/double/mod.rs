//! The product's planner with one wrong set-point in each plan, or with a first ramp to a state in motion.

use standstill_axis::{
    Excess, Limits, MoveProfile, Passage, Plan, PlanError, Planner, ProfileFault, ProfileKind, ProfilePoint,
    Setpoint, Standard, StandardPlan,
};
use std::cell::Cell;

/// The scan with the wrong set-point.
const SCAN: u64 = 150;

/// The value that is added to that set-point.
#[derive(Clone, Copy, Debug)]
pub enum Wrong {
    /// To its position (u).
    Position(f64),
    /// To its velocity (u/s).
    Velocity(f64),
    /// To its acceleration (u/s^2).
    Acceleration(f64),
    /// To its position, and to that of all plans after the first (u).
    Always(f64),
    /// To its position, and to the first one of a stop (u).
    Begin(f64),
}

#[derive(Clone, Debug)]
pub struct Faulty {
    standard: Standard,
    wrong: Option<Wrong>,
    /// The state into which its first ramp puts an axis.
    place: Cell<Option<Setpoint>>,
}

#[derive(Clone, Copy, Debug)]
pub struct FaultyPlan {
    plan: StandardPlan,
    wrong: Option<Wrong>,
    is_stop: bool,
    /// In equal steps from rest at its position to a state, in this number of scans, in place of the plan.
    placed: Option<(Setpoint, u64)>,
}

impl Faulty {
    pub fn new(cycle: f64, wrong: Wrong) -> Self {
        Self {
            standard: Standard::new(cycle),
            wrong: Some(wrong),
            place: Cell::default(),
        }
    }

    /// Puts an axis into `state` with its first ramp, in steps that the axis accepts from a plan. After that it is
    /// [`Standard`].
    pub fn placing(cycle: f64, state: Setpoint) -> Self {
        Self {
            standard: Standard::new(cycle),
            wrong: None,
            place: Cell::new(Some(state)),
        }
    }

    fn faulty<E>(&self, plan: Result<StandardPlan, E>, is_stop: bool) -> Result<FaultyPlan, E> {
        let wrong = self.wrong;
        plan.map(|plan| FaultyPlan {
            plan,
            wrong,
            is_stop,
            placed: None,
        })
    }
}

impl Plan for FaultyPlan {
    fn scans(&self) -> u32 {
        self.placed.map_or_else(|| self.plan.scans(), |_| u32::MAX)
    }

    fn at(&self, scan: u64) -> Setpoint {
        if let Some((state, scans)) = self.placed {
            let part = scan as f64 / scans as f64;
            return if scan >= scans {
                state
            } else {
                Setpoint {
                    velocity: part * state.velocity,
                    acceleration: part * state.acceleration,
                    ..Setpoint::at_rest(state.position)
                }
            };
        }
        let mut state = self.plan.at(scan);
        let Some(wrong) = self.wrong else {
            return state;
        };
        match wrong {
            Wrong::Always(by) if self.is_stop && scan > 0 => state.position += by,
            Wrong::Begin(by) if self.is_stop && scan == 1 => state.position += by,
            _ if self.is_stop || scan != SCAN => {}
            Wrong::Position(by) | Wrong::Always(by) | Wrong::Begin(by) => state.position += by,
            Wrong::Velocity(by) => state.velocity += by,
            Wrong::Acceleration(by) => state.acceleration += by,
        }
        state
    }

    fn excess(&self) -> Option<Excess> {
        self.plan.excess().filter(|_| self.placed.is_none())
    }

    fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        self.plan.excess_over(limits).filter(|_| self.placed.is_none())
    }

    fn shift(&mut self, by: f64) {
        self.plan.shift(by);
    }
}

impl Planner for Faulty {
    type Plan = FaultyPlan;

    fn cycle(&self) -> f64 {
        self.standard.cycle()
    }

    fn ramp_to(
        &self,
        start: &Setpoint,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<FaultyPlan, PlanError> {
        let plan = self.standard.ramp_to(start, velocity, limits, before);
        let plan = self.faulty(plan, velocity == 0.0)?;
        let placed = self.place.take().map(|state| {
            let steps = [
                state.velocity.abs() / (limits.acceleration * self.cycle()),
                state.acceleration.abs() / (limits.jerk * self.cycle()),
            ];
            (state, 1 + steps[0].max(steps[1]).ceil() as u64)
        });
        Ok(FaultyPlan { placed, ..plan })
    }

    fn move_to(
        &self,
        profile: MoveProfile,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<FaultyPlan, PlanError> {
        self.faulty(
            self.standard.move_to(profile, start, target, limits, before),
            false,
        )
    }

    fn pass(
        &self,
        start: &Setpoint,
        target: f64,
        velocity: f64,
        limits: &Limits,
        before: &Limits,
    ) -> Result<FaultyPlan, PlanError> {
        self.faulty(self.standard.pass(start, target, velocity, limits, before), false)
    }

    fn blend(
        &self,
        _: &Setpoint,
        _: f64,
        _: &Passage,
        _: &Limits,
        _: &Limits,
    ) -> Result<Option<FaultyPlan>, PlanError> {
        unreachable!("nothing is blended")
    }

    fn profile(
        &self,
        _: ProfileKind,
        _: &Setpoint,
        _: &[ProfilePoint],
        _: &Limits,
        _: Option<(f64, f64)>,
    ) -> Result<FaultyPlan, ProfileFault> {
        unreachable!("no profile is commanded")
    }

    fn entry_speed(&self, _: f64, _: f64, _: f64, _: f64, _: &Limits) -> f64 {
        unreachable!("nothing is blended")
    }

    fn fits(&self, _: (&FaultyPlan, u64), _: (&FaultyPlan, u64), _: &Limits, _: Option<(f64, f64)>) -> bool {
        unreachable!("nothing is superimposed")
    }

    fn room(&self, _: (&FaultyPlan, u64), _: &Limits) -> Limits {
        unreachable!("nothing is superimposed")
    }

    fn next_switch(&self, _: (&FaultyPlan, u64)) -> u64 {
        unreachable!("nothing is superimposed")
    }

    fn ways(&self, _: (&FaultyPlan, u64)) -> (f64, f64) {
        unreachable!("nothing is superimposed")
    }
}
