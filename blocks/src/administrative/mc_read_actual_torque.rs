//! `MC_ReadActualTorque`: the actual torque of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59, V25.

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
        /// Actual torque or force in the unit of the drive; positive towards larger positions.
        Torque => torque: f64, "torque";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadActualTorque")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadActualTorque {
    core: EnableCore,
}

impl Block for McReadActualTorque {
    const NAME: &'static str = "MC_ReadActualTorque";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the actual torque of an axis, if its drive tells it.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.axis, context, Axis::actual_torque);
        Outputs {
            torque: reading.value(),
            ..(&reading).into()
        }
    }
}
