//! `TP`: pulse timer.
//!
//! Source: IEC 61131-3, standard timer function blocks.

use super::elapsed;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, Time, pins};

pins! {
    in_outs {}
    inputs {
        /// A rising edge starts the pulse; ignored during it.
        IN => input: bool = false, "";
        /// Length of the pulse; a change counts at once, a negative value as 0.
        PT => pt: Time = Time(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The pulse.
        Q => q: bool, "";
        /// Time since the pulse began, at most PT; 0 once the pulse is over and IN is FALSE.
        ET => et: Time, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "TP")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Tp {
    state: State,
}

#[derive(Clone, Copy, Debug, Default)]
enum State {
    /// The last call saw IN FALSE and no pulse, so IN TRUE is an edge.
    #[default]
    Idle,
    /// The pulse began at `start_ns`.
    Pulse { start_ns: i64 },
    /// The pulse is over and IN still TRUE; `et` stays.
    Expired { et: Time },
}

impl Block for Tp {
    const NAME: &'static str = "TP";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Gives a pulse of fixed length.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let mut et = Time(0);
        self.state = match self.state {
            State::Idle if inputs.input => State::Pulse {
                start_ns: context.now_ns,
            },
            State::Idle => State::Idle,
            State::Pulse { start_ns } => {
                let passed;
                (et, passed) = elapsed(start_ns, context.now_ns, inputs.pt);
                if passed { State::Expired { et } } else { self.state }
            }
            State::Expired { et: kept } => {
                et = kept;
                self.state
            }
        };
        if matches!(self.state, State::Expired { .. }) && !inputs.input {
            self.state = State::Idle;
            et = Time(0);
        }
        Outputs {
            q: matches!(self.state, State::Pulse { .. }),
            et,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    const MS: i64 = 1_000_000;

    fn at(block: &mut Tp, now_ms: i64, input: bool, pt_ms: i64) -> (bool, i64) {
        let inputs = Inputs {
            input,
            pt: Time(pt_ms * MS),
        };
        let Outputs { q, et } = call(block, &inputs, now_ms * MS);
        (q, et.0 / MS)
    }

    /// TP-1.
    #[test]
    fn in_is_ignored_during_the_pulse() {
        let mut block = Tp::default();
        assert_eq!(at(&mut block, 0, true, 30), (true, 0));
        assert_eq!(at(&mut block, 10, false, 30), (true, 10));
        assert_eq!(at(&mut block, 20, true, 30), (true, 20));
        assert_eq!(at(&mut block, 29, true, 30), (true, 29));
        assert_eq!(at(&mut block, 30, true, 30), (false, 30));
    }

    /// TP-2, TP-3.
    #[test]
    fn a_held_in_gives_one_pulse() {
        let mut block = Tp::default();
        at(&mut block, 0, true, 30);
        for (now, pt) in [(30, 30), (31, 30), (1000, 50)] {
            assert_eq!(at(&mut block, now, true, pt), (false, 30), "{now}");
        }
        assert_eq!(at(&mut block, 1001, false, 30), (false, 0));
        assert_eq!(at(&mut block, 1002, true, 30), (true, 0));
    }

    /// TP-3: the same when IN is FALSE as the pulse ends.
    #[test]
    fn et_is_zero_when_pulse_and_in_are_over() {
        let mut block = Tp::default();
        at(&mut block, 0, true, 30);
        assert_eq!(at(&mut block, 30, false, 30), (false, 0));
    }

    /// TP-4.
    #[test]
    fn without_length_the_pulse_lasts_one_call() {
        for pt in [0, -5] {
            let mut block = Tp::default();
            assert_eq!(at(&mut block, 0, true, pt), (true, 0));
            assert_eq!(at(&mut block, 0, true, pt), (false, 0));
            assert_eq!(at(&mut block, 1, true, pt), (false, 0));
        }
    }
}
