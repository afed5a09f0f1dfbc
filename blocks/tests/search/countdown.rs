//! A planner that only counts: every change takes two scans. At velocity 2 a move takes two scans even to
//! the present position, so that superimposed motions do not create many positions.

use standstill_axis::{
    Excess, Limits, MoveProfile, Passage, Plan, PlanError, Planner, ProfileFault, ProfileKind, ProfilePoint,
    Setpoint,
};

#[derive(Clone, Copy, Debug)]
pub struct Countdown;

#[derive(Clone, Copy, Debug)]
pub struct Count {
    start: Setpoint,
    goal: Setpoint,
    scans: u32,
}

impl Count {
    fn to(start: &Setpoint, goal: Setpoint, always: bool) -> Self {
        let there = !always && start.position == goal.position && start.velocity == goal.velocity;
        Self {
            start: *start,
            goal,
            scans: if there { 0 } else { 2 },
        }
    }
}

impl Planner for Countdown {
    type Plan = Count;

    fn cycle(&self) -> f64 {
        1.0
    }

    fn move_to(
        &self,
        _: MoveProfile,
        start: &Setpoint,
        target: f64,
        limits: &Limits,
        _: &Limits,
    ) -> Result<Count, PlanError> {
        Ok(Count::to(
            start,
            Setpoint::at_rest(target),
            limits.velocity == 2.0,
        ))
    }

    fn ramp_to(&self, start: &Setpoint, velocity: f64, _: &Limits, _: &Limits) -> Result<Count, PlanError> {
        // The position stays: states must not differ by how far an endless motion went.
        Ok(Count::to(
            start,
            Setpoint {
                velocity,
                ..Setpoint::at_rest(start.position)
            },
            false,
        ))
    }

    fn pass(
        &self,
        start: &Setpoint,
        target: f64,
        velocity: f64,
        _: &Limits,
        _: &Limits,
    ) -> Result<Count, PlanError> {
        let goal = Setpoint {
            velocity,
            ..Setpoint::at_rest(target)
        };
        Ok(Count::to(start, goal, false))
    }

    fn blend(
        &self,
        start: &Setpoint,
        target: f64,
        passage: &Passage,
        limits: &Limits,
        before: &Limits,
    ) -> Result<Option<Count>, PlanError> {
        let velocity = passage.wanted.copysign(target - start.position);
        self.pass(start, target, velocity, limits, before).map(Some)
    }

    fn profile(
        &self,
        kind: ProfileKind,
        start: &Setpoint,
        points: &[ProfilePoint],
        _: &Limits,
        _: Option<(f64, f64)>,
    ) -> Result<Count, ProfileFault> {
        let last = points.last().map_or(0.0, |point| point.value);
        let goal = match kind {
            ProfileKind::Position => Setpoint::at_rest(last),
            ProfileKind::Velocity | ProfileKind::Acceleration => Setpoint {
                velocity: last,
                ..Setpoint::at_rest(start.position)
            },
        };
        Ok(Count::to(start, goal, false))
    }

    fn entry_speed(&self, wanted: f64, _: f64, _: f64, _: f64, _: &Limits) -> f64 {
        wanted
    }

    /// Two motions fit unless the one below has just begun. So a command waits, and a hand-over finds no room.
    fn fits(&self, (_, elapsed): (&Count, u64), _: (&Count, u64), _: &Limits, _: Option<(f64, f64)>) -> bool {
        elapsed > 0
    }

    fn room(&self, _: (&Count, u64), limits: &Limits) -> Limits {
        *limits
    }

    fn next_switch(&self, (plan, elapsed): (&Count, u64)) -> u64 {
        if elapsed < u64::from(plan.scans) {
            elapsed + 1
        } else {
            elapsed
        }
    }

    fn ways(&self, (plan, elapsed): (&Count, u64)) -> (f64, f64) {
        let way = plan.goal.position - plan.at(elapsed).position;
        (way.max(0.0), (-way).max(0.0))
    }
}

impl Plan for Count {
    fn scans(&self) -> u32 {
        self.scans
    }

    fn at(&self, scan: u64) -> Setpoint {
        match scan {
            0 => self.start,
            _ if scan >= u64::from(self.scans) => self.goal,
            // In between: moving, with the velocity of neither end.
            _ => Setpoint {
                velocity: 0.5,
                ..self.start
            },
        }
    }

    fn shift(&mut self, by: f64) {
        self.start.position += by;
        self.goal.position += by;
    }

    fn excess(&self) -> Option<Excess> {
        None
    }

    fn excess_over(&self, _: &Limits) -> Option<Excess> {
        None
    }
}
