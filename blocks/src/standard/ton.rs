//! `TON`: on-delay timer.
//!
//! Source: IEC 61131-3, standard timer function blocks.

use super::elapsed;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, Time, pins};

pins! {
    in_outs {}
    inputs {
        /// The signal to delay.
        IN => input: bool = false, "";
        /// The delay; a change counts at once, a negative value as 0.
        PT => pt: Time = Time(0), "";
    }
    vendor_inputs {}
    outputs {
        /// IN has been TRUE for PT.
        Q => q: bool, "";
        /// Time since IN rose, at most PT.
        ET => et: Time, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "TON")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ton {
    running: Option<Running>,
}

/// IN is TRUE.
#[derive(Clone, Copy, Debug)]
struct Running {
    start_ns: i64,
    /// PT has passed; a larger PT does not reset it.
    q: bool,
}

impl Block for Ton {
    const NAME: &'static str = "TON";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Delays a rising edge.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        if !inputs.input {
            self.running = None;
            return Outputs::default();
        }
        let Some(running) = &mut self.running else {
            self.running = Some(Running {
                start_ns: context.now_ns,
                q: false,
            });
            return Outputs::default();
        };
        let (et, passed) = elapsed(running.start_ns, context.now_ns, inputs.pt);
        running.q |= passed;
        Outputs { q: running.q, et }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    const MS: i64 = 1_000_000;

    fn at(block: &mut Ton, now_ms: i64, input: bool, pt_ms: i64) -> (bool, i64) {
        let inputs = Inputs {
            input,
            pt: Time(pt_ms * MS),
        };
        let Outputs { q, et } = call(block, &inputs, now_ms * MS);
        (q, et.0 / MS)
    }

    /// TN-1, TN-2, TN-7.
    #[test]
    fn q_rises_exactly_at_pt_and_et_stays_there() {
        let mut block = Ton::default();
        assert_eq!(at(&mut block, 5, true, 30), (false, 0));
        assert_eq!(at(&mut block, 34, true, 30), (false, 29));
        assert_eq!(at(&mut block, 35, true, 30), (true, 30));
        assert_eq!(at(&mut block, 99, true, 30), (true, 30));
    }

    /// TN-3.
    #[test]
    fn in_false_resets_in_the_same_call() {
        let mut block = Ton::default();
        at(&mut block, 0, true, 10);
        assert_eq!(at(&mut block, 10, true, 10), (true, 10));
        assert_eq!(at(&mut block, 11, false, 10), (false, 0));
        assert_eq!(at(&mut block, 12, true, 10), (false, 0));
    }

    /// TN-4.
    #[test]
    fn a_change_of_pt_counts_at_once() {
        let mut block = Ton::default();
        at(&mut block, 0, true, 30);
        assert_eq!(at(&mut block, 20, true, 50), (false, 20));
        assert_eq!(at(&mut block, 30, true, 20), (true, 20));
        assert_eq!(at(&mut block, 31, true, 50), (true, 31));
    }

    /// TN-5.
    #[test]
    fn calls_left_out_do_not_stop_the_clock() {
        let mut block = Ton::default();
        at(&mut block, 0, true, 30);
        assert_eq!(at(&mut block, 1000, true, 30), (true, 30));
    }

    /// TN-6. A negative PT gives the same.
    #[test]
    fn without_delay_q_comes_one_call_after_the_edge() {
        for pt in [0, -5] {
            let mut block = Ton::default();
            assert_eq!(at(&mut block, 7, true, pt), (false, 0));
            assert_eq!(at(&mut block, 7, true, pt), (true, 0));
        }
    }
}
