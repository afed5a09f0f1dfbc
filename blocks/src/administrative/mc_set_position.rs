//! `MC_SetPosition`: moves the coordinates of an axis, not the axis.
//!
//! Source: PLCopen Motion Control Part 1, section of that name.

use standstill_axis::{AxisId, ExecutionMode, Planner, Raw};
use standstill_fb::{Block, Context, ExecuteCore, Group, pins};

pins! {
    in_outs {
        /// The axis.
        Axis => axis: AxisId;
    }
    inputs {
        /// A rising edge moves the coordinates with the values of that call.
        Execute => execute: bool = false, "";
        /// New actual position, or with Relative the increase; finite.
        Position => position: f64 = 0.0, "u";
        /// TRUE: Position is added to the actual position found when the command executes.
        Relative => relative: bool = false, "";
        /// At once, or like a buffered motion.
        ExecutionMode => execution_mode: Raw<ExecutionMode> = Raw::new(0), "";
    }
    vendor_inputs {}
    outputs {
        /// The position has the new value.
        Done => done: bool, "";
        ..queued;
    }
    vendor_outputs {}
}

/// State kept between calls.
#[doc(alias = "MC_SetPosition")]
#[derive(Clone, Copy, Debug, Default)]
pub struct McSetPosition {
    core: ExecuteCore,
}

impl Block for McSetPosition {
    const NAME: &'static str = "MC_SetPosition";
    const GROUP: Group = Group::Administrative;
    const DOC: &'static str = "Moves the coordinates of an axis without moving it.";
    type Inputs = Inputs;
    type Outputs = Outputs;

    fn call<P: Planner>(&mut self, inputs: &Inputs, context: &mut Context<'_, P>) -> Outputs {
        let phase = self
            .core
            .scan(inputs.execute, inputs.axis, context, |axis, _, scope| {
                axis.set_position(inputs.position, inputs.relative, inputs.execution_mode, scope)
            });
        Outputs {
            done: phase.is_done(),
            ..phase.into()
        }
    }
}
