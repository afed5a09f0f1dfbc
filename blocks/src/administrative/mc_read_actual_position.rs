//! `MC_ReadActualPosition`: the actual position of an axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name; rules R52 to R59.

use standstill_axis::{AxisId, ErrorId, Planner};
use standstill_fb::{Block, Context, Group, pins};

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
        /// The other outputs can be relied on.
        Valid => valid: bool, "";
        /// Enabled.
        Busy => busy: bool, "";
        /// The block cannot read.
        Error => error: bool, "";
        /// Why; 0 without an error.
        ErrorID => error_id: ErrorId, "";
        /// Actual position.
        Position => position: f64, "u";
    }
    vendor_outputs {}
}

/// Keeps nothing: reads in every call.
#[doc(alias = "MC_ReadActualPosition")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McReadActualPosition;

impl Block for McReadActualPosition {
    const NAME: &'static str = "MC_ReadActualPosition";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Reads the actual position of an axis.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        if !inputs.enable {
            return Outputs::default();
        }
        match context.axes.get(inputs.axis.index()) {
            Some(axis) => Outputs {
                valid: true,
                busy: true,
                position: axis.actual_position(),
                ..Outputs::default()
            },
            // Not recoverable: the pin is wired to nothing (R57).
            None => Outputs {
                error: true,
                error_id: ErrorId::AxisUnknown,
                ..Outputs::default()
            },
        }
    }
}
