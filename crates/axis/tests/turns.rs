//! Chains of blended moves in alternating directions: they turn at their ends.
//!
//! The rules, for any command, change or withdrawal at any time: no limit of the axis is exceeded, and nothing is
//! later than with buffered moves. The axis is on each end exactly, in a scan, with velocity 0, and never beyond it.
//! Set-points are checked independently, by their backward differences. The numbers are seeded; a failing case prints
//! its own.

use crate::chains::{BLENDING, CYCLE, LONGEST, Rig, drawn_dynamics, drawn_limits};
use standstill_axis::{
    AxisConfig, AxisState, BufferMode, Command, Dynamics, Fate, Limits, Scope, Superimpose,
};
use standstill_testkit::{Random, cases};

struct Move {
    end: f64,
    dynamics: Dynamics,
    mode: BufferMode,
    /// The scan in which it is commanded.
    at: u64,
}

/// Two to six moves; on average every second one reverses. Half of the chains have the dynamics of the axis.
fn moves(random: &mut Random, limits: &Limits, longest_wait: u64) -> Vec<Move> {
    let scan = limits.velocity * CYCLE;
    let is_same = random.below(2) == 0;
    let (mut side, mut end, mut at) = (1.0, 0.0, 0);
    (0..2 + random.below(5))
        .map(|_| {
            let scans = match random.below(3) {
                0 => random.between(1.1, 5.0),
                1 => random.between(5.0, 40.0),
                _ => random.between(40.0, 300.0),
            };
            if random.below(2) == 0 {
                side = -side;
            }
            end += side * scans * scan;
            let drawn = drawn_dynamics(random, limits);
            let dynamics = if is_same { Dynamics::default() } else { drawn };
            let mode = BLENDING[random.below(4) as usize];
            let next = Move {
                end,
                dynamics,
                mode,
                at,
            };
            at += random.below(longest_wait);
            next
        })
        .collect()
}

/// The range of all ends and the start.
fn range(moves: &[Move]) -> (f64, f64) {
    let ends = moves.iter().map(|next| next.end);
    ends.fold((0.0, 0.0), |(low, high): (f64, f64), end| {
        (low.min(end), high.max(end))
    })
}

/// Runs the moves, commanded in time, blended or buffered; `disturb` acts in each scan.
fn told(limits: Limits, moves: &[Move], is_blended: bool, disturb: impl FnMut(&mut Rig)) -> Rig {
    told_to(AxisConfig::new(limits), moves, is_blended, disturb)
}

/// The same on this axis.
fn told_to(config: AxisConfig, moves: &[Move], is_blended: bool, mut disturb: impl FnMut(&mut Rig)) -> Rig {
    let (low, high) = range(moves);
    let mut rig = Rig::of(config);
    let mut left = moves.iter().peekable();
    while left.peek().is_some() || rig.axis.state() != AxisState::Standstill {
        assert!(rig.scan < LONGEST, "does not end");
        while let Some(next) = left.next_if(|next| next.at <= rig.scan) {
            let mode = if is_blended {
                next.mode
            } else {
                BufferMode::Buffered
            };
            rig.move_with(next.end, mode, next.dynamics);
        }
        disturb(&mut rig);
        rig.step();
        let position = rig.axis.setpoint().position;
        let beyond = (low - position).max(position - high);
        let resolved = 8.0 * f64::EPSILON * high.max(-low);
        assert!(beyond <= resolved, "{position} is beyond {low}, {high}");
        assert_ne!(rig.axis.state(), AxisState::ErrorStop);
    }
    rig
}

/// Covers: B13, B15
#[test]
fn chains_that_turn_are_no_later_than_buffered() {
    let mut ratios = Vec::new();
    let mut later = Vec::new();
    for seed in 0..cases(4_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let longest = [1, 10, 100, 400][random.below(4) as usize];
        let moves = moves(&mut random, &limits, longest);
        let blended = told(limits, &moves, true, |_| ());
        let buffered = told(limits, &moves, false, |_| ());
        if blended.scan > buffered.scan {
            later.push((seed, blended.scan, buffered.scan));
        }
        ratios.push(blended.scan as f64 / buffered.scan as f64);
    }
    ratios.sort_by(f64::total_cmp);
    println!(
        "beside buffered: median {:.3}, least {:.3}",
        ratios[ratios.len() / 2],
        ratios[0]
    );
    assert_eq!(later, [], "seed, blended, buffered");
}

/// Covers: B13
#[test]
fn a_turn_is_on_its_end_without_velocity() {
    let mut turned = 0;
    for seed in 0..cases(1_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let moves = moves(&mut random, &limits, 1);
        let mut visited = Vec::new();
        told(limits, &moves, true, |rig| {
            let point = rig.axis.setpoint();
            if point.velocity == 0.0 {
                visited.push(point.position);
                turned += u64::from(point.acceleration != 0.0);
            }
        });
        let ends = [0.0].into_iter().chain(moves.iter().map(|next| next.end));
        let ends: Vec<f64> = ends.collect();
        for at in ends.windows(3) {
            let back = (at[1] - at[0]) * (at[2] - at[1]) < 0.0;
            assert!(
                !back || visited.contains(&at[1]),
                "seed {seed}: {} is not met",
                at[1]
            );
        }
    }
    assert!(turned > cases(500), "only {turned}");
}

