//! `SR`: bistable, set dominant.
//!
//! Source: IEC 61131-3, standard bistable function blocks.

use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, pins};

pins! {
    in_outs {}
    inputs {
        /// Sets Q1; dominant.
        S1 => s1: bool = false, "";
        /// Resets Q1.
        R => r: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// The stored state.
        Q1 => q1: bool, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "SR")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Sr {
    q1: bool,
}

impl Block for Sr {
    const NAME: &'static str = "SR";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Stores a state; setting is dominant.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        self.q1 = inputs.s1 || (!inputs.r && self.q1);
        Outputs { q1: self.q1 }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    /// BI-1 and the whole truth table.
    #[test]
    fn set_wins() {
        for (q1, s1, r, wanted) in [
            (false, false, false, false),
            (false, false, true, false),
            (false, true, false, true),
            (false, true, true, true),
            (true, false, false, true),
            (true, false, true, false),
            (true, true, false, true),
            (true, true, true, true),
        ] {
            let mut block = Sr { q1 };
            assert_eq!(call(&mut block, &Inputs { s1, r }, 0).q1, wanted, "{q1} {s1} {r}");
        }
    }
}
