//! `MC_WriteParameter`: writes a parameter of type REAL once.
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
        /// Which parameter: 2, 3, 7, 9, 13, 15 or 17.
        ParameterNumber => parameter_number: Int = 0, "";
        /// Its new value, in units of the axis.
        Value => value: f64 = 0.0, "";
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
#[doc(alias = "MC_WriteParameter")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McWriteParameter {
    core: ExecuteCore,
}

impl Block for McWriteParameter {
    const NAME: &'static str = "MC_WriteParameter";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Writes a parameter of an axis that is a number.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                axis.write_parameter(
                    inputs.parameter_number,
                    ParameterValue::Real(inputs.value),
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