#[test]
fn overrides_leave_the_turns_where_they_are() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let mut moves = moves(&mut random, &limits, 1);
        // If the override is lowered too late for the velocity at an end, the axis passes that end faster, and may be
        // a scan late.
        for number in 1..moves.len() {
            let way = (moves[number].end - moves[number - 1].end).abs();
            let side = if number % 2 == 0 { 1.0 } else { -1.0 };
            moves[number].end = moves[number - 1].end + side * moves[0].end.signum() * way;
        }
        told(limits, &moves, true, |rig| {
            if rig.scan > 3_000 {
                rig.set_override(1.0);
            } else if random.below(20) == 0 {
                rig.set_override([0.05, 0.3, 0.9, 1.0][random.below(4) as usize]);
            }
        });
    }
}

/// The override may be lowered at any time: an end for which that is too late is passed as planned, and the axis is
/// never beyond the last turn.
///
/// Covers: B13, B17
#[test]
fn an_override_in_a_chain_that_turns_leads_beyond_no_turn() {
    for seed in 0..cases(3_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let moves = moves(&mut random, &limits, 1);
        let (low, high) = range(&moves);
        let mut rig = Rig::new(limits);
        for next in &moves {
            rig.move_with(next.end, next.mode, next.dynamics);
        }
        while rig.axis.state() != AxisState::Standstill {
            assert!(rig.scan < LONGEST, "seed {seed}: does not end");
            if rig.scan > 3_000 {
                rig.set_override(1.0);
            } else if random.below(20) == 0 {
                rig.set_override([0.05, 0.3, 0.9, 1.0][random.below(4) as usize]);
            }
            let position = rig.advance();
            let beyond = (low - position).max(position - high);
            assert!(
                beyond <= 1e-12 * rig.watch.largest,
                "seed {seed}: {position} is beyond {low}, {high}"
            );
        }
        assert_eq!(rig.axis.setpoint().position, moves[moves.len() - 1].end);
    }
}

/// The software limits are a short or a long distance beyond the ends, and the axis is stopped at any time.
#[test]
fn a_stop_before_a_turn_stays_inside_the_software_limits() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let moves = moves(&mut random, &limits, 1);
        let (low, high) = range(&moves);
        let beyond = [0.1, 1.0, 10.0][random.below(3) as usize] * limits.velocity * CYCLE;
        let config = AxisConfig {
            software_limits: Some((low - beyond, high + beyond)),
            ..AxisConfig::new(limits)
        };
        let at = random.below(300);
        let mut rig = Rig::of(config);
        for next in &moves {
            rig.move_with(next.end, next.mode, next.dynamics);
        }
        while rig.axis.state() != AxisState::Standstill {
            assert!(rig.scan < LONGEST, "seed {seed}: does not end");
            if rig.scan == at {
                rig.moves.clear();
                let dynamics = Dynamics::default();
                rig.command(Command::Halt { dynamics }, BufferMode::Aborting);
            }
            rig.step();
            assert_ne!(rig.axis.state(), AxisState::ErrorStop, "seed {seed}");
            let position = rig.axis.setpoint().position;
            let outside = (low - position).max(position - high) - beyond;
            assert!(outside <= 1e-12 * rig.watch.largest, "seed {seed}: {position}");
        }
    }
}

#[test]
fn a_turn_whose_command_is_taken_away_goes_no_further() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let mut moves = moves(&mut random, &limits, 1);
        moves.truncate(2);
        let side = moves[0].end.signum();
        moves[1].end = moves[0].end * random.between(-1.0, 0.9);
        let at = random.below(120);
        let (mut end, mut furthest) = (0.0, 0.0_f64);
        let mut withdrawn = false;
        let rig = told(limits, &moves, true, |rig| {
            let (id, ..) = rig.moves[1];
            if rig.scan == at && rig.axis.fate(id) == Fate::Waiting {
                assert!(rig.axis.withdraw(id));
                let scope = &mut Scope::new(rig.scan, &mut rig.log);
                rig.axis.replaced(id, true, None, scope);
                rig.moves.remove(1);
                rig.move_to(moves[0].end, BufferMode::Buffered);
                withdrawn = true;
            }
            furthest = furthest.max(side * rig.axis.setpoint().position);
            end = rig.axis.setpoint().position;
        });
        let last = rig.axis.setpoint().position;
        if withdrawn {
            assert_eq!(last, moves[0].end, "seed {seed}");
        }
        assert!(
            furthest <= side * moves[0].end,
            "seed {seed}: as far as {furthest}"
        );
    }
}

/// Checks the differences of the sum, for any order of waiting.
#[test]
fn what_is_superimposed_at_a_turn_keeps_the_limits() {
    for seed in 0..cases(2_000) {
        let mut random = Random(seed);
        let limits = drawn_limits(&mut random);
        let moves = moves(&mut random, &limits, 1);
        let mut rig = Rig::new(limits);
        // The sum is as coarse as its parts.
        let (low, high) = range(&moves);
        rig.watch.largest = high.max(-low);
        for next in &moves {
            rig.move_with(next.end, next.mode, next.dynamics);
        }
        let at = random.below(200);
        let distance = limits.velocity * CYCLE * random.between(-20.0, 20.0);
        while rig.axis.state() != AxisState::Standstill {
            assert!(rig.scan < LONGEST, "seed {seed}: does not end");
            let scope = &mut Scope::new(rig.scan, &mut rig.log);
            if rig.scan == at {
                let dynamics = Dynamics::at(0.3 * limits.velocity);
                let request = Superimpose { distance, dynamics };
                rig.axis.superimpose(&request, scope).expect("a distance");
            }
            rig.axis.step_alone(scope);
            rig.scan += 1;
            rig.watch.see(rig.axis.setpoint().position).unwrap();
        }
    }
}
