//! `CTD`: down counter.
//!
//! Source: IEC 61131-3, standard counter function blocks.

use super::rising;
use standstill_axis::Planner;
use standstill_fb::{Block, Context, Group, Int, pins};

pins! {
    in_outs {}
    inputs {
        /// Counts down at a rising edge.
        CD => cd: bool = false, "";
        /// Sets CV to PV; has priority over an edge, which is then consumed.
        LD => ld: bool = false, "";
        /// The value for LD.
        PV => pv: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        /// CV is 0 or less.
        Q => q: bool, "";
        /// The count; it continues below 0 and stops at -32768.
        CV => cv: Int, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "CTD")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ctd {
    memory: bool,
    cv: Int,
}

impl Block for Ctd {
    const NAME: &'static str = "CTD";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Counts rising edges down.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        let edge = rising(&mut self.memory, inputs.cd);
        if inputs.ld {
            self.cv = inputs.pv;
        } else if edge {
            self.cv = self.cv.saturating_sub(1);
        }
        Outputs {
            q: self.cv <= 0,
            cv: self.cv,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    fn at(cv: Int) -> Ctd {
        Ctd { memory: false, cv }
    }

    fn count(block: &mut Ctd, cd: bool, ld: bool, pv: Int) -> (bool, Int) {
        let Outputs { q, cv } = call(block, &Inputs { cd, ld, pv }, 0);
        (q, cv)
    }

    /// CT-1, CT-2: PV acts only through LD, and there at once.
    #[test]
    fn load_wins_and_spends_the_edge() {
        let mut block = at(5);
        assert_eq!(count(&mut block, true, true, 3), (false, 3));
        assert_eq!(count(&mut block, true, true, 0), (true, 0));
        assert_eq!(count(&mut block, true, false, 9), (true, 0));
    }

    /// CT-3, CT-4.
    #[test]
    fn it_counts_below_zero_and_stops_at_the_type_limit() {
        let mut block = at(Int::MIN + 1);
        for cv in [Int::MIN, Int::MIN] {
            assert_eq!(count(&mut block, true, false, 3), (true, cv));
            count(&mut block, false, false, 3);
        }
    }
}
