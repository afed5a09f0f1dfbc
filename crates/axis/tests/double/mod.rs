//! The product's planner with one wrong set-point in each plan.

use standstill_axis::{
    Excess, Limits, MoveProfile, Passage, Plan, PlanError, Planner, ProfileFault, ProfileKind, ProfilePoint,
    Setpoint, Standard, StandardPlan,
};

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
    wrong: Wrong,
}

#[derive(Clone, Copy, Debug)]
pub struct FaultyPlan {
    plan: StandardPlan,
    wrong: Wrong,
    is_stop: bool,
}

impl Faulty {
    pub fn new(cycle: f64, wrong: Wrong) -> Self {
        Self {
            standard: Standard::new(cycle),
            wrong,
        }
    }

    fn faulty<E>(&self, plan: Result<StandardPlan, E>, is_stop: bool) -> Result<FaultyPlan, E> {
        let wrong = self.wrong;
        plan.map(|plan| FaultyPlan { plan, wrong, is_stop })
    }
}

impl Plan for FaultyPlan {
    fn scans(&self) -> u32 {
        self.plan.scans()
    }

    fn at(&self, scan: u64) -> Setpoint {
        let mut state = self.plan.at(scan);
        match self.wrong {
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
        self.plan.excess()
    }

    fn excess_over(&self, limits: &Limits) -> Option<Excess> {
        self.plan.excess_over(limits)
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
        self.faulty(
            self.standard.ramp_to(start, velocity, limits, before),
            velocity == 0.0,
        )
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
