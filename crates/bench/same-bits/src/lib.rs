//! Random machines with random programs, and a digest of every bit they publish.
//!
//! The digest is the same on every processor: `.ci/deep` compares it. It changes with the behaviour of a block, the
//! axis or the planner, so no file contains it. The random draws need no heap and no operating system, so that a
//! bare processor can make the same ones. `standstill soak blocks` checks the rules; this program does not.
#![no_std]
#![forbid(unsafe_code)]

#[cfg(test)]
extern crate std;

mod machine;

use core::fmt;
use machine::Machine;
use standstill_axis::Event;
use standstill_testkit::Random;

/// Machines, each with configurations and programs of its own.
const MACHINES: u64 = 100;

/// Scans of each.
const SCANS: u64 = 1000;

/// The results of the programs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Played {
    /// Scans of all machines.
    pub scans: u64,
    /// Motions that were planned.
    pub plans: u64,
    /// Commands that were refused.
    pub refused: u64,
    /// States that axes were in, a bit each.
    pub states: u32,
    /// Folds every published bit.
    pub digest: u64,
}

impl Played {
    /// FNV-1a over whole words.
    fn fold(&mut self, word: u64) {
        self.digest = (self.digest ^ word).wrapping_mul(0x0000_0100_0000_01b3);
        self.digest ^= self.digest >> 29;
    }
}

impl fmt::Display for Played {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let Self {
            scans,
            plans,
            refused,
            states,
            digest,
        } = self;
        let states = states.count_ones();
        write!(
            f,
            "{scans} scans, {plans} plans, {refused} refused, {states} states, digest {digest:016x}"
        )
    }
}

/// Runs all machines.
pub fn play() -> Played {
    play_with(Random(0), MACHINES)
}

fn play_with(mut random: Random, machines: u64) -> Played {
    let mut played = Played::default();
    for _ in 0..machines {
        let mut machine = Machine::new(&mut random);
        for scan in 0..SCANS {
            machine.scan(scan, &mut random, &mut |word| played.fold(word));
            played.scans += 1;
            for state in machine.states() {
                played.states |= 1 << state as u32;
            }
            for event in machine.events() {
                match event {
                    Event::Planned { .. } => played.plans += 1,
                    Event::Refused { .. } => played.refused += 1,
                    _ => {}
                }
            }
        }
    }
    played
}

#[cfg(test)]
mod tests {
    use super::*;

    /// There are couplings among them; `.ci/deep` compares other processors with the same line.
    ///
    /// Covers: G85
    #[test]
    fn the_programs_enter_every_state() {
        let played = play();
        assert_eq!(played.scans, 100_000);
        assert!(played.plans > 100 && played.refused > 100, "{played}");
        // Homing shows where MC_Home waited; otherwise only setting a position takes no scan.
        assert_eq!(played.states, 0b1111_1111, "{:#b}", played.states);
    }

    #[test]
    fn the_same_seed_gives_the_same_digest_and_another_one_another() {
        let [first, again, other] = [0, 0, 1].map(|seed| play_with(Random(seed), 2));
        assert_eq!(first, again);
        assert_ne!(first.digest, other.digest);
    }
}
