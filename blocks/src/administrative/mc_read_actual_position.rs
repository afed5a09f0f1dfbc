//! `MC_ReadActualPosition`: the actual position of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{Axis, AxisId, Planner};
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
        /// Actual position, as latched in this scan.
        Position => position: f64, "u";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadActualPosition")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadActualPosition {
    core: EnableCore,
}

impl Block for McReadActualPosition {
    const NAME: &'static str = "MC_ReadActualPosition";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the actual position of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.axis, context, Axis::fresh_position);
        Outputs {
            position: reading.value(),
            ..(&reading).into()
        }
    }
}
