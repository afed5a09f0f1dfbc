//! `MC_WriteBoolParameter`: writes a parameter of type BOOL once.
//!
//! Source: PLCopen Motion Control Part 1, section of that name and the list of parameters.

use standstill_axis::{AxisId, ExecutionMode, ParameterValue, Planner, Raw};
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
        ..queued;
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
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                axis.write_parameter(
                    inputs.parameter_number,
                    ParameterValue::Bool(inputs.value),
                    inputs.execution_mode,
                    scope,
                )
            });
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}
