//! `F_TRIG`: falling edge.
//!
//! Source: IEC 61131-3, standard edge detection function blocks.

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
        /// TRUE for the one call that sees CLK fall.
        Q => q: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "F_TRIG")]
#[derive(Clone, Copy, Debug, Default)]
pub struct FTrig {
    /// CLK at the last call; FALSE before the first, so that CLK FALSE at first is no edge.
    memory: bool,
}

impl Block for FTrig {
    const NAME: &'static str = "F_TRIG";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Detects a falling edge.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        let q = !inputs.clk && self.memory;
        self.memory = inputs.clk;
        Outputs { q }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    /// FT-1, FT-2.
    #[test]
    fn q_is_true_for_the_call_that_sees_the_fall() {
        let mut block = FTrig::default();
        let seen = [false, false, true, true, false, false, true, false]
            .map(|clk| call(&mut block, &Inputs { clk }, 0).q);
        assert_eq!(seen, [false, false, false, false, true, false, false, true]);
    }
}
