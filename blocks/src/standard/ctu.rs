//! `CTU`: up counter.
//!
//! Source: IEC 61131-3, standard counter function blocks.

use super::rising;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, Int, pins};

pins! {
    in_outs {}
    inputs {
        /// Counts up at a rising edge.
        CU => cu: bool = false, "";
        /// Sets CV to 0; has priority over an edge, which is then consumed.
        R => r: bool = false, "";
        /// The count at which Q becomes TRUE.
        PV => pv: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        /// CV has reached PV.
        Q => q: bool, "";
        /// The count; it continues past PV and stops at 32767.
        CV => cv: Int, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "CTU")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ctu {
    memory: bool,
    cv: Int,
}

impl Block for Ctu {
    const NAME: &'static str = "CTU";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Counts rising edges up.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        let edge = rising(&mut self.memory, inputs.cu);
        if inputs.r {
            self.cv = 0;
        } else if edge {
            self.cv = self.cv.saturating_add(1);
        }
        Outputs {
            q: self.cv >= inputs.pv,
            cv: self.cv,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    fn at(cv: Int) -> Ctu {
        Ctu { memory: false, cv }
    }

    fn count(block: &mut Ctu, cu: bool, r: bool, pv: Int) -> (bool, Int) {
        let Outputs { q, cv } = call(block, &Inputs { cu, r, pv }, 0);
        (q, cv)
    }

    /// CT-1.
    #[test]
    fn reset_wins_and_spends_the_edge() {
        let mut block = at(5);
        assert_eq!(count(&mut block, true, true, 3), (false, 0));
        assert_eq!(count(&mut block, true, false, 3), (false, 0));
    }

    /// CT-2.
    #[test]
    fn q_follows_pv_without_an_edge() {
        let mut block = at(5);
        assert_eq!(count(&mut block, false, false, 6), (false, 5));
        assert_eq!(count(&mut block, false, false, 5), (true, 5));
        assert_eq!(count(&mut block, false, false, -1), (true, 5));
    }

    /// CT-3, CT-4.
    #[test]
    fn it_counts_past_pv_and_stops_at_the_type_limit() {
        let mut block = at(Int::MAX - 1);
        for cv in [Int::MAX, Int::MAX] {
            assert_eq!(count(&mut block, true, false, 3), (true, cv));
            count(&mut block, false, false, 3);
        }
    }
}
