//! `standstill soak planner`: random replans, each checked against the claims about plans.

use super::tally::Tally;
use super::{Trial, soak};
use crate::exit::{Exit, Failure};
use standstill_planner::PlanError;
use standstill_soak::{Chain, judge};
use std::io::Write;
use std::path::Path;

/// Runs `count` replans, prints failing ones as `plan` lines and then the figures.
pub fn planner(seed: u64, count: u64, resume: Option<&Path>, out: &mut dyn Write) -> Result<Exit, Failure> {
    let tally: Tally = soak(seed, count, resume)?;
    for line in tally.lines() {
        writeln!(out, "{line}")?;
    }
    let failed = tally.failed;
    write!(out, "{tally}")?;
    writeln!(out, "seed {seed}: {} replans, {failed} failed", tally.replans())?;
    Ok(Exit::of(failed == 0))
}

impl Trial for Tally {
    const CASES: &str = "replans";
    const LINKS: u64 = 20;
    const BATCH: u64 = 250;

    fn chain(seed: u64, number: u64, links: u64) -> Self {
        let mut tally = Self::default();
        let mut chain = Chain::new(seed, number);
        for link in 0..links {
            let case = chain.next_case();
            let planned = case.plan();
            if matches!(planned, Err(PlanError::TooLong { .. })) && case.is_long() {
                tally.long += 1;
                chain.rest();
                continue;
            }
            let judged = planned.map_err(|error| error.to_string()).and_then(|plan| {
                let scan = chain.leave(&plan);
                let measured = judge(&case, &plan, scan)?;
                chain.follow(&plan, scan, measured.keeps);
                Ok((plan, measured))
            });
            match judged {
                Ok((plan, measured)) => tally.passed(&case, &plan, &measured),
                Err(what) => {
                    tally.fail(&case, &format!("chain {number}, replan {link}: {what}"));
                    chain.rest();
                }
            }
        }
        tally
    }

    fn add(&mut self, later: Self) {
        self.join(later);
    }

    fn failed(&self) -> u64 {
        self.failed
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::plan;
    use standstill_planner::Limits;
    use standstill_soak::{Case, Goal, Plan};

    /// The replans of some chains with their plans, and the scans at which the next replan begins.
    fn replans(chains: u64) -> Vec<(Case, Plan, u64)> {
        let mut replans = Vec::new();
        for number in 0..chains {
            let mut chain = Chain::new(7, number);
            for _ in 0..Tally::LINKS {
                let case = chain.next_case();
                let Ok(plan) = case.plan() else {
                    assert!(case.is_long(), "{}", case.line("x"));
                    chain.rest();
                    continue;
                };
                let scan = chain.leave(&plan);
                chain.follow(&plan, scan, false);
                replans.push((case, plan, scan));
            }
        }
        replans
    }

    #[test]
    fn every_replan_is_a_line_that_plans_the_same() {
        for (case, plan, _) in replans(30) {
            let line = case.line("x");
            let mut answer = Vec::new();
            let exit = plan::plan(&mut line.as_bytes(), "a line", &mut answer).expect("an answer");
            let answer: serde_json::Value = serde_json::from_slice(&answer).expect("JSON");
            assert_eq!(exit, Exit::Passed, "{line} {answer}");
            assert_eq!(answer["scans"], plan.scans(), "{line}");
            assert_eq!(answer["duration"], plan.duration(), "{line}");
            assert_eq!(
                answer["segments"].as_array().map(Vec::len),
                Some(plan.segments().len())
            );
        }
    }

    #[test]
    fn plans_that_break_a_claim_are_noticed() {
        let mut noticed = [0; 3];
        for (case, plan, scan) in replans(30) {
            if plan.excess().is_some() || plan.segments().is_empty() {
                continue;
            }
            let all = |factor: f64| Limits {
                velocity: case.limits.velocity * factor,
                acceleration: case.limits.acceleration * factor,
                deceleration: case.limits.deceleration * factor,
                jerk: case.limits.jerk * factor,
                snap: case.limits.snap * factor,
            };
            let slower = Case {
                limits: all(1.0 - 1e-6),
                before: all(1.0 - 1e-6),
                ..case
            };
            noticed[0] += u32::from(judge(&slower, &plan, scan).is_err());
            let way = case.limits.velocity * plan.duration();
            let elsewhere = match case.goal {
                Goal::Grid(target) => Goal::Grid(target + 1e-6 * way),
                Goal::Position(target) => Goal::Position(target + 1e-6 * way),
                Goal::Passing(target, velocity) => Goal::Passing(target + 1e-6 * way, velocity),
                Goal::Velocity(velocity) => Goal::Velocity(velocity + 1e-6 * case.limits.velocity),
            };
            let missed = Case {
                goal: elsewhere,
                ..case
            };
            noticed[1] += u32::from(judge(&missed, &plan, scan).is_err());
            let mut jumping = case;
            jumping.start.velocity += 1e-6 * case.limits.velocity;
            noticed[2] += u32::from(judge(&jumping, &plan, scan).is_err());
        }
        // Most plans touch some limit; all have one goal and one start.
        assert!(noticed[0] > 300 && noticed[1] > 400, "{noticed:?}");
        assert_eq!(noticed[1], noticed[2]);
    }

    #[test]
    fn failing_replans_become_lines() {
        let (case, ..) = replans(1).remove(0);
        let mut tally = Tally::default();
        for _ in 0..200 {
            tally.fail(&case, "chain 0, replan 0: it broke");
        }
        let mut sum = Tally::default();
        sum.add(tally);
        assert_eq!((sum.failed, sum.lines().count()), (200, 20));
        assert!(
            sum.lines()
                .all(|line| line.starts_with(r#"{"id":"chain 0, replan 0: it broke","method":""#))
        );
    }
}
