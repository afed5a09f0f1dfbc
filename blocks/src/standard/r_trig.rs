//! `R_TRIG`: rising edge.
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
        let q = inputs.clk && !self.memory;
        self.memory = inputs.clk;
        Outputs { q }
    }
}
