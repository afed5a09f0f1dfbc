//! `RS`: bistable, reset dominant.
//!
//! Source: IEC 61131-3, standard bistable function blocks.

use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {}
    inputs {
        /// Sets Q1.
        S => s: bool = false, "";
        /// Resets Q1; dominant.
        R1 => r1: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// The stored state.
        Q1 => q1: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "RS")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Rs {
    q1: bool,
}

impl Block for Rs {
    const NAME: &'static str = "RS";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Stores a state; resetting is dominant.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        self.q1 = !inputs.r1 && (inputs.s || self.q1);
        Outputs { q1: self.q1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    /// BI-2 and the whole truth table.
    #[test]
    fn reset_wins() {
        for (q1, s, r1, wanted) in [
            (false, false, false, false),
            (false, false, true, false),
            (false, true, false, true),
            (false, true, true, false),
            (true, false, false, true),
            (true, false, true, false),
            (true, true, false, true),
            (true, true, true, false),
        ] {
            let mut block = Rs { q1 };
            assert_eq!(call(&mut block, &Inputs { s, r1 }, 0).q1, wanted, "{q1} {s} {r1}");
        }
    }
}
