//! `MC_WriteBoolParameter`: writes a parameter of type BOOL once.
//!
//! Source: PLCopen Motion Control Part 1, section of that name and the list of parameters.

use standstill_axis::{AxisId, ErrorId, ExecutionMode, ParameterValue, Planner, Raw};
use standstill_fb::{Block, Context, ExecuteCore, Group, Int, pins};

pins! {
    in_outs {
        /// The axis.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge writes the values of that call.
        Execute => execute: bool = false, "";
        /// Which parameter: 4 to 6.
        ParameterNumber => parameter_number: Int = 0, "";
        /// Its new value.
        Value => value: bool = false, "";
        /// At once, or like a buffered motion.
        ExecutionMode => execution_mode: Raw<ExecutionMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// Written: it holds for commands from now on.
        Done => done: bool, "";
        /// Waiting in the buffer.
        Busy => busy: bool, "";
        /// Refused, or removed from the buffer.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_WriteBoolParameter")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McWriteBoolParameter {
    core: ExecuteCore,
}

impl Block for McWriteBoolParameter {
    const NAME: &'static str = "MC_WriteBoolParameter";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Writes a parameter of an axis that is a switch.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self.core.scan(inputs.execute, context, |context, _| {
            let (axis, scope) = context.axis(inputs.axis)?;
            axis.write_parameter(
                inputs.parameter_number,
                ParameterValue::Bool(inputs.value),
                inputs.execution_mode,
                scope,
            )
            .map(|command| (inputs.axis, command))
        });
        Outputs {
            done: phase.is_done(),
            busy: phase.is_busy(),
            // It has no CommandAborted: removed from the buffer it was never executed, which is an error.
            error: phase.is_error() || phase.is_aborted(),
            error_id: if phase.is_aborted() {
                ErrorId::RemovedFromBuffer
            } else {
                phase.error_id()
            },
        }
    }
}
