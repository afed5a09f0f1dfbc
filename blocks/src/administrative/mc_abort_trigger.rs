//! `MC_AbortTrigger`: aborts the block that waits for an event.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; T39 g.

use standstill_axis::{AxisId, ErrorId, Planner, Raw, Trigger};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis.
        Axis => axis: AxisId;
        /// The probe of its drive, for either edge; mcProbe1Rising if it is left out.
        TriggerInput => trigger_input: Raw<Trigger>;
    }
    inputs {
        /// A rising edge aborts.
        Execute => execute: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        /// No block waits for the probe any more.
        Done => done: bool, "";
        /// Never TRUE: it is done in the call.
        Busy => busy: bool, "";
        /// Refused.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_AbortTrigger")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McAbortTrigger {
    core: ExecuteCore,
}

impl Block for McAbortTrigger {
    const NAME: &'static str = "MC_AbortTrigger";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Aborts the MC_TouchProbe that waits for a probe input.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                axis.abort_trigger(inputs.trigger_input, scope)
            });
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            error: phase.is_error(),
            error_id: phase.error_id(),
        }
    }
}
