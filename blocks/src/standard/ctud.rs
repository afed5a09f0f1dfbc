//! `CTUD`: up and down counter.
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
        /// Counts down at a rising edge; edges of both in one call cancel.
        CD => cd: bool = false, "";
        /// Sets CV to 0; has priority over LD and edges, which are then consumed.
        R => r: bool = false, "";
        /// Sets CV to PV; has priority over edges, which are then consumed.
        LD => ld: bool = false, "";
        /// The count at which QU becomes TRUE, and the value for LD.
        PV => pv: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        /// CV has reached PV.
        QU => qu: bool, "";
        /// CV is 0 or less.
        QD => qd: bool, "";
        /// The count, from -32768 to 32767.
        CV => cv: Int, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "CTUD")]
#[derive(Clone, Copy, Debug, Default)]
pub struct Ctud {
    up: bool,
    down: bool,
    cv: Int,
}

impl Block for Ctud {
    const NAME: &'static str = "CTUD";
    const GROUP: Group = Group::Standard;
    const DOC: &'static str = "Counts rising edges up and down.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, _context: &mut Context<'_, P>) -> Outputs {
        let up = rising(&mut self.up, inputs.cu);
        let down = rising(&mut self.down, inputs.cd);
        if inputs.r {
            self.cv = 0;
        } else if inputs.ld {
            self.cv = inputs.pv;
        } else if up && !down {
            self.cv = self.cv.saturating_add(1);
        } else if down && !up {
            self.cv = self.cv.saturating_sub(1);
        }
        Outputs {
            qu: self.cv >= inputs.pv,
            qd: self.cv <= 0,
            cv: self.cv,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::standard::testing::call;

    const PULSES: Inputs = Inputs {
        cu: true,
        cd: true,
        r: false,
        ld: false,
        pv: 3,
    };

    fn at(cv: Int) -> Ctud {
        Ctud {
            cv,
            ..Ctud::default()
        }
    }

    fn shown(qu: bool, qd: bool, cv: Int) -> Outputs {
        Outputs { qu, qd, cv }
    }

    /// CT-1: R, then LD, then the edges; an edge that loses is consumed.
    #[test]
    fn reset_wins_over_load_and_load_over_edges() {
        let mut block = at(7);
        let reset = Inputs {
            r: true,
            ld: true,
            ..PULSES
        };
        let load = Inputs {
            ld: true,
            cd: false,
            ..PULSES
        };
        let up = Inputs { cd: false, ..PULSES };
        assert_eq!(call(&mut block, &reset, 0), shown(false, true, 0));
        assert_eq!(call(&mut block, &load, 0), shown(true, false, 3));
        assert_eq!(call(&mut block, &up, 0), shown(true, false, 3));
    }

    #[test]
    fn edges_of_both_cancel_even_at_the_limits() {
        for cv in [Int::MIN, 5, Int::MAX] {
            assert_eq!(call(&mut at(cv), &PULSES, 0).cv, cv);
        }
    }

    /// CT-3, CT-4.
    #[test]
    fn it_stops_at_the_type_limits() {
        let up = Inputs { cd: false, ..PULSES };
        let down = Inputs { cu: false, ..PULSES };
        assert_eq!(call(&mut at(Int::MAX), &up, 0), shown(true, false, Int::MAX));
        assert_eq!(call(&mut at(Int::MIN), &down, 0), shown(false, true, Int::MIN));
        assert_eq!(call(&mut at(3), &up, 0), shown(true, false, 4));
        assert_eq!(call(&mut at(0), &down, 0), shown(false, true, -1));
    }

    /// CT-2.
    #[test]
    fn qu_follows_pv_without_an_edge() {
        let still = |pv| Inputs {
            cu: false,
            cd: false,
            pv,
            ..PULSES
        };
        let mut block = at(5);
        assert!(!call(&mut block, &still(6), 0).qu);
        assert!(call(&mut block, &still(5), 0).qu);
    }
}
