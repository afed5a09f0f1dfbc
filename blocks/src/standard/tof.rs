//! `TOF`: off-delay timer.
//!
//! Source: IEC 61131-3, standard timer function blocks.

use super::elapsed;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, Time, pins};

pins! {
    in_outs {}
    inputs {
        /// The signal to hold.
        IN => input: bool = false, "";
        /// How long Q outlasts IN; a change counts at once, a negative value as 0.
        PT => pt: Time = Time(0), "";
    }
    vendor_inputs {}
    outputs {
        /// IN is TRUE, or fell less than PT ago.
        Q => q: bool, "";
        /// Time since IN fell, at most PT; stays until IN rises.
        ET => et: Time, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "TOF")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Tof {
    state: State,
}

#[derive(Clone, Copy, Debug)]
enum State {
    /// Q is FALSE; `et` keeps the time of the last delay.
    Off { et: Time },
    /// IN is TRUE.
    On,
    /// IN fell at `start_ns`.
    Timing { start_ns: i64 },
}

impl Default for State {
    fn default() -> Self {
        Self::Off { et: Time(0) }
    }
}

impl Block for Tof {
    const NAME: &'static str = "TOF";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Delays a falling edge.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let mut et = Time(0);
        self.state = match self.state {
            _ if inputs.input => State::On,
            State::On => State::Timing {
                start_ns: context.now_ns,
            },
            State::Timing { start_ns } => {
                let passed;
                (et, passed) = elapsed(start_ns, context.now_ns, inputs.pt);
                if passed { State::Off { et } } else { self.state }
            }
            State::Off { et: kept } => {
                et = kept;
                self.state
            }
        };
        Outputs {
            q: !matches!(self.state, State::Off { .. }),
            et,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    const MS: i64 = 1_000_000;

    fn at(block: &mut Tof, now_ms: i64, input: bool, pt_ms: i64) -> (bool, i64) {
        let inputs = Inputs {
            input,
            pt: Time(pt_ms * MS),
        };
        let Outputs { q, et } = call(block, &inputs, now_ms * MS);
        (q, et.0 / MS)
    }

    /// TF-1, TF-2.
    #[test]
    fn q_falls_exactly_at_pt_and_et_stays_until_in_rises() {
        let mut block = Tof::default();
        assert_eq!(at(&mut block, 0, true, 30), (true, 0));
        assert_eq!(at(&mut block, 5, false, 30), (true, 0));
        assert_eq!(at(&mut block, 34, false, 30), (true, 29));
        assert_eq!(at(&mut block, 35, false, 30), (false, 30));
        assert_eq!(at(&mut block, 99, false, 50), (false, 30));
        assert_eq!(at(&mut block, 100, true, 50), (true, 0));
    }

    /// TF-3.
    #[test]
    fn in_back_while_timing_starts_over() {
        let mut block = Tof::default();
        at(&mut block, 0, true, 30);
        at(&mut block, 10, false, 30);
        assert_eq!(at(&mut block, 30, true, 30), (true, 0));
        assert_eq!(at(&mut block, 50, false, 30), (true, 0));
        assert_eq!(at(&mut block, 79, false, 30), (true, 29));
        assert_eq!(at(&mut block, 80, false, 30), (false, 30));
    }

    /// TF-4.
    #[test]
    fn in_false_at_first_is_no_edge() {
        let mut block = Tof::default();
        assert_eq!(at(&mut block, 50, false, 30), (false, 0));
    }

    /// PT = 0: as for TON one call later, and a change of PT counts at once.
    #[test]
    fn pt_is_looked_at_in_every_call_after_the_edge() {
        let mut block = Tof::default();
        at(&mut block, 0, true, 0);
        assert_eq!(at(&mut block, 1, false, 0), (true, 0));
        assert_eq!(at(&mut block, 1, false, 20), (true, 0));
        assert_eq!(at(&mut block, 11, false, 5), (false, 5));
    }
}
