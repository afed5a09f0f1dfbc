//! `MC_Reset`: leaves ErrorStop.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; notes 3 and 4 of the state diagram, V10, V10a.

use standstill_axis::{AxisId, ErrorId, Planner};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis to reset.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge clears the axis errors.
        Execute => execute: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// Standstill or Disabled is reached.
        Done => done: bool, "";
        /// Not finished: the axis still brakes, or the drive has not answered.
        Busy => busy: bool, "";
        /// The cause is still present, or the block is not usable.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_Reset")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReset {
    core: ExecuteCore,
}

impl Block for McReset {
    const NAME: &'static str = "MC_Reset";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Clears the errors of an axis and leaves ErrorStop.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                axis.reset(scope)
            });
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}
