//! `R_TRIG`: rising edge.
//!
//! Source: IEC 61131-3, standard edge detection function blocks.

use super::rising;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {}
    inputs {
        /// The signal.
        CLK => clk: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// TRUE for the one call that sees CLK rise.
        Q => q: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "R_TRIG")]
#[derive(Clone, Copy, Debug, Default)]
pub struct RTrig {
    memory: bool,
}

impl Block for RTrig {
    const NAME: &'static str = "R_TRIG";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Detects a rising edge.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        Outputs {
            q: rising(&mut self.memory, inputs.clk),
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    /// RT-1, RT-2.
    #[test]
    fn q_is_true_for_the_call_that_sees_the_rise() {
        let mut block = RTrig::default();
        let seen = [true, true, false, false, true, false].map(|clk| call(&mut block, &Inputs { clk }, 0).q);
        assert_eq!(seen, [true, false, false, false, true, false]);
    }

    /// FB-3: two calls in one scan are two executions.
    #[test]
    fn called_with_both_values_it_fires_in_every_scan() {
        let mut block = RTrig::default();
        for scan in 0..3 {
            assert!(call(&mut block, &Inputs { clk: true }, scan).q);
            assert!(!call(&mut block, &Inputs { clk: false }, scan).q);
        }
    }
}
