//! The results of the replans so far.

use serde::{Deserialize, Serialize};
use standstill_planner::Rung;
use standstill_soak::{Case, Goal, Measured, Plan};
use std::fmt;

/// Failing lines that are kept for each kind of goal; further ones are only counted.
const KEPT: usize = 20;

/// Counts, worst figures and failing lines. The sum of two equals the result of all their cases.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Tally {
    /// Replans to: a position on the grid, a position, a position passed, a velocity, a stop.
    goals: [u64; 5],
    /// Replans that started in motion.
    moving: u64,
    /// Replans whose start was known to need no excess.
    viable: u64,
    /// Plans that reported an excess.
    exceeding: u64,
    rungs: [u64; 4],
    /// Largest numbers of ramps solved for a plan, steps of a root, segments.
    work: [u32; 3],
    excess: [f64; 4],
    untold: [f64; 3],
    jumps: [f64; 3],
    miss: f64,
    sample: f64,
    peak: f64,
    /// Replans refused because they take more scans than a plan can count.
    pub long: u64,
    /// Replans that failed.
    pub failed: u64,
    /// The first of them for each kind of goal, as lines of `standstill plan`.
    lines: [Vec<String>; 5],
}

impl Tally {
    /// Counts a plan that passes.
    pub fn passed(&mut self, case: &Case, plan: &Plan, measured: &Measured) {
        self.count(case);
        self.exceeding += u64::from(plan.excess().is_some());
        let steps = match plan {
            Plan::Grid(_) | Plan::Unequal(_) => [0, 0],
            Plan::Ramp(plan) => [0, plan.steps()],
            Plan::Online(plan) => {
                self.rungs[plan.rung() as usize] += 1;
                [plan.solves(), plan.steps()]
            }
        };
        let pieces = u32::try_from(plan.segments().len()).unwrap_or(u32::MAX);
        raise(&mut self.work, [steps[0], steps[1], pieces], u32::max);
        let Measured {
            excess,
            untold,
            jumps,
            miss,
            sample,
            peak,
            keeps: _,
        } = *measured;
        raise(&mut self.excess, excess, f64::max);
        raise(&mut self.untold, untold, f64::max);
        raise(&mut self.jumps, jumps, f64::max);
        self.miss = self.miss.max(miss);
        self.sample = self.sample.max(sample);
        self.peak = self.peak.max(peak);
    }

    /// Counts a failure; `id` gives its place and the broken claim.
    pub fn fail(&mut self, case: &Case, id: &str) {
        self.count(case);
        self.failed += 1;
        let lines = &mut self.lines[kind(case)];
        if lines.len() < KEPT {
            lines.push(case.line(id));
        }
    }

    fn count(&mut self, case: &Case) {
        self.goals[kind(case)] += 1;
        self.moving += u64::from(!case.start.is_at_rest());
        self.viable += u64::from(case.viable);
    }

    /// Adds later results.
    pub fn join(&mut self, later: Self) {
        let sum = |a, b| a + b;
        raise(&mut self.goals, later.goals, sum);
        raise(&mut self.rungs, later.rungs, sum);
        self.moving += later.moving;
        self.viable += later.viable;
        self.exceeding += later.exceeding;
        raise(&mut self.work, later.work, u32::max);
        raise(&mut self.excess, later.excess, f64::max);
        raise(&mut self.untold, later.untold, f64::max);
        raise(&mut self.jumps, later.jumps, f64::max);
        self.miss = self.miss.max(later.miss);
        self.sample = self.sample.max(later.sample);
        self.peak = self.peak.max(later.peak);
        self.long += later.long;
        self.failed += later.failed;
        for (lines, later) in self.lines.iter_mut().zip(later.lines) {
            lines.extend(later);
            lines.truncate(KEPT);
        }
    }

    /// Failing replans as lines, those of one kind of goal after the other.
    pub fn lines(&self) -> impl Iterator<Item = &String> {
        self.lines.iter().flatten()
    }

    /// All replans.
    pub fn replans(&self) -> u64 {
        self.goals.iter().sum()
    }
}

/// The place of a goal in [`Tally::goals`].
fn kind(case: &Case) -> usize {
    match case.goal {
        Goal::Grid(_) => 0,
        Goal::Position(_) => 1,
        Goal::Passing(..) => 2,
        Goal::Velocity(velocity) => 3 + usize::from(velocity == 0.0),
    }
}

/// Replaces each value by `of` of it and the other one.
fn raise<T: Copy, const N: usize>(values: &mut [T; N], others: [T; N], of: impl Fn(T, T) -> T) {
    for (value, other) in values.iter_mut().zip(others) {
        *value = of(*value, other);
    }
}

impl fmt::Display for Tally {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [grid, position, passing, velocity, stop] = self.goals;
        writeln!(
            f,
            "goals           {grid} on the grid, {position} positions, {passing} passed, {velocity} velocities, {stop} stops"
        )?;
        writeln!(
            f,
            "starts          {} moving, {} that need no excess; {} plans tell of one",
            self.moving, self.viable, self.exceeding
        )?;
        let rungs = Rung::ALL
            .iter()
            .zip(self.rungs)
            .map(|(rung, count)| format!("{count} {}", rung.name()));
        writeln!(f, "rungs           {}", rungs.collect::<Vec<_>>().join(", "))?;
        writeln!(
            f,
            "refused         {} that take more scans than a plan counts",
            self.long
        )?;
        let [solves, steps, segments] = self.work;
        writeln!(
            f,
            "most            {solves} ramps solved, {steps} steps of a root, {segments} segments"
        )?;
        let names = ["velocity", "acceleration", "jerk", "snap"];
        let line = |values: &[f64]| {
            let named = names.iter().zip(values);
            named
                .map(|(name, value)| format!("{name} {value:.1e}"))
                .collect::<Vec<_>>()
                .join(", ")
        };
        writeln!(f, "worst, relative")?;
        writeln!(f, "  over a limit  {}", line(&self.excess))?;
        writeln!(f, "  over the told {}", line(&self.untold))?;
        writeln!(f, "  jumps         {}", line(&self.jumps))?;
        writeln!(f, "  off target    {:.1e}", self.miss)?;
        writeln!(f, "  set-points    {:.1e}", self.sample)?;
        writeln!(f, "  peaks         {:.1e}", self.peak)
    }
}
