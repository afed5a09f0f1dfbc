//! The scans of blended chains, compared with the least number.
//!
//! `chains_least.txt` holds 300 random chains of two to four moves, queued at once on an axis at rest, at orders 3
//! and 4: short and long distances, equal and different dynamics, in the same direction and back. The first word of a
//! line is the least total. The second is the scans of each move in it. This is the smallest total found for which
//! the linear program over the snaps (at order 3 the jerks) of all scans has a solution. In that solution each end is
//! passed in its scan, not before, with at most the velocity of its blending mode. If the next move reverses, the
//! velocity is 0 exactly at the end. Every move keeps its limits at every scan end, and moves only in its direction.
//! A move is faster than its own velocity only if the velocity at an end is higher: no faster than that, and within
//! the least-time ramp between that velocity and its own (B3, B4). A ramp up to that velocity may end at any time in
//! the scan that passes the end. A ramp down begins with the set-point of that scan, at which the next move takes
//! over. The search takes scans from one move, or gives some to another, as long as the program has a solution. It
//! was made with SciPy's HiGHS, with no part of this project.

use crate::chains::{CYCLE, Rig};
use standstill_axis::{AxisState, BufferMode, Dynamics, Limits};
use standstill_planner::{OnlinePlan, Setpoint, ramp::solved};
use std::collections::BTreeMap;

struct Move {
    mode: BufferMode,
    end: f64,
    dynamics: Dynamics,
}

struct Case {
    limits: Limits,
    moves: Vec<Move>,
    least: u64,
}

fn cases() -> impl Iterator<Item = Case> {
    include_str!("chains_least.txt").lines().map(Case::new)
}

impl Case {
    fn new(line: &str) -> Self {
        let mut words = line.split(' ');
        let least = words.next().unwrap().parse().unwrap();
        let scans = words
            .next()
            .unwrap()
            .split(',')
            .map(|scans| scans.parse::<u64>().unwrap());
        assert_eq!(scans.sum::<u64>(), least, "{line}");
        let limits = numbers(&mut words);
        let mut moves = Vec::new();
        while let Some(mode) = words.next() {
            let mode = match mode {
                "Low" => BufferMode::BlendingLow,
                "Previous" => BufferMode::BlendingPrevious,
                "Next" => BufferMode::BlendingNext,
                "High" => BufferMode::BlendingHigh,
                _ => panic!("{line}"),
            };
            let end = words.next().unwrap().parse().unwrap();
            let [velocity, acceleration, deceleration, jerk, snap] = numbers(&mut words);
            let finite = |limit: f64| if limit.is_finite() { limit } else { 0.0 };
            let dynamics = Dynamics {
                velocity,
                acceleration,
                deceleration,
                jerk: finite(jerk),
                snap: finite(snap),
            };
            moves.push(Move { mode, end, dynamics });
        }
        let [velocity, acceleration, deceleration, jerk, snap] = limits;
        let limits = Limits {
            velocity,
            acceleration,
            deceleration,
            jerk,
            snap,
        };
        Self { limits, moves, least }
    }

    /// Scans until the last move is done. Each end is passed in order, and no limit is exceeded.
    fn scans(&self) -> u64 {
        let mut rig = Rig::new(self.limits);
        for next in &self.moves {
            rig.move_with(next.end, next.mode, next.dynamics);
        }
        rig.run()
    }
}

fn numbers<'a>(words: &mut impl Iterator<Item = &'a str>) -> [f64; 5] {
    [(); 5].map(|()| words.next().unwrap().parse().unwrap())
}

/// The kind of a chain, by the direction and dynamics of its moves relative to the ones before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
enum Kind {
    /// In the same direction, with the same dynamics.
    Same,
    /// Reversed at one end at least, otherwise with the same dynamics.
    Turned,
    /// In the same direction, with other dynamics.
    Other,
    /// Both.
    TurnedOther,
}

impl Case {
    fn kind(&self) -> Kind {
        let is_same = self
            .moves
            .iter()
            .all(|next| next.dynamics == self.moves[0].dynamics);
        let ends = [0.0].into_iter().chain(self.moves.iter().map(|next| next.end));
        let ends: Vec<f64> = ends.collect();
        let turns = |at: &[f64]| (at[1] - at[0]) * (at[2] - at[1]) < 0.0;
        match (is_same, ends.windows(3).any(turns)) {
            (true, false) => Kind::Same,
            (true, true) => Kind::Turned,
            (false, false) => Kind::Other,
            (false, true) => Kind::TurnedOther,
        }
    }
}

#[test]
fn a_blended_chain_takes_nearly_the_least_scans() {
    let mut above = BTreeMap::new();
    let mut worst = BTreeMap::new();
    for case in cases() {
        let (scans, least) = (case.scans(), case.least);
        // A plan that switches within a scan may need fewer scans than the program on the grid.
        assert!(scans + 2 >= least, "{scans} scans, the least are {least}");
        let more = scans.saturating_sub(least);
        let bar = (0.03 * least as f64).max(2.0);
        let (all, too_many) = above.entry(case.kind()).or_insert((0, 0));
        *all += 1;
        *too_many += u32::from(more as f64 > bar);
        let ratio = scans as f64 / least as f64;
        let worst = worst.entry(case.kind()).or_insert(ratio);
        *worst = ratio.max(*worst);
    }
    println!(
        "of each kind, those more than 3 % and 2 scans above the least: {above:?}; worst ratio {worst:.3?}"
    );
    let all: Vec<_> = above.values().map(|(all, _)| *all).collect();
    assert_eq!(all, [64, 87, 84, 65], "cases of each kind");
    assert!(above.values().all(|(_, too_many)| *too_many == 0), "{above:?}");
}

/// Ramps that `plan` solves.
fn ramps(plan: impl FnOnce()) -> u64 {
    let before = solved();
    plan();
    solved() - before
}

/// All that is planned ahead at once, when a move is commanded or in a scan, costs at most eight times the most
/// expensive move from rest.
#[test]
fn looking_ahead_costs_at_most_eight_single_plans() {
    let (mut single, mut looks) = (0, Vec::new());
    for case in cases() {
        let mut rig = Rig::new(case.limits);
        let mut from = 0.0;
        for next in &case.moves {
            let or_none = |limit: f64| if limit > 0.0 { limit } else { f64::INFINITY };
            let limits = Limits {
                velocity: next.dynamics.velocity,
                acceleration: next.dynamics.acceleration,
                deceleration: next.dynamics.deceleration,
                jerk: or_none(next.dynamics.jerk),
                snap: or_none(next.dynamics.snap),
            };
            let rest = Setpoint::at_rest(from);
            single = single.max(ramps(|| {
                OnlinePlan::new(&rest, next.end, &limits, &limits, CYCLE).expect("a plan");
            }));
            from = next.end;
            looks.push(ramps(|| {
                rig.move_with(next.end, next.mode, next.dynamics);
            }));
        }
        while rig.axis.state() != AxisState::Standstill {
            looks.push(ramps(|| rig.step()));
        }
    }
    looks.retain(|solved| *solved > 0);
    looks.sort_unstable();
    let mean = looks.iter().sum::<u64>() as f64 / looks.len() as f64;
    let (nearly_all, most) = (looks[looks.len() * 95 / 100], looks[looks.len() - 1]);
    println!(
        "ramps: {single} for the dearest move from rest; a look ahead {mean:.1} in the mean, {nearly_all} in 95 %, {most} at most"
    );
    assert!(most <= 8 * single, "{most} ramps, {single} for a single plan");
}
