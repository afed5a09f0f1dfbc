//! A planner that only counts: every change takes two scans.

use standstill_axis::{Excess, Limits, Passage, Plan, PlanError, Planner, Setpoint};

#[derive(Clone, Copy, Debug)]
pub struct Countdown;

#[derive(Clone, Copy, Debug)]
pub struct Count {
    start: Setpoint,
    goal: Setpoint,
    scans: u32,
}

impl Count {
    fn to(start: &Setpoint, goal: Setpoint) -> Self {
        let there = start.position == goal.position && start.velocity == goal.velocity;
        Self {
            start: *start,
            goal,
            scans: if there { 0 } else { 2 },
        }
    }
}

impl Planner for Countdown {
    type Plan = Count;

    fn move_to(&self, start: &Setpoint, target: f64, _: &Limits, _: &Limits) -> Result<Count, PlanError> {
        Ok(Count::to(start, Setpoint::at_rest(target)))
    }

    fn ramp_to(&self, start: &Setpoint, velocity: f64, _: &Limits, _: &Limits) -> Result<Count, PlanError> {
        // The position stays: states must not differ by how far an endless motion went.
        Ok(Count::to(
            start,
            Setpoint {
                velocity,
                ..Setpoint::at_rest(start.position)
            },
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
        Ok(Count::to(start, goal))
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

    fn entry_speed(&self, wanted: f64, _: f64, _: f64, _: &Limits) -> f64 {
        wanted
    }

    fn fits(&self, _: (&Count, u64), _: (&Count, u64), _: &Limits, _: Option<(f64, f64)>) -> bool {
        true
    }

    fn room(&self, _: (&Count, u64), limits: &Limits) -> Limits {
        *limits
    }

    fn next_switch(&self, (_, elapsed): (&Count, u64)) -> u64 {
        elapsed
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
            // On the way: moving, with the velocity of neither end.
            _ => Setpoint {
                velocity: 0.5,
                ..self.start
            },
        }
    }

    fn excess(&self) -> Option<Excess> {
        None
    }
}
