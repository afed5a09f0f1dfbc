//! `MC_ReadActualVelocity`: the actual velocity of an axis.
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
        /// Actual velocity, signed; its resolution is that of the position over the cycle.
        Velocity => velocity: f64, "u/s";
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_ReadActualVelocity")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadActualVelocity {
    core: EnableCore,
}

impl Block for McReadActualVelocity {
    const NAME: &'static str = "MC_ReadActualVelocity";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the actual velocity of an axis: the way from the last latched position to the newest, over the cycle.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let reading = self
            .core
            .scan(inputs.enable, inputs.axis, context, Axis::actual_velocity);
        Outputs {
            velocity: reading.value(),
            ..(&reading).into()
        }
    }
}
