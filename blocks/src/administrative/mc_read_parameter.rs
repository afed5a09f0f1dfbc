//! `MC_ReadParameter`: a parameter of type REAL by its number.
//!
//! Source: PLCopen Motion Control Part 1, section of that name and the list of parameters; rules R52 to R59.

use standstill_axis::{AxisId, Planner};
use standstill_fb::{Block, Context, EnableCore, Group, Int, pins};

pins! {
    in_outs {
        /// The axis.
        Axis => axis: AxisId;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
        /// Which parameter: 1 to 3 and 7 to 17.
        ParameterNumber => parameter_number: Int = 0, "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// Its value, in units of the axis; infinity where the axis has no limit.
        Value => value: f64, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadParameter")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadParameter {
    core: EnableCore,
}

impl Block for McReadParameter {
    const NAME: &'static str = "MC_ReadParameter";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads a parameter of an axis that is a number.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self.core.scan(inputs.enable, inputs.axis, context, |axis| {
            axis.real_parameter(inputs.parameter_number)
        });
        Outputs {
            value: reading.value(),
            ..(&reading).into()
        }
    }
}
