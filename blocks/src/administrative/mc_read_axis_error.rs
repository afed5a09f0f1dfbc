//! `MC_ReadAxisError`: axis, drive and communication errors.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{AxisId, ErrorId, Planner};
use standstill_fb::{Block, Context, EnableCore, Group, pins};

pins! {
    in_outs {
        /// The axis to read.
        Axis => axis: AxisId;
    }
    inputs {
        /// Read in every call while TRUE.
        Enable => enable: bool = false, "";
    }
    vendor_inputs {}
    outputs {
        ..reading;
        /// The axis error; 0 if there is none.
        AxisErrorID => axis_error_id: ErrorId, "";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadAxisError")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadAxisError {
    core: EnableCore,
}

impl Block for McReadAxisError {
    const NAME: &'static str = "MC_ReadAxisError";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the error of an axis; errors of block instances are not shown (R76).";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.axis, context, |axis| Ok(axis.error_id()));
        Outputs {
            axis_error_id: reading.value(),
            ..(&reading).into()
        }
    }
}
